#ifndef HELFRICH_ON_MEMBRANE_H_
#define HELFRICH_ON_MEMBRANE_H_

#include "SharedMembrane.h"
#include "openmm-helfrich/internal/ConnectivityImpl.h"

namespace HelfrichPlugin {

/** What is the same for all implementations that act on a membrane: it knows what there is in a Context. */
class OnMembrane : public ConnectivityImpl {
public:
    std::vector<int> getTrianglesInContext(OpenMM::ContextImpl& context) const {
        return membrane->getPresentTriangles(context);
    }
    void setTrianglesInContext(OpenMM::ContextImpl& context, const std::vector<int>& corners) {
        membrane->setTriangles(subject, context, corners);
    }
    std::vector<int> getPermutationInContext(OpenMM::ContextImpl& context) const {
        return membrane->getPermutation(subject, context);
    }
    void setPermutationInContext(OpenMM::ContextImpl& context, const std::vector<int>& permutation) {
        membrane->setPermutation(subject, context, permutation);
    }
    std::string saveConnectivity(OpenMM::ContextImpl& context) const {
        return membrane->save(context);
    }
    void restoreConnectivity(OpenMM::ContextImpl& context, const std::string& saved) {
        membrane->restore(subject, context, saved);
    }
    std::vector<double> getVirial(OpenMM::ContextImpl& context, int groups) const {
        return SharedMembrane::sumVirials(context, groups);
    }

protected:
    /** @param subject  the class that messages shall name */
    explicit OnMembrane(const std::string& subject) : subject(subject) {
    }

    std::shared_ptr<SharedMembrane> membrane;

private:
    const std::string subject;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_ON_MEMBRANE_H_*/
