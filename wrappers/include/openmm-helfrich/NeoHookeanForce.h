#ifndef HELFRICH_NEO_HOOKEAN_FORCE_H_
#define HELFRICH_NEO_HOOKEAN_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Elasticity of a rubber-like membrane against a reference shape:
 *
 *     E = sum over triangles of A0 [ mu/2 (l1/l2 + l2/l1 - 2) + K/2 (l1 l2 - 1)^2 ]
 *
 * with the principal stretches l1, l2 of a triangle, whose area in the reference is A0. Shear at fixed area costs mu and
 * growth K only, however large they are; at small strains mu is the shear and K the area modulus.
 *
 * It is the first-order material of E. A. Evans and R. Skalak, Mechanics and Thermodynamics of Biomembranes (CRC Press,
 * 1980), mu beta + K/2 alpha^2 with alpha = l1 l2 - 1 and beta = (l1^2 + l2^2)/(2 l1 l2) - 1, to which G. Lim, M. Wortis
 * and R. Mukhopadhyay (doi:10.1073/pnas.202617299) add terms of higher order.
 *
 * The reference gives each vertex a position, so that a triangle which bond flips make has the shape at rest that its
 * new corners have there; see SkalakForce.
 */
class NeoHookeanForce : public MembraneForce {
public:
    /**
     * @param triangles     the particle indices of the corners, three for each triangle
     * @param shearModulus  the shear modulus mu, kJ/mol/nm^2, zero or above
     * @param areaModulus   the area modulus K, kJ/mol/nm^2, zero or above
     * @param reference     the positions of the vertices at rest, nm, three coordinates for each, in ascending order of
     *                      particle index
     */
    NeoHookeanForce(const std::vector<int>& triangles, double shearModulus, double areaModulus,
                    const std::vector<double>& reference)
        : MembraneForce("NeoHookeanForce", triangles, {shearModulus, areaModulus}) {
        setReference(reference);
    }
    /**
     * Get the shear modulus mu, kJ/mol/nm^2.
     */
    double getShearModulus() const {
        return getParameterValue("shearModulus");
    }
    /**
     * Set the shear modulus mu, kJ/mol/nm^2, zero or above.
     */
    void setShearModulus(double shearModulus) {
        setParameterValue("shearModulus", shearModulus);
    }
    /**
     * Get the area modulus K, kJ/mol/nm^2.
     */
    double getAreaModulus() const {
        return getParameterValue("areaModulus");
    }
    /**
     * Set the area modulus K, kJ/mol/nm^2, zero or above.
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

#endif /*HELFRICH_NEO_HOOKEAN_FORCE_H_*/
