// The passes over the mesh, one thread an element, each gathering what it needs in a fixed order. `energy_of_…`
// call the potentials; build.rs writes them from the names of the functions in potentials/.

// The number of a group. Those past the last one that has elements must not store anything.
fn group_index(group: vec3<u32>) -> u32 {
    return group.y * GROUPS_ACROSS + group.x;
}

fn groups_for(elements: u32) -> u32 {
    return (elements + GROUP_SIZE - 1u) / GROUP_SIZE;
}

fn triangle_groups() -> u32 {
    return groups_for(frame.num_triangles);
}

fn is_needed(bits: u32) -> bool {
    return (frame.needs & bits) != 0u;
}

// Normals and areas.
@compute @workgroup_size(GROUP_SIZE)
fn triangles_forward(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let triangle = group_index(id) * GROUP_SIZE + lane;
    if triangle < frame.num_triangles {
        triangle_geometry[triangle] = new_triangle(triangle);
    }
}

// Normals and areas, and their sums: a pass of its own, as not all compilers take barriers that depend on buffers.
@compute @workgroup_size(GROUP_SIZE)
fn triangles_forward_summed(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let group = group_index(id);
    let triangle = group * GROUP_SIZE + lane;
    let exists = triangle < frame.num_triangles;
    var geometry = vec4r();
    if exists {
        geometry = new_triangle(triangle);
        triangle_geometry[triangle] = geometry;
    }
    sum_triangle(triangle, exists, geometry, lane, group, triangle_groups());
}

// The mean curvature of each group of edges.
@compute @workgroup_size(GROUP_SIZE)
fn mean_curvature_of_edges(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let group = group_index(id);
    let index = group * GROUP_SIZE + lane;
    var share = real(0.0);
    if index < frame.num_edges {
        let edge = edge_geometry[index];
        share = real(0.5) * edge.x * edge.y;
    }
    sum_edge(share, lane, group, groups_for(frame.num_edges));
}

// The sum of these; one group.
@compute @workgroup_size(GROUP_SIZE)
fn mean_curvature_forward(@builtin(local_invocation_index) lane: u32) {
    sum_groups_of_edges(groups_for(frame.num_edges), lane);
}

// The energies of totals, and the derivatives with respect to them; one group.
@compute @workgroup_size(GROUP_SIZE)
fn totals_forward(@builtin(local_invocation_index) lane: u32) {
    sum_groups(triangle_groups(), lane);
    if lane != 0u {
        return;
    }
    var partials = TotalPartials(real(0.0), real(0.0), real(0.0));
    for (var term = 0u; term < frame.num_terms; term++) {
        if (frame.terms[term].needs & TOTALS) == 0u {
            continue;
        }
        let contribution = energy_of_totals(term, &partials);
        let first = frame.terms[term].sums[SUMS_OF_TOTALS];
        results[first] = contribution.energy;
        if (frame.terms[term].needs & DERIVATIVES) != 0u {
            for (var k = 0u; k < PARAMETERS; k++) {
                results[first + k + 1u] = contribution.by_parameter[k];
            }
        }
    }
    store_total_partials(partials);
}

// Lengths, dihedral angles and moments.
@compute @workgroup_size(GROUP_SIZE)
fn edges_forward(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = group_index(id) * GROUP_SIZE + lane;
    if index >= frame.num_edges {
        return;
    }
    let edge = new_edge(index);
    var partial = real(0.0);
    for (var term = 0u; term < frame.num_terms; term++) {
        if (frame.terms[term].needs & EDGES) != 0u {
            energy_of_edge(term, index, edge, &partial);
        }
    }
    store_edge(index, edge, partial);
}

// The same, and the energies.
@compute @workgroup_size(GROUP_SIZE)
fn edges_forward_summed(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let group = group_index(id);
    let index = group * GROUP_SIZE + lane;
    let exists = index < frame.num_edges;
    var edge: EdgeGeometry;
    if exists {
        edge = new_edge(index);
    }
    var partial = real(0.0);
    for (var term = 0u; term < frame.num_terms; term++) {
        if (frame.terms[term].needs & EDGES) == 0u {
            continue;
        }
        var contribution = nothing();
        if exists {
            contribution = energy_of_edge(term, index, edge, &partial);
        }
        store_sums(term, frame.terms[term].sums[SUMS_OF_EDGES], contribution, lane, group, groups_for(frame.num_edges));
    }
    if exists {
        store_edge(index, edge, partial);
    }
}

fn store_edge(index: u32, edge: EdgeGeometry, partial: real) {
    let moment = select(real(0.0), partial / root(edge.length_squared), partial != real(0.0));
    edge_geometry[index] = vec4r(edge.length_squared, edge.bend, moment, real(0.0));
}

// Areas, curvatures and vectors, and the derivatives of energies with respect to them.
@compute @workgroup_size(GROUP_SIZE)
fn vertices_forward(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = group_index(id) * GROUP_SIZE + lane;
    if index >= frame.num_vertices {
        return;
    }
    let vertex = new_vertex(index);
    let inner = !is_on_border(index);
    var partials: VertexPartials;
    for (var term = 0u; term < frame.num_terms; term++) {
        if acts_on_vertex(term, inner) {
            energy_of_vertex(term, index, vertex, &partials);
        }
    }
    store_vertex(index, partials);
}

// The same, and the energies.
@compute @workgroup_size(GROUP_SIZE)
fn vertices_forward_summed(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let group = group_index(id);
    let index = group * GROUP_SIZE + lane;
    let exists = index < frame.num_vertices;
    var vertex: VertexGeometry;
    var inner = false;
    if exists {
        vertex = new_vertex(index);
        inner = !is_on_border(index);
    }
    var partials: VertexPartials;
    for (var term = 0u; term < frame.num_terms; term++) {
        if (frame.terms[term].needs & VERTICES) == 0u {
            continue;
        }
        var contribution = nothing();
        if exists && acts_on_vertex(term, inner) {
            contribution = energy_of_vertex(term, index, vertex, &partials);
        }
        store_sums(term, frame.terms[term].sums[SUMS_OF_VERTICES], contribution, lane, group, groups_for(frame.num_vertices));
    }
    if exists {
        store_vertex(index, partials);
    }
}

fn acts_on_vertex(term: u32, inner: bool) -> bool {
    let needs = frame.terms[term].needs;
    return (needs & VERTICES) != 0u && (inner || (needs & INNER) == 0u);
}

fn store_vertex(index: u32, partials: VertexPartials) {
    vertex_partials[index] = vec4r(partials.area, partials.voronoi_area, partials.curvature, real(0.0));
    if is_needed(VECTORS) {
        store_vector_partial(index, 0u, partials.cotangent);
        store_vector_partial(index, 1u, partials.umbrella);
        store_vector_partial(index, 2u, partials.normal_sum);
    }
}

// Whether a side of a triangle has no other triangle.
fn is_border_side(triangle: u32, side: u32) -> bool {
    return edge_corners[corner_edges[3u * triangle + side]].y == NO_CORNER;
}

// Whether a vertex is on a border: one of the edges that leave it has one triangle only.
fn is_on_border(index: u32) -> bool {
    if 2u * frame.num_edges == 3u * frame.num_triangles {
        return false;
    }
    let ring = frame.num_vertices + 1u;
    for (var place = rings[index]; place < rings[index + 1u]; place++) {
        if edge_corners[corner_edges[rings[ring + place]]].y == NO_CORNER {
            return true;
        }
    }
    return false;
}

fn new_vertex(index: u32) -> VertexGeometry {
    var vertex: VertexGeometry;
    let ring = frame.num_vertices + 1u;
    for (var place = rings[index]; place < rings[index + 1u]; place++) {
        let corner = rings[ring + place];
        let triangle = corner / 3u;
        if is_needed(VECTORS) {
            let geometry = load_triangle(triangle);
            vertex.area += geometry.twice_area / real(6.0);
            add_corner(&vertex, geometry, corner % 3u, is_needed(NORMALS));
        } else {
            vertex.area += triangle_geometry[triangle].w / real(6.0);
        }
        if is_needed(CURVATURES) {
            // Each edge at a vertex leaves it in exactly one triangle; not so at borders, where nobody asks.
            let edge = edge_geometry[corner_edges[corner]];
            vertex.curvature += real(0.5) * edge.x * edge.y;
        }
    }
    return vertex;
}

// All forces of a triangle on its corners.
@compute @workgroup_size(GROUP_SIZE)
fn triangles_backward(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = group_index(id) * GROUP_SIZE + lane;
    if index >= frame.num_triangles {
        return;
    }
    let triangle = load_triangle(index);
    var partials: TrianglePartials;
    for (var term = 0u; term < frame.num_terms; term++) {
        if (frame.terms[term].needs & TRIANGLES) != 0u {
            energy_of_triangle(term, index, triangle, &partials);
        }
    }
    store_corner_forces(index, triangle, partials);
}

// The same, and the energies of triangles.
@compute @workgroup_size(GROUP_SIZE)
fn triangles_backward_summed(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let group = group_index(id);
    let index = group * GROUP_SIZE + lane;
    let exists = index < frame.num_triangles;
    var triangle: TriangleGeometry;
    if exists {
        triangle = load_triangle(index);
    }
    var partials: TrianglePartials;
    for (var term = 0u; term < frame.num_terms; term++) {
        if (frame.terms[term].needs & TRIANGLES) == 0u {
            continue;
        }
        var contribution = nothing();
        if exists {
            contribution = energy_of_triangle(term, index, triangle, &partials);
        }
        store_sums(term, frame.terms[term].sums[SUMS_OF_TRIANGLES], contribution, lane, group, triangle_groups());
    }
    if exists && is_needed(FORCES) {
        store_corner_forces(index, triangle, partials);
    }
}

fn store_corner_forces(index: u32, triangle: TriangleGeometry, of_terms: TrianglePartials) {
    var partials = of_terms;
    var totals = TotalPartials(real(0.0), real(0.0), real(0.0));
    if is_needed(TOTALS) {
        totals = total_partials();
        partials.area += totals.area;
    }
    var curvature_partials = vec3r();
    if is_needed(VERTICES) {
        var sum = real(0.0);
        for (var k = 0u; k < 3u; k++) {
            let stored = vertex_partials[corner_vertex(index, k)];
            sum += stored.x;
            curvature_partials[k] = stored.z;
        }
        partials.area += sum / real(3.0);
    }
    var half_tensions = vec3r();
    var moments = vec3r();
    if is_needed(EDGES | CURVATURES) {
        for (var k = 0u; k < 3u; k++) {
            let edge = edge_geometry[corner_edges[3u * index + k]];
            // Jülicher's curvature adds m d(l φ), with m the mean of ∂E/∂J at the two ends.
            let mean = real(0.5) * (curvature_partials[k] + curvature_partials[(k + 1u) % 3u]);
            half_tensions[k] = real(0.5) * mean * edge.y;
            moments[k] = mean + edge.z;
            if is_needed(MEAN_CURVATURE) {
                // Half of a vertex' curvature is in the total. Moments that are the same at all sides have no force, so
                // instead of them sides at borders, which have no angle, get what they have less.
                let part = real(0.5) * totals.mean_curvature;
                half_tensions[k] += real(0.5) * part * edge.y;
                moments[k] -= select(real(0.0), part, is_border_side(index, k));
            }
        }
    }
    var forces = forces_on_corners(
        triangle, partials.area, partials.length_squared, half_tensions, moments, totals.volume);
    if is_needed(VECTORS) {
        let more = forces_of_vectors(index, triangle, is_needed(NORMALS));
        for (var k = 0u; k < 3u; k++) {
            forces[k] += more[k];
        }
    }
    for (var k = 0u; k < 3u; k++) {
        let first = FORCES_PER_TRIANGLE * index + 3u * k;
        corner_forces[first] = forces[k].x;
        corner_forces[first + 1u] = forces[k].y;
        corner_forces[first + 2u] = forces[k].z;
    }
}

// The force on each vertex.
@compute @workgroup_size(GROUP_SIZE)
fn vertices_backward(@builtin(workgroup_id) id: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = group_index(id) * GROUP_SIZE + lane;
    if index >= frame.num_vertices {
        return;
    }
    let force = force_on_vertex(index);
    results[3u * index] = force.x;
    results[3u * index + 1u] = force.y;
    results[3u * index + 2u] = force.z;
}

// The sum over its corners.
fn force_on_vertex(index: u32) -> vec3r {
    var force = vec3r();
    let ring = frame.num_vertices + 1u;
    for (var place = rings[index]; place < rings[index + 1u]; place++) {
        let first = 3u * rings[ring + place];
        force += vec3r(corner_forces[first], corner_forces[first + 1u], corner_forces[first + 2u]);
    }
    return force;
}
