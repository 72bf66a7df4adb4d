#ifndef HELFRICH_LINEAR_ELASTIC_FORCE_H_
#define HELFRICH_LINEAR_ELASTIC_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * The simplest elasticity against a reference shape, quadratic in Green's strain e of each triangle:
 *
 *     E = sum over triangles of A0 [ K/2 (e1 + e2)^2 + mu/2 (e1 - e2)^2 ]
 *
 * with the principal strains e = (l^2 - 1)/2 of the principal stretches l1, l2 and the area A0 of the triangle in the
 * reference. mu is the shear and K the area modulus at small strains. This is the law of de Saint-Venant and Kirchhoff
 * (P. G. Ciarlet, Mathematical Elasticity I, North-Holland 1988). It is for small strains: a triangle that is compressed
 * to nothing has a finite energy, and resists less and less on the way there.
 *
 * The reference gives each vertex a position, so that a triangle which bond flips make has the shape at rest that its
 * new corners have there; see SkalakForce.
 */
class LinearElasticForce : public MembraneForce {
public:
    /**
     * @param triangles     the particle indices of the corners, three for each triangle
     * @param shearModulus  the shear modulus mu, kJ/mol/nm^2, zero or above
     * @param areaModulus   the area modulus K, kJ/mol/nm^2, zero or above
     * @param reference     the positions of the vertices at rest, nm, three coordinates for each, in ascending order of
     *                      particle index
     */
    LinearElasticForce(const std::vector<int>& triangles, double shearModulus, double areaModulus,
                       const std::vector<double>& reference)
        : MembraneForce("LinearElasticForce", triangles, {shearModulus, areaModulus}) {
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

#endif /*HELFRICH_LINEAR_ELASTIC_FORCE_H_*/
