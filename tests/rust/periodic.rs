//! Surfaces in a periodic box: unfolded, wrapped at random, spanning it.

use crate::support::{
    Mesh, border_terms, equipped, open, random, spheroid, terms_in, terms_on, without,
};
use openmm_helfrich::error::Error;
use openmm_helfrich::evaluator::{BorderEvaluator, ReferenceEvaluator};
use openmm_helfrich::membrane::Membrane;
use openmm_helfrich::mesh::{Cell, Configuration, Topology, Unfolding};
use openmm_helfrich::moves::{FlipRules, FlipState, Round};
use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term, VertexNumbers};
use proptest::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// A triclinic box, and one that is none, nm; on a grid of dyadic fractions, as positions are here, so that wrapping is
/// exact.
const BOXES: [[[f64; 3]; 3]; 2] = [
    [[40.0, 0.0, 0.0], [11.25, 44.0, 0.0], [-14.5, 17.0, 48.0]],
    [[40.0, 0.0, 0.0], [0.0, 44.0, 0.0], [0.0, 0.0, 48.0]],
];

fn dyadic(x: f64) -> f64 {
    (x * 65536.0).round() / 65536.0
}

/// A grid of `n` × `m` quadrilaterals, halved into triangles, that spans two sides of a box and undulates; with holes, if
/// some particles are left out.
fn sheet(cell: &Cell, n: i64, m: i64, noise: &mut impl FnMut() -> f64) -> Mesh {
    let [a, b, c] = *cell.vectors();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let at = |i: i64, j: i64| m * i.rem_euclid(n) + j.rem_euclid(m);
    for i in 0..n {
        for j in 0..m {
            let (u, v) = (i as f64 / n as f64, j as f64 / m as f64);
            let height = 0.1 * (std::f64::consts::TAU * u).sin() + 0.02 * noise();
            let (u, v) = (u + 0.2 * noise() / n as f64, v + 0.2 * noise() / m as f64);
            positions.extend((a * u + b * v + c * height).iter().map(|x| dyadic(*x)));
            let (p, q, r, s) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    (positions, triangles)
}

/// A tube of `n` vertices around and `m` along the third side of a box.
fn tube(cell: &Cell, n: i64, m: i64, noise: &mut impl FnMut() -> f64) -> Mesh {
    let c = cell.vectors()[2];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let at = |i: i64, j: i64| m * i.rem_euclid(n) + j.rem_euclid(m);
    for i in 0..n {
        for j in 0..m {
            let angle = std::f64::consts::TAU * (i as f64 + 0.1 * noise()) / n as f64;
            let middle = c * ((j as f64 + 0.2 * noise()) / m as f64);
            let radius = 8.0 + 0.5 * noise();
            let point =
                [middle.x + radius * angle.cos(), middle.y + radius * angle.sin(), middle.z];
            positions.extend(point.map(dyadic));
            let (p, q, r, s) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    (positions, triangles)
}

/// A surface that goes on in three directions: that of cubes, `k`³ in a node and in each of three arms of a period.
fn labyrinth(cell: &Cell, k: i64, noise: &mut impl FnMut() -> f64) -> Mesh {
    let n = 2 * k;
    let inside = |cube: [i64; 3]| cube.iter().filter(|x| x.rem_euclid(n) >= k).count() <= 1;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut numbers = HashMap::new();
    let mut vertex = |corner: [i64; 3]| {
        let corner = corner.map(|x| x.rem_euclid(n));
        let next = numbers.len() as i64;
        *numbers.entry(corner).or_insert_with(|| {
            let [u, v, w] = corner.map(|x| (x as f64 + 0.15 * noise()) / n as f64);
            let [a, b, c] = cell.vectors();
            positions.extend((a * u + b * v + c * w).iter().map(|x| dyadic(*x)));
            next
        })
    };
    for index in 0..n * n * n {
        let cube = [index / (n * n), index / n % n, index % n];
        for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
            let mut beyond = cube;
            beyond[axis] += 2 * side - 1;
            if !inside(cube) || inside(beyond) {
                continue;
            }
            // Counter-clockwise seen from the high side of the axis, which is outside if the face is on that side.
            let mut turn = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(one, other)| {
                let mut corner = cube;
                corner[axis] += side;
                corner[(axis + 1) % 3] += one;
                corner[(axis + 2) % 3] += other;
                vertex(corner)
            });
            if side == 0 {
                turn.reverse();
            }
            let [p, q, r, s] = turn;
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    (positions, triangles)
}

/// Surfaces that span the box, one of them with holes.
fn spanning(cell: &Cell, seed: u64) -> Vec<Mesh> {
    let mut noise = random(seed);
    vec![
        sheet(cell, 6, 7, &mut noise),
        sheet(cell, 14, 15, &mut noise),
        tube(cell, 7, 9, &mut noise),
        labyrinth(cell, 3, &mut noise),
        without(sheet(cell, 9, 9, &mut noise), &[0, 13, 40, 41]),
    ]
}

/// Terms that make sense on them.
fn spanning_terms(mesh: &Mesh, cell: &Cell) -> Vec<Term<'static>> {
    [open(terms_in(mesh, Some(*cell), false)), border_terms()].concat()
}

/// Box vectors at random added to all positions.
fn wrapped(positions: &[f64], cell: &Cell, most: f64, seed: u64) -> Vec<f64> {
    let mut noise = random(seed);
    let mut moved = positions.to_vec();
    for position in moved.chunks_mut(3) {
        let shift = cell.shift([0; 3].map(|_: i32| (most * noise()) as i32));
        position.iter_mut().zip(&shift).for_each(|(x, shift)| *x += shift);
    }
    moved
}

/// Energies and forces of terms.
fn evaluated(
    membrane: &mut Membrane,
    terms: &[Term],
    positions: &[f64],
    cell: Option<&Cell>,
) -> (Vec<f64>, Vec<f64>) {
    let mut energies = vec![Contribution::default(); terms.len()];
    let mut forces = vec![0.0; positions.len()];
    membrane
        .evaluate(
            Request::new(terms, positions)
                .with_energies(&mut energies)
                .with_forces(&mut forces[..]),
            cell,
        )
        .unwrap();
    (energies.iter().map(|part| part.energy).collect(), forces)
}

fn membrane(mesh: &Mesh) -> Membrane {
    Membrane::new(&mesh.1, mesh.0.len() / 3).unwrap()
}

/// Energies and forces by the readable evaluator, of a mesh with the images that a membrane has found.
fn reference(
    membrane: &Membrane,
    terms: &[Term],
    positions: &[f64],
    cell: &Cell,
) -> (Vec<f64>, Vec<f64>) {
    let mut mesh = membrane.mesh().clone();
    let mut unfolding = Unfolding::default();
    let unfolded = unfolding.unfold(&mut mesh, positions, cell).unwrap().positions;
    let triangles: Vec<_> =
        (0..mesh.triangles().len()).map(|t| mesh.particles_of(t).map(i64::from)).collect();
    let terms = &equipped(&triangles, positions.len() / 3, terms);
    let mut evaluator = ReferenceEvaluator::new(Arc::new(Topology::of(&mesh)));
    evaluator.set_images(mesh.images(), cell);
    let mut energies = vec![Contribution::default(); terms.len()];
    let mut forces = vec![0.0; positions.len()];
    evaluator
        .evaluate(
            Request::new(terms, unfolded).with_energies(&mut energies).with_forces(&mut forces[..]),
        )
        .unwrap();
    let mut borders = BorderEvaluator::default();
    let found = borders.forward(&mesh, terms, unfolded, Some(cell)).unwrap();
    let request = Request::new(terms, unfolded).with_energies(&mut energies);
    borders.add(&mesh, Some(cell), found, request.with_forces(&mut forces[..]));
    (energies.iter().map(|part| part.energy).collect(), forces)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| x.abs().max(most))
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    let scale = largest(expected).max(1e-300);
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance * scale, "{what}: {found}, not {expected}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn wrapped_positions_have_the_same_bits(seed in 0..u64::MAX, most in 1.0..9.0f64) {
        for vectors in BOXES {
            let cell = Cell::new(vectors).unwrap();
            let mut closed = spheroid(5, 7, &mut random(seed));
            closed.0.iter_mut().for_each(|x| *x = dyadic(*x + 30.0));
            let closed_terms = terms_on(&closed, false);
            let cases = spanning(&cell, seed).into_iter().map(|mesh| {
                let terms = spanning_terms(&mesh, &cell);
                (mesh, terms)
            });
            for (mesh, terms) in cases.chain([(closed, closed_terms)]) {
                let expected = evaluated(&mut membrane(&mesh), &terms, &mesh.0, Some(&cell));
                let mut here = membrane(&mesh);
                for seed in [seed, !seed] {
                    let moved = wrapped(&mesh.0, &cell, most, seed);
                    prop_assert_eq!(&evaluated(&mut here, &terms, &moved, Some(&cell)), &expected);
                }
            }
        }
    }
}

#[test]
fn what_crosses_faces_is_as_without_a_box() {
    for vectors in BOXES {
        let cell = Cell::new(vectors).unwrap();
        let mesh = spheroid(6, 9, &mut random(5));
        let terms = terms_on(&mesh, false);
        let (energies, forces) = evaluated(&mut membrane(&mesh), &terms, &mesh.0, None);
        let moved: Vec<_> = wrapped(&mesh.0, &cell, 3.0, 8);
        let (found, pushes) = evaluated(&mut membrane(&mesh), &terms, &moved, Some(&cell));
        assert_close(&found, &energies, 1e-12, "energy");
        assert_close(&pushes, &forces, 1e-11, "force");
    }
}

#[test]
fn lanes_and_reference_agree_on_what_spans_the_box() {
    for vectors in BOXES {
        let cell = Cell::new(vectors).unwrap();
        for mesh in spanning(&cell, 11) {
            for term in spanning_terms(&mesh, &cell) {
                let mut membrane = membrane(&mesh);
                let moved = wrapped(&mesh.0, &cell, 2.0, 3);
                let (energies, forces) = evaluated(&mut membrane, &[term], &moved, Some(&cell));
                assert!(!membrane.mesh().images().is_empty());
                let (expected, pulls) = reference(&membrane, &[term], &moved, &cell);
                let what = term.potential.name();
                assert_close(&energies, &expected, 1e-11, what);
                assert_close(&forces, &pulls, 1e-9, what);
            }
        }
    }
}

#[test]
fn forces_are_gradients_and_sum_to_zero() {
    let cell = Cell::new(BOXES[0]).unwrap();
    for mesh in spanning(&cell, 23) {
        let mut membrane = membrane(&mesh);
        for term in spanning_terms(&mesh, &cell) {
            let terms = [term];
            let (_, forces) = evaluated(&mut membrane, &terms, &mesh.0, Some(&cell));
            let scale = largest(&forces);
            for axis in 0..3 {
                let sum: f64 = forces.iter().skip(axis).step_by(3).sum();
                assert!(sum.abs() <= 1e-11 * scale * forces.len() as f64, "{sum} of {scale}");
            }
            let mut noise = random(2);
            let direction: Vec<f64> = mesh.0.iter().map(|_| noise()).collect();
            let energy = |membrane: &mut Membrane, step: f64| {
                let moved: Vec<_> =
                    mesh.0.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
                evaluated(membrane, &terms, &moved, Some(&cell)).0[0]
            };
            let step = 2e-4;
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| energy(&mut membrane, k * step));
            let slope = (a - 8.0 * b + 8.0 * c - d) / (12.0 * step);
            let expected: f64 = -forces.iter().zip(&direction).map(|(f, d)| f * d).sum::<f64>();
            let most: f64 = forces.iter().zip(&direction).map(|(f, d)| (f * d).abs()).sum();
            assert!(
                (slope - expected).abs() <= 1e-6 * most + 1e-9,
                "{}: {slope}, not {expected}",
                term.potential.name()
            );
        }
    }
}

#[test]
fn a_flip_changes_the_energy_by_what_it_says() {
    for vectors in BOXES {
        let cell = Cell::new(vectors).unwrap();
        for mesh in spanning(&cell, 31) {
            for term in spanning_terms(&mesh, &cell) {
                let terms = [term];
                let mut membrane = membrane(&mesh);
                let positions = wrapped(&mesh.0, &cell, 2.0, 4);
                let before = evaluated(&mut membrane, &terms, &positions, Some(&cell)).0[0];
                let mut state =
                    FlipState { key: [7, 9], demon_energy: 1e5, ..FlipState::default() };
                let rules = FlipRules {
                    temperature: 1.0,
                    min_degree: 3,
                    max_degree: 12,
                    max_edge_length: 0.0,
                    demon: 1,
                };
                let made = membrane
                    .flip(
                        &terms,
                        Configuration::new(&positions, Some(&cell)),
                        Round { rules: &rules, attempts: 300, state: &mut state },
                        None,
                        &mut [],
                    )
                    .unwrap();
                assert!(made > 10, "{made}");
                let (after, forces) = evaluated(&mut membrane, &terms, &positions, Some(&cell));
                let change = 1e5 - state.demon_energy;
                let scale = before.abs().max(after[0].abs());
                assert!(
                    (after[0] - before - change).abs() < 1e-9 * (scale + 1.0),
                    "{}: {} − {before} is not {change}",
                    term.potential.name(),
                    after[0]
                );
                let (expected, pulls) = reference(&membrane, &terms, &positions, &cell);
                assert_close(&after, &expected, 1e-11, "energy");
                assert_close(&forces, &pulls, 1e-9, "forces");
                // Whoever begins here finds the same bits.
                let mut anew = self::membrane(&mesh);
                anew.restore(&membrane.connectivity()).unwrap();
                assert_eq!(evaluated(&mut anew, &terms, &positions, Some(&cell)), (after, forces));
            }
        }
    }
}

#[test]
fn the_way_to_some_positions_leaves_no_trace() {
    let cell = Cell::new(BOXES[0]).unwrap();
    let wide = Cell::new(BOXES[0].map(|row| row.map(|x| 1.25 * x))).unwrap();
    for mesh in spanning(&cell, 41) {
        let terms = spanning_terms(&mesh, &cell);
        let mut walker = membrane(&mesh);
        let mut noise = random(6);
        let mut positions = mesh.0.clone();
        for round in 0..40 {
            match round % 4 {
                // Small steps, a drift by more than a box (and none), a box of another size and back, and other images.
                0 => positions.iter_mut().for_each(|x| *x += dyadic(0.3 * noise())),
                1 => {
                    let mut energies = vec![Contribution::default(); terms.len()];
                    let request = Request::new(&terms, &positions).with_energies(&mut energies);
                    // Sides across the box may be too long for some terms; what matters is what comes after.
                    let _ = walker.evaluate(request, None);
                    positions.iter_mut().for_each(|x| *x += 13.25);
                }
                2 => {
                    let stretched: Vec<_> = positions.iter().map(|x| 1.25 * x).collect();
                    evaluated(&mut walker, &terms, &stretched, Some(&wide));
                }
                _ => positions = wrapped(&positions, &cell, 4.0, round),
            }
            if round % 4 == 0 {
                positions = mesh
                    .0
                    .iter()
                    .zip(&positions)
                    .map(|(a, b)| if round % 8 == 0 { *a } else { *b })
                    .collect();
            }
            let found = evaluated(&mut walker, &terms, &positions, Some(&cell));
            assert_eq!(found, evaluated(&mut membrane(&mesh), &terms, &positions, Some(&cell)));
        }
    }
}

#[test]
fn long_edges_and_lost_particles_are_named() {
    let cell = Cell::new(BOXES[1]).unwrap();
    let mut mesh = sheet(&cell, 6, 7, &mut random(3));
    let mut here = membrane(&mesh);
    let term = Term::new("SurfaceAreaForce", 0, &[1.0, 100.0]).unwrap();
    let fine = evaluated(&mut here, &[term], &mesh.0, Some(&cell));
    let kept = mesh.0.clone();
    mesh.0[3 * 10 + 2] += 21.0;
    let refused = here.evaluate(Request::new(&[term], &mesh.0), Some(&cell)).unwrap_err();
    let Error::LongEdge { edge, length, limit, .. } = &refused else { panic!("{refused}") };
    assert!(edge.contains(&10) && *limit == 20.0 && *length > 20.0, "{refused}");
    assert!(refused.to_string().contains("[40.0, 0.0, 0.0]"), "{refused}");
    mesh.0[3 * 10 + 2] = f64::NAN;
    let refused = here.evaluate(Request::new(&[term], &mesh.0), Some(&cell)).unwrap_err();
    assert!(matches!(refused, Error::NonFinitePosition { particle: 10, .. }), "{refused}");
    assert_eq!(evaluated(&mut here, &[term], &kept, Some(&cell)), fine);
    // Two vertices around the box: one edge goes either way.
    let narrow = sheet(&cell, 2, 7, &mut random(3));
    assert!(Membrane::new(&narrow.1, 14).is_err());
    // Three of them may be near enough.
    let narrow = sheet(&cell, 3, 7, &mut || 0.0);
    assert!(membrane(&narrow).evaluate(Request::new(&[term], &narrow.0), Some(&cell)).is_ok());
}

/// All triangles are stretched alike, whatever their images: only the box of the reference counts, and how it is wrapped
/// does not.
#[test]
fn a_reference_is_in_a_box_of_its_own() {
    let cell = Cell::new(BOXES[0]).unwrap();
    let wide = Cell::new(BOXES[0].map(|row| row.map(|x| 1.25 * x))).unwrap();
    for mesh in spanning(&cell, 61) {
        let stretched: Vec<_> = mesh.0.iter().map(|x| 1.25 * x).collect();
        let area = Term::new("SurfaceAreaForce", 0, &[2.0, 1.0]).unwrap();
        let at_rest = evaluated(&mut membrane(&mesh), &[area], &mesh.0, Some(&cell)).0[0];
        let at_rest = at_rest.sqrt() + 1.0;
        // I₁ = 2 (λ² − 1), I₂ = λ⁴ − 1.
        let (first, second) = (2.0 * (1.5625 - 1.0), 1.5625 * 1.5625 - 1.0);
        let density = 0.5 * (0.5 * first * first + first - second) + 0.375 * second * second;
        let used: Vec<_> =
            (0..mesh.0.len() as i64 / 3).filter(|v| mesh.1.as_flattened().contains(v)).collect();
        let rows = |positions: &[f64]| -> Vec<f64> {
            used.iter().flat_map(|v| positions[3 * *v as usize..][..3].to_vec()).collect()
        };
        let evaluate = |values: &[f64], vectors, positions: &[f64], cell| {
            let numbers = VertexNumbers::new(values.to_vec(), vectors, None);
            let term =
                Term { numbers: &numbers, ..Term::new("SkalakForce", 0, &[2.0, 3.0]).unwrap() };
            let mut energies = [Contribution::default()];
            membrane(&mesh)
                .evaluate(Request::new(&[term], positions).with_energies(&mut energies), cell)
                .map(|()| energies[0].energy)
        };
        for values in [rows(&mesh.0), rows(&wrapped(&mesh.0, &cell, 3.0, 5))] {
            let found = evaluate(&values, Some(BOXES[0]), &stretched, Some(&wide)).unwrap();
            assert!((found / (at_rest * density) - 1.0).abs() < 1e-11, "{found}");
            assert!(
                evaluate(&values, Some(BOXES[0]), &mesh.0, Some(&cell)).unwrap() < 1e-24 * found
            );
        }
        let values = rows(&mesh.0);
        let refused = evaluate(&values, None, &mesh.0, Some(&cell)).unwrap_err();
        assert!(matches!(refused, Error::NoReferenceBox { force: "SkalakForce", .. }));
        let narrow = BOXES[0].map(|row| row.map(|x| 0.125 * x));
        let refused = evaluate(&values, Some(narrow), &mesh.0, Some(&cell)).unwrap_err();
        assert!(matches!(refused, Error::LongReference { force: "SkalakForce", .. }));
    }
}

#[test]
fn what_spans_the_box_has_no_volume() {
    let cell = Cell::new(BOXES[0]).unwrap();
    let mesh = tube(&cell, 7, 9, &mut random(3));
    let term = Term::new("EnclosedVolumeForce", 0, &[1.0, 100.0]).unwrap();
    let refused =
        membrane(&mesh).evaluate(Request::new(&[term], &mesh.0), Some(&cell)).unwrap_err();
    assert!(matches!(refused, Error::Spanning { force: "EnclosedVolumeForce", .. }), "{refused}");
}

#[test]
fn a_triangle_without_area_across_a_face_is_named() {
    let cell = Cell::new(BOXES[1]).unwrap();
    let mut mesh = sheet(&cell, 6, 7, &mut random(3));
    // Between 35, in the last row, and 0, its neighbour across the face, for the corner that they share with 36.
    let [a, b] = [35, 0].map(|v: usize| [0, 1, 2].map(|k| mesh.0[3 * v + k]));
    let third = mesh.1.iter().find(|t| t.contains(&35) && t.contains(&0)).unwrap();
    let third = *third.iter().find(|v| **v != 35 && **v != 0).unwrap() as usize;
    for k in 0..3 {
        let shift = if k == 0 { 40.0 } else { 0.0 };
        mesh.0[3 * third + k] = 0.5 * (a[k] + b[k] + shift);
    }
    let term = Term::new("SurfaceAreaForce", 0, &[1.0, 100.0]).unwrap();
    let refused =
        membrane(&mesh).evaluate(Request::new(&[term], &mesh.0), Some(&cell)).unwrap_err();
    let Error::DegenerateTriangle { corners, .. } = &refused else { panic!("{refused}") };
    assert!([0, 35, third as u32].iter().all(|v| corners.contains(v)), "{refused}");
}

/// The virial against the energy's slope along strains of positions and box together.
fn check_virial(mesh: &Mesh, terms: &[Term], vectors: Option<[[f64; 3]; 3]>) {
    let cell = vectors.map(|vectors| Cell::new(vectors).unwrap());
    let mut here = membrane(mesh);
    for term in terms {
        let term = [*term];
        let found = here.virial(&term, Configuration::new(&mesh.0, cell.as_ref())).unwrap();
        let scale = found.abs().max();
        assert!((found - found.transpose()).abs().max() <= 1e-10 * scale, "{found}");
        for (row, column) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
            let energy = |here: &mut Membrane, strain: f64| {
                // Above the diagonal only, which keeps a box in OpenMM's form.
                let strained = |r: &[f64]| {
                    let mut r = [r[0], r[1], r[2]];
                    r[row] += strain * r[column];
                    r
                };
                let positions: Vec<_> = mesh.0.chunks(3).flat_map(strained).collect();
                let cell = vectors.map(|rows| Cell::new(rows.map(|row| strained(&row))).unwrap());
                evaluated(here, &term, &positions, cell.as_ref()).0[0]
            };
            let step = 2e-4;
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| energy(&mut here, k * step));
            let slope = (a - 8.0 * b + 8.0 * c - d) / (12.0 * step);
            let what = term[0].potential.name();
            let difference = (slope - found[(row, column)]).abs();
            assert!(difference <= 1e-7 * scale + 1e-9, "{what}: {slope}, not {found}");
        }
    }
}

#[test]
fn the_virial_is_the_slope_along_a_strain() {
    for vectors in BOXES {
        let cell = Cell::new(vectors).unwrap();
        for mesh in spanning(&cell, 53) {
            check_virial(&mesh, &spanning_terms(&mesh, &cell), Some(vectors));
        }
        let closed = spheroid(5, 7, &mut random(2));
        let crossing = (wrapped(&closed.0, &cell, 2.0, 7), closed.1.clone());
        check_virial(&crossing, &terms_on(&closed, false), Some(vectors));
        check_virial(&closed, &terms_on(&closed, false), None);
    }
}

#[test]
fn without_a_box_the_virial_is_that_of_the_forces() {
    let mesh = spheroid(5, 7, &mut random(2));
    let mut here = membrane(&mesh);
    for term in terms_on(&mesh, false) {
        let (_, forces) = evaluated(&mut here, &[term], &mesh.0, None);
        let virial = here.virial(&[term], Configuration::new(&mesh.0, None)).unwrap();
        let scale = virial.abs().max();
        for row in 0..3 {
            for column in 0..3 {
                let parts = forces.chunks(3).zip(mesh.0.chunks(3)).map(|(f, r)| f[row] * r[column]);
                let expected = -parts.sum::<f64>();
                let difference = (virial[(row, column)] - expected).abs();
                assert!(difference <= 1e-9 * scale, "{}: {virial}", term.potential.name());
            }
        }
    }
}

#[test]
fn threads_do_not_change_bits_of_what_spans_the_box() {
    let cell = Cell::new(BOXES[0]).unwrap();
    let mesh = sheet(&cell, 32, 32, &mut random(9));
    let terms = spanning_terms(&mesh, &cell);
    let results = [1, 2, 4].map(|threads| {
        let mut here = membrane(&mesh);
        here.set_threads(threads);
        // The choice between one thread and several tries both.
        (0..8).map(|_| evaluated(&mut here, &terms, &mesh.0, Some(&cell))).collect::<Vec<_>>()
    });
    let expected = &results[0][0];
    assert!(results.iter().flatten().all(|found| found == expected));
}
