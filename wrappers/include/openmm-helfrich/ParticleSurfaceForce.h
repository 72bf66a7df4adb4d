#ifndef HELFRICH_PARTICLE_SURFACE_FORCE_H_
#define HELFRICH_PARTICLE_SURFACE_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * A surface that other particles cannot pass, and may adhere to. With the gap g = d - R between a particle of radius R
 * and a triangle, whose nearest point is at the distance d from the particle's middle,
 *
 *     E = sum over pairs with g < D of epsilon [ (D/g)^6 - 1 ]^2
 *         - adhesion * sum over pairs of the integral of phi((|x - r| - R)/D) over the triangle
 *
 * phi(x) = 1 for x <= 1; beyond that it is 2/x^6 - 1/x^12 (LennardJones) or (3/x^3 - 1/x^9)/2 (NineThree, for a
 * particle of many Lennard-Jones particles), which the factor 1 - 10 y^3 + 15 y^4 - 6 y^5, y = x - 2, takes to zero
 * from x = 2 to 3. So `adhesion` is the energy by area, w, of what touches, on any mesh that is fine enough: edges up
 * to about D. A bead of radius R is wrapped at w (R + D)^2 > 2 kappa (M. Deserno, doi:10.1103/PhysRevE.69.031903). The
 * attraction WCA, the default, is none.
 *
 * The core acts on whole triangles, so nothing slips between vertices while steps are short against D: a particle
 * that moves farther than D in one step is not seen.
 *
 * Particles that are vertices of the same triangles are refused: SurfaceRepulsionForce is for those. The triangles may
 * be of several membranes, also where bonds flip; see there. The processor computes the force, whatever computes
 * others.
 */
class ParticleSurfaceForce : public MembraneForce {
public:
    /**
     * What attracts particles to the surface.
     */
    enum Attraction {
        /**
         * Nothing does.
         */
        WCA = 0,
        /**
         * The tail of a Lennard-Jones potential.
         */
        LennardJones = 1,
        /**
         * The tail of its integral over a half-space.
         */
        NineThree = 2
    };
    /**
     * @param triangles   the particle indices of the corners, three for each triangle
     * @param particles   the indices of the particles that the surface acts on, none of them a corner
     * @param distance    the gap D below which there is a repulsion, nm, above zero
     * @param epsilon     the strength of the repulsion, kJ/mol, zero or above
     * @param adhesion    the energy by area w of what touches, kJ/mol/nm^2, zero or above
     * @param radius      the radius R of all particles, nm, zero or above
     * @param attraction  what attracts them
     */
    ParticleSurfaceForce(const std::vector<int>& triangles, const std::vector<int>& particles, double distance,
                         double epsilon, double adhesion = 0, double radius = 0, Attraction attraction = WCA)
        : MembraneForce("ParticleSurfaceForce", triangles, {distance, epsilon, adhesion, radius}, attraction) {
        setOtherParticles(particles);
    }
    /**
     * Set the particles that the surface acts on.
     *
     * @param particles  their indices, none of them a corner of a triangle
     */
    void setParticles(const std::vector<int>& particles) {
        setOtherParticles(particles);
    }
    /**
     * Get the gap D below which there is a repulsion, nm.
     */
    double getDistance() const {
        return getParameterValue("distance");
    }
    /**
     * Set the gap D below which there is a repulsion, nm, above zero.
     */
    void setDistance(double distance) {
        setParameterValue("distance", distance);
    }
    /**
     * Get the strength of the repulsion, kJ/mol.
     */
    double getEpsilon() const {
        return getParameterValue("epsilon");
    }
    /**
     * Set the strength of the repulsion, kJ/mol, zero or above.
     */
    void setEpsilon(double epsilon) {
        setParameterValue("epsilon", epsilon);
    }
    /**
     * Get the energy by area w of what touches, kJ/mol/nm^2.
     */
    double getAdhesion() const {
        return getParameterValue("adhesion");
    }
    /**
     * Set the energy by area w of what touches, kJ/mol/nm^2, zero or above.
     */
    void setAdhesion(double adhesion) {
        setParameterValue("adhesion", adhesion);
    }
    /**
     * Get the radius R of all particles, nm.
     */
    double getRadius() const {
        return getParameterValue("radius");
    }
    /**
     * Set the radius R of all particles, nm, zero or above.
     * Values of single particles are given up.
     */
    void setRadius(double radius) {
        setParameterValue("radius", radius);
    }
    /**
     * Get the radius of each particle, nm; empty if all have the same.
     */
    const std::vector<double>& getParticleRadius() const {
        return getElementValues("radius");
    }
    /**
     * Give each particle its own radius, which replaces the scalar.
     *
     * @param values  one for each particle, in the order of getParticles(), nm; empty to go back
     */
    void setParticleRadius(const std::vector<double>& values) {
        setElementValues("radius", values);
    }
    /**
     * Get what attracts particles.
     */
    Attraction getAttraction() const {
        return (Attraction) getForm();
    }
    /**
     * Set what attracts particles. updateParametersInContext() tells existing Contexts.
     */
    void setAttraction(Attraction attraction) {
        setForm(attraction);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_PARTICLE_SURFACE_FORCE_H_*/
