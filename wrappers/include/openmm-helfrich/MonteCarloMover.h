#ifndef HELFRICH_MONTE_CARLO_MOVER_H_
#define HELFRICH_MONTE_CARLO_MOVER_H_

#include "internal/Core.h"

#include <cmath>
#include <string>

namespace HelfrichPlugin {

/**
 * What makes random moves now and then, at the temperature of a bath: what all such classes have in common. Base is a
 * HelfrichForce.
 */
template <class Base>
class MonteCarloMover : public Base {
public:
    /**
     * Get the default temperature, K.
     */
    double getDefaultTemperature() const {
        return temperature;
    }
    /**
     * Set the default temperature, K, above zero, of Contexts that are made from now on; in others it is the parameter
     * Temperature().
     */
    void setDefaultTemperature(double temperature) {
        if (!(temperature > 0 && std::isfinite(temperature)))
            this->fail("temperature must be a finite number of K above zero, got " + formatted(temperature));
        this->temperature = temperature;
    }
    /**
     * Get every how many time steps there are moves.
     */
    int getFrequency() const {
        return frequency;
    }
    /**
     * Set every how many time steps there are moves; 0 for never.
     */
    void setFrequency(int frequency) {
        if (frequency < 0)
            this->fail("frequency must be a number of steps, or 0 for never, got " + std::to_string(frequency));
        this->frequency = frequency;
    }
    /**
     * Get the seed of the random numbers.
     */
    int getRandomNumberSeed() const {
        return randomNumberSeed;
    }
    /**
     * Set the seed of the random numbers, for Contexts that are made from now on. The same seed gives the same moves,
     * on any number of threads. With 0, the default, each Context gets a seed of its own.
     */
    void setRandomNumberSeed(int seed) {
        randomNumberSeed = seed;
    }

protected:
#ifndef SWIG
    /**
     * @param temperature  the default temperature, K
     * @param frequency    every how many time steps there are moves
     * @param base         the arguments of the base
     */
    template <class... Arguments>
    MonteCarloMover(double temperature, int frequency, const Arguments&... base) : Base(base...), randomNumberSeed(0) {
        setDefaultTemperature(temperature);
        setFrequency(frequency);
    }
#endif

private:
    double temperature;
    int frequency, randomNumberSeed;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_MONTE_CARLO_MOVER_H_*/
