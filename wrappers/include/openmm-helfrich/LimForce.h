#ifndef HELFRICH_LIM_FORCE_H_
#define HELFRICH_LIM_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Elasticity of the skeleton of a red blood cell, which hardens, against a reference shape:
 *
 *     E = sum over triangles of A0 [ K/2 (a^2 + a3 a^3 + a4 a^4) + mu (b + b1 a b + b2 b^2) ]
 *
 * with a = l1 l2 - 1 and b = (l1 - l2)^2 / (2 l1 l2) of the principal stretches l1, l2 of a triangle, whose area in the
 * reference is A0. It has no energy in the reference, and none of bending. At small strains the shear modulus is mu and
 * the area modulus K. a3 = -2, a4 = 8, b1 = 0.7, and b2 is chosen among those of the literature.
 *
 * Sources: Lim, Wortis and Mukhopadhyay, PNAS 99, 16766 (2002), doi:10.1073/pnas.202617299, and in Soft Matter 4
 * (Wiley, 2008), doi:10.1002/9783527623372.ch2a; Amoudruz et al., Biophys. J. 122, 1517 (2023),
 * doi:10.1016/j.bpj.2023.03.019.
 *
 * The reference gives each vertex a position, so that a triangle which bond flips make has the shape at rest that its
 * new corners have there; one whose corners are in one line there is never made.
 */
class LimForce : public MembraneForce {
public:
    /**
     * Sets of coefficients.
     */
    enum Coefficients {
        /**
         * b2 = 0.75: Lim, Wortis and Mukhopadhyay.
         */
        Lim2002 = 0,
        /**
         * b2 = 1.84: Amoudruz et al., from experiments.
         */
        Amoudruz2023 = 1
    };
    /**
     * @param triangles     the particle indices of the corners, three for each triangle
     * @param shearModulus  the modulus mu, kJ/mol/nm^2, zero or above
     * @param areaModulus   the modulus K, kJ/mol/nm^2, zero or above
     * @param reference     the positions of the vertices at rest, nm, three coordinates for each, in ascending order of
     *                      particle index
     * @param coefficients  the set of coefficients
     */
    LimForce(const std::vector<int>& triangles, double shearModulus, double areaModulus,
             const std::vector<double>& reference, Coefficients coefficients = Lim2002)
        : MembraneForce("LimForce", triangles, {shearModulus, areaModulus}, coefficients) {
        setReference(reference);
    }
    /**
     * Get the set of coefficients.
     */
    Coefficients getCoefficients() const {
        return (Coefficients) getForm();
    }
    /**
     * Set the set of coefficients. updateParametersInContext() tells existing Contexts.
     */
    void setCoefficients(Coefficients coefficients) {
        setForm(coefficients);
    }
    /**
     * Get the modulus mu, kJ/mol/nm^2.
     */
    double getShearModulus() const {
        return getParameterValue("shearModulus");
    }
    /**
     * Set the modulus mu, kJ/mol/nm^2, zero or above.
     */
    void setShearModulus(double shearModulus) {
        setParameterValue("shearModulus", shearModulus);
    }
    /**
     * Get the modulus K, kJ/mol/nm^2.
     */
    double getAreaModulus() const {
        return getParameterValue("areaModulus");
    }
    /**
     * Set the modulus K, kJ/mol/nm^2, zero or above.
     */
    void setAreaModulus(double areaModulus) {
        setParameterValue("areaModulus", areaModulus);
    }
    /**
     * Get the positions of the vertices at rest, nm, three coordinates for each.
     */
    const std::vector<double>& getReference() const {
        return getVertexNumbers();
    }
    /**
     * Set the positions of the vertices at rest; setReferenceBox() says in which periodic box they are.
     *
     * @param positions  nm, three coordinates for each, in ascending order of particle index
     */
    void setReference(const std::vector<double>& positions) {
        setVertexNumbers(positions);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_LIM_FORCE_H_*/
