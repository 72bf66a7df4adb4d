//! A potential with all that it is evaluated with.

use super::{Element, MAX_PARAMETERS, Potential, TriangleConstants, VertexNumbers, find};
use crate::error::{Error, Result};

/// The values that a potential is evaluated with.
pub type Values = [f64; MAX_PARAMETERS];

/// A potential with its form and values.
#[derive(Clone, Copy)]
pub struct Term<'a> {
    /// From the [`REGISTRY`](super::REGISTRY).
    pub potential: &'static dyn Potential,
    /// Index into the names of [`Potential::forms`]; 0 if there are none.
    pub form: usize,
    /// One bit for each of [`Potential::switches`].
    pub switches: u32,
    /// One for each parameter; the rest is unused.
    pub values: Values,
    /// For each parameter the values of the single elements that replace it; empty if there are none.
    pub fields: [&'a [f64]; MAX_PARAMETERS],
    /// Particles beside the vertices that the term acts on, by their indices in the System.
    pub particles: &'a [u32],
    /// What the user has given for each vertex, if the potential has constants of triangles; their owner and version tell
    /// whether the constants hold.
    pub numbers: &'a VertexNumbers,
    /// These constants; a [`Membrane`](crate::membrane::Membrane) makes them.
    pub constants: &'a TriangleConstants,
    /// Whether the derivatives with respect to the scalars will be read; those that cost extra may be
    /// wrong otherwise.
    pub wants_derivatives: bool,
}

impl<'a> Term<'a> {
    /// Look up a potential and check its values.
    ///
    /// # Errors
    /// An unknown name or form, too few or too many values, a value outside its domain.
    pub fn new(name: &str, form: usize, values: &[f64]) -> Result<Self> {
        let potential = find(name)?;
        let forms = potential.forms().map_or(1, |(_, names)| names.len());
        if form >= forms {
            return Err(Error::Contract(format!("there is no form {form}, only {forms}")));
        }
        let count = potential.parameters().len();
        if values.len() != count {
            return Err(Error::Contract(format!("needs {count} values, got {}", values.len())));
        }
        let mut padded = Values::default();
        padded[..count].copy_from_slice(values);
        let term = Self { form, values: padded, ..Self::of(potential) };
        term.check()?;
        Ok(term)
    }

    /// A potential with zeros for values, and nothing else.
    pub fn of(potential: &'static dyn Potential) -> Self {
        Self {
            potential,
            form: 0,
            switches: 0,
            values: Values::default(),
            fields: Default::default(),
            particles: &[],
            numbers: VertexNumbers::NONE,
            constants: TriangleConstants::NONE,
            wants_derivatives: false,
        }
    }

    /// Refuse values outside their domains.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<()> {
        let parameters = self.potential.parameters();
        parameters
            .iter()
            .zip(&self.values)
            .try_for_each(|(parameter, value)| parameter.check(*value))
    }

    /// The value of a parameter at an element.
    #[inline]
    pub fn value(&self, parameter: usize, element: usize) -> f64 {
        self.fields[parameter].get(element).copied().unwrap_or(self.values[parameter])
    }

    /// Whether a parameter is a single value that may change what is computed: zero everywhere.
    pub fn vanishes(&self, parameter: usize) -> bool {
        self.fields[parameter].is_empty() && self.values[parameter] == 0.0
    }

    /// Whether a parameter has a value for each vertex.
    pub fn is_of_vertices(&self, parameter: usize) -> bool {
        let known = self.potential.parameters().get(parameter);
        known.is_some_and(|known| known.per == Some(Element::Vertex))
            && !self.fields[parameter].is_empty()
    }

    /// Whether a derivative with respect to this parameter makes sense: a field hides the scalar.
    #[inline]
    pub fn is_scalar(&self, parameter: usize) -> bool {
        self.fields[parameter].is_empty()
    }
}
