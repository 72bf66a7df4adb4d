//! Terms that a membrane refuses.

use super::Membrane;
use crate::contact::Contacts;
use crate::error::{Error, Result};
use crate::potentials::{Element, MadeOf, Parameter, Term};

/// Values of single edges, where edges come and go.
fn of_edges(term: &Term, parameter: &Parameter) -> Error {
    let (force, name) = (term.potential.name(), parameter.name.to_string_lossy());
    Error::Contract(format!(
        "{force}: {name} has a value for each edge, and flips make edges that have none; give one value for all edges, or leave the triangles as they are"
    ))
}

impl Membrane {
    /// Refuse terms that flips would leave without values.
    ///
    /// # Errors
    /// Names the parameter.
    pub(super) fn check_for_flips(&self, term: &Term) -> Result<()> {
        for (parameter, field) in term.potential.parameters().iter().zip(term.fields) {
            if parameter.per == Some(Element::Edge) && !field.is_empty() {
                return Err(of_edges(term, parameter));
            }
        }
        Ok(())
    }

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
                Some(Element::Edge) if self.mesh().fingerprint() != self.initial_fingerprint => {
                    return Err(of_edges(term, parameter));
                }
                Some(Element::Edge) => (self.mesh().num_edges(), "edges"),
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
        let made_of = term.potential.constants(term);
        if let Some((name, width)) = made_of.and_then(MadeOf::numbers) {
            let (count, vertices) = (term.numbers.values.len(), self.mesh().num_vertices());
            if count != width * vertices {
                return Err(Error::Contract(format!(
                    "{} is of {} vertices, but there are {vertices}; give one row for each, in ascending order of \
                     particle index",
                    name.to_string_lossy(),
                    count / width
                )));
            }
        }
        Ok(())
    }
}
