//! An evaluation as its threads go through it: which passes a tile needs, and the potentials between them.
//!
//! The passes are compiled for each set of quantities that terms can ask for; here one of them is chosen.

use super::arrays::{self, Arrays};
use super::backward::{Backward, Forces};
use super::forward::{self, COTANGENTS, NORMALS, UMBRELLAS, VORONOI};
use super::layout::Layout;
use super::survey::Findings;
use super::triangles::{self, TriangleSums};
use crate::lanes::BLOCK;
use crate::lanes::tiles::TILE;
use crate::lanes::tiles::{EdgeBlock, TriangleTile, VertexTile};
use crate::lanes::{Level, dispatch};
use crate::mesh::geometry::TotalPartials;
use crate::potentials::{Contribution, Edges, Needs, Term, Triangles, Vertices};
use crate::team::{Member, Parts};

/// What Gompper and Kroll need.
const COTANGENTS_AND_AREAS: u8 = COTANGENTS | VORONOI;
/// What the passes take together that is seldom needed together.
const ALL_VECTORS: u8 = COTANGENTS_AND_AREAS | UMBRELLAS | NORMALS;

/// Expands `$pass!` with what is known and a constant for which of the vertices' vectors are needed.
macro_rules! with_vectors {
    ($needs:expr, $pass:ident $($known:literal)*) => {
        match vectors($needs) {
            0 => $pass!($($known)* 0),
            VORONOI => $pass!($($known)* VORONOI),
            COTANGENTS => $pass!($($known)* COTANGENTS),
            UMBRELLAS => $pass!($($known)* UMBRELLAS),
            COTANGENTS_AND_AREAS => $pass!($($known)* COTANGENTS_AND_AREAS),
            _ => $pass!($($known)* ALL_VECTORS),
        }
    };
}

/// What a thread needs for the tile that it is at.
pub struct Scratch {
    pub triangles: TriangleTile,
    pub vertices: VertexTile,
}

/// An evaluation as all its threads see it.
pub struct Sweep<'a, 't> {
    pub level: Level,
    pub layout: &'a Layout,
    pub arrays: &'a Arrays,
    pub terms: &'a [Term<'t>],
    pub needs: Needs,
    pub positions: &'a [f64],
    /// Where to note every element, if somebody wants to know.
    pub findings: Option<Findings<'a>>,
}

impl Sweep<'_, '_> {
    /// The first two passes, as one of the threads.
    pub fn forward(
        &self,
        member: &Member,
        scratch: &mut Scratch,
        sums: &Parts<TriangleSums>,
        curvatures: &Parts<f64>,
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
            if self.needs.contains(Needs::MEAN_CURVATURE) {
                let known = &scratch.vertices.known.curvature.0[..layout.vertex_tile(tile).len()];
                // SAFETY: as above.
                unsafe { curvatures.part(tile..tile + 1)[0] = known.iter().sum() };
            }
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
        if member.index() == 0 {
            let ghosts = self.arrays.positions.at(4 * particles.len()).cast::<[f64; 4]>();
            for index in 0..self.layout.ghosts.len() {
                let (vertex, shift) = self.layout.ghosts.vertex_and_shift(index);
                let position = all[particles[vertex] as usize];
                let [dx, dy, dz] = [0, 1, 2].map(|k| position[k] + shift[k]);
                // SAFETY: nobody else writes ghosts.
                unsafe { *ghosts.add(index) = [dx - x, dy - y, dz - z, 0.0] };
            }
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
        let columns = potentials || self.findings.is_some();
        macro_rules! forward {
            ($potentials:literal $angles:literal) => {{
                type Pass<'a> = triangles::Forward<'a, $potentials, $angles>;
                dispatch(level, Pass { layout, arrays, index, tile })
            }};
        }
        let sums = match (columns, self.needs.contains(Needs::NORMALS)) {
            (false, false) => forward!(false false),
            (false, true) => forward!(false true),
            (true, false) => forward!(true false),
            (true, true) => forward!(true true),
        };
        tile.energies.begin(self.findings.is_some());
        tile.silent = true;
        let ids = &layout.triangle_ids[layout.triangle_tile(index)];
        for (term, contribution) in self.terms.iter().zip(contributions) {
            if term.potential.needs(term).contains(Needs::TRIANGLES) {
                let run = Triangles::Lanes { level, ids, tile };
                *contribution = term.potential.triangles(term, run);
            }
        }
        if let Some(findings) = &self.findings {
            self.survey_triangles(index, tile, findings);
        }
        if !potentials {
            return TriangleSums { silent, ..sums };
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
        match (bends, vectors(needs)) {
            (false, 0) if !needs.contains(Needs::VERTICES) && self.findings.is_none() => return,
            (false, _) => with_vectors!(needs, forward false),
            (true, _) => with_vectors!(needs, forward true),
        }
        if lengths {
            self.edges(index, contributions);
        }
        tile.energies.begin(self.findings.is_some());
        let potentials = needs.contains(Needs::VERTICES);
        let range = layout.vertex_tile(index);
        if potentials {
            tile.partials.clear(needs, range.len());
        }
        let ids = &layout.vertex_ids[range];
        let inner = &ids[..layout.inner[index] as usize];
        for (term, contribution) in self.terms.iter().zip(contributions) {
            if term.potential.needs(term).contains(Needs::VERTICES) {
                let ids = if term.potential.acts_at_borders() { ids } else { inner };
                let run = Vertices::Lanes { level, total: layout.num_vertices, ids, tile };
                *contribution += term.potential.vertices(term, run);
            }
        }
        if let Some(findings) = &self.findings {
            self.survey_vertices(index, tile, findings);
        }
        if !potentials {
            return;
        }
        macro_rules! partials {
            ($vectors:expr) => {{
                type Pass<'a> = forward::Partials<'a, { $vectors }>;
                dispatch(level, Pass { layout, arrays, index, tile })
            }};
        }
        with_vectors!(needs, partials)
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
            // Nothing else writes the closing step; what an earlier layout has left there is no angle.
            let closing = steps.len() - 1;
            // SAFETY: bends, lengths and moments have a row for each step, and the steps of a tile are its own.
            unsafe {
                *rows(&arrays.bends).add(closing) = [0.0; BLOCK];
                *rows(&arrays.lengths_squared).add(closing) = [1.0; BLOCK];
            }
            // SAFETY: as above.
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
                    let names = &|| &layout.edge_names()[steps.clone()];
                    let block = EdgeBlock { bends, lengths_squared, moments, lanes, names };
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
pub fn backward(
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
    macro_rules! with_tensions {
        ($bends:literal $moments:literal) => {
            if needs.contains(Needs::TRIANGLES) {
                with_vectors!(needs, backward $bends $moments true)
            } else {
                with_vectors!(needs, backward $bends $moments false)
            }
        };
    }
    // With moments of edges, those of curvatures are always taken along.
    if needs.contains(Needs::EDGES) {
        with_tensions!(true true)
    } else if needs.contains(Needs::CURVATURES) {
        with_tensions!(true false)
    } else {
        with_tensions!(false false)
    }
}

/// Which of the vertices' vectors are needed.
fn vectors(needs: Needs) -> u8 {
    let bit = |what, bit| if needs.contains(what) { bit } else { 0 };
    bit(Needs::VORONOI_AREAS, VORONOI)
        | bit(Needs::COTANGENTS, COTANGENTS)
        | bit(Needs::UMBRELLAS, UMBRELLAS)
        | bit(Needs::NORMALS, NORMALS)
}

/// What all terms need together; and all vectors, where there are no passes for just those that they need.
pub fn needs_of(terms: &[Term]) -> Needs {
    let needs = terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
    match vectors(needs) {
        0 | VORONOI | COTANGENTS | UMBRELLAS | COTANGENTS_AND_AREAS => needs,
        _ => needs | Needs::VORONOI_AREAS | Needs::COTANGENTS | Needs::UMBRELLAS | Needs::NORMALS,
    }
}
