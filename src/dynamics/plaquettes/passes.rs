//! The passes over triangles and vertices, in lanes.

use super::layout::Layout;
use super::{LANES, Lanes, Vectors};
use crate::dynamics::instructions::{Arithmetic, Kernel, run};
use crate::mesh::Cell;
use crate::mesh::geometry::Vec3;
use std::ops::Range;

/// A vector in each lane, from its places.
#[inline(always)]
fn load(values: &[f64], places: &[u32; LANES]) -> Vectors {
    let mut loaded = Vectors::default();
    for (lane, &place) in places.iter().enumerate() {
        let place = place as usize;
        let values = &values[place..place + 2 * LANES + 1];
        for axis in 0..3 {
            loaded[axis][lane] = values[axis * LANES];
        }
    }
    loaded
}

/// a − b.
#[inline(always)]
fn minus(a: &Vectors, b: &Vectors) -> Vectors {
    std::array::from_fn(|axis| std::array::from_fn(|lane| a[axis][lane] - b[axis][lane]))
}

/// a × b.
#[inline(always)]
fn cross<A: Arithmetic>(a: &Vectors, b: &Vectors) -> Vectors {
    std::array::from_fn(|axis| {
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        std::array::from_fn(|lane| {
            A::multiply_add(a[j][lane], b[k][lane], -(a[k][lane] * b[j][lane]))
        })
    })
}

/// |a|.
#[inline(always)]
fn norm<A: Arithmetic>(a: &Vectors) -> Lanes {
    std::array::from_fn(|lane| {
        let square = A::multiply_add(a[1][lane], a[1][lane], a[0][lane] * a[0][lane]);
        A::multiply_add(a[2][lane], a[2][lane], square).sqrt()
    })
}

/// The sides from the first corner to the others.
#[inline(always)]
fn sides(corners: &[[u32; LANES]; 3], positions: &[f64], cell: Option<&Cell>) -> [Vectors; 2] {
    let [a, b, c] = [0, 1, 2].map(|k| load(positions, &corners[k]));
    let mut sides = [minus(&b, &a), minus(&c, &a)];
    if let Some(cell) = cell {
        for side in &mut sides {
            for lane in 0..LANES {
                let plain = Vec3::new(side[0][lane], side[1][lane], side[2][lane]);
                let nearest = plain + cell.shift(cell.nearest(&plain));
                (0..3).for_each(|axis| side[axis][lane] = nearest[axis]);
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
        (0..LANES).for_each(|lane| sums[lane] += areas[lane]);
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
            let [ab, ac] = sides(corners, positions, cell);
            *areas = norm::<A>(&cross::<A>(&ab, &ac)).map(|twice| 0.5 * twice);
        }
        *self.sum = sum(self.areas, padding);
    }
}

/// The same with the gradients: ∂aₜ/∂r = n̂ × (c − b) / 2 at a corner, from b to c the side opposite to it.
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
        let results = self.areas.iter_mut().zip(self.gradients);
        for (corners, (areas, gradients)) in corners.iter().zip(results) {
            let [ab, ac] = sides(corners, positions, cell);
            let normal = cross::<A>(&ab, &ac);
            let twice = norm::<A>(&normal);
            *areas = twice.map(|twice| 0.5 * twice);
            let half_unit: Vectors =
                normal.map(|n| std::array::from_fn(|lane| 0.5 * n[lane] / twice[lane]));
            let bc = minus(&ac, &ab);
            let ca = ac.map(|x| x.map(|x| -x));
            *gradients = [bc, ca, ab].map(|opposite| cross::<A>(&half_unit, &opposite));
        }
        *self.sum = sum(self.areas, padding);
    }
}

/// aᵢ of some groups of vertices.
pub fn gather_areas(
    layout: &Layout,
    groups: Range<usize>,
    of_triangles: &[Lanes],
    areas: &mut [Lanes],
) {
    let of_triangles = of_triangles.as_flattened();
    for (group, areas) in groups.zip(areas) {
        let mut sums = Lanes::default();
        for [triangles, _] in &layout.around[layout.around_of(group)] {
            for (sum, &triangle) in sums.iter_mut().zip(triangles) {
                *sum += of_triangles[triangle as usize];
            }
        }
        *areas = sums.map(|sum| sum / 3.0);
    }
}

/// The derivatives of areas with respect to the positions of some groups of vertices.
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
        let first = self.layout.neighbours_of(self.groups.clone()).start;
        for (group, total) in self.groups.zip(self.totals) {
            *total = Vectors::default();
            for [_, places] in &self.layout.around[self.layout.around_of(group)] {
                let gradient = load(self.gradients, places);
                for axis in 0..3 {
                    (0..LANES).for_each(|lane| total[axis][lane] += gradient[axis][lane]);
                }
            }
            for slot in self.layout.neighbours_of(group..group + 1) {
                let [before, after] = self.layout.neighbours[slot].gradients;
                let (before, after) = (load(self.gradients, &before), load(self.gradients, &after));
                self.neighbours[slot - first] = std::array::from_fn(|axis| {
                    std::array::from_fn(|lane| (before[axis][lane] + after[axis][lane]) / 3.0)
                });
            }
        }
    }
}
