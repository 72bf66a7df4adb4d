#ifndef HELFRICH_SURFACE_REPULSION_FORCE_H_
#define HELFRICH_SURFACE_REPULSION_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps surfaces from passing through themselves and each other, by a repulsion of vertices and triangles and of edges:
 *
 *     E = sum over pairs at a distance d < D of m epsilon [ (D/d)^6 - 1 ]^2
 *
 * A pair is a vertex and a triangle, or two edges, that share no vertex; d is the distance of their nearest points. m
 * is 1, but for edges at an angle theta with q = sin^2 theta / 0.01 < 1 it is q (2 - q): where edges become parallel
 * their ends take over. Energy and force go to zero at D (Weeks, Chandler and Andersen, doi:10.1063/1.1674820).
 *
 * Two triangles without a common vertex can begin to cross only where a vertex meets a triangle or an edge meets an
 * edge, at d = 0, where the energy is infinite. So nothing crosses that is not crossed at the beginning, whatever the
 * lengths of edges, as long as no vertex moves by a good part of D in a step. Within a flat surface, pairs are as far
 * apart as triangles are high: take a D below the least height, about a fifth of the mean edge, and epsilon of kT.
 *
 * The triangles may be of several surfaces. If bonds flip on some of them, give those of whole membranes one after
 * another, each as its MonteCarloBondFlip and its other forces have them: the force follows their flips, and
 * its energy counts in each. A flip does not look whether the quadrilateral that it turns sweeps over something.
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
