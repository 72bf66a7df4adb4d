//! Time of one evaluation of the paper's default forces, per mesh size: `cargo bench`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use openmm_helfrich::evaluator::CpuEvaluator;
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::potentials::{Contribution, Term};
use std::collections::HashMap;
use std::hint::black_box;
use std::sync::Arc;

/// An icosahedron of which each triangle is split into four, `times` times, on a sphere of 1000 nm.
fn sphere(times: usize) -> (Vec<f64>, Vec<[i64; 3]>) {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        vertices.extend([[0.0, s, t * g], [s, t * g, 0.0], [t * g, 0.0, s]]);
    }
    let distance = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let near = |a: usize, b: usize| (distance(&vertices[a], &vertices[b]) - 4.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let [p, q, r] = [a, b, c].map(|v| nalgebra::Vector3::from(vertices[v]));
                    let outward = p.dot(&q.cross(&r)) > 0.0;
                    let (b, c) = if outward { (b, c) } else { (c, b) };
                    triangles.push([a as i64, b as i64, c as i64]);
                }
            }
        }
    }
    for _ in 0..times {
        let mut middle = HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for &[a, b, c] in &triangles {
            let mut between = |i: i64, j: i64| {
                *middle.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let (p, q) = (vertices[i as usize], vertices[j as usize]);
                    vertices.push(std::array::from_fn(|k| 0.5 * (p[k] + q[k])));
                    vertices.len() as i64 - 1
                })
            };
            let (ab, bc, ca) = (between(a, b), between(b, c), between(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let scaled = |v: &[f64; 3]| {
        let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| 1000.0 * x / norm)
    };
    (vertices.iter().flat_map(scaled).collect(), triangles)
}

fn evaluate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("Julicher + area + volume + heights");
    for times in 2..=6 {
        let (positions, triangles) = sphere(times);
        let count = positions.len() / 3;
        let mut evaluator = CpuEvaluator::new(Arc::new(Topology::new(&triangles, count).unwrap()));
        let terms = [
            Term::new("BendingForce", 0, &[50.0, 0.0]).unwrap(),
            Term::new("SurfaceAreaForce", 0, &[1.3, 1.25e7]).unwrap(),
            Term::new("EnclosedVolumeForce", 0, &[0.04, 4.1e9]).unwrap(),
            Term::new("TriangleHeightForce", 0, &[20.0, 9.977]).unwrap(),
        ];
        let mut contributions = [Contribution::default(); 4];
        let mut forces = vec![0.0; positions.len()];
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(BenchmarkId::from_parameter(count), |bencher| {
            bencher.iter(|| {
                forces.fill(0.0);
                evaluator
                    .evaluate(
                        terms.iter(),
                        black_box(&positions),
                        &mut contributions,
                        Some(&mut forces),
                    )
                    .unwrap();
                black_box(&forces);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate);
criterion_main!(benches);
