//! The C interface to [`crate::membrane`]: meshes of particles, and evaluations of terms on them.

use super::{Status, TermInput, guarded, slice, text};
use crate::error::Result;
use crate::membrane::{self, Membrane};
use crate::mesh::Cell;
use crate::mesh::Configuration;
use crate::mesh::triangulation::next;
use crate::potentials::{Contribution, REGISTRY, Request, Term, TriangleConstants, VertexNumbers};
use smallvec::SmallVec;
use std::ffi::{c_char, c_int};
use std::slice as slices;

/// Make a membrane of triangles of particles. `subject` is the class that messages shall name.
///
/// # Safety
/// `subject` must end with a NUL; `triangles` must hold 3 `num_triangles` values; `membrane` must be
/// writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_create(
    subject: *const c_char,
    triangles: *const c_int,
    num_triangles: i64,
    num_particles: i64,
    membrane: *mut *mut Membrane,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let triangles = unsafe { slice(triangles.cast::<[c_int; 3]>(), num_triangles as usize) };
        let triangles: Vec<_> = triangles.iter().map(|corners| corners.map(i64::from)).collect();
        let made = Membrane::new(&triangles, num_particles as usize)?;
        unsafe { membrane.write(Box::into_raw(Box::new(made))) };
        Ok(())
    })
}

/// Destroy a membrane; null is allowed.
///
/// # Safety
/// `membrane` must come from [`Helfrich_Membrane_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_destroy(membrane: *mut Membrane) {
    if !membrane.is_null() {
        drop(unsafe { Box::from_raw(membrane) });
    }
}

/// The number of membranes that exist in this process.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Membrane_count() -> i64 {
    membrane::count()
}

/// Whether it is settled that the processor evaluates it: 1 or 0.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_isOnProcessor(membrane: *const Membrane) -> c_int {
    unsafe { &*membrane }.is_on_processor().into()
}

/// Number of edges of a membrane.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_numEdges(membrane: *const Membrane) -> i64 {
    unsafe { &*membrane }.mesh().num_edges() as i64
}

/// Write the two particles of each edge.
///
/// # Safety
/// `membrane` must be alive; `particles` must have room for two values an edge.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_edges(membrane: *const Membrane, particles: *mut c_int) {
    let mesh = unsafe { &*membrane }.mesh();
    let out = unsafe { slices::from_raw_parts_mut(particles, 2 * mesh.num_edges()) };
    let ends = mesh.edges().flat_map(|half| [mesh.origin(half), mesh.origin(next(half))]);
    for (slot, vertex) in out.iter_mut().zip(ends) {
        *slot = mesh.particles()[vertex as usize] as c_int;
    }
}

/// Whether a membrane spans the periodic box in which it was evaluated last: 1 or 0.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_spans(membrane: *const Membrane) -> c_int {
    c_int::from(!unsafe { &*membrane }.mesh().images().is_empty())
}

/// The periodic box of some vectors; null for none.
///
/// # Safety
/// `vectors` must hold nine values or be null.
pub(super) unsafe fn cell(vectors: *const f64) -> Result<Option<Cell>> {
    let vectors = unsafe { vectors.cast::<[[f64; 3]; 3]>().as_ref() };
    vectors.map(|vectors| Cell::new(*vectors)).transpose()
}

impl TermInput {
    /// # Safety
    /// The fields and the particles must be as many as they say.
    pub(super) unsafe fn term(&self) -> Term<'_> {
        let field = |k: usize| unsafe { slice(self.fields[k], self.field_lengths[k] as usize) };
        Term {
            potential: REGISTRY[self.potential as usize],
            form: self.form as usize,
            switches: self.switches,
            values: self.values,
            fields: std::array::from_fn(field),
            particles: unsafe { slice(self.particles.cast(), self.num_particles as usize) },
            numbers: unsafe { self.numbers.as_ref() }.unwrap_or(VertexNumbers::NONE),
            constants: TriangleConstants::NONE,
            wants_derivatives: self.wants_derivatives != 0,
        }
    }
}

/// The usual handful of them costs no allocation.
///
/// # Safety
/// The terms must be as many as is said, and as [`TermInput::term`] wants them.
pub(super) unsafe fn read_terms<'a>(
    inputs: *const TermInput,
    count: i64,
) -> SmallVec<[Term<'a>; 8]> {
    let inputs = unsafe { slice(inputs, count as usize) };
    inputs.iter().map(|input| unsafe { input.term() }).collect()
}

/// The terms and the configuration of a call, and what it makes of them.
///
/// # Safety
/// `terms` as of [`read_terms`]; `positions` must hold three values for each particle; `box_vectors` must be readable or
/// null.
pub(super) unsafe fn with_terms<R>(
    (terms, num_terms): (*const TermInput, i64),
    (positions, num_particles): (*const f64, i64),
    box_vectors: *const f64,
    call: impl FnOnce(&[Term], Configuration) -> Result<R>,
) -> Result<R> {
    let terms = unsafe { read_terms(terms, num_terms) };
    let positions = unsafe { slice(positions, 3 * num_particles as usize) };
    let cell = unsafe { cell(box_vectors) }?;
    call(&terms, Configuration::new(positions, cell.as_ref()))
}

/// An array for as many numbers as there are positions; null for none.
///
/// # Safety
/// `numbers` must be null, or hold as many, which nobody else uses.
pub(super) unsafe fn like_positions<'a>(
    numbers: *mut f64,
    at: &Configuration,
) -> Option<&'a mut [f64]> {
    let length = at.positions.len();
    (!numbers.is_null()).then(|| unsafe { slices::from_raw_parts_mut(numbers, length) })
}

/// One contribution a term; null for none.
///
/// # Safety
/// `contributions` must be null, or hold as many.
pub(super) unsafe fn of_terms<'a>(
    contributions: *mut Contribution,
    terms: &[Term],
) -> &'a mut [Contribution] {
    match contributions.is_null() {
        true => &mut [],
        false => unsafe { slices::from_raw_parts_mut(contributions, terms.len()) },
    }
}

/// Refuse a term that cannot be evaluated on a membrane, or that has no constants of its triangles.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive; `term` must be readable with its fields.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_checkTerm(
    subject: *const c_char,
    membrane: *mut Membrane,
    term: *const TermInput,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let (membrane, term) = unsafe { (&mut *membrane, (*term).term()) };
        membrane.check(&term)?;
        membrane.equip(&[term]).map(|_| ())
    })
}

/// Refuse particles of a term that do not exist, come twice or are vertices.
///
/// # Safety
/// As [`Helfrich_Membrane_checkTerm`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_checkParticles(
    subject: *const c_char,
    membrane: *const Membrane,
    term: *const TermInput,
) -> Status {
    let subject = unsafe { text(subject) };
    guarded(subject, || unsafe { &*membrane }.check_particles(&unsafe { (*term).term() }))
}

/// Let so many threads share evaluations, where that turns out faster; 0 for as many as there are.
///
/// # Safety
/// `membrane` must be alive and used by no other thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_setThreads(membrane: *mut Membrane, threads: c_int) {
    unsafe { &mut *membrane }.set_threads(usize::try_from(threads).unwrap_or(0));
}

/// Evaluate terms together. `contributions` may be null; then no energies are computed. `forces` may be null;
/// otherwise forces are added to it. `box_vectors` has those of the periodic box, or is null if there is none.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive and used by no other thread; `terms` and
/// `contributions` must hold `num_terms` values, `positions` and `forces` three values for each particle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_evaluate(
    subject: *const c_char,
    membrane: *mut Membrane,
    terms: *const TermInput,
    num_terms: i64,
    num_particles: i64,
    positions: *const f64,
    box_vectors: *const f64,
    contributions: *mut Contribution,
    forces: *mut f64,
) -> Status {
    let (given, at) = ((terms, num_terms), (positions, num_particles));
    guarded(unsafe { text(subject) }, || unsafe {
        with_terms(given, at, box_vectors, |terms, at| {
            let forces = like_positions(forces, &at);
            let energies = of_terms(contributions, terms);
            let request =
                Request::new(terms, at.positions).with_energies(energies).with_forces(forces);
            (*membrane).evaluate(request, at.cell)
        })
    })
}

/// Add ∂E/∂ε of terms for a homogeneous strain ε of positions and periodic box to nine numbers, row by row.
///
/// # Safety
/// As of [`Helfrich_Membrane_evaluate`]; `virial` must hold nine values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_addVirial(
    subject: *const c_char,
    membrane: *mut Membrane,
    terms: *const TermInput,
    num_terms: i64,
    num_particles: i64,
    positions: *const f64,
    box_vectors: *const f64,
    virial: *mut f64,
) -> Status {
    let (given, at) = ((terms, num_terms), (positions, num_particles));
    guarded(unsafe { text(subject) }, || {
        let found = unsafe {
            with_terms(given, at, box_vectors, |terms, at| (*membrane).virial(terms, at))
        }?;
        let virial = unsafe { slices::from_raw_parts_mut(virial, 9) };
        // Matrices are stored by columns.
        virial.iter_mut().zip(&found.transpose()).for_each(|(sum, part)| *sum += part);
        Ok(())
    })
}
