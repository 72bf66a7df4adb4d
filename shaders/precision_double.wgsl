// Double precision. Positions are relative to the middle of each part of the mesh.

alias real = f64;
alias vec3r = vec3<f64>;
alias vec4r = vec4<f64>;
alias coordinate = f64;

// Only what has no area at all is refused, as on the processor.
const THINNEST = 0.0;

fn position(vertex: u32) -> vec3r {
    return vec3r(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
}

// The vector from one vertex to another of the same part of the mesh.
fn separation(start: u32, end: u32) -> vec3r {
    return position(end) - position(start);
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
