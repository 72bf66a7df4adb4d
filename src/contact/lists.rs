//! Which vertices may touch which triangles of a surface, and which edges which edges.
//!
//! The lists have the pairs that are nearer than reach + skin at the positions of the **reference**, in ascending order,
//! but for those that share a vertex. They are good until a vertex has moved by half of the skin, or
//! the connectivity has changed. While flips go on, grids of the reference find what is near a triangle or an edge.

use super::block::Block;
use super::closest::{Arms, crossing, difference, edge_arms};
use super::grid::{Grid, bounds};
use crate::error::{Error, Result};
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::{Quad, next};
use crate::mesh::{Cell, Triangulation};
use crate::team::{Parts, Team};
use std::ops::Range;

/// The skin as a share of the reach, at first, at least and at most. Thicker ones are renewed less often, but have more
/// pairs in them.
const SKIN: [f64; 3] = [1.0, 0.05, 4.0];

/// What it costs to make lists, by triangle or edge, in looks at a pair: the skin grows until both cost the same.
const MAKING: f64 = 60.0;

/// After so many flips the edges are sorted into boxes anew.
const MOST_NEW: usize = 200;

/// Lists for one mesh.
#[derive(Default)]
pub struct Lists {
    made_for: Option<Made>,
    /// As a share of the reach, once it is known.
    skin: Option<f64>,
    /// How many evaluations the lists have served.
    served: u32,
    /// All vertices as they are now.
    positions: Vec<Vec3>,
    reference: Vec<Vec3>,
    /// The reference's vertices and edges.
    vertex_grid: Grid,
    edge_grid: Grid,
    /// The ends of each edge. One that a flip has taken away has the same end twice; those that flips have made are behind
    /// `known`, and not in the grid.
    edges: Vec<[u32; 2]>,
    known: usize,
    /// For each vertex the connected part that it is on; empty unless that matters.
    parts: Vec<u32>,
    /// Triangles with vertices, and edges with edges, ascending.
    pairs: [Vec<[u32; 2]>; 2],
    /// Whether each vertex takes part in any pair.
    listed: Vec<bool>,
    /// Whether flips have made pairs that are in no list.
    has_new_pairs: bool,
    /// Whether the edges may have other places than the pairs know; flips that are taken back move them, too.
    has_followed: bool,
    /// One for each thread; kept for their memory.
    scratch: Vec<[Vec<[u32; 2]>; 2]>,
}

/// What lists depend on, beside the reference.
#[derive(Clone, Copy, PartialEq)]
struct Made {
    reach: f64,
    between_parts: bool,
    cell: Option<Cell>,
    fingerprint: u64,
    /// nm.
    skin: f64,
}

impl Lists {
    /// Be good for pairs up to `reach` at some positions of all particles; with `between_parts` only for those of
    /// different parts of the surface.
    ///
    /// # Errors
    /// A position that is not finite; a box that is too small.
    pub fn refresh(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        positions: &[f64],
        (reach, between_parts): (f64, bool),
        team: &mut Team,
    ) -> Result<()> {
        let fingerprint = mesh.fingerprint();
        let share = self.skin.unwrap_or(SKIN[0]);
        let (cell_now, skin) = (cell.copied(), share * reach);
        let mut wanted = Made { reach, between_parts, cell: cell_now, fingerprint, skin };
        let particles = mesh.particles();
        let at = |particle: u32| Vec3::from_column_slice(&positions[3 * particle as usize..][..3]);
        self.positions.clear();
        self.positions.extend(particles.iter().map(|particle| at(*particle)));
        // Lists of a longer reach are good, too: force groups may take turns.
        let good = self.made_for.filter(|made| {
            let Made { reach, between_parts, cell, fingerprint, .. } = *made;
            !self.has_followed
                && reach >= wanted.reach
                && between_parts <= wanted.between_parts
                && (cell, fingerprint) == (wanted.cell, wanted.fingerprint)
        });
        if let Some(made) = good {
            let pairs = self.positions.iter().zip(&self.reference);
            let farthest = pairs.fold(0.0, |farthest: f64, (now, then)| {
                let moved = (now - then).norm_squared();
                // What is no number counts as far.
                if moved <= farthest { farthest } else { moved }
            });
            if farthest < 0.25 * made.skin * made.skin {
                self.served += 1;
                return Ok(());
            }
            let elements = mesh.triangles().len() + self.edges.len();
            let making = MAKING * elements as f64 / f64::from(self.served + 1);
            let looking = (self.pairs[0].len() + self.pairs[1].len()) as f64;
            let share = share * if making > looking { 1.25 } else { 0.8 };
            let share = share.clamp(SKIN[1], SKIN[2]);
            self.skin = Some(share);
            wanted.skin = share * reach;
        }
        self.made_for = None;
        for (position, particle) in self.positions.iter().zip(particles) {
            if !position.iter().all(|x| x.is_finite()) {
                let (particle, position) = (*particle, (*position).into());
                return Err(Error::NonFinitePosition { particle, position });
            }
        }
        if let Some(cell) = cell
            && reach + wanted.skin >= cell.half_width()
        {
            return Err(Error::Contract(format!(
                "the repulsion reaches {reach} nm, which with some margin is more than half of the periodic box; make \
                 the distance smaller or the box larger"
            )));
        }
        self.make(mesh, wanted, team);
        self.served = 0;
        self.made_for = Some(wanted);
        Ok(())
    }

    /// Know nothing.
    pub fn forget(&mut self) {
        self.made_for = None;
    }

    /// All vertices at the last refresh.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Pairs of a triangle and a vertex.
    pub fn vertex_pairs(&self) -> &[[u32; 2]] {
        &self.pairs[0]
    }

    /// Pairs of edges.
    pub fn edge_pairs(&self) -> &[[u32; 2]] {
        &self.pairs[1]
    }

    /// The ends of an edge.
    #[inline]
    pub fn ends(&self, edge: u32) -> [u32; 2] {
        self.edges[edge as usize]
    }

    /// Whether any of some vertices may be near something.
    pub fn has_any(&self, vertices: &[u32]) -> bool {
        self.has_new_pairs || vertices.iter().any(|vertex| self.listed[*vertex as usize])
    }

    /// Whether two vertices are on the same part; false unless lists are between parts.
    #[inline]
    fn are_one_part(&self, one: u32, other: u32) -> bool {
        !self.parts.is_empty() && self.parts[one as usize] == self.parts[other as usize]
    }

    fn make(&mut self, mesh: &Triangulation, wanted: Made, team: &mut Team) {
        let range = wanted.reach + wanted.skin;
        self.reference.clone_from(&self.positions);
        self.parts = if wanted.between_parts { mesh.parts() } else { Vec::new() };
        self.edges.clear();
        self.edges.extend(mesh.edges().map(|half| [mesh.origin(half), mesh.origin(next(half))]));
        let (cell, around) = (wanted.cell.as_ref(), bounds(&self.reference));
        self.vertex_grid.set_up(cell, around, range, 8 * mesh.num_vertices());
        for (vertex, position) in self.reference.iter().enumerate() {
            self.vertex_grid.add(vertex as u32, position);
        }
        self.vertex_grid.seal();
        self.sort_edges(&wanted);
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.resize_with(team.size(), Default::default);
        let all_scratch = Parts::new(&mut scratch);
        let this = &*self;
        team.run(|member| {
            // SAFETY: each member has its own place.
            let scratch = unsafe { all_scratch.part(member.index()..member.index() + 1) };
            let [vertices, edges] = &mut scratch[0];
            vertices.clear();
            edges.clear();
            for triangle in member.share(mesh.triangles().len()) {
                let (start, corners) = (vertices.len(), mesh.triangles()[triangle]);
                let near = |vertex| vertices.push([triangle as u32, vertex]);
                this.vertices_near(&wanted, &this.reference, corners, range, near);
                vertices[start..].sort_unstable();
            }
            this.pair_edges(&wanted, member.share(this.edges.len()), range, edges);
        });
        for (kind, pairs) in self.pairs.iter_mut().enumerate() {
            pairs.clear();
            scratch.iter().for_each(|found| pairs.extend_from_slice(&found[kind]));
        }
        self.scratch = scratch;
        (self.has_new_pairs, self.has_followed) = (false, false);
        self.listed.clear();
        self.listed.resize(mesh.num_vertices(), false);
        let mut note = |vertex: u32| self.listed[vertex as usize] = true;
        for [triangle, vertex] in &self.pairs[0] {
            note(*vertex);
            mesh.triangles()[*triangle as usize].into_iter().for_each(&mut note);
        }
        for edge in self.pairs[1].as_flattened() {
            self.edges[*edge as usize].into_iter().for_each(&mut note);
        }
    }

    /// Sort all edges into boxes.
    fn sort_edges(&mut self, made: &Made) {
        let (cell, around) = (made.cell.as_ref(), bounds(&self.reference));
        let range = made.reach + made.skin;
        self.edges.retain(|[start, end]| start != end);
        self.known = self.edges.len();
        self.edge_grid.set_up(cell, around, range, 4 * self.edges.len());
        for (edge, ends) in self.edges.iter().enumerate() {
            let [start, end] = ends.map(|end| &self.reference[end as usize]);
            let points = [*start, start + difference(cell, end, start)];
            self.edge_grid.add_around(edge as u32, &points, 0.0);
        }
        self.edge_grid.seal();
    }

    /// Add pairs of some edges and later ones that are nearer than `range` at the reference's positions.
    fn pair_edges(&self, made: &Made, share: Range<usize>, range: f64, pairs: &mut Vec<[u32; 2]>) {
        let cell = made.cell.as_ref();
        let at = |vertex: u32| &self.reference[vertex as usize];
        let spheres: Vec<(Vec3, f64)> = self
            .edges
            .iter()
            .map(|[start, end]| {
                let half = difference(cell, at(*end), at(*start)) * 0.5;
                (at(*start) + half, half.norm())
            })
            .collect();
        let mut block = Block::<[u32; 2], true>::new([0; 2]);
        // For each edge the last one that has met it: an edge may be in several boxes.
        let mut met = vec![u32::MAX; self.edges.len()];
        let most = range * range;
        for edge in share {
            let (start, number, ends) = (pairs.len(), edge as u32, self.edges[edge]);
            let (middle, half) = &spheres[edge];
            let [p, p_end] = ends.map(at);
            let points = [*p, p + difference(cell, p_end, p)];
            self.edge_grid.near(&points, range, |other| {
                if other <= number || met[other as usize] == number {
                    return;
                }
                met[other as usize] = number;
                let (its_middle, its_half) = &spheres[other as usize];
                let far = range + half + its_half;
                let [c, d] = self.edges[other as usize];
                if difference(cell, its_middle, middle).norm_squared() < far * far
                    && !ends.contains(&c)
                    && !ends.contains(&d)
                    && !self.are_one_part(c, ends[0])
                {
                    block.push([number, other], &edge_arms(cell, [p, p_end], [at(c), at(d)]));
                    if block.is_full() {
                        block.find(most, |pair, _, _| pairs.push(pair));
                    }
                }
            });
            block.find(most, |pair, _, _| pairs.push(pair));
            pairs[start..].sort_unstable();
        }
    }

    /// The vertices nearer than `range` to a triangle, in any order, but for its corners.
    fn vertices_near(
        &self,
        made: &Made,
        positions: &[Vec3],
        corners: [u32; 3],
        range: f64,
        mut visit: impl FnMut(u32),
    ) {
        let cell = made.cell.as_ref();
        let [a, b, c] = corners.map(|corner| &positions[corner as usize]);
        let points = [*a, a + difference(cell, b, a), a + difference(cell, c, a)];
        let middle = (points[0] + points[1] + points[2]) / 3.0;
        let size = points.iter().fold(0.0, |size: f64, p| size.max((p - middle).norm_squared()));
        let most = (range + size.sqrt()).powi(2);
        // Vertices that have moved since the grid was made are not farther than half of the skin from there.
        let margin = 0.5 * made.skin;
        self.vertex_grid.near(&points, range.min(made.reach + margin) + margin, |vertex| {
            let position = &positions[vertex as usize];
            if difference(cell, position, &middle).norm_squared() < most
                && !corners.contains(&vertex)
                && !self.are_one_part(vertex, corners[0])
                && Arms::new(cell, position, points.each_ref()).nearest().squared < range * range
            {
                visit(vertex);
            }
        });
    }

    /// The edges nearer than `range` to an edge, each once, in any order, but for those that share an end.
    fn edges_near(
        &self,
        made: &Made,
        positions: &[Vec3],
        ends: [u32; 2],
        range: f64,
        mut visit: impl FnMut(u32),
    ) {
        let cell = made.cell.as_ref();
        let [start, end] = ends.map(|end| &positions[end as usize]);
        let points = [*start, start + difference(cell, end, start)];
        let (middle, half) = ((points[0] + points[1]) * 0.5, 0.5 * (points[1] - points[0]).norm());
        let mut found: smallvec::SmallVec<[u32; 64]> = smallvec::SmallVec::new();
        let mut look = |edge: u32| {
            let [from, to] = self.edges[edge as usize];
            if ends.contains(&from)
                || ends.contains(&to)
                || from == to
                || self.are_one_part(from, ends[0])
            {
                return;
            }
            let [p, q] = [from, to].map(|end| &positions[end as usize]);
            let along = difference(cell, q, p);
            let away = difference(cell, &(p + along * 0.5), &middle).norm_squared();
            let most = range + half + 0.5 * along.norm();
            if away < most * most
                && crossing(cell, [p, q], [start, end]).squared < range * range
                && !found.contains(&edge)
            {
                found.push(edge);
                visit(edge);
            }
        };
        let margin = 0.5 * made.skin;
        let reach = range.min(made.reach + margin) + margin;
        self.edge_grid.near(&points, reach, &mut look);
        (self.known..self.edges.len()).for_each(|edge| look(edge as u32));
    }

    /// The vertices within reach of a triangle at present, ascending.
    pub fn vertices_near_now(&self, corners: [u32; 3], found: &mut Vec<u32>) {
        found.clear();
        let Some(made) = self.made_for else { return };
        self.vertices_near(&made, &self.positions, corners, made.reach, |vertex| {
            found.push(vertex)
        });
        found.sort_unstable();
    }

    /// The ends of all edges within reach of an edge at present, ascending.
    pub fn edges_near_now(&self, ends: [u32; 2], found: &mut Vec<[u32; 2]>) {
        found.clear();
        let Some(made) = self.made_for else { return };
        let visit = |edge: u32| found.push(self.edges[edge as usize]);
        self.edges_near(&made, &self.positions, ends, made.reach, visit);
        found.sort_unstable();
    }

    /// What flips have made is near something.
    pub fn note_new_pairs(&mut self) {
        self.has_new_pairs = true;
    }

    /// Have kl in place of ij.
    pub fn follow(&mut self, quad: &Quad) {
        let Some(made) = self.made_for else { return };
        self.has_followed = true;
        let [i, j, k, l] = quad.vertices;
        let mut gone = None;
        let is_gone = |ends: &[u32; 2]| *ends == [i, j] || *ends == [j, i];
        let points = [self.reference[i as usize]];
        self.edge_grid.near(&points, 0.0, |edge| {
            if is_gone(&self.edges[edge as usize]) {
                gone = Some(edge as usize);
            }
        });
        let new = self.edges[self.known..].iter().position(is_gone);
        if let Some(place) = new {
            self.edges[self.known + place] = [k, l];
            return;
        }
        if let Some(edge) = gone {
            self.edges[edge] = [i, i];
        }
        self.edges.push([k, l]);
        if self.edges.len() > self.known + MOST_NEW {
            self.sort_edges(&made);
        }
    }
}
