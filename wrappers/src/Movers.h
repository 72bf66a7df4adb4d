#ifndef HELFRICH_MOVERS_H_
#define HELFRICH_MOVERS_H_

#include <openmm/Force.h>
#include <openmm/OpenMMException.h>
#include <openmm/System.h>
#include <openmm/internal/ContextImpl.h>
#include <openmm/internal/OSRngSeed.h>
#include <openmm/reference/SimTKOpenMMRealType.h>

#include <cmath>
#include <cstdint>
#include <string>

namespace HelfrichPlugin {

/** The first word of a key of random numbers, for a seed of a user: 0 asks for any. */
inline uint32_t toKey(int seed) {
    return (uint32_t) (seed == 0 ? osrngseed() : seed);
}

/** How many forces of a System that are like one of them come before it. */
template <class IsAlike>
uint32_t countBefore(const OpenMM::System& system, const OpenMM::Force& owner, IsAlike isAlike) {
    uint32_t count = 0;
    for (int i = 0; i < system.getNumForces() && &system.getForce(i) != &owner; i++)
        count += isAlike(system.getForce(i)) ? 1 : 0;
    return count;
}

/** kT of the bath whose temperature is a parameter of the Context, kJ/mol; messages begin with the class of the mover.
 */
inline double findThermalEnergy(const std::string& mover, OpenMM::ContextImpl& context, const std::string& parameter) {
    double temperature = context.getParameter(parameter);
    if (!(temperature > 0 && std::isfinite(temperature)))
        throw OpenMM::OpenMMException(mover + ": the Context parameter " + parameter +
                                      " must be a finite number of K above zero, got " + std::to_string(temperature));
    return BOLTZ * temperature;
}

} // namespace HelfrichPlugin

#endif /*HELFRICH_MOVERS_H_*/
