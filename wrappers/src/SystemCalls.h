#ifndef HELFRICH_SYSTEM_CALLS_H_
#define HELFRICH_SYSTEM_CALLS_H_

/*
 * What differs between Linux, macOS and Windows. Nothing else in wrappers/ calls the system by other than standard C++,
 * but OldHypot.cpp, which is for glibc alone.
 */
#include <cstdlib>
#include <locale.h>
#ifdef __APPLE__
#include <xlocale.h>
#endif

namespace HelfrichPlugin {

/** strtod with a point in any locale. */
inline double plainNumber(const char* text, char** end) {
#ifdef _WIN32
    static const _locale_t plain = _create_locale(LC_ALL, "C");
    return _strtod_l(text, end, plain);
#else
    static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
    return strtod_l(text, end, plain);
#endif
}

} // namespace HelfrichPlugin

#endif // HELFRICH_SYSTEM_CALLS_H_
