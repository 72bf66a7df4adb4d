#include "MembraneForceImpl.h"
#include "MonteCarloBondFlipImpl.h"
#include "SharedMembrane.h"

#include <openmm/reference/ReferencePlatform.h>

#include <algorithm>
#include <cstring>
#include <limits>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

/*
 * What is saved of a membrane, in checkpoints of platform Helfrich and for users: little-endian numbers without gaps.
 *
 *     uint32  MARK, with the version
 *     uint64  checksum of the System's triangles, which tells membranes of a Context apart
 *     int32   the smallest index of a particle
 *     int32   number of triangles T
 *     int32   number of vertices N
 *     int64   flips since the order of the vertices was made
 *     int32   3 T corners of triangles, by particle
 *     uint32  N vertices in their order
 *     uint32  whether there is a mover; if so
 *     104     its MoverState
 *     uint64  checksum of all before, FNV-1a
 */
namespace {

const uint32_t MARK = 0x32434c48;

uint64_t findChecksum(const char* data, size_t size) {
    uint64_t sum = 0xcbf29ce484222325;
    for (size_t i = 0; i < size; i++)
        sum = (sum ^ (unsigned char) data[i]) * 0x100000001b3;
    return sum;
}

template <class T>
uint64_t findChecksum(const vector<T>& values) {
    return findChecksum(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/** OpenMM's own array, on Reference and what derives from it. */
const vector<Vec3>& getPositions(ContextImpl& context) {
    return *static_cast<ReferencePlatform::PlatformData*>(context.getPlatformData())->positions;
}

template <class T>
void put(string& bytes, const T* values, size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

template <class T>
void put(string& bytes, const T& value) {
    put(bytes, &value, 1);
}

} // namespace

/** Takes apart what was saved. */
struct HelfrichPlugin::SavedConnectivity {
    uint64_t triangulation;
    int32_t smallest, numTriangles, numVertices;
    Connectivity connectivity;
    bool hasMover;
    MoverState mover;

    SavedConnectivity(const string& subject, const string& bytes) : hasMover(false), mover(), bytes(bytes), at(0) {
        uint64_t sum = 0;
        const size_t least = 3 * sizeof(int32_t) + 2 * sizeof(uint32_t) + 2 * sizeof(int64_t) + sizeof(sum);
        if (bytes.size() >= least)
            std::memcpy(&sum, bytes.data() + bytes.size() - sizeof(sum), sizeof(sum));
        if (bytes.size() < least || sum != findChecksum(bytes.data(), bytes.size() - sizeof(sum)))
            throw OpenMMException(subject + ": the saved connectivity is damaged");
        uint32_t mark = 0, moves = 0;
        take(&mark, 1);
        if (mark != MARK)
            throw OpenMMException(subject + ": the saved connectivity is of another version of openmm-helfrich");
        take(&triangulation, 1);
        take(&smallest, 1);
        take(&numTriangles, 1);
        take(&numVertices, 1);
        take(&connectivity.flips, 1);
        connectivity.corners.resize(3 * (size_t) numTriangles);
        take(connectivity.corners.data(), connectivity.corners.size());
        connectivity.order.resize((size_t) numVertices);
        take(connectivity.order.data(), connectivity.order.size());
        take(&moves, 1);
        hasMover = moves != 0;
        if (hasMover)
            take(&mover, 1);
    }

private:
    template <class T>
    void take(T* values, size_t count) {
        // The checksum has told that all is there.
        std::memcpy(values, bytes.data() + at, count * sizeof(T));
        at += count * sizeof(T);
    }

    const string& bytes;
    size_t at;
};

int SharedMembrane::getSmallestParticle() const {
    return *std::min_element(triangles.begin(), triangles.end());
}

bool SharedMembrane::needsSaving() const {
    // What is made up of others follows them.
    return mover != nullptr || (getFingerprint() != 0 && parts.empty());
}

string SharedMembrane::save(ContextImpl& context) {
    settle(context);
    Connectivity present = getConnectivity();
    string bytes;
    put(bytes, MARK);
    put(bytes, findChecksum(triangles));
    put(bytes, (int32_t) getSmallestParticle());
    put(bytes, (int32_t) (present.corners.size() / 3));
    put(bytes, (int32_t) present.order.size());
    put(bytes, present.flips);
    put(bytes, present.corners.data(), present.corners.size());
    put(bytes, present.order.data(), present.order.size());
    put(bytes, (uint32_t) (mover != nullptr));
    if (mover != nullptr)
        put(bytes, mover->getState(context));
    put(bytes, findChecksum(bytes.data(), bytes.size()));
    return bytes;
}

Connectivity SharedMembrane::getConnectivity() const {
    Connectivity present;
    present.corners.resize(triangles.size());
    Helfrich_Membrane_triangles(core, present.corners.data());
    present.order.resize(Helfrich_Membrane_numVertices(core));
    present.flips = Helfrich_Membrane_order(core, present.order.data());
    return present;
}

void SharedMembrane::setConnectivity(const string& subject, const Connectivity& connectivity) {
    check(Helfrich_Membrane_restore(subject.c_str(), core, connectivity.corners.data(), connectivity.order.data(),
                                    connectivity.flips));
    for (Link& part : parts)
        part.followed = std::numeric_limits<double>::quiet_NaN();
}

void SharedMembrane::checkMover(const string& subject, const Connectivity& before) {
    if (mover == nullptr)
        return;
    try {
        checkRules(mover->getOwner().getTypeName(), mover->getRules());
    } catch (...) {
        setConnectivity(subject, before);
        throw;
    }
}

void SharedMembrane::take(const string& subject, const SavedConnectivity& saved) {
    if (saved.smallest != getSmallestParticle() || saved.connectivity.corners.size() != triangles.size() ||
        (int64_t) saved.connectivity.order.size() != Helfrich_Membrane_numVertices(core))
        throw OpenMMException(subject + ": the saved connectivity is that of " + std::to_string(saved.numTriangles) +
                              " triangles of " + std::to_string(saved.numVertices) + " particles from " +
                              std::to_string(saved.smallest) + " on, not that of this membrane");
    Connectivity before = getConnectivity();
    setConnectivity(subject, saved.connectivity);
    checkMover(subject, before);
}

void SharedMembrane::announce(ContextImpl& context, const SavedConnectivity* saved) {
    inherited.reset();
    if (mover != nullptr) {
        mover->announceConnectivity(context);
        if (saved != nullptr && saved->hasMover)
            mover->setState(saved->mover);
    }
    context.systemChanged();
}

void SharedMembrane::setTriangles(const string& subject, ContextImpl& context, const vector<int>& corners) {
    if (std::any_of(parts.begin(), parts.end(), [](const Link& link) { return !link.other.expired(); }))
        throw OpenMMException(subject +
                              ": these triangles follow those of other forces, which have some of them each; "
                              "set them there");
    Connectivity before = getConnectivity();
    check(Helfrich_Membrane_setTriangles(subject.c_str(), core, corners.data(), (int64_t) corners.size() / 3));
    checkMover(subject, before);
    announce(context, nullptr);
}

void SharedMembrane::restore(const string& subject, ContextImpl& context, const string& bytes) {
    SavedConnectivity saved(subject, bytes);
    take(subject, saved);
    announce(context, &saved);
}

vector<string> SharedMembrane::saveAll(ContextImpl& context) {
    vector<string> saved;
    for (const auto& membrane : findAll(context)) {
        membrane->settle(context);
        if (membrane->needsSaving())
            saved.push_back(membrane->save(context));
    }
    return saved;
}

void SharedMembrane::restoreAll(const string& subject, ContextImpl& context, const vector<string>& saved) {
    vector<std::shared_ptr<SharedMembrane>> left = findAll(context), found;
    vector<SavedConnectivity> wanted;
    for (const string& bytes : saved) {
        wanted.emplace_back(subject, bytes);
        const SavedConnectivity& one = wanted.back();
        auto match = std::find_if(left.begin(), left.end(), [&](const std::shared_ptr<SharedMembrane>& membrane) {
            return findChecksum(membrane->triangles) == one.triangulation;
        });
        if (match == left.end())
            throw OpenMMException(subject + ": there is saved connectivity of " + std::to_string(one.numTriangles) +
                                  " triangles of particles from " + std::to_string(one.smallest) +
                                  " on, but no force on such triangles in this Context");
        found.push_back(*match);
        left.erase(match);
    }
    vector<Connectivity> before;
    try {
        for (size_t i = 0; i < found.size(); i++) {
            before.push_back(found[i]->getConnectivity());
            found[i]->take(subject, wanted[i]);
        }
    } catch (...) {
        for (size_t i = 0; i < before.size(); i++)
            found[i]->setConnectivity(subject, before[i]);
        throw;
    }
    for (size_t i = 0; i < found.size(); i++)
        found[i]->announce(context, &wanted[i]);
    // These have no mover, which could refuse the triangles of the System.
    for (const auto& membrane : left)
        if (membrane->getFingerprint() != 0 && membrane->parts.empty())
            membrane->setTriangles(subject, context, membrane->triangles);
}

/*
 * Context::reinitialize() destroys the forces' implementations and makes others, on the same thread, and may then load
 * a checkpoint, which on most platforms does not hold the connectivity. So a mover's membrane leaves it behind, and the
 * next membrane on the same triangles takes it up if its Context has come to the same fingerprint and number of steps
 * (and to the same positions, where an integrator has set the fingerprint back). Each thread keeps what one Context has
 * left.
 */
thread_local SharedMembrane::Estate SharedMembrane::estate;
thread_local bool SharedMembrane::hasNoEstate = false;

SharedMembrane::Estate::~Estate() {
    hasNoEstate = true;
}

void SharedMembrane::leaveBehind(ContextImpl& context) {
    if (hasNoEstate)
        return;
    try {
        // Of several membranes each adds its own.
        if (estate.context != &context) {
            estate.context = &context;
            estate.left.clear();
        }
        if (inherited != nullptr)
            estate.left.push_back(std::move(*inherited));
        if (!mover->isInUse())
            return;
        Left left = {
            triangles, mover->getConnectivityParameter(), mover->getAnnounced(context), context.getStepCount(), 0, ""};
        // Every new Context would be taken for one in which nothing has happened; and a State may have been loaded.
        if ((left.value == 0 && left.step == 0) || !mover->isRight(context))
            return;
        if (left.value != getFingerprint() && mover->isInPlace())
            left.checksum = findChecksum(getPositions(context));
        left.saved = save(context);
        estate.left.push_back(std::move(left));
    } catch (...) {
        // A destructor must not throw. Without this, the State of the Context is refused by the next one.
    }
}

void SharedMembrane::inherit() {
    if (hasNoEstate)
        return;
    estate.context = nullptr;
    for (Left& left : estate.left)
        if (left.triangles == triangles) {
            inherited.reset(new Left(std::move(left)));
            left.triangles.clear();
            return;
        }
}

void SharedMembrane::settle(ContextImpl& context) {
    std::lock_guard<std::mutex> lock(settling);
    if (!parts.empty())
        followParts(context);
    if (inherited == nullptr)
        return;
    if (isHeir(context)) {
        SavedConnectivity saved("reinitialize", inherited->saved);
        take("reinitialize", saved);
        if (mover != nullptr) {
            mover->announceConnectivity(context);
            mover->setState(saved.mover);
        }
    }
    inherited.reset();
}

bool SharedMembrane::isHeir(ContextImpl& context) const {
    // A checkpoint brings the parameter even where the mover has been removed.
    const auto& parameters = context.getParameters();
    auto found = parameters.find(inherited->parameter);
    if (found == parameters.end() || found->second != inherited->value || context.getStepCount() != inherited->step)
        return false;
    return inherited->checksum == 0 || inherited->checksum == findChecksum(getPositions(context));
}
