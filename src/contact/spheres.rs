//! Which vertices or edges may be near something: by the spheres around them, in boxes.

use super::closest::difference;
use super::grid::{Around, Grid, bounds};
use crate::dynamics::instructions::{Arithmetic, Kernel, run};
use crate::mesh::Cell;
use crate::mesh::geometry::Vec3;

/// How many are looked at together.
const LANES: usize = 16;

/// What positions in single precision may be off by, as a share of how far they are from the origin.
const ROUNDING: f64 = 4e-7;

/// What is around an edge, or a vertex of no size.
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

/// What to look for.
#[derive(Clone, Copy)]
pub struct Query {
    middle: [f32; 3],
    /// How far spheres may be from the middle at most.
    own: f32,
    /// Larger spheres do not count, nor do those as large from a place on.
    largest: f32,
    before: u32,
    /// Vertices that must not be among the ends.
    corners: [u32; 3],
    /// The part that does not count.
    part: u32,
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
    /// No number for those that have been taken out.
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

/// The spheres around the one that was looked for last, side by side, and what was found.
#[derive(Default)]
pub struct Search {
    around: Option<Around>,
    middles: [Vec<f32>; 3],
    radii: Vec<f32>,
    places: Vec<u32>,
    /// The places that were found.
    pub found: Vec<u32>,
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

    /// How many places there are, those of what has been taken out among them.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// How many have come since they were sorted.
    pub fn num_late(&self) -> usize {
        self.len() - self.sorted
    }

    /// The ends of the one at a place.
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

    /// Find what may be nearer than `range` to the edge at a place, shares no vertex with it, is on another part if that
    /// matters, and is smaller, so that of two edges one finds the other.
    pub fn find_smaller(&self, place: usize, range: f64, between_parts: bool, search: &mut Search) {
        let (middle, radius) = (self.middle(place), self.radii[place]);
        let reach = range + self.slack() + f64::from(radius);
        let [a, b] = self.ends(place);
        let part = if between_parts { self.parts[place] } else { u32::MAX };
        let query = Query {
            middle,
            own: reach as f32 * (1.0 + 1e-6),
            largest: radius,
            before: place as u32,
            corners: [a, b, b],
            part,
        };
        let position = self.origin + Vec3::from(middle.map(f64::from));
        self.search(&position, reach + f64::from(radius), &query, search);
    }

    /// Find what may be nearer than `range` to something around `middle` and has none of some corners; returns the middle
    /// as it is here.
    pub fn find(
        &self,
        (middle, radius): (&Vec3, f64),
        range: f64,
        corners: [u32; 3],
        part: u32,
        search: &mut Search,
    ) -> [f32; 3] {
        let reach = range + self.slack() + radius;
        let query = Query {
            middle: self.single(middle),
            own: reach as f32 * (1.0 + 1e-6),
            largest: f32::INFINITY,
            before: 0,
            corners,
            part,
        };
        self.search(middle, reach + self.largest, &query, search);
        query.middle
    }

    fn search(&self, middle: &Vec3, reach: f64, query: &Query, search: &mut Search) {
        // A little more, as a middle in single precision may have changed boxes.
        let around = self.grid.around(middle, (reach + self.slack) * (1.0 + 1e-6));
        if !search.around.as_ref().is_some_and(|last| last.has(&around)) {
            self.collect(around, search);
        }
        search.found.clear();
        run(Sift { brick: self.brick, query, search });
        let Query { largest, before, corners, part, .. } = *query;
        search.found.retain(|found| {
            let place = *found as usize;
            let counts = self.radii[place] < largest || *found < before;
            let [a, b] = self.ends(place);
            let shares = corners.iter().fold(false, |any, c| any | (*c == a) | (*c == b));
            counts & !shares & (self.parts[place] != part)
        });
    }

    /// Put what is in some boxes, and what came later, side by side.
    fn collect(&self, around: Around, search: &mut Search) {
        let Search { around: last, middles, radii, places, .. } = search;
        middles.iter_mut().chain([&mut *radii]).for_each(Vec::clear);
        places.clear();
        let mut copy = |run: std::ops::Range<usize>| {
            for k in 0..3 {
                middles[k].extend_from_slice(&self.middles[k][run.clone()]);
            }
            radii.extend_from_slice(&self.radii[run.clone()]);
            places.extend(run.start as u32..run.end as u32);
        };
        self.grid.each_run(&around, |run| {
            if !run.is_empty() {
                copy(run);
            }
        });
        copy(self.sorted..self.len());
        // None is in the lanes that are left.
        let room = places.len().next_multiple_of(LANES);
        middles.iter_mut().for_each(|values| values.resize(room, 0.0));
        radii.resize(room, f32::NAN);
        places.resize(room, 0);
        *last = Some(around);
    }
}

impl Search {
    /// Other spheres are searched from now on.
    pub fn forget(&mut self) {
        self.around = None;
    }
}

struct Sift<'a> {
    brick: Option<Brick>,
    query: &'a Query,
    search: &'a mut Search,
}

impl Kernel for Sift<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        match self.brick {
            None => self.sift(|way| way),
            Some(brick) => self.sift(|way| brick.shortest(way)),
        }
    }
}

impl Sift<'_> {
    /// Find what is near and not too large.
    #[inline(always)]
    fn sift(self, shortest: impl Fn([f32; 3]) -> [f32; 3]) {
        let Query { middle, own, largest, .. } = *self.query;
        let Search { middles: [x, y, z], radii, places, found, .. } = self.search;
        let [x, y, z, radii] = [x, y, z, radii].map(|values| values.as_chunks::<LANES>().0);
        let places = places.as_chunks::<LANES>().0;
        for ((((x, y), z), radii), places) in x.iter().zip(y).zip(z).zip(radii).zip(places) {
            let mut near = [0_u32; LANES];
            for n in 0..LANES {
                let way = shortest([x[n] - middle[0], y[n] - middle[1], z[n] - middle[2]]);
                let squared = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
                let most = own + radii[n];
                near[n] = u32::from((squared < most * most) & (radii[n] <= largest)) << n;
            }
            let mut bits = near.iter().fold(0, |all, bit| all | bit);
            while bits != 0 {
                found.push(places[bits.trailing_zeros() as usize]);
                bits &= bits - 1;
            }
        }
    }
}
