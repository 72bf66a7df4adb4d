//! Dihedral angles of the few edges around a flip, all at once.

use crate::lanes::{Arithmetic, Kernel, run};
use crate::mesh::geometry::{EdgeGeometry, TriangleGeometry, Vec3, bend, is_small, small_bend};

/// Room for ten edges, in whole registers.
pub const HINGES: usize = 16;

/// Edges whose angles are computed together, as many at once as the processor has lanes.
pub struct Hinges {
    lengths_squared: [f64; HINGES],
    determinants: [f64; HINGES],
    cosines: [f64; HINGES],
    products: [f64; HINGES],
}

impl Default for Hinges {
    fn default() -> Self {
        // Those that are not filled in are flat.
        let (lengths_squared, determinants) = ([1.0; HINGES], [0.0; HINGES]);
        let (cosines, products) = ([1.0; HINGES], [1.0; HINGES]);
        Self { lengths_squared, determinants, cosines, products }
    }
}

impl Hinges {
    /// The edge of a triangle on the left and one on the right; `arm` leads from the tip of the right one to the
    /// edge.
    #[inline(always)]
    pub fn set(
        &mut self,
        place: usize,
        left: &TriangleGeometry,
        right: &TriangleGeometry,
        length_squared: f64,
        arm: &Vec3,
    ) {
        self.lengths_squared[place] = length_squared;
        self.determinants[place] = left.normal.dot(arm);
        self.cosines[place] = left.normal.dot(&right.normal);
        self.products[place] = left.twice_area * right.twice_area;
    }

    /// All of them.
    #[inline]
    pub fn bend(&self) -> [EdgeGeometry; HINGES] {
        struct Small<'a>(&'a Hinges, &'a mut [f64; HINGES]);
        impl Kernel for Small<'_> {
            #[inline(always)]
            fn execute<A: Arithmetic>(self) {
                let Self(hinges, bends) = self;
                for n in 0..HINGES {
                    bends[n] = small_bend(
                        hinges.lengths_squared[n],
                        hinges.determinants[n],
                        hinges.cosines[n],
                        hinges.products[n],
                    );
                }
            }
        }
        let mut bends = [0.0; HINGES];
        run(Small(self, &mut bends));
        std::array::from_fn(|n| {
            let (length_squared, cosine) = (self.lengths_squared[n], self.cosines[n]);
            let (determinant, product) = (self.determinants[n], self.products[n]);
            let bend = if is_small(cosine, product) {
                bends[n]
            } else {
                bend(length_squared, determinant, cosine, product)
            };
            EdgeGeometry { length_squared, bend }
        })
    }
}
