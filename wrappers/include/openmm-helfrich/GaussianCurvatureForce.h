#ifndef HELFRICH_GAUSSIAN_CURVATURE_FORCE_H_
#define HELFRICH_GAUSSIAN_CURVATURE_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * The elasticity of Gaussian curvature:
 *
 *     E = kappa_G [ sum over vertices on no border of (2 pi - sum of theta) ]
 *       = kappa_G [ 2 pi chi - sum over vertices on borders of (pi - sum of theta) ]
 *
 * with theta the angles of the triangles at a vertex (Meyer et al., in Visualization and Mathematics III, 35 (2003),
 * doi:10.1007/978-3-662-05105-4_2) and chi the number of vertices less that of edges plus that of triangles. The two
 * are equal by the theorem of Gauss and Bonnet, in which the second sum is the integrated geodesic curvature of the
 * borders; forces act on the triangles at borders only. On a closed surface E is the constant 2 pi chi kappa_G, 4 pi
 * kappa_G on a sphere, and there are no forces.
 *
 * The modulus can have a value for each vertex, so that domains may differ. Then
 *
 *     E = sum over vertices on no border of kappa_G,i (2 pi - sum of theta)
 *
 * has forces on closed surfaces, too: those of the line between domains, by its geodesic curvature (F. Juelicher and
 * R. Lipowsky, Phys. Rev. Lett. 70, 2964 (1993), doi:10.1103/PhysRevLett.70.2964; LineTensionForce is the line's
 * tension).
 *
 * With kappa_G below zero and bond flips, meshes with borders may crumple: where the dihedral angles at a vertex
 * cancel, BendingForce's scheme Julicher sees no curvature however the surface zigzags, and folds at a border gain
 * energy. A DihedralForce of the stiffness of the membrane's rigidity prevents that for kappa_G down to minus the
 * rigidity; at -1.5 of it borders ruffle nevertheless. Free borders also fold over and heat up at low friction, with or
 * without this force; a DihedralForce of 0.2 of the rigidity keeps them from it. docs/surfaces.md has the measurements.
 */
class GaussianCurvatureForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param modulus  the modulus kappa_G, kJ/mol; of lipid membranes it is below zero, about -rigidity
     */
    GaussianCurvatureForce(const std::vector<int>& triangles, double modulus)
        : MembraneForce("GaussianCurvatureForce", triangles, {modulus}) {
    }
    /**
     * Get the modulus kappa_G, kJ/mol.
     */
    double getModulus() const {
        return getParameterValue("modulus");
    }
    /**
     * Set the modulus kappa_G, kJ/mol.
     * Values of single vertices are given up.
     */
    void setModulus(double modulus) {
        setParameterValue("modulus", modulus);
    }
    /**
     * Get the modulus of each vertex, kJ/mol; empty if all have the same.
     */
    const std::vector<double>& getVertexModulus() const {
        return getElementValues("modulus");
    }
    /**
     * Give each vertex its own modulus, which replaces the scalar.
     *
     * @param values  one for each vertex, in ascending order of particle index, kJ/mol; empty to go back to the scalar
     */
    void setVertexModulus(const std::vector<double>& values) {
        setElementValues("modulus", values);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_GAUSSIAN_CURVATURE_FORCE_H_*/
