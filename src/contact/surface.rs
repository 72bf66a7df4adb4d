//! The repulsion of a surface's vertices and triangles; `src/potentials/surface_repulsion.rs` has the formula.

use super::closest::{Arms, BLOCK, Nearest, nearest};
use super::lists::{Lists, each_leaving, is_excluded};
use crate::dynamics::instructions::{Arithmetic, Kernel, run};
use crate::error::Result;
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::Quad;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::{Contribution, ONLY_BETWEEN_PARTS, Term, surface_repulsion};
use crate::team::{Parts, Team};

/// A vertex and a triangle within reach of each other.
#[derive(Clone, Copy)]
struct Hit {
    triangle: u32,
    vertex: u32,
    nearest: Nearest,
    /// From the triangle to the vertex, nm.
    separation: Vec3,
}

/// Evaluates repulsions on one mesh.
#[derive(Default)]
pub struct SurfaceContacts {
    lists: Lists,
    cell: Option<Cell>,
    /// The connected part of each vertex, if a term asks for it.
    parts: Vec<u32>,
    /// One for each thread; the hits of all, one after the other, are in the order of triangles and then vertices.
    hits: Vec<Vec<Hit>>,
    /// Kept for its memory.
    near: Vec<u32>,
}

/// Pairs whose nearest points are found together.
struct Block {
    pairs: [(u32, u32); BLOCK],
    arms: [[f64; BLOCK]; 9],
    nearest: [[f64; BLOCK]; 3],
    count: usize,
}

impl Block {
    const EMPTY: Self = Self {
        pairs: [(0, 0); BLOCK],
        arms: [[0.0; BLOCK]; 9],
        nearest: [[0.0; BLOCK]; 3],
        count: 0,
    };

    #[inline]
    fn push(&mut self, pair: (u32, u32), arms: &Arms) {
        let Arms { point, sides: [u, v] } = arms;
        self.pairs[self.count] = pair;
        for (k, x) in point.iter().chain(u).chain(v).enumerate() {
            self.arms[k][self.count] = *x;
        }
        self.count += 1;
    }

    /// Note the hits among the pairs, and forget them.
    fn find(&mut self, reach_squared: f64, hits: &mut Vec<Hit>) {
        run(Together(self));
        let arm = |k: usize, n: usize| Vec3::new(self.arms[k][n], self.arms[k + 1][n], self.arms[k + 2][n]);
        for n in 0..self.count {
            let [squared, s, t] = self.nearest.map(|values| values[n]);
            // What is no number is a hit, which will be refused.
            if squared >= reach_squared {
                continue;
            }
            let (triangle, vertex) = self.pairs[n];
            let nearest = Nearest { squared, s, t };
            let separation = Arms { point: arm(0, n), sides: [arm(3, n), arm(6, n)] }.separation(&nearest);
            hits.push(Hit { triangle, vertex, nearest, separation });
        }
        self.count = 0;
    }
}

/// The nearest points of a block.
struct Together<'a>(&'a mut Block);

impl Kernel for Together<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let Block { arms: [rx, ry, rz, ux, uy, uz, vx, vy, vz], nearest: out, .. } = self.0;
        for n in 0..BLOCK {
            let found = nearest([rx[n], ry[n], rz[n]], [ux[n], uy[n], uz[n]], [vx[n], vy[n], vz[n]]);
            out[0][n] = found.squared;
            out[1][n] = found.s;
            out[2][n] = found.t;
        }
    }
}

/// How far the terms reach, nm, and whether all of them act between parts only; none if there are no terms.
fn range(terms: &[&Term]) -> Option<(f64, bool)> {
    let reach = terms.iter().map(|term| term.values[0]).reduce(f64::max)?;
    Some((reach, terms.iter().all(|term| term.switches & ONLY_BETWEEN_PARTS != 0)))
}

impl SurfaceContacts {
    /// Be ready for some positions.
    ///
    /// # Errors
    /// Those of [`Lists::refresh`].
    pub fn prepare(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        terms: &[&Term],
        positions: &[f64],
        team: &mut Team,
    ) -> Result<()> {
        let Some(range) = range(terms) else { return Ok(()) };
        self.cell = cell.copied();
        let asks = |term: &&Term| term.switches & ONLY_BETWEEN_PARTS != 0;
        if !terms.iter().any(asks) || range.1 {
            // Lists between parts have no other pairs.
            self.parts.clear();
        } else if self.parts.is_empty() {
            self.parts = mesh.parts();
        }
        self.lists.refresh(mesh, cell, positions, range, team)
    }

    /// About how many pairs an evaluation looks at.
    pub fn work(&self) -> usize {
        self.lists.busy().len() * 4
    }

    /// Add the energies of terms at the positions of [`Self::prepare`], and forces (kJ/mol/nm) to those of all particles.
    /// A term's contributions are what `contributions` finds at the same place.
    pub fn evaluate(
        &mut self,
        mesh: &Triangulation,
        terms: &[&Term],
        contributions: &mut [Contribution],
        mut forces: Option<&mut [f64]>,
        team: &mut Team,
    ) {
        let Some((reach, _)) = range(terms) else { return };
        self.hits.resize_with(team.size().max(self.hits.len()), Vec::new);
        self.hits.iter_mut().for_each(Vec::clear);
        let hits = Parts::new(&mut self.hits);
        let (lists, cell) = (&self.lists, self.cell.as_ref());
        team.run(|member| {
            // SAFETY: each member has its own place.
            let hits = &mut unsafe { hits.part(member.index()..member.index() + 1) }[0];
            let positions = lists.positions();
            let mut block = Block::EMPTY;
            for &triangle in &lists.busy()[member.share(lists.busy().len())] {
                let corners = mesh.triangles()[triangle as usize].map(|v| &positions[v as usize]);
                for &vertex in lists.of(triangle) {
                    let arms = Arms::new(cell, &positions[vertex as usize], corners);
                    block.push((triangle, vertex), &arms);
                    if block.count == BLOCK {
                        block.find(reach * reach, hits);
                    }
                }
            }
            block.find(reach * reach, hits);
        });
        let particles = mesh.particles();
        for hit in self.hits.iter().flatten() {
            let corners = mesh.triangles()[hit.triangle as usize];
            let mut strength = 0.0;
            for (term, sum) in terms.iter().zip(&mut *contributions) {
                if self.acts(term, hit.vertex, corners) {
                    let (contribution, slope) = surface_repulsion::pair(term, hit.nearest.squared);
                    *sum += contribution;
                    strength -= 2.0 * slope;
                }
            }
            let Some(forces) = &mut forces else { continue };
            let force = hit.separation * strength;
            let Nearest { s, t, .. } = hit.nearest;
            let [a, b, c] = corners;
            for (vertex, weight) in [(hit.vertex, 1.0), (a, s + t - 1.0), (b, -s), (c, -t)] {
                let slot = &mut forces[3 * particles[vertex as usize] as usize..][..3];
                for (sum, force) in slot.iter_mut().zip(force.iter()) {
                    *sum += weight * force;
                }
            }
        }
    }

    /// Whether a term acts between a vertex and a triangle that are not excluded.
    #[inline]
    fn acts(&self, term: &Term, vertex: u32, corners: [u32; 3]) -> bool {
        term.switches & ONLY_BETWEEN_PARTS == 0
            || self.parts.is_empty()
            || self.parts[vertex as usize] != self.parts[corners[0] as usize]
    }

    /// Whether no flip of a quadrilateral can free energy, as nothing is near it.
    pub fn is_quiet(&self, quad: &Quad) -> bool {
        let [_, _, k, l] = quad.vertices;
        let empty = |triangle: usize| self.lists.of(triangle as u32).is_empty();
        quad.triangles().into_iter().all(empty) && !self.lists.has(k) && !self.lists.has(l)
    }

    /// The energy, kJ/mol, of all pairs that a flip makes or ends, as the mesh is now: before it or after it. `changed`
    /// are the two triangles that it replaces, `vertices` i, j, k and l.
    pub fn around(
        &mut self,
        mesh: &Triangulation,
        terms: &[&Term],
        changed: [usize; 2],
        [i, j, k, l]: [u32; 4],
    ) -> f64 {
        if terms.is_empty() {
            return 0.0;
        }
        let mut near = std::mem::take(&mut self.near);
        let mut energy = 0.0;
        for triangle in changed {
            self.lists.near_now(mesh, triangle as u32, &mut near);
            for &vertex in &near {
                energy += self.pair(mesh, terms, vertex, triangle as u32);
            }
        }
        for (vertex, corner) in [(k, l), (l, k), (i, j), (j, i)] {
            each_leaving(mesh, corner, |half| {
                let triangle = half / 3;
                let corners = mesh.triangles()[triangle as usize];
                if !changed.contains(&(triangle as usize)) && !is_excluded(mesh, vertex, corners) {
                    energy += self.pair(mesh, terms, vertex, triangle);
                }
            });
        }
        self.near = near;
        energy
    }

    fn pair(&self, mesh: &Triangulation, terms: &[&Term], vertex: u32, triangle: u32) -> f64 {
        let positions = self.lists.positions();
        let corners = mesh.triangles()[triangle as usize];
        let at = corners.map(|corner| &positions[corner as usize]);
        let nearest = Arms::new(self.cell.as_ref(), &positions[vertex as usize], at).nearest();
        let acting = terms.iter().filter(|term| self.acts(term, vertex, corners));
        acting.map(|term| surface_repulsion::pair(term, nearest.squared).0.energy).sum()
    }

    /// Follow a flip, which `mesh` has made; `quad` is as it was before.
    pub fn follow(&mut self, mesh: &Triangulation, quad: &Quad) {
        self.lists.follow(mesh, quad);
    }
}
