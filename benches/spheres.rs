//! Icospheres for the benchmarks.

use std::collections::HashMap;

/// An icosphere: every side of the icosahedron cut into `n` parts, radius 100 n nm.
pub fn sphere(n: usize) -> (Vec<f64>, Vec<[i64; 3]>) {
    let (corners, faces) = icosahedron();
    let mut index = HashMap::new();
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for face in faces {
        // A point of a face by its weights; neighbouring faces name it by the same corners.
        let mut vertex = |weights: [usize; 3]| {
            let mut key: Vec<_> = (0..3).map(|k| (face[k], weights[k])).collect();
            key.retain(|&(_, weight)| weight > 0);
            key.sort_unstable();
            let fresh = index.len() as i64;
            *index.entry(key.clone()).or_insert_with(|| {
                let point: [f64; 3] = std::array::from_fn(|axis| {
                    key.iter().map(|&(corner, w)| w as f64 * corners[corner][axis]).sum()
                });
                let norm = point.iter().map(|x| x * x).sum::<f64>().sqrt();
                positions.extend(point.map(|x| 100.0 * n as f64 * x / norm));
                fresh
            })
        };
        for i in 0..n {
            for j in 0..n - i {
                let k = n - 1 - i - j;
                triangles.push([[i + 1, j, k], [i, j + 1, k], [i, j, k + 1]].map(&mut vertex));
                if k > 0 {
                    let turned = [[i, j + 1, k], [i + 1, j, k], [i + 1, j + 1, k - 1]];
                    triangles.push(turned.map(&mut vertex));
                }
            }
        }
    }
    (positions, triangles)
}

/// Corners and outward faces of an icosahedron.
fn icosahedron() -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut corners: Vec<[f64; 3]> = Vec::new();
    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        corners.extend([[0.0, s, t * g], [s, t * g, 0.0], [t * g, 0.0, s]]);
    }
    let near = |a: usize, b: usize| {
        let square: f64 = (0..3).map(|k| (corners[a][k] - corners[b][k]).powi(2)).sum();
        (square - 4.0).abs() < 1e-9
    };
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let [p, q, r] = [a, b, c].map(|v| nalgebra::Vector3::from(corners[v]));
                    let outward = p.dot(&q.cross(&r)) > 0.0;
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    (corners, faces)
}
