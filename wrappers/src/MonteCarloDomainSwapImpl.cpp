#include "MonteCarloDomainSwapImpl.h"

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;
using std::vector;

MonteCarloDomainSwapImpl::MonteCarloDomainSwapImpl(const MonteCarloDomainSwap& owner)
    : SurfaceMoverImpl(owner, MonteCarloDomainSwap::Temperature(), owner.getPermutationParameter(),
                       {&state, sizeof(state), state.key, 0x53570000}),
      owner(owner), rules(), state() {
}

void MonteCarloDomainSwapImpl::copyRules() {
    rules.demon = owner.getEnsemble() == MonteCarloDomainSwap::Microcanonical;
}

int64_t MonteCarloDomainSwapImpl::attempt(ContextImpl& context, int groups, const vector<Vec3>& positions,
                                          int64_t attempts, vector<Vec3>* forceChange) {
    if (rules.demon == 0)
        rules.temperature = findBath(context);
    return membrane->swap(owner.getTypeName(), context, groups, positions, rules, attempts, state, forceChange);
}

map<string, double> MonteCarloDomainSwapImpl::getCounts() const {
    return {{"attempts", (double) state.attempts},
            {"accepted", (double) state.accepted},
            {"refusedByKind", (double) state.byKind},
            {"refusedByEnergy", (double) state.byEnergy},
            {"demonEnergy", state.demonEnergy}};
}

string MonteCarloDomainSwapImpl::describeForeign() const {
    return "it belongs to another permutation of the vertices' values than the Context has: a State or checkpoint was "
           "loaded, which does not hold it. Restore what saveConnectivity() has saved with restoreConnectivity() (in "
           "Python helfrich.save_state() and load_state()), or give the Context the permutation with "
           "setPermutationInContext()";
}
