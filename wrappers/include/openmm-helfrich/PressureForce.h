#ifndef HELFRICH_PRESSURE_FORCE_H_
#define HELFRICH_PRESSURE_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * A pressure difference across a membrane that encloses the volume V:
 *
 *     E = -p V
 *
 * with p the pressure inside less that outside: above zero it blows the membrane up, below zero it sucks it in. The
 * force on a vertex is p/3 times the sum of the area vectors of its triangles. Bending, a tension and a pressure
 * together are the functional of Deuling and Helfrich, J. Phys. (Paris) 37, 1335 (1976),
 * doi:10.1051/jphys:0197600370110133500, whose pressure difference has the other sign; see also Seifert, Adv. Phys. 46,
 * 13 (1997), doi:10.1080/00018739700101488.
 *
 * E has no lower bound for p above zero: something else must keep the area finite, such as a SurfaceAreaForce. p can be
 * a parameter of the Context, see setContextParameter(). Where the volume changes with osmotic pressure, take an
 * OsmoticPressureForce.
 *
 * Triangles must run counter-clockwise seen from outside, and a surface with a border is refused, as
 * EnclosedVolumeForce says.
 */
class PressureForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param pressure   the pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar)
     */
    PressureForce(const std::vector<int>& triangles, double pressure)
        : MembraneForce("PressureForce", triangles, {pressure}) {
    }
    /**
     * Get the pressure difference p, inside less outside, kJ/mol/nm^3.
     */
    double getPressure() const {
        return getParameterValue("pressure");
    }
    /**
     * Set the pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar).
     */
    void setPressure(double pressure) {
        setParameterValue("pressure", pressure);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_PRESSURE_FORCE_H_*/
