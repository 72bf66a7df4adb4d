//! Small meshes for the unit tests.

use crate::mesh::{Topology, Triangulation};

/// Vertices and outward triangles.
pub type TestMesh = (Vec<[f64; 3]>, Vec<[i64; 3]>);

/// The octahedron with corners on the axes.
pub fn octahedron() -> TestMesh {
    let vertices = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let triangles = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    (vertices, triangles)
}

/// The icosahedron with edges of length 2.
pub fn icosahedron() -> TestMesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let vertices = vec![
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ];
    let triangles = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (vertices, triangles)
}

/// What a validation from nothing says of the same triangles.
pub fn rebuilt(mesh: &Triangulation) -> Triangulation {
    let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
    Triangulation::new(&Topology::new(&triangles, mesh.num_vertices()).unwrap())
}

/// The icosahedron; the same with a hole; with two, one of them of several triangles; and as few triangles as have an
/// edge to flip.
pub fn with_holes() -> [Triangulation; 4] {
    let whole = icosahedron().1;
    let mut one = whole.clone();
    one.remove(7);
    let two = whole.iter().copied().filter(|t| !t.contains(&0) && *t != [3, 2, 6]).collect();
    let few = whole[..5].to_vec();
    [whole, one, two, few]
        .map(|triangles| rebuilt(&Triangulation::new(&Topology::new(&triangles, 12).unwrap())))
}

/// Numbers in [−1, 1) that look random and never change.
pub fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
