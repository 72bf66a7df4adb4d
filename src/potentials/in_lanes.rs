//! Formulas over the tiles of the fast evaluator, in the lanes of the instruction set that the processor has.

use super::{
    Contribution, Needs, Place, Sums, Term, Triangle, TriangleFormula, Vertex, VertexFormula,
};
use crate::lanes::tiles::{COUNTS, Column, TriangleTile, VertexColumns, VertexTile, load3};
use crate::lanes::{BLOCK, Lane, Level, Records, WithLanes, dispatch};
use crate::mesh::geometry::TrianglePartials;
use crate::real::Real;

impl TriangleTile {
    /// Apply a formula to the elements with these indices; returns the sum.
    pub fn apply<F: TriangleFormula>(
        &mut self,
        level: Level,
        term: &Term,
        ids: &[u32],
        formula: &F,
    ) -> Contribution {
        dispatch(level, InLanes { term, ids, tile: self, formula })
    }
}

impl VertexTile {
    /// Apply a formula to the elements with these indices; returns the sum.
    pub fn apply<F: VertexFormula>(
        &mut self,
        level: Level,
        term: &Term,
        ids: &[u32],
        formula: &F,
    ) -> Contribution {
        dispatch(level, InLanes { term, ids, tile: self, formula })
    }
}

impl VertexColumns {
    /// Set the columns of so many vertices to 0, as far as somebody needs them.
    pub fn clear(&mut self, needs: Needs, count: usize) {
        let clear = |column: &mut Column| column.0[..count.next_multiple_of(BLOCK)].fill(0.0);
        clear(&mut self.area);
        clear(&mut self.curvature);
        if needs.contains(Needs::VORONOI_AREAS) {
            clear(&mut self.voronoi_area);
        }
        if needs.contains(Needs::COTANGENTS) {
            self.cotangent.iter_mut().for_each(clear);
        }
        if needs.contains(Needs::UMBRELLAS) {
            self.umbrella.iter_mut().for_each(clear);
        }
        if needs.contains(Needs::NORMALS) {
            self.normal_sum.iter_mut().for_each(clear);
        }
    }

    /// The columns that a formula uses, and zeros for the rest.
    #[inline(always)]
    fn load<S: Records, F: VertexFormula>(&self, simd: S, index: usize) -> Vertex<Lane<S>> {
        let nothing = [Lane::splat(simd, 0.0); 3];
        let mut vertex = Vertex {
            area: self.area.load(simd, index),
            voronoi_area: nothing[0],
            curvature: nothing[0],
            cotangent: nothing,
            umbrella: nothing,
            normal_sum: nothing,
        };
        if F::USES.contains(Needs::CURVATURES) {
            vertex.curvature = self.curvature.load(simd, index);
        }
        if F::USES.contains(Needs::VORONOI_AREAS) {
            vertex.voronoi_area = self.voronoi_area.load(simd, index);
        }
        if F::USES.contains(Needs::COTANGENTS) {
            vertex.cotangent = load3(simd, &self.cotangent, index);
        }
        if F::USES.contains(Needs::UMBRELLAS) {
            vertex.umbrella = load3(simd, &self.umbrella, index);
        }
        if F::USES.contains(Needs::NORMALS) {
            vertex.normal_sum = load3(simd, &self.normal_sum, index);
        }
        vertex
    }

    #[inline(always)]
    fn store<S: Records, F: VertexFormula>(&mut self, index: usize, vertex: Vertex<Lane<S>>) {
        self.area.store(index, vertex.area);
        if F::USES.contains(Needs::CURVATURES) {
            self.curvature.store(index, vertex.curvature);
        }
        if F::USES.contains(Needs::VORONOI_AREAS) {
            self.voronoi_area.store(index, vertex.voronoi_area);
        }
        for k in 0..3 {
            if F::USES.contains(Needs::COTANGENTS) {
                self.cotangent[k].store(index, vertex.cotangent[k]);
            }
            if F::USES.contains(Needs::UMBRELLAS) {
                self.umbrella[k].store(index, vertex.umbrella[k]);
            }
            if F::USES.contains(Needs::NORMALS) {
                self.normal_sum[k].store(index, vertex.normal_sum[k]);
            }
        }
    }
}

/// The partials of the lanes that count, and others for the rest.
#[inline(always)]
fn chosen<S: Records>(
    counts: <Lane<S> as Real>::Mask,
    these: Vertex<Lane<S>>,
    others: Vertex<Lane<S>>,
) -> Vertex<Lane<S>> {
    let mut chosen = others;
    chosen.area = these.area.or_else(counts, others.area);
    chosen.voronoi_area = these.voronoi_area.or_else(counts, others.voronoi_area);
    chosen.curvature = these.curvature.or_else(counts, others.curvature);
    for k in 0..3 {
        chosen.cotangent[k] = these.cotangent[k].or_else(counts, others.cotangent[k]);
        chosen.umbrella[k] = these.umbrella[k].or_else(counts, others.umbrella[k]);
        chosen.normal_sum[k] = these.normal_sum[k].or_else(counts, others.normal_sum[k]);
    }
    chosen
}

/// A formula on its way to the instruction set that the processor has.
struct InLanes<'a, T, F> {
    term: &'a Term<'a>,
    ids: &'a [u32],
    tile: &'a mut T,
    formula: &'a F,
}

/// Sums over elements, lane by lane while whole registers of them come.
struct Accumulated<S: Records> {
    lanes: Sums<Lane<S>>,
    rest: Contribution,
}

impl<S: Records> Accumulated<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = Lane::splat(simd, 0.0);
        let lanes = Sums { energy: zero, by_parameter: [zero; 2] };
        Self { lanes, rest: Contribution::default() }
    }

    /// Add the first `count` lanes.
    #[inline(always)]
    fn add(&mut self, sums: Sums<Lane<S>>, count: usize) {
        if count >= Lane::<S>::COUNT {
            self.lanes.energy = self.lanes.energy + sums.energy;
            for k in 0..2 {
                self.lanes.by_parameter[k] = self.lanes.by_parameter[k] + sums.by_parameter[k];
            }
            return;
        }
        let [a, b] = sums.by_parameter;
        let by_parameter = [a.sum_of_first(count), b.sum_of_first(count)];
        self.rest.add(Sums { energy: sums.energy.sum_of_first(count), by_parameter });
    }

    #[inline(always)]
    fn total(self) -> Contribution {
        let mut total = self.rest;
        let [a, b] = self.lanes.by_parameter;
        let by_parameter = [a.sum(), b.sum()];
        total.add(Sums { energy: self.lanes.energy.sum(), by_parameter });
        total
    }
}

impl<F: TriangleFormula> WithLanes for InLanes<'_, TriangleTile, F> {
    type Output = Contribution;

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) -> Contribution {
        let Self { term, ids, tile, formula } = self;
        let mut sum = Accumulated::new(simd);
        for index in (0..ids.len()).step_by(Lane::<S>::COUNT) {
            let triangle = Triangle {
                twice_area: tile.twice_area.load(simd, index),
                dots: load3(simd, &tile.dots, index),
            };
            if formula.vanishes(&triangle) {
                continue;
            }
            tile.silent = false;
            let mut partials = TrianglePartials {
                area: tile.by_area.load(simd, index),
                length_squared: load3(simd, &tile.by_length_squared, index),
            };
            let place = Place::new(term, &ids[index..]);
            let sums = formula.apply(place, &triangle, &mut partials);
            tile.energies.add(simd, index, sums.energy);
            sum.add(sums, ids.len() - index);
            tile.by_area.store(index, partials.area);
            for k in 0..3 {
                tile.by_length_squared[k].store(index, partials.length_squared[k]);
            }
        }
        sum.total()
    }
}

impl<F: VertexFormula> WithLanes for InLanes<'_, VertexTile, F> {
    type Output = Contribution;

    #[inline(always)]
    fn with_lanes<S: Records>(self, simd: S) -> Contribution {
        let Self { term, ids, tile, formula } = self;
        let mut sum = Accumulated::new(simd);
        for index in (0..ids.len()).step_by(Lane::<S>::COUNT) {
            let vertex = tile.known.load::<S, F>(simd, index);
            let before = tile.partials.load::<S, F>(simd, index);
            let mut partials = before;
            let place = Place::new(term, &ids[index..]);
            let mut sums = formula.apply(place, &vertex, &mut partials);
            let count = ids.len() - index;
            sum.add(sums, count);
            if count < Lane::<S>::COUNT {
                // The other lanes may be vertices on borders, which the formula leaves alone.
                let zero = Lane::splat(simd, 0.0);
                // SAFETY: as many ones as count, then zeros, are within the table.
                let counts = unsafe { Lane::load(simd, COUNTS.as_ptr().add(BLOCK - count)) };
                let counts = counts.above(zero);
                sums.energy = sums.energy.or_else(counts, zero);
                partials = chosen(counts, partials, before);
            }
            tile.energies.add(simd, index, sums.energy);
            tile.partials.store::<S, F>(index, partials);
        }
        sum.total()
    }
}
