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
mod choice;
mod forward;
mod instructions;
mod lanes;
mod layout;
mod records;
mod tiles;
mod triangles;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use instructions::Level;
pub use layout::Layout;
pub use records::BLOCK;
pub use tiles::{EdgeBlock, TriangleTile, VertexTile};

use super::checks::{check_energies, culprit};
use crate::error::{Error, Result};
use crate::mesh::Topology;
use crate::mesh::geometry::{TotalPartials, Totals};
use crate::potentials::{Contribution, Edges, Needs, Term, Triangles, Vertices};
use crate::team::{Member, Parts, Team};
use arrays::Arrays;
use backward::{Backward, Forces};
use choice::Choice;
use forward::{NORMALS, VECTORS, VORONOI};
use instructions::dispatch;
use layout::TILE;
use std::sync::Arc;
use triangles::TriangleSums;

/// Below twice this area, nm², a triangle has none: its reciprocal and products of it are no numbers any more.
const SMALLEST_AREA: f64 = 1e-140;

/// Evaluates terms on one mesh in lanes, on one thread or several.
pub struct SimdEvaluator {
    level: Level,
    topology: Arc<Topology>,
    layout: Layout,
    arrays: Arrays,
    /// The calling thread, and the team that it belongs to where that is worth a try.
    alone: Team,
    team: Option<Team>,
    choice: Choice,
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
    level: Level,
    layout: &'a Layout,
    arrays: &'a Arrays,
    terms: &'a [&'t Term<'t>],
    needs: Needs,
    positions: &'a [f64],
}

impl SimdEvaluator {
    /// Buffers for a mesh. `level` is the instruction set to use, which the processor must have.
    pub fn new(topology: Arc<Topology>, level: Level) -> Self {
        let layout = Layout::new(&topology);
        let mut evaluator = Self {
            level,
            arrays: Arrays::new(&layout),
            triangle_sums: vec![TriangleSums::default(); layout.triangle_tiles()],
            contributions: Vec::new(),
            topology,
            layout,
            alone: Team::new(1).expect("no thread is made for a team of one"),
            team: None,
            choice: Choice::new(),
            scratch: Vec::new(),
            has_slopes: false,
        };
        evaluator.set_threads(1);
        evaluator
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.layout.num_vertices
    }

    /// Let so many threads share the work where that is faster, or as many as the system has left.
    pub fn set_threads(&mut self, threads: usize) {
        self.team = if threads > 1 { Team::new(threads).ok() } else { None };
        self.choice = Choice::new();
        let steps = self.layout.longest;
        let scratch =
            || Scratch { triangles: TriangleTile::EMPTY, vertices: VertexTile::new(steps) };
        self.scratch.resize_with(self.team.as_ref().map_or(1, Team::size), scratch);
    }

    /// As [`super::CpuEvaluator::evaluate`].
    pub fn evaluate(
        &mut self,
        terms: &[&Term],
        positions: &[f64],
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
    ) -> Result<()> {
        let particles = self.topology.particles.last().map_or(0, |last| *last as usize + 1);
        let (length, fits) =
            (positions.len(), |forces: &&mut [f64]| forces.len() == positions.len());
        let counts = contributions.is_empty() || contributions.len() == terms.len();
        if length < 3 * particles || !forces.as_ref().is_none_or(fits) || !counts {
            return Err(Error::Contract(format!(
                "needs positions and forces of {particles} particles or more and one contribution a term, or none"
            )));
        }
        let attempt = self.choice.next();
        let outcome = self.attempt(terms, positions, contributions, forces, attempt.together);
        self.choice.done(&attempt);
        outcome
    }

    /// An evaluation, by the team or by this thread alone.
    fn attempt(
        &mut self,
        terms: &[&Term],
        positions: &[f64],
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
        together: bool,
    ) -> Result<()> {
        let needs = terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        self.make_room(needs, terms.len());
        let team = self.team.as_mut().filter(|_| together).unwrap_or(&mut self.alone);
        let sweep = Sweep {
            level: self.level,
            layout: &self.layout,
            arrays: &self.arrays,
            terms,
            needs,
            positions,
        };
        let sums = Parts::new(&mut self.triangle_sums);
        let parts = Parts::new(&mut self.contributions);
        let scratch = Parts::new(&mut self.scratch);
        team.run(|member| {
            // SAFETY: each member has its own place.
            let scratch = unsafe { scratch.part(member.index()..member.index() + 1) };
            sweep.forward(&member, &mut scratch[0], &sums, &parts);
        });
        let Some((totals, silent)) = totals(&self.triangle_sums) else {
            // What this evaluation has left of tensions is not to be relied on.
            self.triangle_sums.iter_mut().for_each(|sum| sum.silent = false);
            return Err(culprit(&self.topology, positions));
        };
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
            let (layout, arrays, level) = (&self.layout, &self.arrays, self.level);
            let needs = if silent { needs - Needs::TRIANGLES } else { needs };
            let (totals, forces) = (&total_partials, Forces(forces.as_mut_ptr()));
            team.run(|member| {
                for index in member.share(layout.vertex_tiles()) {
                    backward(level, needs, layout, arrays, totals, index, forces);
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
        }
        if needs.contains(Needs::CURVATURE_VECTORS) {
            arrays.umbrella_slopes.require(4 * vertices, 0.0);
        }
        if needs.contains(Needs::NORMALS) {
            arrays.normal_slopes.require(4 * vertices, 0.0);
            arrays.angles.require(4 * (triangles + 1), 0.0);
            arrays.next_angles.require(4 * (triangles + 1), 0.0);
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
}

/// Area and volume, and whether no potential of triangles acts; unless the mesh has no geometry.
fn totals(sums: &[TriangleSums]) -> Option<(Totals, bool)> {
    let mut sum = TriangleSums::default();
    for part in sums {
        sum += *part;
    }
    let TriangleSums { twice_area, six_volumes, smallest, silent } = sum;
    let totals = Totals { area: 0.5 * twice_area, volume: six_volumes / 6.0 };
    (smallest > SMALLEST_AREA && twice_area.is_finite()).then_some((totals, silent))
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
            let silent = sum[0].silent;
            let parts = parts(tile..tile + 1);
            sum[0] = self.triangle_tile(tile, &mut scratch.triangles, silent, parts);
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
        let (all, _) = self.positions.as_chunks::<3>();
        let [x, y, z] = all[particles[0] as usize];
        let share = member.share(particles.len());
        let records = self.arrays.positions.at(4 * share.start).cast::<[f64; 4]>();
        for (index, &particle) in particles[share].iter().enumerate() {
            let position = all[particle as usize];
            // SAFETY: each member writes the vertices of its share.
            unsafe {
                *records.add(index) = [position[0] - x, position[1] - y, position[2] - z, 0.0]
            };
        }
    }

    /// Geometry and potentials of a tile of triangles; `silent` says whether its tensions are zero.
    fn triangle_tile(
        &self,
        index: usize,
        tile: &mut TriangleTile,
        silent: bool,
        contributions: &mut [Contribution],
    ) -> TriangleSums {
        let (layout, arrays, level) = (self.layout, self.arrays, self.level);
        contributions.fill(Contribution::default());
        let potentials = self.needs.contains(Needs::TRIANGLES);
        macro_rules! forward {
            ($potentials:literal $angles:literal) => {{
                type Pass<'a> = triangles::Forward<'a, $potentials, $angles>;
                dispatch(level, Pass { layout, arrays, index, tile })
            }};
        }
        let sums = match (potentials, self.needs.contains(Needs::NORMALS)) {
            (false, false) => forward!(false false),
            (false, true) => forward!(false true),
            (true, false) => forward!(true false),
            (true, true) => forward!(true true),
        };
        if !potentials {
            return TriangleSums { silent, ..sums };
        }
        tile.silent = true;
        let ids = &layout.triangle_ids[layout.triangle_tile(index)];
        for (term, contribution) in self.terms.iter().zip(contributions) {
            if term.potential.needs(term).contains(Needs::TRIANGLES) {
                let run = Triangles::Lanes { level, ids, tile };
                *contribution = term.potential.triangles(term, run);
            }
        }
        // Zeros that follow zeros need not be written.
        if !(silent && tile.silent) {
            dispatch(level, triangles::Tensions { layout, arrays, index, tile });
        }
        TriangleSums { silent: tile.silent, ..sums }
    }

    /// Geometry and potentials of a tile of vertices and of the edges at them.
    fn vertex_tile(&self, index: usize, tile: &mut VertexTile, contributions: &mut [Contribution]) {
        let (layout, arrays, level, needs) = (self.layout, self.arrays, self.level, self.needs);
        contributions.fill(Contribution::default());
        let bends = needs.intersects(Needs::EDGES | Needs::CURVATURES);
        let lengths = needs.contains(Needs::EDGES);
        macro_rules! forward {
            ($bends:literal $vectors:expr) => {{
                type Pass<'a> = forward::Forward<'a, $bends, { $vectors }>;
                dispatch(level, Pass { layout, arrays, index, lengths, tile })
            }};
        }
        match (bends, vector_level(needs)) {
            (false, 0) if !needs.contains(Needs::VERTICES) => return,
            (false, 0) => forward!(false 0),
            (false, VORONOI) => forward!(false VORONOI),
            (false, VECTORS) => forward!(false VECTORS),
            (false, _) => forward!(false NORMALS),
            (true, 0) => forward!(true 0),
            (true, VORONOI) => forward!(true VORONOI),
            (true, VECTORS) => forward!(true VECTORS),
            (true, _) => forward!(true NORMALS),
        }
        if lengths {
            self.edges(index, contributions);
        }
        if !needs.contains(Needs::VERTICES) {
            return;
        }
        let range = layout.vertex_tile(index);
        tile.slopes.clear(needs, range.len());
        let ids = &layout.vertex_ids[range];
        for (term, contribution) in self.terms.iter().zip(contributions) {
            if term.potential.needs(term).contains(Needs::VERTICES) {
                let run = Vertices::Lanes { level, total: layout.num_vertices, ids, tile };
                *contribution += term.potential.vertices(term, run);
            }
        }
        macro_rules! slopes {
            ($vectors:expr) => {{
                type Pass<'a> = forward::Slopes<'a, { $vectors }>;
                dispatch(level, Pass { layout, arrays, index, tile })
            }};
        }
        match vector_level(needs) {
            0 => slopes!(0),
            VORONOI => slopes!(VORONOI),
            VECTORS => slopes!(VECTORS),
            _ => slopes!(NORMALS),
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
            let places = &layout.places[steps];
            for lane in 0..BLOCK {
                let ends = places.iter().position(|lanes| lanes[lane] == nothing);
                if let Some(end) = ends {
                    moments[end][lane] = moments[0][lane];
                }
            }
        }
    }
}

/// The third pass over a tile.
fn backward(
    level: Level,
    needs: Needs,
    layout: &Layout,
    arrays: &Arrays,
    totals: &TotalPartials,
    index: usize,
    forces: Forces,
) {
    macro_rules! backward {
        ($bends:literal $moments:literal $tensions:literal $vectors:expr) => {{
            type Pass<'a> = Backward<'a, $bends, $moments, $tensions, { $vectors }>;
            dispatch(level, Pass { layout, arrays, totals, index, forces })
        }};
    }
    let (bends, moments) = (needs.contains(Needs::CURVATURES), needs.contains(Needs::EDGES));
    match (bends, moments, needs.contains(Needs::TRIANGLES), vector_level(needs)) {
        (false, false, false, 0) => backward!(false false false 0),
        (false, false, false, VORONOI) => backward!(false false false VORONOI),
        (false, false, false, VECTORS) => backward!(false false false VECTORS),
        (false, false, false, _) => backward!(false false false NORMALS),
        (false, false, true, 0) => backward!(false false true 0),
        (false, false, true, VORONOI) => backward!(false false true VORONOI),
        (false, false, true, VECTORS) => backward!(false false true VECTORS),
        (false, false, true, _) => backward!(false false true NORMALS),
        (true, false, false, 0) => backward!(true false false 0),
        (true, false, false, VORONOI) => backward!(true false false VORONOI),
        (true, false, false, VECTORS) => backward!(true false false VECTORS),
        (true, false, false, _) => backward!(true false false NORMALS),
        (true, false, true, 0) => backward!(true false true 0),
        (true, false, true, VORONOI) => backward!(true false true VORONOI),
        (true, false, true, VECTORS) => backward!(true false true VECTORS),
        (true, false, true, _) => backward!(true false true NORMALS),
        (_, true, false, 0) => backward!(true true false 0),
        (_, true, false, VORONOI) => backward!(true true false VORONOI),
        (_, true, false, VECTORS) => backward!(true true false VECTORS),
        (_, true, false, _) => backward!(true true false NORMALS),
        (_, true, true, 0) => backward!(true true true 0),
        (_, true, true, VORONOI) => backward!(true true true VORONOI),
        (_, true, true, VECTORS) => backward!(true true true VECTORS),
        (_, true, true, _) => backward!(true true true NORMALS),
    }
}

/// How much of the vertices' vectors is needed.
fn vector_level(needs: Needs) -> u8 {
    debug_assert!(
        !needs.contains(Needs::NORMALS) || needs.contains(Needs::CURVATURE_VECTORS),
        "who wants normals wants vectors, for which there is room then"
    );
    match needs {
        needs if needs.contains(Needs::NORMALS) => NORMALS,
        needs if needs.contains(Needs::CURVATURE_VECTORS) => VECTORS,
        needs if needs.contains(Needs::VECTORS) => VORONOI,
        _ => 0,
    }
}
