//! Time of one evaluation of the paper's four forces on every adapter, with upload, kernels (by the device's own
//! clock) and readback apart, beside the processor's: `cargo bench --bench gpu`, or with the subdivisions of the
//! icospheres to measure, `cargo bench --bench gpu -- 10 20`.

use openmm_helfrich::evaluator::CpuEvaluator;
use openmm_helfrich::evaluator::gpu::{GpuEvaluator, Precision, Timings, adapters};
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// N = 1002, 4002, 16 002, 100 002 and 998 562.
const SUBDIVISIONS: [usize; 5] = [10, 20, 40, 100, 316];

/// How long each row is measured.
const BUDGET: Duration = Duration::from_secs(2);

type Mesh = (Vec<f64>, Vec<[i64; 3]>);

/// The icosphere of 10 n² + 2 vertices, of radius 1000 nm.
fn icosphere(n: usize) -> Mesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut corners = Vec::new();
    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        corners.extend([[0.0, s, t * g], [s, t * g, 0.0], [t * g, 0.0, s]]);
    }
    let corners: Vec<_> = corners.into_iter().map(nalgebra::Vector3::from).collect();
    let near = |a: usize, b: usize| ((corners[a] - corners[b]).norm_squared() - 4.0).abs() < 1e-9;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    // A point by the weights of its corners, so that neighbouring faces share those of their common edge.
    let mut numbers = HashMap::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if !(near(a, b) && near(b, c) && near(c, a)) {
                    continue;
                }
                let outward = corners[a].dot(&corners[b].cross(&corners[c])) > 0.0;
                let (b, c) = if outward { (b, c) } else { (c, b) };
                let mut point = |i: usize, j: usize| {
                    let mut weights = [(a, n - i - j), (b, i), (c, j)];
                    weights.sort_unstable();
                    let key: Vec<_> = weights.into_iter().filter(|(_, w)| *w > 0).collect();
                    *numbers.entry(key).or_insert_with(|| {
                        let sum: nalgebra::Vector3<f64> =
                            weights.iter().map(|(corner, w)| corners[*corner] * *w as f64).sum();
                        positions.extend_from_slice((1000.0 * sum.normalize()).as_slice());
                        (positions.len() / 3 - 1) as i64
                    })
                };
                for i in 0..n {
                    for j in 0..n - i {
                        triangles.push([point(i, j), point(i + 1, j), point(i, j + 1)]);
                        if i + j + 1 < n {
                            triangles.push([point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                        }
                    }
                }
            }
        }
    }
    (positions, triangles)
}

fn terms() -> [Term<'static>; 4] {
    [
        ("BendingForce", [50.0, 0.0]),
        ("SurfaceAreaForce", [1.3, 1.25e7]),
        ("EnclosedVolumeForce", [0.04, 4.1e9]),
        ("TriangleHeightForce", [0.5, 9.977]),
    ]
    .map(|(name, values)| Term::new(name, 0, &values).expect("the values are allowed"))
}

/// Run for a while and return the shortest run.
fn shortest<T>(mut body: impl FnMut() -> (Duration, T)) -> (Duration, T) {
    body();
    let start = Instant::now();
    let mut best = body();
    while start.elapsed() < BUDGET {
        let next = body();
        if next.0 < best.0 {
            best = next;
        }
    }
    best
}

fn microseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

fn on_processor(topology: &Arc<Topology>, positions: &[f64]) -> Duration {
    let mut evaluator = CpuEvaluator::new(topology.clone());
    let (terms, mut found) = (terms(), [Contribution::default(); 4]);
    let mut forces = vec![0.0; positions.len()];
    shortest(|| {
        let start = Instant::now();
        evaluator
            .evaluate(
                Request::new(&terms, positions)
                    .with_energies(&mut found)
                    .with_forces(&mut forces[..]),
            )
            .expect("a sphere has forces");
        (start.elapsed(), ())
    })
    .0
}

fn on_device(evaluator: &mut GpuEvaluator, positions: &[f64]) -> (Duration, Timings) {
    let (terms, mut found) = (terms(), [Contribution::default(); 4]);
    let mut forces = vec![0.0; positions.len()];
    evaluator.measure();
    shortest(|| {
        let start = Instant::now();
        let done = evaluator.evaluate(
            Request::new(&terms, positions).with_energies(&mut found).with_forces(&mut forces[..]),
        );
        assert_eq!(done, Ok(true));
        (start.elapsed(), evaluator.timings().unwrap_or_default())
    })
}

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let subdivisions = if asked.is_empty() { SUBDIVISIONS.to_vec() } else { asked };
    println!("Jülicher + area + volume + heights, shortest evaluation, µs");
    println!(
        "       N  where                                     total     upload    kernels   readback"
    );
    for n in subdivisions {
        let (positions, triangles) = icosphere(n);
        let count = positions.len() / 3;
        let topology = Arc::new(Topology::new(&triangles, count).expect("a sphere is closed"));
        let time = microseconds(on_processor(&topology, &positions));
        println!("{count:8}  {:38} {time:10.1}", "processor, double");
        for (index, adapter) in adapters::all().iter().enumerate() {
            for precision in [Precision::Single, Precision::Double] {
                let name: String = adapter.name.chars().take(28).collect();
                let where_ = format!("{name}, {}", format!("{precision:?}").to_lowercase());
                match GpuEvaluator::new(topology.clone(), Some(index), precision) {
                    Err(error) => println!("{count:8}  {where_:38} {error}"),
                    Ok(mut evaluator) => {
                        let (total, parts) = on_device(&mut evaluator, &positions);
                        let [total, upload, kernel, readback] =
                            [total, parts.upload, parts.kernel, parts.readback].map(microseconds);
                        println!(
                            "{count:8}  {where_:38} {total:10.1} {upload:10.1} {kernel:10.1} \
                             {readback:10.1}"
                        );
                    }
                }
            }
        }
    }
}
