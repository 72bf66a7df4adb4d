#ifndef HELFRICH_PLATFORM_H_
#define HELFRICH_PLATFORM_H_

#include "HelfrichDynamics.h"
#include "MembraneCrowd.h"
#include "openmm-helfrich/internal/Core.h"

#include <openmm/reference/ReferencePlatform.h>

#include <deque>
#include <map>
#include <string>

namespace HelfrichPlugin {

/**
 * OpenMM's Reference platform with fast time steps.
 *
 * Forces and integrators are Reference's, in double precision, but for the kernels in HelfrichKernels.h. OpenMM
 * chooses it for Systems whose work is their membranes (PlatformChoice.h), unless another platform is named. For
 * all others it gives its speed as less than Reference's; it does them if asked to.
 *
 * Property: "Threads", the number of threads of a Context. Its default is OPENMM_CPU_THREADS, if the environment has
 * it, or else the number of processors that the process may use.
 */
class HelfrichPlatform : public OpenMM::ReferencePlatform {
public:
    class PlatformData;
    HelfrichPlatform();
    const std::string& getName() const;
    /** 1000 while OpenMM chooses a platform for a Context with a membrane, else 0.5. */
    double getSpeed() const;
    const std::string& getPropertyValue(const OpenMM::Context& context, const std::string& property) const;
    void contextCreated(OpenMM::ContextImpl& context, const std::map<std::string, std::string>& properties) const;
    void contextDestroyed(OpenMM::ContextImpl& context) const;
    /** The data of a Context, or null if it belongs to another platform. */
    static PlatformData* getData(OpenMM::ContextImpl& context);
    /**
     * Support what plugins have registered for the Reference platform before this one was there. Later
     * plugins find it themselves, as they find CPU: by its base class.
     */
    void adoptReferenceKernels();
};

/**
 * What a Context has on this platform. Kernels of the Reference platform take it for Reference's.
 */
class HelfrichPlatform::PlatformData : public OpenMM::ReferencePlatform::PlatformData {
public:
    PlatformData(const OpenMM::System& system, int numThreads);
    PlatformData(const PlatformData&) = delete;
    ~PlatformData();
    /** The Context's threads, which are started when first asked for; null if there is only one. */
    HelfrichTeam* getTeam();
    /** The same where steps of this many particles are for them, else null. */
    HelfrichTeam* findTeam();
    /** A new stream of random numbers, with a seed of its own if the given one is 0. */
    HelfrichStream& addStream(int seed);

    const int numThreads;
    const std::string threadsProperty;
    /** In the order in which kernels were made; they stay where they are. */
    std::deque<HelfrichStream> streams;
    MembraneCrowd crowd;

private:
    HelfrichTeam* team;
};

/** The number of threads that a Context asks for by its property, or 0 on other platforms. */
int helfrichThreads(OpenMM::ContextImpl& context);

} // namespace HelfrichPlugin

#endif /*HELFRICH_PLATFORM_H_*/
