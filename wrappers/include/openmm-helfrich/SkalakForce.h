#ifndef HELFRICH_SKALAK_FORCE_H_
#define HELFRICH_SKALAK_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Elasticity of a membrane with a skeleton, such as that of a red blood cell, against a reference shape:
 *
 *     E = sum over triangles of A0 [ mu/4 (1/2 I1^2 + I1 - I2) + K/8 I2^2 ]
 *
 * with I1 = l1^2 + l2^2 - 2 and I2 = l1^2 l2^2 - 1 of the principal stretches l1, l2 of a triangle, whose area in the
 * reference is A0. It has no energy in the reference, and none of bending. The area term makes it stiffer the more it
 * is stretched; for red cells K is some 1000 mu at short times (a membrane whose area is kept) and of the order of mu
 * for the skeleton alone.
 *
 * mu and K are B and C of R. Skalak, A. Tozeren, R. P. Zarda and S. Chien, Biophys. J. 13, 245 (1973),
 * doi:10.1016/S0006-3495(73)85983-1. At small strains the shear modulus is mu/2 and the area modulus K + mu/2.
 * LinearElasticForce and NeoHookeanForce have these moduli themselves for arguments.
 *
 * The reference gives each vertex a position, so that a triangle which bond flips make has the shape at rest that its
 * new corners have there; one whose corners are in one line there is never made.
 */
class SkalakForce : public MembraneForce {
public:
    /**
     * @param triangles     the particle indices of the corners, three for each triangle
     * @param shearModulus  the modulus mu, kJ/mol/nm^2, zero or above
     * @param areaModulus   the modulus K, kJ/mol/nm^2, zero or above
     * @param reference     the positions of the vertices at rest, nm, three coordinates for each, in ascending order of
     *                      particle index
     */
    SkalakForce(const std::vector<int>& triangles, double shearModulus, double areaModulus,
                const std::vector<double>& reference)
        : MembraneForce("SkalakForce", triangles, {shearModulus, areaModulus}) {
        setReference(reference);
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

#endif /*HELFRICH_SKALAK_FORCE_H_*/
