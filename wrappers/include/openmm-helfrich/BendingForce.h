#ifndef HELFRICH_BENDING_FORCE_H_
#define HELFRICH_BENDING_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Bending energy of a fluid membrane (Helfrich), with spontaneous curvature:
 *
 *     E = 1/2 kappa sum_i [ J_i^2 / a_i - 2 C0 J_i + C0^2 a_i ]
 *
 * over the vertices i, with a_i a third of the area of the triangles at i and J_i = sum_j l_ij phi_ij / 2
 * over the edges at i, l the length of an edge and phi the angle between the normals of its two triangles,
 * positive where the surface is convex. This is Juelicher's discretisation, equation (B13) of Farnudi,
 * Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023), doi:10.1103/PhysRevE.108.015301.
 *
 * kappa multiplies half the square of the sum of the principal curvatures less C0: a sphere of radius R
 * has E = 8 pi kappa (1 - C0 R / 2)^2 up to the error of the mesh.
 */
class BendingForce : public MembraneForce {
public:
    /**
     * The discretisations.
     */
    enum Scheme {
        /**
         * Dihedral angles times edge lengths, over barycentric areas (B13).
         */
        Julicher = 0
    };
    /**
     * @param triangles             the particle indices of the corners, three for each triangle
     * @param rigidity              the bending rigidity kappa, kJ/mol, zero or above
     * @param spontaneousCurvature  the spontaneous curvature C0, 1/nm, positive for bulging outward
     * @param scheme                the discretisation
     */
    BendingForce(const std::vector<int>& triangles, double rigidity, double spontaneousCurvature = 0,
                 Scheme scheme = Julicher);
    /**
     * Get the bending rigidity kappa, kJ/mol.
     */
    double getRigidity() const;
    /**
     * Set the bending rigidity kappa, kJ/mol, zero or above.
     */
    void setRigidity(double rigidity);
    /**
     * Get the spontaneous curvature C0, 1/nm, positive for bulging outward.
     */
    double getSpontaneousCurvature() const;
    /**
     * Set the spontaneous curvature C0, 1/nm, positive for bulging outward.
     */
    void setSpontaneousCurvature(double spontaneousCurvature);
    /**
     * Get the discretisation.
     */
    Scheme getScheme() const;
    /**
     * Set the discretisation. Existing Contexts keep theirs until they are reinitialised.
     */
    void setScheme(Scheme scheme);
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_BENDING_FORCE_H_*/
