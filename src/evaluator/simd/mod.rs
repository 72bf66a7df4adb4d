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
mod workspace;

pub use layout::Layout;

use super::Survey;
use super::checks::{check_energies, check_totals};
use crate::error::Result;
use crate::lanes::Level;
use crate::mesh::geometry::{TotalPartials, Totals};
use crate::mesh::{Cell, Triangulation, culprit};
use crate::potentials::{Contribution, Needs, Request, Term};
use crate::team::{Parts, Sharing, Team};
use backward::Forces;
use mean_curvature::{add_mean_curvature, release_borders};
use survey::Findings;
use sweep::{Sweep, backward, needs_of};
use triangles::TriangleSums;
use workspace::{Guest, SHARED_VERTICES, Workspace};

/// |N| below which a triangle counts as having no area, nm²: reciprocals and products of smaller ones leave the range of a
/// double.
const SMALLEST_AREA: f64 = 1e-140;

/// Evaluates terms on one mesh in lanes, on one thread or several.
pub struct SimdEvaluator {
    level: Level,
    layout: Layout,
    guest: Guest,
    /// Its own, where it has no need to share that of the thread.
    workspace: Option<Box<Workspace>>,
    /// The calling thread, and the team that it belongs to where that is worth a try.
    alone: Team,
    team: Option<Team>,
    sharing: Sharing,
    triangle_sums: Vec<TriangleSums>,
    /// For each tile of vertices the sum of their curvatures, where a term wants the total.
    curvature_sums: Vec<f64>,
    /// For each tile of triangles, then of vertices, a contribution for each term.
    contributions: Vec<Contribution>,
    /// How many particles there must be at least.
    particles: usize,
}

impl SimdEvaluator {
    /// Buffers for a mesh. `level` is the instruction set to use, which the processor must have.
    /// `order` has the vertices so that neighbours are near each other.
    pub fn new(mesh: &Triangulation, order: &[u32], level: Level) -> Self {
        let layout = Layout::new(mesh, order);
        Self {
            level,
            guest: Guest::default(),
            workspace: None,
            triangle_sums: vec![TriangleSums::default(); layout.triangle_tiles()],
            curvature_sums: vec![0.0; layout.vertex_tiles()],
            contributions: Vec::new(),
            particles: mesh.particles().last().map_or(0, |last| *last as usize + 1),
            layout,
            alone: Team::new(1).expect("no thread is made for a team of one"),
            team: None,
            sharing: Sharing::new(),
        }
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.layout.num_vertices
    }

    /// Go on with a mesh whose connectivity has changed, or with another order of its vertices.
    pub fn lay_out(&mut self, mesh: &Triangulation, order: &[u32]) {
        self.layout.update(mesh, order);
    }

    /// Let so many threads share the work where that is faster, or as many as the system has left.
    pub fn set_threads(&mut self, threads: usize) {
        self.team = if threads > 1 { Team::new(threads).ok() } else { None };
        self.sharing = Sharing::new();
    }

    /// Set the periodic box, which says where a surface that spans it goes on.
    pub fn set_cell(&mut self, cell: &Cell) {
        self.layout.ghosts.set_cell(cell);
    }

    /// Evaluate terms, and note what is known of every element if somebody wants to know.
    pub fn evaluate(&mut self, request: Request, survey: Option<&mut Survey>) -> Result<()> {
        request.check(self.particles)?;
        let attempt = self.sharing.next();
        let shares = self.team.is_none() && self.layout.num_vertices <= SHARED_VERTICES;
        let mut workspace = if shares {
            self.workspace = None;
            Workspace::of_this_thread()
        } else {
            self.workspace.take().unwrap_or_default()
        };
        let outcome = self.attempt(&mut workspace, request, survey, attempt.together);
        let silent = self.triangle_sums.iter().all(|sum| sum.silent);
        workspace.leave(self.layout.triangle_ids.len(), silent);
        if shares {
            workspace.give_back();
        } else {
            self.workspace = Some(workspace);
        }
        self.sharing.done(&attempt);
        outcome
    }

    /// An evaluation, by the team or by this thread alone.
    fn attempt(
        &mut self,
        workspace: &mut Workspace,
        request: Request,
        mut survey: Option<&mut Survey>,
        together: bool,
    ) -> Result<()> {
        let Request { terms, positions, energies: contributions, forces } = request;
        let needs = needs_of(terms);
        let team = self.team.as_mut().unwrap_or(&mut self.alone);
        let threads = team.size();
        if let Some(silent) = workspace.enter(&mut self.guest, &self.layout, needs, threads) {
            self.triangle_sums.iter_mut().for_each(|sum| sum.silent = silent);
        }
        let tiles = self.layout.triangle_tiles() + self.layout.vertex_tiles();
        self.contributions.resize(tiles * terms.len(), Contribution::default());
        if let Some(survey) = &mut survey {
            survey.make_room(needs, self.layout.num_triangles, self.layout.num_vertices);
        }
        let team = self.team.as_mut().filter(|_| together).unwrap_or(&mut self.alone);
        let sweep = Sweep {
            level: self.level,
            layout: &self.layout,
            arrays: &workspace.arrays,
            terms,
            needs,
            positions,
            findings: survey.as_deref_mut().map(Findings::new),
        };
        let sums = Parts::new(&mut self.triangle_sums);
        let curvatures = Parts::new(&mut self.curvature_sums);
        let parts = Parts::new(&mut self.contributions);
        let scratch = Parts::new(&mut workspace.scratch);
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
            let (layout, arrays, level) = (&self.layout, &workspace.arrays, self.level);
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
