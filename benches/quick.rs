use openmm_helfrich::evaluator::*;
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::potentials::{Contribution, Term};
use std::sync::Arc;
use std::time::Instant;

fn icosphere(n: usize) -> (Vec<f64>, Vec<[i64; 3]>) {
    let mut out = std::process::Command::new("/work/main/.venv/bin/python"); out.args(["-c", &format!("
import numpy as np, openmmhelfrich as h, sys
m=h.Mesh.icosphere({n},1000.0)
np.asarray(m.vertices).astype('<f8').tofile('/tmp/q_v{n}'); np.asarray(m.triangles).astype('<i8').tofile('/tmp/q_t{n}')")]);
    let vp = format!("/tmp/q_v{n}");
    if !std::path::Path::new(&vp).exists() { assert!(out.status().unwrap().success()); }
    let v = std::fs::read(vp).unwrap().chunks(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let t: Vec<i64> = std::fs::read(format!("/tmp/q_t{n}")).unwrap().chunks(8).map(|b| i64::from_le_bytes(b.try_into().unwrap())).collect();
    (v, t.chunks(3).map(|c| [c[0], c[1], c[2]]).collect())
}

fn main() {
    let which: Option<usize> = std::env::var("WHICH").ok().and_then(|x| x.parse().ok());
    let only: Option<usize> = std::env::args().nth(1).and_then(|x| x.parse().ok());
    for n in [10, 20, 32] {
        if only.is_some_and(|o| o != n) { continue; }
        let (v, t) = icosphere(n);
        let count = v.len() / 3;
        let mut seed = 12345u64;
        let mut noise = move || { seed ^= seed << 13; seed ^= seed >> 7; seed ^= seed << 17; (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0 };
        let scale = 0.05 * 1000.0 * (12.56f64 / count as f64).sqrt();
        let v: Vec<f64> = v.iter().map(|x| x + scale * noise()).collect();
        let topology = Arc::new(Topology::new(&t, count).unwrap());
        let d = 0.19 * (4.0 * std::f64::consts::PI * 1e6 / (2.0 * count as f64) * 1.732).sqrt();
        for form in [0, 1, 2, 3, 4] {
            if form > 0 && (n != 10 && n != 20 || std::env::var("ONLY").is_ok()) { continue; }
            let terms = [
                Term::new("BendingForce", form, &[50.0, 0.0]).unwrap(),
                Term::new("SurfaceAreaForce", 0, &[1.3, 1.25e7]).unwrap(),
                Term::new("EnclosedVolumeForce", 0, &[0.04, 4.1e9]).unwrap(),
                Term::new("TriangleHeightForce", 0, &[d, 9.977]).unwrap(),
            ];
            let terms: Vec<&Term> = terms.iter().collect();
            let mut contributions = [Contribution::default(); 4];
            let mut forces = vec![0.0; v.len()];
            let reps = (20_000 / count).max(1);
            let sets = [(InstructionSet::Best, 1), (InstructionSet::Avx2, 1), (InstructionSet::Scalar, 1), (InstructionSet::Best, 2)];
            let mut reference = ReferenceEvaluator::new(topology.clone());
            let mut all: Vec<_> = sets.iter().map(|&(s, t)| CpuEvaluator::with(topology.clone(), s, t)).collect();
            let mut best = vec![f64::INFINITY; sets.len() + 1];
            for _ in 0..(400 * 1002 / count).max(60) * if std::env::var("ONLY").is_ok() { 5 } else { 1 } {
                let mut take = |slot: usize, f: &mut dyn FnMut(&mut [Contribution], &mut [f64])| {
                    let start = Instant::now();
                    for _ in 0..reps { f(&mut contributions, &mut forces); }
                    best[slot] = best[slot].min(start.elapsed().as_secs_f64() / reps as f64 * 1e6);
                };
                if std::env::var("ONLY").is_err() { take(0, &mut |_, f| { reference.evaluate(&terms, &v, &mut [], Some(f)).unwrap() }); }
                for (k, e) in all.iter_mut().enumerate() {
                    if std::env::var("ONLY").ok().and_then(|x| x.parse::<usize>().ok()).is_some_and(|o| o != k) { continue; }
                    take(k + 1, &mut |_, f| { e.evaluate(&terms, &v, &mut [], Some(f)).unwrap() });
                }
            }
            print!("N {count} form {form}: reference {:.1}", best[0]);
            for (k, (set, threads)) in sets.iter().enumerate() {
                print!("  {set:?}/{threads} {:.1} ({:.3})", best[k + 1], best[k + 1] / best[0]);
            }
            println!();
        }
    }
}
