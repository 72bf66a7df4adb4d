#ifndef HELFRICH_CONNECTIVITY_IMPL_H_
#define HELFRICH_CONNECTIVITY_IMPL_H_

#include <openmm/internal/ContextImpl.h>
#include <openmm/internal/ForceImpl.h>

#include <map>
#include <string>
#include <vector>

namespace HelfrichPlugin {

/** What a force asks of its implementation about the surfaces of a Context; see UpdatableImpl. */
class ConnectivityImpl {
public:
    virtual ~ConnectivityImpl() {
    }
    virtual std::vector<int> getTrianglesInContext(OpenMM::ContextImpl& context) const = 0;
    virtual void setTrianglesInContext(OpenMM::ContextImpl& context, const std::vector<int>& corners) = 0;
    virtual std::string saveConnectivity(OpenMM::ContextImpl& context) const = 0;
    virtual void restoreConnectivity(OpenMM::ContextImpl& context, const std::string& saved) = 0;
    /** Of all membrane forces of the Context in some groups, not only of this one. */
    virtual std::vector<double> getVirial(OpenMM::ContextImpl& context, int groups) const = 0;
};

/** What MonteCarloBondFlip asks of its implementation besides. */
class StatisticsImpl {
public:
    virtual ~StatisticsImpl() {
    }
    virtual std::map<std::string, double> getStatistics(OpenMM::ContextImpl& context) const = 0;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_CONNECTIVITY_IMPL_H_*/
