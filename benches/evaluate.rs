//! Time of one evaluation of the paper's default forces, per mesh size: `cargo bench`.
//!
//! Groups are bending schemes, with area, volume and heights in each; within a group every evaluator
//! has a name that says its threads. `benches/steps.py` reads what criterion leaves in the target
//! folder and prints the ratios.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use openmm_helfrich::evaluator::{CpuEvaluator, InstructionSet, ReferenceEvaluator};
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::potentials::{Evaluator, Request, Term};
use std::f64::consts::PI;
use std::hint::black_box;
use std::sync::Arc;

#[path = "spheres.rs"]
mod spheres;

/// Bending schemes in the order of their codes.
const SCHEMES: [&str; 5] =
    ["Julicher", "GompperKroll", "GompperKrollBarycentric", "JulicherVoronoi", "Espriu"];
/// Parts of a side of the icosahedron: N = 1002, 4002, the sizes at which schemes are compared.
const COMPARED: [usize; 2] = [10, 20];
/// N = 252 to 40 962, at which Jülicher's scheme is timed.
const SIZES: [usize; 5] = [5, 10, 20, 32, 64];

/// What computes forces of terms at positions, and adds them to the last argument.
type Evaluate = Box<dyn FnMut(&[Term], &[f64], &mut [f64]) + Send>;

/// One way to evaluate, under its name in the tables.
struct Contender {
    name: &'static str,
    threads: usize,
    make: fn(Arc<Topology>) -> Evaluate,
}

/// All ways to evaluate. The plain one is the readable reference, to which ratios refer; AVX2 and one number at
/// a time are what other processors get.
const CONTENDERS: [Contender; 6] = [
    Contender { name: "plain, 1 thread", threads: 1, make: plain },
    Contender { name: "plain, 2 threads", threads: 2, make: plain },
    Contender {
        name: "lanes, 1 thread",
        threads: 1,
        make: |mesh| lanes(mesh, InstructionSet::Best, 1),
    },
    Contender {
        name: "lanes, 2 threads",
        threads: 2,
        make: |mesh| lanes(mesh, InstructionSet::Best, 2),
    },
    Contender {
        name: "lanes of AVX2, 1 thread",
        threads: 1,
        make: |mesh| lanes(mesh, InstructionSet::Avx2, 1),
    },
    Contender {
        name: "no lanes, 1 thread",
        threads: 1,
        make: |mesh| lanes(mesh, InstructionSet::Scalar, 1),
    },
];

fn plain(topology: Arc<Topology>) -> Evaluate {
    let mut evaluator = ReferenceEvaluator::new(topology);
    Box::new(move |terms, positions, forces| {
        evaluator.evaluate(Request::new(terms, positions).with_forces(forces)).unwrap();
    })
}

fn lanes(topology: Arc<Topology>, set: InstructionSet, threads: usize) -> Evaluate {
    let mut evaluator = CpuEvaluator::with(topology, set, threads);
    Box::new(move |terms, positions, forces| {
        evaluator.evaluate(Request::new(terms, positions).with_forces(forces)).unwrap();
    })
}

fn evaluate(criterion: &mut Criterion) {
    for (form, scheme) in SCHEMES.into_iter().enumerate() {
        let mut group = criterion.benchmark_group(scheme);
        for &n in if form == 0 { &SIZES[..] } else { &COMPARED[..] } {
            let (positions, triangles) = spheres::sphere(n);
            let count = positions.len() / 3;
            let radius = 100.0 * n as f64;
            let area = 4.0 * PI * radius.powi(2);
            let terms = [
                Term::new("BendingForce", form, &[50.0, 0.0]).unwrap(),
                Term::new("SurfaceAreaForce", 0, &[1.3, area]).unwrap(),
                Term::new("EnclosedVolumeForce", 0, &[0.04, area * radius / 3.0]).unwrap(),
                Term::new("TriangleHeightForce", 0, &[20.0, 9.977]).unwrap(),
            ];
            let topology = Arc::new(Topology::new(&triangles, count).unwrap());
            let mut forces = vec![0.0; positions.len()];
            group.throughput(Throughput::Elements(count as u64));
            for contender in &CONTENDERS {
                let mut run = (contender.make)(topology.clone());
                let pool = rayon::ThreadPoolBuilder::new().num_threads(contender.threads);
                let pool = pool.build().unwrap();
                group.bench_function(BenchmarkId::new(contender.name, count), |bencher| {
                    // Inside of the pool, so that the timed part does not include the way there.
                    pool.install(|| {
                        bencher.iter(|| {
                            forces.fill(0.0);
                            run(&terms, black_box(&positions), &mut forces);
                            black_box(&forces);
                        });
                    });
                });
            }
        }
        group.finish();
    }
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
