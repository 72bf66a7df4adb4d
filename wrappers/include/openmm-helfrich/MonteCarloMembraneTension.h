#ifndef HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_H_
#define HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_H_

#include "MonteCarloMover.h"
#include "internal/ConnectivityImpl.h"
#include "internal/HelfrichForce.h"
#include "internal/UpdatableImpl.h"

#include <openmm/Context.h>

#include <cmath>
#include <map>
#include <string>

namespace HelfrichPlugin {

/**
 * Keeps a membrane that spans the periodic box at constant tension: now and then it tries to change the box, and all
 * positions with it, so that the frame of the membrane breathes during a simulation. Without it the frame's area is
 * constant.
 *
 * OpenMM's barostats move molecules by their centres, and a membrane that spans the box is one molecule: the box would
 * change and the membrane would not. Here the vertices of membranes with periodic boundary conditions are scaled one by
 * one. All else moves by the centres of its molecules; a membrane without periodic boundary conditions, which cannot
 * span the box, is one. (A molecule that is bound to such vertices is scaled by its own centre, without them;
 * setScaleMoleculesAsRigid(false) scales every particle, also those of polymers that span the box.) Let N be the number
 * of the bodies that are so scaled and move: A_p the area of the frame, which is the box seen along z, L_x L_y; E the
 * potential energy of the force groups of the integrator (Integrator::getIntegrationForceGroups()), beta = 1 / kB T,
 * tau the tension and f the pulling force. A positive tension stretches. With an integrator that keeps the temperature,
 * each mode samples positions and box of the weight
 *
 *     XYIsotropic       exp(-beta (E - tau A_p)) dA_p          x and y scaled alike, z fixed
 *     XYIndependent     exp(-beta (E - tau A_p)) dL_x dL_y     x or y, by chance
 *     XYConstantArea    exp(-beta E) d(ln L_x)                 x and 1 / y, at constant A_p
 *     ZOnly             exp(-beta (E - f L_z)) dL_z            z scaled, x and y fixed
 *
 * each times the volume element dr of the N bodies in the box. In fractions of the box it is A_p^N ds, L_x^N L_y^N ds,
 * ds and L_z^N ds, since a scaling by s_x, s_y, s_z multiplies the volume of configurations by (s_x s_y s_z)^N. A new
 * A_p, L or ln L_x is chosen uniformly within a width on both sides of the old one, so that a move is accepted with
 * the probability
 *
 *     min(1, exp(-beta (dE - tau dA_p) + N ln(A_p' / A_p)))
 *
 * in the first two modes, min(1, exp(-beta dE)) at constant area, and for ZOnly with f dL and L in place of tau dA_p
 * and A_p: D. Frenkel and B. Smit, Understanding Molecular Simulation, chapter 5,
 * doi:10.1016/B978-0-12-267351-1.X5000-7. The tension is that of the frame, which is conjugate to A_p, not to the area
 * of the membrane itself: see F. Schmid, doi:10.1209/0295-5075/95/28008. For XYIndependent and
 * XYConstantArea nothing but the energy holds the ratio of L_x and L_y, so that the box of a fluid membrane becomes
 * ever narrower; XYIsotropic keeps it. For a tube along z, f is the force that pulls it.
 *
 * The box vectors are scaled in the same way, each of their components with its coordinate, which keeps a triclinic box
 * exactly what it was to the particles; L_x, L_y and L_z are its diagonal. Positions are scaled about the origin.
 * Particles of mass 0 are scaled one by one and not counted in N; virtual sites follow. Constraints of vertices are
 * refused. Like OpenMM's barostats, this class scales positions only: integrators that keep velocities of half a step
 * ago take the new forces for the kick of the whole step, which leaves a little heat, of second order in the step.
 *
 * OpenMM's barostats adapt the width of their moves for ever, which disturbs the distribution a little. Here it is
 * adapted during the first moves only (setAdaptiveMoves()), by their rule: from 1 % of the box on, divided by 1.1 where
 * of ten moves or more less than a quarter was accepted, multiplied by 1.1 where it was more than three quarters,
 * up to 30 % of the box. From then on it is constant, and the distribution exact.
 *
 * A move costs two evaluations of the energy. It is tried whenever an integrator updates the state of the Context: all
 * integrators of OpenMM do, a CustomIntegrator where it has addUpdateContextState(). RPMDIntegrator, whose beads have
 * positions of their own, is refused, and so are OpenMM's barostats beside it and two of this class that change the
 * same axis. Some force of the System must use periodic boundary conditions. Checkpoints of platform Helfrich hold
 * widths, random numbers and statistics, as the files of Python's save_state() do.
 *
 * OpenMM's barostats are refused by themselves where a membrane spans the box, unless they scale every particle
 * (setScaleMoleculesAsRigid(False)) or never act (frequency 0).
 */
class MonteCarloMembraneTension : public MonteCarloMover<HelfrichForce> {
public:
    /**
     * Which edges of the box change.
     */
    enum Axes {
        /**
         * x and y by the same factor.
         */
        XYIsotropic = 0,
        /**
         * x or y, by chance.
         */
        XYIndependent = 1,
        /**
         * x by a factor and y by its inverse. Neither the tension nor the pulling force is used.
         */
        XYConstantArea = 2,
        /**
         * z, against the pulling force. The tension is not used.
         */
        ZOnly = 3
    };
    /**
     * The name of the Context parameter that holds the tension, kJ/mol/nm^2; with XYConstantArea and ZOnly, which do
     * not use it, there is none.
     */
    static const std::string& Tension() {
        static const std::string key = "MembraneTension";
        return key;
    }
    /**
     * The name of the Context parameter that holds the pulling force along z, kJ/mol/nm.
     */
    static const std::string& PullingForce() {
        static const std::string key = "MembranePullingForce";
        return key;
    }
    /**
     * The name of the Context parameter that holds the temperature of the moves, K.
     */
    static const std::string& Temperature() {
        static const std::string key = "MembraneTensionTemperature";
        return key;
    }
    /**
     * @param temperature   the default temperature, K, above zero: that of the thermostat
     * @param tension       the default tension of the frame, kJ/mol/nm^2; positive stretches
     * @param frequency     every how many time steps a move is tried; 0 for never
     * @param axes          which edges of the box change
     * @param pullingForce  the default force along z, kJ/mol/nm; positive stretches
     */
    explicit MonteCarloMembraneTension(double temperature, double tension = 0, int frequency = 25,
                                       Axes axes = XYIsotropic, double pullingForce = 0)
        : MonteCarloMover(temperature, frequency, "MonteCarloMembraneTension"), scaleMoleculesAsRigid(true),
          adaptiveMoves(1000) {
        setDefaultTension(tension);
        setAxes(axes);
        setDefaultPullingForce(pullingForce);
    }
    /**
     * Get the default tension, kJ/mol/nm^2.
     */
    double getDefaultTension() const {
        return tension;
    }
    /**
     * Set the default tension, kJ/mol/nm^2, of Contexts that are made from now on; in others it is the parameter
     * Tension().
     */
    void setDefaultTension(double tension) {
        if (!std::isfinite(tension))
            fail("tension must be a finite number of kJ/mol/nm^2, got " + formatted(tension));
        this->tension = tension;
    }
    /**
     * Get the default pulling force along z, kJ/mol/nm.
     */
    double getDefaultPullingForce() const {
        return pullingForce;
    }
    /**
     * Set the default pulling force along z, kJ/mol/nm, of Contexts that are made from now on; in others it is the
     * parameter PullingForce().
     */
    void setDefaultPullingForce(double pullingForce) {
        if (!std::isfinite(pullingForce))
            fail("pullingForce must be a finite number of kJ/mol/nm, got " + formatted(pullingForce));
        this->pullingForce = pullingForce;
    }
    /**
     * Get which edges of the box change.
     */
    Axes getAxes() const {
        return axes;
    }
    /**
     * Set which edges of the box change, in Contexts that are made from now on.
     */
    void setAxes(Axes axes) {
        if (axes < XYIsotropic || axes > ZOnly)
            fail("there are no axes " + std::to_string((int) axes));
        this->axes = axes;
    }
    /**
     * Get whether molecules other than membranes with periodic boundary conditions are moved by their centres.
     */
    bool getScaleMoleculesAsRigid() const {
        return scaleMoleculesAsRigid;
    }
    /**
     * Set whether molecules other than membranes with periodic boundary conditions are moved by their centres, or every
     * particle is scaled by itself, in Contexts that are made from now on.
     */
    void setScaleMoleculesAsRigid(bool rigid) {
        scaleMoleculesAsRigid = rigid;
    }
    /**
     * Get how many moves adapt their width, since a Context was made.
     */
    int getAdaptiveMoves() const {
        return adaptiveMoves;
    }
    /**
     * Set how many moves adapt their width, since a Context was made. What is sampled before is not to be used.
     */
    void setAdaptiveMoves(int moves) {
        if (moves < 0)
            fail("adaptiveMoves must be a number of moves, got " + std::to_string(moves));
        adaptiveMoves = moves;
    }
    /**
     * Copy frequency and adaptiveMoves of this object to a Context. Temperature, tension and pulling force are
     * parameters of the Context; all else needs Context::reinitialize().
     *
     * @param context  the Context to update
     */
    void updateParametersInContext(OpenMM::Context& context) {
        dynamic_cast<UpdatableImpl&>(getImplInContext(context)).updateParametersInContext(getContextImpl(context));
    }
    /**
     * Get what has come of the moves that were tried in a Context since it was made: "attempts", those "accepted",
     * "acceptance", accepted over attempts (NaN before the first); "adapting", 1 while the width is being adapted, else
     * 0; "bodies", the number N, 0 before the first; and "width", how far a move goes at most: nm^2 for XYIsotropic,
     * nm for ZOnly, a change of ln L_x for XYConstantArea. XYIndependent has "widthX" and "widthY", nm. A width is 0
     * before the first move.
     *
     * @param context  the Context
     */
    std::map<std::string, double> getStatistics(OpenMM::Context& context) const {
        return dynamic_cast<StatisticsImpl&>(getImplInContext(context)).getStatistics(getContextImpl(context));
    }
    /**
     * Get all that restoreState() needs to go on with the same moves: widths, random numbers and statistics. Neither
     * box nor positions are among it. The bytes are those of processors with little-endian numbers.
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
     * Like OpenMM's barostats, this class has neither energy nor forces, and does not make a System periodic.
     *
     * @return false
     */
    bool usesPeriodicBoundaryConditions() const {
        return false;
    }

private:
    double tension, pullingForce;
    Axes axes;
    bool scaleMoleculesAsRigid;
    int adaptiveMoves;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_MEMBRANE_TENSION_H_*/
