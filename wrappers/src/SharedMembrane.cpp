#include "SharedMembrane.h"

#include "HelfrichPlatform.h"
#include "MembraneForceImpl.h"
#include "SurfaceMoverImpl.h"
#include "SurfaceViscosityThermostatImpl.h"

#include <openmm/System.h>

#include <algorithm>
#include <mutex>
#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::shared_ptr;
using std::string;
using std::vector;

namespace {

/** The membranes of all living Contexts. Those that nobody holds any more are removed on the next visit. */
std::mutex registryMutex;
std::multimap<const ContextImpl*, std::weak_ptr<SharedMembrane>> registry;

[[noreturn]] void refuseShared(const string& subject, const string& mover, int particle) {
    throw OpenMMException(
        subject + ": particle " + std::to_string(particle) + " belongs to two different triangulations, and a " +
        mover + " would change one of them only; give all membrane forces on these particles and the " + mover +
        " the same triangles in the same order (SurfaceRepulsionForce, ParticleSurfaceForce and "
        "SurfaceViscosityThermostat may have those of several such membranes, one after another)");
}

} // namespace

shared_ptr<SharedMembrane> SharedMembrane::acquire(const string& subject, ContextImpl& context,
                                                   const vector<int>& triangles) {
    vector<shared_ptr<SharedMembrane>> known = findAll(context);
    for (const auto& membrane : known)
        if (membrane->triangles == triangles)
            return membrane;
    shared_ptr<SharedMembrane> membrane(new SharedMembrane(subject, context, triangles));
    for (const auto& other : known) {
        link(membrane, other);
        link(other, membrane);
        if (other->findMover() != nullptr)
            refuseOthers(subject, *membrane, *other);
    }
    std::lock_guard<std::mutex> lock(registryMutex);
    registry.emplace(&context, membrane);
    return membrane;
}

vector<shared_ptr<SharedMembrane>> SharedMembrane::findAll(ContextImpl& context) {
    std::lock_guard<std::mutex> lock(registryMutex);
    vector<shared_ptr<SharedMembrane>> found;
    for (auto entry = registry.begin(); entry != registry.end();) {
        if (entry->second.expired()) {
            entry = registry.erase(entry);
            continue;
        }
        // Those of other Contexts must not be held, be it for a moment: another thread may be about to end their
        // lives, and then this one would, when their devices are gone.
        shared_ptr<SharedMembrane> membrane = entry->first == &context ? entry->second.lock() : nullptr;
        if (membrane != nullptr && membrane->belongsTo(context))
            found.push_back(membrane);
        ++entry;
    }
    return found;
}

void SharedMembrane::link(const shared_ptr<SharedMembrane>& whole, const shared_ptr<SharedMembrane>& part) {
    const vector<int>&all = whole->triangles, &some = part->triangles;
    // Each corner belongs to one part only, so a triangle can begin at one place only.
    for (size_t first = 0; first + some.size() <= all.size(); first += 3)
        if (std::equal(some.begin(), some.end(), all.begin() + first)) {
            whole->parts.push_back({part, (int64_t) first / 3, 0});
            part->wholes.push_back({whole, (int64_t) first / 3, 0});
            return;
        }
}

bool SharedMembrane::hasOnlyContacts() const {
    return std::all_of(members.begin(), members.end(),
                       [](const MembraneForceImpl* member) { return member->isContact(); });
}

void SharedMembrane::checkJoining(const string& subject, int potential) const {
    if (Helfrich_Potential_isContact(potential))
        return;
    for (const Link& link : parts)
        if (auto part = link.other.lock())
            if (const SurfaceMoverImpl* mover = part->findMover())
                refuseShared(subject, mover->getOwner().getTypeName(), part->triangles[0]);
}

void SharedMembrane::followParts(ContextImpl& context) {
    vector<int> corners;
    for (Link& link : parts) {
        shared_ptr<SharedMembrane> part = link.other.lock();
        if (part == nullptr)
            continue;
        part->settle(context);
        double present = part->getFingerprint();
        if (present == link.followed)
            continue;
        if (corners.empty())
            corners = getConnectivity().corners;
        vector<int> theirs = part->getConnectivity().corners;
        std::copy(theirs.begin(), theirs.end(), corners.begin() + 3 * link.firstTriangle);
        link.followed = present;
    }
    if (!corners.empty())
        check(Helfrich_Membrane_setTriangles("", core, corners.data(), (int64_t) corners.size() / 3));
}

void SharedMembrane::refuseOthers(const string& subject, const SharedMembrane& one, const SharedMembrane& other) {
    for (const auto& [whole, part] : {std::make_pair(&one, &other), std::make_pair(&other, &one)})
        for (const Link& link : whole->parts)
            if (link.other.lock().get() == part && whole->findMover() == nullptr && whole->hasOnlyContacts())
                return;
    const SurfaceMoverImpl* mover = one.findMover() != nullptr ? one.findMover() : other.findMover();
    std::set<int> particles(one.triangles.begin(), one.triangles.end());
    for (int particle : other.triangles)
        if (particles.count(particle) != 0)
            refuseShared(subject, mover->getOwner().getTypeName(), particle);
}

const SurfaceMoverImpl* SharedMembrane::findMover() const {
    for (const SurfaceMoverImpl* mover : movers)
        if (mover != nullptr)
            return mover;
    return nullptr;
}

SharedMembrane::SharedMembrane(const string& subject, ContextImpl& context, const vector<int>& triangles)
    : triangles(triangles), core(nullptr), inCrowd(false), movers(), hasLeftBehind(false), permutationFingerprint(0),
      spans(false) {
    check(Helfrich_Membrane_create(subject.c_str(), triangles.data(), (int64_t) triangles.size() / 3,
                                   context.getSystem().getNumParticles(), &core));
    if (int threads = helfrichThreads(context))
        Helfrich_Membrane_setThreads(core, threads);
    try {
        chooseForAll(context.getSystem());
    } catch (...) {
        Helfrich_Membrane_destroy(core);
        throw;
    }
    inherit();
}

void SharedMembrane::chooseForAll(const System& system) {
    for (int i = 0; i < system.getNumForces(); i++) {
        auto* force = dynamic_cast<const MembraneForce*>(&system.getForce(i));
        if (force != nullptr && force->getTriangles() == triangles)
            check(Helfrich_Membrane_choose(force->getTypeName().c_str(), core, force->getBackend().c_str()));
    }
}

SharedMembrane::~SharedMembrane() {
    Helfrich_Membrane_destroy(core);
}

bool SharedMembrane::belongsTo(ContextImpl& context) const {
    const vector<ForceImpl*>& impls = context.getForceImpls();
    auto isThere = [&](const ForceImpl* impl) { return std::find(impls.begin(), impls.end(), impl) != impls.end(); };
    if (findMover() == nullptr && members.empty() && thermostats.empty())
        return false;
    auto isThereIfAny = [&](const SurfaceMoverImpl* mover) { return mover == nullptr || isThere(mover); };
    return std::all_of(std::begin(movers), std::end(movers), isThereIfAny) &&
        std::all_of(members.begin(), members.end(), isThere) &&
        std::all_of(thermostats.begin(), thermostats.end(), isThere);
}

void SharedMembrane::join(MembraneForceImpl* member) {
    members.push_back(member);
    forgetKinds();
}

void SharedMembrane::checkAgreement(const MembraneForceImpl& joining) const {
    checkAgreementWithMembers(joining, "on the same triangles");
    for (const vector<Link>* links : {&parts, &wholes})
        for (const Link& link : *links)
            if (auto other = link.other.lock())
                other->checkAgreementWithMembers(joining, "on triangles of which some are the same");
}

void SharedMembrane::checkAgreementWithMembers(const MembraneForceImpl& joining, const string& where) const {
    if (members.empty() || members[0]->isPeriodic() == joining.isPeriodic())
        return;
    const MembraneForceImpl& periodic = joining.isPeriodic() ? joining : *members[0];
    const MembraneForceImpl& other = joining.isPeriodic() ? *members[0] : joining;
    throw OpenMMException(joining.getOwner().getTypeName() + ": of the forces " + where + ", \"" +
                          periodic.getOwner().getName() + "\" uses periodic boundary conditions and \"" +
                          other.getOwner().getName() +
                          "\" does not; call setUsesPeriodicBoundaryConditions() of both with the same value");
}

void SharedMembrane::leave(MembraneForceImpl* member) {
    members.erase(std::remove(members.begin(), members.end(), member), members.end());
    forgetKinds();
}

void SharedMembrane::join(SurfaceMoverImpl* joining, ContextImpl& context) {
    const string& subject = joining->getOwner().getTypeName();
    SurfaceMoverImpl*& mover = movers[(int) joining->getKind()];
    if (mover != nullptr)
        throw OpenMMException(subject + ": the same triangles have another " + subject +
                              "; one is enough, with more attemptsPerEdge if need be");
    vector<shared_ptr<SharedMembrane>> known = findAll(context);
    mover = joining;
    try {
        for (const auto& other : known)
            if (other.get() != this)
                refuseOthers(subject, *this, *other);
    } catch (...) {
        mover = nullptr;
        throw;
    }
}

void SharedMembrane::leave(SurfaceMoverImpl* leaving, ContextImpl& context) {
    SurfaceMoverImpl*& mover = movers[(int) leaving->getKind()];
    if (mover != leaving)
        return;
    // All that the first of them leaves behind is of all.
    if (!hasLeftBehind)
        leaveBehind(context);
    hasLeftBehind = true;
    mover = nullptr;
}

vector<std::pair<int, int>> SharedMembrane::getEdges() const {
    vector<int> particles(2 * Helfrich_Membrane_numEdges(core));
    Helfrich_Membrane_edges(core, particles.data());
    vector<std::pair<int, int>> edges;
    edges.reserve(particles.size() / 2);
    for (size_t i = 0; i < particles.size(); i += 2)
        edges.emplace_back(particles[i], particles[i + 1]);
    return edges;
}
