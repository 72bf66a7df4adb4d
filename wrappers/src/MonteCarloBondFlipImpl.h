#ifndef HELFRICH_MONTE_CARLO_BOND_FLIP_IMPL_H_
#define HELFRICH_MONTE_CARLO_BOND_FLIP_IMPL_H_

#include "SurfaceMoverImpl.h"
#include "openmm-helfrich/MonteCarloBondFlip.h"

namespace HelfrichPlugin {

static_assert(sizeof(HelfrichFlipState) == 80, "what has come of flips has no gaps");

/** Flips edges of a membrane. */
class MonteCarloBondFlipImpl : public SurfaceMoverImpl {
public:
    explicit MonteCarloBondFlipImpl(const MonteCarloBondFlip& owner);
    ~MonteCarloBondFlipImpl() {
        leave();
    }
    MoverKind getKind() const {
        return MoverKind::Flips;
    }
    void checkTriangles() const;
    double getFingerprint() const {
        return membrane->getFingerprint();
    }

protected:
    void copyRules();
    int64_t attempt(OpenMM::ContextImpl& context, int groups, const std::vector<OpenMM::Vec3>& positions,
                    int64_t attempts, std::vector<OpenMM::Vec3>* forceChange);
    std::map<std::string, double> getCounts() const;
    std::string describeForeign() const;

private:
    const MonteCarloBondFlip& owner;
    HelfrichFlipRules rules;
    HelfrichFlipState state;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_BOND_FLIP_IMPL_H_*/
