#ifndef HELFRICH_PLATFORM_CHOICE_H_
#define HELFRICH_PLATFORM_CHOICE_H_

#include <openmm/Integrator.h>
#include <openmm/System.h>
#include <openmm/internal/ContextImpl.h>

#include <string>

namespace HelfrichPlugin {

/**
 * Why a System is not one for the platform Helfrich, or an empty text if it is: nothing in it costs more than the
 * membranes of this plugin do, and they are not for GPU platforms only. This is the one rule that OpenMM's choice and
 * all of the package follow; which forces are cheap is listed at the head of PlatformChoice.cpp.
 *
 * On platforms of the processor membranes cost the same, so what another one could save is the step alone. Whether
 * OpenMM's GPU platforms, which can evaluate membranes themselves, are faster has not been measured.
 */
std::string whyNotHelfrich(const OpenMM::System& system, const OpenMM::Integrator& integrator);

/**
 * How OpenMM is brought to choose the platform Helfrich for such Systems, where nobody has named a platform.
 *
 * The constructor of a Context first makes the implementations of the forces and asks them for their kernels. If
 * nobody has named a platform it then asks every registered one for its speed, and tries them from the fastest
 * until one does not refuse in contextCreated. From these calls alone nobody can tell a platform that was named
 * from one that OpenMM tries; hence Helfrich is registered twice, so that it is asked twice in the latter case.
 *
 * What is noted belongs to a thread, since a constructor does all of this on one.
 */
class PlatformChoice {
public:
    /** Note that a Context is being made which has an implementation of a membrane force. */
    static void begin(const OpenMM::ForceImpl& membrane);
    /** Forget it, when the choice has been made. */
    static void end();
    /** The speed to tell OpenMM: the highest while a Context with a membrane is being made, or else the lowest. */
    static double askSpeed();
    /** Whether OpenMM tries the platform for a Context whose platform nobody has named. */
    static bool isUnasked();
    /** Whether that Context has the membrane that was noted. */
    static bool hasMembrane(const OpenMM::ContextImpl& context);
    /** Note that an entry of the platform refuses the Context. */
    static void refuse();
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_PLATFORM_CHOICE_H_*/
