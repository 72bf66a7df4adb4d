#ifndef HELFRICH_SHARED_MEMBRANE_H_
#define HELFRICH_SHARED_MEMBRANE_H_

#include "openmm-helfrich/internal/Core.h"

#include <openmm/Vec3.h>
#include <openmm/internal/ContextImpl.h>

#include <memory>
#include <utility>
#include <vector>

namespace HelfrichPlugin {

class MembraneForceImpl;

/**
 * A mesh in one Context, shared by all forces on the same triangles, so that the geometry is computed
 * once per evaluation. The first of the forces that an evaluation asks for is its leader and computes
 * the sum of all that are asked for; the others add nothing.
 */
class SharedMembrane {
public:
    /**
     * Join the membrane of a Context that has these triangles, or make it.
     *
     * @param subject    the class that messages shall name
     * @param context    the Context
     * @param triangles  the particle indices of the corners, three for each triangle
     */
    static std::shared_ptr<SharedMembrane> acquire(const std::string& subject, OpenMM::ContextImpl& context,
                                                   const std::vector<int>& triangles);
    ~SharedMembrane();
    SharedMembrane(const SharedMembrane&) = delete;
    SharedMembrane& operator=(const SharedMembrane&) = delete;
    /** Add a force to the membrane; OpenMM makes them in the order in which it will call them. */
    void join(MembraneForceImpl* member);
    void leave(MembraneForceImpl* member);
    /** Whether a member is the first whose force group is among those asked for. */
    bool isLeader(const MembraneForceImpl& member, int groups) const;
    /**
     * Evaluate all members in some force groups.
     *
     * @param subject      the class that messages shall name
     * @param context      the Context
     * @param groups       a bit for each force group
     * @param positions    of all particles, nm
     * @param includeEnergy  whether the energy is wanted; it is 0 otherwise
     * @param forces       of all particles, kJ/mol/nm; the forces are added, unless it is null
     * @param derivatives  of the energy with respect to Context parameters; those asked for are added,
     *                     unless it is null
     * @return the energy, kJ/mol
     */
    double evaluate(const std::string& subject, OpenMM::ContextImpl& context, int groups,
                    const std::vector<OpenMM::Vec3>& positions, bool includeEnergy, std::vector<OpenMM::Vec3>* forces,
                    std::map<std::string, double>* derivatives);
    /** Choose what computes the forces, for one that joins; `backend` is empty if it does not mind. */
    void choose(const std::string& subject, const std::string& backend) {
        check(Helfrich_Membrane_choose(subject.c_str(), core, backend.c_str()));
    }
    /** Refuse a term that cannot be evaluated on this membrane. */
    void checkTerm(const std::string& subject, const HelfrichTerm& term) const {
        check(Helfrich_Membrane_checkTerm(subject.c_str(), core, &term));
    }
    const std::vector<int>& getTriangles() const {
        return triangles;
    }
    /** The pairs of particles that edges connect. */
    std::vector<std::pair<int, int>> getEdges() const;

private:
    SharedMembrane(const std::string& subject, OpenMM::ContextImpl& context, const std::vector<int>& triangles);

    /**
     * Whether the members are forces of this very Context. When a Context cannot be made, OpenMM leaves
     * its forces behind and frees its memory, and the next Context may get the same address.
     */
    bool belongsTo(OpenMM::ContextImpl& context) const;

    std::vector<int> triangles;
    HelfrichMembrane* core;
    std::vector<MembraneForceImpl*> members;
    std::vector<MembraneForceImpl*> active;
    std::vector<HelfrichTerm> terms;
    std::vector<HelfrichContribution> contributions;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SHARED_MEMBRANE_H_*/
