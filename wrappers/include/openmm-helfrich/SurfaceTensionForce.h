#ifndef HELFRICH_SURFACE_TENSION_FORCE_H_
#define HELFRICH_SURFACE_TENSION_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * A surface tension on the total area A of a membrane:
 *
 *     E = sigma A
 *
 * sigma is the energy per area of a membrane that exchanges area with a reservoir, the Lagrange multiplier of the area
 * in Deuling and Helfrich, J. Phys. (Paris) 37, 1335 (1976), doi:10.1051/jphys:0197600370110133500, and in Seifert,
 * Adv. Phys. 46, 13 (1997), doi:10.1080/00018739700101488. A is the sum over all triangles, of all components of the
 * surface, closed or with borders.
 *
 * Vertices are not exchanged with the reservoir: triangles grow or shrink, and a TriangleHeightForce, say, must keep
 * them from collapsing. A membrane under tension by the frame that it spans, at constant area, is another thing:
 * MonteCarloMembraneTension.
 */
class SurfaceTensionForce : public MembraneForce {
public:
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param tension    the tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign
     */
    SurfaceTensionForce(const std::vector<int>& triangles, double tension)
        : MembraneForce("SurfaceTensionForce", triangles, {tension}) {
    }
    /**
     * Get the tension sigma, kJ/mol/nm^2.
     */
    double getTension() const {
        return getParameterValue("tension");
    }
    /**
     * Set the tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign.
     */
    void setTension(double tension) {
        setParameterValue("tension", tension);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SURFACE_TENSION_FORCE_H_*/
