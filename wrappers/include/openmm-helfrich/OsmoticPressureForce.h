#ifndef HELFRICH_OSMOTIC_PRESSURE_FORCE_H_
#define HELFRICH_OSMOTIC_PRESSURE_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * The osmotic pressure of solutes that cannot pass a membrane, which water can:
 *
 *     E = n kT (x - 1 - ln x),   x = c V / n
 *
 * with n the number of solutes inside, c their concentration outside and V the enclosed volume. The solutions are ideal
 * (van 't Hoff, Z. Phys. Chem. 1, 481 (1887), doi:10.1515/zpch-1887-0151), and the one outside is large: E is the work
 * against the pressure difference
 *
 *     -dE/dV = kT (n / V - c)
 *
 * It is zero, and least, at V = n / c, where its stiffness is that of an EnclosedVolumeForce of modulus kT c; for the
 * few bars of real solutions that is a fixed volume. E is infinite at V = 0. A shape without a volume, as one that has
 * turned inside out, is refused by an exception.
 *
 * Numbers are counted in molecules: a concentration of 1 mol/l is 0.602214 / nm^3. In Python, thermalEnergy may be
 * unit.MOLAR_GAS_CONSTANT_R * 300 * unit.kelvin.
 *
 * Triangles must run counter-clockwise seen from outside, and a surface with a border is refused, as
 * EnclosedVolumeForce says.
 */
class OsmoticPressureForce : public MembraneForce {
public:
    /**
     * @param triangles      the particle indices of the corners, three for each triangle
     * @param solutes        the number n of solutes inside, above zero
     * @param concentration  the concentration c of solutes outside, 1/nm^3, above zero
     * @param thermalEnergy  the thermal energy kT, kJ/mol, above zero
     */
    OsmoticPressureForce(const std::vector<int>& triangles, double solutes, double concentration, double thermalEnergy)
        : MembraneForce("OsmoticPressureForce", triangles, {solutes, concentration, thermalEnergy}) {
    }
    /**
     * Get the number n of solutes inside.
     */
    double getSolutes() const {
        return getParameterValue("solutes");
    }
    /**
     * Set the number n of solutes inside, above zero.
     */
    void setSolutes(double solutes) {
        setParameterValue("solutes", solutes);
    }
    /**
     * Get the concentration c of solutes outside, 1/nm^3.
     */
    double getConcentration() const {
        return getParameterValue("concentration");
    }
    /**
     * Set the concentration c of solutes outside, 1/nm^3, above zero.
     */
    void setConcentration(double concentration) {
        setParameterValue("concentration", concentration);
    }
    /**
     * Get the thermal energy kT, kJ/mol.
     */
    double getThermalEnergy() const {
        return getParameterValue("thermalEnergy");
    }
    /**
     * Set the thermal energy kT, kJ/mol, above zero.
     */
    void setThermalEnergy(double thermalEnergy) {
        setParameterValue("thermalEnergy", thermalEnergy);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_OSMOTIC_PRESSURE_FORCE_H_*/
