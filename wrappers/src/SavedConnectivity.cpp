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

#include "SavedConnectivity.h"

#include "SharedMembrane.h"
#include "SurfaceMoverImpl.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

namespace {

const uint32_t MARK = 0x33434c48, OLD_MARK = 0x32434c48;

template <class T>
void put(string& bytes, const T* values, size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

template <class T>
void put(string& bytes, const T& value) {
    put(bytes, &value, 1);
}

} // namespace

void SavedConnectivity::refuse() const {
    throw OpenMMException(subject + ": the saved connectivity is damaged");
}

template <class T>
void SavedConnectivity::take(T* values, size_t count) {
    // A checksum can be right for numbers that do not fit.
    if (count > (end - at) / sizeof(T))
        refuse();
    std::memcpy(values, bytes.data() + at, count * sizeof(T));
    at += count * sizeof(T);
}

template <class T>
void SavedConnectivity::takeAll(vector<T>& values, int64_t count) {
    if (count < 0 || (uint64_t) count > (end - at) / sizeof(T))
        refuse();
    values.resize((size_t) count);
    take(values.data(), values.size());
}

void SavedConnectivity::takeMover(MoverKind kind) {
    uint32_t isThere = 0;
    take(&isThere, 1);
    string& state = movers[(int) kind];
    size_t size = isThere != 0 ? SurfaceMoverImpl::getStateSize(kind) : 0;
    if (size > end - at)
        refuse();
    state.resize(size);
    take(&state[0], size);
}

SavedConnectivity::SavedConnectivity(const string& subject, const string& bytes)
    : subject(subject), bytes(bytes), at(0), end(0) {
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

void SharedMembrane::refuseParts(const string& subject, const string& advice) const {
    if (std::any_of(parts.begin(), parts.end(), [](const Link& link) { return !link.other.expired(); }))
        throw OpenMMException(
            subject + ": these triangles follow those of other forces, which have some of them each; " + advice);
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
    // What is not among the saved was as the System has it.
    vector<std::shared_ptr<SharedMembrane>> all(found);
    all.insert(all.end(), left.begin(), left.end());
    vector<Connectivity> before;
    try {
        for (size_t i = 0; i < all.size(); i++) {
            before.push_back(all[i]->getConnectivity());
            if (i < found.size())
                all[i]->take(subject, wanted[i]);
            else
                all[i]->startAgain(subject);
        }
    } catch (...) {
        for (size_t i = 0; i < before.size(); i++)
            all[i]->setConnectivity(subject, before[i]);
        throw;
    }
    for (size_t i = 0; i < all.size(); i++)
        all[i]->announce(context, i < found.size() ? &wanted[i] : nullptr);
}

void SharedMembrane::startAgain(const string& subject) {
    Connectivity before = getConnectivity();
    setPermutation({});
    if (getFingerprint() == 0 || !parts.empty())
        return;
    check(Helfrich_Membrane_setTriangles(subject.c_str(), core, triangles.data(), (int64_t) triangles.size() / 3));
    checkMovers(subject, before);
}
