// Double precision. Positions are relative to the middle of each part of the mesh.

alias real = f64;
alias vec3r = vec3<f64>;
alias vec4r = vec4<f64>;
alias coordinate = f64;
alias constant = f64;

// Only what has no area at all is refused, as on the processor.
const THINNEST = 0.0;

fn position(vertex: u32) -> vec3r {
    return vec3r(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
}

fn box_vector(k: u32) -> vec3r {
    return vec3r(box_vectors[3u * k], box_vectors[3u * k + 1u], box_vectors[3u * k + 2u]);
}

// The vector from one vertex to another of the same part of the mesh; in a periodic box its shortest image.
fn separation(start: u32, end: u32) -> vec3r {
    var way = position(end) - position(start);
    if is_needed(PERIODIC) {
        let a = box_vector(0u);
        let b = box_vector(1u);
        let c = box_vector(2u);
        way -= c * round(way.z / c.z);
        way -= b * round(way.y / b.y);
        way -= a * round(way.x / a.x);
    }
    return way;
}

// Vulkan promises no more than single precision for the square root of a double; a step of Newton's
// method brings the rest.
fn root(x: real) -> real {
    let first = sqrt(x);
    if first == real(0.0) {
        return first;
    }
    return real(0.5) * (first + x / first);
}
