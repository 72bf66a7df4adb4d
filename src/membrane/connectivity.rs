//! The connectivity of a membrane as a whole: what it is, and going on with another one.

use super::Membrane;
use crate::error::{Error, Result};
use crate::mesh::Triangulation;
use crate::mesh::numbering::breadth_first;

/// What decides the bits of evaluations beside positions: the connectivity, and in which order sums are formed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Connectivity {
    /// The particles at the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// The vertices, by their index in ascending order of particle.
    pub order: Vec<u32>,
    /// How many flips there have been since the order was made.
    pub flips: u64,
}

impl Membrane {
    /// A whole number below 2⁵³, as a double, that tells the present triangles from any others: 0 for those that the
    /// membrane began with.
    pub fn fingerprint(&self) -> f64 {
        let difference = self.mesh().fingerprint().wrapping_sub(self.initial_fingerprint);
        if difference == 0 { 0.0 } else { ((difference >> 11) | 1) as f64 }
    }

    /// What there is to remember of the present connectivity.
    pub fn connectivity(&self) -> Connectivity {
        let mesh = self.mesh();
        Connectivity {
            triangles: (0..mesh.triangles().len()).map(|t| mesh.particles_of(t)).collect(),
            order: self.surface.order.clone(),
            flips: self.surface.flips_of_order,
        }
    }

    /// Go on with other triangles of the same particles, as many as there are.
    ///
    /// # Errors
    /// Those of [`Triangulation::with_triangles`]; nothing has changed then.
    pub fn set_triangles(&mut self, triangles: &[[i64; 3]]) -> Result<()> {
        let mesh = self.mesh().with_triangles(triangles)?;
        let order = breadth_first(&mesh);
        // They may be turned the other way.
        self.surface.has_outside = false;
        self.take(mesh, order, 0);
        Ok(())
    }

    /// Go on with what [`Self::connectivity`] had been: the same bits follow.
    ///
    /// # Errors
    /// Those of [`Triangulation::with_triangles`], and an order that is none; nothing has changed then.
    pub fn restore(&mut self, saved: &Connectivity) -> Result<()> {
        let triangles: Vec<_> = saved.triangles.iter().map(|t| t.map(i64::from)).collect();
        let mesh = self.mesh().with_triangles(&triangles)?;
        let mut met = vec![false; mesh.num_vertices()];
        let all_new = saved.order.iter().all(|vertex| {
            met.get_mut(*vertex as usize).is_some_and(|met| !std::mem::replace(met, true))
        });
        if !all_new || saved.order.len() != met.len() {
            return Err(Error::Contract(
                "the saved order of the vertices is none; what was saved is damaged".to_owned(),
            ));
        }
        self.take(mesh, saved.order.clone(), saved.flips);
        Ok(())
    }

    fn take(&mut self, mesh: Triangulation, order: Vec<u32>, flips: u64) {
        let surface = &mut self.surface;
        (surface.mesh, surface.order, surface.flips_of_order) = (mesh, order, flips);
        surface.connectivity_changed();
        self.remembered.clear();
        self.contacts.forget();
    }
}
