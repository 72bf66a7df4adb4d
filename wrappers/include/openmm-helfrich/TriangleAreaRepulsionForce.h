#ifndef HELFRICH_TRIANGLE_AREA_REPULSION_FORCE_H_
#define HELFRICH_TRIANGLE_AREA_REPULSION_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps triangles from vanishing by a repulsion at small areas:
 *
 *     E = sum over triangles with area a < 2^(1/4) a_m of epsilon [ (a_m/a)^8 - (a_m/a)^4 + 1/4 ]
 *
 * The form of TriangleHeightForce on areas, VCM's SurfaceConstraint WCA and GWCA; energy and force go to zero
 * at the cutoff, where VCM's are discontinuous. A triangle can still degenerate to a long needle; the paper
 * (Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023), doi:10.1103/PhysRevE.108.015301) prefers heights.
 */
class TriangleAreaRepulsionForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param minArea  the area a_m below which the repulsion is strong, nm^2, zero or above
     * @param epsilon  the strength, kJ/mol, zero or above
     */
    TriangleAreaRepulsionForce(const std::vector<int>& triangles, double minArea, double epsilon)
        : MembraneForce("TriangleAreaRepulsionForce", triangles, {minArea, epsilon}) {
    }
    /**
     * Get the area a_m below which the repulsion is strong, nm^2.
     */
    double getMinArea() const {
        return getParameterValue("minArea");
    }
    /**
     * Set the area a_m below which the repulsion is strong, nm^2, zero or above.
     */
    void setMinArea(double minArea) {
        setParameterValue("minArea", minArea);
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
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_TRIANGLE_AREA_REPULSION_FORCE_H_*/
