//! Flips of a membrane, and of those that follow it.

use super::Membrane;
use crate::contact::is_contact;
use crate::error::Result;
use crate::mesh::Configuration;
use crate::moves::{Round, Touched, flips};
use crate::potentials::{Request, Term};
use smallvec::SmallVec;

/// A membrane that has all triangles of another one among its own, and the terms of contacts on it: the other one's flips
/// count its energy, and it makes them, too.
pub struct Follower<'a, 't> {
    /// The membrane.
    pub membrane: &'a mut Membrane,
    /// The place of the other one's first triangle.
    pub first_triangle: usize,
    /// Terms of contacts.
    pub terms: &'a [Term<'t>],
}

impl Membrane {
    /// Make a round of flips at the present positions, with the energy of some terms and of the followers. Returns how
    /// many were made. If `force_change` (kJ/mol/nm, in the layout of the positions) is wanted, it gets by how much they
    /// have changed the forces; it is left alone if there were none.
    ///
    /// # Errors
    /// Rules that make no sense, a term as [`Self::evaluate`] refuses it, a mesh without geometry: nothing has changed
    /// then. A GPU that was asked for and fails: the flips have been made.
    pub fn flip(
        &mut self,
        terms: &[Term],
        at: Configuration,
        round: Round,
        force_change: Option<&mut [f64]>,
        followers: &mut [Follower],
    ) -> Result<u64> {
        for term in terms {
            self.check_for_flips(term)?;
        }
        self.look_around(terms, at, force_change.is_some())?;
        let Configuration { positions, cell } = at;
        let mut before = force_change.is_some().then_some(self.before.as_mut_slice());
        let surface = &mut self.surface;
        let equipped = self.workshop.equip(&surface.mesh, surface.generation, terms)?;
        let mesh = &surface.mesh;
        let mut touched: SmallVec<[Touched; 2]> = SmallVec::new();
        if terms.iter().any(is_contact) {
            let contacts = &mut self.contacts;
            contacts.prepare_flips(mesh, cell, terms, positions)?;
            touched.push(Touched { contacts, terms, positions, mesh: None, first_half: 0 });
        }
        for Follower { membrane, first_triangle, terms } in &mut *followers {
            let (contacts, mesh) = (&mut membrane.contacts, &mut membrane.surface.mesh);
            if let Some(before) = &mut before {
                contacts.evaluate(
                    mesh,
                    cell,
                    Request::new(terms, positions).with_forces(&mut **before),
                )?;
            }
            contacts.prepare_flips(mesh, cell, terms, positions)?;
            let first_half = 3 * *first_triangle as u32;
            touched.push(Touched { contacts, terms, positions, mesh: Some(mesh), first_half });
        }

        let mesh = &mut self.surface.mesh;
        let made = flips::attempt(mesh, &mut self.local, &equipped, round, &mut touched);
        drop((touched, equipped));
        if made > 0 {
            self.surface.note_flips(made);
            for follower in &mut *followers {
                follower.membrane.surface.connectivity_changed();
            }
            if let Some(change) = force_change {
                self.compare_forces(terms, at, change)?;
                for Follower { membrane, terms, .. } in followers {
                    let (contacts, mesh) = (&mut membrane.contacts, &membrane.surface.mesh);
                    contacts.evaluate(
                        mesh,
                        cell,
                        Request::new(terms, positions).with_forces(&mut *change),
                    )?;
                }
            }
        }
        Ok(made)
    }
}
