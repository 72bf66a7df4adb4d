#include "HelfrichPlatform.h"
#include "HelfrichKernels.h"
#include "Movers.h"
#include "PlatformChoice.h"

#include <openmm/KernelFactory.h>
#include <openmm/OpenMMException.h>
#include <openmm/internal/ContextImpl.h>
#include <openmm/kernels.h>

#include <algorithm>
#include <cstdlib>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::map;
using std::string;

namespace {

const string THREADS = "Threads";

/** More than any machine has; a team of more is a mistake. */
const int MAX_THREADS = 1024;

// Plugins that were loaded before this one have registered their kernels with Reference, and OpenMM tells nobody their
// names: they are in a private member, which C++ lets one name in an explicit instantiation and nowhere else.
using Factories = map<string, KernelFactory*> Platform::*;
Factories getFactoriesMember();
template <Factories member>
struct Access {
    friend Factories getFactoriesMember() {
        return member;
    }
};
template struct Access<&Platform::kernelFactories>;

/** Lets Reference's factory make a kernel for this platform; each platform deletes its own factories. */
class BorrowedFactory : public KernelFactory {
public:
    explicit BorrowedFactory(const KernelFactory& owner) : owner(owner) {
    }
    KernelImpl* createKernelImpl(string name, const Platform& platform, ContextImpl& context) const {
        return owner.createKernelImpl(name, platform, context);
    }

private:
    const KernelFactory& owner;
};

int parseThreads(const string& text, const string& origin) {
    char* end = nullptr;
    long value = std::strtol(text.c_str(), &end, 10);
    if (text.empty() || *end != '\0' || value < 1 || value > MAX_THREADS)
        throw OpenMMException("Platform Helfrich: " + origin + " must be a whole number from 1 to " +
                              std::to_string(MAX_THREADS) + ", got \"" + text + "\"");
    return (int) value;
}

} // namespace

HelfrichPlatform::HelfrichPlatform() {
    KernelFactory* factory = new HelfrichKernelFactory();
    for (const string& name : HelfrichKernelFactory::getKernelNames())
        registerKernelFactory(name, factory);
    platformProperties.push_back(THREADS);
    const char* fromEnvironment = std::getenv("OPENMM_CPU_THREADS");
    setPropertyDefaultValue(THREADS,
                            fromEnvironment != nullptr
                                ? string(fromEnvironment)
                                : std::to_string(std::min(Helfrich_Team_available(), MAX_THREADS)));
    adoptReferenceKernels();
}

const string& HelfrichPlatform::getName() const {
    static const string name = "Helfrich";
    return name;
}

double HelfrichPlatform::getSpeed() const {
    return PlatformChoice::askSpeed();
}

const string& HelfrichPlatform::getPropertyValue(const Context& context, const string& property) const {
    if (property != THREADS)
        return ReferencePlatform::getPropertyValue(context, property);
    const PlatformData* data = getData(const_cast<ContextImpl&>(getContextImpl(context)));
    if (data == nullptr)
        throw OpenMMException("Platform Helfrich: the Context whose " + property +
                              " are asked for is on another platform");
    return data->threadsProperty;
}

void HelfrichPlatform::contextCreated(ContextImpl& context, const map<string, string>& properties) const {
    if (PlatformChoice::isUnasked()) {
        // OpenMM goes on with its next platform, after the second entry of this one has refused too.
        string reason = PlatformChoice::hasMembrane(context)
            ? whyNotHelfrich(context.getSystem(), context.getIntegrator())
            : "it has no membrane";
        if (!reason.empty()) {
            PlatformChoice::refuse();
            throw OpenMMException("Platform Helfrich: not for this System: " + reason);
        }
    }
    PlatformChoice::end();
    auto given = properties.find(THREADS);
    bool isGiven = given != properties.end();
    const string& fallback = getPropertyDefaultValue(THREADS);
    // The default may come from the environment, which a user may not think of.
    const char* fromEnvironment = std::getenv("OPENMM_CPU_THREADS");
    bool isEnvironment = !isGiven && fromEnvironment != nullptr && fallback == fromEnvironment;
    int threads = parseThreads(isGiven ? given->second : fallback,
                               isEnvironment ? "the environment variable OPENMM_CPU_THREADS" : THREADS);
    // Kernels cast the pointer to Reference's class, so it must be one to this part of the object.
    ReferencePlatform::PlatformData* data = new PlatformData(context.getSystem(), threads);
    context.setPlatformData(data);
}

void HelfrichPlatform::contextDestroyed(ContextImpl& context) const {
    // Reference's class has no virtual destructor: the object must be deleted as what it is.
    delete getData(context);
}

HelfrichPlatform::PlatformData* HelfrichPlatform::getData(ContextImpl& context) {
    if (dynamic_cast<const HelfrichPlatform*>(&context.getPlatform()) == nullptr)
        return nullptr;
    return static_cast<PlatformData*>(static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData()));
}

void HelfrichPlatform::adoptReferenceKernels() {
    Factories member = getFactoriesMember();
    for (auto& [name, factory] : Platform::getPlatformByName("Reference").*member)
        if ((this->*member).count(name) == 0)
            registerKernelFactory(name, new BorrowedFactory(*factory));
}

HelfrichPlatform::PlatformData::PlatformData(const System& system, int numThreads)
    : ReferencePlatform::PlatformData(system, numThreads), numThreads(numThreads),
      threadsProperty(std::to_string(numThreads)), team(nullptr) {
}

HelfrichPlatform::PlatformData::~PlatformData() {
    Helfrich_Team_destroy(team);
}

HelfrichTeam* HelfrichPlatform::PlatformData::getTeam() {
    if (team == nullptr && numThreads > 1)
        check(Helfrich_Team_create(numThreads, &team));
    return team;
}

HelfrichTeam* HelfrichPlatform::PlatformData::findTeam() {
    return Helfrich_Dynamics_usesTeam(numParticles, crowd.usesTeam()) ? getTeam() : nullptr;
}

HelfrichStream& HelfrichPlatform::PlatformData::addStream(int seed) {
    // The second half of the key keeps two integrators of one seed apart.
    streams.push_back({{toKey(seed), (uint32_t) streams.size()}, 0});
    return streams.back();
}

int HelfrichPlugin::helfrichThreads(ContextImpl& context) {
    auto* data = HelfrichPlatform::getData(context);
    return data == nullptr ? 0 : data->numThreads;
}
