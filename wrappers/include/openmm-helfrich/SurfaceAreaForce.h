#ifndef HELFRICH_SURFACE_AREA_FORCE_H_
#define HELFRICH_SURFACE_AREA_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps the total area A of a membrane near a target A0:
 *
 *     E = 1/2 kA (A - A0)^2 / A0
 *
 * Equation (1) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301. A is the sum over all triangles, of all components of the surface.
 */
class SurfaceAreaForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param modulus    the area modulus kA, kJ/mol/nm^2, zero or above
     * @param target     the target area A0, nm^2, above zero
     */
    SurfaceAreaForce(const std::vector<int>& triangles, double modulus, double target)
        : MembraneForce("SurfaceAreaForce", triangles, {modulus, target}) {
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
     * Get the target area A0, nm^2.
     */
    double getTarget() const {
        return getParameterValue("target");
    }
    /**
     * Set the target area A0, nm^2, above zero.
     */
    void setTarget(double target) {
        setParameterValue("target", target);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SURFACE_AREA_FORCE_H_*/
