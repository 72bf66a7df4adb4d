//! What an evaluation writes and the next need not know: small meshes share it, so that many of them stay in a cache.

use super::arrays::Arrays;
use super::layout::Layout;
use super::sweep::Scratch;
use crate::lanes::BLOCK;
use crate::lanes::tiles::{TriangleTile, VertexTile};
use crate::potentials::Needs;
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

/// Up to so many vertices meshes share the memory of their thread: what is larger does not fit into the second-level
/// cache, and would keep its memory for as long as the thread lives.
pub const SHARED_VERTICES: usize = 2048;

thread_local! {
    static SHARED: Cell<Option<Box<Workspace>>> = const { Cell::new(None) };
}

/// The arrays of an evaluation, and a place for each thread.
#[derive(Default)]
pub struct Workspace {
    pub arrays: Arrays,
    pub scratch: Vec<Scratch>,
    /// Whose visit is the last.
    guest: Guest,
    /// So many triangles may have tensions that are not zero.
    stressed: usize,
    /// Whether the guest may find partials of vertices, from an earlier evaluation.
    has_partials: bool,
}

/// The number of a visit: evaluations of one mesh in one workspace, between which nobody else was there.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Guest(u64);

impl Guest {
    fn next() -> Self {
        static VISITS: AtomicU64 = AtomicU64::new(1);
        Self(VISITS.fetch_add(1, Ordering::Relaxed))
    }
}

impl Workspace {
    /// That of this thread, until it is given back.
    pub fn of_this_thread() -> Box<Self> {
        SHARED.take().unwrap_or_default()
    }

    /// Keep it for the next evaluation of this thread.
    pub fn give_back(self: Box<Self>) {
        SHARED.set(Some(self));
    }

    /// Have room for what the terms need, for so many threads. If a visit begins, so that what the guest knows of
    /// tensions no longer holds, returns whether all are zero.
    pub fn enter(
        &mut self,
        guest: &mut Guest,
        layout: &Layout,
        needs: Needs,
        threads: usize,
    ) -> Option<bool> {
        let arrays = &mut self.arrays;
        let (vertices, triangles) = (layout.places_of_vertices(), layout.triangle_ids.len());
        let steps = BLOCK * layout.neighbours.len();
        arrays.positions.require(4 * vertices, 0.0);
        arrays.partials.require(2 * vertices, 0.0);
        arrays.normals.require(4 * (triangles + 1), 0.0);
        if needs.intersects(Needs::EDGES | Needs::CURVATURES) {
            arrays.bends.require(steps, 0.0);
        }
        if needs.contains(Needs::EDGES) {
            // Where a ring has ended, any length will do.
            arrays.lengths_squared.require(steps, 1.0);
            arrays.moments.require(steps, 0.0);
        }
        if needs.contains(Needs::TRIANGLES) {
            arrays.tensions.require(4 * (triangles + 1), 0.0);
        }
        if needs.intersects(Needs::VORONOI_AREAS | Needs::COTANGENTS) {
            arrays.vector_partials.require(4 * vertices, 0.0);
        }
        if needs.contains(Needs::UMBRELLAS) {
            arrays.umbrella_partials.require(4 * vertices, 0.0);
        }
        if needs.contains(Needs::NORMALS) {
            arrays.normal_partials.require(4 * vertices, 0.0);
            arrays.angles.require(4 * (triangles + 1), 0.0);
            arrays.next_angles.require(4 * (triangles + 1), 0.0);
        }
        let begins = self.guest == Guest::default() || self.guest != *guest;
        if begins {
            self.guest = Guest::next();
            *guest = self.guest;
            self.has_partials = true;
            // The triangle that does not exist may have been one of the guest before.
            let nothing = 4 * triangles..4 * triangles + 4;
            arrays.normals.clear(nothing.clone());
            arrays.tensions.clear(nothing.clone());
            arrays.angles.clear(nothing.clone());
            arrays.next_angles.clear(nothing);
        }
        if self.has_partials && !needs.contains(Needs::VERTICES) {
            arrays.partials.clear(0..2 * vertices);
            self.has_partials = false;
        }
        self.has_partials |= needs.intersects(Needs::VERTICES | Needs::MEAN_CURVATURE);
        self.make_scratch(layout.longest, threads);
        begins.then_some(self.stressed == 0)
    }

    /// Note after an evaluation of triangles whether all of its tensions are zero.
    pub fn leave(&mut self, triangles: usize, silent: bool) {
        self.stressed = match (silent, self.stressed > triangles) {
            (_, true) => self.stressed,
            (true, false) => 0,
            (false, false) => triangles,
        };
    }

    /// A place for each thread, with room for the longest ring.
    fn make_scratch(&mut self, steps: usize, threads: usize) {
        let scratch = &mut self.scratch;
        if scratch.first().is_some_and(|first| first.vertices.ring.len() < steps) {
            scratch.clear();
        }
        if scratch.len() < threads {
            scratch.resize_with(threads, || Scratch {
                triangles: TriangleTile::EMPTY,
                vertices: VertexTile::new(steps),
            });
        }
    }
}
