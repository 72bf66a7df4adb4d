#ifndef HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_H_
#define HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_H_

#include "MonteCarloMover.h"
#include "TriangulatedForce.h"
#include "internal/UpdatableImpl.h"

#include <cmath>
#include <string>
#include <vector>

namespace HelfrichPlugin {

/**
 * Makes a membrane viscous: friction along the edges of the mesh against relative motion of their ends, with the noise
 * that belongs to it.
 *
 * For the edge of vertices i and j let e be the unit vector from j to i and u = (v_i - v_j) . e. In continuous time the
 * force on i is
 *
 *     -gamma u e + sqrt(2 gamma kB T) xi(t) e
 *
 * and the opposite one acts on j: the dissipative and random forces along edges of D. A. Fedosov, B. Caswell and
 * G. E. Karniadakis, doi:10.1016/j.bpj.2010.02.002, with their Gamma^T = 0 and Gamma^C = gamma. Every `frequency` steps
 * each edge in turn gets the exact solution over the time dt of these steps, with the reduced mass mu of the two ends
 * and a standard normal xi, at fixed positions:
 *
 *     u -> u exp(-gamma dt / mu) + sqrt(kB T / mu (1 - exp(-2 gamma dt / mu))) xi
 *
 * This conserves momentum and angular momentum and leaves the Boltzmann distribution of the temperature T unchanged,
 * for any friction and time step (T. Shardlow, doi:10.1137/S1064827501392879; E. A. J. F. Peters,
 * doi:10.1209/epl/i2004-10010-4). Edges are those of the present triangles, which MonteCarloBondFlip changes; in a
 * periodic box they connect nearest images, as they do for the membrane forces on the same triangles, or where there
 * are none, for the System.
 *
 * A regular triangular net has the surface shear viscosity sqrt(3) / 4 gamma, amu/ps, and twice that for dilation; see
 * docs/viscosity.md. Rigid motions are not damped, nor are motions that change no edge's length: a flat membrane moves
 * freely along its normal. Together with VerletIntegrator this is a thermostat of its own that conserves momentum; with
 * LangevinMiddleIntegrator of little friction it leaves to that what it does not reach.
 *
 * Integrators that kick once a step (VerletIntegrator, LangevinMiddleIntegrator, LangevinIntegrator,
 * NoseHooverIntegrator, DPDIntegrator, and those with variable steps) keep velocities of half a step ago when they
 * update the state of the Context. Friction on these at the present positions would push forces in as much as
 * gamma dt / 2 m, and configurations would be too cold by that. So the vertices go back by half a step there, to where
 * they had these velocities, and on with the new ones: the middle scheme (Z. Zhang et al.,
 * doi:10.1021/acs.jpca.9b02771), which takes no forces and whose error is of second order, as that of the integrators.
 * A CustomIntegrator is taken to have velocities of the present moment, as it has with half a kick at each end of a
 * step. BrownianIntegrator, which has no velocities, QTBIntegrator, whose velocities have no one temperature,
 * RPMDIntegrator, whose beads have velocities of their own, and integrators that are not OpenMM's are refused.
 *
 * Like AndersenThermostat, this class has neither energy nor forces, and acts whenever an integrator updates the state
 * of the Context: a CustomIntegrator where it has addUpdateContextState(). Vertices of mass 0 stay where they are and
 * count as infinitely heavy. Vertices with constraints and virtual sites as vertices are refused. On Reference, CPU and
 * Helfrich it works in OpenMM's own arrays; on OpenCL, CUDA and HIP velocities, and positions, travel to the processor
 * and back each time. A sweep over the edges is one thread's work, so that results are the same on any number of
 * threads. Checkpoints of platform Helfrich hold the place in the sequence of random numbers, as the files of Python's
 * save_state() do.
 */
class SurfaceViscosityThermostat : public MonteCarloMover<TriangulatedForce> {
public:
    /**
     * The name of the Context parameter that holds the friction, amu/ps, unless setFrictionParameter() names another.
     */
    static const std::string& Friction() {
        static const std::string key = "SurfaceViscosityFriction";
        return key;
    }
    /**
     * The name of the Context parameter that holds the temperature, K, for all objects of this class.
     */
    static const std::string& Temperature() {
        static const std::string key = "SurfaceViscosityTemperature";
        return key;
    }
    /**
     * @param triangles    the particle indices of the corners, three for each triangle
     * @param friction     the default friction gamma of each edge, amu/ps: force for a relative velocity
     * @param temperature  the default temperature, K, above zero
     * @param frequency    every how many time steps friction and noise act, for the time of all these steps; 0 for
     * never
     */
    SurfaceViscosityThermostat(const std::vector<int>& triangles, double friction, double temperature,
                               int frequency = 1)
        : MonteCarloMover(temperature, frequency, "SurfaceViscosityThermostat", triangles),
          frictionParameter(Friction()) {
        setDefaultFriction(friction);
    }
    /**
     * Get the default friction of each edge, amu/ps.
     */
    double getDefaultFriction() const {
        return friction;
    }
    /**
     * Set the default friction of each edge, amu/ps, 0 or more, of Contexts that are made from now on; in others it is
     * the parameter getFrictionParameter().
     */
    void setDefaultFriction(double friction) {
        if (!(friction >= 0 && std::isfinite(friction)))
            fail("friction must be a finite number of amu/ps, 0 or more, got " + formatted(friction));
        this->friction = friction;
    }
    /**
     * Get the name of the Context parameter that holds the friction.
     */
    const std::string& getFrictionParameter() const {
        return frictionParameter;
    }
    /**
     * Set the name of the Context parameter that holds the friction, in Contexts that are made from now on. Objects of
     * different frictions in one System need different names.
     */
    void setFrictionParameter(const std::string& name) {
        if (name.empty() || name == Temperature())
            fail("the Context parameter of the friction needs a name of its own, got \"" + name + "\"");
        frictionParameter = name;
    }
    /**
     * Copy the frequency of this object to a Context. Friction and temperature are parameters of the Context; changed
     * triangles are refused (use Context::reinitialize()).
     *
     * @param context  the Context to update
     */
    void updateParametersInContext(OpenMM::Context& context) {
        dynamic_cast<UpdatableImpl&>(getImplInContext(context)).updateParametersInContext(getContextImpl(context));
    }
    /**
     * Get all that restoreState() needs to go on with the same random numbers. Neither positions nor velocities are
     * among it. The bytes are those of processors with little-endian numbers.
     *
     * @param context  the Context
     */
    std::string saveState(OpenMM::Context& context) const {
        return dynamic_cast<StateImpl&>(getImplInContext(context)).saveState();
    }
    /**
     * Go on with what saveState() has returned.
     *
     * @param context  a Context with this force
     * @param saved    the bytes
     */
    void restoreState(OpenMM::Context& context, const std::string& saved) {
        dynamic_cast<StateImpl&>(getImplInContext(context)).restoreState(saved);
    }
    /**
     * Like MonteCarloBondFlip, this class follows the forces on the same triangles, and does not make a System
     * periodic.
     *
     * @return false
     */
    bool usesPeriodicBoundaryConditions() const {
        return false;
    }

private:
    double friction;
    std::string frictionParameter;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SURFACE_VISCOSITY_THERMOSTAT_H_*/
