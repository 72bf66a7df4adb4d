//! The evaluator on whole meshes: gradients, symmetries, threads and bad input, for every potential.

use crate::support::{
    Mesh, beside, border_terms, open_meshes, open_terms, random, spheroid, terms_on,
};
use openmm_helfrich::error::Error;
use openmm_helfrich::evaluator::{CpuEvaluator, InstructionSet, ReferenceEvaluator};
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::potentials::{Contribution, Evaluator, REGISTRY, Request, Term};
use proptest::prelude::*;
use std::sync::Arc;

fn evaluator(mesh: &Mesh) -> CpuEvaluator {
    CpuEvaluator::new(Arc::new(Topology::new(&mesh.1, mesh.0.len() / 3).unwrap()))
}

fn evaluate(
    evaluator: &mut CpuEvaluator,
    terms: &[Term],
    positions: &[f64],
) -> (Vec<Contribution>, Vec<f64>) {
    let mut contributions = vec![Contribution::default(); terms.len()];
    let mut forces = vec![0.0; positions.len()];
    evaluator
        .evaluate(
            Request::new(terms, positions)
                .with_energies(&mut contributions)
                .with_forces(&mut forces[..]),
        )
        .unwrap();
    (contributions, forces)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[test]
fn every_potential_of_the_registry_is_tested_here() {
    let terms = [terms_on(&spheroid(6, 9, &mut random(1)), true), border_terms()].concat();
    // No evaluator sees those of pairs, which `src/contact/` looks after.
    let pairs = ["SurfaceRepulsionForce", "ParticleSurfaceForce"];
    for potential in REGISTRY.into_iter().filter(|one| !pairs.contains(&one.name())) {
        assert!(terms.iter().any(|term| term.potential.name() == potential.name()));
    }
}

#[test]
fn forces_are_minus_the_gradient() {
    let mesh = spheroid(6, 9, &mut random(1));
    check_gradients(&mesh, &terms_on(&mesh, true));
    for mesh in &open_meshes(2)[..7] {
        check_gradients(mesh, &open_terms(mesh, true));
    }
}

fn check_gradients(mesh: &Mesh, terms: &[Term]) {
    let mut noise = random(1);
    let mut evaluator = evaluator(mesh);
    let direction: Vec<f64> = mesh.0.iter().map(|_| noise()).collect();
    for &term in terms {
        let forces = evaluate(&mut evaluator, &[term], &mesh.0).1;
        let mut energy = |step: f64| {
            let moved: Vec<f64> =
                mesh.0.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
            evaluate(&mut evaluator, &[term], &moved).0[0].energy
        };
        // Richardson's combination is of fourth order.
        let h = 2e-4;
        let slope =
            (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
        let scale = dot(&forces, &forces).sqrt();
        let error = (slope + dot(&forces, &direction)).abs() / scale;
        let name = term.potential.name();
        if scale == 0.0 {
            // A strip without an inner vertex has no bending energy, and wide triangles do not repel.
            assert_eq!(energy(0.0), 0.0, "{name}");
            continue;
        }
        assert!(error < 1e-8, "{name} {} {:?}: {error}", term.form, term.values);
    }
}

#[test]
fn parameter_derivatives_match_finite_differences() {
    let mesh = spheroid(6, 9, &mut random(2));
    let mut evaluator = evaluator(&mesh);
    for term in terms_on(&mesh, true) {
        let found = evaluate(&mut evaluator, &[term], &mesh.0).0[0].by_parameter;
        for index in 0..term.potential.parameters().len() {
            let step = 1e-4 * term.values[index].abs().max(0.1);
            let mut energy = |shift: f64| {
                let mut changed = term;
                changed.values[index] += shift;
                evaluate(&mut evaluator, &[changed], &mesh.0).0[0].energy
            };
            let h = step;
            let slope = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h)))
                / (12.0 * h);
            let error = (slope - found[index]).abs() / slope.abs().max(1.0);
            assert!(error < 1e-7, "{} {} {index}: {error}", term.potential.name(), term.form);
        }
    }
}

#[test]
fn terms_add_up_however_they_are_grouped() {
    let mesh = spheroid(7, 8, &mut random(3));
    let mut evaluator = evaluator(&mesh);
    let terms = terms_on(&mesh, true);
    let (together, forces) = evaluate(&mut evaluator, &terms, &mesh.0);
    let mut sum = vec![0.0; forces.len()];
    for (term, contribution) in terms.iter().zip(&together) {
        let (alone, part) = evaluate(&mut evaluator, &[*term], &mesh.0);
        assert_eq!(alone[0], *contribution, "{}", term.potential.name());
        sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
    }
    let largest = forces.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    for (a, b) in forces.iter().zip(&sum) {
        assert!((a - b).abs() < 1e-12 * largest);
    }
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    // Many tiles of every array, so that no number of threads divides them evenly.
    let mesh = spheroid(70, 90, &mut random(4));
    assert!(mesh.1.len() > 12_000);
    let terms = terms_on(&mesh, true);
    let topology = Arc::new(Topology::new(&mesh.1, mesh.0.len() / 3).unwrap());
    for set in [InstructionSet::Best, InstructionSet::Avx2, InstructionSet::Scalar] {
        let mut alone = CpuEvaluator::with(topology.clone(), set, 1);
        let expected = evaluate(&mut alone, &terms, &mesh.0);
        for threads in [2, 3, 8] {
            let mut evaluator = CpuEvaluator::with(topology.clone(), set, threads);
            // The first evaluations are done by one thread and by all in turns.
            for _ in 0..4 {
                assert!(evaluate(&mut evaluator, &terms, &mesh.0) == expected);
            }
        }
    }
}

/// Small meshes share the memory of their thread. Each evaluation must have the bits of one on a thread where nothing
/// has been before, whoever came before it, on whichever thread.
#[test]
fn meshes_that_share_memory_do_not_disturb_each_other() {
    let mut noise = random(11);
    let mut meshes = vec![
        spheroid(6, 9, &mut noise),
        spheroid(20, 31, &mut noise),
        spheroid(6, 9, &mut noise),
        spheroid(9, 6, &mut noise),
    ];
    meshes.extend(open_meshes(3).into_iter().take(3));
    let terms: Vec<_> = meshes
        .iter()
        .enumerate()
        .map(|(k, mesh)| if k < 4 { terms_on(mesh, true) } else { open_terms(mesh, true) })
        .map(|mut terms| {
            // Heights so small that no triangle is pushed: zeros that follow zeros are not written.
            terms.push(Term::new("TriangleHeightForce", 0, &[20.0, 1e-6]).unwrap());
            terms
        })
        .collect();
    let mut evaluators: Vec<_> = meshes.iter().map(evaluator).collect();
    let mut k = 0;
    for turn in 0..600 {
        let mut draw = |below: usize| ((0.5 + 0.4999 * noise()) * below as f64) as usize;
        // Some stay for several evaluations.
        if draw(3) == 0 {
            k = draw(meshes.len());
        }
        let (mesh, known) = (&meshes[k], &mut evaluators[k]);
        let chosen: Vec<_> = match draw(3) {
            0 => vec![*terms[k].last().unwrap()],
            _ => terms[k].iter().filter(|_| draw(8) == 0).copied().collect(),
        };
        let elsewhere = draw(3) == 0;
        let fresh = || evaluate(&mut evaluator(mesh), &chosen, &mesh.0);
        let expected = std::thread::scope(|scope| scope.spawn(fresh).join()).unwrap();
        let found = if elsewhere {
            std::thread::scope(|scope| scope.spawn(|| evaluate(known, &chosen, &mesh.0)).join())
                .unwrap()
        } else {
            evaluate(known, &chosen, &mesh.0)
        };
        let names: Vec<_> = chosen.iter().map(|term| term.potential.name()).collect();
        assert!(found == expected, "{turn}: mesh {k}, {names:?}");
    }
}

#[test]
fn every_instruction_set_agrees_with_the_reference() {
    let two = beside(spheroid(5, 7, &mut random(8)), spheroid(9, 11, &mut random(9)));
    for (mesh, pairs) in [(spheroid(6, 9, &mut random(10)), true), (two, true)] {
        instruction_sets_agree(&mesh, &terms_on(&mesh, true), &terms_on(&mesh, false), pairs);
    }
    for (n, mesh) in open_meshes(11).iter().enumerate() {
        instruction_sets_agree(mesh, &open_terms(mesh, true), &open_terms(mesh, false), n == 2);
    }
}

#[test]
fn values_of_edges_find_their_edges() {
    let meshes = open_meshes(13).into_iter().chain([spheroid(9, 11, &mut random(14))]);
    for mesh in meshes {
        let edges = Topology::new(&mesh.1, mesh.0.len() / 3).unwrap().edges.len();
        let mut noise = random(15);
        let stiffness: Vec<f64> = (0..edges).map(|_| 2.0 + noise()).collect();
        let rest: Vec<f64> = (0..edges).map(|_| 0.8 * noise()).collect();
        let term = |own_stiffness: bool, own_rest: bool| {
            let mut term = Term::new("DihedralForce", 2, &[1.3, 0.2]).unwrap();
            term.wants_derivatives = true;
            term.fields[0] = if own_stiffness { &stiffness } else { &[] };
            term.fields[1] = if own_rest { &rest } else { &[] };
            term
        };
        let terms = [term(true, true), term(false, true), term(true, false)];
        instruction_sets_agree(&mesh, &terms, &terms, false);
    }
}

/// With the reference, for each term, all together, and all pairs.
fn instruction_sets_agree(mesh: &Mesh, with: &[Term], without: &[Term], pairs: bool) {
    let topology = Arc::new(Topology::new(&mesh.1, mesh.0.len() / 3).unwrap());
    let mut reference = ReferenceEvaluator::new(topology.clone());
    let sets = [InstructionSet::Best, InstructionSet::Avx2, InstructionSet::Scalar];
    let mut evaluators = sets.map(|set| CpuEvaluator::with(topology.clone(), set, 1));
    let mut check = |terms: &[Term]| {
        let mut expected = vec![Contribution::default(); terms.len()];
        let mut expected_forces = vec![0.0; mesh.0.len()];
        reference
            .evaluate(
                Request::new(terms, &mesh.0)
                    .with_energies(&mut expected)
                    .with_forces(&mut expected_forces[..]),
            )
            .unwrap();
        let largest = expected_forces.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        let near = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-12 * scale;
        for (set, evaluator) in sets.iter().zip(&mut evaluators) {
            let mut found = vec![Contribution::default(); terms.len()];
            let mut forces = vec![0.0; mesh.0.len()];
            evaluator
                .evaluate(
                    Request::new(terms, &mesh.0)
                        .with_energies(&mut found)
                        .with_forces(&mut forces[..]),
                )
                .unwrap();
            for ((term, a), b) in terms.iter().zip(&expected).zip(&found) {
                let what = format!("{} {} {set:?}", term.potential.name(), term.form);
                assert!(near(a.energy, b.energy, a.energy.abs()), "{what}: {a:?} {b:?}");
                for (x, y) in a.by_parameter.iter().zip(b.by_parameter) {
                    // Derivatives that nobody wants may be anything.
                    let same = !term.wants_derivatives || near(*x, y, x.abs());
                    assert!(same, "{what}: {a:?} {b:?}");
                }
            }
            for (index, (a, b)) in expected_forces.iter().zip(&forces).enumerate() {
                let term = terms[0];
                let what = format!("{} {}", term.potential.name(), term.form);
                assert!(near(*a, *b, largest), "{what} {set:?} {index}: {a} {b} {largest}");
            }
            // Without energies the forces are the same.
            let mut again = vec![0.0; mesh.0.len()];
            evaluator.evaluate(Request::new(terms, &mesh.0).with_forces(&mut again[..])).unwrap();
            assert_eq!(forces, again);
        }
    };
    for terms in [with, without] {
        terms.iter().for_each(|term| check(&[*term]));
        check(terms);
    }
    if !pairs {
        return;
    }
    // All pairs in both orders, since what a term does not need must not reach it from another one; the sign of
    // a curvature asks for nothing else.
    let each = || with.iter().chain(without).filter(|term| term.values[1] >= 0.0);
    for one in each() {
        each().for_each(|other| check(&[*one, *other]));
    }
}

#[test]
fn particles_outside_the_mesh_feel_nothing() {
    let (positions, triangles) = spheroid(5, 7, &mut random(5));
    let count = positions.len() / 3;
    // Every other particle is foreign, and the mesh's own are numbered backwards.
    let place = |v: i64| 2 * (count as i64 - 1 - v);
    let moved: Vec<_> = triangles.iter().map(|t| t.map(place)).collect();
    let mut all = vec![f64::NAN; 6 * count];
    for v in 0..count {
        all[3 * place(v as i64) as usize..][..3].copy_from_slice(&positions[3 * v..][..3]);
    }
    let term = Term::new("BendingForce", 2, &[1.0, 0.1]).unwrap();
    let mesh = (positions, triangles);
    let (direct, expected) = evaluate(&mut evaluator(&mesh), &[term], &mesh.0);
    let (found, forces) = evaluate(&mut evaluator(&(all.clone(), moved)), &[term], &all);
    assert!((direct[0].energy / found[0].energy - 1.0).abs() < 1e-13);
    for particle in 0..2 * count {
        let force = &forces[3 * particle..][..3];
        if particle % 2 == 1 {
            assert_eq!(force, [0.0; 3]);
        } else {
            let v = count - 1 - particle / 2;
            for (a, b) in force.iter().zip(&expected[3 * v..][..3]) {
                assert!((a - b).abs() < 1e-11);
            }
        }
    }
}

#[test]
fn a_mesh_far_from_the_origin_loses_few_digits() {
    let mesh = spheroid(6, 9, &mut random(6));
    let mut evaluator = evaluator(&mesh);
    let far: Vec<f64> = mesh.0.iter().map(|x| x + 1e6).collect();
    // What the doubles at the far place say, brought back without rounding.
    let back: Vec<f64> = far.iter().map(|x| x - 1e6).collect();
    let terms = terms_on(&mesh, true);
    let (near, near_forces) = evaluate(&mut evaluator, &terms, &back);
    let (away, away_forces) = evaluate(&mut evaluator, &terms, &far);
    for (a, b) in near.iter().zip(&away) {
        assert!((a.energy / b.energy - 1.0).abs() < 1e-13);
    }
    let largest = near_forces.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    for (a, b) in near_forces.iter().zip(&away_forces) {
        assert!((a - b).abs() < 1e-12 * largest);
    }
}

#[test]
fn a_refused_evaluation_leaves_no_repulsions_behind() {
    // Heights that act in one part of the mesh only, then nowhere because a position is lost, then there again.
    let mesh = spheroid(20, 24, &mut random(12));
    let term = Term::new("TriangleHeightForce", 0, &[0.6, 2.0]).unwrap();
    let mut evaluator = evaluator(&mesh);
    let expected = evaluate(&mut evaluator, &[term], &mesh.0);
    for vertex in 0..mesh.0.len() / 3 {
        let mut lost = mesh.0.clone();
        lost[3 * vertex] = f64::NAN;
        let mut forces = vec![0.0; lost.len()];
        assert!(
            evaluator.evaluate(Request::new(&[term], &lost).with_forces(&mut forces[..])).is_err()
        );
        assert!(evaluate(&mut evaluator, &[term], &mesh.0) == expected);
    }
    assert!(expected.1.iter().any(|force| *force != 0.0));
    assert!(expected.1.contains(&0.0));
}

#[test]
fn degenerate_and_lost_meshes_are_named_and_change_nothing() {
    let mesh = spheroid(5, 7, &mut random(7));
    let mut evaluator = evaluator(&mesh);
    let terms = terms_on(&mesh, true);
    let mut contributions = vec![Contribution::default(); terms.len()];
    let mut forces = vec![1.0; mesh.0.len()];

    let mut lost = mesh.0.clone();
    lost[3 * 11 + 1] = f64::INFINITY;
    let result = evaluator.evaluate(
        Request::new(&terms, &lost).with_energies(&mut contributions).with_forces(&mut forces[..]),
    );
    assert!(matches!(result, Err(Error::NonFinitePosition { particle: 11, .. })), "{result:?}");

    let huge: Vec<f64> = mesh.0.iter().map(|x| x * 1e200).collect();
    let result = evaluator.evaluate(
        Request::new(&terms, &huge).with_energies(&mut contributions).with_forces(&mut forces[..]),
    );
    assert!(matches!(result, Err(Error::OverflownTriangle { .. })), "{result:?}");

    let mut flat = mesh.0.clone();
    let [a, b, c] = mesh.1[4].map(|v| v as usize);
    for axis in 0..3 {
        // Small integers, so that the corners lie on one line exactly.
        flat[3 * a + axis] = 1.0;
        flat[3 * b + axis] = 2.0;
        flat[3 * c + axis] = 4.0;
    }
    let result = evaluator.evaluate(
        Request::new(&terms, &flat).with_energies(&mut contributions).with_forces(&mut forces[..]),
    );
    assert!(matches!(result, Err(Error::DegenerateTriangle { triangle: 4, .. })), "{result:?}");
    assert!(forces.iter().all(|force| *force == 1.0));

    // Nothing of what was refused is left in later evaluations.
    forces.fill(0.0);
    let fine = evaluator.evaluate(
        Request::new(&terms, &mesh.0)
            .with_energies(&mut contributions)
            .with_forces(&mut forces[..]),
    );
    assert_eq!(fine, Ok(()));
    let expected = evaluate(&mut self::evaluator(&mesh), &terms_on(&mesh, true), &mesh.0);
    assert!(expected == (contributions.clone(), forces.clone()));

    let few = &mut forces[..3];
    let result = evaluator
        .evaluate(Request::new(&terms, &mesh.0).with_energies(&mut contributions).with_forces(few));
    assert!(matches!(result, Err(Error::Contract(_))), "{result:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..Default::default() })]

    /// No net force, no net torque; energy and forces turn and move with the mesh.
    #[test]
    fn rigid_motions(seed in 1u64..1000, rings in 3i64..8, sectors in 4i64..12, angle in 0.1f64..3.0) {
        let mesh = spheroid(rings, sectors, &mut random(seed));
        let mut evaluator = evaluator(&mesh);
        let rotation = nalgebra::Rotation3::from_euler_angles(angle, 2.0 * angle, -angle);
        let turn = |x: &[f64], shift: f64| -> Vec<f64> {
            x.chunks(3).flat_map(|p| {
                let p = rotation * nalgebra::Vector3::new(p[0], p[1], p[2]);
                [p.x + shift, p.y - 2.0 * shift, p.z + shift]
            }).collect()
        };
        for term in terms_on(&mesh, true) {
            let (energy, forces) = evaluate(&mut evaluator, &[term], &mesh.0);
            let scale: f64 = forces.iter().map(|f| f.abs()).sum();
            let mut net = nalgebra::Vector3::zeros();
            let mut torque = nalgebra::Vector3::zeros();
            for (x, f) in mesh.0.chunks(3).zip(forces.chunks(3)) {
                let (x, f) = (nalgebra::Vector3::from_column_slice(x), nalgebra::Vector3::from_column_slice(f));
                net += f;
                torque += x.cross(&f);
            }
            // A repulsion that no triangle of a coarse mesh feels has no forces at all.
            prop_assert!(net.norm() <= 1e-12 * scale && torque.norm() <= 1e-11 * scale);
            let (turned, turned_forces) = evaluate(&mut evaluator, &[term], &turn(&mesh.0, 30.0));
            let (one, two) = (energy[0].energy, turned[0].energy);
            prop_assert!((one - two).abs() <= 1e-10 * one.abs());
            for (a, b) in turned_forces.iter().zip(turn(&forces, 0.0)) {
                prop_assert!((a - b).abs() <= 1e-9 * scale);
            }
        }
    }
}
