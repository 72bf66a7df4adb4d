//! What passes hand to potentials: the quantities of some elements, column by column.

use super::lanes::{BLOCK, Lane, Records, WithLanes, dispatch};
use super::layout::TILE;
use crate::potentials::{
    Contribution, Place, Sums, Term, Triangle, TriangleFormula, TriangleSlopes, Vertex,
    VertexFormula,
};
use crate::real::Real;
use pulp::Arch;

/// One quantity of the elements of a tile.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct Column(pub [f64; TILE]);

impl Column {
    /// 0 everywhere.
    pub const ZERO: Self = Self([0.0; TILE]);

    #[inline(always)]
    pub fn load<S: Records>(&self, simd: S, index: usize) -> Lane<S> {
        debug_assert!(index + Lane::<S>::COUNT <= TILE);
        // SAFETY: tiles are whole blocks, and lanes divide blocks.
        unsafe { Lane::load(simd, self.0.as_ptr().add(index)) }
    }

    #[inline(always)]
    pub fn store<S: Records>(&mut self, index: usize, value: Lane<S>) {
        debug_assert!(index + Lane::<S>::COUNT <= TILE);
        // SAFETY: as in `load`.
        unsafe { value.store(self.0.as_mut_ptr().add(index)) };
    }
}

/// Triangles, and the derivatives of the energy with respect to them.
pub struct TriangleTile {
    pub twice_area: Column,
    pub dots: [Column; 3],
    pub by_area: Column,
    pub by_length_squared: [Column; 3],
}

/// The quantities of vertices, or the derivatives of the energy with respect to them.
pub struct VertexColumns {
    pub area: Column,
    pub voronoi_area: Column,
    pub curvature: Column,
    pub cotangent: [Column; 3],
    pub umbrella: [Column; 3],
    pub normal_sum: [Column; 3],
}

/// Vertices, and the derivatives of the energy with respect to them.
pub struct VertexTile {
    pub known: VertexColumns,
    pub slopes: VertexColumns,
}

/// The edges at a block of vertices, step by step of their rings.
pub struct EdgeBlock<'a> {
    /// φ / l, 1/nm.
    pub bends: &'a [[f64; BLOCK]],
    /// l², nm².
    pub lengths_squared: &'a [[f64; BLOCK]],
    /// (∂E/∂φ) / l, kJ/mol/nm, to be added to.
    pub moments: &'a mut [[f64; BLOCK]],
    /// How many of the lanes count; the rest repeat other vertices.
    pub lanes: usize,
}

impl TriangleTile {
    /// Nothing.
    pub const EMPTY: Self = Self {
        twice_area: Column::ZERO,
        dots: [Column::ZERO; 3],
        by_area: Column::ZERO,
        by_length_squared: [Column::ZERO; 3],
    };

    /// Apply a formula to the elements with these indices; returns the sum.
    pub fn apply<F: TriangleFormula>(
        &mut self,
        arch: Arch,
        term: &Term,
        ids: &[u32],
        formula: &F,
    ) -> Contribution {
        dispatch(arch, InLanes { term, ids, tile: self, formula })
    }
}

impl VertexColumns {
    const ZERO: Self = Self {
        area: Column::ZERO,
        voronoi_area: Column::ZERO,
        curvature: Column::ZERO,
        cotangent: [Column::ZERO; 3],
        umbrella: [Column::ZERO; 3],
        normal_sum: [Column::ZERO; 3],
    };

    /// Set scalars to 0, and `vectors` and Voronoi areas if they are used.
    pub fn clear(&mut self, vectors: bool) {
        self.area = Column::ZERO;
        self.curvature = Column::ZERO;
        if vectors {
            self.voronoi_area = Column::ZERO;
            self.cotangent = [Column::ZERO; 3];
            self.umbrella = [Column::ZERO; 3];
        }
    }

    #[inline(always)]
    fn load<S: Records>(&self, simd: S, index: usize) -> Vertex<Lane<S>> {
        let vector = |columns: &[Column; 3]| columns.each_ref().map(|x| x.load(simd, index));
        Vertex {
            area: self.area.load(simd, index),
            voronoi_area: self.voronoi_area.load(simd, index),
            curvature: self.curvature.load(simd, index),
            cotangent: vector(&self.cotangent),
            umbrella: vector(&self.umbrella),
            normal_sum: vector(&self.normal_sum),
        }
    }

    #[inline(always)]
    fn store<S: Records>(&mut self, index: usize, vertex: Vertex<Lane<S>>) {
        self.area.store(index, vertex.area);
        self.voronoi_area.store(index, vertex.voronoi_area);
        self.curvature.store(index, vertex.curvature);
        for k in 0..3 {
            self.cotangent[k].store(index, vertex.cotangent[k]);
            self.umbrella[k].store(index, vertex.umbrella[k]);
            self.normal_sum[k].store(index, vertex.normal_sum[k]);
        }
    }
}

impl VertexTile {
    /// Nothing.
    pub const EMPTY: Self = Self { known: VertexColumns::ZERO, slopes: VertexColumns::ZERO };

    /// Apply a formula to the elements with these indices; returns the sum.
    pub fn apply<F: VertexFormula>(
        &mut self,
        arch: Arch,
        term: &Term,
        ids: &[u32],
        formula: &F,
    ) -> Contribution {
        dispatch(arch, InLanes { term, ids, tile: self, formula })
    }
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
        let first = |value: Lane<S>| {
            let mut sum = 0.0;
            let mut lane = 0;
            value.map(|x| {
                sum += if lane < count { x } else { 0.0 };
                lane += 1;
                x
            });
            sum
        };
        let by_parameter = sums.by_parameter.map(first);
        self.rest.add(Sums { energy: first(sums.energy), by_parameter });
    }

    #[inline(always)]
    fn total(self) -> Contribution {
        let mut total = self.rest;
        let by_parameter = self.lanes.by_parameter.map(Lane::sum);
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
            let load = |column: &Column| column.load(simd, index);
            let triangle =
                Triangle { twice_area: load(&tile.twice_area), dots: tile.dots.each_ref().map(load) };
            let mut slopes = TriangleSlopes {
                area: load(&tile.by_area),
                length_squared: tile.by_length_squared.each_ref().map(load),
            };
            let place = Place { term, ids: &ids[index..] };
            sum.add(formula.apply(place, &triangle, &mut slopes), ids.len() - index);
            tile.by_area.store(index, slopes.area);
            for (column, value) in tile.by_length_squared.iter_mut().zip(slopes.length_squared) {
                column.store(index, value);
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
            let vertex = tile.known.load(simd, index);
            let mut slopes = tile.slopes.load(simd, index);
            let place = Place { term, ids: &ids[index..] };
            sum.add(formula.apply(place, &vertex, &mut slopes), ids.len() - index);
            tile.slopes.store(index, slopes);
        }
        sum.total()
    }
}
