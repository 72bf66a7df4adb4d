//! The repulsion of a surface; `src/potentials/surface_repulsion.rs` has the formula.

use super::block::Block;
use super::closest::{Arms, Nearest, crossing, edge_arms};
use super::lists::Lists;
use crate::error::Result;
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::Quad;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::{Contribution, ONLY_BETWEEN_PARTS, Term, surface_repulsion};
use crate::team::{Member, Parts, Team};
use nalgebra::Matrix3;

/// A vertex and a triangle, or two edges, within reach of each other.
#[derive(Clone, Copy)]
struct Hit {
    /// Their vertices: the vertex and the corners, or the ends of both.
    vertices: [u32; 4],
    /// How much each of them moves the way between the nearest points.
    weights: [f64; 4],
    squared: f64,
    /// The way, nm.
    separation: Vec3,
    /// The way along the edges, zero for a vertex and a triangle.
    edges: [Vec3; 2],
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
    /// Kept for their memory.
    near: Vec<u32>,
    near_edges: Vec<[u32; 2]>,
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
        self.lists.vertex_pairs().len() + self.lists.edge_pairs().len()
    }

    /// Add the energies of terms at the positions of [`Self::prepare`], and forces (kJ/mol/nm) to those of all particles.
    /// A term's contributions are what `contributions` has at the same place.
    pub fn evaluate(
        &mut self,
        mesh: &Triangulation,
        terms: &[&Term],
        contributions: &mut [Contribution],
        mut forces: Option<&mut [f64]>,
        team: &mut Team,
    ) {
        let Some((reach, _)) = range(terms) else { return };
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
            this.find_vertices(mesh, reach * reach, &member, &mut of_vertices[0]);
            this.find_edges(reach * reach, &member, &mut of_edges[0]);
        });
        let particles = mesh.particles();
        for hit in hits.iter().flatten().flatten() {
            self.add(hit, terms, contributions, forces.as_deref_mut(), particles);
        }
        self.hits = hits;
    }

    /// ∂E/∂ε of what [`Self::evaluate`] has found, for a homogeneous strain ε, kJ/mol.
    pub fn virial(&self, terms: &[&Term]) -> Matrix3<f64> {
        let mut virial = Matrix3::zeros();
        for Hit { vertices, squared, separation, edges: [u, v], .. } in
            self.hits.iter().flatten().flatten()
        {
            let of_edges = *u != Vec3::zeros();
            let (weight, [by_u, by_v]) = if of_edges {
                surface_repulsion::edge_weight(u, v)
            } else {
                (1.0, [Vec3::zeros(); 2])
            };
            let turn = by_u * u.transpose() + by_v * v.transpose();
            for term in terms.iter().filter(|term| self.acts(term, *vertices)) {
                let (pair, slope) = surface_repulsion::pair(term, *squared);
                virial += separation * separation.transpose() * (2.0 * weight * slope);
                virial += turn * pair.energy;
            }
        }
        virial
    }

    fn find_vertices(&self, mesh: &Triangulation, most: f64, member: &Member, hits: &mut Vec<Hit>) {
        let (positions, pairs) = (self.lists.positions(), self.lists.vertex_pairs());
        let mut block = Block::<[u32; 4], false>::new([0; 4]);
        let mut note = |vertices: [u32; 4], [squared, s, t]: [f64; 3], [r, u, v]: [Vec3; 3]| {
            let (weights, separation) = ([1.0, s + t - 1.0, -s, -t], r - u * s - v * t);
            let edges = [Vec3::zeros(); 2];
            hits.push(Hit { vertices, weights, squared, separation, edges });
        };
        for &[triangle, vertex] in &pairs[member.share(pairs.len())] {
            let [a, b, c] = mesh.triangles()[triangle as usize];
            let corners = [a, b, c].map(|corner| &positions[corner as usize]);
            let Arms { point, sides: [u, v] } =
                Arms::new(self.cell.as_ref(), &positions[vertex as usize], corners);
            block.push([vertex, a, b, c], &[point, u, v]);
            if block.is_full() {
                block.find(most, &mut note);
            }
        }
        block.find(most, &mut note);
    }

    fn find_edges(&self, most: f64, member: &Member, hits: &mut Vec<Hit>) {
        let (positions, pairs) = (self.lists.positions(), self.lists.edge_pairs());
        let mut block = Block::<[u32; 4], true>::new([0; 4]);
        let mut note = |vertices: [u32; 4], [squared, s, t]: [f64; 3], [r, u, v]: [Vec3; 3]| {
            let (weights, separation) = ([1.0 - s, s, t - 1.0, -t], r + u * s - v * t);
            hits.push(Hit { vertices, weights, squared, separation, edges: [u, v] });
        };
        for pair in &pairs[member.share(pairs.len())] {
            let [[a, b], [c, d]] = pair.map(|edge| self.lists.ends(edge));
            let at = |vertex: u32| &positions[vertex as usize];
            let arms = edge_arms(self.cell.as_ref(), [at(a), at(b)], [at(c), at(d)]);
            block.push([a, b, c, d], &arms);
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
        forces: Option<&mut [f64]>,
        particles: &[u32],
    ) {
        let [u, v] = &hit.edges;
        let of_edges = *u != Vec3::zeros();
        let (weight, turns) =
            if of_edges { surface_repulsion::edge_weight(u, v) } else { (1.0, [Vec3::zeros(); 2]) };
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
        let Some(forces) = forces else { return };
        let [turn_u, turn_v] = turns.map(|turn| turn * energy);
        // An end moves its edge forward, a beginning backward.
        let turns = [turn_u, -turn_u, turn_v, -turn_v];
        for (k, vertex) in hit.vertices.into_iter().enumerate() {
            let force = hit.separation * (strength * hit.weights[k]) + turns[k];
            let slot = &mut forces[3 * particles[vertex as usize] as usize..][..3];
            slot.iter_mut().zip(force.iter()).for_each(|(sum, force)| *sum += force);
        }
    }

    /// Whether a term acts between things that share no vertex; the first and the last vertex are of different ones.
    #[inline]
    fn acts(&self, term: &Term, [first, .., last]: [u32; 4]) -> bool {
        term.switches & ONLY_BETWEEN_PARTS == 0
            || self.parts[first as usize] != self.parts[last as usize]
    }

    /// Whether no flip of a quadrilateral can free energy, as nothing is near it.
    pub fn is_quiet(&self, quad: &Quad) -> bool {
        !self.lists.has_any(&quad.vertices)
    }

    /// The energy, kJ/mol, of two triangles and the edge between them, as a half-edge of one of them has them now.
    pub fn around(&mut self, mesh: &Triangulation, terms: &[&Term], quad: &Quad) -> f64 {
        if terms.is_empty() {
            return 0.0;
        }
        let (mut near, mut edges) =
            (std::mem::take(&mut self.near), std::mem::take(&mut self.near_edges));
        let (positions, cell) = (self.lists.positions(), self.cell.as_ref());
        let at = |vertex: u32| &positions[vertex as usize];
        let mut energy = 0.0;
        let mut add = |vertices: [u32; 4], squared: f64, weight: f64| {
            let acting = terms.iter().filter(|term| self.acts(term, vertices));
            let pairs = acting.map(|term| surface_repulsion::pair(term, squared).0.energy);
            energy += weight * pairs.sum::<f64>();
        };
        for triangle in quad.triangles() {
            let corners = mesh.triangles()[triangle];
            self.lists.vertices_near_now(corners, &mut near);
            for &vertex in &near {
                let Nearest { squared, .. } =
                    Arms::new(cell, at(vertex), corners.map(at)).nearest();
                add([vertex, corners[0], corners[1], corners[2]], squared, 1.0);
            }
        }
        let [i, j, ..] = quad.vertices;
        self.lists.edges_near_now([i, j], &mut edges);
        for &[p, q] in &edges {
            let [_, u, v] = edge_arms(cell, [at(i), at(j)], [at(p), at(q)]);
            let squared = crossing(cell, [at(i), at(j)], [at(p), at(q)]).squared;
            add([i, j, p, q], squared, surface_repulsion::edge_weight(&u, &v).0);
        }
        (self.near, self.near_edges) = (near, edges);
        energy
    }

    /// Have the edge kl of a quadrilateral in place of ij.
    pub fn follow(&mut self, quad: &Quad) {
        self.lists.follow(quad);
    }

    /// Flips have made something that touches.
    pub fn note_new_pairs(&mut self) {
        self.lists.note_new_pairs();
    }
}
