//! A grid of cells over some points, or over a periodic box.

use crate::lanes::{Arithmetic, Kernel, run};
use crate::mesh::Cell;
use crate::mesh::cell::MOST_BOXES;
use crate::mesh::geometry::Vec3;

/// Positions whose boxes are found together, in lanes.
pub const TOGETHER: usize = 64;

/// How many periodic boxes away positions may be: a little more than vertices may, since lists look at where they are going.
const FARTHEST: f64 = 1.05 * MOST_BOXES;

/// No box.
pub const NOWHERE: u32 = u32::MAX;

/// Boxes of equal size, with a list of numbers in each.
#[derive(Default)]
pub struct Grid {
    origin: Vec3,
    /// Take a position relative to the origin to coordinates in which a box is a unit cube.
    rows: [Vec3; 3],
    /// The lengths of the rows: how far in these coordinates 1 nm can lead.
    lengths: [f64; 3],
    /// How many boxes there are along each axis.
    counts: [i64; 3],
    periodic: bool,
    starts: Vec<u32>,
    items: Vec<u32>,
    /// Kept for its memory.
    homes: Vec<(u32, u32)>,
}

/// Boxes from a first to a last one along each axis.
type Range = [[i64; 2]; 3];

/// Some boxes of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Around(Range);

impl Around {
    /// Whether all boxes of another one are among these.
    pub fn has(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).all(|(own, other)| own[0] <= other[0] && other[1] <= own[1])
    }
}

impl Grid {
    /// An empty grid whose boxes are about `size` wide, over the periodic box, or else from `low` to `high`; there are not
    /// many more boxes than `most`.
    pub fn set_up(&mut self, cell: Option<&Cell>, [low, high]: [Vec3; 2], size: f64, most: usize) {
        self.periodic = cell.is_some();
        let vectors = match cell {
            Some(cell) => *cell.vectors(),
            None => {
                let extent = (high - low).add_scalar(size * 1e-3);
                [0, 1, 2].map(|k| Vec3::ith(k, extent[k]))
            }
        };
        self.origin = if self.periodic { Vec3::zeros() } else { low.add_scalar(-size * 0.5e-3) };
        let volume = vectors[0].dot(&vectors[1].cross(&vectors[2]));
        // Reciprocal vectors: their lengths are one over the distances of opposite faces.
        let dual = |k: usize| vectors[(k + 1) % 3].cross(&vectors[(k + 2) % 3]) / volume;
        let rows = [dual(0), dual(1), dual(2)];
        let mut size = size;
        let counts = |size: f64| {
            rows.map(|row: Vec3| (1.0 / (row.norm() * size)).floor().clamp(1.0, 1e6) as i64)
        };
        self.counts = counts(size);
        while self.counts.iter().product::<i64>() > most.max(64) as i64 {
            size *= 1.25;
            self.counts = counts(size);
        }
        self.rows = [0, 1, 2].map(|k| rows[k] * self.counts[k] as f64);
        self.lengths = self.rows.map(|row| row.norm());
        self.homes.clear();
    }

    /// Number of boxes.
    fn len(&self) -> usize {
        self.counts.iter().product::<i64>() as usize
    }

    #[inline]
    fn coordinates(&self, position: &Vec3) -> [f64; 3] {
        let from = position - self.origin;
        self.rows.map(|row| row.dot(&from))
    }

    /// The box that a position is in, if there is one. Over a periodic box every position has one, unless it is not finite or
    /// a billion boxes away.
    #[inline]
    pub fn home(&self, position: &Vec3) -> Option<usize> {
        let home = self.home_of([position.x, position.y, position.z]);
        (home != NOWHERE).then_some(home as usize)
    }

    /// The boxes that many positions are in, or [`NOWHERE`]; x, y and z of all of them, one after the other.
    pub fn homes(&self, positions: &[[f64; TOGETHER]; 3]) -> [u32; TOGETHER] {
        struct All<'a>(&'a Grid, &'a [[f64; TOGETHER]; 3], &'a mut [u32; TOGETHER]);
        impl Kernel for All<'_> {
            #[inline(always)]
            fn execute<A: Arithmetic>(self) {
                let Self(grid, [x, y, z], homes) = self;
                for n in 0..TOGETHER {
                    homes[n] = grid.home_of([x[n], y[n], z[n]]);
                }
            }
        }
        let mut homes = [NOWHERE; TOGETHER];
        run(All(self, positions, &mut homes));
        homes
    }

    #[inline(always)]
    fn home_of(&self, [x, y, z]: [f64; 3]) -> u32 {
        let (x, y, z) = (x - self.origin.x, y - self.origin.y, z - self.origin.z);
        let mut index = 0.0;
        let mut is_inside = true;
        for k in [2, 1, 0] {
            let (row, count) = (&self.rows[k], self.counts[k] as f64);
            let mut place = (row.x * x + row.y * y + row.z * z).floor();
            if self.periodic {
                is_inside &= place.abs() < FARTHEST * count;
                place -= (place / count).floor() * count;
            }
            is_inside &= (place >= 0.0) & (place < count);
            index = index * count + place;
        }
        // Numbers of boxes are exact as doubles.
        if is_inside { index as u32 } else { NOWHERE }
    }

    /// Put a number into the box of a position.
    pub fn add(&mut self, item: u32, position: &Vec3) {
        if let Some(home) = self.home(position) {
            self.homes.push((home as u32, item));
        }
    }

    /// Put a number into all boxes that are nearer than `reach` to some points or between them.
    pub fn add_around(&mut self, item: u32, points: &[Vec3], reach: f64) {
        let mut homes = std::mem::take(&mut self.homes);
        self.each(self.range(points, reach), |home| homes.push((home as u32, item)));
        self.homes = homes;
    }

    /// All numbers have been put in. Those of a box are in the order in which they came.
    pub fn seal(&mut self) {
        self.starts.clear();
        self.starts.resize(self.len() + 1, 0);
        for (home, _) in &self.homes {
            self.starts[*home as usize + 1] += 1;
        }
        for home in 0..self.len() {
            self.starts[home + 1] += self.starts[home];
        }
        self.items.resize(self.homes.len(), 0);
        for (home, item) in self.homes.iter().rev() {
            let end = &mut self.starts[*home as usize + 1];
            *end -= 1;
            self.items[*end as usize] = *item;
        }
        // Each end has moved down to where its box begins, and is one place too far back.
        self.starts.remove(0);
        self.starts.push(self.items.len() as u32);
    }

    /// The numbers in a box.
    #[inline]
    pub fn items(&self, home: usize) -> &[u32] {
        &self.items[self.starts[home] as usize..self.starts[home + 1] as usize]
    }

    /// The numbers in all boxes that are nearer than `reach` to some points or between them.
    pub fn near(&self, points: &[Vec3], reach: f64, mut visit: impl FnMut(u32)) {
        let around = Around(self.range(points, reach));
        self.each_run(&around, |run| self.items[run].iter().for_each(|item| visit(*item)));
    }

    /// The numbers in all boxes, one box after another.
    pub fn all_items(&self) -> &[u32] {
        &self.items
    }

    /// The numbers in a box, as places among [`Self::all_items`].
    #[inline]
    pub fn run(&self, home: usize) -> std::ops::Range<usize> {
        self.starts[home] as usize..self.starts[home + 1] as usize
    }

    /// All boxes that are nearer than `reach` to the box of a point; so it is the same for all points of a box.
    #[inline]
    pub fn around(&self, point: &Vec3, reach: f64) -> Around {
        let place = self.coordinates(point);
        Around(std::array::from_fn(|k| {
            let (home, far) = (place[k].floor() as i64, (reach * self.lengths[k]).ceil() as i64);
            self.clip(k, [home - far, home + far])
        }))
    }

    /// Go through the numbers in some boxes, as places among [`Self::all_items`].
    #[inline]
    pub fn each_run(
        &self,
        Around([x, y, z]): &Around,
        mut visit: impl FnMut(std::ops::Range<usize>),
    ) {
        let count = self.counts[0];
        // Boxes that follow each other along an axis have their numbers one after the other.
        let runs = if !self.periodic {
            [[x[0], x[1]], [0, -1]]
        } else {
            let first = x[0].rem_euclid(count);
            let last = first + x[1] - x[0];
            [[first, last.min(count - 1)], [0, last - count]]
        };
        for k in z[0]..=z[1] {
            for j in y[0]..=y[1] {
                let row = (self.wrap(2, k) * self.counts[1] + self.wrap(1, j)) * count;
                for [first, last] in runs.into_iter().filter(|[first, last]| first <= last) {
                    let start = self.starts[(row + first) as usize] as usize;
                    let end = self.starts[(row + last + 1) as usize] as usize;
                    visit(start..end);
                }
            }
        }
    }

    #[inline]
    fn wrap(&self, axis: usize, at: i64) -> i64 {
        if self.periodic { at.rem_euclid(self.counts[axis]) } else { at }
    }

    fn range(&self, points: &[Vec3], reach: f64) -> Range {
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for point in points {
            let place = self.coordinates(point);
            for k in 0..3 {
                range[k] = [range[k][0].min(place[k]), range[k][1].max(place[k])];
            }
        }
        std::array::from_fn(|k| {
            let margin = reach * self.lengths[k];
            let [low, high] = [(range[k][0] - margin).floor(), (range[k][1] + margin).floor()];
            self.clip(k, [low as i64, high as i64])
        })
    }

    /// The boxes of a range along an axis that exist, each once.
    #[inline]
    fn clip(&self, axis: usize, [low, high]: [i64; 2]) -> [i64; 2] {
        let last = self.counts[axis] - 1;
        if !self.periodic {
            [low.max(0), high.min(last)]
        } else if high - low >= last {
            [0, last]
        } else {
            [low, high]
        }
    }

    #[inline]
    fn each(&self, [x, y, z]: Range, mut visit: impl FnMut(usize)) {
        for k in z[0]..=z[1] {
            for j in y[0]..=y[1] {
                let row = (self.wrap(2, k) * self.counts[1] + self.wrap(1, j)) * self.counts[0];
                for i in x[0]..=x[1] {
                    visit((row + self.wrap(0, i)) as usize);
                }
            }
        }
    }
}

/// The corners of a brick around some points.
pub fn bounds<'a>(points: impl IntoIterator<Item = &'a Vec3>) -> [Vec3; 2] {
    let start = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
    points.into_iter().fold(start, |[low, high], point| [low.inf(point), high.sup(point)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::closest::difference;
    use crate::test_meshes::noise;

    /// All points nearer than the reach are found, each once.
    fn check(cell: Option<Cell>) {
        let mut random = noise(5);
        let mut point = || Vec3::from_fn(|_, _| 12.0 * random());
        let points: Vec<_> = (0..300).map(|_| point()).collect();
        let mut grid = Grid::default();
        grid.set_up(cell.as_ref(), bounds(&points), 1.1, 500);
        for (item, at) in points.iter().enumerate() {
            grid.add(item as u32, at);
        }
        grid.seal();
        for _ in 0..100 {
            let centre = point();
            let mut found = Vec::new();
            grid.near(&[centre], 1.7, |item| found.push(item));
            found.sort_unstable();
            assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
            for (item, at) in points.iter().enumerate() {
                if difference(cell.as_ref(), at, &centre).norm() < 1.7 {
                    assert!(found.contains(&(item as u32)));
                }
            }
            assert!(found.len() < 200);
        }
    }

    #[test]
    fn near_points_are_found() {
        check(None);
        check(Some(Cell::new([[9.0, 0.0, 0.0], [2.5, 8.0, 0.0], [-2.0, 2.5, 7.0]]).unwrap()));
    }

    #[test]
    fn a_box_has_what_was_put_into_it_in_order() {
        let mut grid = Grid::default();
        grid.set_up(None, [Vec3::zeros(), Vec3::repeat(3.0)], 1.0, 100);
        for item in 0..50 {
            grid.add_around(item, &[Vec3::repeat(1.5)], if item % 2 == 0 { 0.2 } else { 1.2 });
        }
        grid.seal();
        let middle = grid.home(&Vec3::repeat(1.5)).unwrap();
        assert_eq!(grid.items(middle), (0..50).collect::<Vec<_>>());
        assert_eq!(grid.items(0), (0..25).map(|n| 2 * n + 1).collect::<Vec<_>>());
        assert_eq!(grid.home(&Vec3::new(1.0, 1.0, 3.5)), None);
    }
}
