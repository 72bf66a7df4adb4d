#include "SharedMembrane.h"

#include "HelfrichPlatform.h"
#include "MembraneForceImpl.h"

#include <openmm/System.h>

#include <algorithm>
#include <mutex>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::shared_ptr;
using std::string;
using std::vector;

namespace {

/** The membranes of all living Contexts. Those that nobody holds any more are removed on the next visit. */
std::mutex registryMutex;
std::multimap<const ContextImpl*, std::weak_ptr<SharedMembrane>> registry;

} // namespace

shared_ptr<SharedMembrane> SharedMembrane::acquire(const string& subject, ContextImpl& context,
                                                   const vector<int>& triangles) {
    std::lock_guard<std::mutex> lock(registryMutex);
    for (auto entry = registry.begin(); entry != registry.end();) {
        shared_ptr<SharedMembrane> membrane = entry->second.lock();
        if (membrane == nullptr) {
            entry = registry.erase(entry);
            continue;
        }
        if (entry->first == &context && membrane->triangles == triangles && membrane->belongsTo(context))
            return membrane;
        ++entry;
    }
    shared_ptr<SharedMembrane> membrane(new SharedMembrane(subject, context, triangles));
    registry.emplace(&context, membrane);
    return membrane;
}

SharedMembrane::SharedMembrane(const string& subject, ContextImpl& context, const vector<int>& triangles)
    : triangles(triangles), core(nullptr) {
    check(Helfrich_Membrane_create(subject.c_str(), triangles.data(), (int64_t) triangles.size() / 3,
                                   context.getSystem().getNumParticles(), &core));
    if (int threads = helfrichThreads(context))
        Helfrich_Membrane_setThreads(core, threads);
}

SharedMembrane::~SharedMembrane() {
    Helfrich_Membrane_destroy(core);
}

bool SharedMembrane::belongsTo(ContextImpl& context) const {
    const vector<ForceImpl*>& impls = context.getForceImpls();
    return !members.empty() && std::all_of(members.begin(), members.end(), [&](const MembraneForceImpl* member) {
        return std::find(impls.begin(), impls.end(), static_cast<const ForceImpl*>(member)) != impls.end();
    });
}

void SharedMembrane::join(MembraneForceImpl* member) {
    members.push_back(member);
}

void SharedMembrane::leave(MembraneForceImpl* member) {
    members.erase(std::remove(members.begin(), members.end(), member), members.end());
}

bool SharedMembrane::isLeader(const MembraneForceImpl& member, int groups) const {
    for (const MembraneForceImpl* other : members)
        if (other->isInGroups(groups))
            return other == &member;
    return false;
}

double SharedMembrane::evaluate(const string& subject, ContextImpl& context, int groups, const vector<Vec3>& positions,
                                bool includeEnergy, vector<Vec3>* forces, std::map<string, double>* derivatives) {
    active.clear();
    terms.clear();
    for (MembraneForceImpl* member : members)
        if (member->isInGroups(groups)) {
            active.push_back(member);
            terms.push_back(member->getTerm(context));
            // Context parameters can be anything by now; the message shall name the force whose they are.
            if (member->usesContextParameters())
                checkTerm(member->getOwner().getTypeName(), terms.back());
        }
    bool wantsDerivatives = derivatives != nullptr &&
        std::any_of(terms.begin(), terms.end(), [](const HelfrichTerm& term) { return term.wantsDerivatives != 0; });
    contributions.assign(terms.size(), HelfrichContribution());
    // Vec3 is three doubles and nothing else, but its operator[] returns copies.
    static_assert(sizeof(Vec3) == 3 * sizeof(double), "an array of Vec3 is an array of coordinates");
    check(Helfrich_Membrane_evaluate(subject.c_str(), core, terms.data(), (int64_t) terms.size(),
                                     (int64_t) positions.size(), reinterpret_cast<const double*>(positions.data()),
                                     includeEnergy || wantsDerivatives ? contributions.data() : nullptr,
                                     forces == nullptr ? nullptr : reinterpret_cast<double*>(forces->data())));
    double energy = 0;
    for (size_t i = 0; i < active.size(); i++) {
        energy += contributions[i].energy;
        if (derivatives != nullptr)
            active[i]->addDerivatives(contributions[i], *derivatives);
    }
    return energy;
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
