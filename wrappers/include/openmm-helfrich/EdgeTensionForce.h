#ifndef HELFRICH_EDGE_TENSION_FORCE_H_
#define HELFRICH_EDGE_TENSION_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * The line tension of a membrane's borders:
 *
 *     E = gamma L
 *
 * with L the length of all borders, the edges that belong to one triangle. There is no energy on a closed surface. A
 * disk closes to a vesicle where that costs less (Helfrich, Phys. Lett. A 50, 115 (1974),
 * doi:10.1016/0375-9601(74)90899-8). GaussianCurvatureForce is the other energy that borders have, and says what keeps
 * free borders from folding over.
 */
class EdgeTensionForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param tension  the energy gamma per length, kJ/mol/nm; below zero, borders grow
     */
    EdgeTensionForce(const std::vector<int>& triangles, double tension)
        : MembraneForce("EdgeTensionForce", triangles, {tension}) {
    }
    /**
     * Get the energy per length, kJ/mol/nm.
     */
    double getTension() const {
        return getParameterValue("tension");
    }
    /**
     * Set the energy per length, kJ/mol/nm.
     */
    void setTension(double tension) {
        setParameterValue("tension", tension);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_EDGE_TENSION_FORCE_H_*/
