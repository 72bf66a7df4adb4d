// Whole numbers of 64 and 128 bits, in place of functions of the same names in totals_single.wgsl: WGSL has none, OpenMM's
// dialect has the former. They are exact, so that nothing depends on which of the two computes.

DEVICE mm_ulong h_joined(h_u32_2 a) {
    return ((mm_ulong) a.c[1] << 32) | a.c[0];
}

DEVICE h_u32_2 h_split(mm_ulong a) {
    h_u32_2 result;
    result.c[0] = (h_u32) a;
    result.c[1] = (h_u32) (a >> 32);
    return result;
}

DEVICE h_u32_2 h_product(h_u32 a, h_u32 b) {
    return h_split((mm_ulong) a*b);
}

DEVICE h_u32_2 h_signed_product(h_i32 a, h_i32 b) {
    return h_split((mm_ulong) ((mm_long) a*b));
}

DEVICE h_u32_2 h_add64(h_u32_2 a, h_u32_2 b) {
    return h_split(h_joined(a) + h_joined(b));
}

DEVICE h_u32_2 h_negative64(h_u32_2 a) {
    return h_split(0 - h_joined(a));
}

DEVICE h_u32_2 h_shift_left64(h_u32_2 a, h_u32 bits) {
    return h_split(h_joined(a) << bits);
}

DEVICE h_u32_2 h_shift_right64(h_u32_2 a, h_u32 bits) {
    mm_ulong rounder = bits == 0 ? 0 : (mm_ulong) 1 << (bits - 1);
    return h_split((h_joined(a) + rounder) >> bits);
}

DEVICE h_u32_2 h_component(h_i32 u, h_i32 v, h_i32 w, h_i32 x) {
    return h_split((mm_ulong) ((mm_long) u*v - (mm_long) w*x));
}

DEVICE h_u32_4 h_limbs(mm_ulong low, mm_ulong high) {
    h_u32_4 result;
    result.c[0] = (h_u32) low;
    result.c[1] = (h_u32) (low >> 32);
    result.c[2] = (h_u32) high;
    result.c[3] = (h_u32) (high >> 32);
    return result;
}

DEVICE h_u32_4 h_add128(h_u32_4 a, h_u32_4 b) {
    mm_ulong a_low = ((mm_ulong) a.c[1] << 32) | a.c[0], a_high = ((mm_ulong) a.c[3] << 32) | a.c[2];
    mm_ulong b_low = ((mm_ulong) b.c[1] << 32) | b.c[0], b_high = ((mm_ulong) b.c[3] << 32) | b.c[2];
    mm_ulong low = a_low + b_low;
    mm_ulong high = a_high + b_high + (low < a_low ? 1 : 0);
    return h_limbs(low, high);
}

