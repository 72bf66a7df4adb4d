// The sums of area and volume over all triangles, in whole numbers of the lattice's units, and of mean curvature over
// all edges, in those of 2⁻³² of the unit of length, 128 bits wide.
//
// A membrane's area and volume fluctuate by 1e-4, and its forces come from these small differences; single
// precision would leave three digits of them. On the lattice of positions six times the volume is a whole
// number, and so it is summed without any error; twice the area of a triangle is rounded to a share of 1e-9. What an edge
// gives to the mean curvature has the error of a float, and its sum no other.
// Whole numbers have no order of summation either, and compilers do not rearrange them.

// Limbs from the lowest on, two's complement. `totals` holds for each group of triangles twice the area and six times the
// volume, then as bits of floats the derivatives of the energy with respect to area, volume and mean curvature, the mean
// curvature, and its sums over groups of edges.
alias total = vec4<u32>;

// a b, low and high half.
fn product(a: u32, b: u32) -> vec2<u32> {
    let a_low = a & 0xffffu;
    let a_high = a >> 16u;
    let b_low = b & 0xffffu;
    let b_high = b >> 16u;
    let low = a_low * b_low;
    let middle = a_high * b_low + (low >> 16u);
    let other = a_low * b_high + (middle & 0xffffu);
    return vec2<u32>((other << 16u) | (low & 0xffffu), a_high * b_high + (middle >> 16u) + (other >> 16u));
}

fn signed_product(a: i32, b: i32) -> vec2<u32> {
    var result = product(bitcast<u32>(a), bitcast<u32>(b));
    result.y -= select(0u, bitcast<u32>(b), a < 0) + select(0u, bitcast<u32>(a), b < 0);
    return result;
}

fn add64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2<u32>(low, a.y + b.y + select(0u, 1u, low < a.x));
}

fn negative64(a: vec2<u32>) -> vec2<u32> {
    return add64(vec2<u32>(~a.x, ~a.y), vec2<u32>(1u, 0u));
}

fn is_negative(high: u32) -> bool {
    return (high & 0x80000000u) != 0u;
}

fn absolute64(a: vec2<u32>) -> vec2<u32> {
    return select(a, negative64(a), is_negative(a.y));
}

fn shift_left64(a: vec2<u32>, bits: u32) -> vec2<u32> {
    if bits == 0u {
        return a;
    }
    return vec2<u32>(a.x << bits, (a.y << bits) | (a.x >> (32u - bits)));
}

// Shifted right by less than 32 bits and rounded, of a number below 2⁶².
fn shift_right64(a: vec2<u32>, bits: u32) -> vec2<u32> {
    if bits == 0u {
        return a;
    }
    let rounded = add64(a, vec2<u32>(1u << (bits - 1u), 0u));
    return vec2<u32>((rounded.x >> bits) | (rounded.y << (32u - bits)), rounded.y >> bits);
}

fn float64(a: vec2<u32>) -> f32 {
    let size = absolute64(a);
    let result = f32(size.y) * 4294967296.0 + f32(size.x);
    return select(result, -result, is_negative(a.y));
}

fn add128(a: vec4<u32>, b: vec4<u32>) -> vec4<u32> {
    var sum: vec4<u32>;
    var carry = 0u;
    for (var k = 0u; k < 4u; k++) {
        let partial = a[k] + b[k];
        let limb = partial + carry;
        carry = select(0u, 1u, partial < a[k] || limb < partial);
        sum[k] = limb;
    }
    return sum;
}

fn negative128(a: vec4<u32>) -> vec4<u32> {
    return add128(~a, vec4<u32>(1u, 0u, 0u, 0u));
}

fn float128(a: vec4<u32>) -> f32 {
    let size = select(a, negative128(a), is_negative(a.w));
    let result = ((f32(size.w) * 4294967296.0 + f32(size.z)) * 4294967296.0 + f32(size.y)) * 4294967296.0
        + f32(size.x);
    return select(result, -result, is_negative(a.w));
}

// A signed number of 64 bits times 2³² to the power of `limbs`, 0 or 1.
fn widened(a: vec2<u32>, limbs: u32) -> vec4<u32> {
    let sign = select(0u, 0xffffffffu, is_negative(a.y));
    if limbs == 0u {
        return vec4<u32>(a, sign, sign);
    }
    return vec4<u32>(0u, a, sign);
}

// A component of the normal, u v − w x, below 2⁶² since no side has 2³⁰ steps.
fn component(u: i32, v: i32, w: i32, x: i32) -> vec2<u32> {
    return add64(signed_product(u, v), negative64(signed_product(w, x)));
}

// a n.
fn wide_product(a: i32, n: vec2<u32>) -> vec4<u32> {
    var low = product(bitcast<u32>(a), n.x);
    low.y -= select(0u, n.x, a < 0);
    return add128(widened(low, 0u), widened(signed_product(a, bitcast<i32>(n.y)), 1u));
}

// |n| for a vector of numbers below 2⁶²: the root s of a rounded sum of squares in single precision, and a
// step of Newton's method, (Σ − s²) / 2 s, in which the difference is exact.
fn norm(x: vec2<u32>, y: vec2<u32>, z: vec2<u32>) -> vec2<u32> {
    let sizes = array<vec2<u32>, 3>(absolute64(x), absolute64(y), absolute64(z));
    let high = sizes[0].y | sizes[1].y | sizes[2].y;
    let low = sizes[0].x | sizes[1].x | sizes[2].x;
    let bits = select(32u - countLeadingZeros(low), 64u - countLeadingZeros(high), high != 0u);
    let shift = select(0u, bits - 30u, bits > 30u);
    var squares = vec2<u32>();
    for (var k = 0u; k < 3u; k++) {
        let short = shift_right64(sizes[k], shift).x;
        squares = add64(squares, product(short, short));
    }
    let first = u32(sqrt(float64(squares)));
    if first == 0u {
        return vec2<u32>();
    }
    let rest = add64(squares, negative64(product(first, first)));
    let correction = float64(rest) / (2.0 * f32(first));
    // The correction is below 2¹⁰, so that 16 bits of its fraction fit beside it.
    let kept = min(shift, 16u);
    let fine = i32(round(correction * f32(1u << kept)));
    let fraction = vec2<u32>(bitcast<u32>(fine), select(0u, 0xffffffffu, fine < 0));
    return add64(shift_left64(vec2<u32>(first, 0u), shift), shift_left64(fraction, shift - kept));
}

var<workgroup> wide_shares: array<vec4<u32>, GROUP_SIZE>;

fn total_of_group(share: vec4<u32>, lane: u32) -> vec4<u32> {
    workgroupBarrier();
    wide_shares[lane] = share;
    for (var half = GROUP_SIZE / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if lane < half {
            wide_shares[lane] = add128(wide_shares[lane], wide_shares[lane + half]);
        }
    }
    return wide_shares[lane];
}

fn sum_triangle(triangle: u32, exists: bool, geometry: vec4r, lane: u32, group: u32, groups: u32) {
    var area = vec4<u32>();
    var volume = vec4<u32>();
    if exists {
        let a = lattice_position(corner_vertex(triangle, 0u));
        let u = lattice_separation(corner_vertex(triangle, 0u), corner_vertex(triangle, 1u));
        let v = lattice_separation(corner_vertex(triangle, 0u), corner_vertex(triangle, 2u));
        let x = component(u.y, v.z, u.z, v.y);
        let y = component(u.z, v.x, u.x, v.z);
        let z = component(u.x, v.y, u.y, v.x);
        area = vec4<u32>(norm(x, y, z), 0u, 0u);
        volume = add128(add128(wide_product(a.x, x), wide_product(a.y, y)), wide_product(a.z, z));
    }
    let areas = total_of_group(area, lane);
    if lane == 0u && group < groups {
        totals[2u * group] = areas;
    }
    let volumes = total_of_group(volume, lane);
    if lane == 0u && group < groups {
        totals[2u * group + 1u] = volumes;
    }
}

var<workgroup> area_of_all: vec4<u32>;
var<workgroup> volume_of_all: vec4<u32>;

fn sum_groups(groups: u32, lane: u32) {
    var area = vec4<u32>();
    var volume = vec4<u32>();
    for (var group = lane; group < groups; group += GROUP_SIZE) {
        area = add128(area, totals[2u * group]);
        volume = add128(volume, totals[2u * group + 1u]);
    }
    let areas = total_of_group(area, lane);
    if lane == 0u {
        area_of_all = areas;
    }
    let volumes = total_of_group(volume, lane);
    if lane == 0u {
        volume_of_all = volumes;
    }
}

// How far the total area is above what a term measures it from.
fn excess_of_area(term: u32, origin: real) -> real {
    let difference = float128(add128(area_of_all, negative128(frame.terms[term].reference)));
    return difference * frame.quantum * frame.quantum * 0.5;
}

// How far the total volume is above what a term measures it from.
fn excess_of_volume(term: u32, origin: real) -> real {
    let difference = float128(add128(volume_of_all, negative128(frame.terms[term].reference)));
    return difference * frame.quantum * frame.quantum * frame.quantum / 6.0;
}

// A length in the units of its sum, below 2³¹ of the unit of length as all lengths are.
fn whole_number(length: f32) -> vec4<u32> {
    let size = abs(length);
    let above = u32(size);
    let bits = vec2<u32>(u32((size - f32(above)) * 4294967296.0), above);
    return widened(select(bits, negative64(bits), length < 0.0), 0u);
}

fn sum_edge(share: real, lane: u32, group: u32, groups: u32) {
    let sum = total_of_group(whole_number(share), lane);
    if lane == 0u && group < groups {
        totals[2u * triangle_groups() + 2u + group] = sum;
    }
}

fn sum_groups_of_edges(groups: u32, lane: u32) {
    let first = 2u * triangle_groups() + 2u;
    var share = vec4<u32>();
    for (var group = lane; group < groups; group += GROUP_SIZE) {
        share = add128(share, totals[first + group]);
    }
    let sum = total_of_group(share, lane);
    if lane == 0u {
        totals[first - 1u] = sum;
    }
}

// How far the total mean curvature is above what a term measures it from.
fn excess_of_mean_curvature(term: u32, origin: real) -> real {
    let sum = totals[2u * triangle_groups() + 1u];
    return float128(add128(sum, negative128(frame.terms[term].reference))) / 4294967296.0;
}

fn store_total_partials(partials: TotalPartials) {
    let mean_curvature = bitcast<u32>(partials.mean_curvature);
    totals[2u * triangle_groups()] =
        vec4<u32>(bitcast<u32>(partials.area), bitcast<u32>(partials.volume), mean_curvature, 0u);
}

fn total_partials() -> TotalPartials {
    let stored = totals[2u * triangle_groups()];
    return TotalPartials(bitcast<f32>(stored.x), bitcast<f32>(stored.y), bitcast<f32>(stored.z));
}

fn constant_of(term: u32, triangle: u32, k: u32) -> real {
    return constants[constant_place(term, triangle, k)].x;
}

// What is a whole number as one of 64 bits; of others without their fractions.
fn integer64(x: f32) -> vec2<u32> {
    let bits = bitcast<u32>(x) & 0x7fffffffu;
    let exponent = i32(bits >> 23u) - 150;
    let mantissa = (bits & 0x7fffffu) | 0x800000u;
    var size = vec2<u32>();
    if exponent >= 32 {
        size = vec2<u32>(0u, mantissa << u32(exponent - 32));
    } else if exponent >= 0 {
        size = shift_left64(vec2<u32>(mantissa, 0u), u32(exponent));
    } else if exponent > -24 {
        size = vec2<u32>(mantissa >> u32(-exponent), 0u);
    }
    return select(size, negative64(size), x < 0.0);
}

// By how much the scalar product of the sides that leave corner k exceeds constant k. On the lattice it is a whole number,
// and so the difference has as many digits as a float, however small it is.
fn dot_excess(term: u32, index: u32, triangle: TriangleGeometry, k: u32) -> real {
    let rest = constants[constant_place(term, index, k)];
    let step = frame.quantum * frame.quantum;
    // Rest lengths that are larger than the lattice need no digits to differ from those of now.
    if abs(rest.x) >= step * 2305843009213693952.0 {
        return triangle.dots[k] - rest.x;
    }
    let here = corner_vertex(index, k);
    let u = lattice_separation(here, corner_vertex(index, (k + 1u) % 3u));
    let v = lattice_separation(here, corner_vertex(index, (k + 2u) % 3u));
    let product = add64(add64(signed_product(u.x, v.x), signed_product(u.y, v.y)), signed_product(u.z, v.z));
    let at_rest = add64(integer64(rest.x / step), integer64(rest.y / step));
    return float64(add64(product, negative64(at_rest))) * step;
}
