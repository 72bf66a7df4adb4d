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
mod lanes;
mod layout;
mod tiles;
mod triangles;

pub use lanes::BLOCK;
pub use layout::Layout;
pub use tiles::{EdgeBlock, TriangleTile, VertexTile};

use super::checks::{check_energies, culprit};
use crate::error::Result;
use crate::mesh::Topology;
use crate::mesh::geometry::{TotalPartials, Totals};
use crate::potentials::{Contribution, Edges, Needs, Term, Triangles, Vertices};
use crate::team::{Member, Parts, Team};
use arrays::Arrays;
use backward::{Backward, Forces};
use lanes::dispatch;
use layout::TILE;
use pulp::Arch;
use std::sync::Arc;
use tiles::Column;
use triangles::TriangleSums;

/// Evaluates terms on one mesh in lanes, on one thread or several.
pub struct SimdEvaluator {
    arch: Arch,
    topology: Arc<Topology>,
    layout: Layout,
    arrays: Arrays,
    team: Team,
    scratch: Vec<Scratch>,
    triangle_sums: Vec<TriangleSums>,
    /// For each tile of triangles, then of vertices, a contribution for each term.
    contributions: Vec<Contribution>,
    /// Whether there are slopes of vertices from an earlier evaluation.
    has_slopes: bool,
}

/// What a thread needs for the tile that it is at.
struct Scratch {
    triangles: TriangleTile,
    vertices: VertexTile,
}

/// An evaluation as all its threads see it.
struct Sweep<'a, 't> {
    arch: Arch,
    layout: &'a Layout,
    arrays: &'a Arrays,
    terms: &'a [&'t Term<'t>],
    needs: Needs,
    positions: &'a [f64],
    wants_energy: bool,
}

impl SimdEvaluator {
    /// Buffers for a mesh. `arch` is the instruction set to use, which the processor must have.
    pub fn new(topology: Arc<Topology>, arch: Arch, threads: usize) -> Self {
        let layout = Layout::new(&topology);
        let mut evaluator = Self {
            arch,
            arrays: Arrays::new(&layout),
            triangle_sums: vec![TriangleSums::default(); layout.triangle_tiles()],
            contributions: Vec::new(),
            topology,
            layout,
            team: alone(),
            scratch: Vec::new(),
            has_slopes: false,
        };
        evaluator.set_threads(threads);
        evaluator
    }

    /// Let so many threads share the work, or as many as the system has left.
    pub fn set_threads(&mut self, threads: usize) {
        self.team = Team::new(threads).unwrap_or_else(|_| alone());
        let scratch = || Scratch { triangles: TriangleTile::EMPTY, vertices: VertexTile::EMPTY };
        self.scratch.resize_with(self.team.size(), scratch);
    }

    /// As [`super::CpuEvaluator::evaluate`], without terms that want normals of vertices.
    pub fn evaluate(
        &mut self,
        terms: &[&Term],
        positions: &[f64],
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
    ) -> Result<()> {
        let needs =
            terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        self.make_room(needs, terms.len());
        let sweep = Sweep {
            arch: self.arch,
            layout: &self.layout,
            arrays: &self.arrays,
            terms,
            needs,
            positions,
            wants_energy: !contributions.is_empty(),
        };
        let sums = Parts::new(&mut self.triangle_sums);
        let parts = Parts::new(&mut self.contributions);
        let scratch = Parts::new(&mut self.scratch);
        self.team.run(|member| {
            // SAFETY: each member has its own place.
            let scratch = unsafe { scratch.part(member.index()..member.index() + 1) };
            sweep.forward(&member, &mut scratch[0], &sums, &parts);
        });
        let totals = self.totals().ok_or_else(|| culprit(&self.topology, positions))?;
        let mut total_partials = TotalPartials::default();
        let mut ignored = Contribution::default();
        for (k, term) in terms.iter().enumerate() {
            let contribution = contributions.get_mut(k).unwrap_or(&mut ignored);
            *contribution = Contribution::default();
            if term.potential.needs(term).contains(Needs::TOTALS) {
                *contribution = term.potential.totals(term, &totals, &mut total_partials);
            }
        }
        if !contributions.is_empty() && !terms.is_empty() {
            for tile in self.contributions.chunks(terms.len()) {
                for (sum, part) in contributions.iter_mut().zip(tile) {
                    *sum += *part;
                }
            }
            check_energies(terms, contributions)?;
        }
        if let Some(forces) = forces {
            let (layout, arrays, arch) = (&self.layout, &self.arrays, self.arch);
            let (totals, forces) = (&total_partials, Forces(forces.as_mut_ptr()));
            self.team.run(|member| {
                for index in member.share(layout.vertex_tiles()) {
                    backward(arch, needs, layout, arrays, totals, index, forces);
                }
            });
        }
        Ok(())
    }

    /// Allocate what is needed for the first time.
    fn make_room(&mut self, needs: Needs, terms: usize) {
        let (layout, arrays) = (&self.layout, &mut self.arrays);
        let (vertices, triangles) = (layout.vertex_ids.len(), layout.triangle_ids.len());
        let steps = BLOCK * layout.neighbours.len();
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
            arrays.vector_slopes.require(4 * vertices, 0.0);
            arrays.umbrella_slopes.require(4 * vertices, 0.0);
        }
        if self.has_slopes && !needs.contains(Needs::VERTICES) {
            for index in 0..2 * vertices {
                // SAFETY: `&mut self`, and the index is within.
                unsafe { *arrays.slopes.at(index) = 0.0 };
            }
        }
        self.has_slopes = needs.contains(Needs::VERTICES);
        let tiles = layout.triangle_tiles() + layout.vertex_tiles();
        self.contributions.resize(tiles * terms, Contribution::default());
    }

    /// Area and volume, unless the mesh has no geometry.
    fn totals(&self) -> Option<Totals> {
        let mut sum = TriangleSums::default();
        for part in &self.triangle_sums {
            sum += *part;
        }
        let TriangleSums { twice_area, six_volumes, smallest } = sum;
        (smallest > 0.0 && twice_area.is_finite())
            .then(|| Totals { area: 0.5 * twice_area, volume: six_volumes / 6.0 })
    }
}

impl Sweep<'_, '_> {
    /// The first two passes, as one of the threads.
    fn forward(
        &self,
        member: &Member,
        scratch: &mut Scratch,
        sums: &Parts<TriangleSums>,
        contributions: &Parts<Contribution>,
    ) {
        let layout = self.layout;
        self.gather_positions(member);
        let (of_triangles, of_vertices) =
            (layout.triangle_tiles(), layout.triangle_tiles() + layout.vertex_tiles());
        let count = self.terms.len();
        let parts = |tiles: std::ops::Range<usize>| {
            // SAFETY: each member asks for the tiles that it has a share in.
            unsafe { contributions.part(tiles.start * count..tiles.end * count) }
        };
        let triangles = |tile: usize, scratch: &mut Scratch| {
            // SAFETY: as above.
            let sum = unsafe { sums.part(tile..tile + 1) };
            sum[0] = self.triangle_tile(tile, &mut scratch.triangles, parts(tile..tile + 1));
        };
        let vertices = |tile: usize, scratch: &mut Scratch| {
            let here = of_triangles + tile;
            debug_assert!(here < of_vertices);
            self.vertex_tile(tile, &mut scratch.vertices, parts(here..here + 1));
        };
        if member.size() > 1 {
            member.barrier();
            member.share(of_triangles).for_each(|tile| triangles(tile, scratch));
            member.barrier();
            member.share(layout.vertex_tiles()).for_each(|tile| vertices(tile, scratch));
            return;
        }
        // One thread follows each tile of triangles with the vertices that it completes, while the normals are
        // still in the cache.
        let mut done = 0;
        for (tile, &frontier) in layout.frontier.iter().enumerate() {
            while done * TILE < frontier as usize {
                triangles(done, scratch);
                done += 1;
            }
            vertices(tile, scratch);
        }
    }

    /// Positions relative to the first vertex, so that a mesh far from the origin loses no digits.
    fn gather_positions(&self, member: &Member) {
        let particles = &self.layout.particles;
        let of = |particle: u32| &self.positions[3 * particle as usize..][..3];
        let origin = of(particles[0]);
        for vertex in member.share(particles.len()) {
            let position = of(particles[vertex]);
            let record = self.arrays.positions.at(4 * vertex);
            for k in 0..3 {
                // SAFETY: each member writes the vertices of its share.
                unsafe { *record.add(k) = position[k] - origin[k] };
            }
        }
    }

    /// Geometry and potentials of a tile of triangles.
    fn triangle_tile(
        &self,
        index: usize,
        tile: &mut TriangleTile,
        contributions: &mut [Contribution],
    ) -> TriangleSums {
        let (layout, arrays, arch) = (self.layout, self.arrays, self.arch);
        contributions.fill(Contribution::default());
        if !self.needs.contains(Needs::TRIANGLES) {
            return dispatch(arch, triangles::Forward::<false> { layout, arrays, index, tile });
        }
        let sums = dispatch(arch, triangles::Forward::<true> { layout, arrays, index, tile });
        tile.by_area = Column::ZERO;
        tile.by_length_squared = [Column::ZERO; 3];
        let ids = &layout.triangle_ids[layout.triangle_tile(index)];
        for (term, contribution) in self.terms.iter().zip(contributions) {
            if term.potential.needs(term).contains(Needs::TRIANGLES) {
                let run = Triangles::Lanes { arch, ids, tile };
                *contribution = term.potential.triangles(term, run);
            }
        }
        dispatch(arch, triangles::Tensions { layout, arrays, index, tile });
        sums
    }

    /// Geometry and potentials of a tile of vertices and of the edges at them.
    fn vertex_tile(&self, index: usize, tile: &mut VertexTile, contributions: &mut [Contribution]) {
        let (layout, arrays, arch, needs) = (self.layout, self.arrays, self.arch, self.needs);
        contributions.fill(Contribution::default());
        let bends = needs.intersects(Needs::EDGES | Needs::CURVATURES);
        let (lengths, vectors) = (needs.contains(Needs::EDGES), needs.contains(Needs::VECTORS));
        macro_rules! forward {
            ($bends:literal $lengths:literal $vectors:literal) => {{
                type Pass<'a> = forward::Forward<'a, $bends, $lengths, $vectors>;
                dispatch(arch, Pass { layout, arrays, index, tile })
            }};
        }
        match (bends, lengths, vectors) {
            (false, _, false) if !needs.contains(Needs::VERTICES) => return,
            (false, _, false) => forward!(false false false),
            (false, _, true) => forward!(false false true),
            (true, false, false) => forward!(true false false),
            (true, false, true) => forward!(true false true),
            (true, true, false) => forward!(true true false),
            (true, true, true) => forward!(true true true),
        }
        if lengths {
            self.edges(index, contributions);
        }
        if !needs.contains(Needs::VERTICES) {
            return;
        }
        tile.slopes.clear(vectors);
        let ids = &layout.vertex_ids[layout.vertex_tile(index)];
        for (term, contribution) in self.terms.iter().zip(contributions) {
            if term.potential.needs(term).contains(Needs::VERTICES) {
                let run = Vertices::Lanes { arch, total: layout.num_vertices, ids, tile };
                *contribution += term.potential.vertices(term, run);
            }
        }
        if vectors {
            dispatch(arch, forward::Slopes::<true> { layout, arrays, index, tile });
        } else {
            dispatch(arch, forward::Slopes::<false> { layout, arrays, index, tile });
        }
    }

    /// Potentials of the edges at a tile of vertices.
    fn edges(&self, index: usize, contributions: &mut [Contribution]) {
        let (layout, arrays) = (self.layout, self.arrays);
        let vertices = layout.vertex_tile(index);
        for first in vertices.clone().step_by(BLOCK) {
            let block = first / BLOCK;
            let steps = layout.steps[block] as usize..layout.steps[block + 1] as usize;
            let rows = |numbers: &arrays::Numbers| -> *mut [f64; BLOCK] {
                numbers.at(steps.start * BLOCK).cast()
            };
            // SAFETY: bends, lengths and moments have a row for each step, and the steps of a tile are its own.
            let (bends, lengths_squared, moments) = unsafe {
                use std::slice::{from_raw_parts, from_raw_parts_mut};
                (
                    from_raw_parts(rows(&arrays.bends), steps.len()),
                    from_raw_parts(rows(&arrays.lengths_squared), steps.len()),
                    from_raw_parts_mut(rows(&arrays.moments), steps.len()),
                )
            };
            moments.fill([0.0; BLOCK]);
            for (term, contribution) in self.terms.iter().zip(&mut *contributions) {
                if term.potential.needs(term).contains(Needs::EDGES) {
                    let lanes = BLOCK.min(vertices.end - first);
                    let moments = &mut *moments;
                    let block = EdgeBlock { bends, lengths_squared, moments, lanes };
                    *contribution += term.potential.edges(term, Edges::Lanes(block));
                }
            }
            // Past the end of a ring comes its first edge again.
            let nothing = 4 * layout.triangle_ids.len() as u32;
            let triangles = &layout.triangles[steps];
            for lane in 0..BLOCK {
                let ends = triangles.iter().position(|lanes| lanes[lane] == nothing);
                if let Some(end) = ends {
                    moments[end][lane] = moments[0][lane];
                }
            }
        }
    }
}

/// The third pass over a tile.
fn backward(
    arch: Arch,
    needs: Needs,
    layout: &Layout,
    arrays: &Arrays,
    totals: &TotalPartials,
    index: usize,
    forces: Forces,
) {
    macro_rules! backward {
        ($bends:literal $moments:literal $tensions:literal $vectors:literal) => {{
            type Pass<'a> = Backward<'a, $bends, $moments, $tensions, $vectors>;
            dispatch(arch, Pass { layout, arrays, totals, index, forces })
        }};
    }
    let (bends, moments) = (needs.contains(Needs::CURVATURES), needs.contains(Needs::EDGES));
    match (bends, moments, needs.contains(Needs::TRIANGLES), needs.contains(Needs::VECTORS)) {
        (false, false, false, false) => backward!(false false false false),
        (false, false, false, true) => backward!(false false false true),
        (false, false, true, false) => backward!(false false true false),
        (false, false, true, true) => backward!(false false true true),
        (true, false, false, false) => backward!(true false false false),
        (true, false, false, true) => backward!(true false false true),
        (true, false, true, false) => backward!(true false true false),
        (true, false, true, true) => backward!(true false true true),
        (_, true, false, false) => backward!(true true false false),
        (_, true, false, true) => backward!(true true false true),
        (_, true, true, false) => backward!(true true true false),
        (_, true, true, true) => backward!(true true true true),
    }
}

/// A team of the calling thread.
fn alone() -> Team {
    Team::new(1).expect("no thread is made for a team of one")
}
