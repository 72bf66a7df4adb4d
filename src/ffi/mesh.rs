//! The C interface to [`crate::mesh`].

use super::membrane::cell;
use super::{Status, guarded, slice};
use crate::mesh::orientation;
use std::slice as slices;

/// Validate a mesh and turn its triangles, in place, so that each component encloses positive volume.
///
/// # Safety
/// `vertices` must hold 3 `num_vertices` and `triangles` 3 `num_triangles` values, `box_vectors` 9 (a periodic box, nm) or be
/// null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Mesh_orient(
    num_vertices: i64,
    vertices: *const f64,
    num_triangles: i64,
    triangles: *mut i64,
    box_vectors: *const f64,
) -> Status {
    guarded("Mesh", || {
        let vertices = unsafe { slice(vertices.cast::<[f64; 3]>(), num_vertices as usize) };
        let given =
            unsafe { slice(triangles.cast_const().cast::<[i64; 3]>(), num_triangles as usize) };
        let cell = unsafe { cell(box_vectors) }?;
        let oriented = orientation::oriented(vertices, given, cell.as_ref())?;
        let target = triangles.cast::<[i64; 3]>();
        unsafe { slices::from_raw_parts_mut(target, oriented.len()) }.copy_from_slice(&oriented);
        Ok(())
    })
}
