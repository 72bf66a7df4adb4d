//! Which vertices may touch which triangles of a surface, and which edges which edges.
//!
//! Two lists, one within the other, hold the pairs that can come within reach as long as every vertex stays in a ball around
//! its place in a **reference**; pairs that share a vertex are left out. Vertices fly straight on for a while, so the
//! reference is where they will be after half of the list's **life**, and a ball has room for the way there and for some
//! straying. The outer list has a long life and is made with boxes (`outer.rs`). The inner one has a short life, is chosen
//! from the outer one (`inner.rs`), and is what evaluations go through. Pairs are named by their vertices, and the inner
//! list is in ascending order of these, so that no result depends on when lists were made. After flips, pairs of triangles
//! and edges that are gone are taken out and those of new ones are added (`following.rs`).

use super::spheres::{Search, Sphere, Spheres};
use crate::error::Result;
use crate::lanes::{Arithmetic, Kernel, run};
use crate::mesh::cell::check_places;
use crate::mesh::geometry::Vec3;
use crate::mesh::{Cell, Triangulation};
use crate::team::Team;

/// The vertices of a pair: a vertex and the corners of a triangle from the lowest on, or the ends of two edges, the lower end
/// of each and the lower edge first.
pub type Pair = [u32; 4];

/// A pair of the outer list, with a lower bound of its distance in the reference, nm.
#[derive(Clone, Copy)]
pub struct Far {
    pub pair: Pair,
    pub distance: f32,
}

/// Lists for one mesh.
#[derive(Default)]
pub struct Lists {
    pub(super) made_for: Option<Made>,
    /// All vertices as they are now.
    pub(super) positions: Vec<Vec3>,
    pub(super) outer: Balls,
    pub(super) inner: Balls,
    /// For each vertex how far it may be from its place in the outer reference while it is in its ball of the inner list, nm.
    pub(super) moved: Vec<f32>,
    /// Where vertices were when the last list was made, and how many refreshes ago that was.
    pub(super) last: Vec<Vec3>,
    pub(super) since: usize,
    /// How many refreshes ago the outer list was made, and how many the outer and the inner one usually last.
    pub(super) age: usize,
    pub(super) lives: [f64; 2],
    /// How far vertices may stray in the outer list, in median edges, and in the inner one, as a share of that; none before the
    /// first lists.
    pub(super) shares: Option<[f64; 2]>,
    /// The triangles for which the lists were made.
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each vertex the connected part that it is on; empty unless that matters.
    pub(super) parts: Vec<u32>,
    /// The vertices and the edges of the outer reference; what is near no other part is left out.
    pub(super) vertices: Spheres,
    pub(super) edges: Spheres,
    /// Of vertices with triangles, and of edges, in any order.
    pub(super) far: [Vec<Far>; 2],
    /// Those of the inner list, ascending.
    pub(super) near: [Vec<Pair>; 2],
    /// Kept for their memory, `scratch` one for each thread.
    pub(super) scratch: Vec<Scratch>,
    pub(super) all: Vec<Sphere>,
    pub(super) cost: Cost,
}

#[derive(Default)]
pub struct Scratch {
    pub far: [Vec<Far>; 2],
    pub near: [Vec<Pair>; 2],
    pub search: Search,
}

/// What lists have cost since they were made; an evaluation of a pair costs 1.
#[derive(Default)]
pub struct Cost {
    /// In evaluations with the present inner list.
    pub looking: f64,
    /// To make the present inner list.
    pub choosing: f64,
    /// Both together, since the present outer list was made.
    pub all: f64,
}

/// What lists depend on, beside the reference and the triangles.
#[derive(Clone, Copy)]
pub struct Made {
    pub reach: f64,
    pub between_parts: bool,
    pub cell: Option<Cell>,
    pub fingerprint: u64,
    /// The median edge, and the length of which straying is a share, nm.
    pub median: f64,
    pub size: f64,
}

impl Lists {
    /// See to it that the lists have all pairs up to `reach` at some positions of all particles; with `between_parts` only
    /// those of different parts of the surface.
    ///
    /// # Errors
    /// A position that is not finite or too far away; a box that is too small.
    pub fn refresh(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        positions: &[f64],
        (reach, between_parts): (f64, bool),
        team: &mut Team,
    ) -> Result<()> {
        let at =
            |particle: &u32| Vec3::from_column_slice(&positions[3 * *particle as usize..][..3]);
        self.positions.clear();
        self.positions.extend(mesh.particles().iter().map(at));
        // Lists of a longer reach are good, too: force groups may take turns.
        let good = self.made_for.filter(|made| {
            made.reach >= reach && made.between_parts <= between_parts && made.cell.as_ref() == cell
        });
        (self.since, self.age) = (self.since + 1, self.age + 1);
        if let Some(mut made) = good
            && self.outer.have(&self.positions)
            && (made.fingerprint == mesh.fingerprint() || self.follow_flips(mesh, &made))
        {
            made.fingerprint = mesh.fingerprint();
            if !self.inner.have(&self.positions) {
                self.adapt_inner();
                self.choose(&made, team);
            }
            self.made_for = Some(made);
            self.cost.looking += self.work() as f64;
            return Ok(());
        }
        self.made_for = None;
        check_places(cell, mesh.particles(), &self.positions)?;
        let made = self.make(mesh, cell, (reach, between_parts), team)?;
        self.made_for = Some(made);
        self.choose(&made, team);
        self.cost.looking = self.work() as f64;
        Ok(())
    }

    /// Make all lists anew at the next refresh.
    pub fn forget(&mut self) {
        self.made_for = None;
    }

    /// All vertices at the last refresh.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Pairs of a vertex and a triangle, and of edges, that may be within reach.
    pub fn pairs(&self) -> &[Vec<Pair>; 2] {
        &self.near
    }

    /// The number of these pairs.
    pub fn work(&self) -> usize {
        self.near[0].len() + self.near[1].len()
    }

    /// The connected part that a vertex is on; 0 where parts do not matter.
    #[inline]
    pub(super) fn part(&self, vertex: u32) -> u32 {
        self.parts.get(vertex as usize).copied().unwrap_or(0)
    }

    /// The part whose vertices make no pairs with a vertex; a number that no part has where parts do not matter.
    #[inline]
    pub(super) fn own_part(&self, vertex: u32) -> u32 {
        self.parts.get(vertex as usize).copied().unwrap_or(u32::MAX)
    }
}

const LANES: usize = 8;

/// A ball for each vertex.
#[derive(Default)]
pub struct Balls {
    pub middles: Vec<Vec3>,
    /// The radii, and their squares or a little less, nm.
    pub rooms: Vec<f32>,
    squares: Vec<f64>,
}

/// How long a list usually lasts, after one that lasted for `age` refreshes.
pub fn usual(life: f64, age: usize) -> f64 {
    // The factors add up to more than 1, so that a list that lasts as long as expected makes the next one longer.
    0.5 * life + 0.6 * age as f64
}

impl Balls {
    /// Put the balls where vertices are going: each has moved from `last` to `now` in `since` refreshes, and goes on like that
    /// for half of `life`, but by no more than `longest`, nm. Balls have room for that way and for straying.
    pub fn aim(
        &mut self,
        now: &[Vec3],
        (last, since): (&[Vec3], usize),
        life: f64,
        (stray, longest): (f64, f64),
    ) {
        let knows = last.len() == now.len() && since > 0;
        let ahead = if knows { 0.5 * life / since as f64 } else { 0.0 };
        self.middles.clear();
        for (vertex, now) in now.iter().enumerate() {
            let mut way = if knows { (now - last[vertex]) * ahead } else { Vec3::zeros() };
            let length = way.norm();
            if length > longest {
                way *= longest / length;
            }
            self.middles.push(now + way);
        }
        self.rooms.clear();
        let ways = self.middles.iter().zip(now).map(|(there, now)| (there - now).norm());
        self.rooms.extend(ways.map(|way| (way + stray) as f32));
        self.squares.clear();
        let square = |room: &f32| f64::from(*room).powi(2) * (1.0 - 1e-9);
        self.squares.extend(self.rooms.iter().map(square));
    }

    /// Whether all vertices are in their balls.
    pub fn have(&self, positions: &[Vec3]) -> bool {
        let mut all = false;
        run(Within { positions, balls: self, all: &mut all });
        all
    }

    /// The largest radius.
    pub fn largest(&self) -> f64 {
        f64::from(self.rooms.iter().copied().fold(0.0, f32::max))
    }

    /// The larger room of two.
    #[inline]
    pub fn room_of(&self, [a, b]: [u32; 2]) -> f32 {
        self.rooms[a as usize].max(self.rooms[b as usize])
    }
}

struct Within<'a> {
    positions: &'a [Vec3],
    balls: &'a Balls,
    all: &'a mut bool,
}

impl Kernel for Within<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        // A NaN is in no ball.
        let within = |now: &Vec3, then: &Vec3, square: f64| {
            let way = [now[0] - then[0], now[1] - then[1], now[2] - then[2]];
            way[0] * way[0] + way[1] * way[1] + way[2] * way[2] < square
        };
        let (now, rest) = self.positions.as_chunks::<LANES>();
        let (then, other_rest) = self.balls.middles.as_chunks::<LANES>();
        let (squares, rest_squares) = self.balls.squares.as_chunks::<LANES>();
        let mut all = [true; LANES];
        for ((now, then), squares) in now.iter().zip(then).zip(squares) {
            for n in 0..LANES {
                all[n] &= within(&now[n], &then[n], squares[n]);
            }
        }
        for ((now, then), square) in rest.iter().zip(other_rest).zip(rest_squares) {
            all[0] &= within(now, then, *square);
        }
        *self.all = all.iter().all(|all| *all);
    }
}

#[inline]
pub fn ascending(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The same triangle from its lowest corner on.
#[inline]
pub fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
