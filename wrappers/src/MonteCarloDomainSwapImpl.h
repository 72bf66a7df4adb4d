#ifndef HELFRICH_MONTE_CARLO_DOMAIN_SWAP_IMPL_H_
#define HELFRICH_MONTE_CARLO_DOMAIN_SWAP_IMPL_H_

#include "SurfaceMoverImpl.h"
#include "openmm-helfrich/MonteCarloDomainSwap.h"

namespace HelfrichPlugin {

static_assert(sizeof(HelfrichSwapState) == 48, "what has come of exchanges has no gaps");

/** Lets neighbours of a membrane exchange what they are. */
class MonteCarloDomainSwapImpl : public SurfaceMoverImpl {
public:
    explicit MonteCarloDomainSwapImpl(const MonteCarloDomainSwap& owner);
    ~MonteCarloDomainSwapImpl() {
        leave();
    }
    MoverKind getKind() const {
        return MoverKind::Swaps;
    }
    double getFingerprint() const {
        return membrane->getPermutationFingerprint();
    }

protected:
    void copyRules();
    int64_t attempt(OpenMM::ContextImpl& context, int groups, const std::vector<OpenMM::Vec3>& positions,
                    int64_t attempts, std::vector<OpenMM::Vec3>* forceChange);
    std::map<std::string, double> getCounts() const;
    std::string describeForeign() const;

private:
    const MonteCarloDomainSwap& owner;
    HelfrichSwapRules rules;
    HelfrichSwapState state;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_DOMAIN_SWAP_IMPL_H_*/
