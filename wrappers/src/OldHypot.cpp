/*
 * glibc 2.35 has a new version of hypot, with which the library would not load where there is an older glibc. OpenMM's
 * own wheel runs from 2.34 on, and nothing else here needs more; so calls of hypot, which the linker brings here by
 * --wrap (see build.rs), go to the version that every glibc has. Its values are the same.
 */
#include <cstdlib>

#if defined(__x86_64__) && defined(__GLIBC__)
extern "C" {

__asm__(".symver oldHypot, hypot@GLIBC_2.2.5");
__asm__(".symver oldHypotf, hypotf@GLIBC_2.2.5");
double oldHypot(double x, double y);
float oldHypotf(float x, float y);

double __wrap_hypot(double x, double y) {
    return oldHypot(x, y);
}

float __wrap_hypotf(float x, float y) {
    return oldHypotf(x, y);
}
}
#endif
