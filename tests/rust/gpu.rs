//! The evaluator on the GPU against that on the processor, on every adapter that there is.
//!
//! Without an adapter these tests say so and pass, unless HELFRICH_REQUIRE_GPU=1 demands one. Debian's
//! mesa-vulkan-drivers have one that computes on the processor.

use crate::support::{Mesh, open_meshes, open_terms, random, spheroid, terms_on};
use openmm_helfrich::evaluator::CpuEvaluator;
use openmm_helfrich::evaluator::gpu::{GpuEvaluator, Precision, adapters};
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term};
use std::sync::Arc;

/// The adapters and the precisions that each of them has.
fn targets() -> Vec<(usize, Precision)> {
    let adapters = adapters::all();
    if adapters.is_empty() {
        let wanted = std::env::var("HELFRICH_REQUIRE_GPU").is_ok_and(|value| value == "1");
        assert!(!wanted, "HELFRICH_REQUIRE_GPU=1, but there is no adapter");
        eprintln!("skipped: there is no adapter");
    }
    let mut targets = Vec::new();
    for (index, adapter) in adapters.iter().enumerate() {
        targets.push((index, Precision::Single));
        if adapter.has_double {
            targets.push((index, Precision::Double));
        }
    }
    targets
}

fn topology(mesh: &Mesh) -> Arc<Topology> {
    Arc::new(Topology::new(&mesh.1, mesh.0.len() / 3).unwrap())
}

type Found = (Vec<Contribution>, Vec<f64>);

fn on_processor(mesh: &Mesh, terms: &[Term]) -> Found {
    let mut evaluator = CpuEvaluator::new(topology(mesh));
    let mut contributions = vec![Contribution::default(); terms.len()];
    let mut forces = vec![0.0; mesh.0.len()];
    evaluator
        .evaluate(
            Request::new(terms, &mesh.0)
                .with_energies(&mut contributions)
                .with_forces(&mut forces[..]),
        )
        .unwrap();
    (contributions, forces)
}

fn on_device(evaluator: &mut GpuEvaluator, mesh: &Mesh, terms: &[Term]) -> Found {
    let mut contributions = vec![Contribution::default(); terms.len()];
    let mut forces = vec![0.0; mesh.0.len()];
    let done = evaluator
        .evaluate(
            Request::new(terms, &mesh.0)
                .with_energies(&mut contributions)
                .with_forces(&mut forces[..]),
        )
        .unwrap();
    assert!(done, "the device gave up");
    (contributions, forces)
}

fn tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::Single => 1e-4,
        Precision::Double => 1e-10,
    }
}

/// The largest errors of energies, forces and derivatives, each relative to the largest of its kind.
fn errors(found: &Found, expected: &Found) -> [f64; 3] {
    let largest = expected.1.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    let mut errors = [0.0; 3];
    for (a, b) in found.0.iter().zip(&expected.0) {
        errors[0] = f64::max(errors[0], (a.energy / b.energy - 1.0).abs());
        for (a, b) in a.by_parameter.iter().zip(&b.by_parameter) {
            // A derivative that is zero by definition, or that nobody wants.
            if *b != 0.0 {
                errors[2] = f64::max(errors[2], (a / b - 1.0).abs());
            } else {
                assert_eq!(*a, 0.0);
            }
        }
    }
    for (a, b) in found.1.iter().zip(&expected.1) {
        errors[1] = f64::max(errors[1], (a - b).abs() / largest);
    }
    errors
}

#[test]
fn every_potential_is_that_of_the_processor() {
    for (adapter, precision) in targets() {
        let mesh = spheroid(6, 9, &mut random(1));
        check_each(adapter, precision, &mesh, &terms_on(&mesh, true));
        for mesh in open_meshes(1) {
            check_each(adapter, precision, &mesh, &open_terms(&mesh, true));
        }
    }
}

fn check_each(adapter: usize, precision: Precision, mesh: &Mesh, terms: &[Term]) {
    let mut evaluator = GpuEvaluator::new(topology(mesh), Some(adapter), precision).unwrap();
    for &term in terms {
        let found = on_device(&mut evaluator, mesh, &[term]);
        let expected = on_processor(mesh, &[term]);
        let errors = errors(&found, &expected);
        let name = term.potential.name();
        println!(
            "{precision:?} {name} {} {}: {:.1e} {:.1e} {:.1e}",
            term.form, term.switches, errors[0], errors[1], errors[2]
        );
        let worst = errors.into_iter().fold(0.0, f64::max);
        assert!(worst < tolerance(precision), "{name} {} {:?}", term.form, term.values);
    }
}

#[test]
fn terms_together_are_those_alone() {
    for (adapter, precision) in targets() {
        let mesh = spheroid(7, 8, &mut random(2));
        let mut evaluator = GpuEvaluator::new(topology(&mesh), Some(adapter), precision).unwrap();
        let terms = terms_on(&mesh, true);
        let found = on_device(&mut evaluator, &mesh, &terms);
        let errors = errors(&found, &on_processor(&mesh, &terms));
        assert!(errors.into_iter().all(|error| error < tolerance(precision)), "{errors:?}");
        // The same bits again, after something else, and of the energies without the forces.
        on_device(&mut evaluator, &mesh, &terms[..1]);
        assert_eq!(on_device(&mut evaluator, &mesh, &terms), found);
        let mut energies = vec![Contribution::default(); terms.len()];
        assert_eq!(
            evaluator.evaluate(Request::new(&terms, &mesh.0).with_energies(&mut energies)),
            Ok(true)
        );
        assert_eq!(energies, found.0);
    }
}

/// A term with what the processor finds for it alone; derivatives only if they are wanted.
struct Alone {
    term: Term<'static>,
    found: Found,
}

fn alone(mesh: &Mesh, term: Term<'static>) -> Alone {
    let mut found = on_processor(mesh, &[term]);
    if !term.wants_derivatives {
        found.0[0].by_parameter = Default::default();
    }
    Alone { term, found }
}

/// Evaluate some terms on the device, pairs without forces, too, and compare with what the processor finds for each of
/// them alone: terms add up, whatever their order.
fn check_together(evaluator: &mut GpuEvaluator, mesh: &Mesh, some: &[&Alone], tolerance: f64) {
    let terms: Vec<_> = some.iter().map(|alone| alone.term).collect();
    let contributions: Vec<_> = some.iter().map(|alone| alone.found.0[0]).collect();
    let mut forces = vec![0.0; mesh.0.len()];
    for alone in some {
        forces.iter_mut().zip(&alone.found.1).for_each(|(sum, force)| *sum += force);
    }
    let found = on_device(evaluator, mesh, &terms);
    let worst = errors(&found, &(contributions, forces));
    let names = || {
        let name = |term: &Term| {
            let (name, derivatives) = (term.potential.name(), term.wants_derivatives);
            format!("{name} {} {:?} {derivatives}", term.form, term.values)
        };
        terms.iter().map(name).collect::<Vec<_>>().join(", ")
    };
    assert!(worst.into_iter().all(|error| error < tolerance), "{}: {worst:?}", names());
    if some.len() == 2 {
        let mut energies = vec![Contribution::default(); terms.len()];
        assert_eq!(
            evaluator.evaluate(Request::new(&terms, &mesh.0).with_energies(&mut energies)),
            Ok(true)
        );
        assert_eq!(energies, found.0, "{}", names());
    }
}

/// All pairs in both orders, each term with and without its derivatives, and beside itself.
#[test]
fn pairs_in_every_order_are_those_of_the_processor() {
    let mesh = spheroid(6, 9, &mut random(5));
    let terms = [true, false].into_iter().flat_map(|wants| terms_on(&mesh, wants));
    // Signs have passed their own test; they change no order.
    let differs = |term: &Term| term.values[1] >= 0.0 && term.switches == 0;
    let all: Vec<_> = terms.filter(differs).map(|term| alone(&mesh, term)).collect();
    assert!(all.len() >= 68);
    for (adapter, precision) in targets() {
        let mut evaluator = GpuEvaluator::new(topology(&mesh), Some(adapter), precision).unwrap();
        for one in &all {
            for other in &all {
                check_together(&mut evaluator, &mesh, &[one, other], tolerance(precision));
            }
        }
    }
}

/// All triples of potentials in every order, bending in every scheme, with and without derivatives.
#[test]
fn triples_in_every_order_are_those_of_the_processor() {
    let mesh = spheroid(6, 9, &mut random(6));
    let differs = |term: &Term| match term.potential.name() {
        "BendingForce" => term.values[1] > 0.0 && term.switches == 0,
        "DihedralForce" => term.form == 0 && term.values[1] != 0.0,
        // One of those that have constants of triangles.
        _ => term.numbers.owner == 0 || term.potential.name() == "SkalakForce",
    };
    for wants_derivatives in [true, false] {
        let terms = terms_on(&mesh, wants_derivatives).into_iter().filter(differs);
        let all: Vec<_> = terms.map(|term| alone(&mesh, term)).collect();
        assert!(all.len() >= 17);
        for (adapter, precision) in targets() {
            let mut evaluator =
                GpuEvaluator::new(topology(&mesh), Some(adapter), precision).unwrap();
            for (i, one) in all.iter().enumerate() {
                for (j, two) in all.iter().enumerate().filter(|(j, _)| *j != i) {
                    for (_, three) in all.iter().enumerate().filter(|(k, _)| ![i, j].contains(k)) {
                        let some = [one, two, three];
                        check_together(&mut evaluator, &mesh, &some, tolerance(precision));
                    }
                }
            }
        }
    }
}

#[test]
fn values_of_single_elements_are_followed() {
    for (adapter, precision) in targets() {
        let mesh = spheroid(6, 9, &mut random(3));
        let topology = topology(&mesh);
        let mut evaluator = GpuEvaluator::new(topology.clone(), Some(adapter), precision).unwrap();
        let mut noise = random(4);
        for _ in 0..3 {
            let rigidities: Vec<f64> =
                (0..topology.num_vertices()).map(|_| 2.0 + noise()).collect();
            let targets: Vec<f64> =
                (0..topology.triangles.len()).map(|_| 8.0 + 2.0 * noise()).collect();
            let mut bending = Term::new("BendingForce", 1, &[1.0, 0.1]).unwrap();
            bending.fields[0] = &rigidities;
            let mut area = Term::new("TriangleAreaForce", 0, &[1.0, 8.0]).unwrap();
            area.fields[1] = &targets;
            let edges = topology.edges.len();
            let stiffness: Vec<f64> = (0..edges).map(|_| 2.0 + noise()).collect();
            let rest: Vec<f64> = (0..edges).map(|_| 0.8 * noise()).collect();
            let mut hinges = Term::new("DihedralForce", 1, &[1.0, 0.0]).unwrap();
            hinges.fields[..2].copy_from_slice(&[&stiffness, &rest]);
            for terms in
                [vec![bending, area, hinges], vec![hinges, area, bending], vec![area], vec![hinges]]
            {
                let mut terms = terms;
                terms.iter_mut().for_each(|term| term.wants_derivatives = true);
                let found = on_device(&mut evaluator, &mesh, &terms);
                let errors = errors(&found, &on_processor(&mesh, &terms));
                assert!(errors.into_iter().all(|error| error < tolerance(precision)), "{errors:?}");
            }
        }
    }
}

#[test]
fn what_the_device_cannot_say_is_left_to_the_processor() {
    for (adapter, precision) in targets() {
        let mesh = spheroid(5, 7, &mut random(7));
        let mut evaluator = GpuEvaluator::new(topology(&mesh), Some(adapter), precision).unwrap();
        let terms = terms_on(&mesh, true);
        let mut found = vec![Contribution::default(); terms.len()];
        let mut lost = mesh.0.clone();
        lost[3 * 11 + 1] = f64::INFINITY;
        let huge: Vec<f64> = mesh.0.iter().map(|x| x * 1e200).collect();
        let mut flat = mesh.0.clone();
        for (corner, x) in mesh.1[4].into_iter().zip([1.0, 2.0, 4.0]) {
            flat[3 * corner as usize..][..3].fill(x);
        }
        let mut forces = vec![1.0; mesh.0.len()];
        for positions in [lost, huge, flat] {
            let done = evaluator.evaluate(
                Request::new(&terms, &positions)
                    .with_energies(&mut found)
                    .with_forces(&mut forces[..]),
            );
            assert_eq!(done, Ok(false));
            assert!(forces.iter().all(|force| *force == 1.0));
        }
        on_device(&mut evaluator, &mesh, &terms);
    }
}
