// The kernels that only OpenMM's platforms need, after a module: they bring OpenMM's positions into the module's form,
// and its results where OpenMM wants them.
//
// `slots` has the place of each vertex among OpenMM's particles, `anchors` that of the first vertex of its connected
// part, to which positions are relative. `state` is two extents that take turns, and faults; the numbers that the host has,
// too, are stated in src/evaluator/gpu/interface.rs.

// For differences with numbers that may be negative.
#define H_HALF_WIDTH ((int) H_HALF_WIDTH_BITS)

#ifdef HELFRICH_DOUBLE
#define H_VEC3 h_f64_3
#define H_COORDINATE h_f64
#else
#define H_VEC3 h_f32_3
#define H_COORDINATE h_i32
#endif

// OpenMM's coordinates.
typedef mixed h_place_t;

// One number of OpenMM's for each component.
#ifdef HELFRICH_MIXED
#define H_PLACE(k) ((h_place_t) posq[slot].k + (h_place_t) correction[slot].k)
#else
#define H_PLACE(k) ((h_place_t) posq[slot].k)
#endif

typedef struct { h_place_t c[3]; } h_Place;

DEVICE h_Place h_load_place(int slot, GLOBAL const real4* posq, GLOBAL const real4* correction) {
    h_Place place;
    place.c[0] = H_PLACE(x);
    place.c[1] = H_PLACE(y);
    place.c[2] = H_PLACE(z);
    return place;
}

// 2ⁿ for −126 ≤ n ≤ 127.
DEVICE h_f32 h_power(int n) {
    return H_AS_FLOAT((h_u32) (n + 127) << 23);
}

// The largest distance of a vertex from its anchor along an axis, as the bits of a float, which are in the order of what
// they mean; what is not a number is above all.
DEVICE h_u32 h_extent(int first, int step, int vertices, GLOBAL const real4* posq, GLOBAL const real4* correction,
        GLOBAL const int* slots, GLOBAL const int* anchors) {
    h_u32 largest = 0;
    for (int vertex = first; vertex < vertices; vertex += step) {
        h_Place place = h_load_place(slots[vertex], posq, correction);
        h_Place anchor = h_load_place(anchors[vertex], posq, correction);
        for (int k = 0; k < 3; k++) {
            h_u32 bits = H_AS_UINT((h_f32) (place.c[k] - anchor.c[k])) & 0x7fffffffu;
            largest = bits > largest ? bits : largest;
        }
    }
    return largest;
}

// The largest of what the threads of a group have, in `values[0]`.
#define H_LARGEST_OF_GROUP(values, mine) \
    values[LOCAL_ID] = mine; \
    SYNC_THREADS \
    for (int width = LOCAL_SIZE/2; width > 0; width /= 2) { \
        if (LOCAL_ID < width && values[LOCAL_ID + width] > values[LOCAL_ID]) \
            values[LOCAL_ID] = values[LOCAL_ID + width]; \
        SYNC_THREADS \
    }

KERNEL void h_find_extent(int vertices, int turn, GLOBAL const real4* RESTRICT posq,
        GLOBAL const real4* RESTRICT correction, GLOBAL const int* RESTRICT slots, GLOBAL const int* RESTRICT anchors,
        GLOBAL h_u32* RESTRICT state) {
    LOCAL h_u32 largest[H_GROUPS_OF_BLOCK*H_GROUP_SIZE];
    h_u32 mine = h_extent(GLOBAL_ID, GLOBAL_SIZE, vertices, posq, correction, slots, anchors);
    H_LARGEST_OF_GROUP(largest, mine)
    if (LOCAL_ID == 0)
        H_RAISE(&state[turn], largest[0]);
}

#ifndef HELFRICH_DOUBLE
// m 2ˢ, rounded, in 128 bits; a target is m 2ᵖ nmᵏ with m below 2⁵³.
DEVICE h_u32_4 h_shifted(mm_ulong m, int shift) {
    mm_ulong low = 0, high = 0;
    if (shift >= 64)
        high = m << (shift - 64);
    else if (shift > 0) {
        low = m << shift;
        high = m >> (64 - shift);
    }
    else if (shift == 0)
        low = m;
    else if (shift > -64)
        low = (m + ((mm_ulong) 1 << (-shift - 1))) >> -shift;
    return h_limbs(low, high);
}
#endif

// Positions relative to anchors: in single precision on a lattice of 2³⁰ steps across the largest part, whose spacing is a
// power of two, so that they are exact; in double precision in the module's unit of length, 2 to `unit`.
// In a periodic box they are those of the image that is nearest to the anchor, and the lattice reaches over the box.
DEVICE void h_place_vertices(int exponent, int first, int step, int vertices, int unit, GLOBAL const real4* posq,
        GLOBAL const real4* correction, GLOBAL const int* slots, GLOBAL const int* anchors, GLOBAL const h_i32* targets,
        GLOBAL h_u32* state, GLOBAL h_Frame* frame, GLOBAL H_COORDINATE* positions, GLOBAL const H_COORDINATE* box) {
    bool isSane = exponent > -90 && exponent < 90;
    bool isPeriodic = (frame->h_needs & H_PERIODIC) != 0;
    if (!isSane)
        exponent = 0;
    if (first == 0 && !isSane)
        H_NOTE(&state[H_STATE_FAULTS], H_FAULT_POSITION);
#ifdef HELFRICH_DOUBLE
    double scale = unit < 0 ? (double) h_power(-unit) : 1.0 / h_power(unit);
    for (int vertex = first; vertex < vertices; vertex += step) {
        h_Place place = h_load_place(slots[vertex], posq, correction);
        h_Place anchor = h_load_place(anchors[vertex], posq, correction);
        double way[3];
        for (int k = 0; k < 3; k++)
            way[k] = (place.c[k] - anchor.c[k])*scale;
        for (int i = 2; isPeriodic && i >= 0; i--) {
            double times = rint(way[i]/box[4*i]);
            for (int k = 0; k < 3; k++)
                way[k] -= times*box[3*i + k];
        }
        for (int k = 0; k < 3; k++)
            positions[3*vertex + k] = way[k];
    }
#else
    if (first == 0) {
        frame->h_quantum = h_power(exponent - H_HALF_WIDTH - unit);
        for (int term = 0; term < (int) frame->h_num_terms; term++) {
            int power = targets[4*term + 3];
            if (power == 0)
                continue;
            int shift = targets[4*term + 2] - power*(exponent - H_HALF_WIDTH);
            if (shift > 72) {
                H_NOTE(&state[H_STATE_FAULTS], H_FAULT_TARGET);
                shift = 0;
            }
            mm_ulong m = ((mm_ulong) (h_u32) targets[4*term + 1] << 32) | (h_u32) targets[4*term];
            frame->h_terms[term].h_reference = h_shifted(m, shift);
        }
    }
    h_place_t steps = h_power(H_HALF_WIDTH - exponent);
    for (int vertex = first; vertex < vertices; vertex += step) {
        h_Place place = h_load_place(slots[vertex], posq, correction);
        h_Place anchor = h_load_place(anchors[vertex], posq, correction);
        mm_long way[3];
        for (int k = 0; k < 3; k++) {
            h_place_t here = place.c[k]*steps, there = anchor.c[k]*steps;
            // Whole numbers of 64 bits hold both where they differ by less than 2³⁰ and anything is left of the digits.
            bool fits = here < 4e18f && here > -4e18f && there < 4e18f && there > -4e18f;
            if (!fits && isSane)
                H_NOTE(&state[H_STATE_FAULTS], H_FAULT_POSITION);
            way[k] = fits ? (mm_long) rint(here) - (mm_long) rint(there) : 0;
        }
        for (int i = 2; isPeriodic && i >= 0; i--) {
            mm_long times = (mm_long) rint((h_place_t) way[i]/(h_place_t) box[4*i]);
            for (int k = 0; k < 3; k++)
                way[k] -= times*box[3*i + k];
        }
        for (int k = 0; k < 3; k++)
            positions[3*vertex + k] = (h_i32) way[k];
    }
#endif
}

#define H_PLACEMENT GLOBAL const real4* RESTRICT posq, GLOBAL const real4* RESTRICT correction, \
        GLOBAL const int* RESTRICT slots, GLOBAL const int* RESTRICT anchors, GLOBAL const h_i32* RESTRICT targets, \
        GLOBAL h_u32* RESTRICT state, GLOBAL h_Frame* RESTRICT frame, GLOBAL H_COORDINATE* RESTRICT positions, \
        GLOBAL const H_COORDINATE* RESTRICT box

// What the bits of an extent are below.
DEVICE int h_exponent(h_u32 extent) {
    return (int) (extent >> 23) - 126;
}

// With an extent that is known, or with what has been found before.
KERNEL void h_place(int vertices, int extent, int unit, int turn, H_PLACEMENT) {
    if (turn >= 0) {
        if (GLOBAL_ID == 0)
            state[1 - turn] = 0;
        extent = h_exponent(state[turn]);
    }
    h_place_vertices(extent, GLOBAL_ID, GLOBAL_SIZE, vertices, unit, posq, correction, slots, anchors, targets,
            state, frame, positions, box);
}

// Both for small meshes, with one group.
KERNEL void h_find_extent_and_place(int vertices, int unit, H_PLACEMENT) {
    LOCAL h_u32 largest[H_GROUPS_OF_BLOCK*H_GROUP_SIZE];
    h_u32 mine = h_extent(LOCAL_ID, LOCAL_SIZE, vertices, posq, correction, slots, anchors);
    H_LARGEST_OF_GROUP(largest, mine)
    h_place_vertices(h_exponent(largest[0]), LOCAL_ID, LOCAL_SIZE, vertices, unit, posq, correction, slots, anchors,
            targets, state, frame, positions, box);
}

// Add the forces to OpenMM's.
KERNEL void h_add_forces(int vertices, int unit, int stride, GLOBAL const int* RESTRICT slots,
        GLOBAL const h_Frame* RESTRICT frame, GLOBAL const h_u32* RESTRICT rings, GLOBAL real* RESTRICT corner_forces,
        GLOBAL mm_ulong* RESTRICT forces) {
    real scale = unit < 0 ? (real) h_power(-unit) : 1/(real) h_power(unit);
    scale *= 0x100000000;
    for (int vertex = GLOBAL_ID; vertex < vertices; vertex += GLOBAL_SIZE) {
        H_VEC3 force = h_force_on_vertex(vertex, frame, rings, corner_forces);
        for (int k = 0; k < 3; k++)
            forces[slots[vertex] + k*stride] += (mm_ulong) ((mm_long) (force.c[k]*scale));
    }
}

// A float that is finite if a sum is.
#ifdef HELFRICH_DOUBLE
#define H_SHORTENED(sum) ((h_f32) (sum*1e-270))
#else
#define H_SHORTENED(sum) ((h_f32) sum)
#endif

// Add energies to OpenMM's, and derivatives with respect to Context parameters. A run of sums is four numbers: its
// begin, its length, the derivative or −1 for the energy, and the power of two that it is to be multiplied with.
KERNEL void h_add_sums(int numRuns, int numDerivatives, GLOBAL const int* RESTRICT runs,
        GLOBAL const real* RESTRICT results, GLOBAL mixed* RESTRICT energies, GLOBAL mixed* RESTRICT derivatives,
        GLOBAL h_u32* RESTRICT thin, GLOBAL h_u32* RESTRICT state) {
    if (GLOBAL_ID == 0 && thin[0] != 0) {
        H_NOTE(&state[H_STATE_FAULTS], H_FAULT_THIN);
        thin[0] = 0;
    }
    for (int run = 0; run < numRuns; run++) {
        int begin = runs[4*run], length = runs[4*run + 1], derivative = runs[4*run + 2];
        mixed sum = 0;
        for (int k = GLOBAL_ID; k < length; k += GLOBAL_SIZE)
            sum += results[begin + k];
        sum *= h_power(runs[4*run + 3]);
        // By its bits, since compilers may take every number for finite.
        if ((H_AS_UINT(H_SHORTENED(sum)) & 0x7f800000u) == 0x7f800000u)
            H_NOTE(&state[H_STATE_FAULTS], H_FAULT_ENERGY);
        if (derivative < 0)
            energies[GLOBAL_ID] += sum;
        else
            derivatives[GLOBAL_ID*numDerivatives + derivative] += sum;
    }
}
