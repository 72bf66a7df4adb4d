#include "NativeMembrane.h"

#include <openmm/Platform.h>
#include <openmm/System.h>
#include <openmm/common/ComputeContext.h>
#include <openmm/common/ComputeForceInfo.h>
#include <openmm/common/ContextSelector.h>
#include <openmm/cuda/CudaPlatform.h>
#include <openmm/hip/HipPlatform.h>
#include <openmm/opencl/OpenCLPlatform.h>

#include <algorithm>
#include <climits>
#include <iostream>
#include <map>
#include <mutex>
#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::pair;
using std::shared_ptr;
using std::string;
using std::unique_ptr;
using std::vector;

// OpenMM defines these in the library of each platform, none of which is linked here.
bool ComputeForceInfo::areParticlesIdentical(int, int) {
    return true;
}
int ComputeForceInfo::getNumParticleGroups() {
    return 0;
}
void ComputeForceInfo::getParticlesInGroup(int, vector<int>&) {
}
bool ComputeForceInfo::areGroupsIdentical(int, int) {
    return true;
}

namespace {

/** Threads of a group, as src/evaluator/gpu/interface.rs has it, and of the largest block, as the kernels have it. */
const int groupSize = 64, largestBlock = 256;
/** Without a wish for energies, faults are looked for after so many evaluations. */
const int evaluationsBetweenChecks = 1000;
/** Words of the kernels' state: two extents that take turns, faults, and one that nobody uses. */
const int stateSize = 4;
/** Buffers, as src/evaluator/gpu/interface.rs numbers them. */
const int frameBuffer = 0, positionsBuffer = 1, boxBuffer = 2, ringsBuffer = 6, cornerForcesBuffer = 12,
          resultsBuffer = 14, thinBuffer = 15;
/** Below so many vertices one group is faster than two kernels. */
const int64_t verticesOfOneGroup = 2048;

template <class Platform>
ComputeContext* findDevice(ContextImpl& context) {
    auto& contexts = static_cast<typename Platform::PlatformData*>(context.getPlatformData())->contexts;
    // The Contexts of each platform begin with a ComputeContext. Here they are declared only.
    return contexts.size() == 1 ? reinterpret_cast<ComputeContext*>(contexts[0]) : nullptr;
}

/** The device of a Context on a GPU platform; null if there are several, or the platform is another. */
ComputeContext* findDevice(ContextImpl& context) {
    const string& name = context.getPlatform().getName();
    if (name == "OpenCL")
        return findDevice<OpenCLPlatform>(context);
    if (name == "CUDA")
        return findDevice<CudaPlatform>(context);
    if (name == "HIP")
        return findDevice<HipPlatform>(context);
    return nullptr;
}

/** Keeps OpenMM from exchanging vertices, and a membrane in one piece where molecules are wrapped into a box. */
class Vertices : public ComputeForceInfo {
public:
    Vertices(const vector<pair<int, int>>& edges, int numParticles) : edges(edges), isVertex(numParticles, false) {
        for (const auto& edge : edges)
            isVertex[edge.first] = isVertex[edge.second] = true;
    }
    bool areParticlesIdentical(int particle1, int particle2) {
        return particle1 == particle2 || !(isVertex[particle1] || isVertex[particle2]);
    }
    int getNumParticleGroups() {
        return (int) edges.size();
    }
    void getParticlesInGroup(int index, vector<int>& particles) {
        particles = {edges[index].first, edges[index].second};
    }
    bool areGroupsIdentical(int, int) {
        return false;
    }

private:
    vector<pair<int, int>> edges;
    vector<bool> isVertex;
};

/** The Systems of all NativeMembranes; never destroyed, since a Context may be a variable of the program. */
std::mutex systemsMutex;
auto& systems = *new std::multiset<const System*>();

/** Notes that OpenMM has put particles in another order. */
class OrderListener : public ComputeContext::ReorderListener {
public:
    explicit OrderListener(shared_ptr<bool> isNew) : isNew(isNew) {
    }
    void execute() {
        *isNew = true;
    }

private:
    shared_ptr<bool> isNew;
};

} // namespace

struct NativeMembrane::Device {
    ComputeContext& cc;
    ComputeProgram program;
    map<string, ComputeKernel> kernels;
    vector<unique_ptr<ArrayInterface>> buffers;
    /** The version of what is in each. */
    vector<uint64_t> versions;
    unique_ptr<ArrayInterface> slots, anchors, targets, runs, state;
    uint64_t version;
    shared_ptr<bool> hasNewOrder;

    explicit Device(ComputeContext& cc) : cc(cc), version(0), hasNewOrder(new bool(true)) {
    }
    ~Device() {
        // Arrays free memory of the device, which has to be the present one.
        ContextSelector selector(cc);
        kernels.clear();
        buffers.clear();
        for (auto* array : {&slots, &anchors, &targets, &runs, &state})
            array->reset();
    }
    /** Make an array, or make it larger. */
    void provide(unique_ptr<ArrayInterface>& array, int64_t items, int64_t itemSize) {
        if (array == nullptr) {
            array.reset(cc.createArray());
            array->initialize(cc, (size_t) items, (int) itemSize, "helfrich");
        } else if ((int64_t) array->getSize() < items)
            array->resize((size_t) items);
    }
    template <class T>
    void upload(unique_ptr<ArrayInterface>& array, const T* data, int64_t items, int64_t itemSize) {
        provide(array, std::max<int64_t>(items, 1), itemSize);
        if (items > 0)
            array->uploadSubArray(data, 0, (int) items);
    }
    /** OpenMM starts so many blocks at most; where there are more groups, blocks have several of them. */
    void run(const char* kernel, int64_t groups) {
        int blockSize = groups > cc.getNumThreadBlocks() ? getLargestBlock() : groupSize;
        kernels.at(kernel)->execute((int) groups * groupSize, blockSize);
    }
    int getLargestBlock() const {
        // A processor has no use for more threads at once.
        return cc.getIsCPU() || cc.getMaxThreadBlockSize() < largestBlock ? groupSize : largestBlock;
    }
};

bool NativeMembrane::isOnProcessor(ContextImpl& context) {
    return findDevice(context)->getIsCPU();
}

string NativeMembrane::whyNot(ContextImpl& context) {
    const string& name = context.getPlatform().getName();
    if (name != "OpenCL" && name != "CUDA" && name != "HIP")
        return "the platform " + name + " is none of OpenCL, CUDA and HIP; name one of them";
    ComputeContext* cc = findDevice(context);
    if (cc == nullptr)
        return "the Context uses several devices";
    return "";
}

NativeMembrane::NativeMembrane(ContextImpl& context, HelfrichMembrane* core, const vector<pair<int, int>>& edges,
                               const NativeMembrane* sibling)
    : core(core), native(nullptr), device(new Device(*findDevice(context))), unchecked(0), turn(0) {
    ComputeContext& cc = device->cc;
    ContextSelector selector(cc);
    bool isDouble = cc.getUseDoublePrecision();
    if (sibling != nullptr)
        device->program = sibling->device->program;
    else {
        map<string, string> defines;
        if (isDouble)
            defines["HELFRICH_DOUBLE"] = "1";
        if (cc.getUseMixedPrecision())
            defines["HELFRICH_MIXED"] = "1";
        device->program = cc.compileProgram(Helfrich_Native_source(isDouble), defines);
    }
    for (const char* name :
         {"triangles_forward", "triangles_forward_summed", "totals_forward", "edges_forward", "edges_forward_summed",
          "vertices_forward", "vertices_forward_summed", "triangles_backward", "triangles_backward_summed",
          "h_find_extent", "h_place", "h_find_extent_and_place", "h_add_forces", "h_add_sums"})
        device->kernels[name] = device->program->createKernel(name);
    cc.addForce(new Vertices(edges, context.getSystem().getNumParticles()));
    cc.getReorderListeners().push_back(new OrderListener(device->hasNewOrder));
    native = Helfrich_Native_create(isDouble);
    system = &context.getSystem();
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
    device->cc.addEnergyParameterDerivative(parameter);
}

int NativeMembrane::findDerivative(const string& parameter) const {
    const vector<string>& names = device->cc.getEnergyParamDerivNames();
    return (int) (std::find(names.begin(), names.end(), parameter) - names.begin());
}

void NativeMembrane::look(const string& subject, ContextImpl& context, const vector<HelfrichTerm>& terms,
                          const double* box) {
    vector<Vec3> positions;
    context.getPositions(positions);
    check(Helfrich_Native_look(subject.c_str(), native, core, terms.data(), (int64_t) terms.size(),
                               (int64_t) positions.size(), reinterpret_cast<const double*>(positions.data()), box));
}

void NativeMembrane::provide(const HelfrichNativePlan& plan) {
    ComputeContext& cc = device->cc;
    auto& buffers = device->buffers;
    bool isFirst = buffers.empty();
    buffers.resize(plan.numBuffers);
    device->versions.resize(plan.numBuffers, 0);
    for (int64_t i = 0; i < plan.numBuffers; i++) {
        HelfrichNativeBuffer buffer = Helfrich_Native_buffer(native, i);
        bool isTooSmall = buffers[i] == nullptr || (int64_t) buffers[i]->getSize() < buffer.items;
        device->provide(buffers[i], buffer.items, buffer.itemSize);
        if (buffer.data != nullptr && (isTooSmall || device->versions[i] != buffer.version)) {
            buffers[i]->uploadSubArray(buffer.data, 0, (int) (buffer.dataSize / buffer.itemSize));
            device->versions[i] = buffer.version;
        }
    }
    if (device->version != plan.version) {
        device->upload(device->targets, plan.targets, plan.numTargets, 4 * sizeof(int));
        device->upload(device->runs, plan.runs, plan.numRuns, 4 * sizeof(int));
        device->version = plan.version;
    }
    if (*device->hasNewOrder) {
        const vector<int>& order = cc.getAtomIndex();
        vector<int> places(order.size());
        for (size_t place = 0; place < order.size(); place++)
            places[order[place]] = (int) place;
        vector<int> slots(plan.numVertices), anchors(plan.numVertices);
        for (int64_t vertex = 0; vertex < plan.numVertices; vertex++) {
            slots[vertex] = places[plan.particles[vertex]];
            anchors[vertex] = places[plan.particles[plan.anchors[vertex]]];
        }
        device->upload(device->slots, slots.data(), plan.numVertices, sizeof(int));
        device->upload(device->anchors, anchors.data(), plan.numVertices, sizeof(int));
        *device->hasNewOrder = false;
    }
    if (!isFirst)
        return;
    const int zeros[stateSize] = {};
    device->upload(device->state, zeros, stateSize, sizeof(int));
    buffers[thinBuffer]->uploadSubArray(zeros, 0, 1);
    ArrayInterface& posq = cc.getPosq();
    ArrayInterface& correction = cc.getUseMixedPrecision() ? cc.getPosqCorrection() : posq;
    int vertices = (int) plan.numVertices;
    for (auto& entry : device->kernels) {
        if (entry.first.compare(0, 2, "h_") == 0)
            continue;
        entry.second->addArg(0);
        for (auto& buffer : buffers)
            entry.second->addArg(*buffer);
    }
    ComputeKernel extent = device->kernels["h_find_extent"];
    extent->addArg(vertices);
    extent->addArg(0);
    for (ArrayInterface* array : {&posq, &correction, device->slots.get(), device->anchors.get(), device->state.get()})
        extent->addArg(*array);
    ComputeKernel place = device->kernels["h_place"], both = device->kernels["h_find_extent_and_place"];
    place->addArg(vertices);
    place->addArg(0);
    place->addArg(0);
    both->addArg(vertices);
    for (const ComputeKernel& kernel : {place, both}) {
        kernel->addArg(0);
        for (ArrayInterface* array : {&posq, &correction, device->slots.get(), device->anchors.get(),
                                      device->targets.get(), device->state.get(), buffers[frameBuffer].get(),
                                      buffers[positionsBuffer].get(), buffers[boxBuffer].get()})
            kernel->addArg(*array);
    }
    ComputeKernel forces = device->kernels["h_add_forces"];
    forces->addArg(vertices);
    forces->addArg(0);
    forces->addArg(cc.getPaddedNumAtoms());
    for (ArrayInterface* array : {device->slots.get(), buffers[frameBuffer].get(), buffers[ringsBuffer].get(),
                                  buffers[cornerForcesBuffer].get(), &cc.getLongForceBuffer()})
        forces->addArg(*array);
    ComputeKernel sums = device->kernels["h_add_sums"];
    sums->addArg(0);
    sums->addArg(0);
    ArrayInterface& derivatives =
        cc.getEnergyParamDerivNames().empty() ? cc.getEnergyBuffer() : cc.getEnergyParamDerivBuffer();
    for (ArrayInterface* array : {device->runs.get(), buffers[resultsBuffer].get(), &cc.getEnergyBuffer(), &derivatives,
                                  buffers[thinBuffer].get(), device->state.get()})
        sums->addArg(*array);
}

void NativeMembrane::evaluate(const string& subject, ContextImpl& context, const vector<HelfrichTerm>& terms,
                              const vector<int>& derivatives, bool forces, bool wantsSums, bool isAsked,
                              const double* box) {
    ContextSelector selector(device->cc);
    if (Helfrich_Native_mustLook(native, core, terms.data(), (int64_t) terms.size()))
        look(subject, context, terms, box);
    HelfrichNativePlan plan;
    check(Helfrich_Native_plan(subject.c_str(), native, core, box, terms.data(), (int64_t) terms.size(), wantsSums,
                               forces, derivatives.data(), &plan));
    provide(plan);
    int64_t groups = (plan.numVertices + groupSize - 1) / groupSize;
    ComputeKernel place = device->kernels["h_place"];
    if (plan.extent == INT_MIN && plan.numVertices <= verticesOfOneGroup) {
        device->kernels["h_find_extent_and_place"]->setArg(1, plan.unit);
        int threads = device->getLargestBlock();
        device->kernels["h_find_extent_and_place"]->execute(threads, threads);
    } else {
        place->setArg(1, plan.extent);
        place->setArg(2, plan.unit);
        place->setArg(3, -1);
        if (plan.extent == INT_MIN) {
            device->kernels["h_find_extent"]->setArg(1, turn);
            device->run("h_find_extent", groups);
            place->setArg(3, turn);
            turn = 1 - turn;
        }
        device->run("h_place", groups);
    }
    for (int64_t i = 0; i < plan.numPasses; i++) {
        HelfrichNativePass pass = Helfrich_Native_pass(native, i);
        device->kernels.at(pass.name)->setArg(0, (int) pass.groups);
        device->run(pass.name, pass.groups);
    }
    if (forces) {
        device->kernels["h_add_forces"]->setArg(1, plan.unit);
        device->run("h_add_forces", groups);
    }
    bool isDue = isAsked || ++unchecked >= evaluationsBetweenChecks;
    // It also notes what the passes have found.
    if (wantsSums || isDue) {
        device->kernels["h_add_sums"]->setArg(0, wantsSums ? (int) plan.numRuns : 0);
        device->kernels["h_add_sums"]->setArg(1, (int) device->cc.getEnergyParamDerivNames().size());
        device->run("h_add_sums", 1);
    }
    Helfrich_Native_count();
    if (isDue)
        checkFaults(subject, context, terms, box);
}

void NativeMembrane::checkFaults(const string& subject, ContextImpl& context, const vector<HelfrichTerm>& terms,
                                 const double* box) {
    unchecked = 0;
    int state[stateSize];
    device->state->download(state);
    int faults = state[2];
    if (faults == 0)
        return;
    const int none = 0;
    device->state->uploadSubArray(&none, 2, 1);
    look(subject, context, terms, box);
    // What the processor has no complaint about now may have been otherwise before.
    if (faults & 1)
        throw OpenMMException(subject + ": since the energy was asked for last, a position was not finite, or the " +
                              "membrane had no size or one beyond all others; use a smaller time step");
    if (faults & 2)
        throw OpenMMException(subject + ": a target area or volume is too large for the membrane; check its unit");
    static std::once_flag saidLarge, saidThin;
    // OpenMM's minimizer gets on with infinite energies, so this is no error.
    if (faults & 8)
        std::call_once(saidLarge, [&] {
            std::cerr
                << "openmm-helfrich: an energy of the membrane is beyond 3e38 kJ/mol, where single precision ends; "
                   "choose the Precision \"double\", or the backend \"cpu\"\n";
        });
    if (!(faults & 4))
        return;
    std::call_once(saidThin, [&] {
        std::cerr
            << "openmm-helfrich: the height of a triangle is below a thousandth of its longest side, of which single "
               "precision misses digits (2e-4 of the largest force at 1e-4 of the side); choose the Precision "
               "\"double\", or the backend \"cpu\"\n";
    });
}
