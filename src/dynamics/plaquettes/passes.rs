//! The passes over triangles and vertices, in lanes.
//!
//! Lanes are gone through by loops: calls of `array::map` and `from_fn` would not be compiled for the instruction set of
//! the kernel that they are in.

use super::layout::Layout;
use super::{LANES, Lanes, THIRD, Vectors};
use crate::lanes::{Arithmetic, Kernel, run};
use crate::mesh::Cell;
use crate::mesh::geometry::Vec3;
use std::ops::Range;

/// A vector in each lane, from its places.
#[inline(always)]
fn load(values: &[f64], places: &[u32; LANES]) -> Vectors {
    let (mut x, mut y, mut z) = (Lanes::default(), Lanes::default(), Lanes::default());
    for lane in 0..LANES {
        let place = places[lane] as usize;
        let values = &values[place..place + 2 * LANES + 1];
        x[lane] = values[0];
        y[lane] = values[LANES];
        z[lane] = values[2 * LANES];
    }
    [x, y, z]
}

/// a + s b.
#[inline(always)]
fn plus<A: Arithmetic>(a: &Vectors, s: f64, b: &Vectors) -> Vectors {
    let (mut x, mut y, mut z) = (a[0], a[1], a[2]);
    for lane in 0..LANES {
        x[lane] = A::multiply_add(s, b[0][lane], a[0][lane]);
        y[lane] = A::multiply_add(s, b[1][lane], a[1][lane]);
        z[lane] = A::multiply_add(s, b[2][lane], a[2][lane]);
    }
    [x, y, z]
}

/// s a.
#[inline(always)]
fn times(s: &Lanes, a: &Vectors) -> Vectors {
    let (mut x, mut y, mut z) = (a[0], a[1], a[2]);
    for lane in 0..LANES {
        x[lane] *= s[lane];
        y[lane] *= s[lane];
        z[lane] *= s[lane];
    }
    [x, y, z]
}

/// a d − b c.
#[inline(always)]
fn determinant<A: Arithmetic>(a: &Lanes, b: &Lanes, c: &Lanes, d: &Lanes) -> Lanes {
    let mut results = Lanes::default();
    for lane in 0..LANES {
        results[lane] = A::multiply_add(a[lane], d[lane], -(b[lane] * c[lane]));
    }
    results
}

/// a × b.
#[inline(always)]
fn cross<A: Arithmetic>(a: &Vectors, b: &Vectors) -> Vectors {
    [
        determinant::<A>(&a[1], &a[2], &b[1], &b[2]),
        determinant::<A>(&a[2], &a[0], &b[2], &b[0]),
        determinant::<A>(&a[0], &a[1], &b[0], &b[1]),
    ]
}

/// |a|.
#[inline(always)]
fn norm<A: Arithmetic>(a: &Vectors) -> Lanes {
    let mut norm = Lanes::default();
    for lane in 0..LANES {
        let square = A::multiply_add(a[1][lane], a[1][lane], a[0][lane] * a[0][lane]);
        norm[lane] = A::multiply_add(a[2][lane], a[2][lane], square).sqrt();
    }
    norm
}

/// The sides from the first corner to the others.
#[inline(always)]
fn sides<A: Arithmetic>(
    corners: &[[u32; LANES]; 3],
    positions: &[f64],
    cell: Option<&Cell>,
) -> [Vectors; 2] {
    let a = load(positions, &corners[0]);
    let (b, c) = (load(positions, &corners[1]), load(positions, &corners[2]));
    let mut sides = [plus::<A>(&b, -1.0, &a), plus::<A>(&c, -1.0, &a)];
    if let Some(cell) = cell {
        for side in &mut sides {
            for lane in 0..LANES {
                let plain = Vec3::new(side[0][lane], side[1][lane], side[2][lane]);
                let nearest = plain + cell.shift(cell.nearest(&plain));
                for axis in 0..3 {
                    side[axis][lane] = nearest[axis];
                }
            }
        }
    }
    sides
}

/// The sum over all lanes, of those that pad nothing.
#[inline(always)]
fn sum(areas: &mut [Lanes], padding: usize) -> f64 {
    if let Some(last) = areas.last_mut() {
        last[LANES - padding..].fill(0.0);
    }
    let mut sums = Lanes::default();
    for areas in areas {
        for lane in 0..LANES {
            sums[lane] += areas[lane];
        }
    }
    sums.iter().sum()
}

/// What the passes over triangles of a tile read.
struct Triangles<'a> {
    corners: &'a [[[u32; LANES]; 3]],
    positions: &'a [f64],
    cell: Option<&'a Cell>,
    padding: usize,
}

impl<'a> Triangles<'a> {
    fn new(
        layout: &'a Layout,
        tile: usize,
        positions: &'a [Vectors],
        cell: Option<&'a Cell>,
    ) -> Self {
        let tile = &layout.triangle_tiles[tile];
        Self {
            corners: &layout.corners[tile.groups()],
            positions: positions.as_flattened().as_flattened(),
            cell: cell.filter(|_| layout.is_periodic[tile.surface]),
            padding: tile.padding,
        }
    }
}

/// The areas of a tile's triangles and their sum.
pub struct Areas<'a> {
    triangles: Triangles<'a>,
    areas: &'a mut [Lanes],
    sum: &'a mut f64,
}

impl<'a> Areas<'a> {
    pub fn run(
        layout: &'a Layout,
        tile: usize,
        positions: &'a [Vectors],
        cell: Option<&'a Cell>,
        areas: &'a mut [Lanes],
        sum: &'a mut f64,
    ) {
        run(Self { triangles: Triangles::new(layout, tile, positions, cell), areas, sum });
    }
}

impl Kernel for Areas<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let Triangles { corners, positions, cell, padding } = self.triangles;
        for (corners, areas) in corners.iter().zip(&mut *self.areas) {
            let [ab, ac] = sides::<A>(corners, positions, cell);
            let twice = norm::<A>(&cross::<A>(&ab, &ac));
            for lane in 0..LANES {
                areas[lane] = 0.5 * twice[lane];
            }
        }
        *self.sum = sum(self.areas, padding);
    }
}

/// The same with the gradients: ∂aₜ/∂r = n̂ × (c − b) / 2 at a corner, from b to c the side opposite to it. The sum is
/// no number if a triangle has none.
pub struct Gradients<'a> {
    triangles: Triangles<'a>,
    areas: &'a mut [Lanes],
    gradients: &'a mut [[Vectors; 3]],
    sum: &'a mut f64,
}

impl<'a> Gradients<'a> {
    pub fn run(
        layout: &'a Layout,
        tile: usize,
        positions: &'a [Vectors],
        cell: Option<&'a Cell>,
        areas: &'a mut [Lanes],
        gradients: &'a mut [[Vectors; 3]],
        sum: &'a mut f64,
    ) {
        let triangles = Triangles::new(layout, tile, positions, cell);
        run(Self { triangles, areas, gradients, sum });
    }
}

impl Kernel for Gradients<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let Triangles { corners, positions, cell, padding } = self.triangles;
        let mut inverses = Lanes::default();
        let results = self.areas.iter_mut().zip(self.gradients);
        for (corners, (areas, gradients)) in corners.iter().zip(results) {
            let [ab, ac] = sides::<A>(corners, positions, cell);
            let mut normal = cross::<A>(&ab, &ac);
            let twice = norm::<A>(&normal);
            let (mut halves, mut scale) = (twice, twice);
            for lane in 0..LANES {
                halves[lane] *= 0.5;
                scale[lane] = 0.5 / twice[lane];
                inverses[lane] += scale[lane];
            }
            normal = times(&scale, &normal);
            let (at_b, at_c) = (cross::<A>(&ac, &normal), cross::<A>(&normal, &ab));
            // A triangle that is moved as a whole keeps its area.
            *gradients = [times(&[-1.0; LANES], &plus::<A>(&at_b, 1.0, &at_c)), at_b, at_c];
            *areas = halves;
        }
        // A triangle without area has no gradient.
        let all_have_areas = inverses.iter().sum::<f64>().is_finite();
        *self.sum = if all_have_areas { sum(self.areas, padding) } else { f64::NAN };
    }
}

/// aᵢ of some groups of vertices.
pub struct GatherAreas<'a> {
    pub layout: &'a Layout,
    pub groups: Range<usize>,
    pub of_triangles: &'a [Lanes],
    pub areas: &'a mut [Lanes],
}

impl GatherAreas<'_> {
    pub fn run(self) {
        run(self);
    }
}

impl Kernel for GatherAreas<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let of_triangles = self.of_triangles.as_flattened();
        for (group, areas) in self.groups.zip(self.areas) {
            let mut sums = Lanes::default();
            for triangles in &self.layout.around[self.layout.slots_of(group..group + 1)] {
                for lane in 0..LANES {
                    sums[lane] += of_triangles[triangles[lane] as usize];
                }
            }
            for lane in 0..LANES {
                areas[lane] = sums[lane] * THIRD;
            }
        }
    }
}

/// The derivatives of areas with respect to the positions of some groups of vertices. In slots without a neighbour they
/// are anything finite.
pub struct Gather<'a> {
    layout: &'a Layout,
    groups: Range<usize>,
    gradients: &'a [f64],
    totals: &'a mut [Vectors],
    neighbours: &'a mut [Vectors],
}

impl<'a> Gather<'a> {
    pub fn run(
        layout: &'a Layout,
        groups: Range<usize>,
        gradients: &'a [[Vectors; 3]],
        totals: &'a mut [Vectors],
        neighbours: &'a mut [Vectors],
    ) {
        let gradients = gradients.as_flattened().as_flattened().as_flattened();
        run(Self { layout, groups, gradients, totals, neighbours });
    }
}

impl Kernel for Gather<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let mut neighbours = self.neighbours.iter_mut();
        for (group, total) in self.groups.zip(self.totals) {
            let mut before = load(self.gradients, &self.layout.before[group]);
            let mut sum = Vectors::default();
            for places in &self.layout.gradients[self.layout.slots_of(group..group + 1)] {
                let after = load(self.gradients, places);
                let neighbour = neighbours.next().expect("as many as slots");
                sum = plus::<A>(&sum, 1.0, &after);
                *neighbour = times(&[THIRD; LANES], &plus::<A>(&before, 1.0, &after));
                before = after;
            }
            *total = sum;
        }
    }
}
