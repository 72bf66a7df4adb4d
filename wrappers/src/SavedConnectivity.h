#ifndef HELFRICH_SAVED_CONNECTIVITY_H_
#define HELFRICH_SAVED_CONNECTIVITY_H_

#include "SharedMembrane.h"

#include <cstdint>
#include <string>
#include <vector>

namespace HelfrichPlugin {

/** FNV-1a. */
inline uint64_t findChecksum(const char* data, size_t size) {
    uint64_t sum = 0xcbf29ce484222325;
    for (size_t i = 0; i < size; i++)
        sum = (sum ^ (unsigned char) data[i]) * 0x100000001b3;
    return sum;
}

template <class T>
uint64_t findChecksum(const std::vector<T>& values) {
    return findChecksum(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/** Takes apart what was saved of a membrane. */
struct SavedConnectivity {
    uint64_t triangulation;
    int32_t smallest, numTriangles, numVertices;
    Connectivity connectivity;
    /** By their kinds; empty where there is no mover. */
    std::string movers[NUM_MOVER_KINDS];

    /**
     * Read it.
     *
     * @param subject  the class that messages shall name
     * @param bytes    what SharedMembrane::save() has made
     */
    SavedConnectivity(const std::string& subject, const std::string& bytes);

private:
    [[noreturn]] void refuse() const;
    template <class T>
    void take(T* values, size_t count);
    template <class T>
    void takeAll(std::vector<T>& values, int64_t count);
    void takeMover(MoverKind kind);

    const std::string subject;
    const std::string& bytes;
    size_t at, end;
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_SAVED_CONNECTIVITY_H_*/
