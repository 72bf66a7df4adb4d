//! The fast evaluator: three passes over a renumbered mesh, in lanes of whatever the processor has.
//!
//! Where the readable reference goes through triangles, edges, vertices and back, here are no edges: an edge is
//! met twice, once from each of its ends, which costs some arithmetic and saves a detour through memory.
//!
//! 1. [`triangles`]: normals, area and volume; potentials of triangles, which end in tensions of sides.
//! 2. [`forward`]: round the ring of each vertex, its area and curvature; potentials of angles and vertices.
//! 3. [`backward`]: round the rings again, forces.
//!
//! The first two go hand in hand, a tile at a time; the third needs the totals, so all of them. Nothing is
//! allocated in an evaluation, and every sum is formed in an order that the mesh alone decides.

mod arrays;
mod backward;
mod forward;
mod ghosts;
mod layout;
mod mean_curvature;
mod survey;
mod sweep;
mod triangles;

pub use layout::Layout;

use super::Survey;
use super::checks::{check_energies, check_totals};
use crate::error::Result;
use crate::lanes::tiles::{TriangleTile, VertexTile};
use crate::lanes::{BLOCK, Level};
use crate::mesh::geometry::{TotalPartials, Totals};
use crate::mesh::{Cell, Triangulation, culprit};
use crate::potentials::{Contribution, Needs, Request, Term};
use crate::team::{Parts, Sharing, Team};
use arrays::Arrays;
use backward::Forces;
use mean_curvature::{add_mean_curvature, release_borders};
use survey::Findings;
use sweep::{Scratch, Sweep, backward};
use triangles::TriangleSums;

/// |N| below which a triangle counts as having no area, nm²: reciprocals and products of smaller ones leave the range of a
/// double.
const SMALLEST_AREA: f64 = 1e-140;

/// Evaluates terms on one mesh in lanes, on one thread or several.
pub struct SimdEvaluator {
    level: Level,
    layout: Layout,
    arrays: Arrays,
    /// The calling thread, and the team that it belongs to where that is worth a try.
    alone: Team,
    team: Option<Team>,
    sharing: Sharing,
    scratch: Vec<Scratch>,
    triangle_sums: Vec<TriangleSums>,
    /// For each tile of vertices the sum of their curvatures, where a term wants the total.
    curvature_sums: Vec<f64>,
    /// For each tile of triangles, then of vertices, a contribution for each term.
    contributions: Vec<Contribution>,
    /// Whether there are partials of vertices from an earlier evaluation.
    has_partials: bool,
    /// How many particles there must be at least.
    particles: usize,
}

impl SimdEvaluator {
    /// Buffers for a mesh. `level` is the instruction set to use, which the processor must have.
    /// `order` has the vertices so that neighbours are near each other.
    pub fn new(mesh: &Triangulation, order: &[u32], level: Level) -> Self {
        let layout = Layout::new(mesh, order);
        let mut evaluator = Self {
            level,
            arrays: Arrays::new(&layout),
            triangle_sums: vec![TriangleSums::default(); layout.triangle_tiles()],
            curvature_sums: vec![0.0; layout.vertex_tiles()],
            contributions: Vec::new(),
            particles: mesh.particles().last().map_or(0, |last| *last as usize + 1),
            layout,
            alone: Team::new(1).expect("no thread is made for a team of one"),
            team: None,
            sharing: Sharing::new(),
            scratch: Vec::new(),
            has_partials: false,
        };
        evaluator.set_threads(1);
        evaluator
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.layout.num_vertices
    }

    /// Go on with a mesh whose connectivity has changed, or with another order of its vertices.
    pub fn lay_out(&mut self, mesh: &Triangulation, order: &[u32]) {
        let longest = self.layout.longest;
        self.layout.update(mesh, order);
        if self.layout.longest > longest {
            self.scratch.clear();
            self.make_scratch();
        }
    }

    /// Let so many threads share the work where that is faster, or as many as the system has left.
    pub fn set_threads(&mut self, threads: usize) {
        self.team = if threads > 1 { Team::new(threads).ok() } else { None };
        self.sharing = Sharing::new();
        self.make_scratch();
    }

    /// One for each thread, with room for the longest ring.
    fn make_scratch(&mut self) {
        let steps = self.layout.longest;
        let scratch =
            || Scratch { triangles: TriangleTile::EMPTY, vertices: VertexTile::new(steps) };
        self.scratch.resize_with(self.team.as_ref().map_or(1, Team::size), scratch);
    }

    /// Set the periodic box, which says where a surface that spans it goes on.
    pub fn set_cell(&mut self, cell: &Cell) {
        self.layout.ghosts.set_cell(cell);
    }

    /// Evaluate terms, and note what is known of every element if somebody wants to know.
    pub fn evaluate(&mut self, request: Request, survey: Option<&mut Survey>) -> Result<()> {
        request.check(self.particles)?;
        let attempt = self.sharing.next();
        let outcome = self.attempt(request, survey, attempt.together);
        self.sharing.done(&attempt);
        outcome
    }

    /// An evaluation, by the team or by this thread alone.
    fn attempt(
        &mut self,
        request: Request,
        mut survey: Option<&mut Survey>,
        together: bool,
    ) -> Result<()> {
        let Request { terms, positions, energies: contributions, forces } = request;
        let needs = terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        self.make_room(needs, terms.len());
        if let Some(survey) = &mut survey {
            survey.make_room(needs, self.layout.num_triangles, self.layout.num_vertices);
        }
        let team = self.team.as_mut().filter(|_| together).unwrap_or(&mut self.alone);
        let sweep = Sweep {
            level: self.level,
            layout: &self.layout,
            arrays: &self.arrays,
            terms,
            needs,
            positions,
            findings: survey.as_deref_mut().map(Findings::new),
        };
        let sums = Parts::new(&mut self.triangle_sums);
        let curvatures = Parts::new(&mut self.curvature_sums);
        let parts = Parts::new(&mut self.contributions);
        let scratch = Parts::new(&mut self.scratch);
        team.run(|member| {
            // SAFETY: each member has its own place.
            let scratch = unsafe { scratch.part(member.index()..member.index() + 1) };
            sweep.forward(&member, &mut scratch[0], &sums, &curvatures, &parts);
        });
        let Some((mut totals, silent)) = totals(&self.triangle_sums) else {
            // What this evaluation has left of tensions is not to be relied on.
            self.triangle_sums.iter_mut().for_each(|sum| sum.silent = false);
            let mut particles = self.layout.particles[..self.layout.num_vertices].to_vec();
            particles.sort_unstable();
            return Err(culprit(&particles, self.layout.triangles().into_iter(), positions));
        };
        if needs.contains(Needs::MEAN_CURVATURE) {
            totals.mean_curvature = 0.5 * self.curvature_sums.iter().sum::<f64>();
        }
        if let Some(survey) = survey {
            survey.totals = totals;
        }
        let mut total_partials = TotalPartials::default();
        let mut ignored = Contribution::default();
        for (k, term) in terms.iter().enumerate() {
            let contribution = contributions.get_mut(k).unwrap_or(&mut ignored);
            *contribution = Contribution::default();
            if term.potential.needs(term).contains(Needs::TOTALS) {
                *contribution = term.potential.totals(term, &totals, &mut total_partials);
                check_totals(term, contribution, &total_partials)?;
            }
        }
        if !contributions.is_empty() && !terms.is_empty() {
            for tile in self.contributions.chunks(terms.len()) {
                for (sum, part) in contributions.iter_mut().zip(tile) {
                    *sum += *part;
                }
            }
            check_energies(terms, contributions)?;
        } else {
            check_limits(terms, &self.contributions)?;
        }
        if let Some(forces) = forces {
            let (layout, arrays, level) = (&self.layout, &self.arrays, self.level);
            layout.ghosts.copy_partials(arrays, needs, layout.vertex_ids.len());
            let needs = if silent { needs - Needs::TRIANGLES } else { needs };
            let (totals, into) = (&total_partials, Forces(forces.as_mut_ptr()));
            team.run(|member| {
                if needs.contains(Needs::MEAN_CURVATURE) {
                    // SAFETY: each member has its own places, and nobody reads them before all are done.
                    unsafe {
                        add_mean_curvature(
                            arrays,
                            member.share(layout.places_of_vertices()),
                            totals,
                        )
                    };
                    member.barrier();
                }
                for index in member.share(layout.vertex_tiles()) {
                    backward(level, needs, layout, arrays, totals, index, into);
                }
            });
            if needs.contains(Needs::MEAN_CURVATURE) {
                release_borders(layout, arrays, totals, forces);
            }
        }
        Ok(())
    }

    /// Allocate what is needed for the first time.
    fn make_room(&mut self, needs: Needs, terms: usize) {
        let (layout, arrays) = (&self.layout, &mut self.arrays);
        let (vertices, triangles) = (layout.places_of_vertices(), layout.triangle_ids.len());
        let steps = BLOCK * layout.neighbours.len();
        arrays.positions.require(4 * vertices, 0.0);
        arrays.partials.require(2 * vertices, 0.0);
        if needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            arrays.bends.require(steps, 0.0);
        }
        if needs.contains(Needs::EDGES) {
            // Where a ring has ended, any length will do.
            arrays.lengths_squared.require(steps, 1.0);
            arrays.moments.require(steps, 0.0);
        }
        if needs.contains(Needs::TRIANGLES) {
            arrays.tensions.require(4 * (triangles + 1), 0.0);
        }
        if needs.contains(Needs::VECTORS) {
            arrays.vector_partials.require(4 * vertices, 0.0);
        }
        if needs.contains(Needs::CURVATURE_VECTORS) {
            arrays.umbrella_partials.require(4 * vertices, 0.0);
        }
        if needs.contains(Needs::NORMALS) {
            arrays.normal_partials.require(4 * vertices, 0.0);
            arrays.angles.require(4 * (triangles + 1), 0.0);
            arrays.next_angles.require(4 * (triangles + 1), 0.0);
        }
        if self.has_partials && !needs.contains(Needs::VERTICES) {
            for index in 0..2 * vertices {
                // SAFETY: `&mut self`, and the index is within.
                unsafe { *arrays.partials.at(index) = 0.0 };
            }
        }
        self.has_partials = needs.intersects(Needs::VERTICES | Needs::MEAN_CURVATURE);
        let tiles = layout.triangle_tiles() + layout.vertex_tiles();
        self.contributions.resize(tiles * terms, Contribution::default());
    }
}

/// Refuse what has no finite energy where a step would go on with forces that are no numbers, since nobody wants to know
/// the energy; `contributions` has tile by tile one for each term.
fn check_limits(terms: &[Term], contributions: &[Contribution]) -> Result<()> {
    for (k, term) in terms.iter().enumerate() {
        if !term.constants.values.is_empty() && term.potential.limits_sides(term) {
            let mut sum = Contribution::default();
            contributions.chunks(terms.len()).for_each(|tile| sum += tile[k]);
            check_energies(std::slice::from_ref(term), &[sum])?;
        }
    }
    Ok(())
}

/// Area and volume, and whether no potential of triangles acts; unless the mesh has no geometry.
fn totals(sums: &[TriangleSums]) -> Option<(Totals, bool)> {
    let mut sum = TriangleSums::default();
    for part in sums {
        sum += *part;
    }
    let TriangleSums { twice_area, six_volumes, smallest, silent } = sum;
    let totals = Totals { area: 0.5 * twice_area, volume: six_volumes / 6.0, ..Totals::default() };
    (smallest > SMALLEST_AREA && twice_area.is_finite()).then_some((totals, silent))
}
