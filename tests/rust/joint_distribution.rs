//! Molecular dynamics with bond flips against a Monte Carlo that is written plainly here: vertices that are displaced one
//! by one, and edges that are flipped in a list of triangles, each accepted by the energy of the whole mesh. Both
//! sample exp(−E / kT) over positions and connectivity, so the means of areas, energies and degrees must agree.
//!
//! The bending is Gompper and Kroll's, whose energy is smooth. Jülicher's jumps where an edge is folded until its angle
//! passes through π: displacements go there as the weights say, and dynamics do not, whatever their time step.

use crate::support::{Mesh, random, spheroid};
use openmm_helfrich::dynamics::integrate::{Dynamics, Particles};
use openmm_helfrich::dynamics::random::{Stream, normals};
use openmm_helfrich::evaluator::ReferenceEvaluator;
use openmm_helfrich::membrane::Membrane;
use openmm_helfrich::mesh::{Configuration, Topology};
use openmm_helfrich::moves::{FlipRules, FlipState, Round};
use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term};
use std::sync::Arc;

const MOST: usize = 8;

/// kT is 1; the mesh has 14 vertices, about 10 nm from its middle.
fn terms() -> [Term<'static>; 4] {
    [
        Term::new("BendingForce", 2, &[2.0, 0.05]).unwrap(),
        Term::new("SurfaceAreaForce", 0, &[5.0, 900.0]).unwrap(),
        Term::new("EnclosedVolumeForce", 0, &[1.0, 2200.0]).unwrap(),
        Term::new("TriangleHeightForce", 0, &[3.5, 4.0]).unwrap(),
    ]
}

/// Energies of terms, and the number of vertices of each degree from 3 on.
type Sample = Vec<f64>;

fn sample(energies: &[f64], degrees: impl Iterator<Item = u32>) -> Sample {
    let mut sample = energies.to_vec();
    sample.extend([0.0; MOST - 2]);
    for degree in degrees {
        sample[energies.len() + degree as usize - 3] += 1.0;
    }
    sample
}

/// Means, and their standard errors from the means of blocks.
fn statistics(samples: &[Sample]) -> Vec<(f64, f64)> {
    const BLOCKS: usize = 25;
    let length = samples.len() / BLOCKS;
    (0..samples[0].len())
        .map(|k| {
            let mean =
                |block: &[Sample]| block.iter().map(|s| s[k]).sum::<f64>() / block.len() as f64;
            let blocks: Vec<f64> = samples.chunks_exact(length).map(mean).collect();
            let all = blocks.iter().sum::<f64>() / BLOCKS as f64;
            let spread = blocks.iter().map(|b| (b - all).powi(2)).sum::<f64>();
            (all, (spread / (BLOCKS * (BLOCKS - 1)) as f64).sqrt())
        })
        .collect()
}

fn energies(mesh: &Mesh, terms: &[Term]) -> Vec<f64> {
    let topology = Arc::new(Topology::new(&mesh.1, mesh.0.len() / 3).unwrap());
    let mut sums = vec![Contribution::default(); terms.len()];
    match ReferenceEvaluator::new(topology)
        .evaluate(Request::new(terms, &mesh.0).with_energies(&mut sums))
    {
        Ok(()) => sums.iter().map(|sum| sum.energy).collect(),
        Err(_) => vec![f64::INFINITY],
    }
}

fn degree(triangles: &[[i64; 3]], vertex: i64) -> usize {
    triangles.iter().filter(|corners| corners.contains(&vertex)).count()
}

/// The triangles after the flip of side `side` of triangle `first`, unless it is not allowed.
fn flipped(triangles: &[[i64; 3]], first: usize, side: usize) -> Option<Vec<[i64; 3]>> {
    let [i, j, k] = [0, 1, 2].map(|n| triangles[first][(side + n) % 3]);
    let runs = |t: &[i64; 3]| (0..3).any(|n| t[n] == j && t[(n + 1) % 3] == i);
    let second = triangles.iter().position(runs).unwrap();
    let l = *triangles[second].iter().find(|v| **v != i && **v != j).unwrap();
    let joined = triangles.iter().any(|t| t.contains(&k) && t.contains(&l));
    let [i_has, j_has, k_has, l_has] = [i, j, k, l].map(|v| degree(triangles, v));
    if joined || i_has.min(j_has) <= 3 || k_has.max(l_has) >= MOST {
        return None;
    }
    let mut changed = triangles.to_vec();
    changed[first] = [i, l, k];
    changed[second] = [j, k, l];
    Some(changed)
}

fn plain_monte_carlo(mut mesh: Mesh, sweeps: usize) -> Vec<Sample> {
    let terms = terms();
    let mut noise = random(77);
    let count = mesh.0.len() / 3;
    let mut known = energies(&mesh, &terms);
    let mut samples = Vec::new();
    for sweep in 0..sweeps {
        for _ in 0..2 * count {
            let vertex = ((noise() + 1.0) * 0.5 * count as f64) as usize;
            let mut moved = mesh.clone();
            for axis in 0..3 {
                moved.0[3 * vertex + axis] += 0.8 * noise();
            }
            let found = energies(&moved, &terms);
            let rise = found.iter().sum::<f64>() - known.iter().sum::<f64>();
            if 0.5 * (noise() + 1.0) < (-rise).exp() {
                (mesh, known) = (moved, found);
            }
        }
        for _ in 0..count {
            let half = ((noise() + 1.0) * 0.5 * (3 * mesh.1.len()) as f64) as usize;
            let Some(triangles) = flipped(&mesh.1, half / 3, half % 3) else { continue };
            let moved = (mesh.0.clone(), triangles);
            let found = energies(&moved, &terms);
            let rise = found.iter().sum::<f64>() - known.iter().sum::<f64>();
            if 0.5 * (noise() + 1.0) < (-rise).exp() {
                (mesh, known) = (moved, found);
            }
        }
        if sweep > sweeps / 20 {
            let degrees = (0..count).map(|v| degree(&mesh.1, v as i64) as u32);
            samples.push(sample(&known, degrees));
        }
    }
    samples
}

fn dynamics_with_flips(mesh: &Mesh, steps: usize) -> Vec<Sample> {
    let terms = terms();
    let (mut positions, count) = (mesh.0.clone(), mesh.0.len() / 3);
    let mut membrane = Membrane::new(&mesh.1, count).unwrap();
    membrane.set_threads(1);
    let rules = FlipRules {
        temperature: 1.0,
        min_degree: 3,
        max_degree: MOST as i32,
        max_edge_length: 0.0,
        demon: 0,
    };
    let mut state = FlipState { key: [3, 4], ..FlipState::default() };
    let dynamics = Dynamics::new(&vec![1.0; count]);
    let mut stream = Stream { key: [5, 6], draws: 0 };
    let mut velocities = vec![0.0; 3 * count];
    normals(&mut stream, &mut velocities);
    let mut forces = vec![0.0; 3 * count];
    let mut sums = vec![Contribution::default(); terms.len()];
    let mut samples = Vec::new();
    for step in 0..steps {
        if step % 5 == 0 {
            membrane
                .flip(
                    &terms,
                    Configuration::new(&positions, None),
                    Round { rules: &rules, attempts: count as u64, state: &mut state },
                    None,
                    &mut [],
                )
                .unwrap();
        }
        forces.fill(0.0);
        let wanted = step % 10 == 0 && step > steps / 20;
        let energies = if wanted { &mut sums[..] } else { &mut [] };
        membrane
            .evaluate(
                Request::new(&terms, &positions)
                    .with_energies(energies)
                    .with_forces(&mut forces[..]),
                None,
            )
            .unwrap();
        if wanted {
            let energies: Vec<f64> = sums.iter().map(|sum| sum.energy).collect();
            samples.push(sample(&energies, membrane.mesh().degrees().iter().copied()));
        }
        let particles =
            Particles { positions: &mut positions, velocities: &mut velocities, forces: &forces };
        dynamics.langevin_middle(None, particles, &mut stream, (0.02, 0.5, 1.0));
    }
    assert!(state.accepted > state.attempts / 20, "{state:?}");
    samples
}

#[test]
fn dynamics_with_flips_and_plain_monte_carlo_have_the_same_means() {
    let mesh = spheroid(3, 4, &mut random(1));
    let start = mesh.clone();
    let other = std::thread::spawn(move || plain_monte_carlo(start, 60_000));
    let dynamics = statistics(&dynamics_with_flips(&mesh, 2_000_000));
    let plain = statistics(&other.join().unwrap());
    let names = ["bending", "area", "volume", "heights", "3", "4", "5", "6", "7", "8"];
    for (name, (this, other)) in names.into_iter().zip(dynamics.iter().zip(&plain)) {
        println!("{name:8} {:9.4} ± {:.4}   {:9.4} ± {:.4}", this.0, this.1, other.0, other.1);
    }
    for (name, (this, other)) in names.into_iter().zip(dynamics.iter().zip(&plain)) {
        let error = this.1.hypot(other.1);
        assert!((this.0 - other.0).abs() < 4.0 * error, "{name}: {this:?} {other:?}");
    }
    // The errors are small enough to tell something.
    assert!(dynamics[0].1.hypot(plain[0].1) < 0.02 * plain[0].0);
}
