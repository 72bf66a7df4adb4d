// Curvature elasticity: ½ κ [ c² / a − 2 C₀ c + C₀² a ] for each vertex, with the integrated curvature c and the
// area a of the scheme.

fn bending_vertex(
    term: u32,
    element: u32,
    vertex: VertexGeometry,
    partials: ptr<function, VertexPartials>,
) -> Contribution {
    let scheme = frame.terms[term].form;
    let is_unsigned = (frame.terms[term].switches & UNSIGNED) != 0u;
    let voronoi = scheme == SCHEME_GOMPPER_KROLL || scheme == SCHEME_JULICHER_VORONOI;
    let umbrella = scheme == SCHEME_ESPRIU;
    let is_vector = umbrella || scheme == SCHEME_GOMPPER_KROLL || scheme == SCHEME_GOMPPER_KROLL_BARYCENTRIC;

    let area = select(vertex.area, vertex.voronoi_area, voronoi);
    let vector = select(vertex.cotangent, vertex.umbrella, umbrella);
    // c² and the linear term; what the linear term's derivative with respect to c is, as a sign or vector.
    var square: real;
    var linear = real(0.0);
    var sign_of_linear = real(1.0);
    var direction = vec3r();
    var length = real(0.0);
    if is_vector {
        square = dot(vector, vector);
        // Where nobody asked for normals their sums are zero, and so is what the linear term is for. |c| has
        // no derivative at 0, where the mean over all directions is 0.
        let along = select(vertex.normal_sum, vector, is_unsigned);
        length = root(dot(along, along));
        if length > real(0.0) {
            direction = along / length;
            linear = dot(vector, direction);
        }
    } else {
        square = vertex.curvature * vertex.curvature;
        linear = vertex.curvature;
        if is_unsigned {
            linear = abs(vertex.curvature);
            sign_of_linear = sign(vertex.curvature);
        }
    }

    let rigidity = value(term, 0u, element);
    let spontaneous = value(term, 1u, element);
    let density = square / area;
    let by_rigidity = real(0.5) * (density + spontaneous * (spontaneous * area - real(2.0) * linear));
    let by_spontaneous = rigidity * (spontaneous * area - linear);

    let by_area = real(0.5) * rigidity * (spontaneous * spontaneous - density / area);
    if voronoi {
        (*partials).voronoi_area += by_area;
    } else {
        (*partials).area += by_area;
    }
    let by_square = real(0.5) * rigidity / area;
    let by_linear = -rigidity * spontaneous;
    if is_vector {
        let partial = vector * (real(2.0) * by_square) + direction * by_linear;
        if umbrella {
            (*partials).umbrella += partial;
        } else {
            (*partials).cotangent += partial;
        }
        if !is_unsigned && by_linear != real(0.0) && length > real(0.0) {
            let across = vector - direction * linear;
            (*partials).normal_sum += across * (by_linear / length);
        }
    } else {
        (*partials).curvature += real(2.0) * vertex.curvature * by_square + sign_of_linear * by_linear;
    }
    return Contribution(
        rigidity * by_rigidity,
        vec4r(
            by_rigidity * is_scalar(term, 0u),
            by_spontaneous * is_scalar(term, 1u),
            real(0.0),
            real(0.0),
        ),
    );
}
