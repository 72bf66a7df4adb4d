//! The connected parts of a surface, and whether another has the same.

use super::topology::NONE;
use super::triangulation::{Triangulation, next};
use crate::error::{Error, Result};

impl Triangulation {
    /// Refuse a surface whose connected parts have other vertices, or other numbers of triangles, or whose borders have
    /// other edges. For each part V − E + F with E = (3F + B)/2 is then the same, hence its genus.
    pub(super) fn compare_parts(&self, other: &Self) -> Result<()> {
        self.compare_borders(other)?;
        let (mine, theirs) = (self.parts(), other.parts());
        if let Some(vertex) = (0..mine.len()).find(|vertex| mine[*vertex] != theirs[*vertex]) {
            // One of the two parts has a smaller first vertex, which the vertex has left or come to.
            let first = self.particles()[mine[vertex].min(theirs[vertex]) as usize];
            let now = if mine[vertex] < theirs[vertex] { "no longer" } else { "now" };
            return Err(Error::Contract(format!(
                "connectivity changes, but not topology: with the new triangles particle {} is {now} on the same \
                 connected part of the surface as particle {first}",
                self.particles()[vertex]
            )));
        }
        let count = |mesh: &Self, parts: &[u32]| {
            let mut counts = vec![0; parts.len()];
            for triangle in mesh.triangles() {
                counts[parts[triangle[0] as usize] as usize] += 1;
            }
            counts
        };
        let (before, after) = (count(self, &mine), count(other, &theirs));
        match (0..before.len()).find(|vertex| before[*vertex] != after[*vertex]) {
            None => Ok(()),
            Some(vertex) => Err(Error::Contract(format!(
                "connectivity changes, but not topology: the connected part of the surface with particle {} has {} \
                 triangles, and would have {}, with another number of handles",
                self.particles()[vertex],
                before[vertex],
                after[vertex]
            ))),
        }
    }

    fn compare_borders(&self, other: &Self) -> Result<()> {
        let borders = [self, other].map(|mesh| {
            let edges = mesh.edges().filter(|half| mesh.twin(*half) == NONE);
            let ends = edges.map(|half| [mesh.origin(half), mesh.origin(next(half))]);
            let mut ends: Vec<_> = ends.map(|[a, b]| [a.min(b), a.max(b)]).collect();
            ends.sort_unstable();
            ends
        });
        let (was, is) = ("is a border, and would no longer be one", "would become a border");
        for (here, change) in [(0, was), (1, is)] {
            let there = &borders[1 - here];
            let is_new = |ends: &&[u32; 2]| there.binary_search(ends).is_err();
            if let Some(ends) = borders[here].iter().find(is_new) {
                let [a, b] = ends.map(|vertex| self.particles()[vertex as usize]);
                return Err(Error::Contract(format!(
                    "connectivity changes, but not topology: the edge of particles {a} and {b} {change}"
                )));
            }
        }
        Ok(())
    }

    /// For each vertex the lowest vertex of the connected part that it is on.
    pub(crate) fn parts(&self) -> Vec<u32> {
        let mut parts = vec![u32::MAX; self.num_vertices()];
        let (mut neighbours, mut waiting) = (Vec::new(), Vec::new());
        for first in 0..parts.len() {
            if parts[first] != u32::MAX {
                continue;
            }
            parts[first] = first as u32;
            waiting.push(first as u32);
            while let Some(vertex) = waiting.pop() {
                self.neighbours(vertex, &mut neighbours);
                for &neighbour in &neighbours {
                    if parts[neighbour as usize] == u32::MAX {
                        parts[neighbour as usize] = first as u32;
                        waiting.push(neighbour);
                    }
                }
            }
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Topology;

    /// The octahedron of some particles, counter-clockwise: the first is opposite to the fourth, and so on.
    fn octahedron_of([a, b, c, d, e, f]: [i64; 6]) -> Vec<[i64; 3]> {
        [[a, b, c], [b, d, c], [d, e, c], [e, a, c], [b, a, f], [d, b, f], [e, d, f], [a, e, f]]
            .to_vec()
    }

    /// The torus of nine particles, three around and three along.
    fn torus(first: i64) -> Vec<[i64; 3]> {
        let at = |i: i64, j: i64| first + 3 * (i % 3) + j % 3;
        let squares = (0..9).map(|n| (n / 3, n % 3));
        squares
            .flat_map(|(i, j)| {
                let (p, q, r, s) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                [[p, q, r], [p, r, s]]
            })
            .collect()
    }

    fn refused(old: &[[i64; 3]], new: &[[i64; 3]]) -> String {
        let count = old.as_flattened().iter().max().unwrap() + 1;
        let mesh = Triangulation::new(&Topology::new(old, count as usize).unwrap());
        mesh.with_triangles(old).unwrap();
        mesh.with_triangles(new).unwrap_err().to_string()
    }

    #[test]
    fn particles_stay_on_their_part_of_the_surface() {
        let two = [octahedron_of([0, 1, 2, 3, 4, 5]), octahedron_of([6, 7, 8, 9, 10, 11])].concat();
        let mixed =
            [octahedron_of([0, 1, 2, 3, 4, 11]), octahedron_of([6, 7, 8, 9, 10, 5])].concat();
        let words = refused(&two, &mixed);
        assert!(
            words.contains("particle 5 is no longer") && words.contains("as particle 0"),
            "{words}"
        );
        let words = refused(&mixed, &two);
        assert!(words.contains("particle 5 is now") && words.contains("as particle 0"), "{words}");
    }

    #[test]
    fn borders_keep_their_edges() {
        // Without a triangle, and without another one.
        let whole = octahedron_of([0, 1, 2, 3, 4, 5]);
        let (mut one, mut other) = (whole.clone(), whole);
        let hole = one.remove(0);
        other.remove(6);
        let words = refused(&one, &other);
        let named = [0, 1, 2].map(|k| {
            let (a, b) = (hole[k], hole[(k + 1) % 3]);
            format!("particles {} and {} is a border", a.min(b), a.max(b))
        });
        assert!(named.iter().any(|name| words.contains(name)), "{words}");
    }

    #[test]
    fn parts_keep_their_handles() {
        // A sphere of nine vertices has 14 triangles, a torus 18.
        let mut sphere = octahedron_of([0, 1, 2, 3, 4, 5]);
        for apex in 6..9 {
            let [a, b, c] = sphere[0];
            sphere[0] = [a, b, apex];
            sphere.extend([[b, c, apex], [c, a, apex]]);
        }
        let moved: Vec<_> = sphere.iter().map(|triangle| triangle.map(|v| v + 9)).collect();
        let old = [sphere, torus(9)].concat();
        let new = [torus(0), moved].concat();
        let words = refused(&old, &new);
        assert!(words.contains("with particle 0 has 14 triangles, and would have 18"), "{words}");
    }
}
