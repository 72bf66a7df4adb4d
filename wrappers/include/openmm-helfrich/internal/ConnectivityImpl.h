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
    virtual std::vector<int> getPermutationInContext(OpenMM::ContextImpl& context) const = 0;
    virtual void setPermutationInContext(OpenMM::ContextImpl& context, const std::vector<int>& permutation) = 0;
    virtual std::string saveConnectivity(OpenMM::ContextImpl& context) const = 0;
    virtual void restoreConnectivity(OpenMM::ContextImpl& context, const std::string& saved) = 0;
    /** Of all membrane forces of the Context in some groups, not only of this one. */
    virtual std::vector<double> getVirial(OpenMM::ContextImpl& context, int groups) const = 0;
};

/** What forces ask of their implementations that have numbers for each vertex. */
class VertexNumbersImpl {
public:
    virtual ~VertexNumbersImpl() {
    }
    /** As vertices have them now. */
    virtual std::vector<double> getVertexNumbersInContext(OpenMM::ContextImpl& context) const = 0;
};

/** What movers ask of their implementations. */
class StatisticsImpl {
public:
    virtual ~StatisticsImpl() {
    }
    virtual std::map<std::string, double> getStatistics(OpenMM::ContextImpl& context) const = 0;
};

/** What movers ask of their implementations that keep what they have come to. */
class StateImpl {
public:
    virtual ~StateImpl() {
    }
    virtual std::string saveState() const = 0;
    virtual void restoreState(const std::string& saved) = 0;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_CONNECTIVITY_IMPL_H_*/
