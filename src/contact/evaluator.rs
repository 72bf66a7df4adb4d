//! All contacts of one mesh.

use super::particles::ParticleContacts;
use super::surface::SurfaceContacts;
use crate::error::{Error, Result};
use crate::mesh::triangulation::Quad;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::{Contribution, Needs, Request, Term, particle_surface};
use crate::team::Sharing;
use crate::team::{Team, default_threads};
use nalgebra::Matrix3;
use smallvec::SmallVec;

/// Below so many pairs or particles several threads are never faster.
const PARALLEL_FROM: usize = 2000;

/// Evaluates terms of contacts, and follows flips.
pub struct Contacts {
    surface: SurfaceContacts,
    /// One for each term of particles, in order.
    particles: Vec<ParticleContacts>,
    alone: Team,
    /// Made when there is enough to do; the number that it may have, 0 for as many as there are.
    team: Option<Team>,
    threads: usize,
    sharing: Sharing,
}

impl Default for Contacts {
    fn default() -> Self {
        Self {
            surface: SurfaceContacts::default(),
            particles: Vec::new(),
            alone: Team::new(1).expect("no thread is made for a team of one"),
            team: None,
            threads: 0,
            sharing: Sharing::new(),
        }
    }
}

/// Whether a term is one of contacts.
#[inline]
pub fn is_contact(term: &Term) -> bool {
    term.potential.needs(term).contains(Needs::CONTACTS)
}

/// Of vertices and triangles, and of particles and triangles, with their places among all terms.
type Sorted<'a, 't> = [SmallVec<[(usize, &'a Term<'t>); 4]>; 2];

fn sorted<'a, 't>(terms: &'a [Term<'t>]) -> Sorted<'a, 't> {
    let of = |particles: bool| {
        let has = |term: &Term| term.potential.name() == particle_surface::NAME;
        let contacts = terms.iter().enumerate().filter(|(_, term)| is_contact(term));
        contacts.filter(|(_, term)| has(term) == particles).collect()
    };
    [of(false), of(true)]
}

impl Contacts {
    /// Let so many threads share the work where that is faster; 0 for as many as there are.
    pub fn set_threads(&mut self, threads: usize) {
        (self.threads, self.team) = (threads, None);
        self.sharing = Sharing::new();
    }

    /// Forget the lists, since the triangles have been replaced other than by flips.
    pub fn forget(&mut self) {
        self.surface.forget();
    }

    /// Refuse particles of a term that do not exist, come twice or are vertices.
    ///
    /// # Errors
    /// Names the particle.
    pub fn check(mesh: &Triangulation, term: &Term, num_particles: usize) -> Result<()> {
        ParticleContacts::check(mesh, term.particles, num_particles)
    }

    /// Evaluate the terms of contacts among all; others are left alone. Contributions, which may be none, and forces
    /// (kJ/mol/nm) are added to.
    ///
    /// # Errors
    /// A position that is not finite, a periodic box that is too small, a pair without distance.
    pub fn evaluate(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        request: Request,
    ) -> Result<()> {
        self.evaluate_all(mesh, cell, request, None)
    }

    /// ∂E/∂ε for a homogeneous strain ε of all positions and of the periodic box, kJ/mol.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn virial(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        terms: &[Term],
        positions: &[f64],
    ) -> Result<Matrix3<f64>> {
        let mut virial = Matrix3::zeros();
        self.evaluate_all(mesh, cell, Request::new(terms, positions), Some(&mut virial))?;
        Ok(virial)
    }

    fn evaluate_all(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        request: Request,
        mut virial: Option<&mut Matrix3<f64>>,
    ) -> Result<()> {
        let Request { terms, positions, energies: contributions, mut forces } = request;
        let [surface, particles] = sorted(terms);
        if surface.is_empty() && particles.is_empty() {
            return Ok(());
        }
        let count: usize = particles.iter().map(|(_, term)| term.particles.len()).sum();
        let worth_it = count + self.surface.work() >= PARALLEL_FROM;
        let attempt = worth_it.then(|| self.sharing.next());
        if worth_it && self.team.is_none() {
            let threads = if self.threads == 0 { default_threads() } else { self.threads };
            self.team = Team::new(threads).ok();
        }
        let together = attempt.as_ref().is_some_and(|attempt| attempt.together);
        let team = self.team.as_mut().filter(|_| together).unwrap_or(&mut self.alone);
        let mut sums: SmallVec<[Contribution; 4]> = SmallVec::new();
        if !surface.is_empty() {
            let only: SmallVec<[&Term; 4]> = surface.iter().map(|(_, term)| *term).collect();
            sums.resize(only.len(), Contribution::default());
            self.surface.prepare(mesh, cell, &only, positions, team)?;
            let into = (forces.as_deref_mut(), virial.as_deref_mut());
            self.surface.evaluate(mesh, &only, &mut sums, into, team);
        }
        self.particles
            .resize_with(particles.len().max(self.particles.len()), ParticleContacts::default);
        for ((_, term), contacts) in particles.iter().zip(&mut self.particles) {
            let mut sum = Contribution::default();
            let on = (mesh, cell);
            let into = (forces.as_deref_mut(), virial.as_deref_mut());
            contacts.evaluate(on, term, positions, &mut sum, into, team)?;
            sums.push(sum);
        }
        for ((place, term), sum) in surface.iter().chain(&particles).zip(&sums) {
            if !sum.energy.is_finite() {
                let force = term.potential.name();
                let is_of_particles = force == particle_surface::NAME;
                let nearest = (!is_of_particles).then(|| self.surface.nearest(mesh, term));
                return Err(match nearest.flatten() {
                    Some((particles, are_edges)) => {
                        Error::TouchingSurface { force, particles, are_edges }
                    }
                    None => Error::Touching { force },
                });
            }
            if let Some(contribution) = contributions.get_mut(*place) {
                *contribution += *sum;
            }
        }
        if let Some(attempt) = attempt {
            self.sharing.done(&attempt);
        }
        Ok(())
    }

    /// Be ready for flips at some positions.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn prepare_flips(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        terms: &[Term],
        positions: &[f64],
    ) -> Result<()> {
        let [surface, particles] = sorted(terms);
        let only: SmallVec<[&Term; 4]> = surface.iter().map(|(_, term)| *term).collect();
        self.surface.prepare(mesh, cell, &only, positions, &mut self.alone)?;
        self.surface.prepare_flips(&only, &mut self.alone);
        self.particles
            .resize_with(particles.len().max(self.particles.len()), ParticleContacts::default);
        for ((_, term), contacts) in particles.iter().zip(&mut self.particles) {
            contacts.prepare_flips((mesh, cell), term, positions)?;
        }
        Ok(())
    }

    /// An upper bound of the energy that a flip can set free, kJ/mol: that of the contacts around it. `quad` is the
    /// quadrilateral before the flip.
    pub fn most(
        &mut self,
        mesh: &Triangulation,
        terms: &[Term],
        positions: &[f64],
        quad: &Quad,
    ) -> f64 {
        let [surface, particles] = sorted(terms);
        let quiet = self.particles[..particles.len()].iter().all(|one| one.is_quiet(quad));
        let attracts = |(_, term): &(usize, &Term)| particle_surface::attracts(term);
        if (surface.is_empty() || self.surface.is_quiet(mesh, quad)) && quiet {
            0.0
        } else if particles.iter().any(attracts) && !quiet {
            f64::INFINITY
        } else {
            self.around(mesh, terms, positions, quad)
        }
    }

    /// The energy, kJ/mol, of all that a flip changes: of the two triangles and their edge, before the flip or after it.
    /// `positions` are those of [`Self::prepare_flips`].
    pub fn around(
        &mut self,
        mesh: &Triangulation,
        terms: &[Term],
        positions: &[f64],
        quad: &Quad,
    ) -> f64 {
        let [surface, particles] = sorted(terms);
        let only: SmallVec<[&Term; 4]> = surface.iter().map(|(_, term)| *term).collect();
        let surface = self.surface.around(mesh, &only, quad);
        let pairs = particles.iter().zip(&self.particles);
        let of = |((_, term), contacts): (&(usize, &Term), &ParticleContacts)| {
            contacts.around(mesh, term, positions, quad.triangles())
        };
        surface + pairs.map(of).sum::<f64>()
    }

    /// Replace the edge ij of a quadrilateral by kl in the lists; the mesh is not looked at.
    pub fn follow(&mut self, quad: &Quad) {
        self.surface.follow(quad);
    }

    /// Keep what [`Self::around`] found last, since its flip has been made.
    pub fn note_new_pairs(&mut self) {
        self.surface.note_new_pairs();
    }
}
