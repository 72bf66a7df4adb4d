// Single precision. Positions are whole numbers on a lattice over the mesh, 2³⁰ steps across each of its
// parts: their differences are exact, so that a side is as precise as a number can be, however small it is
// beside the mesh, and no compiler can spoil that by reordering floating-point arithmetic.

alias real = f32;
alias vec3r = vec3<f32>;
alias vec4r = vec4<f32>;
alias coordinate = i32;
// The sum of two.
alias constant = vec2<f32>;

// A triangle whose height is a smaller share of its longest side is left to the processor, or on OpenMM's platforms reported:
// the digits that its normal has lost in single precision are missed in the forces (2e-4 of the largest at a share of 1e-4).
const THINNEST = 1e-3;

fn lattice_position(vertex: u32) -> vec3<i32> {
    return vec3<i32>(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
}

fn box_vector(k: u32) -> vec3<i32> {
    return vec3<i32>(box_vectors[3u * k], box_vectors[3u * k + 1u], box_vectors[3u * k + 2u]);
}

// How many times a length goes into another, rounded.
fn times(length: i32, side: i32) -> i32 {
    return i32(round(real(length) / real(side)));
}

// The vector from one vertex to another of the same part of the mesh, in steps; in a periodic box its shortest image.
fn lattice_separation(start: u32, end: u32) -> vec3<i32> {
    var way = lattice_position(end) - lattice_position(start);
    if is_needed(PERIODIC) {
        let a = box_vector(0u);
        let b = box_vector(1u);
        let c = box_vector(2u);
        way -= c * times(way.z, c.z);
        way -= b * times(way.y, b.y);
        way -= a * times(way.x, a.x);
    }
    return way;
}

fn separation(start: u32, end: u32) -> vec3r {
    return vec3r(lattice_separation(start, end)) * frame.quantum;
}

fn root(x: real) -> real {
    return sqrt(x);
}
