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
     */
    void setModulus(double modulus) {
        setParameterValue("modulus", modulus);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_GAUSSIAN_CURVATURE_FORCE_H_*/
