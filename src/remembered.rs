//! Forces that were computed a moment before somebody asks for them.

use crate::error::Result;
use crate::mesh::Cell;
use crate::potentials::{MAX_PARAMETERS, Term};

/// Forces of some terms at some positions in a periodic box or none.
#[derive(Default)]
pub struct Remembered {
    is_there: bool,
    terms: Vec<RememberedTerm>,
    positions: Vec<f64>,
    cell: Option<Cell>,
    forces: Vec<f64>,
}

/// All of a term that forces depend on.
struct RememberedTerm {
    name: &'static str,
    form: usize,
    switches: u32,
    values: [f64; MAX_PARAMETERS],
    fields: [Vec<f64>; MAX_PARAMETERS],
    particles: Vec<u32>,
    /// Owner and version of the numbers of vertices.
    numbers: [u64; 2],
}

impl Remembered {
    /// Forget.
    pub fn clear(&mut self) {
        self.is_there = false;
    }

    /// Remember these forces, kJ/mol/nm, which `compute` finds: it is to add them to zeros.
    ///
    /// # Errors
    /// Those of `compute`; nothing is remembered then.
    pub fn fill(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
        compute: impl FnOnce(&mut [f64]) -> Result<()>,
    ) -> Result<&[f64]> {
        self.is_there = false;
        self.forces.clear();
        self.forces.resize(positions.len(), 0.0);
        compute(&mut self.forces)?;
        self.terms.clear();
        self.terms.extend(terms.iter().map(RememberedTerm::new));
        self.positions.clear();
        self.positions.extend_from_slice(positions);
        self.cell = cell.copied();
        self.is_there = true;
        Ok(&self.forces)
    }

    /// Add the forces, if they are of these terms at these positions. What is asked for next is something else, so they
    /// are forgotten in any case.
    pub fn add_once(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
        forces: &mut [f64],
    ) -> bool {
        let known = self.is_of(terms, positions, cell);
        self.is_there = false;
        if known {
            // Forces on others may be summed at the same time.
            for (sum, force) in
                forces.iter_mut().zip(&self.forces).filter(|(_, force)| **force != 0.0)
            {
                *sum += force;
            }
        }
        known
    }

    fn is_of(&self, terms: &[Term], positions: &[f64], cell: Option<&Cell>) -> bool {
        self.is_there
            && self.terms.len() == terms.len()
            && self.terms.iter().zip(terms).all(|(known, term)| known.is(term))
            && self.positions == positions
            && self.cell.as_ref() == cell
    }
}

impl RememberedTerm {
    fn new(term: &Term) -> Self {
        Self {
            name: term.potential.name(),
            form: term.form,
            switches: term.switches,
            values: term.values,
            fields: term.fields.map(<[f64]>::to_vec),
            particles: term.particles.to_vec(),
            numbers: [term.numbers.owner, term.numbers.version],
        }
    }

    fn is(&self, term: &Term) -> bool {
        self.name == term.potential.name()
            && (self.form, self.switches) == (term.form, term.switches)
            && self.values == term.values
            && self.particles == term.particles
            && self.numbers == [term.numbers.owner, term.numbers.version]
            && self.fields.iter().zip(term.fields).all(|(known, field)| known == field)
    }
}
