#include "HelfrichKernels.h"
#include "MonteCarloMembraneTensionImpl.h"
#include "SharedMembrane.h"
#include "SurfaceViscosityThermostatImpl.h"
#include "VariableMassStepKernel.h"

#include <openmm/BrownianIntegrator.h>
#include <openmm/LangevinMiddleIntegrator.h>
#include <openmm/OpenMMException.h>
#include <openmm/System.h>
#include <openmm/VerletIntegrator.h>
#include <openmm/internal/ContextImpl.h>
#include <openmm/reference/ReferenceKernelFactory.h>
#include <openmm/reference/SimTKOpenMMRealType.h>

#include <algorithm>
#include <istream>
#include <ostream>
#include <sstream>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

namespace {

/** Starts what this platform adds to a checkpoint: random numbers, */
const uint32_t CHECKPOINT_MARK = 0x31464c48;
/** or these and then the connectivity of membranes that is not the System's, or may change. */
const uint32_t CONNECTIVITY_MARK = 0x32464c48;
/** or these, connectivity or none, and then what each MonteCarloMembraneTension has come to. */
const uint32_t TENSION_MARK = 0x33464c48;
/** or these, connectivity and tensions or none, and then what each SurfaceViscosityThermostat has come to. */
const uint32_t VISCOSITY_MARK = 0x34464c48;

Kernel createReferenceKernel(const string& name, const Platform& platform, ContextImpl& context) {
    return Kernel(ReferenceKernelFactory().createKernelImpl(name, platform, context));
}

bool findVirtualSites(const System& system) {
    for (int i = 0; i < system.getNumParticles(); i++)
        if (system.isVirtualSite(i))
            return true;
    return false;
}

template <class T>
void write(std::ostream& stream, const T& value) {
    stream.write(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <class T>
T read(std::istream& stream) {
    T value{};
    stream.read(reinterpret_cast<char*>(&value), sizeof(T));
    if (!stream)
        throw OpenMMException("loadCheckpoint: the checkpoint ends too early; it is damaged");
    return value;
}

/** Read so many bytes; a number that is damaged shall not take all memory. */
string readBytes(std::istream& stream, uint64_t size) {
    string bytes;
    while (bytes.size() < size) {
        size_t before = bytes.size();
        bytes.resize((size_t) std::min<uint64_t>(size, before + (1 << 20)));
        stream.read(&bytes[before], (std::streamsize) (bytes.size() - before));
        if (!stream)
            throw OpenMMException("loadCheckpoint: the checkpoint ends too early; it is damaged");
    }
    return bytes;
}

} // namespace

vector<string> HelfrichKernelFactory::getKernelNames() {
    return {CalcForcesAndEnergyKernel::Name(),   UpdateStateDataKernel::Name(),
            IntegrateVerletStepKernel::Name(),   IntegrateLangevinMiddleStepKernel::Name(),
            IntegrateBrownianStepKernel::Name(), IntegrateVariableMassStepKernel::Name()};
}

KernelImpl* HelfrichKernelFactory::createKernelImpl(string name, const Platform& platform, ContextImpl& context) const {
    if (name == CalcForcesAndEnergyKernel::Name())
        return new HelfrichCalcForcesAndEnergyKernel(name, platform, context);
    if (name == UpdateStateDataKernel::Name())
        return new HelfrichUpdateStateDataKernel(name, platform, context);
    if (name == IntegrateVerletStepKernel::Name())
        return new HelfrichIntegrateVerletStepKernel(name, platform, context);
    if (name == IntegrateLangevinMiddleStepKernel::Name())
        return new HelfrichIntegrateLangevinMiddleStepKernel(name, platform, context);
    if (name == IntegrateBrownianStepKernel::Name())
        return new HelfrichIntegrateBrownianStepKernel(name, platform, context);
    if (name == IntegrateVariableMassStepKernel::Name())
        return new VariableMassStepKernel(name, platform, context);
    throw OpenMMException("Platform Helfrich: there is no kernel called \"" + name + "\"");
}

HelfrichCalcForcesAndEnergyKernel::HelfrichCalcForcesAndEnergyKernel(const string& name, const Platform& platform,
                                                                     ContextImpl& context)
    : CalcForcesAndEnergyKernel(name, platform), data(*HelfrichPlatform::getData(context)),
      reference(createReferenceKernel(name, platform, context)), hasVirtualSites(false) {
}

void HelfrichCalcForcesAndEnergyKernel::initialize(const System& system) {
    reference.getAs<CalcForcesAndEnergyKernel>().initialize(system);
    hasVirtualSites = findVirtualSites(system);
}

void HelfrichCalcForcesAndEnergyKernel::beginComputation(ContextImpl& context, bool includeForce, bool includeEnergy,
                                                         int groups) {
    data.crowd.begin();
    if (!includeForce || hasVirtualSites)
        return reference.getAs<CalcForcesAndEnergyKernel>().beginComputation(context, includeForce, includeEnergy,
                                                                             groups);
    check(Helfrich_Dynamics_clear(data.findTeam(), data.numParticles, &(*data.forces)[0][0]));
    for (const auto& parameter : context.getParameters())
        (*data.energyParameterDerivatives)[parameter.first] = 0;
}

double HelfrichCalcForcesAndEnergyKernel::finishComputation(ContextImpl& context, bool includeForce, bool includeEnergy,
                                                            int groups, bool& valid) {
    if (!includeForce || hasVirtualSites)
        return reference.getAs<CalcForcesAndEnergyKernel>().finishComputation(context, includeForce, includeEnergy,
                                                                              groups, valid);
    return 0;
}

HelfrichUpdateStateDataKernel::HelfrichUpdateStateDataKernel(const string& name, const Platform& platform,
                                                             ContextImpl& context)
    : UpdateStateDataKernel(name, platform), data(*HelfrichPlatform::getData(context)),
      kernel(createReferenceKernel(name, platform, context)), reference(kernel.getAs<UpdateStateDataKernel>()) {
}

void HelfrichUpdateStateDataKernel::initialize(const System& system) {
    reference.initialize(system);
}

double HelfrichUpdateStateDataKernel::getTime(const ContextImpl& context) const {
    return reference.getTime(context);
}

void HelfrichUpdateStateDataKernel::setTime(ContextImpl& context, double time) {
    reference.setTime(context, time);
}

long long HelfrichUpdateStateDataKernel::getStepCount(const ContextImpl& context) const {
    return reference.getStepCount(context);
}

void HelfrichUpdateStateDataKernel::setStepCount(const ContextImpl& context, long long count) {
    reference.setStepCount(context, count);
}

void HelfrichUpdateStateDataKernel::getPositions(ContextImpl& context, vector<Vec3>& positions, bool allowPeriodic) {
    reference.getPositions(context, positions, allowPeriodic);
}

void HelfrichUpdateStateDataKernel::setPositions(ContextImpl& context, const vector<Vec3>& positions) {
    reference.setPositions(context, positions);
}

void HelfrichUpdateStateDataKernel::getVelocities(ContextImpl& context, vector<Vec3>& velocities) {
    reference.getVelocities(context, velocities);
}

void HelfrichUpdateStateDataKernel::setVelocities(ContextImpl& context, const vector<Vec3>& velocities) {
    reference.setVelocities(context, velocities);
}

void HelfrichUpdateStateDataKernel::computeShiftedVelocities(ContextImpl& context, double timeShift,
                                                             vector<Vec3>& velocities) {
    reference.computeShiftedVelocities(context, timeShift, velocities);
}

void HelfrichUpdateStateDataKernel::getForces(ContextImpl& context, vector<Vec3>& forces) {
    reference.getForces(context, forces);
}

void HelfrichUpdateStateDataKernel::getEnergyParameterDerivatives(ContextImpl& context,
                                                                  std::map<string, double>& derivs) {
    reference.getEnergyParameterDerivatives(context, derivs);
}

void HelfrichUpdateStateDataKernel::getPeriodicBoxVectors(ContextImpl& context, Vec3& a, Vec3& b, Vec3& c) const {
    reference.getPeriodicBoxVectors(context, a, b, c);
}

void HelfrichUpdateStateDataKernel::setPeriodicBoxVectors(ContextImpl& context, const Vec3& a, const Vec3& b,
                                                          const Vec3& c) {
    reference.setPeriodicBoxVectors(context, a, b, c);
}

void HelfrichUpdateStateDataKernel::createCheckpoint(ContextImpl& context, std::ostream& stream) {
    reference.createCheckpoint(context, stream);
    vector<string> connectivity = SharedMembrane::saveAll(context);
    vector<TensionState> tensions = MonteCarloMembraneTensionImpl::saveAll(context);
    vector<ViscosityState> viscosities = SurfaceViscosityThermostatImpl::saveAll(context);
    uint32_t mark = !viscosities.empty() ? VISCOSITY_MARK
        : !tensions.empty()              ? TENSION_MARK
        : !connectivity.empty()          ? CONNECTIVITY_MARK
                                         : CHECKPOINT_MARK;
    write(stream, mark);
    write(stream, (uint32_t) data.streams.size());
    for (const HelfrichStream& random : data.streams)
        write(stream, random);
    if (mark == CHECKPOINT_MARK)
        return;
    write(stream, (uint32_t) connectivity.size());
    for (const string& saved : connectivity) {
        write(stream, (uint64_t) saved.size());
        stream.write(saved.data(), (std::streamsize) saved.size());
    }
    if (mark == CONNECTIVITY_MARK)
        return;
    write(stream, (uint32_t) tensions.size());
    for (const TensionState& state : tensions)
        write(stream, state);
    if (mark == TENSION_MARK)
        return;
    write(stream, (uint32_t) viscosities.size());
    for (const ViscosityState& state : viscosities)
        write(stream, state);
}

void HelfrichUpdateStateDataKernel::loadCheckpoint(ContextImpl& context, std::istream& stream) {
    // What is refused leaves all as it was but the Context's parameters, which OpenMM has read before.
    std::stringstream before(std::ios::in | std::ios::out | std::ios::binary);
    reference.createCheckpoint(context, before);
    vector<HelfrichStream> streams(data.streams.begin(), data.streams.end());
    try {
        reference.loadCheckpoint(context, stream);
        loadOurs(context, stream);
    } catch (...) {
        reference.loadCheckpoint(context, before);
        std::copy(streams.begin(), streams.end(), data.streams.begin());
        throw;
    }
}

void HelfrichUpdateStateDataKernel::loadOurs(ContextImpl& context, std::istream& stream) {
    auto mark = read<uint32_t>(stream);
    if (mark != CHECKPOINT_MARK && mark != CONNECTIVITY_MARK && mark != TENSION_MARK && mark != VISCOSITY_MARK)
        throw OpenMMException("loadCheckpoint: the checkpoint has no random numbers of platform Helfrich; it is "
                              "damaged, or of another version of openmm-helfrich");
    // As with other platforms, a checkpoint may go on with another integrator; its streams stay as they are.
    uint32_t count = read<uint32_t>(stream);
    for (uint32_t i = 0; i < count; i++) {
        HelfrichStream random = read<HelfrichStream>(stream);
        if (i < data.streams.size())
            data.streams[i] = random;
    }
    vector<string> connectivity;
    if (mark != CHECKPOINT_MARK)
        for (uint32_t left = read<uint32_t>(stream); left > 0; left--)
            connectivity.push_back(readBytes(stream, read<uint64_t>(stream)));
    vector<TensionState> tensions;
    if (mark == TENSION_MARK || mark == VISCOSITY_MARK)
        for (uint32_t left = read<uint32_t>(stream); left > 0; left--)
            tensions.push_back(read<TensionState>(stream));
    vector<ViscosityState> viscosities;
    if (mark == VISCOSITY_MARK)
        for (uint32_t left = read<uint32_t>(stream); left > 0; left--)
            viscosities.push_back(read<ViscosityState>(stream));
    SharedMembrane::restoreAll("loadCheckpoint", context, connectivity);
    MonteCarloMembraneTensionImpl::restoreAll(context, tensions);
    SurfaceViscosityThermostatImpl::restoreAll(context, viscosities);
}

TimeStep::TimeStep(const string& name, const Platform& platform, ContextImpl& context)
    : data(*HelfrichPlatform::getData(context)), reference(createReferenceKernel(name, platform, context)),
      dynamics(nullptr) {
}

TimeStep::~TimeStep() {
    Helfrich_Dynamics_destroy(dynamics);
}

void TimeStep::initialize(const System& system) {
    if (system.getNumConstraints() > 0 || findVirtualSites(system))
        return;
    vector<double> masses;
    for (int i = 0; i < system.getNumParticles(); i++)
        masses.push_back(system.getParticleMass(i));
    check(Helfrich_Dynamics_create((int64_t) masses.size(), masses.data(), &dynamics));
}

HelfrichParticleArrays TimeStep::getParticles() const {
    return {data.numParticles, &(*data.positions)[0][0], &(*data.velocities)[0][0], &(*data.forces)[0][0]};
}

void TimeStep::advance(double time) {
    data.time += time;
    data.stepCount++;
}

HelfrichIntegrateVerletStepKernel::HelfrichIntegrateVerletStepKernel(const string& name, const Platform& platform,
                                                                     ContextImpl& context)
    : IntegrateVerletStepKernel(name, platform), step(name, platform, context) {
}

void HelfrichIntegrateVerletStepKernel::initialize(const System& system, const VerletIntegrator& integrator) {
    step.reference.getAs<IntegrateVerletStepKernel>().initialize(system, integrator);
    step.initialize(system);
}

void HelfrichIntegrateVerletStepKernel::execute(ContextImpl& context, const VerletIntegrator& integrator) {
    if (step.isDelegated())
        return step.reference.getAs<IntegrateVerletStepKernel>().execute(context, integrator);
    HelfrichParticleArrays particles = step.getParticles();
    check(Helfrich_Dynamics_verlet(step.dynamics, step.data.findTeam(), &particles, integrator.getStepSize()));
    step.advance(integrator.getStepSize());
}

double HelfrichIntegrateVerletStepKernel::computeKineticEnergy(ContextImpl& context,
                                                               const VerletIntegrator& integrator) {
    return step.reference.getAs<IntegrateVerletStepKernel>().computeKineticEnergy(context, integrator);
}

HelfrichIntegrateLangevinMiddleStepKernel::HelfrichIntegrateLangevinMiddleStepKernel(const string& name,
                                                                                     const Platform& platform,
                                                                                     ContextImpl& context)
    : IntegrateLangevinMiddleStepKernel(name, platform), step(name, platform, context), stream(nullptr) {
}

void HelfrichIntegrateLangevinMiddleStepKernel::initialize(const System& system,
                                                           const LangevinMiddleIntegrator& integrator) {
    step.reference.getAs<IntegrateLangevinMiddleStepKernel>().initialize(system, integrator);
    step.initialize(system);
    stream = &step.data.addStream(integrator.getRandomNumberSeed());
}

void HelfrichIntegrateLangevinMiddleStepKernel::execute(ContextImpl& context,
                                                        const LangevinMiddleIntegrator& integrator) {
    if (step.isDelegated())
        return step.reference.getAs<IntegrateLangevinMiddleStepKernel>().execute(context, integrator);
    HelfrichParticleArrays particles = step.getParticles();
    check(Helfrich_Dynamics_langevinMiddle(step.dynamics, step.data.findTeam(), &particles, stream,
                                           integrator.getStepSize(), integrator.getFriction(),
                                           BOLTZ * integrator.getTemperature()));
    step.advance(integrator.getStepSize());
}

double HelfrichIntegrateLangevinMiddleStepKernel::computeKineticEnergy(ContextImpl& context,
                                                                       const LangevinMiddleIntegrator& integrator) {
    return step.reference.getAs<IntegrateLangevinMiddleStepKernel>().computeKineticEnergy(context, integrator);
}

HelfrichIntegrateBrownianStepKernel::HelfrichIntegrateBrownianStepKernel(const string& name, const Platform& platform,
                                                                         ContextImpl& context)
    : IntegrateBrownianStepKernel(name, platform), step(name, platform, context), stream(nullptr) {
}

void HelfrichIntegrateBrownianStepKernel::initialize(const System& system, const BrownianIntegrator& integrator) {
    step.reference.getAs<IntegrateBrownianStepKernel>().initialize(system, integrator);
    step.initialize(system);
    stream = &step.data.addStream(integrator.getRandomNumberSeed());
}

void HelfrichIntegrateBrownianStepKernel::execute(ContextImpl& context, const BrownianIntegrator& integrator) {
    if (step.isDelegated())
        return step.reference.getAs<IntegrateBrownianStepKernel>().execute(context, integrator);
    HelfrichParticleArrays particles = step.getParticles();
    check(Helfrich_Dynamics_brownian(step.dynamics, step.data.findTeam(), &particles, stream, integrator.getStepSize(),
                                     integrator.getFriction(), BOLTZ * integrator.getTemperature()));
    step.advance(integrator.getStepSize());
}

double HelfrichIntegrateBrownianStepKernel::computeKineticEnergy(ContextImpl& context,
                                                                 const BrownianIntegrator& integrator) {
    return step.reference.getAs<IntegrateBrownianStepKernel>().computeKineticEnergy(context, integrator);
}
