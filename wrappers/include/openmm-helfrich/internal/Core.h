#ifndef HELFRICH_CORE_H_
#define HELFRICH_CORE_H_

/** The functions of the Rust core, and its errors as exceptions. */

#include "CoreFunctions.h"

#include <openmm/OpenMMException.h>

#include <cstdio>
#include <string>

namespace HelfrichPlugin {

/** The core's message of this thread's last failure. */
inline std::string lastError() {
    std::string message(Helfrich_lastError(nullptr, 0) + 1, '\0');
    Helfrich_lastError(&message[0], (int64_t) message.size());
    message.pop_back();
    return message;
}

/** Throw the core's message if a function of the core has failed. */
inline void check(Helfrich_Status status) {
    if (status != Helfrich_Success)
        throw OpenMM::OpenMMException(lastError());
}

/** A number as messages have it. */
inline std::string formatted(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof(buffer), "%g", value);
    return buffer;
}

} // namespace HelfrichPlugin

#endif /*HELFRICH_CORE_H_*/
