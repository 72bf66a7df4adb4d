#include "ScaledBodies.h"

#include "openmm-helfrich/MembraneForce.h"

#include <openmm/CustomCVForce.h>
#include <openmm/OpenMMException.h>
#include <openmm/System.h>
#include <openmm/VirtualSite.h>
#include <openmm/internal/ForceImpl.h>

#include <algorithm>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

namespace {

/** Note the vertices of a membrane that may span the box, also where another force contains it. */
void markVertices(const Force& force, vector<bool>& isVertex) {
    if (auto* variables = dynamic_cast<const CustomCVForce*>(&force))
        for (int i = 0; i < variables->getNumCollectiveVariables(); i++)
            markVertices(variables->getCollectiveVariable(i), isVertex);
    auto* membrane = dynamic_cast<const MembraneForce*>(&force);
    if (membrane == nullptr || !membrane->usesPeriodicBoundaryConditions())
        return;
    for (int particle : membrane->getTriangles())
        // The force itself complains of a particle that is not there.
        if (particle >= 0 && particle < (int) isVertex.size())
            isVertex[particle] = true;
}

vector<bool> findVertices(ContextImpl& context) {
    vector<bool> isVertex(context.getSystem().getNumParticles());
    for (const ForceImpl* impl : context.getForceImpls()) {
        markVertices(impl->getOwner(), isVertex);
        for (const Force* contained : impl->getContainedForces())
            markVertices(*contained, isVertex);
    }
    return isVertex;
}

/** What bonds connect, as a forest whose roots stand for molecules. */
class Forest {
public:
    explicit Forest(int size) : parents(size) {
        for (int i = 0; i < size; i++)
            parents[i] = i;
    }
    int findRoot(int i) {
        while (parents[i] != i)
            i = parents[i] = parents[parents[i]];
        return i;
    }
    void join(int i, int j) {
        // The lowest index is the root, so that the order of bonds does not matter.
        int one = findRoot(i), other = findRoot(j);
        parents[std::max(one, other)] = std::min(one, other);
    }

private:
    vector<int> parents;
};

} // namespace

ScaledBodies::ScaledBodies(ContextImpl& context, bool rigidMolecules) : count(0) {
    const System& system = context.getSystem();
    const int numParticles = system.getNumParticles();
    vector<bool> isPoint = findVertices(context);
    for (int i = 0; i < numParticles; i++) {
        bool isMassless = system.getParticleMass(i) == 0;
        if (!rigidMolecules || (isMassless && !system.isVirtualSite(i)))
            isPoint[i] = true;
        if (!isPoint[i])
            continue;
        points.push_back(i);
        if (!isMassless)
            count++;
    }
    Forest forest(numParticles);
    auto connect = [&](int i, int j) {
        if (!isPoint[i] && !isPoint[j])
            forest.join(i, j);
    };
    for (const ForceImpl* impl : context.getForceImpls())
        for (const auto& [i, j] : impl->getBondedParticles())
            connect(i, j);
    for (int i = 0; i < system.getNumConstraints(); i++) {
        int one, other;
        double distance;
        system.getConstraintParameters(i, one, other, distance);
        connect(one, other);
    }
    for (int i = 0; i < numParticles; i++)
        if (system.isVirtualSite(i))
            for (int j = 0; j < system.getVirtualSite(i).getNumParticles(); j++)
                connect(i, system.getVirtualSite(i).getParticle(j));
    vector<vector<int>> massive(numParticles), massless(numParticles);
    for (int i = 0; i < numParticles; i++)
        if (!isPoint[i])
            (system.getParticleMass(i) > 0 ? massive : massless)[forest.findRoot(i)].push_back(i);
    for (int i = 0; i < numParticles; i++) {
        // Without any mass it is made of virtual sites of points, which follow these.
        if (massive[i].empty())
            continue;
        Molecule molecule = {massive[i], (int) massive[i].size()};
        molecule.particles.insert(molecule.particles.end(), massless[i].begin(), massless[i].end());
        molecules.push_back(molecule);
    }
    count += (int) molecules.size();
}

void ScaledBodies::refuseConstraints(const string& subject, ContextImpl& context, bool rigidMolecules) {
    const System& system = context.getSystem();
    const vector<bool> isVertex = findVertices(context);
    for (int i = 0; i < system.getNumConstraints(); i++) {
        int one, other;
        double distance;
        system.getConstraintParameters(i, one, other, distance);
        if (!rigidMolecules || isVertex[one] || isVertex[other])
            throw OpenMMException(subject + ": the constraint between the particles " + std::to_string(one) + " and " +
                                  std::to_string(other) +
                                  " would not survive that they are scaled one by one; put a bond in its place" +
                                  (rigidMolecules ? "" : ", or setScaleMoleculesAsRigid(True)"));
    }
}

void ScaledBodies::scale(const Vec3& factors, vector<Vec3>& positions) const {
    for (int i : points)
        for (int axis = 0; axis < 3; axis++)
            positions[i][axis] *= factors[axis];
    for (const Molecule& molecule : molecules) {
        Vec3 centre;
        for (int i = 0; i < molecule.numMassive; i++)
            centre += positions[molecule.particles[i]];
        centre /= molecule.numMassive;
        const Vec3 shift((factors[0] - 1) * centre[0], (factors[1] - 1) * centre[1], (factors[2] - 1) * centre[2]);
        for (int i : molecule.particles)
            positions[i] += shift;
    }
}
