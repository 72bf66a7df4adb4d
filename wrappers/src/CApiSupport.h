#ifndef HELFRICH_C_API_SUPPORT_H_
#define HELFRICH_C_API_SUPPORT_H_

/**
 * What the functions for C share: casts, and errors that become statuses.
 *
 * What the functions of OpenMMHelfrichCWrapper.h do stands in the files CApi*.cpp under other names: the exported ones
 * are Rust's, which pass on to these. The build makes CApi.h of that header, so that these have its types
 * (wrappers/declarations.rs).
 */

#include "OpenMMHelfrich.h"
#include "Shim.h"

#include <CApi.h>

#include <OpenMM.h>

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

namespace HelfrichPlugin {

template <class Wanted>
Wanted& as(const std::string& name, void* force) {
    if (force == nullptr)
        throw OpenMM::OpenMMException(name +
                                      ": the force is null; the function that should have made it had the reason "
                                      "in Helfrich_lastError()");
    // C hands over the address of an OpenMM::Force.
    OpenMM::Force* any = static_cast<OpenMM::Force*>(force);
    auto* found = dynamic_cast<Wanted*>(any);
    if (found == nullptr)
        throw OpenMM::OpenMMException(name + ": the force \"" + any->getName() + "\" is of another class");
    return *found;
}

inline OpenMM::Context& asContext(void* context) {
    if (context == nullptr)
        throw OpenMM::OpenMMException("openmm-helfrich: the context is null");
    return *static_cast<OpenMM::Context*>(context);
}

/** Run something that may throw; C gets a status and a message. */
template <class Body>
Helfrich_Status guarded(Body body) {
    try {
        body();
        return Helfrich_Success;
    } catch (const std::exception& error) {
        helfrich_setLastError(error.what());
    } catch (...) {
        helfrich_setLastError("openmm-helfrich: an unknown exception");
    }
    return Helfrich_Failure;
}

/** A value, or `nothing` if there is an error. */
template <class Value, class Body>
Value valueOr(Value nothing, Body body) {
    Value value = nothing;
    return guarded([&] { value = body(); }) == Helfrich_Success ? value : nothing;
}

/** A new force, or null. */
template <class Body>
OpenMM_Force* made(Body body) {
    return reinterpret_cast<OpenMM_Force*>(valueOr<OpenMM::Force*>(nullptr, body));
}

/** What C has for so many things, with `width` numbers for each. */
template <class Number>
std::vector<Number> arrayOf(const std::string& owner, const std::string& things, const Number* first, int64_t count,
                            int width = 1) {
    if (count < 0)
        throw OpenMM::OpenMMException(owner + ": the number of " + things + " is negative, " + std::to_string(count));
    if (first == nullptr && count > 0)
        throw OpenMM::OpenMMException(owner + ": the array for " + std::to_string(count) + " " + things + " is null");
    return count == 0 ? std::vector<Number>() : std::vector<Number>(first, first + width * count);
}

/** The corners of so many triangles. */
inline std::vector<int> cornersOf(const std::string& owner, const int* triangles, int numTriangles) {
    return arrayOf(owner, "triangles", triangles, numTriangles, 3);
}

/** Bytes as C takes them, if there is room for them; their number. */
inline int64_t copied(const std::string& saved, char* buffer, int64_t size) {
    if (buffer == nullptr && size > 0)
        throw OpenMM::OpenMMException("openmm-helfrich: the buffer is null, but is said to have " +
                                      std::to_string(size) + " bytes");
    if ((int64_t) saved.size() <= size)
        std::copy(saved.begin(), saved.end(), buffer);
    return (int64_t) saved.size();
}

/** Bytes as C has them. */
inline std::string bytesOf(const std::string& owner, const char* saved, int64_t size) {
    std::vector<char> bytes = arrayOf(owner, "bytes", saved, size);
    return std::string(bytes.begin(), bytes.end());
}

/** A name as C has it. */
inline std::string nameOf(const std::string& owner, const char* name) {
    if (name == nullptr)
        throw OpenMM::OpenMMException(owner + ": a name is null");
    return name;
}

} // namespace HelfrichPlugin

#endif /*HELFRICH_C_API_SUPPORT_H_*/
