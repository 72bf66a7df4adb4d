//! Backward formulas beside differences of forward ones.

use super::*;
use crate::test_meshes::noise;

#[test]
fn arctangent_polynomial_is_exact_to_rounding() {
    for k in 1..=1000 {
        let z = POLYNOMIAL_RANGE * f64::from(k) / 1000.0;
        let t = z.sqrt();
        let error = (arctan_over_argument(z) / (t.atan() / t) - 1.0).abs();
        assert!(error < 5e-16, "{z}: {error}");
    }
}

#[test]
fn angles_are_exact_to_rounding() {
    for k in 1..=1000 {
        let expected = std::f64::consts::PI * f64::from(k) / 1000.5;
        for scale in [1e-3, 1.0, 1e5] {
            let found = corner_angle(scale * expected.sin(), scale * expected.cos());
            // The sine near π itself has lost digits.
            let tolerance = 1e-15 * (1.0 + 1.0 / (std::f64::consts::PI - expected));
            assert!((found - expected).abs() < tolerance, "{expected}: {found}");
        }
    }
}

fn hinge(angle: f64) -> (EdgeGeometry, f64) {
    // Triangles on either side of an edge along y; for a convex edge the right tip lies low.
    let (start, end) = (Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.1, 2.0, 0.0));
    let left_tip = Vec3::new(-1.5, 0.3, 0.0);
    let along = (end - start).normalize();
    let out = along.cross(&Vec3::z());
    let right_tip = start + 0.4 * along + 1.1 * (angle.cos() * out - angle.sin() * Vec3::z());
    let left = TriangleGeometry::new(&start, &end, &left_tip);
    let right = TriangleGeometry::new(&end, &start, &right_tip);
    assert!(left.normal.z > 0.0);
    (EdgeGeometry::new(&start, &end, &right_tip, &left, &right), (end - start).norm())
}

#[test]
fn dihedral_angles_have_the_right_sign_and_size() {
    for angle in [1e-9, 1e-4, 0.3, 0.78, 0.79, 1.5, 2.5, 3.1] {
        for angle in [angle, -angle] {
            let (edge, length) = hinge(angle);
            let error = (edge.bend * length / angle - 1.0).abs();
            assert!(error < 1e-12 + 1e-16 / angle.abs(), "{angle}: {error}");
            let (sine, cosine) = angle.sin_cos();
            let quick = bend(length * length, 0.7 * sine / length, 0.7 * cosine, 0.7);
            assert!((quick * length / angle - 1.0).abs() < 1e-14, "{angle}");
        }
    }
    assert_eq!(hinge(0.0).0.bend, 0.0);
}

/// A lone hinge has M = ½ l φ; its other four sides have no angle.
#[test]
fn forces_of_mean_curvature_are_minus_the_gradient() {
    let mut random = noise(5);
    let points: [Vec3; 4] = [[0.0, 0.0], [1.0, 0.2], [0.3, 1.1], [0.5, -0.9]]
        .map(|[x, y]| Vec3::new(x, y, 0.4 * random()));
    let (partial, step) = (1.7, 1e-5);
    let hinge = |p: &[Vec3; 4]| {
        let left = TriangleGeometry::new(&p[0], &p[1], &p[2]);
        let right = TriangleGeometry::new(&p[1], &p[0], &p[3]);
        (EdgeGeometry::new(&p[0], &p[1], &p[3], &left, &right), left, right)
    };
    let (edge, left, right) = hinge(&points);
    let mut sides = [EdgeTension::default(); 3];
    sides[0].add_mean_curvature(&edge, partial);
    let [a, b, c, d] = points.each_ref();
    let on_left = corner_forces([a, b, c], &left, 0.0, &[0.0; 3], sides, 0.0);
    let on_right = corner_forces([b, a, d], &right, 0.0, &[0.0; 3], sides, 0.0);
    let forces = [on_left[0] + on_right[1], on_left[1] + on_right[0], on_left[2], on_right[2]];
    for vertex in 0..4 {
        for axis in 0..3 {
            let energy = |shift: f64| {
                let mut moved = points;
                moved[vertex][axis] += shift;
                let edge = hinge(&moved).0;
                partial * 0.5 * edge.length_squared * edge.bend
            };
            let expected = -(energy(step) - energy(-step)) / (2.0 * step);
            assert!((forces[vertex][axis] - expected).abs() < 1e-8, "{vertex} {axis}");
        }
    }
}

/// The corner forces of a lone hinge against finite differences of E = c φ + k a + Σ s l².
#[test]
fn corner_forces_are_minus_the_gradient() {
    let mut random = noise(3);
    let points: [Vec3; 4] = std::array::from_fn(|k| {
        let base = [[0.0, 0.0], [1.0, 0.2], [0.3, 1.1], [0.5, -0.9]][k];
        Vec3::new(base[0], base[1], 0.3 * random())
    });
    let (moment_arm, stress, springs) = (0.7, 1.3, [0.4, -0.2, 0.9]);
    let triangles = |p: &[Vec3; 4]| {
        (TriangleGeometry::new(&p[0], &p[1], &p[2]), TriangleGeometry::new(&p[1], &p[0], &p[3]))
    };
    let edge = |p: &[Vec3; 4]| {
        let (left, right) = triangles(p);
        EdgeGeometry::new(&p[0], &p[1], &p[3], &left, &right)
    };
    let energy = |p: &[Vec3; 4]| {
        let (left, _) = triangles(p);
        let edge = edge(p);
        moment_arm * edge.bend * edge.length_squared.sqrt()
            + stress * left.area()
            + (0..3).map(|k| springs[k] * left.length_squared(k)).sum::<f64>()
    };
    let (left, right) = triangles(&points);
    let tension =
        EdgeTension { half_tension: 0.0, moment: moment_arm / edge(&points).length_squared.sqrt() };
    let sides = [tension, EdgeTension::default(), EdgeTension::default()];
    let p = &points;
    let on_left = corner_forces([&p[0], &p[1], &p[2]], &left, stress, &springs, sides, 0.0);
    let on_right = corner_forces([&p[1], &p[0], &p[3]], &right, 0.0, &[0.0; 3], sides, 0.0);
    let forces = [on_left[0] + on_right[1], on_left[1] + on_right[0], on_left[2], on_right[2]];
    for vertex in 0..4 {
        for axis in 0..3 {
            let step = 1e-5;
            let at = |shift: f64| {
                let mut moved = points;
                moved[vertex][axis] += shift;
                energy(&moved)
            };
            let expected = -(at(step) - at(-step)) / (2.0 * step);
            assert!((forces[vertex][axis] - expected).abs() < 1e-8, "{vertex} {axis}");
        }
    }
}
