#include "MembraneCrowd.h"

#include "HelfrichPlatform.h"
#include "SharedMembrane.h"

#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::vector;

MembraneCrowd::MembraneCrowd() : core(Helfrich_Crowd_create()), isGathered(false), isDone(false), isShared(false) {
}

MembraneCrowd::~MembraneCrowd() {
    Helfrich_Crowd_destroy(core);
}

void MembraneCrowd::gather(ContextImpl& context) {
    isGathered = true;
    std::set<int> taken;
    size_t all = 0, largest = 0;
    for (const auto& membrane : SharedMembrane::findAll(context)) {
        const vector<int>& corners = membrane->getTriangles();
        // Contacts reach for other particles, and act on the triangles of several membranes.
        if (membrane->hasContacts() || !membrane->isOnProcessor())
            continue;
        std::set<int> own(corners.begin(), corners.end());
        size_t before = taken.size();
        taken.insert(own.begin(), own.end());
        if (taken.size() != before + own.size()) {
            membranes.clear();
            return;
        }
        membranes.push_back(membrane.get());
        all += own.size();
        largest = std::max(largest, own.size());
    }
    // What is larger than all others together had better have all threads for itself.
    if (membranes.size() < 2 || 2 * largest > all) {
        membranes.clear();
        return;
    }
    isShared = membranes.size() >= (size_t) HelfrichPlatform::getData(context)->numThreads;
    for (SharedMembrane* membrane : membranes)
        membrane->joinCrowd(isShared);
}

bool MembraneCrowd::evaluate(const SharedMembrane& membrane, const Computation& computation) {
    if (!isGathered)
        gather(computation.context);
    if (!membrane.isInCrowd())
        return false;
    if (isDone)
        return true;
    turns.clear();
    for (SharedMembrane* each : membranes)
        if (each->prepare(computation))
            turns.push_back(each->getTurn(computation));
    HelfrichTeam* team = isShared ? HelfrichPlatform::getData(computation.context)->getTeam() : nullptr;
    vector<Vec3>* forces = computation.forces;
    check(Helfrich_Crowd_evaluate(core, team, turns.data(), (int64_t) turns.size(),
                                  (int64_t) computation.positions.size(),
                                  reinterpret_cast<const double*>(computation.positions.data()),
                                  forces == nullptr ? nullptr : reinterpret_cast<double*>(forces->data())));
    isDone = true;
    return true;
}
