#include "NativeDevice.h"

#include <NativeCodes.h>
#include <openmm/Platform.h>
#include <openmm/System.h>
#include <openmm/common/ComputeForceInfo.h>
#include <openmm/common/ContextSelector.h>
#include <openmm/cuda/CudaPlatform.h>
#include <openmm/hip/HipPlatform.h>
#include <openmm/opencl/OpenCLPlatform.h>

#include <algorithm>
#include <climits>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::NativeCodes;
using namespace OpenMM;
using std::map;
using std::pair;
using std::shared_ptr;
using std::string;
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

const int groupSize = GROUP_SIZE, largestBlock = GROUP_SIZE * GROUPS_OF_BLOCK;
/** Up to so many vertices one block is faster than two kernels. */
const int64_t verticesOfOneBlock = 2048;
/** Bytes of a target and of a run. */
const int64_t fourWords = 4 * sizeof(int);

template <class Platform>
ComputeContext* findOn(ContextImpl& context) {
    auto& contexts = static_cast<typename Platform::PlatformData*>(context.getPlatformData())->contexts;
    // The Contexts of each platform begin with a ComputeContext. Here they are declared only.
    return contexts.size() == 1 ? reinterpret_cast<ComputeContext*>(contexts[0]) : nullptr;
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

void addArrays(const ComputeKernel& kernel, std::initializer_list<ArrayInterface*> arrays) {
    for (ArrayInterface* array : arrays)
        kernel->addArg(*array);
}

} // namespace

ComputeContext* NativeDevice::find(ContextImpl& context) {
    const string& name = context.getPlatform().getName();
    if (name == "OpenCL")
        return findOn<OpenCLPlatform>(context);
    if (name == "CUDA")
        return findOn<CudaPlatform>(context);
    if (name == "HIP")
        return findOn<HipPlatform>(context);
    return nullptr;
}

NativeDevice::NativeDevice(ContextImpl& context, const vector<pair<int, int>>& edges, const NativeDevice* sibling)
    : cc(*find(context)), version(0), turn(0), hasNewOrder(new bool(true)) {
    ContextSelector selector(cc);
    if (sibling != nullptr)
        program = sibling->program;
    else {
        map<string, string> defines;
        if (cc.getUseDoublePrecision())
            defines["HELFRICH_DOUBLE"] = "1";
        if (cc.getUseMixedPrecision())
            defines["HELFRICH_MIXED"] = "1";
        program = cc.compileProgram(Helfrich_Native_source(cc.getUseDoublePrecision()), defines);
    }
    // Both belong to OpenMM, which keeps them as long as the Context lives.
    cc.addForce(new Vertices(edges, context.getSystem().getNumParticles()));
    cc.getReorderListeners().push_back(new OrderListener(hasNewOrder));
}

NativeDevice::~NativeDevice() {
    // Arrays free memory of the device, which has to be the present one.
    ContextSelector selector(cc);
    buffers.clear();
    for (Array* array : {&slots, &anchors, &targets, &runs, &state})
        array->reset();
}

void NativeDevice::provide(Array& array, int64_t items, int64_t itemSize) {
    if (array == nullptr) {
        array.reset(cc.createArray());
        array->initialize(cc, (size_t) items, (int) itemSize, "helfrich");
    } else if ((int64_t) array->getSize() < items)
        array->resize((size_t) items);
}

void NativeDevice::upload(Array& array, const void* data, int64_t items, int64_t itemSize) {
    // OpenMM has no arrays without items.
    provide(array, std::max<int64_t>(items, 1), itemSize);
    if (items > 0)
        array->uploadSubArray(data, 0, (int) items);
}

void NativeDevice::provide(const HelfrichNative* native, const HelfrichNativePlan& plan) {
    bool isFirst = buffers.empty();
    buffers.resize(plan.numBuffers);
    versions.resize(plan.numBuffers, 0);
    for (int64_t i = 0; i < plan.numBuffers; i++) {
        HelfrichNativeBuffer buffer = Helfrich_Native_buffer(native, i);
        bool isTooSmall = buffers[i] == nullptr || (int64_t) buffers[i]->getSize() < buffer.items;
        provide(buffers[i], buffer.items, buffer.itemSize);
        if (buffer.data != nullptr && (isTooSmall || versions[i] != buffer.version)) {
            upload(buffers[i], buffer.data, buffer.dataSize / buffer.itemSize, buffer.itemSize);
            versions[i] = buffer.version;
        }
    }
    if (version != plan.version) {
        upload(targets, plan.targets, plan.numTargets, fourWords);
        upload(runs, plan.runs, plan.numRuns, fourWords);
        version = plan.version;
    }
    if (*hasNewOrder)
        uploadPlaces(plan);
    if (isFirst)
        makeKernels((int) plan.numVertices);
}

void NativeDevice::uploadPlaces(const HelfrichNativePlan& plan) {
    const vector<int>& order = cc.getAtomIndex();
    vector<int> places(order.size());
    for (size_t place = 0; place < order.size(); place++)
        places[order[place]] = (int) place;
    vector<int> own(plan.numVertices), first(plan.numVertices);
    for (int64_t vertex = 0; vertex < plan.numVertices; vertex++) {
        own[vertex] = places[plan.particles[vertex]];
        first[vertex] = places[plan.particles[plan.anchors[vertex]]];
    }
    upload(slots, own.data(), plan.numVertices, sizeof(int));
    upload(anchors, first.data(), plan.numVertices, sizeof(int));
    *hasNewOrder = false;
}

void NativeDevice::makeKernels(int numVertices) {
    const unsigned zeros[STATE_SIZE] = {};
    upload(state, zeros, STATE_SIZE, sizeof(unsigned));
    upload(buffers[ThinTriangles], zeros, 1, sizeof(unsigned));
    ArrayInterface& posq = cc.getPosq();
    ArrayInterface& correction = cc.getUseMixedPrecision() ? cc.getPosqCorrection() : posq;
    auto make = [&](const char* name, int numbers) {
        ComputeKernel kernel = program->createKernel(name);
        kernel->addArg(numVertices);
        // Numbers that each evaluation sets.
        for (int i = 0; i < numbers; i++)
            kernel->addArg(0);
        return kernel;
    };
    extent = make("h_find_extent", 1);
    addArrays(extent, {&posq, &correction, slots.get(), anchors.get(), state.get()});
    place = make("h_place", 3);
    extentAndPlace = make("h_find_extent_and_place", 1);
    for (const ComputeKernel& kernel : {place, extentAndPlace})
        addArrays(kernel,
                  {&posq, &correction, slots.get(), anchors.get(), targets.get(), state.get(), buffers[Frame].get(),
                   buffers[Positions].get(), buffers[BoxVectors].get()});
    forces = make("h_add_forces", 1);
    forces->addArg(cc.getPaddedNumAtoms());
    addArrays(forces,
              {slots.get(), buffers[Frame].get(), buffers[Rings].get(), buffers[CornerForces].get(),
               &cc.getLongForceBuffer()});
    sums = program->createKernel("h_add_sums");
    sums->addArg(0);
    sums->addArg((int) cc.getEnergyParamDerivNames().size());
    ArrayInterface& derivatives =
        cc.getEnergyParamDerivNames().empty() ? cc.getEnergyBuffer() : cc.getEnergyParamDerivBuffer();
    addArrays(sums,
              {runs.get(), buffers[Results].get(), &cc.getEnergyBuffer(), &derivatives, buffers[ThinTriangles].get(),
               state.get()});
}

void NativeDevice::execute(const ComputeKernel& kernel, int64_t groups) {
    // OpenMM starts so many blocks at most; where there are more groups, blocks have several of them.
    int blockSize = groups > cc.getNumThreadBlocks() ? getLargestBlock() : groupSize;
    kernel->execute((int) groups * groupSize, blockSize);
}

int NativeDevice::getLargestBlock() const {
    // A processor has no use for more threads at once.
    return cc.getIsCPU() || cc.getMaxThreadBlockSize() < largestBlock ? groupSize : largestBlock;
}

void NativeDevice::placeVertices(const HelfrichNativePlan& plan) {
    bool isKnown = plan.extent != INT_MIN;
    if (!isKnown && plan.numVertices <= verticesOfOneBlock) {
        extentAndPlace->setArg(1, plan.unit);
        int threads = getLargestBlock();
        extentAndPlace->execute(threads, threads);
        return;
    }
    int64_t groups = (plan.numVertices + groupSize - 1) / groupSize;
    place->setArg(1, plan.extent);
    place->setArg(2, plan.unit);
    place->setArg(3, isKnown ? -1 : turn);
    if (!isKnown) {
        extent->setArg(1, turn);
        execute(extent, groups);
        turn = 1 - turn;
    }
    execute(place, groups);
}

ComputeKernel& NativeDevice::findPass(const char* name) {
    ComputeKernel& kernel = passes[name];
    if (kernel == nullptr) {
        kernel = program->createKernel(name);
        kernel->addArg(0);
        for (const Array& buffer : buffers)
            kernel->addArg(*buffer);
    }
    return kernel;
}

void NativeDevice::run(const HelfrichNativePass& pass) {
    ComputeKernel& kernel = findPass(pass.name);
    kernel->setArg(0, (int) pass.groups);
    execute(kernel, pass.groups);
}

void NativeDevice::addForces(const HelfrichNativePlan& plan) {
    forces->setArg(1, plan.unit);
    execute(forces, (plan.numVertices + groupSize - 1) / groupSize);
}

void NativeDevice::addSums(const HelfrichNativePlan& plan, bool areWanted) {
    sums->setArg(0, areWanted ? (int) plan.numRuns : 0);
    execute(sums, 1);
}

unsigned NativeDevice::takeFaults() {
    unsigned words[STATE_SIZE];
    state->download(words);
    const unsigned none = 0;
    if (words[STATE_FAULTS] != 0)
        state->uploadSubArray(&none, STATE_FAULTS, 1);
    return words[STATE_FAULTS];
}
