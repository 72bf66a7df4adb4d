#ifndef HELFRICH_BENDING_FORCE_H_
#define HELFRICH_BENDING_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Bending energy of a fluid membrane (Helfrich), with spontaneous curvature, in five discretisations:
 *
 *     E = 1/2 kappa sum_i [ c_i^2 / a_i - 2 C0 c_i + C0^2 a_i ]
 *
 * over the vertices i, with an integrated curvature c_i and an area a_i that the scheme chooses.
 * kappa multiplies half the square of the sum of the principal curvatures less C0: a sphere of radius R
 * has E = 8 pi kappa (1 - C0 R / 2)^2 up to the error of the mesh.
 *
 * Where c is a vector, c^2 is its square and the linear term takes n.c, with n the mean of the normals of
 * the triangles at the vertex weighted by their angles (B9); setUnsignedSpontaneousCurvature() chooses |c|
 * instead, as VCM does, which cannot tell a bulge from a dent.
 *
 * Borders are free, as in Capovilla, Guven and Santiago, Phys. Rev. E 66, 021607 (2002),
 * doi:10.1103/PhysRevE.66.021607, without tension of their own: no scheme has curvature at a vertex on a border, which
 * is left out of the sum, and a border edge has no angle. An inner edge that ends at a border counts for its inner end.
 *
 * The Voronoi area of the schemes GompperKroll and JulicherVoronoi goes through zero where triangles
 * are obtuse. The energy then has pits and poles, as the formula has; it is not clamped.
 *
 * Source: Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301.
 */
class BendingForce : public MembraneForce {
public:
    /**
     * The discretisations.
     */
    enum Scheme {
        /**
         * c = J = sum_j l_ij phi_ij / 2 over the edges, with phi the angle between the normals of their two
         * triangles, positive where the surface is convex; a is barycentric (B13).
         */
        Julicher = 0,
        /**
         * c = S = sum_j (cot theta_1 + cot theta_2)(r_i - r_j) / 2 with the two angles opposite the edge; a is
         * Voronoi's, sum_j l_ij^2 (cot theta_1 + cot theta_2) / 8 (B10).
         */
        GompperKroll = 1,
        /**
         * c = S; a is barycentric, a third of the area of the triangles at the vertex (B15).
         */
        GompperKrollBarycentric = 2,
        /**
         * c = J; a is Voronoi's (B16).
         */
        JulicherVoronoi = 3,
        /**
         * c = sum_j (r_i - r_j) / sqrt(3), as S if all triangles were equilateral; a is barycentric. At C0 = 0
         * this is VCM's Espiru1987, kappa sum_i |sum_j r_j - n_i r_i|^2 / (6 a_i).
         */
        Espriu = 4
    };
    /**
     * @param triangles             the particle indices of the corners, three for each triangle
     * @param rigidity              the bending rigidity kappa, kJ/mol, zero or above
     * @param spontaneousCurvature  the spontaneous curvature C0, 1/nm, positive for bulging outward
     * @param scheme                the discretisation
     */
    BendingForce(const std::vector<int>& triangles, double rigidity, double spontaneousCurvature = 0,
                 Scheme scheme = Julicher)
        : MembraneForce("BendingForce", triangles, {rigidity, spontaneousCurvature}, scheme) {
    }
    /**
     * Get the bending rigidity kappa, kJ/mol.
     */
    double getRigidity() const {
        return getParameterValue("rigidity");
    }
    /**
     * Set the bending rigidity kappa, kJ/mol, zero or above.
     * Values of single vertices are given up.
     */
    void setRigidity(double rigidity) {
        setParameterValue("rigidity", rigidity);
    }
    /**
     * Get the spontaneous curvature C0, 1/nm, positive for bulging outward.
     */
    double getSpontaneousCurvature() const {
        return getParameterValue("spontaneousCurvature");
    }
    /**
     * Set the spontaneous curvature C0, 1/nm, positive for bulging outward.
     * Values of single vertices are given up.
     */
    void setSpontaneousCurvature(double spontaneousCurvature) {
        setParameterValue("spontaneousCurvature", spontaneousCurvature);
    }
    /**
     * Get the discretisation.
     */
    Scheme getScheme() const {
        return (Scheme) getForm();
    }
    /**
     * Set the discretisation. updateParametersInContext() tells existing Contexts.
     */
    void setScheme(Scheme scheme) {
        setForm(scheme);
    }
    /**
     * Get whether the linear term of the spontaneous curvature takes |c|.
     */
    bool getUnsignedSpontaneousCurvature() const {
        return getSwitch("unsignedSpontaneousCurvature");
    }
    /**
     * Choose whether the linear term of the spontaneous curvature takes |c| (VCM) instead of n.c.
     *
     * @param isUnsigned  true for |c|; false, the default, for n.c
     */
    void setUnsignedSpontaneousCurvature(bool isUnsigned) {
        setSwitch("unsignedSpontaneousCurvature", isUnsigned);
    }
    /**
     * Get the bending rigidity of each vertex, kJ/mol; empty if all have the same.
     */
    const std::vector<double>& getVertexRigidity() const {
        return getElementValues("rigidity");
    }
    /**
     * Give each vertex its own bending rigidity, which replaces the scalar: domains.
     *
     * @param values  one for each vertex, in ascending order of particle index, kJ/mol; empty to go back
     */
    void setVertexRigidity(const std::vector<double>& values) {
        setElementValues("rigidity", values);
    }
    /**
     * Get the spontaneous curvature of each vertex, 1/nm; empty if all have the same.
     */
    const std::vector<double>& getVertexSpontaneousCurvature() const {
        return getElementValues("spontaneousCurvature");
    }
    /**
     * Give each vertex its own spontaneous curvature, which replaces the scalar: domains.
     *
     * @param values  one for each vertex, in ascending order of particle index, 1/nm; empty to go back
     */
    void setVertexSpontaneousCurvature(const std::vector<double>& values) {
        setElementValues("spontaneousCurvature", values);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_BENDING_FORCE_H_*/
