#include "MembraneForceImpl.h"
#include "MonteCarloBondFlipImpl.h"
#include "SharedMembrane.h"

#include <algorithm>
#include <cstring>

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
 *     96      its MoverState
 *     uint64  checksum of all before, FNV-1a
 */
namespace {

const uint32_t MARK = 0x31434c48;

uint64_t findChecksum(const char* data, size_t size) {
    uint64_t sum = 0xcbf29ce484222325;
    for (size_t i = 0; i < size; i++)
        sum = (sum ^ (unsigned char) data[i]) * 0x100000001b3;
    return sum;
}

uint64_t findChecksum(const vector<int>& corners) {
    return findChecksum(reinterpret_cast<const char*>(corners.data()), corners.size() * sizeof(int));
}

template <class T>
void put(string& bytes, const T* values, size_t count) {
    bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

template <class T>
void put(string& bytes, const T& value) {
    put(bytes, &value, 1);
}

/** Takes apart what was saved. */
struct Saved {
    uint64_t triangulation;
    int32_t smallest, numTriangles, numVertices;
    int64_t flips;
    vector<int> corners;
    vector<uint32_t> order;
    bool hasMover;
    MoverState mover;

    Saved(const string& subject, const string& bytes) : hasMover(false), mover(), bytes(bytes), at(0) {
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
        take(&flips, 1);
        corners.resize(3 * (size_t) numTriangles);
        take(corners.data(), corners.size());
        order.resize((size_t) numVertices);
        take(order.data(), order.size());
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

} // namespace

int SharedMembrane::getSmallestParticle() const {
    return *std::min_element(triangles.begin(), triangles.end());
}

bool SharedMembrane::needsSaving() const {
    return mover != nullptr || getFingerprint() != 0;
}

string SharedMembrane::save(ContextImpl& context) const {
    vector<int> corners = getPresentTriangles();
    vector<uint32_t> order(Helfrich_Membrane_numVertices(core));
    int64_t flips = Helfrich_Membrane_order(core, order.data());
    string bytes;
    put(bytes, MARK);
    put(bytes, findChecksum(triangles));
    put(bytes, (int32_t) getSmallestParticle());
    put(bytes, (int32_t) (corners.size() / 3));
    put(bytes, (int32_t) order.size());
    put(bytes, flips);
    put(bytes, corners.data(), corners.size());
    put(bytes, order.data(), order.size());
    put(bytes, (uint32_t) (mover != nullptr));
    if (mover != nullptr)
        put(bytes, mover->getState(context));
    put(bytes, findChecksum(bytes.data(), bytes.size()));
    return bytes;
}

template <class Change>
void SharedMembrane::change(const string& subject, ContextImpl& context, Change make) {
    vector<int> corners = getPresentTriangles();
    vector<uint32_t> order(Helfrich_Membrane_numVertices(core));
    int64_t flips = Helfrich_Membrane_order(core, order.data());
    make();
    if (mover != nullptr) {
        try {
            checkRules(mover->getOwner().getTypeName(), mover->getRules());
        } catch (...) {
            check(Helfrich_Membrane_restore(subject.c_str(), core, corners.data(), order.data(), flips));
            throw;
        }
        mover->announceConnectivity(context);
    }
    context.systemChanged();
}

void SharedMembrane::setTriangles(const string& subject, ContextImpl& context, const vector<int>& corners) {
    change(subject, context, [&] {
        check(Helfrich_Membrane_setTriangles(subject.c_str(), core, corners.data(), (int64_t) corners.size() / 3));
    });
}

void SharedMembrane::restore(const string& subject, ContextImpl& context, const string& bytes) {
    Saved saved(subject, bytes);
    if (saved.smallest != getSmallestParticle() || saved.corners.size() != triangles.size() ||
        (int64_t) saved.order.size() != Helfrich_Membrane_numVertices(core))
        throw OpenMMException(subject + ": the saved connectivity is that of " + std::to_string(saved.numTriangles) +
                              " triangles of " + std::to_string(saved.numVertices) + " particles from " +
                              std::to_string(saved.smallest) + " on, not that of this membrane");
    change(subject, context, [&] {
        check(Helfrich_Membrane_restore(subject.c_str(), core, saved.corners.data(), saved.order.data(), saved.flips));
    });
    if (mover != nullptr && saved.hasMover)
        mover->setState(saved.mover);
}

vector<string> SharedMembrane::saveAll(ContextImpl& context) {
    vector<string> saved;
    for (const auto& membrane : findAll(context))
        if (membrane->needsSaving())
            saved.push_back(membrane->save(context));
    return saved;
}

void SharedMembrane::restoreAll(const string& subject, ContextImpl& context, const vector<string>& saved) {
    vector<std::shared_ptr<SharedMembrane>> left = findAll(context), found;
    for (const string& bytes : saved) {
        Saved one(subject, bytes);
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
    for (size_t i = 0; i < saved.size(); i++)
        found[i]->restore(subject, context, saved[i]);
    for (const auto& membrane : left)
        if (membrane->getFingerprint() != 0)
            membrane->setTriangles(subject, context, membrane->triangles);
}
