//! The energy of borders, in one pass beside whatever evaluator does the rest: they are few. Only OpenMM's GPU platforms
//! compute it themselves, triangle by triangle, so that nothing travels.

use super::checks::check_energies;
use crate::error::Result;
use crate::mesh::borders::{BorderPartials, Borders};
use crate::mesh::geometry::Vec3;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::{Contribution, Needs, Request, Term};
use nalgebra::Matrix3;
use smallvec::SmallVec;

/// Evaluates the terms of borders on one mesh.
#[derive(Default)]
pub struct BorderEvaluator {
    /// Made when a term first needs them with the present connectivity.
    borders: Option<Borders>,
}

/// Energies of the terms, and what they do to the borders.
pub struct OnBorders {
    contributions: SmallVec<[Contribution; 8]>,
    partials: BorderPartials,
}

impl BorderEvaluator {
    /// Go on with other connectivity.
    pub fn connectivity_changed(&mut self) {
        self.borders = None;
    }

    /// The energies of terms at the positions of all particles, nm, in a periodic box or none; `None` if none acts on
    /// borders.
    ///
    /// # Errors
    /// An energy that is not finite although the geometry is.
    pub fn forward(
        &mut self,
        mesh: &Triangulation,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
    ) -> Result<Option<OnBorders>> {
        let acts = |term: &Term| term.potential.needs(term).contains(Needs::BORDERS);
        if !terms.iter().any(acts) {
            return Ok(None);
        }
        let borders = self.borders.get_or_insert_with(|| Borders::new(mesh));
        let totals = borders.totals(|half| place(mesh, positions, cell, half));
        let mut partials = BorderPartials::default();
        let contributions: SmallVec<[_; 8]> = terms
            .iter()
            .map(|term| match acts(term) {
                true => term.potential.borders(term, &totals, &mut partials),
                false => Contribution::default(),
            })
            .collect();
        // Where positions are not finite, the other evaluator names the culprit.
        if totals.length.is_finite() && totals.turning.is_finite() {
            check_energies(terms, &contributions)?;
        }
        Ok(Some(OnBorders { contributions, partials }))
    }

    /// What the terms give to ∂E/∂ε for a homogeneous strain ε of positions and box, kJ/mol.
    ///
    /// # Errors
    /// Those of [`Self::forward`].
    pub fn virial(
        &mut self,
        mesh: &Triangulation,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
    ) -> Result<Matrix3<f64>> {
        let mut virial = Matrix3::zeros();
        let found = self.forward(mesh, terms, positions, cell)?;
        if let (Some(found), Some(borders)) = (found, &self.borders) {
            let position = |half| place(mesh, positions, cell, half);
            let origin = position(0);
            borders.forces(position, &found.partials, |half, force| {
                virial -= force * (position(half) - origin).transpose();
            });
        }
        Ok(virial)
    }

    /// Add what [`Self::forward`] has found to energies, if they are wanted, and to forces, kJ/mol/nm.
    pub fn add(
        &self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        found: Option<OnBorders>,
        request: Request,
    ) {
        let (Some(found), Some(borders)) = (found, &self.borders) else { return };
        let Request { positions, energies, forces, .. } = request;
        for (sum, part) in energies.iter_mut().zip(found.contributions) {
            *sum += part;
        }
        if let Some(forces) = forces {
            let position = |half| place(mesh, positions, cell, half);
            borders.forces(position, &found.partials, |half, force| {
                let particle = mesh.particles()[mesh.origin(half) as usize] as usize;
                for (sum, part) in forces[3 * particle..][..3].iter_mut().zip(&force) {
                    *sum += part;
                }
            });
        }
    }
}

/// Where the corner that a half-edge begins at is, beside the others of its triangle.
pub fn place(mesh: &Triangulation, positions: &[f64], cell: Option<&Cell>, half: u32) -> Vec3 {
    let particle = mesh.particles()[mesh.origin(half) as usize] as usize;
    let position = Vec3::from_column_slice(&positions[3 * particle..][..3]);
    match (mesh.images().as_flattened().get(half as usize), cell) {
        (Some(image), Some(cell)) => position + cell.shift(*image),
        _ => position,
    }
}
