#ifndef HELFRICH_SURFACE_REPULSION_FORCE_H_
#define HELFRICH_SURFACE_REPULSION_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps surfaces from passing through themselves and each other by a repulsion of vertices and triangles:
 *
 *     E = sum over pairs of a vertex and a triangle at a distance d < D of epsilon [ (D/d)^6 - 1 ]^2
 *
 * with d from the vertex to the nearest point of the triangle. A pair does not count if the vertex is a corner of the
 * triangle, or joined to a corner. Energy and force go to zero at D (Weeks, Chandler and Andersen,
 * doi:10.1063/1.1674820).
 *
 * No edge passes through a triangle while each is shorter than 2 d_min, where d_min is the smallest distance in any
 * pair: of the point where it did, one of its ends would be nearer than d_min. Left out are triangles with a
 * corner that is joined to that end, or is it: there the bending energy must do. An energy E of a pair means
 * d = D / (1 + sqrt(E/epsilon))^(1/6), so with epsilon = 1 kT no pair comes nearer than about 0.75 D (E = 20 kT). So take
 * D of 0.7 to 0.9 of the longest edges, below the distance of second neighbours (1.7 edges on an even mesh), and time
 * steps in which nothing moves by more than a tenth of it.
 *
 * The triangles may be of several surfaces. If bonds flip on some of them, give those of whole membranes one after
 * another, each as its MonteCarloBondFlip and its other forces have them: the force follows their flips, and
 * its energy counts in each.
 *
 * The processor computes it, whatever computes other forces.
 */
class SurfaceRepulsionForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param distance   the distance D below which there is a repulsion, nm, above zero
     * @param epsilon    the strength, kJ/mol, zero or above
     */
    SurfaceRepulsionForce(const std::vector<int>& triangles, double distance, double epsilon)
        : MembraneForce("SurfaceRepulsionForce", triangles, {distance, epsilon}) {
    }
    /**
     * Get the distance D below which there is a repulsion, nm.
     */
    double getDistance() const {
        return getParameterValue("distance");
    }
    /**
     * Set the distance D below which there is a repulsion, nm, above zero.
     */
    void setDistance(double distance) {
        setParameterValue("distance", distance);
    }
    /**
     * Get the strength, kJ/mol.
     */
    double getEpsilon() const {
        return getParameterValue("epsilon");
    }
    /**
     * Set the strength, kJ/mol, zero or above.
     */
    void setEpsilon(double epsilon) {
        setParameterValue("epsilon", epsilon);
    }
    /**
     * Get whether only different connected parts of the triangles repel each other.
     */
    bool getOnlyBetweenParts() const {
        return getSwitch("onlyBetweenParts");
    }
    /**
     * Choose whether only different connected parts of the triangles repel each other.
     *
     * @param only  true to leave out pairs within a part; false, the default, for all pairs
     */
    void setOnlyBetweenParts(bool only) {
        setSwitch("onlyBetweenParts", only);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SURFACE_REPULSION_FORCE_H_*/
