//! Dihedral angles of many edges at once, for a pass over the whole mesh.

use crate::dynamics::instructions::{Arithmetic, Kernel, run};
use crate::mesh::geometry::{EdgeGeometry, bend, is_small, small_bend};

/// Elements that are handled together where the whole mesh is gone over.
pub const CHUNK: usize = 64;

/// Edges whose angles are computed together, as many at once as the processor has lanes.
pub struct Hinges {
    pub halves: [u32; CHUNK],
    pub twins: [u32; CHUNK],
    pub lengths_squared: [f64; CHUNK],
    pub determinants: [f64; CHUNK],
    pub cosines: [f64; CHUNK],
    pub products: [f64; CHUNK],
}

impl Default for Hinges {
    fn default() -> Self {
        // Those that are not filled in are flat.
        let (lengths_squared, determinants) = ([1.0; CHUNK], [0.0; CHUNK]);
        let (cosines, products) = ([1.0; CHUNK], [1.0; CHUNK]);
        let (halves, twins) = ([0; CHUNK], [0; CHUNK]);
        Self { halves, twins, lengths_squared, determinants, cosines, products }
    }
}

impl Hinges {
    /// The first so many.
    pub fn bend(&self, count: usize) -> [EdgeGeometry; CHUNK] {
        struct Small<'a>(&'a Hinges, &'a mut [f64; CHUNK]);
        impl Kernel for Small<'_> {
            #[inline(always)]
            fn execute<A: Arithmetic>(self) {
                let Self(hinges, bends) = self;
                for n in 0..CHUNK {
                    bends[n] = small_bend(
                        hinges.lengths_squared[n],
                        hinges.determinants[n],
                        hinges.cosines[n],
                        hinges.products[n],
                    );
                }
            }
        }
        let mut bends = [0.0; CHUNK];
        run(Small(self, &mut bends));
        let mut edges = [EdgeGeometry::default(); CHUNK];
        for n in 0..count {
            let (length_squared, cosine) = (self.lengths_squared[n], self.cosines[n]);
            edges[n] = EdgeGeometry { length_squared, bend: bends[n] };
            if !is_small(cosine, self.products[n]) {
                edges[n].bend =
                    bend(length_squared, self.determinants[n], cosine, self.products[n]);
            }
        }
        edges
    }
}
