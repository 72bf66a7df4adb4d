#ifndef HELFRICH_NATIVE_MEMBRANE_H_
#define HELFRICH_NATIVE_MEMBRANE_H_

#include "NativeDevice.h"

#include <string>
#include <utility>
#include <vector>

namespace HelfrichPlugin {

/**
 * A membrane that OpenMM's platform OpenCL, CUDA or HIP evaluates itself: positions and forces stay on the device. What
 * is computed, Rust says (`src/evaluator/gpu/native.rs`); NativeDevice does it.
 */
class NativeMembrane {
public:
    /** Why a Context evaluates no membranes itself, or an empty text. */
    static std::string whyNot(OpenMM::ContextImpl& context);
    /** Whether the device of a Context, for which whyNot() is empty, is the processor. */
    static bool isOnProcessor(OpenMM::ContextImpl& context);
    /** Whether another Context of a System evaluates membranes itself. */
    static bool isElsewhere(const OpenMM::System& system);
    /**
     * Compile the kernels.
     *
     * @param context   the Context, for which whyNot() is empty
     * @param core      the membrane
     * @param edges     the pairs of particles that edges connect
     * @param sibling   one that the Context has already, whose compiled program is used again, or null
     */
    NativeMembrane(OpenMM::ContextImpl& context, HelfrichMembrane* core, const std::vector<std::pair<int, int>>& edges,
                   const NativeMembrane* sibling);
    ~NativeMembrane();
    NativeMembrane(const NativeMembrane&) = delete;
    NativeMembrane& operator=(const NativeMembrane&) = delete;
    /** Have the platform compute the derivative with respect to a Context parameter. */
    void requestDerivative(const std::string& parameter);
    /** The number of such a derivative. */
    int findDerivative(const std::string& parameter) const;
    /**
     * Add forces, energies and derivatives to those of the Context.
     *
     * @param subject      the class that messages shall name
     * @param context      the Context
     * @param terms        what to evaluate
     * @param derivatives  for each scalar of each term the number of the derivative that it adds to, or -1
     * @param wantsSums    whether energies or derivatives are wanted
     * @param forces       whether forces are wanted
     * @param isAsked      whether the energy is, so that there is time to look for faults
     * @param box          the vectors of the periodic box, nm, or null
     */
    void evaluate(const std::string& subject, OpenMM::ContextImpl& context, const std::vector<HelfrichTerm>& terms,
                  const std::vector<int>& derivatives, bool forces, bool wantsSums, bool isAsked, const double* box);

private:
    /** Evaluate on the processor, which names what is wrong. */
    void look(const std::string& subject, OpenMM::ContextImpl& context, const std::vector<HelfrichTerm>& terms,
              const double* box);
    /** Look at what the kernels could not say. */
    void checkFaults(const std::string& subject, OpenMM::ContextImpl& context, const std::vector<HelfrichTerm>& terms,
                     const double* box);

    HelfrichMembrane* core;
    HelfrichNative* native;
    const OpenMM::System* system;
    NativeDevice device;
    /** Evaluations since faults were looked for. */
    int unchecked;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_NATIVE_MEMBRANE_H_*/
