#include "MembraneForceImpl.h"
#include "SharedMembrane.h"
#include "SurfaceMoverImpl.h"

#include <openmm/reference/ReferencePlatform.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>
#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

/*
 * What is saved of a membrane, in checkpoints of platform Helfrich and for users: little-endian numbers without gaps.
 *
 *     uint32  MARK, with the version; OLD_MARK where vertices exchange nothing
 *     uint64  checksum of the System's triangles, which tells membranes of a Context apart
 *     int32   the smallest index of a particle
 *     int32   number of triangles T
 *     int32   number of vertices N
 *     int64   flips since the order of the vertices was made
 *     int32   3 T corners of triangles, by particle
 *     uint32  N vertices in their order
 *     uint32  whether there is a MonteCarloBondFlip; if so
 *     104     its state
 *     uint64  checksum of all before, FNV-1a
 *
 * What has the new mark has before the checksum
 *
 *     uint32  N, or 0 where every vertex has its own values
 *     uint32  as many vertices, whose values the vertices have
 *     uint32  whether there is a MonteCarloDomainSwap; if so
 *     72      its state
 */
namespace {

const uint32_t MARK = 0x33434c48, OLD_MARK = 0x32434c48;

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
    /** By their kinds; empty where there is no mover. */
    string movers[NUM_MOVER_KINDS];

    SavedConnectivity(const string& subject, const string& bytes) : subject(subject), bytes(bytes), at(0), end(0) {
        uint64_t sum = 0;
        if (bytes.size() < sizeof(sum))
            refuse();
        end = bytes.size() - sizeof(sum);
        std::memcpy(&sum, bytes.data() + end, sizeof(sum));
        if (sum != findChecksum(bytes.data(), end))
            refuse();
        uint32_t mark = 0, moved = 0;
        take(&mark, 1);
        if (mark != MARK && mark != OLD_MARK)
            throw OpenMMException(subject + ": the saved connectivity is of another version of openmm-helfrich");
        take(&triangulation, 1);
        take(&smallest, 1);
        take(&numTriangles, 1);
        take(&numVertices, 1);
        take(&connectivity.flips, 1);
        takeAll(connectivity.corners, 3 * (int64_t) numTriangles);
        takeAll(connectivity.order, numVertices);
        takeMover(MoverKind::Flips);
        if (mark == MARK) {
            take(&moved, 1);
            takeAll(connectivity.permutation, moved);
            takeMover(MoverKind::Swaps);
        }
        if (at != end)
            refuse();
    }

private:
    [[noreturn]] void refuse() const {
        throw OpenMMException(subject + ": the saved connectivity is damaged");
    }

    template <class T>
    void take(T* values, size_t count) {
        // A checksum can be right for numbers that do not fit.
        if (count > (end - at) / sizeof(T))
            refuse();
        std::memcpy(values, bytes.data() + at, count * sizeof(T));
        at += count * sizeof(T);
    }

    template <class T>
    void takeAll(vector<T>& values, int64_t count) {
        if (count < 0 || (uint64_t) count > (end - at) / sizeof(T))
            refuse();
        values.resize((size_t) count);
        take(values.data(), values.size());
    }

    void takeMover(MoverKind kind) {
        uint32_t isThere = 0;
        take(&isThere, 1);
        string& state = movers[(int) kind];
        size_t size = isThere != 0 ? SurfaceMoverImpl::getStateSize(kind) : 0;
        if (size > end - at)
            refuse();
        state.resize(size);
        take(&state[0], size);
    }

    const string subject;
    const string& bytes;
    size_t at, end;
};

int SharedMembrane::getSmallestParticle() const {
    return *std::min_element(triangles.begin(), triangles.end());
}

bool SharedMembrane::needsSaving() const {
    // What is made up of others follows them.
    return findMover() != nullptr || !permutation.empty() || (getFingerprint() != 0 && parts.empty());
}

string SharedMembrane::save(ContextImpl& context) {
    settle(context);
    Connectivity present = getConnectivity();
    string bytes;
    auto putMover = [&](MoverKind kind) {
        const SurfaceMoverImpl* mover = movers[(int) kind];
        put(bytes, (uint32_t) (mover != nullptr));
        if (mover != nullptr)
            bytes += mover->getState(context);
    };
    bool isOld = present.permutation.empty() && movers[(int) MoverKind::Swaps] == nullptr;
    put(bytes, isOld ? OLD_MARK : MARK);
    put(bytes, findChecksum(triangles));
    put(bytes, (int32_t) getSmallestParticle());
    put(bytes, (int32_t) (present.corners.size() / 3));
    put(bytes, (int32_t) present.order.size());
    put(bytes, present.flips);
    put(bytes, present.corners.data(), present.corners.size());
    put(bytes, present.order.data(), present.order.size());
    putMover(MoverKind::Flips);
    if (!isOld) {
        put(bytes, (uint32_t) present.permutation.size());
        put(bytes, present.permutation.data(), present.permutation.size());
        putMover(MoverKind::Swaps);
    }
    put(bytes, findChecksum(bytes.data(), bytes.size()));
    return bytes;
}

Connectivity SharedMembrane::getConnectivity() const {
    Connectivity present;
    present.corners.resize(triangles.size());
    Helfrich_Membrane_triangles(core, present.corners.data());
    present.order.resize(Helfrich_Membrane_numVertices(core));
    present.flips = Helfrich_Membrane_order(core, present.order.data());
    present.permutation = permutation;
    return present;
}

void SharedMembrane::setConnectivity(const string& subject, const Connectivity& connectivity) {
    check(Helfrich_Membrane_restore(subject.c_str(), core, connectivity.corners.data(), connectivity.order.data(),
                                    connectivity.flips));
    for (Link& part : parts)
        part.followed = std::numeric_limits<double>::quiet_NaN();
    setPermutation(connectivity.permutation);
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

void SharedMembrane::refuseParts(const string& subject, const string& advice) const {
    if (std::any_of(parts.begin(), parts.end(), [](const Link& link) { return !link.other.expired(); }))
        throw OpenMMException(
            subject + ": these triangles follow those of other forces, which have some of them each; " + advice);
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

void SharedMembrane::checkMovers(const string& subject, const Connectivity& before) {
    try {
        for (const SurfaceMoverImpl* mover : movers)
            if (mover != nullptr)
                mover->checkTriangles();
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
    const vector<uint32_t>& moved = saved.connectivity.permutation;
    std::set<uint32_t> met(moved.begin(), moved.end());
    if (!moved.empty() &&
        (moved.size() != saved.connectivity.order.size() || met.size() != moved.size() || *met.rbegin() >= met.size()))
        throw OpenMMException(subject + ": the saved permutation of vertices is none; what was saved is damaged");
    setConnectivity(subject, saved.connectivity);
    checkMovers(subject, before);
}

void SharedMembrane::announce(ContextImpl& context, const SavedConnectivity* saved) {
    inherited.reset();
    tellMovers(context, saved);
    context.systemChanged();
}

void SharedMembrane::tellMovers(ContextImpl& context, const SavedConnectivity* saved) {
    for (int kind = 0; kind < NUM_MOVER_KINDS; kind++) {
        if (movers[kind] == nullptr)
            continue;
        movers[kind]->announce(context);
        if (saved != nullptr && !saved->movers[kind].empty())
            movers[kind]->setState(saved->movers[kind]);
    }
}

void SharedMembrane::setTriangles(const string& subject, ContextImpl& context, const vector<int>& corners) {
    refuseParts(subject, "set them there");
    Connectivity before = getConnectivity();
    check(Helfrich_Membrane_setTriangles(subject.c_str(), core, corners.data(), (int64_t) corners.size() / 3));
    checkMovers(subject, before);
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
    for (const auto& membrane : left) {
        membrane->setPermutation({});
        if (membrane->getFingerprint() != 0 && membrane->parts.empty())
            membrane->setTriangles(subject, context, membrane->triangles);
    }
}

/*
 * Context::reinitialize() destroys the forces' implementations and makes others, on the same thread, and may then load
 * a checkpoint, which on most platforms does not hold the connectivity. So a membrane with movers leaves it behind, and
 * the next membrane on the same triangles takes it up if its Context has come to the same fingerprints and number of
 * steps (and to the same positions, where an integrator has set a fingerprint back). Each thread keeps what one Context
 * has left.
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
        Left left = {triangles, {}, context.getStepCount(), 0, ""};
        bool isNew = left.step == 0;
        for (SurfaceMoverImpl* mover : movers) {
            if (mover == nullptr)
                continue;
            // A State may have been loaded.
            if (!mover->isInUse() || !mover->isRight(context))
                return;
            double value = mover->getAnnounced(context);
            left.parameters[mover->getParameter()] = value;
            isNew = isNew && value == 0;
            if (value != mover->getFingerprint() && mover->isInPlace())
                left.checksum = findChecksum(getPositions(context));
        }
        // Every other new Context would be taken for this one.
        if (isNew)
            return;
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
        tellMovers(context, &saved);
    }
    inherited.reset();
}

bool SharedMembrane::isHeir(ContextImpl& context) const {
    if (context.getStepCount() != inherited->step)
        return false;
    // A checkpoint brings the parameters even where a mover has been removed.
    const auto& parameters = context.getParameters();
    for (const auto& [name, value] : inherited->parameters) {
        auto found = parameters.find(name);
        if (found == parameters.end() || found->second != value)
            return false;
    }
    return inherited->checksum == 0 || inherited->checksum == findChecksum(getPositions(context));
}
