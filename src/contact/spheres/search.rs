//! Which spheres may be near something: those in the boxes around it are looked at many at once.

use super::{Brick, Spheres};
use crate::contact::grid::Around;
use crate::lanes::{Arithmetic, Kernel, run};
use crate::mesh::geometry::Vec3;

/// How many are looked at together.
const LANES: usize = 16;

/// What to look for.
#[derive(Clone, Copy)]
struct Query {
    middle: [f32; 3],
    /// How far spheres may be from the middle at most.
    own: f32,
    /// Larger spheres do not count, nor do spheres of this size whose place is not before that of the one looked for.
    largest: f32,
    before: u32,
    /// Vertices that must not be among the ends.
    corners: [u32; 3],
    /// The part whose spheres do not count.
    part: u32,
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

impl Search {
    /// Forget what was gathered, since other spheres are searched from now on.
    pub fn forget(&mut self) {
        self.around = None;
    }
}

impl Spheres {
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
        // Fill the last lanes with spheres that are never found.
        let room = places.len().next_multiple_of(LANES);
        middles.iter_mut().for_each(|values| values.resize(room, 0.0));
        radii.resize(room, f32::NAN);
        places.resize(room, 0);
        *last = Some(around);
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
