// What the three languages behind OpenMM's platforms have under different names, before a module that
// shaders/dialect has written.

typedef unsigned int h_u32;
typedef int h_i32;
typedef float h_f32;
#ifdef HELFRICH_DOUBLE
typedef double h_f64;
#endif

#ifdef __OPENCL_VERSION__
#define H_VECTOR(NAME, ITEM, SIZE, ALIGN) typedef struct { ITEM c[SIZE]; } __attribute__((aligned(ALIGN))) NAME;
#define H_ZERO {0}
#define H_AS_UINT(x) as_uint(x)
#define H_AS_FLOAT(x) as_float(x)
#define H_COUNT(place, value) atomic_add(place, value)
#define H_RAISE(place, value) atomic_max(place, value)
#define H_NOTE(place, bits) atomic_or(place, bits)
#define H_LEADING_ZEROS(x) clz(x)
#define H_SQRT32 sqrt
#define H_ABS32 fabs
#define H_MIN32 fmin
#define H_MAX32 fmax
#define H_ROUND32 rint
#else
#define H_VECTOR(NAME, ITEM, SIZE, ALIGN) struct alignas(ALIGN) NAME { ITEM c[SIZE]; };
#define H_ZERO {}
#define H_AS_UINT(x) __float_as_uint(x)
#define H_AS_FLOAT(x) __uint_as_float(x)
#define H_COUNT(place, value) atomicAdd(place, value)
#define H_RAISE(place, value) atomicMax(place, value)
#define H_NOTE(place, bits) atomicOr(place, bits)
#define H_LEADING_ZEROS(x) ((h_u32) __clz((int) (x)))
#define H_SQRT32 sqrtf
#define H_ABS32 fabsf
#define H_MIN32 fminf
#define H_MAX32 fmaxf
#define H_ROUND32 rintf
#endif

