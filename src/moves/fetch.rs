//! Bringing near what later attempts will read, in three steps, since each finds out where the next has to look.

use super::local::LocalEnergy;
use crate::mesh::NONE;
use crate::mesh::triangulation::{Triangulation, next, previous};

impl LocalEnergy {
    /// Bring what an attempt will need near: first, of the triangle that it begins with.
    #[inline(always)]
    pub fn fetch_triangle(&self, mesh: &Triangulation, half: u32) {
        let triangle = half as usize / 3;
        fetch(&mesh.triangles()[triangle]);
        fetch(&mesh.twins()[triangle]);
        fetch(&self.survey.triangles[triangle]);
    }

    /// Then, of the other triangle and the vertices.
    #[inline(always)]
    pub fn fetch_quad(&self, mesh: &Triangulation, half: u32) {
        let twin = mesh.twin(half);
        if twin == NONE {
            return;
        }
        self.fetch_triangle(mesh, twin);
        self.fetch_beyond(mesh, next(half));
        self.fetch_beyond(mesh, previous(half));
        for half in [half, next(half), previous(half)] {
            let vertex = mesh.origin(half) as usize;
            fetch(&self.survey.vertices[vertex]);
            fetch(&mesh.degrees()[vertex]);
        }
    }

    /// At last, of what lies around the other triangle.
    #[inline(always)]
    pub fn fetch_rest(&self, mesh: &Triangulation, half: u32) {
        let twin = mesh.twin(half);
        if twin == NONE {
            return;
        }
        self.fetch_beyond(mesh, next(twin));
        self.fetch_beyond(mesh, previous(twin));
        let vertex = mesh.origin(previous(twin)) as usize;
        fetch(&self.survey.vertices[vertex]);
        fetch(&mesh.degrees()[vertex]);
    }

    /// The triangle on the other side of a half-edge, if there is one.
    #[inline(always)]
    fn fetch_beyond(&self, mesh: &Triangulation, half: u32) {
        if let Some(triangle) = self.survey.triangles.get(mesh.twin(half) as usize / 3) {
            fetch(triangle);
        }
    }
}

/// Ask for the cache lines of something that will be needed soon.
#[inline(always)]
fn fetch<T>(what: &T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch has no effect but on caches.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let first = std::ptr::from_ref(what).cast::<i8>();
        _mm_prefetch::<_MM_HINT_T0>(first);
        _mm_prefetch::<_MM_HINT_T0>(first.wrapping_add(size_of::<T>() - 1));
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = what;
}
