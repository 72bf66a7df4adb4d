//! Vertices whose masses follow their plaquettes: O. Farnudi, M. R. Ejtehadi and R. Everaers, Phys. Rev. E 108, 015301
//! (2023), Sec. II.B, doi:10.1103/PhysRevE.108.015301, who propose the Hamiltonian and leave its dynamics open.
//!
//! H(p, q) = K + U(q), K = Σ pᵢ²/(2 mᵢ), mᵢ = σ aᵢ(q) with the barycentric areas aᵢ of the plaquettes; σ is a given
//! density, or M/A with the area A(q) of the surface and its constant mass M. The kinetic energy depends on the
//! positions, so there is a force −∂K/∂q besides −∂U/∂q:
//!
//! −∂K/∂rᵢ = Σⱼ (σ vⱼ²/2) ∂aⱼ/∂rᵢ, less (K/A) ∂A/∂rᵢ where σ = M/A.
//!
//! A time step h is the generalised leapfrog (E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration, VI.3,
//! doi:10.1007/3-540-30666-8):
//!
//! 1. p' = p − (h/2) ∂H/∂q(p', q), an implicit equation for p',
//! 2. q' = q + (h/2) (p'/m(q) + p'/m(q')), an implicit equation for q',
//! 3. p″ = p' − (h/2) ∂H/∂q(p', q').
//!
//! It is symplectic, symmetric and of second order, and conserves linear and angular momentum. Both equations are solved
//! to rounding by iteration; in a step vertices move by some 1e-3 of a plaquette's width, and each iteration gains as
//! much.

mod passes;
#[cfg(test)]
mod tests;
mod vertices;

use super::plaquettes::{Plaquettes, Sheet, share};
use super::random::{GROUP, Stream};
use crate::dynamics::integrate::Particles;
use crate::error::Result;
use crate::mesh::Cell;
use crate::mesh::topology::NONE;
use crate::team::{Parts, Team};
use passes::Bath;
use vertices::Vertices;

/// The particles of a System under masses that follow plaquettes. Massless particles do not move.
pub struct VariableMasses {
    /// Those of the System, amu.
    constant: Vec<f64>,
    /// Mass per area, amu/nm²; 0 for surfaces of constant mass.
    density: f64,
    /// None as long as there are no surfaces.
    vertices: Option<Vertices>,
    /// Particles that are no vertices and move, with 1/m.
    others: Vec<(u32, f64)>,
    /// √(1/m) for each component of each particle.
    roots: Vec<f64>,
}

impl VariableMasses {
    /// Particles with the masses of a System, amu, and so far no surfaces; `density` is the mass per area of surfaces,
    /// amu/nm², or 0 where each surface keeps its mass.
    pub fn new(masses: &[f64], density: f64) -> Self {
        Self {
            constant: masses.to_vec(),
            density,
            vertices: None,
            others: Vec::new(),
            roots: vec![0.0; 3 * masses.len()],
        }
    }

    /// Go on with the surfaces that the triangles of all forces make up.
    ///
    /// # Errors
    /// Those of [`Plaquettes::new`].
    pub fn set_surfaces(&mut self, sheets: &[Sheet]) -> Result<()> {
        let plaquettes = Plaquettes::new(sheets, self.constant.len())?;
        let vertices = Vertices::new(plaquettes, &self.constant, self.density);
        let mut is_vertex = vec![false; self.constant.len()];
        for &particle in vertices.plaquettes.layout().particles.as_flattened() {
            if particle != NONE {
                is_vertex[particle as usize] = true;
            }
        }
        let moves = |(particle, mass): &(usize, &f64)| !is_vertex[*particle] && **mass != 0.0;
        let others = self.constant.iter().enumerate().filter(moves);
        self.others = others.map(|(particle, mass)| (particle as u32, 1.0 / mass)).collect();
        self.vertices = Some(vertices);
        Ok(())
    }

    /// The masses of all particles at some positions, amu.
    ///
    /// # Errors
    /// Those of [`Plaquettes::place`].
    pub fn masses(&mut self, positions: &[f64], cell: Option<&Cell>) -> Result<Vec<f64>> {
        let mut masses = self.constant.clone();
        let Some(vertices) = &mut self.vertices else { return Ok(masses) };
        vertices.plaquettes.place(&mut None, positions, cell)?;
        vertices.weigh();
        let lanes = vertices.plaquettes.layout().particles.as_flattened();
        for (&particle, &mass) in lanes.iter().zip(vertices.masses.as_flattened()) {
            if particle != NONE {
                masses[particle as usize] = mass;
            }
        }
        Ok(masses)
    }

    /// The first two parts of a time step of `step` ps, with the forces at the old positions: to new positions. The
    /// momenta of vertices stay here until [`Self::finish`], which has to come next.
    ///
    /// # Errors
    /// Those of [`Plaquettes::place`]; equations that iteration does not solve. Nothing has changed then.
    pub fn begin(
        &mut self,
        mut team: Option<&mut Team>,
        particles: Particles,
        cell: Option<&Cell>,
        step: f64,
    ) -> Result<()> {
        let Particles { positions, velocities, forces } = particles;
        let team = &mut team;
        if let Some(vertices) = &mut self.vertices {
            vertices.plaquettes.place(team, positions, cell)?;
            vertices.weigh();
            vertices.read(velocities);
            vertices.add_forces(forces, 0.5 * step);
            vertices.kick_implicitly(team, step)?;
            vertices.drift(team, cell, step)?;
            vertices.write_positions(positions);
        }
        for &(particle, inverse) in &self.others {
            for i in 3 * particle as usize..3 * particle as usize + 3 {
                velocities[i] += 0.5 * step * (forces[i] * inverse);
                positions[i] += step * velocities[i];
            }
        }
        Ok(())
    }

    /// The last part of a time step, with the forces at the new positions: to new velocities.
    ///
    /// # Errors
    /// Those of [`Plaquettes::place`].
    pub fn finish(
        &mut self,
        mut team: Option<&mut Team>,
        particles: Particles,
        cell: Option<&Cell>,
        step: f64,
    ) -> Result<()> {
        let Particles { positions, velocities, forces } = particles;
        let team = &mut team;
        if let Some(vertices) = &mut self.vertices {
            vertices.plaquettes.place(team, positions, cell)?;
            vertices.weigh();
            vertices.add_forces(forces, 0.5 * step);
            vertices.kick(team, 0.5 * step);
            vertices.write_velocities(velocities);
        }
        for &(particle, inverse) in &self.others {
            for i in 3 * particle as usize..3 * particle as usize + 3 {
                velocities[i] += 0.5 * step * (forces[i] * inverse);
            }
        }
        Ok(())
    }

    /// Let a bath with `friction` in 1/ps and kT in kJ/mol act on the momenta for `time` ps, at constant positions. Takes
    /// one draw of the stream.
    ///
    /// # Errors
    /// Those of [`Plaquettes::place`].
    pub fn bathe(
        &mut self,
        mut team: Option<&mut Team>,
        particles: Particles,
        cell: Option<&Cell>,
        stream: &mut Stream,
        (time, friction, kt): (f64, f64, f64),
    ) -> Result<()> {
        let Particles { positions, velocities, .. } = particles;
        let team = &mut team;
        if let Some(vertices) = &mut self.vertices {
            vertices.plaquettes.place(team, positions, cell)?;
            vertices.weigh();
            let lanes = vertices.plaquettes.layout().particles.as_flattened();
            for (&particle, &inverse) in lanes.iter().zip(vertices.inverse_masses.as_flattened()) {
                if particle != NONE {
                    self.roots.as_chunks_mut().0[particle as usize] = [inverse.sqrt(); 3];
                }
            }
        }
        for &(particle, inverse) in &self.others {
            self.roots.as_chunks_mut().0[particle as usize] = [inverse.sqrt(); 3];
        }
        let scale = (-time * friction).exp();
        let noise = (1.0 - scale * scale).sqrt() * kt.sqrt();
        let (length, roots, draw) = (velocities.len(), &self.roots, *stream);
        let velocities = Parts::new(velocities);
        share(team, length.div_ceil(GROUP), |groups| {
            let range = groups.start * GROUP..(groups.end * GROUP).min(length);
            // SAFETY: groups do not overlap, and those of different threads are different.
            let velocities = unsafe { velocities.part(range.clone()) };
            let (first_group, roots) = (groups.start as u64, &roots[range]);
            Bath { stream: &draw, first_group, scale, noise, roots, velocities }.run();
        });
        stream.draws += 1;
        Ok(())
    }
}
