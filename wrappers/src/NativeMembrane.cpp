#include "NativeMembrane.h"

#include <NativeCodes.h>
#include <openmm/Platform.h>
#include <openmm/System.h>
#include <openmm/common/ContextSelector.h>

#include <algorithm>
#include <iostream>
#include <mutex>
#include <set>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::NativeCodes;
using namespace OpenMM;
using std::pair;
using std::string;
using std::vector;

namespace {

/** Without a wish for energies, faults are looked for after so many evaluations. */
const int evaluationsBetweenChecks = 1000;

/** The Systems of all NativeMembranes; never destroyed, since a Context may be a variable of the program. */
std::mutex systemsMutex;
auto& systems = *new std::multiset<const System*>();

} // namespace

string NativeMembrane::whyNot(ContextImpl& context) {
    const string& name = context.getPlatform().getName();
    if (name != "OpenCL" && name != "CUDA" && name != "HIP")
        return "the platform " + name + " is none of OpenCL, CUDA and HIP; name one of them";
    return NativeDevice::find(context) == nullptr ? "the Context uses several devices" : "";
}

bool NativeMembrane::isOnProcessor(ContextImpl& context) {
    return NativeDevice::find(context)->getIsCPU();
}

NativeMembrane::NativeMembrane(ContextImpl& context, HelfrichMembrane* core, const vector<pair<int, int>>& edges,
                               const NativeMembrane* sibling)
    : core(core), native(nullptr), system(&context.getSystem()),
      device(context, edges, sibling == nullptr ? nullptr : &sibling->device), unchecked(0) {
    native = Helfrich_Native_create(device.getContext().getUseDoublePrecision());
    std::lock_guard<std::mutex> lock(systemsMutex);
    systems.insert(system);
}

NativeMembrane::~NativeMembrane() {
    Helfrich_Native_destroy(native);
    std::lock_guard<std::mutex> lock(systemsMutex);
    systems.erase(systems.find(system));
}

bool NativeMembrane::isElsewhere(const System& system) {
    std::lock_guard<std::mutex> lock(systemsMutex);
    return systems.count(&system) != 0;
}

void NativeMembrane::requestDerivative(const string& parameter) {
    device.getContext().addEnergyParameterDerivative(parameter);
}

int NativeMembrane::findDerivative(const string& parameter) const {
    const vector<string>& names = device.getContext().getEnergyParamDerivNames();
    return (int) (std::find(names.begin(), names.end(), parameter) - names.begin());
}

void NativeMembrane::look(const string& subject, ContextImpl& context, const vector<HelfrichTerm>& terms,
                          const double* box) {
    vector<Vec3> positions;
    context.getPositions(positions);
    check(Helfrich_Native_look(subject.c_str(), native, core, terms.data(), (int64_t) terms.size(),
                               (int64_t) positions.size(), reinterpret_cast<const double*>(positions.data()), box));
}

void NativeMembrane::evaluate(const string& subject, ContextImpl& context, const vector<HelfrichTerm>& terms,
                              const vector<int>& derivatives, bool forces, bool wantsSums, bool isAsked,
                              const double* box) {
    ContextSelector selector(device.getContext());
    if (Helfrich_Native_mustLook(native, core, terms.data(), (int64_t) terms.size()))
        look(subject, context, terms, box);
    HelfrichNativePlan plan;
    check(Helfrich_Native_plan(subject.c_str(), native, core, box, terms.data(), (int64_t) terms.size(), wantsSums,
                               forces, derivatives.data(), &plan));
    device.provide(native, plan);
    device.placeVertices(plan);
    for (int64_t i = 0; i < plan.numPasses; i++)
        device.run(Helfrich_Native_pass(native, i));
    if (forces)
        device.addForces(plan);
    bool isDue = isAsked || ++unchecked >= evaluationsBetweenChecks;
    // It also notes what the passes have found.
    if (wantsSums || isDue)
        device.addSums(plan, wantsSums);
    Helfrich_Native_count();
    if (isDue)
        checkFaults(subject, context, terms, box);
}

void NativeMembrane::checkFaults(const string& subject, ContextImpl& context, const vector<HelfrichTerm>& terms,
                                 const double* box) {
    unchecked = 0;
    unsigned faults = device.takeFaults();
    if (faults == 0)
        return;
    look(subject, context, terms, box);
    // What the processor has no complaint about now may have been otherwise before.
    if (faults & FAULT_POSITION)
        throw OpenMMException(subject + ": since the energy was asked for last, a position was not finite, or the " +
                              "membrane had no size or one beyond all others; use a smaller time step");
    if (faults & FAULT_TARGET)
        throw OpenMMException(subject + ": a target area or volume is too large for the membrane; check its unit");
    static std::once_flag saidLarge, saidThin;
    // OpenMM's minimizer gets on with infinite energies, so this is no error.
    if (faults & FAULT_ENERGY)
        std::call_once(saidLarge, [&] {
            std::cerr
                << "openmm-helfrich: an energy of the membrane is beyond 3e38 kJ/mol, where single precision ends; "
                   "choose the Precision \"double\", or the backend \"cpu\"\n";
        });
    if (!(faults & FAULT_THIN))
        return;
    std::call_once(saidThin, [&] {
        std::cerr
            << "openmm-helfrich: the height of a triangle is below a thousandth of its longest side, of which single "
               "precision misses digits (2e-4 of the largest force at 1e-4 of the side); choose the Precision "
               "\"double\", or the backend \"cpu\"\n";
    });
}
