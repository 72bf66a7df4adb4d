#ifndef HELFRICH_NATIVE_DEVICE_H_
#define HELFRICH_NATIVE_DEVICE_H_

#include "openmm-helfrich/internal/Core.h"

#include <openmm/common/ComputeContext.h>
#include <openmm/internal/ContextImpl.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace HelfrichPlugin {

/**
 * The arrays and kernels of one membrane on the device of OpenMM's platform OpenCL, CUDA or HIP.
 *
 * Of these platforms only virtual functions are called, so that neither their libraries nor their makers' headers are
 * needed to build this, and one library serves all of them.
 */
class NativeDevice {
public:
    /** The device of a Context; null if there are several, or its platform is none of these. */
    static OpenMM::ComputeContext* find(OpenMM::ContextImpl& context);
    /**
     * Compile the kernels.
     *
     * @param context  the Context, which has a device
     * @param edges    the pairs of particles that edges connect
     * @param sibling  one of the same Context, whose compiled program is used again, or null
     */
    NativeDevice(OpenMM::ContextImpl& context, const std::vector<std::pair<int, int>>& edges,
                 const NativeDevice* sibling);
    ~NativeDevice();
    NativeDevice(const NativeDevice&) = delete;
    NativeDevice& operator=(const NativeDevice&) = delete;
    OpenMM::ComputeContext& getContext() const {
        return cc;
    }
    /** Bring to the device what it lacks for an evaluation that has just been planned. */
    void provide(const HelfrichNative* native, const HelfrichNativePlan& plan);
    /** Bring OpenMM's positions into the form of the passes. */
    void placeVertices(const HelfrichNativePlan& plan);
    void run(const HelfrichNativePass& pass);
    /** Add the forces to OpenMM's. */
    void addForces(const HelfrichNativePlan& plan);
    /** Add energies and derivatives to OpenMM's, unless nobody wants them, and note what the passes have found. */
    void addSums(const HelfrichNativePlan& plan, bool areWanted);
    /** The faults that have been noted since this was asked last, as bits of NativeCodes. */
    unsigned takeFaults();

private:
    using Array = std::unique_ptr<OpenMM::ArrayInterface>;
    /** Make an array, or make it larger. */
    void provide(Array& array, int64_t items, int64_t itemSize);
    /** Let an array begin with some items. */
    void upload(Array& array, const void* data, int64_t items, int64_t itemSize);
    /** Note where OpenMM has the vertices. */
    void uploadPlaces(const HelfrichNativePlan& plan);
    void execute(const OpenMM::ComputeKernel& kernel, int64_t groups);
    int getLargestBlock() const;
    /** Make the kernels of OpenMM's platforms, once all arrays are there. */
    void makeKernels(int numVertices);
    OpenMM::ComputeKernel& findPass(const char* name);

    OpenMM::ComputeContext& cc;
    OpenMM::ComputeProgram program;
    OpenMM::ComputeKernel extent, place, extentAndPlace, forces, sums;
    /** By their names, of which the core has one each. */
    std::map<const char*, OpenMM::ComputeKernel> passes;
    std::vector<Array> buffers;
    /** The version of what is in each. */
    std::vector<uint64_t> versions;
    /** The place of each vertex among OpenMM's particles, and that of the first of its connected part. */
    Array slots, anchors;
    Array targets, runs, state;
    /** That of targets and runs. */
    uint64_t version;
    /** Which of two extents is the next evaluation's. */
    int turn;
    /** Whether OpenMM has put particles in another order. */
    std::shared_ptr<bool> hasNewOrder;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_NATIVE_DEVICE_H_*/
