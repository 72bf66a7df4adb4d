/*
 * What changes the state of a SharedMembrane within a step: flips, exchanges and friction; and the permutation that
 * exchanges leave.
 */

#include "MembraneForceImpl.h"
#include "SavedConnectivity.h"
#include "SharedMembrane.h"

#include <map>
#include <numeric>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::shared_ptr;
using std::string;
using std::vector;

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
    auto status =
        Helfrich_Membrane_flip(subject.c_str(), core, terms.data(), (int64_t) terms.size(), (int64_t) positions.size(),
                               reinterpret_cast<const double*>(positions.data()), findBox(context), &rules, attempts,
                               &state, &made, change, followers.data(), (int64_t) followers.size());
    // Where forces fail after them, flips have been made.
    for (Link* link : links)
        link->followed = getFingerprint();
    check(status);
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

void SharedMembrane::setPermutation(const vector<uint32_t>& wanted) {
    vector<uint32_t> sources(Helfrich_Membrane_numVertices(core));
    std::iota(sources.begin(), sources.end(), 0);
    vector<uint32_t> place(sources);
    for (size_t i = 0; i < permutation.size(); i++)
        place[permutation[i]] = (uint32_t) i;
    for (size_t i = 0; i < sources.size(); i++)
        sources[i] = place[wanted.empty() ? i : wanted[i]];
    rearrange(sources, Helfrich_Numbers_takeVersion());
}

void SharedMembrane::setPermutation(const string& subject, ContextImpl& context, const vector<int>& given) {
    settle(context);
    refuseParts(subject, "set their permutations");
    auto count = (size_t) Helfrich_Membrane_numVertices(core);
    if (given.size() != count)
        throw OpenMMException(subject + ": the permutation is of " + std::to_string(given.size()) +
                              " vertices, but there are " + std::to_string(count) +
                              "; give one for each, in ascending order of particle index");
    vector<bool> met(count, false);
    for (int vertex : given) {
        if (vertex < 0 || vertex >= (int) count)
            throw OpenMMException(subject + ": the permutation has " + std::to_string(vertex) + ", but vertices are " +
                                  "counted from 0 to " + std::to_string(count - 1));
        if (met[vertex])
            throw OpenMMException(subject + ": the permutation has vertex " + std::to_string(vertex) +
                                  " twice; each must come once");
        met[vertex] = true;
    }
    setPermutation(vector<uint32_t>(given.begin(), given.end()));
    announce(context, nullptr);
}

void SharedMembrane::rearrange(const vector<uint32_t>& sources, uint64_t version) {
    vector<uint32_t> own(sources.size());
    std::iota(own.begin(), own.end(), 0);
    if (sources == own)
        return;
    auto moved = [&](const vector<uint32_t>& before) {
        vector<uint32_t> after;
        for (uint32_t source : sources)
            after.push_back(before[source]);
        return after;
    };
    permutation = moved(permutation.empty() ? own : permutation);
    if (permutation == own)
        permutation.clear();
    // A whole number that a double can hold, and not zero.
    permutationFingerprint = permutation.empty() ? 0 : (double) ((findChecksum(permutation) >> 11) | 1);
    if (!kinds.empty())
        kinds = moved(kinds);
    for (MembraneForceImpl* member : members)
        member->rearrange(sources, version);
}

void SharedMembrane::arrange(vector<double>& values) const {
    // Of too few or too many values the core complains.
    if (values.size() != permutation.size())
        return;
    const vector<double> given(values);
    for (size_t i = 0; i < values.size(); i++)
        values[i] = given[permutation[i]];
}

vector<int> SharedMembrane::getPermutation(const string& subject, ContextImpl& context) {
    settle(context);
    refuseParts(subject, "ask those for their permutations");
    vector<int> found(permutation.begin(), permutation.end());
    if (found.empty()) {
        found.resize(Helfrich_Membrane_numVertices(core));
        std::iota(found.begin(), found.end(), 0);
    }
    return found;
}
