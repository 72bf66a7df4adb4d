// What the passes read and write: one bind group, the same for all of them. `real`, `vec3r` and
// `vec4r` are the numbers of the module's precision. src/evaluator/gpu/frame.rs fills `Frame`; the
// two change together.

// Lengths are in units of a power of two near the mean edge, so that no square of a square leaves the
// range of single precision for any size of mesh; the host scales parameters and results.
struct Term {
    // Which potential, as build.rs numbers the files of potentials/.
    potential: u32,
    form: u32,
    switches: u32,
    // Bits of Needs, and those below.
    needs: u32,
    // Where in `results` the sums of the totals, triangles, edges and vertices go.
    sums: vec4<u32>,
    // Where in `fields` the values of single elements begin, NO_FIELD where there are none.
    field_starts: vec4<u32>,
    // The target of the total area or volume as a whole number of the lattice's units, two's complement.
    reference: vec4<u32>,
    values: vec4r,
    // What one unit of a field is.
    field_units: vec4r,
}

struct Frame {
    num_vertices: u32,
    num_edges: u32,
    num_triangles: u32,
    needs: u32,
    num_terms: u32,
    // The spacing of the lattice on which positions are whole numbers (single precision).
    quantum: f32,
    padding: vec2<u32>,
    terms: array<Term>,
}

// The bits of Needs in src/potentials/mod.rs …
const TOTALS = 1u;
const TRIANGLES = 2u;
const EDGES = 4u;
const VERTICES = 8u;
const CURVATURES = 16u;
const VECTORS = 32u;
const NORMALS = 64u;
// … and two more: whether the derivatives with respect to scalars, or forces, are wanted.
const DERIVATIVES = 128u;
const FORCES = 256u;

const NO_FIELD = 0xffffffffu;

@group(0) @binding(0) var<storage, read> frame: Frame;
// Corner 3 t + k is the k-th corner of triangle t; the vertex there, and the edge from it to the next.
@group(0) @binding(2) var<storage, read> corner_vertices: array<u32>;
@group(0) @binding(3) var<storage, read> corner_edges: array<u32>;
// The corners from which an edge leaves in its left and its right triangle.
@group(0) @binding(4) var<storage, read> edge_corners: array<vec2<u32>>;
// Where the corners of each vertex begin, then the corners themselves.
@group(0) @binding(5) var<storage, read> rings: array<u32>;
@group(0) @binding(6) var<storage, read> fields: array<real>;
// Normal and twice the area.
@group(0) @binding(7) var<storage, read_write> triangle_geometry: array<vec4r>;
// l², φ / l, and the bending moment per length of potentials of the angle.
@group(0) @binding(8) var<storage, read_write> edge_geometry: array<vec4r>;
// ∂E/∂ barycentric area, Voronoi area and curvature of each vertex.
@group(0) @binding(9) var<storage, read_write> vertex_slopes: array<vec4r>;
// ∂E/∂ cotangent vector, umbrella vector and normal sum, nine numbers a vertex.
@group(0) @binding(10) var<storage, read_write> vector_slopes: array<real>;
// Nine numbers a triangle.
@group(0) @binding(11) var<storage, read_write> corner_forces: array<real>;
// Forces, three numbers a vertex, then the sums of the terms, group by group.
@group(0) @binding(13) var<storage, read_write> results: array<real>;
// The number of triangles that are too thin for this precision.
@group(0) @binding(14) var<storage, read_write> thin_triangles: atomic<u32>;

// The value of a parameter at an element.
fn value(term: u32, parameter: u32, element: u32) -> real {
    let start = frame.terms[term].field_starts[parameter];
    if start == NO_FIELD {
        return frame.terms[term].values[parameter];
    }
    return fields[start + element] * frame.terms[term].field_units[parameter];
}

// 1 if a parameter is one value for all elements, else 0: a field hides the scalar, on which nothing
// depends then.
fn is_scalar(term: u32, parameter: u32) -> real {
    return select(real(0.0), real(1.0), frame.terms[term].field_starts[parameter] == NO_FIELD);
}
