//! A surface with the evaluators of its geometry.

use crate::error::{Error, Result};
use crate::evaluator::{
    BorderEvaluator, ChosenEvaluator, Present, ReferenceEvaluator, Survey, place,
};
use crate::mesh::Configuration;
use crate::mesh::cell::Image;
use crate::mesh::numbering::breadth_first;
use crate::mesh::orientation::is_inside_out;
use crate::mesh::{Topology, Triangulation, Unfolding};
use crate::potentials::{MadeOf, Request, Term};
use nalgebra::Matrix3;
use std::sync::Arc;

/// The connectivity, and what evaluates any terms but contacts on it.
pub(super) struct Surface {
    pub mesh: Triangulation,
    /// The vertices, so that neighbours on the surface are near each other.
    pub order: Vec<u32>,
    /// How many flips there have been since the order was made.
    pub flips_of_order: u64,
    /// Whether the surface has been looked at and is not inside out.
    pub has_outside: bool,
    pub evaluator: ChosenEvaluator,
    /// How often the connectivity has changed.
    pub generation: u64,
    borders: BorderEvaluator,
    unfolding: Unfolding,
}

/// A surface at some positions, in one piece.
pub(super) struct Placed<'a> {
    pub present: Present<'a>,
    positions: &'a [f64],
    has_outside: &'a mut bool,
    evaluator: &'a mut ChosenEvaluator,
    borders: &'a mut BorderEvaluator,
}

impl Surface {
    pub fn new(mesh: Triangulation) -> Self {
        Self {
            order: breadth_first(&mesh),
            flips_of_order: 0,
            has_outside: false,
            mesh,
            evaluator: ChosenEvaluator::new(),
            generation: 0,
            borders: BorderEvaluator::default(),
            unfolding: Unfolding::default(),
        }
    }

    /// The triangles have changed, and with them all that is made of them.
    pub fn connectivity_changed(&mut self) {
        self.generation += 1;
        self.unfolding.connectivity_changed();
        self.borders.connectivity_changed();
        self.evaluator.connectivity_changed();
    }

    /// So many flips have been made.
    pub fn note_flips(&mut self, made: u64) {
        self.flips_of_order += made;
        // By then every vertex has moved on by a few neighbours.
        if self.flips_of_order > 2 * self.mesh.num_edges() as u64 {
            (self.order, self.flips_of_order) = (breadth_first(&self.mesh), 0);
        }
        self.connectivity_changed();
    }

    /// Make ready for evaluations at some positions.
    ///
    /// # Errors
    /// Those of [`Unfolding::unfold`].
    pub fn place<'a>(&'a mut self, at: Configuration<'a>) -> Result<Placed<'a>> {
        let (positions, has_new_images) = match at.cell {
            None => {
                let has_new_images = self.mesh.set_images(Vec::new());
                if has_new_images {
                    // In a box again, it would take the images for those that it has found before.
                    self.unfolding.connectivity_changed();
                }
                (at.positions, has_new_images)
            }
            Some(cell) => {
                let found = self.unfolding.unfold(&mut self.mesh, at.positions, cell)?;
                (found.positions, found.has_new_images)
            }
        };
        if has_new_images {
            self.evaluator.connectivity_changed();
        }
        Ok(Placed {
            present: Present { mesh: &self.mesh, order: &self.order, cell: at.cell },
            positions,
            has_outside: &mut self.has_outside,
            evaluator: &mut self.evaluator,
            borders: &mut self.borders,
        })
    }
}

impl Placed<'_> {
    /// Evaluate all terms but those of contacts; the positions are those of this.
    ///
    /// # Errors
    /// Those of [`ChosenEvaluator::evaluate`] and of [`BorderEvaluator::forward`].
    pub fn evaluate(&mut self, request: Request) -> Result<()> {
        self.with_borders(request, ChosenEvaluator::evaluate)
    }

    /// Note what all terms but those of contacts find of every element. Forces are added.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn survey(&mut self, request: Request, survey: &mut Survey) -> Result<()> {
        self.with_borders(request, |evaluator, present, request| {
            evaluator.survey(present, request, survey)
        })
    }

    fn with_borders(
        &mut self,
        request: Request,
        evaluate: impl FnOnce(&mut ChosenEvaluator, Present, Request) -> Result<()>,
    ) -> Result<()> {
        let &mut Self { present, positions, .. } = self;
        let Present { mesh, cell, .. } = present;
        let terms = request.terms;
        let mut request = Request { positions, ..request };
        let on_borders = self.borders.forward(mesh, terms, positions, cell)?;
        evaluate(self.evaluator, present, request.again())
            .map_err(|error| self.explained(error, terms))?;
        self.borders.add(mesh, cell, on_borders, request);
        Ok(())
    }

    /// See what the processor says of terms of the surface itself. Forces are added.
    ///
    /// # Errors
    /// Those of [`ChosenEvaluator::look`].
    pub fn look(&mut self, terms: &[Term], forces: &mut [f64]) -> Result<()> {
        self.evaluator
            .look(self.present, terms, self.positions, forces)
            .map_err(|error| self.explained(error, terms))
    }

    /// An error that names the side of a triangle which has become too long, if that is why an energy is not finite.
    fn explained(&self, error: Error, terms: &[Term]) -> Error {
        let Error::NonFiniteEnergy { force, .. } = error else { return error };
        let broken = terms.iter().find_map(|term| match term.potential.limits_sides(term) {
            true => self.broken_side(term),
            false => None,
        });
        broken.filter(|broken| broken.class() == Some(force)).unwrap_or(error)
    }

    /// The first side that is too long for a term.
    fn broken_side(&self, term: &Term) -> Option<Error> {
        let Present { mesh, cell, .. } = self.present;
        term.constants.values.iter().enumerate().find_map(|(triangle, constants)| {
            let corners =
                [0, 1, 2].map(|k| place(mesh, self.positions, cell, 3 * triangle as u32 + k));
            let longest = term.potential.longest_sides(term, constants);
            (0..3).find_map(|k| {
                let (next, particles) = ((k + 1) % 3, mesh.particles_of(triangle));
                let (length, longest) = ((corners[next] - corners[k]).norm(), longest[k]);
                let (force, edge) = (term.potential.name(), [particles[k], particles[next]]);
                (length >= longest).then_some(Error::LongSpring {
                    force,
                    triangle,
                    edge,
                    length,
                    longest,
                })
            })
        })
    }

    /// What all terms but those of contacts give to the virial, by the readable evaluator.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn virial(&mut self, terms: &[Term]) -> Result<Matrix3<f64>> {
        let (Present { mesh, cell, .. }, positions) = (self.present, self.positions);
        let mut evaluator = ReferenceEvaluator::new(Arc::new(Topology::of(mesh)));
        if let Some(cell) = cell {
            evaluator.set_images(mesh.images(), cell);
        }
        let of_geometry = evaluator.virial(terms, positions)?;
        Ok(of_geometry + self.borders.virial(mesh, terms, positions, cell)?)
    }

    /// Refuse triangles that all run clockwise, as a slip in a mesh has them, before a volume below zero becomes a
    /// pressure that blows the membrane up. That is settled by the first positions that a term asks about, for good:
    /// a shape that turns inside out later, or crosses itself, follows the formula, whose volume has a sign. What spans a
    /// periodic box has no volume.
    ///
    /// # Errors
    /// Names the force.
    pub fn look_for_outside(&mut self, terms: &[Term]) -> Result<()> {
        check_references(self.present.mesh, terms)?;
        let mesh = self.present.mesh;
        if *self.has_outside && mesh.images().is_empty() {
            return Ok(());
        }
        let Some(term) = terms.iter().find(|term| term.potential.needs_outside()) else {
            return Ok(());
        };
        let force = term.potential.name();
        let outer = |images: &[Image; 3]| *images != [[0; 3]; 3];
        if let Some(triangle) = mesh.images().iter().position(outer) {
            let particle = mesh.particles_of(triangle)[0];
            return Err(Error::Spanning { force, particle });
        }
        match is_inside_out(mesh, self.positions) {
            Some((true, totals)) => Err(Error::InsideOut { force, volume: totals.volume }),
            found => {
                // Where positions are not finite, the evaluator names the culprit.
                *self.has_outside = found.is_some();
                Ok(())
            }
        }
    }
}

/// Refuse a reference that does not say how the surface goes on where it spans the periodic box.
///
/// # Errors
/// Names the force.
pub(super) fn check_references(mesh: &Triangulation, terms: &[Term]) -> Result<()> {
    let Some(triangle) = mesh.images().iter().position(|images| *images != [[0; 3]; 3]) else {
        return Ok(());
    };
    let has_no_box = |term: &&Term| {
        let made_of = term.potential.constants(term);
        matches!(made_of, Some(MadeOf::Reference(_))) && term.numbers.vectors.is_none()
    };
    terms.iter().find(has_no_box).map_or(Ok(()), |term| {
        let (force, particle) = (term.potential.name(), mesh.particles_of(triangle)[0]);
        Err(Error::NoReferenceBox { force, particle })
    })
}
