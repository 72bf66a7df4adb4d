#ifndef HELFRICH_MONTE_CARLO_SURFACE_MOVER_H_
#define HELFRICH_MONTE_CARLO_SURFACE_MOVER_H_

#include "MonteCarloMover.h"
#include "TriangulatedForce.h"
#include "internal/UpdatableImpl.h"

#include <map>
#include <string>
#include <vector>

namespace HelfrichPlugin {

/**
 * What tries Monte Carlo moves of the edges of a surface now and then, each by the change of the energy of all membrane
 * forces on it: what all such classes have in common.
 */
class MonteCarloSurfaceMover : public MonteCarloMover<TriangulatedForce> {
public:
    /**
     * Who pays for moves.
     */
    enum Ensemble {
        /**
         * A bath of a temperature.
         */
        Canonical = 0,
        /**
         * A demon, which has no energy when a Context is made. The temperature is not used.
         */
        Microcanonical = 1
    };
    /**
     * Get how many moves are tried each time, for each edge.
     */
    double getAttemptsPerEdge() const {
        return attemptsPerEdge;
    }
    /**
     * Set how many moves are tried each time, for each edge, from 0 to 1000.
     */
    void setAttemptsPerEdge(double attemptsPerEdge) {
        if (!(attemptsPerEdge >= 0 && attemptsPerEdge <= 1000))
            fail("attemptsPerEdge must be from 0 to 1000, got " + formatted(attemptsPerEdge));
        this->attemptsPerEdge = attemptsPerEdge;
    }
    /**
     * Get who pays for moves.
     */
    Ensemble getEnsemble() const {
        return ensemble;
    }
    /**
     * Set who pays for moves: Canonical, a bath, or Microcanonical, a demon.
     */
    void setEnsemble(Ensemble ensemble) {
        if (ensemble != Canonical && ensemble != Microcanonical)
            fail("there is no ensemble " + std::to_string((int) ensemble));
        this->ensemble = ensemble;
    }
    /**
     * Copy the values of this object to a Context, except for the seed. The temperature is a parameter of the Context;
     * changed triangles are refused (use Context::reinitialize()).
     *
     * @param context  the Context to update
     */
    void updateParametersInContext(OpenMM::Context& context) {
        dynamic_cast<UpdatableImpl&>(getImplInContext(context)).updateParametersInContext(getContextImpl(context));
    }
    /**
     * Get what has come of the moves that were tried in a Context since it was made: "attempts"; those "accepted";
     * those refused, by the first reason, as the class tells; "acceptance", accepted over attempts; "time", the time
     * that has been simulated, ps; "rate", accepted for each edge and ps; and "demonEnergy", kJ/mol. Ratios are NaN as
     * long as there is nothing to divide by.
     *
     * @param context  the Context
     */
    std::map<std::string, double> getStatistics(OpenMM::Context& context) const {
        return dynamic_cast<StatisticsImpl&>(getImplInContext(context)).getStatistics(getContextImpl(context));
    }
    /**
     * Positions are taken as they are, without periodic boundary conditions.
     *
     * @return false
     */
    bool usesPeriodicBoundaryConditions() const {
        return false;
    }

protected:
#ifndef SWIG
    MonteCarloSurfaceMover(const std::string& type, const std::vector<int>& triangles, double temperature,
                           int frequency, double attemptsPerEdge)
        : MonteCarloMover(temperature, frequency, type, triangles), ensemble(Canonical) {
        setAttemptsPerEdge(attemptsPerEdge);
    }
#endif

private:
    double attemptsPerEdge;
    Ensemble ensemble;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_SURFACE_MOVER_H_*/
