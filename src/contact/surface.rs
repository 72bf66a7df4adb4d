//! The repulsion of a surface; `src/potentials/surface_repulsion.rs` has the formula.

use super::block::Block;
use super::inner::arms;
use super::lists::{Lists, Pair, ascending, lowest_first};
use super::spheres::Search;
use crate::error::Result;
use crate::mesh::closest::{Arms, Nearest, crossing, edge_arms};
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::Quad;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::{Contribution, ONLY_BETWEEN_PARTS, Term, surface_repulsion};
use crate::team::{Member, Parts, Team};
use nalgebra::Matrix3;
use std::collections::HashSet;

/// A vertex and a triangle, or two edges, within reach of each other.
#[derive(Clone, Copy)]
struct Hit {
    /// Their vertices: the vertex and the corners, or the ends of both.
    vertices: [u32; 4],
    /// By how much the vector between the nearest points changes with the position of each.
    weights: [f64; 4],
    squared: f64,
    /// That vector, nm.
    separation: Vec3,
    /// From the first vertex of the second partner to that of the first, and along both edges or sides, nm.
    arms: [Vec3; 3],
    are_edges: bool,
}

/// Evaluates repulsions on one mesh.
#[derive(Default)]
pub struct SurfaceContacts {
    lists: Lists,
    cell: Option<Cell>,
    /// The connected part of each vertex, if a term asks for it.
    parts: Vec<u32>,
    /// Of vertices and triangles, and of edges, for each thread; the hits of all, one after the other, are in the order of the lists.
    hits: [Vec<Vec<Hit>>; 2],
    /// During a round of flips, the triangles and edges that are, or were, in a pair within reach.
    touched: Touched,
    /// The triangles and edges in the pairs that [`Self::around`] found last.
    last: Vec<(Pair, bool)>,
    /// Kept for their memory.
    near: Vec<u32>,
    near_edges: Vec<[u32; 2]>,
    search: Search,
}

/// Triangles from the lowest corner on, and edges from the lower end on.
#[derive(Default)]
struct Touched {
    triangles: HashSet<[u32; 3]>,
    edges: HashSet<[u32; 2]>,
}

impl Touched {
    fn clear(&mut self) {
        self.triangles.clear();
        self.edges.clear();
    }

    fn add(&mut self, [a, b, c, d]: Pair, are_edges: bool) {
        if are_edges {
            self.edges.extend([ascending(a, b), ascending(c, d)]);
        } else {
            self.triangles.insert([b, c, d]);
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
        let Some(range) = range(terms) else {
            self.lists.forget();
            return Ok(());
        };
        self.cell = cell.copied();
        let asks = |term: &&Term| term.switches & ONLY_BETWEEN_PARTS != 0;
        if !terms.iter().any(asks) {
            self.parts.clear();
        } else if self.parts.is_empty() {
            // Flips keep parts as they are.
            self.parts = mesh.parts();
        }
        self.lists.refresh(mesh, cell, positions, range, team)
    }

    /// How many pairs an evaluation looks at.
    pub fn work(&self) -> usize {
        self.lists.work()
    }

    /// Add the energies of terms at the positions of [`Self::prepare`], and forces (kJ/mol/nm) to those of all particles.
    /// A term's contributions are what `contributions` has at the same place. The virial is that of `Membrane::virial`.
    pub fn evaluate(
        &mut self,
        mesh: &Triangulation,
        terms: &[&Term],
        contributions: &mut [Contribution],
        (mut forces, mut virial): (Option<&mut [f64]>, Option<&mut Matrix3<f64>>),
        team: &mut Team,
    ) {
        let Some((reach, _)) = range(terms) else { return };
        self.find(reach, team);
        let (hits, particles) = (std::mem::take(&mut self.hits), mesh.particles());
        for hit in hits.iter().flatten().flatten() {
            let forces = (forces.as_deref_mut(), virial.as_deref_mut());
            self.add(hit, terms, contributions, forces, particles);
        }
        self.hits = hits;
    }

    /// Of the pairs of a term that the last evaluation found, the particles of the nearest one, and whether it is one of edges.
    pub fn nearest(&self, mesh: &Triangulation, term: &Term) -> Option<([u32; 4], bool)> {
        let hits = self.hits.iter().flatten().flatten();
        let acting = hits.filter(|hit| self.acts(term, hit.vertices));
        let nearest = acting.min_by(|one, other| one.squared.total_cmp(&other.squared))?;
        let particles = nearest.vertices.map(|vertex| mesh.particles()[vertex as usize]);
        Some((particles, nearest.are_edges))
    }

    /// Be ready for flips at the positions of [`Self::prepare`].
    pub fn prepare_flips(&mut self, terms: &[&Term], team: &mut Team) {
        let Some((reach, _)) = range(terms) else { return };
        self.find(reach, team);
        self.touched.clear();
        for hit in self.hits.iter().flatten().flatten() {
            self.touched.add(hit.vertices, hit.are_edges);
        }
    }

    fn find(&mut self, reach: f64, team: &mut Team) {
        for hits in &mut self.hits {
            hits.resize_with(team.size().max(hits.len()), Vec::new);
            hits.iter_mut().for_each(Vec::clear);
        }
        let mut hits = std::mem::take(&mut self.hits);
        let [of_vertices, of_edges] = &mut hits;
        let (of_vertices, of_edges) = (Parts::new(of_vertices), Parts::new(of_edges));
        let this = &*self;
        team.run(|member| {
            let place = member.index()..member.index() + 1;
            // SAFETY: each member has its own places.
            let (of_vertices, of_edges) =
                unsafe { (of_vertices.part(place.clone()), of_edges.part(place)) };
            this.find_some::<false>(reach * reach, &member, &mut of_vertices[0]);
            this.find_some::<true>(reach * reach, &member, &mut of_edges[0]);
        });
        self.hits = hits;
    }

    fn find_some<const EDGES: bool>(&self, most: f64, member: &Member, hits: &mut Vec<Hit>) {
        let (positions, pairs) = (self.lists.positions(), &self.lists.pairs()[usize::from(EDGES)]);
        let mut block = Block::<Pair, EDGES>::new([0; 4]);
        let mut note = |vertices: Pair, [squared, s, t]: [f64; 3], arms: [Vec3; 3]| {
            let [r, u, v] = arms;
            let (weights, separation) = match EDGES {
                true => ([1.0 - s, s, t - 1.0, -t], r + u * s - v * t),
                false => ([1.0, s + t - 1.0, -s, -t], r - u * s - v * t),
            };
            hits.push(Hit { vertices, weights, squared, separation, arms, are_edges: EDGES });
        };
        for &pair in &pairs[member.share(pairs.len())] {
            block.push(pair, &arms::<EDGES>(self.cell.as_ref(), positions, pair));
            if block.is_full() {
                block.find(most, &mut note);
            }
        }
        block.find(most, &mut note);
    }

    #[inline]
    fn add(
        &self,
        hit: &Hit,
        terms: &[&Term],
        contributions: &mut [Contribution],
        (mut forces, virial): (Option<&mut [f64]>, Option<&mut Matrix3<f64>>),
        particles: &[u32],
    ) {
        let [r, u, v] = &hit.arms;
        let (weight, turns) = if hit.are_edges {
            surface_repulsion::edge_weight(u, v)
        } else {
            (1.0, [Vec3::zeros(); 2])
        };
        let (mut strength, mut energy) = (0.0, 0.0);
        for (term, sum) in terms.iter().zip(contributions) {
            if self.acts(term, hit.vertices) {
                let (mut pair, slope) = surface_repulsion::pair(term, hit.squared);
                energy += pair.energy;
                strength -= 2.0 * weight * slope;
                pair.energy *= weight;
                pair.by_parameter.iter_mut().for_each(|derivative| *derivative *= weight);
                *sum += pair;
            }
        }
        if forces.is_none() && virial.is_none() {
            return;
        }
        let [turn_u, turn_v] = turns.map(|turn| turn * energy);
        // An end moves its edge forward, a beginning backward.
        let turns = [turn_u, -turn_u, turn_v, -turn_v];
        let all: [Vec3; 4] =
            std::array::from_fn(|k| hit.separation * (strength * hit.weights[k]) + turns[k]);
        if let Some(forces) = &mut forces {
            for (vertex, force) in hit.vertices.into_iter().zip(&all) {
                let slot = &mut forces[3 * particles[vertex as usize] as usize..][..3];
                slot.iter_mut().zip(force.iter()).for_each(|(sum, force)| *sum += force);
            }
        }
        if let Some(virial) = virial {
            let zero = Vec3::zeros();
            let points = if hit.are_edges { [*r, r + u, zero, *v] } else { [*r, zero, *u, *v] };
            for (force, point) in all.iter().zip(&points) {
                *virial -= force * point.transpose();
            }
        }
    }

    /// Whether a term acts between things that share no vertex; the first and the last vertex are of different ones.
    #[inline]
    fn acts(&self, term: &Term, [first, .., last]: [u32; 4]) -> bool {
        term.switches & ONLY_BETWEEN_PARTS == 0
            || self.parts[first as usize] != self.parts[last as usize]
    }

    /// Whether no flip of a quadrilateral can free energy, as nothing is near its edge and its triangles.
    pub fn is_quiet(&self, mesh: &Triangulation, quad: &Quad) -> bool {
        let [i, j, ..] = quad.vertices;
        let triangles = quad.triangles().map(|triangle| lowest_first(mesh.triangles()[triangle]));
        !self.touched.edges.contains(&ascending(i, j))
            && !triangles.iter().any(|triangle| self.touched.triangles.contains(triangle))
    }

    /// The energy, kJ/mol, of two triangles and the edge between them, as a half-edge of one of them has them now.
    pub fn around(&mut self, mesh: &Triangulation, terms: &[&Term], quad: &Quad) -> f64 {
        if terms.is_empty() {
            return 0.0;
        }
        let (mut near, mut edges) =
            (std::mem::take(&mut self.near), std::mem::take(&mut self.near_edges));
        let mut search = std::mem::take(&mut self.search);
        let (positions, cell) = (self.lists.positions(), self.cell.as_ref());
        let at = |vertex: u32| &positions[vertex as usize];
        let mut energy = 0.0;
        let mut last = std::mem::take(&mut self.last);
        last.clear();
        let mut add = |vertices: Pair, squared: f64, weight: f64, are_edges: bool| {
            let acting = terms.iter().filter(|term| self.acts(term, vertices));
            let pairs = acting.map(|term| surface_repulsion::pair(term, squared).0.energy);
            energy += weight * pairs.sum::<f64>();
            last.push((vertices, are_edges));
        };
        for triangle in quad.triangles() {
            let corners = lowest_first(mesh.triangles()[triangle]);
            self.lists.vertices_near_now(corners, &mut search, &mut near);
            for &vertex in &near {
                let Nearest { squared, .. } =
                    Arms::new(cell, at(vertex), corners.map(at)).nearest();
                add([vertex, corners[0], corners[1], corners[2]], squared, 1.0, false);
            }
        }
        let [i, j, ..] = quad.vertices;
        self.lists.edges_near_now([i, j], &mut search, &mut edges);
        for &[p, q] in &edges {
            let [_, u, v] = edge_arms(cell, [at(i), at(j)], [at(p), at(q)]);
            let squared = crossing(cell, [at(i), at(j)], [at(p), at(q)]).squared;
            add([i, j, p, q], squared, surface_repulsion::edge_weight(&u, &v).0, true);
        }
        (self.near, self.near_edges, self.last) = (near, edges, last);
        self.search = search;
        energy
    }

    /// Replace the edge ij of a quadrilateral by kl.
    pub fn follow(&mut self, quad: &Quad) {
        self.lists.follow(quad);
    }

    /// Keep what [`Self::around`] found last, since its flip has been made.
    pub fn note_new_pairs(&mut self) {
        for (pair, are_edges) in &self.last {
            self.touched.add(*pair, *are_edges);
        }
    }

    /// Forget all positions and triangles.
    pub fn forget(&mut self) {
        self.lists.forget();
    }
}
