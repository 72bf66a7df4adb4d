//! Which triangles, edges and vertices of a surface touch which.

use super::Triangulation;
use super::pairing::{HalfEdge, checked_indices, paired_half_edges};
use crate::error::{Error, Result};
use std::ops::Range;

/// What stands for the neighbour that an edge or half-edge at a border does not have.
pub const NONE: u32 = u32::MAX;

/// A validated, oriented 2-manifold triangulation, closed or with borders.
///
/// Vertices are numbered locally, from 0 without gaps, in ascending order of the indices that the user
/// gave; [`Topology::particles`] translates back. Corner `3 t + k` is the `k`-th corner of triangle `t`.
/// Edge `k` of a triangle runs from its corner `k` to its corner `k + 1`.
///
/// ```
/// use openmm_helfrich::mesh::Topology;
/// let tetrahedron = [[7, 5, 9], [7, 9, 8], [7, 8, 5], [5, 8, 9]];
/// let topology = Topology::new(&tetrahedron, 10).unwrap();
/// assert_eq!(topology.particles, [5, 7, 8, 9]);
/// assert_eq!(topology.edges.len(), 6);
/// ```
#[derive(Debug, Clone)]
pub struct Topology {
    /// The user's index of each local vertex, ascending.
    pub particles: Vec<u32>,
    /// The local vertices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle, the index of its edges 01, 12 and 20.
    pub triangle_edges: Vec<[u32; 3]>,
    /// Each edge once.
    pub edges: Vec<Edge>,
    /// Where the corners of each vertex begin in `corners`; one entry more than vertices.
    pub offsets: Vec<u32>,
    /// The corners at each vertex, in ascending order.
    pub corners: Vec<u32>,
    /// Where the edges of each vertex begin in `vertex_edges`; at a border there is one edge more than corners.
    pub edge_offsets: Vec<u32>,
    /// The edges at each vertex, in ascending order.
    pub vertex_edges: Vec<u32>,
}

/// An edge with its two triangles, or one at a border: then the second triangle and its vertex are [`NONE`].
///
/// ```text
///            opposite[0]
///              /    \
///   triangles[0]     \        seen from outside: triangles[0] runs through
///            / start  \       the edge from start to end, triangles[1]
///           0────────▶ 1      from end to start
///            \   end  /
///   triangles[1]     /
///              \    /
///            opposite[1]
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Edge {
    /// Start and end.
    pub vertices: [u32; 2],
    /// The third vertex of either triangle.
    pub opposite: [u32; 2],
    /// The triangle on the left and the one on the right.
    pub triangles: [u32; 2],
}

impl Topology {
    /// Validate triangles that hold indices from 0 to `count` − 1.
    ///
    /// # Errors
    /// Names the triangle, edge or vertex at fault: empty mesh, index out of range, repeated corner,
    /// duplicate triangle, non-manifold edge, inconsistent orientation, pinched vertex.
    pub fn new(triangles: &[[i64; 3]], count: usize) -> Result<Self> {
        let triangles = checked_indices(triangles, count)?;
        let pairs = paired_half_edges(&triangles)?;
        for (here, there) in &pairs {
            if let Some(there) = there
                && here.ascending == there.ascending
            {
                return Err(Error::InconsistentOrientation {
                    edge: here.ends,
                    triangles: [here, there].map(|half| half.corner as usize / 3),
                });
            }
        }
        let (particles, triangles) = renumbered(&triangles);
        let corner = |half: Option<HalfEdge>| half.map_or(NONE, |half| half.corner);
        let pairs: Vec<_> =
            pairs.into_iter().map(|(here, there)| [here.corner, corner(there)]).collect();
        let topology = Self::from_pairs(particles, triangles, &pairs);
        topology.check_fans()?;
        Ok(topology)
    }

    /// The present lists of a surface whose connectivity may change.
    pub fn of(triangulation: &Triangulation) -> Self {
        let pairs: Vec<_> =
            triangulation.edges().map(|half| [half, triangulation.twin(half)]).collect();
        let particles = triangulation.particles().to_vec();
        Self::from_pairs(particles, triangulation.triangles().to_vec(), &pairs)
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.particles.len()
    }

    /// The user's indices of the corners of a triangle.
    pub fn particles_of(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle].map(|v| self.particles[v as usize])
    }

    /// The range of a vertex in `corners`.
    #[inline]
    pub fn ring(&self, vertex: usize) -> Range<usize> {
        self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize
    }

    /// The range of a vertex in `vertex_edges`.
    #[inline]
    pub fn edges_at(&self, vertex: usize) -> Range<usize> {
        self.edge_offsets[vertex] as usize..self.edge_offsets[vertex + 1] as usize
    }

    /// Whether a vertex is on a border.
    #[inline]
    pub fn is_border(&self, vertex: usize) -> bool {
        self.edges_at(vertex).len() > self.ring(vertex).len()
    }

    /// For each edge its place in lexicographic order of the particles at the ends, the lower one first; [`NONE`] for those
    /// on borders.
    pub fn edge_names(&self) -> Vec<u32> {
        let ends = |edge: &u32| {
            let [a, b] = self.edges[*edge as usize].vertices;
            [a.min(b), a.max(b)]
        };
        let mut sorted: Vec<u32> = (0..self.edges.len() as u32).collect();
        sorted.sort_unstable_by_key(ends);
        let mut names = vec![NONE; self.edges.len()];
        for (name, &edge) in sorted.iter().enumerate() {
            if self.edges[edge as usize].triangles[1] != NONE {
                names[edge as usize] = name as u32;
            }
        }
        names
    }

    /// Each pair are the two half-edges of an edge, by triangle and side as a corner index, the lower one first;
    /// [`NONE`] is the second at a border.
    fn from_pairs(particles: Vec<u32>, triangles: Vec<[u32; 3]>, pairs: &[[u32; 2]]) -> Self {
        let num_vertices = particles.len();
        let mut triangle_edges = vec![[0; 3]; triangles.len()];
        let mut edges = Vec::with_capacity(pairs.len());
        for (index, &[here, there]) in pairs.iter().enumerate() {
            let mut edge = Edge { vertices: [0; 2], opposite: [NONE; 2], triangles: [NONE; 2] };
            for (place, half) in [here, there].into_iter().enumerate() {
                if half == NONE {
                    continue;
                }
                let (triangle, side) = (half as usize / 3, half as usize % 3);
                let corners = &triangles[triangle];
                triangle_edges[triangle][side] = index as u32;
                edge.opposite[place] = corners[(side + 2) % 3];
                edge.triangles[place] = triangle as u32;
                if place == 0 {
                    edge.vertices = [corners[side], corners[(side + 1) % 3]];
                }
            }
            edges.push(edge);
        }
        let corner_ends = triangles.iter().flatten().copied();
        let (offsets, corners) = incidence(num_vertices, corner_ends, 1);
        let edge_ends = edges.iter().flat_map(|edge| edge.vertices);
        let (edge_offsets, vertex_edges) = incidence(num_vertices, edge_ends, 2);
        Self {
            particles,
            triangles,
            triangle_edges,
            edges,
            offsets,
            corners,
            edge_offsets,
            vertex_edges,
        }
    }

    /// Every vertex must be surrounded by a single fan of triangles, closed unless the vertex is on a border.
    fn check_fans(&self) -> Result<()> {
        for vertex in 0..self.num_vertices() {
            let ring = self.ring(vertex);
            let start = self.corners[ring.start];
            let mut met = 1;
            // Counter-clockwise, and where that ends at a border, clockwise from the start again.
            for side in [2, 0] {
                let mut corner = self.across(start, side);
                while corner != start && corner != NONE {
                    met += 1;
                    corner = self.across(corner, side);
                }
                if corner == start {
                    break;
                }
            }
            if met != ring.len() {
                return Err(Error::NonManifoldVertex {
                    vertex: self.particles[vertex],
                    fans: self.count_fans(vertex),
                });
            }
        }
        Ok(())
    }

    /// The same vertex' corner in the triangle beyond a side: 0 is the side that leaves the corner, 2 the one that
    /// enters it.
    fn across(&self, corner: u32, side: usize) -> u32 {
        let (triangle, k) = (corner as usize / 3, corner as usize % 3);
        let edge = &self.edges[self.triangle_edges[triangle][(k + side) % 3] as usize];
        let other = edge.triangles[usize::from(edge.triangles[0] as usize == triangle)];
        if other == NONE {
            return NONE;
        }
        let vertex = self.triangles[triangle][k];
        let place = self.triangles[other as usize].iter().position(|v| *v == vertex);
        3 * other + place.expect("both triangles of an edge have its ends") as u32
    }

    /// The number of groups of triangles at a vertex that hang together by edges at this vertex.
    fn count_fans(&self, vertex: usize) -> usize {
        let mut fans: Vec<Vec<u32>> = Vec::new();
        for &edge in &self.vertex_edges[self.edges_at(vertex)] {
            let [here, there] = self.edges[edge as usize].triangles;
            let pair = if there == NONE { [here; 2] } else { [here, there] };
            let touches = |fan: &Vec<u32>| fan.contains(&pair[0]) || fan.contains(&pair[1]);
            let (joined, rest): (Vec<_>, Vec<_>) = fans.into_iter().partition(touches);
            fans = rest;
            fans.push(joined.into_iter().flatten().chain(pair).collect());
        }
        fans.len()
    }
}

/// Number the vertices from 0 without gaps, in ascending order.
fn renumbered(triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut particles: Vec<u32> = triangles.iter().flatten().copied().collect();
    particles.sort_unstable();
    particles.dedup();
    // Every index is in the list that was made from it, so the search succeeds.
    let local = |index: u32| particles.partition_point(|&particle| particle < index) as u32;
    let triangles = triangles.iter().map(|corners| corners.map(local)).collect();
    (particles, triangles)
}

/// For each vertex the items that touch it, in ascending order: `ends` lists the vertices of item 0,
/// then of item 1 and so on, `per_item` of them each. Returns the offsets and the lists end to end.
fn incidence(
    num_vertices: usize,
    ends: impl Iterator<Item = u32> + Clone,
    per_item: usize,
) -> (Vec<u32>, Vec<u32>) {
    let mut offsets = vec![0u32; num_vertices + 1];
    for vertex in ends.clone() {
        offsets[vertex as usize + 1] += 1;
    }
    for vertex in 0..num_vertices {
        offsets[vertex + 1] += offsets[vertex];
    }
    let mut next = offsets.clone();
    let mut items = vec![0; offsets[num_vertices] as usize];
    for (position, vertex) in ends.enumerate() {
        let slot = &mut next[vertex as usize];
        items[*slot as usize] = (position / per_item) as u32;
        *slot += 1;
    }
    (offsets, items)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{icosahedron, octahedron};

    #[test]
    fn icosahedron_has_euler_characteristic_two() {
        let topology = Topology::new(&icosahedron().1, 12).unwrap();
        let (v, e, f) = (topology.num_vertices(), topology.edges.len(), topology.triangles.len());
        assert_eq!((v, e, f), (12, 30, 20));
        assert!((0..12).all(|vertex| topology.ring(vertex).len() == 5));
    }

    #[test]
    fn edges_know_their_triangles() {
        let topology = Topology::new(&octahedron().1, 6).unwrap();
        for (index, edge) in topology.edges.iter().enumerate() {
            for side in 0..2 {
                let triangle = edge.triangles[side] as usize;
                assert!(topology.triangle_edges[triangle].contains(&(index as u32)));
                let corners = topology.triangles[triangle];
                let k = corners.iter().position(|&v| v == edge.opposite[side]).unwrap();
                let (start, end) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                assert_eq!([start, end], [edge.vertices[side], edge.vertices[1 - side]]);
            }
        }
    }

    #[test]
    fn gaps_in_the_indices_are_closed() {
        let triangles: Vec<_> = octahedron().1.iter().map(|t| t.map(|v| 10 * v + 3)).collect();
        let topology = Topology::new(&triangles, 54).unwrap();
        assert_eq!(topology.particles, [3, 13, 23, 33, 43, 53]);
        assert_eq!(topology.particles_of(0).map(i64::from), triangles[0]);
    }

    #[test]
    fn mistakes_name_their_culprit() {
        let good = octahedron().1;
        let broken = |change: &dyn Fn(&mut Vec<[i64; 3]>)| {
            let mut triangles = good.clone();
            change(&mut triangles);
            Topology::new(&triangles, 12).unwrap_err()
        };
        assert_eq!(broken(&|t| t.clear()), Error::EmptyMesh);
        assert_eq!(
            broken(&|t| t[2][1] = 12),
            Error::IndexOutOfRange { triangle: 2, index: 12, count: 12 }
        );
        assert_eq!(
            broken(&|t| t[2][1] = -1),
            Error::IndexOutOfRange { triangle: 2, index: -1, count: 12 }
        );
        assert!(matches!(
            broken(&|t| t[3][1] = t[3][0]),
            Error::RepeatedCorner { triangle: 3, .. }
        ));
        assert!(matches!(
            broken(&|t| t.push([t[1][1], t[1][2], t[1][0]])),
            Error::DuplicateTriangle { first: 1, second: 8, .. }
        ));
        let [a, b, _] = good[0].map(|v| v as u32);
        assert!(matches!(
            broken(&|t| t.push([t[0][0], t[0][1], 7])),
            Error::NonManifoldEdge { edge, count: 3, .. } if edge == [a.min(b), a.max(b)]
        ));
        assert!(matches!(
            broken(&|t| t[5].swap(0, 1)),
            Error::InconsistentOrientation { triangles: [_, 5], .. }
                | Error::InconsistentOrientation { triangles: [5, _], .. }
        ));
    }

    #[test]
    fn borders_have_edges_of_one_triangle() {
        let mut triangles = octahedron().1;
        let hole = triangles.remove(5).map(|vertex| vertex as u32);
        let topology = Topology::new(&triangles, 6).unwrap();
        let of_one = |edge: &&Edge| edge.triangles[1] == NONE;
        let rim: Vec<_> = topology.edges.iter().filter(of_one).collect();
        assert_eq!((topology.edges.len(), rim.len()), (12, 3));
        for edge in rim {
            assert!(edge.opposite[1] == NONE && edge.vertices.iter().all(|v| hole.contains(v)));
        }
        for vertex in 0..6 {
            assert_eq!(topology.is_border(vertex), hole.contains(&(vertex as u32)));
            assert_eq!(topology.edges_at(vertex).len(), 4);
        }
    }

    #[test]
    fn holes_that_share_a_vertex_are_pinched() {
        let mut triangles = octahedron().1;
        // Opposite to each other at vertex 0.
        triangles.remove(7);
        triangles.remove(0);
        let error = Topology::new(&triangles, 6).unwrap_err();
        assert_eq!(error, Error::NonManifoldVertex { vertex: 0, fans: 2 });
    }

    #[test]
    fn two_octahedra_that_share_a_vertex_are_pinched() {
        let mut triangles = octahedron().1;
        let second: Vec<_> =
            triangles.iter().map(|t| t.map(|v| if v == 0 { 0 } else { v + 5 })).collect();
        triangles.extend(second);
        let error = Topology::new(&triangles, 11).unwrap_err();
        assert_eq!(error, Error::NonManifoldVertex { vertex: 0, fans: 2 });
    }
}
