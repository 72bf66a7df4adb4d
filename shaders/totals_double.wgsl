// The sums of area and volume over all triangles, and of mean curvature over all edges, in double precision, as trees
// of fixed shape.

// `totals` holds twice the area and six times the volume for each group of triangles, then the derivatives of the energy
// with respect to area and volume, that with respect to mean curvature, the mean curvature, and its sums over groups of
// edges.
alias total = vec2<f64>;

var<workgroup> total_shares: array<vec2<f64>, GROUP_SIZE>;

fn total_of_group(share: vec2<f64>, lane: u32) -> vec2<f64> {
    workgroupBarrier();
    total_shares[lane] = share;
    for (var half = GROUP_SIZE / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if lane < half {
            total_shares[lane] += total_shares[lane + half];
        }
    }
    return total_shares[lane];
}

fn sum_triangle(triangle: u32, exists: bool, geometry: vec4r, lane: u32, group: u32, groups: u32) {
    var share = vec2<f64>();
    if exists {
        share = vec2<f64>(geometry.w, dot(position(corner_vertex(triangle, 0u)), geometry.xyz));
    }
    let sum = total_of_group(share, lane);
    if lane == 0u && group < groups {
        totals[group] = sum;
    }
}

var<workgroup> sum_of_all: vec2<f64>;

fn sum_groups(groups: u32, lane: u32) {
    var share = vec2<f64>();
    for (var group = lane; group < groups; group += GROUP_SIZE) {
        share += totals[group];
    }
    let sum = total_of_group(share, lane);
    if lane == 0u {
        sum_of_all = sum;
    }
}

// How far the total area is above what a term measures it from.
fn excess_of_area(term: u32, origin: real) -> real {
    return real(0.5) * sum_of_all.x - origin;
}

// How far the total volume is above what a term measures it from.
fn excess_of_volume(term: u32, origin: real) -> real {
    return sum_of_all.y / real(6.0) - origin;
}

fn sum_edge(share: real, lane: u32, group: u32, groups: u32) {
    let sum = total_of_group(vec2<f64>(share, real(0.0)), lane);
    if lane == 0u && group < groups {
        totals[triangle_groups() + 3u + group] = sum;
    }
}

fn sum_groups_of_edges(groups: u32, lane: u32) {
    let first = triangle_groups() + 3u;
    var share = vec2<f64>();
    for (var group = lane; group < groups; group += GROUP_SIZE) {
        share += totals[first + group];
    }
    let sum = total_of_group(share, lane);
    if lane == 0u {
        totals[first - 1u] = sum;
    }
}

// How far the total mean curvature is above what a term measures it from.
fn excess_of_mean_curvature(term: u32, origin: real) -> real {
    return totals[triangle_groups() + 2u].x - origin;
}

fn store_total_partials(partials: TotalPartials) {
    totals[triangle_groups()] = vec2<f64>(partials.area, partials.volume);
    totals[triangle_groups() + 1u] = vec2<f64>(partials.mean_curvature, real(0.0));
}

fn total_partials() -> TotalPartials {
    let stored = totals[triangle_groups()];
    return TotalPartials(stored.x, stored.y, totals[triangle_groups() + 1u].x);
}

fn constant_of(term: u32, triangle: u32, k: u32) -> real {
    return constants[constant_place(term, triangle, k)];
}

// By how much the scalar product of the sides that leave corner k exceeds constant k.
fn dot_excess(term: u32, index: u32, triangle: TriangleGeometry, k: u32) -> real {
    return triangle.dots[k] - constants[constant_place(term, index, k)];
}
