#include "Barostats.h"

#include <OpenMM.h>

#include <typeinfo>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;

namespace {

/** What matters about a barostat of OpenMM. */
struct Barostat {
    bool acts, movesMolecules;
};

/** Of a force of one of OpenMM's classes. */
template <class BarostatClass>
bool describe(const Force& force, Barostat& found) {
    auto* barostat = dynamic_cast<const BarostatClass*>(&force);
    if (barostat != nullptr)
        found = {barostat->getFrequency() > 0, barostat->getScaleMoleculesAsRigid()};
    return barostat != nullptr;
}

Barostat findBarostat(const Force& force) {
    Barostat found = {false, false};
    if (describe<MonteCarloBarostat>(force, found) || describe<MonteCarloAnisotropicBarostat>(force, found) ||
        describe<MonteCarloMembraneBarostat>(force, found) || describe<MonteCarloFlexibleBarostat>(force, found))
        return found;
    // Its plugin is not linked; the name of a class is part of what compilers call its type.
    if (string(typeid(force).name()).find("RPMDMonteCarloBarostat") != string::npos)
        return {true, true};
    return found;
}

} // namespace

void HelfrichPlugin::refuseBarostats(const string& subject, const System& system) {
    for (int i = 0; i < system.getNumForces(); i++)
        if (findBarostat(system.getForce(i)).acts)
            throw OpenMMException(subject + ": the System also has the barostat \"" + system.getForce(i).getName() +
                                  "\", and both change the box; choose one of them");
}

void HelfrichPlugin::refuseTearing(const string& subject, const System& system) {
    for (int i = 0; i < system.getNumForces(); i++) {
        Barostat barostat = findBarostat(system.getForce(i));
        if (barostat.acts && barostat.movesMolecules)
            throw OpenMMException(subject + ": the membrane spans the periodic box, and the barostat \"" +
                                  system.getForce(i).getName() +
                                  "\" moves molecules by their centres: the box would change and the membrane, which "
                                  "is one molecule, would not, so that it tears; use a MonteCarloMembraneTension, or "
                                  "scale every particle with the barostat's setScaleMoleculesAsRigid(False)");
    }
}

void HelfrichPlugin::refuseScaling(const string& subject, const System& system) {
    for (int i = 0; i < system.getNumForces(); i++) {
        Barostat barostat = findBarostat(system.getForce(i));
        if (barostat.acts && !barostat.movesMolecules)
            throw OpenMMException(subject + ": the barostat \"" + system.getForce(i).getName() +
                                  "\" scales the positions of single particles and weighs that without the kinetic "
                                  "energy, but masses and so kinetic energies change with it; let it move molecules "
                                  "as a whole, with its setScaleMoleculesAsRigid(True)");
    }
}
