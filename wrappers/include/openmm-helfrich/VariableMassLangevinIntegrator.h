#ifndef HELFRICH_VARIABLE_MASS_LANGEVIN_INTEGRATOR_H_
#define HELFRICH_VARIABLE_MASS_LANGEVIN_INTEGRATOR_H_

#include "VariableMassIntegrator.h"

namespace HelfrichPlugin {

/**
 * VariableMassVerletIntegrator in a bath: before and after the leapfrog, momenta take half a step of
 *
 *     dp_i = -gamma p_i dt + sqrt(2 gamma m_i(q) kB T) dW
 *
 * at constant positions, which is solved exactly. For small steps positions and momenta have the weight
 * exp(-H(p, q) / kB T).
 *
 * The random numbers are functions of the seed and the number of the step: the same seed gives the same bits on any
 * number of threads. Checkpoints have where they are.
 */
class VariableMassLangevinIntegrator : public VariableMassIntegrator {
public:
    /**
     * @param temperature    the temperature of the bath, K
     * @param frictionCoeff  gamma, what couples the momenta to the bath, 1/ps
     * @param stepSize       the step size, ps
     * @param density        the mass per area, amu/nm^2, or 0 for surfaces of constant mass
     */
    VariableMassLangevinIntegrator(double temperature, double frictionCoeff, double stepSize, double density = 0)
        : VariableMassIntegrator("VariableMassLangevinIntegrator", stepSize, density), randomNumberSeed(0) {
        setTemperature(temperature);
        setFriction(frictionCoeff);
    }
    /**
     * Get the temperature of the bath, K.
     */
    double getTemperature() const {
        return temperature;
    }
    /**
     * Set the temperature of the bath, K.
     */
    void setTemperature(double temperature) {
        if (!(temperature >= 0 && std::isfinite(temperature)))
            fail("temperature must be a finite number of K, zero or above, got " + formatted(temperature));
        this->temperature = temperature;
    }
    /**
     * Get what couples the momenta to the bath, 1/ps.
     */
    double getFriction() const {
        return friction;
    }
    /**
     * Set what couples the momenta to the bath, 1/ps.
     */
    void setFriction(double friction) {
        if (!(friction >= 0 && std::isfinite(friction)))
            fail("friction must be a finite number of 1/ps, zero or above, got " + formatted(friction));
        this->friction = friction;
    }
    /**
     * Get the seed of the random numbers.
     */
    int getRandomNumberSeed() const {
        return randomNumberSeed;
    }
    /**
     * Set the seed of the random numbers, for Contexts that are made from now on. With 0, the default, each Context
     * gets a seed of its own.
     */
    void setRandomNumberSeed(int seed) {
        randomNumberSeed = seed;
    }

private:
    double temperature, friction;
    int randomNumberSeed;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_VARIABLE_MASS_LANGEVIN_INTEGRATOR_H_*/
