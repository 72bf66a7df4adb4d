//! What passes hand to potentials: the quantities of some elements, column by column.
//!
//! A potential gets a whole tile by one dynamic call, or a block of rings where it acts on angles.

use super::{BLOCK, Lane, Records};

/// Elements that are handled together: what a tile needs between passes stays in the nearest cache. Sums
/// are formed within tiles and then over tiles in order, whatever the number of threads, so this number is
/// part of what decides the last bits.
pub const TILE: usize = 128;

/// Which lanes of a last block that is not full count: as many ones from `BLOCK` − that many on, then zeros.
pub static COUNTS: [f64; 2 * BLOCK] = {
    let mut counts = [0.0; 2 * BLOCK];
    let mut lane = 0;
    while lane < BLOCK {
        counts[lane] = 1.0;
        lane += 1;
    }
    counts
};

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

/// The three components of a vector.
#[inline(always)]
pub fn load3<S: Records>(simd: S, columns: &[Column; 3], index: usize) -> [Lane<S>; 3] {
    [columns[0].load(simd, index), columns[1].load(simd, index), columns[2].load(simd, index)]
}

/// Triangles, and the derivatives of the energy with respect to them.
pub struct TriangleTile {
    pub twice_area: Column,
    pub dots: [Column; 3],
    pub by_area: Column,
    pub by_length_squared: [Column; 3],
    /// Whether no formula has acted, so that the derivatives are zero.
    pub silent: bool,
    pub energies: Energies,
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

/// The energy of each element, if somebody wants to know.
pub struct Energies {
    pub wanted: bool,
    pub sum: Column,
}

impl Energies {
    const UNWANTED: Self = Self { wanted: false, sum: Column::ZERO };

    /// Begin a tile.
    pub fn begin(&mut self, wanted: bool) {
        self.wanted = wanted;
        if wanted {
            self.sum = Column::ZERO;
        }
    }

    #[inline(always)]
    pub fn add<S: Records>(&mut self, simd: S, index: usize, energy: Lane<S>) {
        if self.wanted {
            self.sum.store(index, self.sum.load(simd, index) + energy);
        }
    }
}

/// Vertices, and the derivatives of the energy with respect to them.
pub struct VertexTile {
    pub energies: Energies,
    pub known: VertexColumns,
    pub partials: VertexColumns,
    /// tan(φ/2) / l and l² of the edges of a block, step by step.
    pub ring: Vec<[[f64; BLOCK]; 2]>,
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
    /// The places of the edges among the values of edges, [`NONE`](crate::mesh::NONE) where there is no dihedral angle,
    /// for who asks.
    pub names: &'a dyn Fn() -> &'a [[u32; BLOCK]],
}

impl TriangleTile {
    /// Nothing.
    pub const EMPTY: Self = Self {
        twice_area: Column::ZERO,
        dots: [Column::ZERO; 3],
        by_area: Column::ZERO,
        by_length_squared: [Column::ZERO; 3],
        silent: true,
        energies: Energies::UNWANTED,
    };
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
}

impl VertexTile {
    /// For rings of so many steps.
    pub fn new(steps: usize) -> Self {
        let (known, partials) = (VertexColumns::ZERO, VertexColumns::ZERO);
        let energies = Energies::UNWANTED;
        Self { energies, known, partials, ring: vec![[[0.0; BLOCK]; 2]; steps] }
    }
}
