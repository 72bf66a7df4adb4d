#ifndef HELFRICH_TRIANGLE_HEIGHT_FORCE_H_
#define HELFRICH_TRIANGLE_HEIGHT_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps triangles from degenerating by a repulsion at small heights:
 *
 *     E = sum over triangles, sum over their three heights h < 2^(1/4) d of
 *         epsilon [ (d/h)^8 - (d/h)^4 + 1/4 ]
 *
 * The auxiliary potential of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301. Energy and force go to zero at h = 2^(1/4) d.
 */
class TriangleHeightForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param minHeight  the height d below which the repulsion is strong, nm, zero or above
     * @param epsilon    the strength, kJ/mol, zero or above
     */
    TriangleHeightForce(const std::vector<int>& triangles, double minHeight, double epsilon)
        : MembraneForce("TriangleHeightForce", triangles, {minHeight, epsilon}) {
    }
    /**
     * Get the height d, nm.
     */
    double getMinHeight() const {
        return getParameterValue("minHeight");
    }
    /**
     * Set the height d, nm, zero or above.
     */
    void setMinHeight(double minHeight) {
        setParameterValue("minHeight", minHeight);
    }
    /**
     * Get the strength epsilon, kJ/mol.
     */
    double getEpsilon() const {
        return getParameterValue("epsilon");
    }
    /**
     * Set the strength epsilon, kJ/mol, zero or above.
     */
    void setEpsilon(double epsilon) {
        setParameterValue("epsilon", epsilon);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_TRIANGLE_HEIGHT_FORCE_H_*/
