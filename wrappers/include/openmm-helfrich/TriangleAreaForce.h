#ifndef HELFRICH_TRIANGLE_AREA_FORCE_H_
#define HELFRICH_TRIANGLE_AREA_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps the area a of each triangle near a target a0:
 *
 *     E = sum over triangles of 1/2 kA (a - a0)^2 / a0
 *
 * which gives a membrane local resistance to changes of area, as VCM's SurfaceConstraint L. The target can
 * be one value or one for each triangle. Compare SurfaceAreaForce, equation (1) of
 * Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301, which keeps the sum.
 */
class TriangleAreaForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param modulus  the area modulus kA, kJ/mol/nm^2, zero or above
     * @param target  the target area a0 of each triangle, nm^2, above zero
     */
    TriangleAreaForce(const std::vector<int>& triangles, double modulus, double target)
        : MembraneForce("TriangleAreaForce", triangles, {modulus, target}) {
    }
    /**
     * Get the area modulus kA, kJ/mol/nm^2.
     */
    double getModulus() const {
        return getParameterValue("modulus");
    }
    /**
     * Set the area modulus kA, kJ/mol/nm^2, zero or above.
     */
    void setModulus(double modulus) {
        setParameterValue("modulus", modulus);
    }
    /**
     * Get the target area a0 of each triangle, nm^2.
     */
    double getTarget() const {
        return getParameterValue("target");
    }
    /**
     * Set the target area a0 of each triangle, nm^2, above zero.
     * Values of single triangles are given up.
     */
    void setTarget(double target) {
        setParameterValue("target", target);
    }
    /**
     * Get the target area of each triangle, nm^2; empty if all have the same.
     */
    const std::vector<double>& getTriangleTargets() const {
        return getElementValues("target");
    }
    /**
     * Give each triangle its own target area, which replaces the scalar.
     *
     * @param values  one for each triangle, nm^2; empty to go back to the scalar
     */
    void setTriangleTargets(const std::vector<double>& values) {
        setElementValues("target", values);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_TRIANGLE_AREA_FORCE_H_*/
