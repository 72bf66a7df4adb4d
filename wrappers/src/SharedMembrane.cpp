#include "SharedMembrane.h"

#include "Barostats.h"
#include "HelfrichPlatform.h"
#include "MembraneForceImpl.h"
#include "SurfaceMoverImpl.h"
#include "SurfaceViscosityThermostatImpl.h"

#include <openmm/System.h>

#include <algorithm>
#include <iostream>
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

bool SharedMembrane::isPeriodic() const {
    return !members.empty() && members[0]->isPeriodic();
}

const double* SharedMembrane::findBox(ContextImpl& context) {
    if (!isPeriodic())
        return nullptr;
    context.getPeriodicBoxVectors(box[0], box[1], box[2]);
    return reinterpret_cast<const double*>(box);
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

bool SharedMembrane::isLeader(const MembraneForceImpl& member, int groups) const {
    for (const MembraneForceImpl* other : members)
        if (other->isInGroups(groups) && other->isNative() == member.isNative())
            return other == &member;
    return false;
}

bool SharedMembrane::startNative(const MembraneForce& force, ContextImpl& context, int potential) {
    int wish = Helfrich_Membrane_wishesNative(core);
    if (wish == 0)
        return false;
    bool isMust = wish == 2;
    string reason = NativeMembrane::whyNot(context);
    if (!reason.empty()) {
        // OpenMM's minimizer has a second Context on the processor for forces that are too large for its own.
        if (isMust && !NativeMembrane::isElsewhere(context.getSystem()))
            throw OpenMMException(force.getTypeName() + ": the backend \"native\" cannot be had here: " + reason);
        return false;
    }
    // An OpenCL driver that computes on the processor is slower there than our own code.
    if (!isMust && NativeMembrane::isOnProcessor(context))
        return false;
    // Contacts and volumes in a periodic box are for the processor, whatever evaluates the rest.
    if (!Helfrich_Native_canEvaluate(potential, force.usesPeriodicBoundaryConditions()))
        return false;
    if (native != nullptr)
        return true;
    const NativeMembrane* sibling = nullptr;
    for (const auto& other : findAll(context))
        if (other->native != nullptr)
            sibling = other->native.get();
    try {
        native.reset(new NativeMembrane(context, core, getEdges(), sibling));
    } catch (const std::exception& error) {
        if (isMust)
            throw OpenMMException(force.getTypeName() + ": the backend \"native\" cannot be had here: " + error.what());
        static std::once_flag said;
        std::call_once(said, [&] {
            std::cerr << "openmm-helfrich: the platform " << context.getPlatform().getName()
                      << " cannot compile the membrane's kernels; the processor takes over: " << error.what() << "\n";
        });
        return false;
    }
    return true;
}

void SharedMembrane::evaluateNatively(const string& subject, ContextImpl& context, int groups, bool forces,
                                      bool energy) {
    settle(context);
    collect(context, groups, Which::Native);
    derivativeNumbers.assign(HELFRICH_MAX_PARAMETERS * terms.size(), -1);
    bool wantsSums = energy;
    for (size_t i = 0; i < active.size(); i++)
        if (terms[i].wantsDerivatives) {
            active[i]->findDerivatives(*native, &derivativeNumbers[HELFRICH_MAX_PARAMETERS * i]);
            wantsSums = true;
        }
    native->evaluate(subject, context, terms, derivativeNumbers, forces, wantsSums, energy, findBox(context));
    noteSpanning(subject, context);
}

void SharedMembrane::noteSpanning(const string& subject, ContextImpl& context) {
    if (spans || !Helfrich_Membrane_spans(core))
        return;
    refuseTearing(subject, context.getSystem());
    spans = true;
}

void SharedMembrane::collect(ContextImpl& context, int groups, Which which) {
    active.clear();
    terms.clear();
    for (MembraneForceImpl* member : members)
        if (member->isInGroups(groups) && (which == Which::All || member->isNative() == (which == Which::Native))) {
            active.push_back(member);
            terms.push_back(member->getTerm(context));
            // Context parameters can be anything by now; the message shall name the force whose they are.
            if (member->usesContextParameters())
                checkTerm(member->getOwner().getTypeName(), terms.back());
        }
}

bool SharedMembrane::hasContacts() const {
    return std::any_of(members.begin(), members.end(),
                       [](const MembraneForceImpl* member) { return member->isContact(); });
}

void SharedMembrane::joinCrowd(bool isAlone) {
    inCrowd = true;
    if (isAlone)
        Helfrich_Membrane_setThreads(core, 1);
}

bool SharedMembrane::prepare(const Computation& computation) {
    settle(computation.context);
    collect(computation.context, computation.groups, Which::Others);
    contributions.assign(terms.size(), HelfrichContribution());
    return !active.empty();
}

HelfrichTurn SharedMembrane::getTurn(const Computation& computation) {
    bool wantsContributions = computation.includeEnergy ||
        (computation.includeDerivatives &&
         std::any_of(terms.begin(), terms.end(), [](const HelfrichTerm& term) { return term.wantsDerivatives != 0; }));
    return {active[0]->getOwner().getTypeName().c_str(),
            core,
            terms.data(),
            (int64_t) terms.size(),
            wantsContributions ? contributions.data() : nullptr,
            findBox(computation.context)};
}

double SharedMembrane::evaluate(const string& subject, ContextImpl& context, int groups, const vector<Vec3>& positions,
                                bool includeEnergy, vector<Vec3>* forces, std::map<string, double>* derivatives) {
    // Vec3 is three doubles and nothing else, but its operator[] returns copies.
    static_assert(sizeof(Vec3) == 3 * sizeof(double), "an array of Vec3 is an array of coordinates");
    Computation computation = {context, groups, positions, includeEnergy, forces, derivatives != nullptr};
    HelfrichPlatform::PlatformData* data = HelfrichPlatform::getData(context);
    if (data == nullptr || !data->crowd.evaluate(*this, computation)) {
        prepare(computation);
        HelfrichTurn turn = getTurn(computation);
        check(Helfrich_Membrane_evaluate(turn.subject, turn.membrane, turn.terms, turn.numTerms,
                                         (int64_t) positions.size(), reinterpret_cast<const double*>(positions.data()),
                                         turn.boxVectors, turn.contributions,
                                         forces == nullptr ? nullptr : reinterpret_cast<double*>(forces->data())));
    }
    noteSpanning(subject, context);
    double energy = 0;
    for (size_t i = 0; i < active.size(); i++) {
        energy += contributions[i].energy;
        if (derivatives != nullptr)
            active[i]->addDerivatives(contributions[i], *derivatives);
    }
    return energy;
}

vector<double> SharedMembrane::sumVirials(ContextImpl& context, int groups) {
    vector<Vec3> positions;
    context.getPositions(positions);
    vector<double> sum(9, 0.0);
    for (const auto& membrane : findAll(context)) {
        membrane->settle(context);
        membrane->collect(context, groups);
        if (membrane->active.empty())
            continue;
        const string& subject = membrane->active[0]->getOwner().getTypeName();
        check(Helfrich_Membrane_addVirial(subject.c_str(), membrane->core, membrane->terms.data(),
                                          (int64_t) membrane->terms.size(), (int64_t) positions.size(),
                                          reinterpret_cast<const double*>(positions.data()), membrane->findBox(context),
                                          sum.data()));
    }
    return sum;
}

int64_t SharedMembrane::flip(const string& subject, ContextImpl& context, int groups, const vector<Vec3>& positions,
                             const HelfrichFlipRules& rules, int64_t attempts, HelfrichFlipState& state,
                             vector<Vec3>* forceChange) {
    collect(context, groups);
    int64_t made = 0;
    double* change = nullptr;
    if (forceChange != nullptr) {
        forceChange->resize(positions.size());
        change = reinterpret_cast<double*>(forceChange->data());
    }
    vector<shared_ptr<SharedMembrane>> following;
    vector<HelfrichFollower> followers;
    vector<Link*> links;
    for (const Link& link : wholes)
        if (auto whole = link.other.lock()) {
            whole->settle(context);
            whole->collect(context, groups);
            following.push_back(whole);
            followers.push_back({whole->core, link.firstTriangle, whole->terms.data(), (int64_t) whole->terms.size()});
            for (Link& back : whole->parts)
                if (back.other.lock().get() == this)
                    links.push_back(&back);
        }
    check(Helfrich_Membrane_flip(subject.c_str(), core, terms.data(), (int64_t) terms.size(),
                                 (int64_t) positions.size(), reinterpret_cast<const double*>(positions.data()),
                                 findBox(context), &rules, attempts, &state, &made, change, followers.data(),
                                 (int64_t) followers.size()));
    for (Link* link : links)
        link->followed = getFingerprint();
    return made;
}

HelfrichViscosity* SharedMembrane::makeViscosity(const string& subject, const vector<double>& masses) const {
    HelfrichViscosity* viscosity = nullptr;
    check(Helfrich_Viscosity_create(subject.c_str(), core, (int64_t) masses.size(), masses.data(), &viscosity));
    return viscosity;
}

void SharedMembrane::sweep(const string& subject, ContextImpl& context, HelfrichViscosity& viscosity,
                           const HelfrichEdgeBath& bath, vector<Vec3>& positions, vector<Vec3>& velocities,
                           HelfrichStream& random) {
    settle(context);
    const double* vectors = findBox(context);
    // Where no force on these triangles says so, they are in the box that other forces are in.
    if (members.empty() && context.getSystem().usesPeriodicBoundaryConditions()) {
        context.getPeriodicBoxVectors(box[0], box[1], box[2]);
        vectors = reinterpret_cast<const double*>(box);
    }
    check(Helfrich_Viscosity_sweep(subject.c_str(), &viscosity, core, (int64_t) positions.size(),
                                   reinterpret_cast<double*>(positions.data()),
                                   reinterpret_cast<double*>(velocities.data()), vectors, &bath, &random));
}

int64_t SharedMembrane::swap(const string& subject, ContextImpl& context, int groups, const vector<Vec3>& positions,
                             const HelfrichSwapRules& rules, int64_t attempts, HelfrichSwapState& state,
                             vector<Vec3>* forceChange) {
    collect(context, groups);
    if (kinds.empty() && !findKinds())
        throw OpenMMException(
            subject +
            ": no force on these triangles has values of single vertices, or domains, so there is "
            "nothing to exchange; give a BendingForce one rigidity for each vertex, for instance, or add a "
            "LineTensionForce");
    double* change = nullptr;
    if (forceChange != nullptr) {
        forceChange->resize(positions.size());
        change = reinterpret_cast<double*>(forceChange->data());
    }
    int64_t made = 0;
    uint64_t version = Helfrich_Numbers_takeVersion();
    vector<uint32_t> sources(kinds.size());
    check(Helfrich_Membrane_swap(subject.c_str(), core, terms.data(), (int64_t) terms.size(),
                                 (int64_t) positions.size(), reinterpret_cast<const double*>(positions.data()),
                                 findBox(context), &rules, attempts, &state, kinds.data(), sources.data(), version,
                                 &made, change));
    if (made > 0)
        rearrange(sources, version);
    return made;
}

bool SharedMembrane::findKinds() {
    bool isAny = false;
    kinds.assign(Helfrich_Membrane_numVertices(core), 0);
    for (const MembraneForceImpl* member : members)
        member->visitKinds([&](const vector<double>& values) {
            isAny = true;
            std::map<std::pair<uint32_t, double>, uint32_t> known;
            for (size_t i = 0; i < kinds.size(); i++)
                kinds[i] = known.emplace(std::make_pair(kinds[i], values[i]), (uint32_t) known.size()).first->second;
        });
    if (!isAny)
        kinds.clear();
    return isAny;
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
