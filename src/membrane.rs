//! A mesh as one OpenMM Context sees it: shared by all its forces on the same triangles.

use crate::backend::Choice;
use crate::error::{Error, Result};
use crate::evaluator::ChosenEvaluator;
use crate::mesh::Topology;
use crate::mesh::orientation::is_inside_out;
use crate::potentials::{Contribution, Element, Term};
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

/// How many membranes there are, which tells whether forces share them and whether any are left over.
static ALIVE: AtomicI64 = AtomicI64::new(0);

/// The number of membranes that exist in this process.
pub fn count() -> i64 {
    ALIVE.load(Ordering::Relaxed)
}

/// A mesh with the buffers to evaluate any terms on it.
pub struct Membrane {
    topology: Arc<Topology>,
    evaluator: ChosenEvaluator,
    num_particles: usize,
    /// Whether the surface has been looked at and is not inside out.
    has_outside: bool,
}

impl Membrane {
    /// For triangles of particles of a System with `num_particles` of them.
    ///
    /// # Errors
    /// Those of [`Topology::new`].
    pub fn new(triangles: &[[i64; 3]], num_particles: usize) -> Result<Self> {
        let topology = Arc::new(Topology::new(triangles, num_particles)?);
        let evaluator = ChosenEvaluator::new(topology.clone());
        ALIVE.fetch_add(1, Ordering::Relaxed);
        Ok(Self { topology, evaluator, num_particles, has_outside: false })
    }

    /// Let so many threads share evaluations, where that turns out faster; 0 for as many as there are.
    pub fn set_threads(&mut self, threads: usize) {
        self.evaluator.set_threads(threads);
    }

    /// The mesh.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// Let a force join that wants to be computed in some way, or in any.
    ///
    /// # Errors
    /// Those of [`ChosenEvaluator::choose`].
    pub fn choose(&mut self, wish: Option<Choice>) -> Result<()> {
        self.evaluator.choose(wish)
    }

    /// Evaluate terms together. Positions (nm) and forces (kJ/mol/nm) are those of all particles of the
    /// System, x y z of one after the other; forces are added. Without contributions no energies are summed.
    ///
    /// # Errors
    /// Those of [`ChosenEvaluator::evaluate`], triangles that are turned inside out where a term needs an outside, and
    /// a parameter outside its domain, as a Context parameter
    /// can come to be.
    pub fn evaluate(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
    ) -> Result<()> {
        let length = 3 * self.num_particles;
        let fits = forces.as_ref().is_none_or(|forces| forces.len() == length);
        let counts = contributions.is_empty() || contributions.len() == terms.len();
        if positions.len() != length || !fits || !counts {
            return Err(Error::Contract(format!(
                "needs positions and forces of {} particles and one contribution a term, or none",
                self.num_particles
            )));
        }
        for term in terms {
            self.check(term)?;
        }
        if !self.has_outside {
            self.look_for_outside(terms, positions)?;
        }
        self.evaluator.evaluate(terms, positions, contributions, forces)
    }

    /// Refuse triangles that all run clockwise, as a slip in a mesh has them, before a volume below zero becomes a
    /// pressure that blows the membrane up. That is settled by the first positions that a term asks about, for good:
    /// a shape that turns inside out later, or crosses itself, follows the formula, whose volume has a sign.
    fn look_for_outside(&mut self, terms: &[Term], positions: &[f64]) -> Result<()> {
        let Some(term) = terms.iter().find(|term| term.potential.needs_outside()) else {
            return Ok(());
        };
        match is_inside_out(&self.topology, positions) {
            Some((true, totals)) => {
                let (force, volume) = (term.potential.name(), totals.volume);
                Err(Error::InsideOut { force, volume })
            }
            found => {
                // Of positions that are not finite the evaluator names the culprit.
                self.has_outside = found.is_some();
                Ok(())
            }
        }
    }

    /// Refuse a term with values outside their domains, or with more or fewer values for single
    /// elements than there are elements.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self, term: &Term) -> Result<()> {
        term.check()?;
        for (parameter, field) in term.potential.parameters().iter().zip(term.fields) {
            let (count, elements) = match parameter.per {
                _ if field.is_empty() => continue,
                Some(Element::Vertex) => (self.topology.num_vertices(), "vertices"),
                Some(Element::Triangle) => (self.topology.triangles.len(), "triangles"),
                None => (0, "elements that can have their own"),
            };
            if field.len() != count {
                let name = parameter.name.to_string_lossy();
                return Err(Error::Contract(format!(
                    "{name} has {} values, but the mesh has {count} {elements}; give one for each",
                    field.len()
                )));
            }
        }
        Ok(())
    }
}

impl Drop for Membrane {
    fn drop(&mut self) {
        ALIVE.fetch_sub(1, Ordering::Relaxed);
    }
}
