#ifndef HELFRICH_ENCLOSED_VOLUME_FORCE_H_
#define HELFRICH_ENCLOSED_VOLUME_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps the volume V that a membrane encloses near a target V0:
 *
 *     E = 1/2 kV (V - V0)^2 / V0
 *
 * Equation (2) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301. V is positive for outward triangles, the sum over all components of
 * the surface, and does not depend on the origin.
 */
class EnclosedVolumeForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param modulus    the volume modulus kV, kJ/mol/nm^3, zero or above
     * @param target     the target volume V0, nm^3, above zero
     */
    EnclosedVolumeForce(const std::vector<int>& triangles, double modulus, double target)
        : MembraneForce("EnclosedVolumeForce", triangles, {modulus, target}) {
    }
    /**
     * Get the volume modulus kV, kJ/mol/nm^3.
     */
    double getModulus() const {
        return getParameterValue("modulus");
    }
    /**
     * Set the volume modulus kV, kJ/mol/nm^3, zero or above.
     */
    void setModulus(double modulus) {
        setParameterValue("modulus", modulus);
    }
    /**
     * Get the target volume V0, nm^3.
     */
    double getTarget() const {
        return getParameterValue("target");
    }
    /**
     * Set the target volume V0, nm^3, above zero.
     */
    void setTarget(double target) {
        setParameterValue("target", target);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_ENCLOSED_VOLUME_FORCE_H_*/
