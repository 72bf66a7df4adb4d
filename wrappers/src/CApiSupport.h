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

#include <exception>
#include <string>
#include <vector>

namespace HelfrichPlugin {

template <class Wanted>
Wanted& as(const std::string& name, void* force) {
    // C hands over the address of an OpenMM::Force.
    OpenMM::Force* any = static_cast<OpenMM::Force*>(force);
    auto* found = dynamic_cast<Wanted*>(any);
    if (found == nullptr)
        throw OpenMM::OpenMMException(name + ": the force \"" + any->getName() + "\" is of another class");
    return *found;
}

inline OpenMM::Context& asContext(void* context) {
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

/** The corners of so many triangles. */
inline std::vector<int> cornersOf(const std::string& owner, const int* triangles, int numTriangles) {
    if (numTriangles < 0)
        throw OpenMM::OpenMMException(owner + ": the number of triangles is negative");
    return std::vector<int>(triangles, triangles + 3 * (size_t) numTriangles);
}

} // namespace HelfrichPlugin

#endif /*HELFRICH_C_API_SUPPORT_H_*/
