//! A mesh as one OpenMM Context sees it: shared by all its forces on the same triangles.

use crate::backend::Choice;
use crate::contact::{Contacts, is_contact};
use crate::error::{Error, Result};
use crate::evaluator::{BorderEvaluator, ChosenEvaluator, Present, ReferenceEvaluator};
use crate::mesh::cell::Image;
use crate::mesh::numbering::breadth_first;
use crate::mesh::orientation::is_inside_out;
use crate::mesh::{Cell, Topology, Triangulation, Unfolding};
use crate::moves::local::LocalEnergy;
use crate::moves::{FlipRules, FlipState, Touched, flips};
use crate::potentials::{Contribution, Element, Term};
use crate::remembered::Remembered;
use nalgebra::Matrix3;
use smallvec::SmallVec;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

/// How many membranes there are, which tells whether forces share them and whether any are left over.
static ALIVE: AtomicI64 = AtomicI64::new(0);

/// The number of membranes that exist in this process.
pub fn count() -> i64 {
    ALIVE.load(Ordering::Relaxed)
}

/// A mesh with the buffers to evaluate any terms on it, and to change its connectivity.
pub struct Membrane {
    mesh: Triangulation,
    unfolding: Unfolding,
    /// The vertices, so that neighbours on the surface are near each other.
    order: Vec<u32>,
    /// How many flips there have been since the order was made.
    flips_of_order: u64,
    initial_fingerprint: u64,
    evaluator: ChosenEvaluator,
    borders: BorderEvaluator,
    local: LocalEnergy,
    contacts: Contacts,
    /// The forces after the last flips, which the time step asks for next.
    remembered: Remembered,
    /// The forces before them; kept for its memory.
    before: Vec<f64>,
    num_particles: usize,
    /// Whether the surface has been looked at and is not inside out.
    has_outside: bool,
}

/// A membrane that has all triangles of another one among its own, and the terms of contacts on it: the other one's flips
/// count its energy, and it makes them, too.
pub struct Follower<'a, 't> {
    /// The membrane.
    pub membrane: &'a mut Membrane,
    /// The place of the other one's first triangle.
    pub first_triangle: usize,
    /// Terms of contacts.
    pub terms: &'a [Term<'t>],
}

/// What decides the bits of evaluations beside positions: the connectivity, and in which order sums are formed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Connectivity {
    /// The particles at the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// The vertices, by their index in ascending order of particle.
    pub order: Vec<u32>,
    /// How many flips there have been since the order was made.
    pub flips: u64,
}

/// The positions that a membrane's evaluators shall see. A macro, since the evaluator is needed beside them.
macro_rules! unfolded {
    ($membrane:ident, $positions:expr, $cell:expr) => {
        match $cell {
            None => {
                if $membrane.mesh.set_images(Vec::new()) {
                    let (mesh, order) = (&$membrane.mesh, $membrane.order.as_slice());
                    $membrane.evaluator.connectivity_changed(Present {
                        mesh,
                        order,
                        cell: None,
                    })?;
                }
                $positions
            }
            Some(cell) => {
                let found = $membrane.unfolding.unfold(&mut $membrane.mesh, $positions, cell)?;
                if found.has_new_images {
                    let (mesh, order) = (&$membrane.mesh, $membrane.order.as_slice());
                    $membrane.evaluator.connectivity_changed(Present {
                        mesh,
                        order,
                        cell: None,
                    })?;
                }
                found.positions
            }
        }
    };
}

impl Membrane {
    /// For triangles of particles of a System with `num_particles` of them.
    ///
    /// # Errors
    /// Those of [`Topology::new`].
    pub fn new(triangles: &[[i64; 3]], num_particles: usize) -> Result<Self> {
        let mesh = Triangulation::new(&Topology::new(triangles, num_particles)?);
        let order = breadth_first(&mesh);
        let (evaluator, local) = (ChosenEvaluator::new(), LocalEnergy::default());
        ALIVE.fetch_add(1, Ordering::Relaxed);
        Ok(Self {
            initial_fingerprint: mesh.fingerprint(),
            mesh,
            unfolding: Unfolding::default(),
            order,
            flips_of_order: 0,
            evaluator,
            borders: BorderEvaluator::default(),
            local,
            contacts: Contacts::default(),
            remembered: Remembered::default(),
            before: Vec::new(),
            num_particles,
            has_outside: false,
        })
    }

    /// Let so many threads share evaluations, where that turns out faster; 0 for as many as there are.
    pub fn set_threads(&mut self, threads: usize) {
        self.evaluator.set_threads(threads);
        self.contacts.set_threads(threads);
    }

    /// The mesh as it is now.
    pub fn mesh(&self) -> &Triangulation {
        &self.mesh
    }

    /// A whole number below 2⁵³, as a double, that tells the present triangles from any others: 0 for those that the
    /// membrane began with.
    pub fn fingerprint(&self) -> f64 {
        let difference = self.mesh.fingerprint().wrapping_sub(self.initial_fingerprint);
        if difference == 0 { 0.0 } else { ((difference >> 11) | 1) as f64 }
    }

    /// What there is to remember of the present connectivity.
    pub fn connectivity(&self) -> Connectivity {
        Connectivity {
            triangles: (0..self.mesh.triangles().len())
                .map(|t| self.mesh.particles_of(t))
                .collect(),
            order: self.order.clone(),
            flips: self.flips_of_order,
        }
    }

    /// Go on with other triangles of the same particles, as many as there are.
    ///
    /// # Errors
    /// Those of [`Triangulation::with_triangles`]; nothing has changed then.
    pub fn set_triangles(&mut self, triangles: &[[i64; 3]]) -> Result<()> {
        let mesh = self.mesh.with_triangles(triangles)?;
        let order = breadth_first(&mesh);
        // They may be turned the other way.
        self.has_outside = false;
        self.take(mesh, order, 0)
    }

    /// Go on with what [`Self::connectivity`] had been: the same bits follow.
    ///
    /// # Errors
    /// Those of [`Triangulation::with_triangles`], and an order that is none; nothing has changed then.
    pub fn restore(&mut self, saved: &Connectivity) -> Result<()> {
        let triangles: Vec<_> = saved.triangles.iter().map(|t| t.map(i64::from)).collect();
        let mesh = self.mesh.with_triangles(&triangles)?;
        let mut met = vec![false; mesh.num_vertices()];
        let all_new = saved.order.iter().all(|vertex| {
            met.get_mut(*vertex as usize).is_some_and(|met| !std::mem::replace(met, true))
        });
        if !all_new || saved.order.len() != met.len() {
            return Err(Error::Contract(
                "the saved order of the vertices is none; what was saved is damaged".to_owned(),
            ));
        }
        self.take(mesh, saved.order.clone(), saved.flips)
    }

    fn take(&mut self, mesh: Triangulation, order: Vec<u32>, flips: u64) -> Result<()> {
        (self.mesh, self.order, self.flips_of_order) = (mesh, order, flips);
        self.remembered.clear();
        self.contacts.forget();
        self.connectivity_changed()
    }

    /// The triangles have changed, and with them all that is made of them.
    fn connectivity_changed(&mut self) -> Result<()> {
        self.unfolding.connectivity_changed();
        self.borders.connectivity_changed();
        let present = Present { mesh: &self.mesh, order: &self.order, cell: None };
        self.evaluator.connectivity_changed(present)
    }

    /// Try to flip so many edges at the present positions (nm), in a periodic box or none, with the energy of some terms.
    /// Returns how many flips were made. If `force_change` (kJ/mol/nm, in the layout of the positions) is wanted, it gets by how much they
    /// have changed the forces; it is left alone if there were none.
    ///
    /// # Errors
    /// Rules that make no sense, a term as [`Self::evaluate`] refuses it, a mesh without geometry: nothing has changed
    /// then. A GPU that was asked for and fails: the flips have been made.
    #[expect(clippy::too_many_arguments, reason = "what a move needs is of several kinds")]
    pub fn flip(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
        rules: &FlipRules,
        attempts: u64,
        state: &mut FlipState,
        force_change: Option<&mut [f64]>,
    ) -> Result<u64> {
        self.flip_together(terms, positions, cell, rules, attempts, state, force_change, &mut [])
    }

    /// The same with membranes that follow: their energy counts, and they make the same flips.
    ///
    /// # Errors
    /// Those of [`Self::flip`].
    #[allow(clippy::too_many_arguments, reason = "they are those of `flip` and one more")]
    pub fn flip_together(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
        rules: &FlipRules,
        attempts: u64,
        state: &mut FlipState,
        mut force_change: Option<&mut [f64]>,
        followers: &mut [Follower],
    ) -> Result<u64> {
        if positions.len() != 3 * self.num_particles {
            return Err(Error::Contract(format!(
                "needs positions of {} particles",
                self.num_particles
            )));
        }
        for term in terms {
            self.check(term)?;
        }
        self.remembered.clear();
        let given = positions;
        let positions = unfolded!(self, given, cell);
        let mut before = force_change.as_ref().map(|_| {
            self.before.clear();
            self.before.resize(positions.len(), 0.0);
            self.before.as_mut_slice()
        });
        let present = Present { mesh: &self.mesh, order: &self.order, cell };
        let on_borders = self.borders.forward(&self.mesh, terms, positions, cell)?;
        self.local.fill(&self.mesh, terms, cell, |survey| {
            self.evaluator.survey(present, terms, positions, before.as_deref_mut(), survey)
        })?;
        self.borders.add(&self.mesh, positions, cell, on_borders, &mut [], before);
        let wants_forces = force_change.is_some();
        let mut touched: SmallVec<[Touched; 2]> = SmallVec::new();
        if terms.iter().any(is_contact) {
            let contacts = &mut self.contacts;
            let before = wants_forces.then_some(&mut self.before[..]);
            contacts.evaluate(&self.mesh, cell, terms, given, &mut [], before)?;
            contacts.prepare_flips(&self.mesh, cell, terms, given)?;
            touched.push(Touched { contacts, terms, mesh: None, first_half: 0 });
        }
        for follower in &mut *followers {
            let Follower { membrane, first_triangle, terms } = follower;
            let (contacts, mesh) = (&mut membrane.contacts, &mut membrane.mesh);
            if wants_forces {
                let before = Some(&mut self.before[..]);
                contacts.evaluate(mesh, cell, terms, given, &mut [], before)?;
            }
            contacts.prepare_flips(mesh, cell, terms, given)?;
            let first_half = 3 * *first_triangle as u32;
            touched.push(Touched { contacts, terms, mesh: Some(mesh), first_half });
        }
        let (mesh, local) = (&mut self.mesh, &mut self.local);
        let made = flips::attempt(mesh, local, terms, rules, attempts, state, &mut touched);
        drop(touched);
        if made > 0 {
            self.flips_of_order += made;
            // By then every vertex has moved on by a few neighbours.
            if self.flips_of_order > 2 * self.mesh.num_edges() as u64 {
                (self.order, self.flips_of_order) = (breadth_first(&self.mesh), 0);
            }
            self.borders.connectivity_changed();
            self.unfolding.connectivity_changed();
            if let Some(cell) = cell {
                self.unfolding.unfold(&mut self.mesh, given, cell)?;
            }
            self.evaluator.connectivity_changed(Present {
                mesh: &self.mesh,
                order: &self.order,
                cell,
            })?;
            for Follower { membrane, .. } in &mut *followers {
                membrane.connectivity_changed()?;
            }
            if let Some(change) = &mut force_change {
                self.compare_forces(terms, given, cell, change)?;
                for Follower { membrane, terms, .. } in followers {
                    let Membrane { mesh, contacts, .. } = &mut **membrane;
                    contacts.evaluate(mesh, cell, terms, given, &mut [], Some(change))?;
                }
            }
        }
        Ok(made)
    }

    /// By how much forces differ from those before flips; what they are is remembered.
    fn compare_forces(
        &mut self,
        terms: &[Term],
        given: &[f64],
        cell: Option<&Cell>,
        change: &mut [f64],
    ) -> Result<()> {
        let positions = unfolded!(self, given, cell);
        let present = Present { mesh: &self.mesh, order: &self.order, cell };
        let on_borders = self.borders.forward(&self.mesh, terms, positions, cell)?;
        let after = self.remembered.fill(terms, given, cell, |forces| {
            self.evaluator.evaluate(present, terms, positions, &mut [], Some(&mut *forces))?;
            let into = Some(&mut *forces);
            self.borders.add(&self.mesh, positions, cell, on_borders, &mut [], into);
            self.contacts.evaluate(&self.mesh, cell, terms, given, &mut [], Some(forces))
        })?;
        for ((change, after), before) in change.iter_mut().zip(after).zip(&self.before) {
            *change = after - before;
        }
        Ok(())
    }

    /// Let a force join that wants to be computed in some way, or in any.
    ///
    /// # Errors
    /// Those of [`ChosenEvaluator::choose`].
    pub fn choose(&mut self, wish: Option<Choice>) -> Result<()> {
        self.evaluator.choose(&self.mesh, wish)
    }

    /// Evaluate terms together. Positions (nm) and forces (kJ/mol/nm) are those of all particles of the
    /// System, x y z of one after the other; forces are added. Without contributions no energies are summed. In a periodic
    /// box, edges connect nearest images.
    ///
    /// # Errors
    /// Those of [`ChosenEvaluator::evaluate`] and of [`Unfolding::unfold`], triangles that are turned inside out where a term needs an outside, and
    /// a parameter outside its domain, as a Context parameter
    /// can come to be.
    pub fn evaluate(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
        contributions: &mut [Contribution],
        mut forces: Option<&mut [f64]>,
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
        if let (true, Some(forces)) = (contributions.is_empty(), &mut forces)
            && self.remembered.add_once(terms, positions, cell, forces)
        {
            return Ok(());
        }
        let given = positions;
        contributions.fill(Contribution::default());
        // A surface that only contacts act on may be in no condition for the others.
        if terms.is_empty() || !terms.iter().all(is_contact) {
            let positions = unfolded!(self, given, cell);
            if !self.has_outside || !self.mesh.images().is_empty() {
                look_for_outside(&self.mesh, &mut self.has_outside, terms, positions)?;
            }
            let present = Present { mesh: &self.mesh, order: &self.order, cell };
            let on_borders = self.borders.forward(&self.mesh, terms, positions, cell)?;
            let (evaluator, energies) = (&mut self.evaluator, &mut *contributions);
            evaluator.evaluate(present, terms, positions, energies, forces.as_deref_mut())?;
            let (energies, into) = (&mut *contributions, forces.as_deref_mut());
            self.borders.add(&self.mesh, positions, cell, on_borders, energies, into);
        }
        self.contacts.evaluate(&self.mesh, cell, terms, given, contributions, forces)
    }

    /// ∂E/∂ε of some terms for a homogeneous strain ε of all positions and of the periodic box, kJ/mol: where there is
    /// none, or no surface spans it, −Σ F ⊗ r.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn virial(
        &mut self,
        terms: &[Term],
        positions: &[f64],
        cell: Option<&Cell>,
    ) -> Result<Matrix3<f64>> {
        // What this refuses, nothing below has to.
        self.evaluate(terms, positions, cell, &mut [], None)?;
        let of_contacts = self.contacts.virial(&self.mesh, cell, terms, positions)?;
        if terms.iter().all(is_contact) {
            return Ok(of_contacts);
        }
        let positions = unfolded!(self, positions, cell);
        let of_geometry = virial_of_geometry(&self.mesh, terms, positions, cell)?;
        let of_borders = self.borders.virial(&self.mesh, terms, positions, cell)?;
        Ok(of_geometry + of_borders + of_contacts)
    }

    /// Refuse particles of a term that do not exist, come twice or are vertices.
    ///
    /// # Errors
    /// Names the particle.
    pub fn check_particles(&self, term: &Term) -> Result<()> {
        Contacts::check(&self.mesh, term, self.num_particles)
    }

    /// Refuse a term with values outside their domains, or with more or fewer values for single
    /// elements than there are elements, or that needs a closed surface where this one has a border.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self, term: &Term) -> Result<()> {
        term.check()?;
        if term.potential.needs_outside() && !self.mesh.is_closed() {
            let border = &self.mesh.border_loops()[0];
            let particles: Vec<_> =
                border.iter().map(|vertex| self.mesh.particles()[*vertex as usize]).collect();
            let (force, length) = (term.potential.name(), border.len());
            return Err(Error::Border { force, length, particles });
        }
        for (parameter, field) in term.potential.parameters().iter().zip(term.fields) {
            let (count, elements) = match parameter.per {
                _ if field.is_empty() => continue,
                Some(Element::Vertex) => (self.mesh.num_vertices(), "vertices"),
                Some(Element::Triangle) => (self.mesh.triangles().len(), "triangles"),
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

/// What terms of areas, lengths, angles and volume give to the virial, by the readable evaluator.
fn virial_of_geometry(
    mesh: &Triangulation,
    terms: &[Term],
    positions: &[f64],
    cell: Option<&Cell>,
) -> Result<Matrix3<f64>> {
    let terms: Vec<_> = terms.iter().collect();
    let mut evaluator = ReferenceEvaluator::new(Arc::new(Topology::of(mesh)));
    if let Some(cell) = cell {
        evaluator.set_images(mesh.images(), cell);
    }
    evaluator.virial(&terms, positions)
}

/// Refuse triangles that all run clockwise, as a slip in a mesh has them, before a volume below zero becomes a
/// pressure that blows the membrane up. That is settled by the first positions that a term asks about, for good:
/// a shape that turns inside out later, or crosses itself, follows the formula, whose volume has a sign. What spans a
/// periodic box has no volume.
fn look_for_outside(
    mesh: &Triangulation,
    has_outside: &mut bool,
    terms: &[Term],
    positions: &[f64],
) -> Result<()> {
    let Some(term) = terms.iter().find(|term| term.potential.needs_outside()) else {
        return Ok(());
    };
    let outer = |images: &[Image; 3]| *images != [[0; 3]; 3];
    if let Some(triangle) = mesh.images().iter().position(outer) {
        let (force, particle) = (term.potential.name(), mesh.particles_of(triangle)[0]);
        return Err(Error::Spanning { force, particle });
    }
    match is_inside_out(mesh, positions) {
        Some((true, totals)) => {
            let (force, volume) = (term.potential.name(), totals.volume);
            Err(Error::InsideOut { force, volume })
        }
        found => {
            // Of positions that are not finite the evaluator names the culprit.
            *has_outside = found.is_some();
            Ok(())
        }
    }
}

impl Drop for Membrane {
    fn drop(&mut self) {
        ALIVE.fetch_sub(1, Ordering::Relaxed);
    }
}
