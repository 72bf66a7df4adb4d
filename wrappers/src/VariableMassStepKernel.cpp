#include "VariableMassStepKernel.h"

#include "Barostats.h"
#include "HelfrichPlatform.h"
#include "Movers.h"
#include "openmm-helfrich/MonteCarloBondFlip.h"
#include "openmm-helfrich/MonteCarloMembraneTension.h"
#include "openmm-helfrich/TriangulatedForce.h"

#include <openmm/AndersenThermostat.h>
#include <openmm/CMMotionRemover.h>
#include <openmm/CustomCVForce.h>
#include <openmm/OpenMMException.h>
#include <openmm/System.h>
#include <openmm/reference/SimTKOpenMMRealType.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <ostream>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

namespace {

/** Starts what a checkpoint of platform Reference has of the random numbers. */
const uint32_t STREAM_MARK = 0x314d5648;

/** Refuse a force of some class. */
template <class ForceClass>
void refuse(const string& subject, const Force& force, const string& reason) {
    if (dynamic_cast<const ForceClass*>(&force) != nullptr)
        throw OpenMMException(subject + ": the System has the force \"" + force.getName() + "\", " + reason);
}

/** Refuse what the scheme cannot do exactly. */
void refuseOthers(const string& subject, const System& system) {
    if (system.getNumConstraints() > 0)
        throw OpenMMException(subject + ": the System has constraints, which masses that change do not keep; remove " +
                              "them, or use an integrator of constant masses");
    for (int i = 0; i < system.getNumForces(); i++) {
        const Force& force = system.getForce(i);
        refuse<MonteCarloBondFlip>(subject, force,
                                   "which weighs flips without the kinetic energy, but a flip changes masses and so "
                                   "kinetic energies; leave it out, or use an integrator of constant masses");
        refuse<MonteCarloMembraneTension>(subject, force,
                                          "which weighs moves without the kinetic energy, but a move changes masses "
                                          "and so kinetic energies; leave it out, or use an integrator of constant "
                                          "masses");
        refuse<AndersenThermostat>(subject, force,
                                   "which draws velocities for the System's masses, not for those of plaquettes; use "
                                   "a VariableMassLangevinIntegrator for a bath");
        refuse<CMMotionRemover>(subject, force,
                                "which takes the System's masses for those of plaquettes and so would not remove the "
                                "motion of the centre; leave it out: the time steps conserve the momentum");
    }
    refuseScaling(subject, system);
}

/** Refuse a surface inside of a force, in a Context of its own: its vertices would keep constant masses, unnoticed. */
void refuseIn(const string& subject, const vector<bool>& isVertex, const Force& contained, const string& outer) {
    if (auto* variables = dynamic_cast<const CustomCVForce*>(&contained))
        for (int i = 0; i < variables->getNumCollectiveVariables(); i++)
            refuseIn(subject, isVertex, variables->getCollectiveVariable(i), outer);
    if (auto* force = dynamic_cast<const TriangulatedForce*>(&contained))
        for (int particle : force->getTriangles())
            if (!isVertex[particle])
                throw OpenMMException(subject + ": particle " + std::to_string(particle) + " is a vertex of a " +
                                      force->getTypeName() + " inside of the force \"" + outer +
                                      "\" only; its mass follows the surfaces of the System's own forces, so add one " +
                                      "on these triangles");
}

vector<std::shared_ptr<SharedMembrane>> findMembranes(const string& subject, ContextImpl& context) {
    auto membranes = SharedMembrane::findAll(context);
    if (membranes.empty())
        throw OpenMMException(
            subject + ": the System has no membrane force, so no vertices whose masses could follow " +
            "their plaquettes; add the forces to the System itself, or use an integrator of " + "constant masses");
    return membranes;
}

} // namespace

KernelImpl* VariableMassKernelFactory::createKernelImpl(string name, const Platform& platform,
                                                        ContextImpl& context) const {
    return new VariableMassStepKernel(name, platform, context);
}

VariableMassStepKernel::VariableMassStepKernel(const string& name, const Platform& platform, ContextImpl& context)
    : IntegrateVariableMassStepKernel(name, platform),
      data(*static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())), bath(nullptr), masses(nullptr),
      team(nullptr), isPeriodic(false), hasVirtualSites(false), stream(nullptr), ownStream(), forceGroups(0),
      stepCount(0) {
}

VariableMassStepKernel::~VariableMassStepKernel() {
    Helfrich_VariableMasses_destroy(masses);
}

void VariableMassStepKernel::initialize(ContextImpl& context, const VariableMassIntegrator& integrator) {
    subject = integrator.getTypeName();
    bath = dynamic_cast<const VariableMassLangevinIntegrator*>(&integrator);
    const System& system = context.getSystem();
    refuseOthers(subject, system);
    membranes = findMembranes(subject, context);
    vector<double> constant;
    for (int i = 0; i < system.getNumParticles(); i++) {
        constant.push_back(system.getParticleMass(i));
        hasVirtualSites |= system.isVirtualSite(i);
    }
    check(Helfrich_VariableMasses_create(subject.c_str(), (int64_t) constant.size(), constant.data(),
                                         integrator.getDensity(), &masses));
    // What a Context of before has left is not settled yet: a checkpoint may come.
    findSurfaces(context);
    vector<bool> isVertex(constant.size());
    for (const auto& membrane : membranes)
        for (int particle : membrane->getTriangles())
            isVertex[particle] = true;
    for (const ForceImpl* impl : context.getForceImpls())
        for (const Force* contained : impl->getContainedForces())
            refuseIn(subject, isVertex, *contained, impl->getOwner().getName());
    auto* ours = HelfrichPlatform::getData(context);
    if (ours != nullptr)
        team = ours->findTeam();
    if (bath == nullptr)
        return;
    int seed = bath->getRandomNumberSeed();
    ownStream.key[0] = toKey(seed);
    stream = ours != nullptr ? &ours->addStream(seed) : &ownStream;
}

void VariableMassStepKernel::findPresentSurfaces(ContextImpl& context) {
    for (const auto& membrane : membranes)
        membrane->settle(context);
    findSurfaces(context);
}

void VariableMassStepKernel::findSurfaces(ContextImpl& context) {
    vector<double> present;
    for (const auto& membrane : membranes)
        present.push_back(membrane->getFingerprint());
    if (present == fingerprints)
        return;
    // What is refused below will be so the next time.
    fingerprints.clear();
    const System& system = context.getSystem();
    vector<vector<int>> corners;
    vector<HelfrichSheet> sheets;
    isPeriodic = false;
    for (const auto& membrane : membranes) {
        corners.push_back(membrane->findTriangles());
        for (int particle : corners.back())
            if (system.isVirtualSite(particle))
                throw OpenMMException(subject + ": particle " + std::to_string(particle) +
                                      " is a vertex and a virtual site, which has no momentum of its own; give the " +
                                      "membrane particles that move by themselves");
        sheets.push_back({corners.back().data(), (int64_t) corners.back().size() / 3, membrane->isPeriodic()});
        isPeriodic |= membrane->isPeriodic();
    }
    check(Helfrich_VariableMasses_setSurfaces(subject.c_str(), masses, sheets.data(), (int64_t) sheets.size()));
    fingerprints = present;
}

HelfrichParticleArrays VariableMassStepKernel::getParticles() const {
    return {data.numParticles, &(*data.positions)[0][0], &(*data.velocities)[0][0], &(*data.forces)[0][0]};
}

const double* VariableMassStepKernel::findBox() const {
    return isPeriodic ? &data.periodicBoxVectors[0][0] : nullptr;
}

void VariableMassStepKernel::execute(ContextImpl& context, const VariableMassIntegrator& integrator,
                                     bool forcesAreValid) {
    double step = integrator.getStepSize();
    if (!std::isfinite(step))
        throw OpenMMException(subject + ": the step size must be a finite number of ps, got " + std::to_string(step));
    findPresentSurfaces(context);
    int groups = integrator.getIntegrationForceGroups();
    // In a CompoundIntegrator, others may have made steps since.
    if (!forcesAreValid || groups != forceGroups || data.stepCount != stepCount) {
        context.calcForcesAndEnergy(true, false, groups);
        forces = *data.forces;
        forceGroups = groups;
    }
    oldPositions = *data.positions;
    oldVelocities = *data.velocities;
    double oldTime = data.time;
    HelfrichStream oldStream = stream == nullptr ? HelfrichStream() : *stream;
    try {
        advance(context, step, groups);
    } catch (...) {
        *data.positions = oldPositions;
        *data.velocities = oldVelocities;
        data.time = oldTime;
        if (stream != nullptr)
            *stream = oldStream;
        throw;
    }
    forces = *data.forces;
    stepCount = ++data.stepCount;
}

void VariableMassStepKernel::advance(ContextImpl& context, double step, int groups) {
    const double* box = findBox();
    HelfrichParticleArrays particles = getParticles();
    particles.forces = &forces[0][0];
    auto bathe = [&] {
        if (bath != nullptr)
            check(Helfrich_VariableMasses_bathe(subject.c_str(), masses, team, &particles, box, stream, 0.5 * step,
                                                bath->getFriction(), BOLTZ * bath->getTemperature()));
    };
    bathe();
    check(Helfrich_VariableMasses_begin(subject.c_str(), masses, team, &particles, box, step));
    data.time += step;
    if (hasVirtualSites)
        context.computeVirtualSites();
    context.calcForcesAndEnergy(true, false, groups);
    particles = getParticles();
    check(Helfrich_VariableMasses_finish(subject.c_str(), masses, team, &particles, box, step));
    bathe();
}

double VariableMassStepKernel::computeKineticEnergy(ContextImpl& context) {
    vector<double> present = computeMasses(context);
    double sum = 0;
    for (size_t i = 0; i < present.size(); i++) {
        const Vec3& velocity = (*data.velocities)[i];
        sum += 0.5 * present[i] * velocity.dot(velocity);
    }
    return sum;
}

vector<double> VariableMassStepKernel::computeMasses(ContextImpl& context) {
    findPresentSurfaces(context);
    vector<double> present(data.numParticles);
    HelfrichParticleArrays particles = getParticles();
    check(Helfrich_VariableMasses_get(subject.c_str(), masses, &particles, findBox(), present.data()));
    return present;
}

void VariableMassStepKernel::createCheckpoint(std::ostream& out) const {
    if (stream != &ownStream)
        return;
    out.write(reinterpret_cast<const char*>(&STREAM_MARK), sizeof(STREAM_MARK));
    out.write(reinterpret_cast<const char*>(&ownStream), sizeof(ownStream));
}

void VariableMassStepKernel::loadCheckpoint(std::istream& in) {
    // As with other integrators, a checkpoint may be that of another one; the random numbers stay as they are then.
    if (stream != &ownStream || in.peek() == std::istream::traits_type::eof())
        return;
    uint32_t mark = 0;
    HelfrichStream saved = {};
    in.read(reinterpret_cast<char*>(&mark), sizeof(mark));
    in.read(reinterpret_cast<char*>(&saved), sizeof(saved));
    if (!in || mark != STREAM_MARK)
        throw OpenMMException(subject +
                              ": loadCheckpoint: the checkpoint has no random numbers of this integrator; it " +
                              "is damaged, or of another version of openmm-helfrich");
    ownStream = saved;
}
