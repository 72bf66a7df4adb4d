#ifndef HELFRICH_PLAQUETTE_AREA_FORCE_H_
#define HELFRICH_PLAQUETTE_AREA_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Keeps the plaquettes of all N vertices alike:
 *
 *     E = 1/2 k sum_i (N a_i / A0 - 1)^2
 *
 * with a_i the barycentric area of vertex i, a third of the area of its triangles.
 *
 * Source: equation (20) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301, with k = (3/2) kB T.
 */
class PlaquetteAreaForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param stiffness  the stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above
     * @param target  the target A0 of the total area, nm^2, above zero
     */
    PlaquetteAreaForce(const std::vector<int>& triangles, double stiffness, double target)
        : MembraneForce("PlaquetteAreaForce", triangles, {stiffness, target}) {
    }
    /**
     * Get the stiffness k, (3/2) kB T in the paper, kJ/mol.
     */
    double getStiffness() const {
        return getParameterValue("stiffness");
    }
    /**
     * Set the stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above.
     */
    void setStiffness(double stiffness) {
        setParameterValue("stiffness", stiffness);
    }
    /**
     * Get the target A0 of the total area, nm^2.
     */
    double getTarget() const {
        return getParameterValue("target");
    }
    /**
     * Set the target A0 of the total area, nm^2, above zero.
     */
    void setTarget(double target) {
        setParameterValue("target", target);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_PLAQUETTE_AREA_FORCE_H_*/
