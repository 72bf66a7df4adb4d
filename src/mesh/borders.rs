//! The borders of a surface: where they are, how long they are and how they turn, forward and backward.
//!
//! With θ the angles of the triangles at a vertex, a border turns by π − Σ θ at each of its vertices, which is its
//! geodesic curvature integrated over the vertex' part of it, and an inner vertex has the Gaussian curvature 2π − Σ θ,
//! integrated over its part of the surface (M. Meyer et al., doi:10.1007/978-3-662-05105-4_2). By the theorem of Gauss
//! and Bonnet the two sums over all vertices add up to 2π χ, with χ = V − E + F, whatever the shape.

use super::geometry::Vec3;
use super::topology::NONE;
use super::triangulation::{Triangulation, next, previous};
use std::f64::consts::PI;

impl Triangulation {
    /// The vertices of each border, with the surface on the left, from the lowest one.
    pub fn border_loops(&self) -> Vec<Vec<u32>> {
        let mut loops: Vec<Vec<u32>> = Vec::new();
        let mut met = vec![false; self.num_vertices()];
        for first in 0..self.num_vertices() as u32 {
            let mut vertex = first;
            let mut border = Vec::new();
            while self.is_border(vertex) && !met[vertex as usize] {
                met[vertex as usize] = true;
                border.push(vertex);
                vertex = self.origin(next(self.leaving(vertex)));
            }
            if !border.is_empty() {
                loops.push(border);
            }
        }
        loops
    }
}

/// Sums over all borders.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BorderTotals {
    /// Length, nm.
    pub length: f64,
    /// Σ (π − Σ θ) over the vertices of borders: 2π for a flat disk.
    pub turning: f64,
    /// χ of the whole surface, which no shape changes.
    pub euler_characteristic: f64,
}

/// Derivatives of the energy with respect to the [`BorderTotals`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BorderPartials {
    /// ∂E/∂(length), kJ/mol/nm.
    pub length: f64,
    /// ∂E/∂(turning), kJ/mol.
    pub turning: f64,
}

/// The borders of a surface with its present connectivity, by half-edges, each of which stands for the corner that it
/// begins at.
#[derive(Debug, Clone, Default)]
pub struct Borders {
    edges: Vec<[u32; 2]>,
    /// The corners of triangles at vertices of borders, and the other two counter-clockwise.
    corners: Vec<[u32; 3]>,
    euler_characteristic: f64,
}

impl Borders {
    /// Those of a mesh.
    pub fn new(mesh: &Triangulation) -> Self {
        let mut borders = Self {
            euler_characteristic: mesh.num_vertices() as f64 - mesh.num_edges() as f64
                + mesh.triangles().len() as f64,
            ..Self::default()
        };
        if mesh.is_closed() {
            return borders;
        }
        for half in 0..3 * mesh.triangles().len() as u32 {
            if mesh.twin(half) == NONE {
                borders.edges.push([half, next(half)]);
            }
            if mesh.is_border(mesh.origin(half)) {
                borders.corners.push([half, next(half), previous(half)]);
            }
        }
        borders
    }

    /// Length and turning with corners at some positions, nm, beside each other in a triangle.
    pub fn totals(&self, position: impl Fn(u32) -> Vec3) -> BorderTotals {
        let length = |edge: &[u32; 2]| (position(edge[1]) - position(edge[0])).norm();
        // Each vertex of a border begins one of its edges.
        let straight = PI * self.edges.len() as f64;
        let angles: f64 = self.corners.iter().map(|corner| angle(corner.map(&position))).sum();
        BorderTotals {
            length: self.edges.iter().map(length).sum(),
            turning: straight - angles,
            euler_characteristic: self.euler_characteristic,
        }
    }

    /// Hand the forces, kJ/mol/nm, on corners to `add`, in an order that the triangles alone decide. They sum to zero in
    /// each triangle.
    pub fn forces(
        &self,
        position: impl Fn(u32) -> Vec3,
        partials: &BorderPartials,
        mut add: impl FnMut(u32, Vec3),
    ) {
        if partials.length != 0.0 {
            for &[start, end] in &self.edges {
                let pull = (position(end) - position(start)).normalize() * partials.length;
                add(start, pull);
                add(end, -pull);
            }
        }
        if partials.turning != 0.0 {
            for corner in &self.corners {
                let [by_start, by_end] = angle_gradient(corner.map(&position));
                let (start, end) = (by_start * partials.turning, by_end * partials.turning);
                add(corner[0], -start - end);
                add(corner[1], start);
                add(corner[2], end);
            }
        }
    }
}

/// The angle of a triangle at the first of its corners.
pub fn angle([a, b, c]: [Vec3; 3]) -> f64 {
    let (ab, ac) = (b - a, c - a);
    ab.cross(&ac).norm().atan2(ab.dot(&ac))
}

/// The gradient of the [`angle`] with respect to the second and the third corner: either turns about the first.
fn angle_gradient([a, b, c]: [Vec3; 3]) -> [Vec3; 2] {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(&ac).normalize();
    [ab.cross(&normal) / ab.norm_squared(), normal.cross(&ac) / ac.norm_squared()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Topology;
    use crate::test_meshes::{icosahedron, noise, with_holes};

    /// An icosahedron with two holes, one of them of several triangles, and moved vertices.
    fn mesh() -> (Triangulation, Vec<Vec3>) {
        let (vertices, mut triangles) = icosahedron();
        triangles.retain(|t| !t.contains(&0) && *t != [3, 2, 6]);
        let mut random = noise(8);
        let mesh = Triangulation::new(&Topology::new(&triangles, 12).unwrap());
        let place =
            |particle: &u32| Vec3::from(vertices[*particle as usize].map(|x| x + 0.3 * random()));
        let positions = mesh.particles().iter().map(place).collect();
        (mesh, positions)
    }

    #[test]
    fn borders_are_loops_with_the_surface_on_the_left() {
        let lengths = with_holes().into_iter().map(|mesh| {
            let loops = mesh.border_loops();
            for border in &loops {
                for (n, &vertex) in border.iter().enumerate() {
                    let half = mesh.leaving(vertex);
                    assert_eq!((mesh.origin(half), mesh.twin(half)), (vertex, NONE));
                    assert_eq!(mesh.origin(next(half)), border[(n + 1) % border.len()]);
                }
            }
            loops.iter().map(Vec::len).collect::<Vec<_>>()
        });
        assert_eq!(lengths.collect::<Vec<_>>(), [vec![], vec![3], vec![5, 3], vec![5]]);
    }

    #[test]
    fn gauss_and_bonnet_hold() {
        let (mesh, positions) = mesh();
        let totals = Borders::new(&mesh).totals(|half| positions[mesh.origin(half) as usize]);
        assert_eq!((totals.euler_characteristic, mesh.num_border_edges()), (0.0, 8));
        let mut ring = Vec::new();
        let inner = (0..mesh.num_vertices() as u32).filter(|vertex| !mesh.is_border(*vertex));
        let curvature: f64 = inner
            .map(|vertex| {
                mesh.ring(vertex, &mut ring);
                let corner = |half: &u32| {
                    [*half, next(*half), previous(*half)]
                        .map(|h| positions[mesh.origin(h) as usize])
                };
                2.0 * PI - ring.iter().map(|half| angle(corner(half))).sum::<f64>()
            })
            .sum();
        assert!((curvature + totals.turning).abs() < 1e-13, "{curvature} {totals:?}");
    }

    #[test]
    fn forces_are_minus_the_gradient() {
        let (mesh, positions) = mesh();
        let borders = Borders::new(&mesh);
        let partials = BorderPartials { length: 0.7, turning: -1.3 };
        let energy = |positions: &[Vec3]| {
            let totals = borders.totals(|half| positions[mesh.origin(half) as usize]);
            partials.length * totals.length + partials.turning * totals.turning
        };
        let mut forces = vec![Vec3::zeros(); positions.len()];
        borders.forces(
            |half| positions[mesh.origin(half) as usize],
            &partials,
            |half, force| forces[mesh.origin(half) as usize] += force,
        );
        for vertex in 0..positions.len() {
            for axis in 0..3 {
                let at = |step: f64| {
                    let mut moved = positions.clone();
                    moved[vertex][axis] += step;
                    energy(&moved)
                };
                let expected = -(at(1e-5) - at(-1e-5)) / 2e-5;
                assert!((forces[vertex][axis] - expected).abs() < 1e-8, "{vertex} {axis}");
            }
        }
    }
}
