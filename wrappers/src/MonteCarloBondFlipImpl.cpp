#include "MonteCarloBondFlipImpl.h"

#include <openmm/reference/SimTKOpenMMRealType.h>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;
using std::vector;

MonteCarloBondFlipImpl::MonteCarloBondFlipImpl(const MonteCarloBondFlip& owner)
    : SurfaceMoverImpl(owner, MonteCarloBondFlip::Temperature(), owner.getConnectivityParameter(),
                       {&state, sizeof(state), state.key, 0x464c0000}),
      owner(owner), rules(), state() {
}

void MonteCarloBondFlipImpl::checkTriangles() const {
    membrane->checkRules(owner.getTypeName(), rules);
}

void MonteCarloBondFlipImpl::copyRules() {
    HelfrichFlipRules updated;
    updated.temperature = BOLTZ * owner.getDefaultTemperature();
    updated.minDegree = owner.getMinDegree();
    updated.maxDegree = owner.getMaxDegree();
    updated.maxEdgeLength = owner.getMaxEdgeLength();
    updated.demon = owner.getEnsemble() == MonteCarloBondFlip::Microcanonical;
    membrane->checkRules(owner.getTypeName(), updated);
    rules = updated;
}

int64_t MonteCarloBondFlipImpl::attempt(ContextImpl& context, int groups, const vector<Vec3>& positions,
                                        int64_t attempts, vector<Vec3>* forceChange) {
    if (rules.demon == 0)
        rules.temperature = findBath(context);
    return membrane->flip(owner.getTypeName(), context, groups, positions, rules, attempts, state, forceChange);
}

map<string, double> MonteCarloBondFlipImpl::getCounts() const {
    return {{"attempts", (double) state.attempts},
            {"accepted", (double) state.accepted},
            {"refusedByBorder", (double) state.byBorder},
            {"refusedByDegree", (double) state.byDegree},
            {"refusedByLength", (double) state.byLength},
            {"refusedByShape", (double) state.byShape},
            {"refusedByEnergy", (double) state.byEnergy},
            {"refusedByEdge", (double) state.byEdge},
            {"demonEnergy", state.demonEnergy}};
}

string MonteCarloBondFlipImpl::describeForeign() const {
    return "positions belong to other triangles than the Context has: a State or checkpoint was loaded, which does not "
           "hold the connectivity. Restore what saveConnectivity() has saved with restoreConnectivity() (in Python "
           "helfrich.save_state() and load_state()), or give the Context the triangles with setTrianglesInContext()";
}
