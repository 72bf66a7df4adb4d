//! Which vertices may touch which triangles of a surface, and which edges which edges.
//!
//! Two lists, one within the other, have the pairs that were nearer than reach + skin at the positions of a **reference**,
//! but for those that share a vertex. Each is good until a vertex has moved by half of its skin. The outer one has a thick skin
//! and comes from boxes (`outer.rs`); the inner one has a thin skin and comes from the outer one (`inner.rs`), and is what
//! evaluations look at. Pairs are known by their vertices, and the inner list is in ascending order of these, so that nothing depends
//! on when lists were made. After flips, pairs of what is gone are taken out and those of what is new are added (`following.rs`).

use super::spheres::{Search, Sphere, Spheres};
use crate::dynamics::instructions::{Arithmetic, Kernel, run};
use crate::error::{Error, Result};
use crate::mesh::geometry::Vec3;
use crate::mesh::{Cell, Triangulation};
use crate::team::Team;

/// The vertices of a pair: a vertex and the corners of a triangle from the lowest on, or the ends of two edges, the lower end
/// of each and the lower edge first.
pub type Pair = [u32; 4];

/// A pair of the outer list, and the distance at its reference, or less, nm.
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
    /// The references of the outer and the inner list.
    pub(super) outer: Vec<Vec3>,
    pub(super) inner: Vec<Vec3>,
    /// How far each vertex was from its outer reference at the inner one, nm.
    pub(super) moved: Vec<f32>,
    /// The outer skin in mean edges, the inner one as a share of it; none before the first lists.
    pub(super) shares: Option<[f64; 2]>,
    /// The triangles that the lists are of.
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

/// Looks at pairs since lists were made.
#[derive(Default)]
pub struct Cost {
    /// In evaluations with the present inner list.
    pub looking: f64,
    /// To make the present inner list.
    pub choosing: f64,
    /// All of both with the present outer list.
    pub all: f64,
}

/// What lists depend on, beside the reference and the triangles.
#[derive(Clone, Copy)]
pub struct Made {
    pub reach: f64,
    pub between_parts: bool,
    pub cell: Option<Cell>,
    pub fingerprint: u64,
    /// nm.
    pub outer_skin: f64,
    pub inner_skin: f64,
    /// The mean edge, nm.
    pub mean: f64,
}

impl Lists {
    /// Be good for pairs up to `reach` at some positions of all particles; with `between_parts` only for those of
    /// different parts of the surface.
    ///
    /// # Errors
    /// A position that is not finite; a box that is too small.
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
        if let Some(mut made) = good {
            let stays = farthest(&self.positions, &self.inner) < 0.5 * made.inner_skin;
            if (stays || self.measure(&mut made))
                && (made.fingerprint == mesh.fingerprint() || self.follow_flips(mesh, &made))
            {
                made.fingerprint = mesh.fingerprint();
                if !stays {
                    self.choose(&made, team);
                }
                self.made_for = Some(made);
                self.cost.looking += self.work() as f64;
                return Ok(());
            }
        }
        self.made_for = None;
        for (position, particle) in self.positions.iter().zip(mesh.particles()) {
            if !position.iter().all(|x| x.is_finite()) {
                let (particle, position) = (*particle, (*position).into());
                return Err(Error::NonFinitePosition { particle, position });
            }
        }
        let made = self.make(mesh, cell, (reach, between_parts), team)?;
        self.made_for = Some(made);
        self.choose(&made, team);
        self.cost.looking = self.work() as f64;
        Ok(())
    }

    /// Know nothing.
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

    /// How many pairs that are.
    pub fn work(&self) -> usize {
        self.near[0].len() + self.near[1].len()
    }

    /// The part that a vertex is on; 0 unless that matters.
    #[inline]
    pub(super) fn part(&self, vertex: u32) -> u32 {
        self.parts.get(vertex as usize).copied().unwrap_or(0)
    }

    /// The part that has no pairs with a vertex, or none.
    #[inline]
    pub(super) fn own_part(&self, vertex: u32) -> u32 {
        self.parts.get(vertex as usize).copied().unwrap_or(u32::MAX)
    }
}

/// How far the farthest vertex is from where it was, nm; no number if a position is none.
pub fn farthest(now: &[Vec3], then: &[Vec3]) -> f64 {
    let mut found = 0.0;
    run(Farthest { now, then, found: &mut found });
    found
}

const LANES: usize = 8;

struct Farthest<'a> {
    now: &'a [Vec3],
    then: &'a [Vec3],
    found: &'a mut f64,
}

impl Kernel for Farthest<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let mut most = [0.0; LANES];
        // What is no number stays.
        let larger = |most: f64, x: f64| if x <= most { most } else { x };
        let squared = |now: &Vec3, then: &Vec3| {
            let way = [now[0] - then[0], now[1] - then[1], now[2] - then[2]];
            way[0] * way[0] + way[1] * way[1] + way[2] * way[2]
        };
        let (now, rest) = self.now.as_chunks::<LANES>();
        let (then, other_rest) = self.then.as_chunks::<LANES>();
        for (now, then) in now.iter().zip(then) {
            for n in 0..LANES {
                most[n] = larger(most[n], squared(&now[n], &then[n]));
            }
        }
        for (now, then) in rest.iter().zip(other_rest) {
            most[0] = larger(most[0], squared(now, then));
        }
        *self.found = most.into_iter().fold(0.0, larger).sqrt();
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
