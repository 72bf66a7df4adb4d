//! The spheres around vertices and edges, in boxes; `search.rs` finds which may be near something.

mod search;

pub use search::Search;

use super::grid::{Grid, bounds};
use crate::mesh::Cell;
use crate::mesh::closest::difference;
use crate::mesh::geometry::Vec3;

/// The largest error of positions in single precision, as a share of their distance from the origin.
pub const ROUNDING: f64 = 4e-7;

/// The sphere around an edge, or around a vertex, which has no size.
#[derive(Clone, Copy)]
pub struct Sphere {
    pub middle: Vec3,
    /// From the middle to the second end.
    pub half: Vec3,
    /// The ends; a vertex twice.
    pub ends: [u32; 2],
    /// The connected part that it is on; 0 unless that matters.
    pub part: u32,
    /// How far its ends may be from where they are here, nm.
    pub room: f32,
}

impl Sphere {
    /// Around a vertex.
    pub fn of_vertex(positions: &[Vec3], vertex: u32, part: u32, room: f32) -> Self {
        let middle = positions[vertex as usize];
        Self { middle, half: Vec3::zeros(), ends: [vertex; 2], part, room }
    }

    /// Around an edge.
    #[inline]
    pub fn of_edge(
        cell: Option<&Cell>,
        positions: &[Vec3],
        ends: [u32; 2],
        part: u32,
        room: f32,
    ) -> Self {
        let [start, end] = ends.map(|end| &positions[end as usize]);
        let half = difference(cell, end, start) * 0.5;
        Self { middle: start + half, half, ends, part, room }
    }

    /// With the room, nm.
    #[inline]
    pub fn radius(&self) -> f64 {
        self.half.norm() + f64::from(self.room)
    }
}

/// An edge by its middle and the way from there to its second end, nm.
#[derive(Clone, Copy)]
pub struct Edge {
    pub ends: [u32; 2],
    pub middle: [f32; 3],
    pub half: [f32; 3],
}

/// Vertices or edges by their middles, sorted into boxes, and some that came later. They are known by their places.
#[derive(Default)]
pub struct Spheres {
    grid: Grid,
    cell: Option<Cell>,
    brick: Option<Brick>,
    origin: Vec3,
    /// Middles and halves, in the order of the boxes, and then as they came.
    middles: [Vec<f32>; 3],
    halves: [Vec<f32>; 3],
    /// NaN for those that have been taken out.
    radii: Vec<f32>,
    ends: Vec<[u32; 2]>,
    parts: Vec<u32>,
    /// How many are in boxes.
    sorted: usize,
    /// The largest radius, nm.
    largest: f64,
    /// How far a position may be off, nm.
    slack: f64,
}

/// A periodic box in single precision.
#[derive(Clone, Copy)]
struct Brick {
    vectors: [[f32; 3]; 3],
}

impl Brick {
    fn new(cell: &Cell) -> Self {
        Self { vectors: cell.vectors().map(|vector| vector.map(|x| x as f32).into()) }
    }

    /// The shortest image.
    #[inline(always)]
    fn shortest(&self, [mut x, mut y, mut z]: [f32; 3]) -> [f32; 3] {
        let [a, b, c] = &self.vectors;
        let k = (z / c[2]).round_ties_even();
        (x, y, z) = (x - k * c[0], y - k * c[1], z - k * c[2]);
        let k = (y / b[1]).round_ties_even();
        (x, y) = (x - k * b[0], y - k * b[1]);
        [x - (x / a[0]).round_ties_even() * a[0], y, z]
    }
}

impl Spheres {
    /// Sort some into boxes of a size, nm.
    pub fn fill(&mut self, cell: Option<&Cell>, size: f64, all: &[Sphere]) {
        let [low, high] = bounds(all.iter().map(|sphere| &sphere.middle));
        (self.cell, self.brick) = (cell.copied(), cell.map(Brick::new));
        self.origin =
            if cell.is_some() || all.is_empty() { Vec3::zeros() } else { (low + high) * 0.5 };
        let extent = match cell {
            Some(cell) => cell.vectors().iter().map(Vec3::norm).sum(),
            None if all.is_empty() => 0.0,
            None => (high - low).norm(),
        };
        self.largest = all.iter().fold(0.0, |most: f64, sphere| most.max(sphere.radius()));
        self.slack = ROUNDING * (extent + 2.0 * self.largest);
        self.grid.set_up(cell, [low, high], size, 8 * all.len());
        for (item, sphere) in all.iter().enumerate() {
            self.grid.add(item as u32, &sphere.middle);
        }
        self.grid.seal();
        let floats = self.middles.iter_mut().chain(&mut self.halves).chain([&mut self.radii]);
        floats.for_each(Vec::clear);
        self.ends.clear();
        self.parts.clear();
        let items = std::mem::take(&mut self.grid);
        for item in items.all_items() {
            self.push(&all[*item as usize]);
        }
        self.grid = items;
        self.sorted = self.len();
    }

    fn push(&mut self, sphere: &Sphere) {
        let middle = self.single(&sphere.middle);
        for k in 0..3 {
            self.middles[k].push(middle[k]);
            self.halves[k].push(sphere.half[k] as f32);
        }
        self.radii.push(sphere.radius() as f32);
        self.ends.push(sphere.ends);
        self.parts.push(sphere.part);
    }

    /// A position from the origin.
    #[inline]
    fn single(&self, position: &Vec3) -> [f32; 3] {
        let mut from = position - self.origin;
        if let Some(cell) = &self.cell {
            from += cell.shift(cell.nearest(&from));
        }
        from.map(|x| x as f32).into()
    }

    /// The box that a position is in, of all that are in boxes.
    pub fn home(&self, position: &Vec3) -> usize {
        self.grid.home(position).unwrap_or(0)
    }

    /// How many places there are, with those of what has been taken out.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// How many have come since they were sorted.
    pub fn num_late(&self) -> usize {
        self.len() - self.sorted
    }

    /// The ends of the edge, or the vertex twice, at a place.
    #[inline]
    pub fn ends(&self, place: usize) -> [u32; 2] {
        self.ends[place]
    }

    /// How far a distance between two places may be off, nm.
    pub fn slack(&self) -> f64 {
        2.0 * self.slack
    }

    /// Add one that is not there, or that has been taken out.
    pub fn put(&mut self, sphere: &Sphere) {
        let place = self.place(sphere).unwrap_or_else(|| {
            self.push(sphere);
            self.len() - 1
        });
        self.radii[place] = sphere.radius() as f32;
        self.largest = self.largest.max(sphere.radius());
    }

    /// Take one out.
    pub fn take(&mut self, sphere: &Sphere) {
        if let Some(place) = self.place(sphere) {
            self.radii[place] = f32::NAN;
        }
    }

    fn place(&self, sphere: &Sphere) -> Option<usize> {
        let home = self.grid.home(&sphere.middle).map_or(0..0, |home| self.grid.run(home));
        let mut places = home.chain(self.sorted..self.len());
        places.find(|place| self.ends(*place) == sphere.ends)
    }

    /// The middle at a place.
    #[inline]
    pub fn middle(&self, place: usize) -> [f32; 3] {
        [0, 1, 2].map(|k| self.middles[k][place])
    }

    /// The edge at a place.
    #[inline]
    pub fn edge(&self, place: usize) -> Edge {
        let half = [0, 1, 2].map(|k| self.halves[k][place]);
        Edge { ends: self.ends(place), middle: self.middle(place), half }
    }

    /// The arms of two edges, as `closest.rs` has them.
    #[inline]
    pub fn arms(&self, one: &Edge, other: &Edge) -> [[f32; 3]; 3] {
        let way = self.between(other.middle, one.middle);
        let away = [0, 1, 2].map(|k| way[k] - one.half[k] + other.half[k]);
        [away, one.half.map(|x| 2.0 * x), other.half.map(|x| 2.0 * x)]
    }

    /// The ends of all that have not been taken out.
    pub fn all_ends(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.len()).filter(|place| !self.radii[*place].is_nan()).map(|place| self.ends(place))
    }

    /// From one middle to another, of the nearest image.
    #[inline]
    pub fn between(&self, from: [f32; 3], to: [f32; 3]) -> [f32; 3] {
        let plain = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        self.brick.map_or(plain, |brick| brick.shortest(plain))
    }
}
