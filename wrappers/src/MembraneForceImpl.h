#ifndef HELFRICH_MEMBRANE_FORCE_IMPL_H_
#define HELFRICH_MEMBRANE_FORCE_IMPL_H_

#include "OnMembrane.h"
#include "openmm-helfrich/MembraneForce.h"
#include "openmm-helfrich/internal/UpdatableImpl.h"

#include <openmm/internal/CustomCPPForceImpl.h>

#include <functional>
#include <memory>

namespace HelfrichPlugin {

/**
 * The one implementation of all membrane forces.
 *
 * On Reference, CPU and what derives from them, it reads and writes OpenMM's arrays in place. GPU platforms evaluate
 * most forces themselves; for all others, OpenMM's support for forces in plain C++ carries positions to the processor
 * and forces back.
 */
class MembraneForceImpl : public OpenMM::CustomCPPForceImpl,
                          public UpdatableImpl,
                          public OnMembrane,
                          public VertexNumbersImpl {
public:
    explicit MembraneForceImpl(const MembraneForce& owner);
    ~MembraneForceImpl();
    void initialize(OpenMM::ContextImpl& context);
    const MembraneForce& getOwner() const {
        return owner;
    }
    double calcForcesAndEnergy(OpenMM::ContextImpl& context, bool includeForces, bool includeEnergy, int groups);
    double computeForce(OpenMM::ContextImpl& context, const std::vector<OpenMM::Vec3>& positions,
                        std::vector<OpenMM::Vec3>& forces);
    std::map<std::string, double> getDefaultParameters();
    std::vector<std::pair<int, int>> getBondedParticles() const;
    std::vector<std::string> getKernelNames();
    void updateParametersInContext(OpenMM::ContextImpl& context);
    std::vector<double> getVertexNumbersInContext(OpenMM::ContextImpl& context) const {
        membrane->settle(context);
        return vertexNumbers;
    }
    /** Whether the force belongs to one of some groups, given as bits. */
    bool isInGroups(int groups) const;
    /** Whether the surface was in the periodic box when the Context was made. */
    bool isPeriodic() const {
        return periodic;
    }
    /** Whether it acts on pairs that are near each other, and so may act on several membranes together. */
    bool isContact() const {
        return Helfrich_Potential_isContact(term.potential) != 0;
    }
    /** Whether a scalar is a Context parameter. */
    bool usesContextParameters() const;
    /** What to compute, with the present values of Context parameters. */
    HelfrichTerm getTerm(OpenMM::ContextImpl& context) const;
    /** Do something with each list of what vertices are, in ascending order of particle index. */
    void visitKinds(const std::function<void(const std::vector<double>& values)>& visit) const;
    /**
     * Let the vertices have each other's values.
     *
     * @param sources  for each vertex the one whose values it shall have
     * @param version  of the numbers of vertices from then on, if that makes a difference to the force
     */
    void rearrange(const std::vector<uint32_t>& sources, uint64_t version);
    /** Whether the platform evaluates it, with NativeMembrane. */
    bool isNative() const {
        return native;
    }
    /** For each scalar the number of the derivative that a platform adds to; others stay as they are. */
    void findDerivatives(const NativeMembrane& native, int* numbers) const;
    /** Add the derivatives that the user asked for. */
    void addDerivatives(const HelfrichContribution& contribution, std::map<std::string, double>& derivatives) const;

private:
    /** Copy the values of the force; if they are refused, everything stays as it was. */
    void copyValues();

    const MembraneForce& owner;
    HelfrichTerm term;
    /** What the fields of the term point to. */
    std::vector<std::vector<double>> fields;
    std::vector<int> particles;
    std::vector<double> vertexNumbers, referenceBox;
    /** The same for the core; others where any of them or a field has changed. */
    struct Destroy {
        void operator()(HelfrichNumbers* numbers) const {
            Helfrich_Numbers_destroy(numbers);
        }
    };
    std::unique_ptr<HelfrichNumbers, Destroy> numbers;
    /** Whether each scalar may have values of vertices, and whether the numbers say of what kind these are. */
    std::vector<bool> isOfVertices;
    bool hasKinds;
    /** For each scalar the Context parameter that stands in for it, or an empty text. */
    std::vector<std::string> contextParameters;
    std::vector<std::string> derivatives;
    /** Whether positions and forces are OpenMM's own arrays of doubles. */
    bool inPlace;
    bool native;
    /** The force's group when the Context was made, as OpenMM's own forces have it: a change needs reinitialize. */
    const int group;
    const bool periodic;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MEMBRANE_FORCE_IMPL_H_*/
