#ifndef HELFRICH_SCALED_BODIES_H_
#define HELFRICH_SCALED_BODIES_H_

#include <openmm/Vec3.h>
#include <openmm/internal/ContextImpl.h>

#include <string>
#include <vector>

namespace HelfrichPlugin {

/**
 * What keeps its shape when the periodic box is scaled: points, which are scaled one by one, and molecules, which move
 * with their centres.
 *
 * Points are the vertices of membranes with periodic boundary conditions, particles of mass 0 and, if molecules are not
 * rigid, all. Of the rest, what bonds, constraints and virtual sites connect is a molecule, as for OpenMM's barostats.
 */
class ScaledBodies {
public:
    /** Of a Context whose forces have all been initialised. */
    ScaledBodies(OpenMM::ContextImpl& context, bool rigidMolecules);
    /** Refuse constraints that scaling would break. */
    static void refuseConstraints(const std::string& subject, OpenMM::ContextImpl& context, bool rigidMolecules);
    /** How many are scaled and can move by themselves. */
    int getNumBodies() const {
        return count;
    }
    /** Scale positions about the origin. */
    void scale(const OpenMM::Vec3& factors, std::vector<OpenMM::Vec3>& positions) const;

private:
    std::vector<int> points;
    /** The particles of each molecule, those that its centre is made of first. */
    struct Molecule {
        std::vector<int> particles;
        int numMassive;
    };
    std::vector<Molecule> molecules;
    int count;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SCALED_BODIES_H_*/
