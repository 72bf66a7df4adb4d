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
 *
 * A surface with a border encloses nothing: creating a Context throws an exception that names the border.
 *
 * Triangles must run counter-clockwise seen from outside. Where V is below zero when a Context first evaluates the
 * force, it throws an exception: swap two corners of each triangle. Of several surfaces some may face inward, as
 * the inner wall of a shell does, if V as a whole is above zero, and a flat surface (|V| below a thousandth of a
 * sphere's of the same area) may start. A shape that turns inside out or crosses itself later is not refused; the
 * formula holds for V of either sign.
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
