#ifndef HELFRICH_BAROSTATS_H_
#define HELFRICH_BAROSTATS_H_

#include <openmm/System.h>

#include <string>

namespace HelfrichPlugin {

/**
 * Refuse OpenMM's barostats beside one of ours, unless they never act.
 *
 * @param subject  the class that the message shall name
 * @param system   the System
 */
void refuseBarostats(const std::string& subject, const OpenMM::System& system);

/**
 * Refuse OpenMM's barostats that move molecules by their centres, for a membrane that spans the periodic box.
 *
 * @param subject  the class that the message shall name
 * @param system   the System
 */
void refuseTearing(const std::string& subject, const OpenMM::System& system);

/**
 * Refuse OpenMM's barostats that scale the positions of single particles, and so change the shape of membranes.
 *
 * @param subject  the class that the message shall name
 * @param system   the System
 */
void refuseScaling(const std::string& subject, const OpenMM::System& system);

} // namespace HelfrichPlugin

#endif /*HELFRICH_BAROSTATS_H_*/
