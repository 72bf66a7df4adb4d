//! The C interface: what the C++ shim, the Python package and OpenMM's plugin loader call.
//!
//! Every function that can fail returns 0 for success and 1 for failure; [`Helfrich_lastError`] then has
//! the message of the calling thread. No panic leaves a function. `openmm-helfrich/internal/Core.h`
//! in `wrappers/include` declares them for C++, as far as C++ needs them; the two change together.

#![allow(non_snake_case, reason = "names follow OpenMM's C API")]

mod dynamics;

use crate::error::{Error, Result};
use crate::membrane::{self, Membrane};
use crate::mesh::orientation;
use crate::potentials::{self, Contribution, Element, MAX_PARAMETERS, REGISTRY, Term};
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

thread_local! {
    static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Keep a message for [`Helfrich_lastError`].
pub(crate) fn set_last_error(message: String) {
    LAST_ERROR.with(|last| *last.borrow_mut() = message);
}

/// Run a fallible body and turn its result, or its panic, into a status and a message.
pub(crate) fn guarded(subject: &str, body: impl FnOnce() -> Result<()>) -> c_int {
    let message = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return 0,
        Ok(Err(error)) => format!("{subject}: {error}"),
        Err(panic) => {
            let text = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or("no message");
            format!("{subject}: internal error in openmm-helfrich, please report it: {text}")
        }
    };
    set_last_error(message);
    1
}

/// The text behind a pointer; a name that is not text is a name that nobody knows.
///
/// # Safety
/// `text` must be null or end with a NUL.
pub(crate) unsafe fn text<'a>(text: *const c_char) -> &'a str {
    if text.is_null() {
        return "";
    }
    unsafe { CStr::from_ptr(text) }.to_str().unwrap_or("?")
}

/// A slice that may be empty with a null pointer.
///
/// # Safety
/// `data` must point to `length` values, unless `length` is 0.
unsafe fn slice<'a, T>(data: *const T, length: usize) -> &'a [T] {
    if length == 0 { &[] } else { unsafe { slice::from_raw_parts(data, length) } }
}

/// Copy a message with its NUL into a buffer, cutting it if need be; returns its whole length.
///
/// # Safety
/// `buffer` must have room for `size` bytes, unless `size` is 0.
pub(crate) unsafe fn copy_out(message: &str, buffer: *mut c_char, size: i64) -> i64 {
    if size > 0 {
        let length = message.len().min(size as usize - 1);
        let bytes = unsafe { slice::from_raw_parts_mut(buffer.cast::<u8>(), length + 1) };
        bytes[..length].copy_from_slice(&message.as_bytes()[..length]);
        bytes[length] = 0;
    }
    message.len() as i64
}

/// Copy the message of this thread's last failure into a buffer of `size` bytes; returns its length.
///
/// # Safety
/// `buffer` must have room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_lastError(buffer: *mut c_char, size: i64) -> i64 {
    LAST_ERROR.with(|last| unsafe { copy_out(&last.borrow(), buffer, size) })
}

/// The message of this thread's last failure.
pub fn last_error() -> String {
    LAST_ERROR.with(|last| last.borrow().clone())
}

/// The version of OpenMM that this library was built against.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_openmmVersion() -> *const c_char {
    const VERSION: &CStr = match CStr::from_bytes_with_nul(
        concat!(env!("HELFRICH_OPENMM_VERSION"), "\0").as_bytes(),
    ) {
        Ok(version) => version,
        Err(_) => panic!("a version has no NUL inside"),
    };
    VERSION.as_ptr()
}

/// Validate a mesh and turn its triangles, in place, so that each component encloses positive volume.
///
/// # Safety
/// `vertices` must hold 3 `num_vertices` and `triangles` 3 `num_triangles` values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Mesh_orient(
    num_vertices: i64,
    vertices: *const f64,
    num_triangles: i64,
    triangles: *mut i64,
) -> c_int {
    guarded("Mesh", || {
        let vertices = unsafe { slice(vertices.cast::<[f64; 3]>(), num_vertices as usize) };
        let given =
            unsafe { slice(triangles.cast_const().cast::<[i64; 3]>(), num_triangles as usize) };
        let oriented = orientation::oriented(vertices, given)?;
        let target = triangles.cast::<[i64; 3]>();
        unsafe { slice::from_raw_parts_mut(target, oriented.len()) }.copy_from_slice(&oriented);
        Ok(())
    })
}

/// A scalar of a potential, for C++ and Python: `name` lives as long as the library, the unit is
/// (kJ/mol)^`energy` nm^`length`, and a default of NaN says that the user must give a value.
#[repr(C)]
pub struct ParameterInfo {
    name: *const c_char,
    energy: c_int,
    length: c_int,
    default_value: f64,
    /// 0: only as a scalar; 1: also for each vertex; 2: also for each triangle.
    per: c_int,
}

/// Describe the parameter `index` of a potential; fails if there is none.
///
/// # Safety
/// `potential` must end with a NUL; `info` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_parameter(
    potential: *const c_char,
    index: c_int,
    info: *mut ParameterInfo,
) -> c_int {
    let subject = unsafe { text(potential) };
    guarded(subject, || {
        let parameters = potentials::find(subject)?.parameters();
        let parameter = parameters.get(index as usize).ok_or_else(|| {
            Error::Contract(format!("has {} parameters, there is no {index}", parameters.len()))
        })?;
        let default_value = parameter.default.unwrap_or(f64::NAN);
        let (energy, length) = (parameter.energy.into(), parameter.length.into());
        let per = match parameter.per {
            None => 0,
            Some(Element::Vertex) => 1,
            Some(Element::Triangle) => 2,
        };
        let name = parameter.name.as_ptr();
        unsafe { info.write(ParameterInfo { name, energy, length, default_value, per }) };
        Ok(())
    })
}

/// The name of variant `index` of a potential, and what its variants are called ("scheme"); fails if
/// there is none.
///
/// # Safety
/// `potential` must end with a NUL; `what` and `name` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_form(
    potential: *const c_char,
    index: c_int,
    what: *mut *const c_char,
    name: *mut *const c_char,
) -> c_int {
    let subject = unsafe { text(potential) };
    guarded(subject, || {
        let found = potentials::find(subject)?;
        let (kind, names) = found.forms().unwrap_or((c"form", &[]));
        let form = names.get(index as usize).ok_or_else(|| {
            let kind = kind.to_string_lossy();
            Error::Contract(format!(
                "there is no {kind} {index}, the number must be below {}",
                names.len()
            ))
        })?;
        unsafe {
            what.write(kind.as_ptr());
            name.write(form.as_ptr());
        }
        Ok(())
    })
}

/// The name of switch `index` of a potential; fails if there is none.
///
/// # Safety
/// `potential` must end with a NUL; `name` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_switch(
    potential: *const c_char,
    index: c_int,
    name: *mut *const c_char,
) -> c_int {
    let subject = unsafe { text(potential) };
    guarded(subject, || match potentials::find(subject)?.switches().get(index as usize) {
        Some(switch) => {
            unsafe { name.write(switch.as_ptr()) };
            Ok(())
        }
        None => Err(Error::Contract(format!("there is no switch {index}"))),
    })
}

/// Refuse a value that a parameter cannot have.
///
/// # Safety
/// `potential` must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_check(
    potential: *const c_char,
    index: c_int,
    value: f64,
) -> c_int {
    let subject = unsafe { text(potential) };
    guarded(subject, || match potentials::find(subject)?.parameters().get(index as usize) {
        Some(parameter) => parameter.check(value),
        None => Err(Error::Contract(format!("there is no parameter {index}"))),
    })
}

/// The index of a potential in the registry.
///
/// # Safety
/// `potential` must end with a NUL; `index` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_find(
    potential: *const c_char,
    index: *mut c_int,
) -> c_int {
    let subject = unsafe { text(potential) };
    guarded(subject, || {
        let known = potentials::find(subject)?.name();
        let position = REGISTRY.iter().position(|entry| entry.name() == known).unwrap_or(0);
        unsafe { index.write(position as c_int) };
        Ok(())
    })
}

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
) -> c_int {
    guarded(unsafe { text(subject) }, || {
        let triangles = unsafe { slice(triangles.cast::<[c_int; 3]>(), num_triangles as usize) };
        let triangles: Vec<_> = triangles.iter().map(|corners| corners.map(i64::from)).collect();
        let made = Membrane::new(&triangles, num_particles as usize)?;
        unsafe { membrane.write(Box::into_raw(Box::new(made))) };
        Ok(())
    })
}

/// End a membrane's life; null is allowed.
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

/// Number of edges of a membrane.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_numEdges(membrane: *const Membrane) -> i64 {
    unsafe { &*membrane }.topology().edges.len() as i64
}

/// Write the two particles of each edge.
///
/// # Safety
/// `membrane` must be alive; `particles` must have room for two values an edge.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_edges(membrane: *const Membrane, particles: *mut c_int) {
    let topology = unsafe { &*membrane }.topology();
    let out = unsafe { slice::from_raw_parts_mut(particles, 2 * topology.edges.len()) };
    let ends = topology.edges.iter().flat_map(|edge| edge.vertices);
    for (slot, vertex) in out.iter_mut().zip(ends) {
        *slot = topology.particles[vertex as usize] as c_int;
    }
}

/// One term of an evaluation, as C++ hands it over.
#[repr(C)]
pub struct TermInput {
    potential: c_int,
    form: c_int,
    switches: u32,
    wants_derivatives: c_int,
    values: [f64; MAX_PARAMETERS],
    /// Values of single elements, null where there are none.
    fields: [*const f64; MAX_PARAMETERS],
    field_lengths: [i64; MAX_PARAMETERS],
}

impl TermInput {
    /// # Safety
    /// The fields must hold as many values as they say.
    unsafe fn term(&self) -> Term<'_> {
        let field = |k: usize| unsafe { slice(self.fields[k], self.field_lengths[k] as usize) };
        Term {
            potential: REGISTRY[self.potential as usize],
            form: self.form as usize,
            switches: self.switches,
            values: self.values,
            fields: std::array::from_fn(field),
            wants_derivatives: self.wants_derivatives != 0,
        }
    }
}

/// Refuse a term that cannot be evaluated on a membrane.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive; `term` must be readable with its fields.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_checkTerm(
    subject: *const c_char,
    membrane: *const Membrane,
    term: *const TermInput,
) -> c_int {
    let subject = unsafe { text(subject) };
    guarded(subject, || unsafe { &*membrane }.check(&unsafe { (*term).term() }))
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
/// otherwise forces are added to it.
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
    contributions: *mut Contribution,
    forces: *mut f64,
) -> c_int {
    guarded(unsafe { text(subject) }, || {
        let (count, length) = (num_terms as usize, 3 * num_particles as usize);
        let inputs = unsafe { slice(terms, count) };
        let contributions = if contributions.is_null() {
            &mut []
        } else {
            unsafe { slice::from_raw_parts_mut(contributions, count) }
        };
        let positions = unsafe { slice(positions, length) };
        let forces =
            (!forces.is_null()).then(|| unsafe { slice::from_raw_parts_mut(forces, length) });
        // The usual handful of terms costs no allocation.
        let terms: smallvec::SmallVec<[Term; 8]> =
            inputs.iter().map(|input| unsafe { input.term() }).collect();
        unsafe { &mut *membrane }.evaluate(&terms, positions, contributions, forces)
    })
}

unsafe extern "C" {
    fn helfrich_shim_registerSerialization() -> c_int;
    fn helfrich_shim_registerPlatform();
    fn helfrich_shim_adoptKernels();
    fn helfrich_shim_createImpl(force: *const c_void) -> *mut c_void;
}

/// OpenMM's plugin entry point for platforms: registers the platform `Helfrich`.
#[unsafe(no_mangle)]
pub extern "C" fn registerPlatforms() {
    // SAFETY: the shim's function takes nothing and throws nothing.
    unsafe { helfrich_shim_registerPlatform() };
}

/// OpenMM's plugin entry point for kernels. The forces need none; their XML readers are registered here.
#[unsafe(no_mangle)]
pub extern "C" fn registerKernelFactories() {
    // SAFETY: the shim's functions take nothing and throw nothing. If OpenMM is of another version the first says
    // so on the standard error and registers nothing: a plugin in a folder must not stop the others.
    unsafe {
        if helfrich_shim_registerSerialization() == 0 {
            helfrich_shim_adoptKernels();
        }
    }
}

/// Make the implementation of a force. The force classes are compiled into several libraries (this one,
/// the Python extension), their implementation into this one only, so that all forces of a Context meet
/// in one registry.
///
/// # Safety
/// `force` must be a `MembraneForce` that is alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_createImpl(force: *const c_void) -> *mut c_void {
    unsafe { helfrich_shim_createImpl(force) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last_error() -> String {
        let mut buffer = vec![0u8; 500];
        let length = unsafe { Helfrich_lastError(buffer.as_mut_ptr().cast(), 500) };
        buffer.truncate(length as usize);
        String::from_utf8(buffer).unwrap()
    }

    /// A term with a number that is not in the registry: a mistake of the shim, not of a user.
    fn provoke_panic() -> c_int {
        let triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let mut membrane = std::ptr::null_mut();
        let term = TermInput {
            potential: 99,
            form: 0,
            switches: 0,
            wants_derivatives: 0,
            values: [1.0; MAX_PARAMETERS],
            fields: [std::ptr::null(); MAX_PARAMETERS],
            field_lengths: [0; MAX_PARAMETERS],
        };
        let mut contribution = Contribution::default();
        unsafe {
            let made = Helfrich_Membrane_create(
                c"Test".as_ptr(),
                triangles.as_ptr().cast(),
                4,
                4,
                &mut membrane,
            );
            assert_eq!(made, 0);
            let status = Helfrich_Membrane_evaluate(
                c"Test".as_ptr(),
                membrane,
                &term,
                1,
                4,
                [0.0; 12].as_ptr(),
                &mut contribution,
                std::ptr::null_mut(),
            );
            Helfrich_Membrane_destroy(membrane);
            status
        }
    }

    #[test]
    fn a_panic_becomes_a_message() {
        assert_eq!(provoke_panic(), 1);
        assert!(last_error().contains("internal error") && last_error().contains("out of bounds"));
    }

    #[test]
    fn long_messages_are_cut_not_overrun() {
        assert_eq!(provoke_panic(), 1);
        let mut buffer = [7u8; 6];
        let length = unsafe { Helfrich_lastError(buffer.as_mut_ptr().cast(), 5) };
        assert!(length > 5);
        assert_eq!(&buffer, b"Test\0\x07");
    }

    #[test]
    fn errors_start_with_the_subject() {
        let status = unsafe { Helfrich_Potential_check(c"BendingForce".as_ptr(), 0, -1.0) };
        assert_eq!(status, 1);
        assert_eq!(
            last_error(),
            "BendingForce: rigidity must be a finite number, zero or above, got -1"
        );
        let mut membrane = std::ptr::null_mut();
        let status = unsafe {
            Helfrich_Membrane_create(
                c"SurfaceAreaForce".as_ptr(),
                std::ptr::null(),
                0,
                9,
                &mut membrane,
            )
        };
        assert!(
            status == 1 && last_error().starts_with("SurfaceAreaForce: the mesh has no triangles")
        );
    }
}
