//! The evaluator on the GPU against that on the processor, on every adapter that there is.
//!
//! Without an adapter these tests say so and pass, unless HELFRICH_REQUIRE_GPU=1 demands one. Debian's
//! mesa-vulkan-drivers have one that computes on the processor.

#[path = "support.rs"]
mod support;

use openmm_helfrich::evaluator::CpuEvaluator;
use openmm_helfrich::evaluator::gpu::{GpuEvaluator, Precision, adapters};
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::potentials::{Contribution, Term};
use std::sync::Arc;
use support::{Mesh, all_terms, random, spheroid};

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
    let borrowed: Vec<_> = terms.iter().collect();
    evaluator.evaluate(&borrowed, &mesh.0, &mut contributions, Some(&mut forces)).unwrap();
    (contributions, forces)
}

fn on_device(evaluator: &mut GpuEvaluator, mesh: &Mesh, terms: &[Term]) -> Found {
    let mut contributions = vec![Contribution::default(); terms.len()];
    let mut forces = vec![0.0; mesh.0.len()];
    let done = evaluator.evaluate(terms, &mesh.0, &mut contributions, Some(&mut forces)).unwrap();
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
        let mut evaluator = GpuEvaluator::new(topology(&mesh), Some(adapter), precision).unwrap();
        for term in all_terms() {
            let found = on_device(&mut evaluator, &mesh, &[term]);
            let expected = on_processor(&mesh, &[term]);
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
}
