//! Terms that a membrane refuses.

use super::Membrane;
use crate::contact::Contacts;
use crate::error::{Error, Result};
use crate::potentials::{Element, Term};

impl Membrane {
    /// Refuse particles of a term that do not exist, come twice or are vertices.
    ///
    /// # Errors
    /// Names the particle.
    pub fn check_particles(&self, term: &Term) -> Result<()> {
        Contacts::check(self.mesh(), term, self.num_particles)
    }

    /// Refuse a term with values outside their domains, or with more or fewer values for single
    /// elements than there are elements, or that needs a closed surface where this one has a border.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self, term: &Term) -> Result<()> {
        term.check()?;
        if term.potential.needs_outside() && !self.mesh().is_closed() {
            let border = &self.mesh().border_loops()[0];
            let particles: Vec<_> =
                border.iter().map(|vertex| self.mesh().particles()[*vertex as usize]).collect();
            let (force, length) = (term.potential.name(), border.len());
            return Err(Error::Border { force, length, particles });
        }
        for (parameter, field) in term.potential.parameters().iter().zip(term.fields) {
            let (count, elements) = match parameter.per {
                _ if field.is_empty() => continue,
                Some(Element::Vertex) => (self.mesh().num_vertices(), "vertices"),
                Some(Element::Triangle) => (self.mesh().triangles().len(), "triangles"),
                Some(Element::Particle) => (term.particles.len(), "particles"),
                None => (0, "elements that can have their own"),
            };
            if field.len() != count {
                let name = parameter.name.to_string_lossy();
                return Err(Error::Contract(format!(
                    "{name} has {} values, but there are {count} {elements}; give one for each",
                    field.len()
                )));
            }
        }
        Ok(())
    }
}
