//! What moves of a membrane begin with, and what leapfrogs want to know after them.

use super::Membrane;
use super::surface::check_references;
use crate::contact::is_contact;
use crate::error::{Error, Result};
use crate::mesh::Configuration;
use crate::potentials::{Request, Term};

impl Membrane {
    /// Note the energy and the geometry of every element at some positions, and, if they are wanted, the forces.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub(super) fn look_around(
        &mut self,
        terms: &[Term],
        at: Configuration,
        wants_forces: bool,
    ) -> Result<()> {
        let Configuration { positions, cell } = at;
        if positions.len() != 3 * self.num_particles {
            return Err(Error::Contract(format!(
                "needs positions of {} particles",
                self.num_particles
            )));
        }
        for term in terms {
            self.check(term)?;
        }
        self.remembered.clear();
        self.before.clear();
        if wants_forces {
            self.before.resize(positions.len(), 0.0);
        }
        let mut before = wants_forces.then_some(self.before.as_mut_slice());
        let surface = &mut self.surface;
        let equipped = self.workshop.equip(&surface.mesh, surface.generation, terms)?;
        let mut placed = surface.place(at)?;
        check_references(placed.present.mesh, terms)?;
        let (mesh, into) = (placed.present.mesh, before.as_deref_mut());
        let request = Request::new(&equipped, positions).with_forces(into);
        self.local.fill(mesh, terms, cell, |survey| placed.survey(request, survey))?;
        if terms.iter().any(is_contact) {
            self.contacts.evaluate(
                mesh,
                cell,
                Request::new(terms, positions).with_forces(before),
            )?;
        }
        Ok(())
    }

    /// By how much forces differ from those before moves; what they are is remembered.
    pub(super) fn compare_forces(
        &mut self,
        terms: &[Term],
        at: Configuration,
        change: &mut [f64],
    ) -> Result<()> {
        let Configuration { positions, cell } = at;
        let surface = &mut self.surface;
        let equipped = self.workshop.equip(&surface.mesh, surface.generation, terms)?;
        let mut placed = surface.place(at)?;
        let after = self.remembered.fill(terms, positions, cell, |forces| {
            placed.evaluate(Request::new(&equipped, positions).with_forces(&mut *forces))?;
            let request = Request::new(terms, positions).with_forces(forces);
            self.contacts.evaluate(placed.present.mesh, cell, request)
        })?;
        for ((change, after), before) in change.iter_mut().zip(after).zip(&self.before) {
            *change = after - before;
        }
        Ok(())
    }
}
