//! A mesh as one OpenMM Context sees it: shared by all its forces on the same triangles.

use crate::backend::Choice;
use crate::contact::{Contacts, is_contact};
use crate::error::{Error, Result};
use crate::mesh::{Cell, Configuration, Topology, Triangulation};
use crate::moves::local::LocalEnergy;
use crate::potentials::{Contribution, Request, Term};
use crate::remembered::Remembered;
use nalgebra::Matrix3;
use std::sync::atomic::{AtomicI64, Ordering};

mod checks;
mod connectivity;
mod constants;
mod crowd;
mod flips;
mod moves;
mod surface;
mod swaps;

pub use connectivity::Connectivity;
use constants::{Equipped, Workshop, need_constants};
pub use crowd::Crowd;
pub use flips::Follower;
use surface::{Surface, check_references};

/// How many membranes there are, which tells whether forces share them and whether any are left over.
static ALIVE: AtomicI64 = AtomicI64::new(0);

/// The number of membranes that exist in this process.
pub fn count() -> i64 {
    ALIVE.load(Ordering::Relaxed)
}

/// A mesh with the buffers to evaluate any terms on it, and to change its connectivity.
pub struct Membrane {
    surface: Surface,
    initial_fingerprint: u64,
    local: LocalEnergy,
    contacts: Contacts,
    workshop: Workshop,
    /// The forces after the last flips, which the time step asks for next.
    remembered: Remembered,
    /// The forces before them; kept for its memory.
    before: Vec<f64>,
    num_particles: usize,
}

impl Membrane {
    /// For triangles of particles of a System with `num_particles` of them.
    ///
    /// # Errors
    /// Those of [`Topology::new`].
    pub fn new(triangles: &[[i64; 3]], num_particles: usize) -> Result<Self> {
        let mesh = Triangulation::new(&Topology::new(triangles, num_particles)?);
        ALIVE.fetch_add(1, Ordering::Relaxed);
        Ok(Self {
            initial_fingerprint: mesh.fingerprint(),
            surface: Surface::new(mesh),
            local: LocalEnergy::default(),
            contacts: Contacts::default(),
            workshop: Workshop::default(),
            remembered: Remembered::default(),
            before: Vec::new(),
            num_particles,
        })
    }

    /// Let so many threads share evaluations, where that turns out faster; 0 for as many as there are.
    pub fn set_threads(&mut self, threads: usize) {
        self.surface.evaluator.set_threads(threads);
        self.contacts.set_threads(threads);
    }

    /// Let a force join that wants to be computed in some way, or in any.
    ///
    /// # Errors
    /// Those of [`ChosenEvaluator::choose`](crate::evaluator::ChosenEvaluator::choose).
    pub fn choose(&mut self, wish: Option<Choice>) -> Result<()> {
        self.surface.evaluator.choose(&self.surface.mesh, wish)
    }

    /// What has been chosen for it, once that is known.
    pub fn choice(&self) -> Option<Choice> {
        self.surface.evaluator.choice()
    }

    /// Whether it is settled that the processor evaluates it.
    pub fn is_on_processor(&self) -> bool {
        self.surface.evaluator.is_settled_on_cpu()
    }

    /// How often the connectivity has changed.
    pub fn generation(&self) -> u64 {
        self.surface.generation
    }

    /// The mesh as it is now.
    pub fn mesh(&self) -> &Triangulation {
        &self.surface.mesh
    }

    /// Evaluate terms together. Forces, kJ/mol/nm in the layout of the positions, are added. Without contributions no
    /// energies are summed.
    ///
    /// # Errors
    /// Those of the evaluators and of [`Unfolding::unfold`](crate::mesh::Unfolding::unfold), triangles that are turned
    /// inside out where a term needs an outside, and a parameter outside its domain, as a Context parameter can come to
    /// be.
    pub fn evaluate(&mut self, mut request: Request, cell: Option<&Cell>) -> Result<()> {
        if request.positions.len() != 3 * self.num_particles {
            return Err(Error::Contract(format!(
                "needs positions of {} particles",
                self.num_particles
            )));
        }
        request.check(self.num_particles)?;
        let Request { terms, positions, .. } = request;
        for term in terms {
            self.check(term)?;
        }
        if let (true, Some(forces)) = (request.energies.is_empty(), &mut request.forces)
            && self.remembered.add_once(terms, positions, cell, forces)
        {
            return Ok(());
        }
        request.energies.fill(Contribution::default());
        let surface = &mut self.surface;
        let equipped;
        let terms = match need_constants(terms) {
            false => terms,
            true => {
                equipped = self.workshop.equip(&surface.mesh, surface.generation, terms)?;
                &equipped
            }
        };
        let mut request = Request { terms, ..request };
        // A surface that only contacts act on may be in no condition for the others.
        if terms.is_empty() || !terms.iter().all(is_contact) {
            let mut placed = surface.place(Configuration { positions, cell })?;
            placed.look_for_outside(terms)?;
            placed.evaluate(request.again())?;
        }
        self.contacts.evaluate(&surface.mesh, cell, request)
    }

    /// Whether [`Self::look`] has to come before terms are evaluated elsewhere: one of them needs an outside, and nobody
    /// has looked for it.
    pub fn must_look(&self, terms: &[Term]) -> bool {
        !self.surface.has_outside && terms.iter().any(|term| term.potential.needs_outside())
    }

    /// Evaluate terms on the processor, whatever has been chosen, to learn what is wrong with the positions: its errors name
    /// the culprit.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn look(&mut self, terms: &[Term], at: Configuration, forces: &mut [f64]) -> Result<()> {
        let surface = &mut self.surface;
        let terms = self.workshop.equip(&surface.mesh, surface.generation, terms)?;
        let mut placed = surface.place(at)?;
        placed.look_for_outside(&terms)?;
        placed.look(&terms, forces)
    }

    /// Some terms with their constants of triangles, for who evaluates them elsewhere; and the mesh.
    ///
    /// # Errors
    /// Numbers of more or fewer vertices than there are; a triangle that has no shape at rest; a reference without a box,
    /// where the surface is known to span its own.
    pub fn equip<'a>(
        &'a mut self,
        terms: &[Term<'a>],
    ) -> Result<(Equipped<'a>, &'a Triangulation)> {
        let surface = &self.surface;
        check_references(&surface.mesh, terms)?;
        Ok((self.workshop.equip(&surface.mesh, surface.generation, terms)?, &surface.mesh))
    }

    /// ∂E/∂ε of some terms for a homogeneous strain ε of all positions and of the periodic box, kJ/mol: where there is
    /// none, or no surface spans it, −Σ F ⊗ r.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn virial(&mut self, terms: &[Term], at: Configuration) -> Result<Matrix3<f64>> {
        // What this refuses need not be looked for below.
        self.evaluate(Request::new(terms, at.positions), at.cell)?;
        let surface = &mut self.surface;
        let of_contacts = self.contacts.virial(&surface.mesh, at.cell, terms, at.positions)?;
        if terms.iter().all(is_contact) {
            return Ok(of_contacts);
        }
        let terms = self.workshop.equip(&surface.mesh, surface.generation, terms)?;
        Ok(surface.place(at)?.virial(&terms)? + of_contacts)
    }
}

impl Drop for Membrane {
    fn drop(&mut self) {
        ALIVE.fetch_sub(1, Ordering::Relaxed);
    }
}
