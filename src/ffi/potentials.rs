//! The C interface to [`crate::potentials`]: names, units, defaults and domains, which C++ and Python ask for.

use super::membrane::cell;
use super::{ParameterInfo, Status, guarded, slice, text};
use crate::error::Error;
use crate::potentials::{
    self, Element, MadeOf, REGISTRY, Term, VertexNumbers, particle_surface, surface_repulsion,
};
use std::ffi::{c_char, c_int};

/// Describe the parameter `index` of a potential; fails if there is none.
///
/// # Safety
/// `potential` must end with a NUL; `info` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_parameter(
    potential: *const c_char,
    index: c_int,
    info: *mut ParameterInfo,
) -> Status {
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
            Some(Element::Particle) => 3,
            Some(Element::Edge) => 4,
        };
        let name = parameter.name.as_ptr();
        let last = parameter.last.into();
        unsafe { info.write(ParameterInfo { name, energy, length, default_value, per, last }) };
        Ok(())
    })
}

/// The name of form `index` of a potential, and what its forms are called ("scheme"); fails if
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
) -> Status {
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
) -> Status {
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
) -> Status {
    let subject = unsafe { text(potential) };
    guarded(subject, || match potentials::find(subject)?.parameters().get(index as usize) {
        Some(parameter) => parameter.check(value),
        None => Err(Error::Contract(format!("there is no parameter {index}"))),
    })
}

/// How many numbers a potential wants for each vertex, 0 if none, and what they are called, null if nothing.
///
/// # Safety
/// `potential` must end with a NUL; `name` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_numbers(
    potential: *const c_char,
    name: *mut *const c_char,
) -> c_int {
    let found = potentials::find(unsafe { text(potential) }).ok();
    let made_of = found.and_then(|potential| potential.constants(&Term::of(potential)));
    let numbers = made_of.and_then(MadeOf::numbers);
    unsafe { name.write(numbers.map_or(std::ptr::null(), |(name, _)| name.as_ptr())) };
    numbers.map_or(0, |(_, width)| width as c_int)
}

/// Whether these numbers say of what kind a vertex is, so that neighbours can exchange them: 1 or 0.
///
/// # Safety
/// `potential` must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_hasKinds(potential: *const c_char) -> c_int {
    let found = potentials::find(unsafe { text(potential) }).ok();
    let made_of = found.and_then(|potential| potential.constants(&Term::of(potential)));
    made_of.is_some_and(MadeOf::is_of_kinds).into()
}

/// Refuse numbers that vertices cannot have. `box_vectors` has those of the periodic box that positions among them are in,
/// or is null.
///
/// # Safety
/// `potential` must end with a NUL; `numbers` must hold `count` values; `box_vectors` must be readable or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_checkNumbers(
    potential: *const c_char,
    numbers: *const f64,
    count: i64,
    box_vectors: *const f64,
) -> Status {
    let subject = unsafe { text(potential) };
    guarded(subject, || {
        let potential = potentials::find(subject)?;
        let made_of = potential.constants(&Term::of(potential)).ok_or_else(|| {
            Error::Contract("has no reference and no domains; it cannot be given any".to_owned())
        })?;
        unsafe { cell(box_vectors) }?;
        made_of.check(unsafe { slice(numbers, count as usize) })
    })
}

/// What a force object has for each vertex; `before` is what it has had, or null. `box_vectors` has those of the periodic
/// box that positions among the numbers are in, or is null.
///
/// # Safety
/// `before` must come from here and be alive, or be null; `numbers` must hold `count` values; `box_vectors` must be readable
/// or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Numbers_create(
    before: *const VertexNumbers,
    numbers: *const f64,
    count: i64,
    box_vectors: *const f64,
) -> *mut VertexNumbers {
    let owner = unsafe { before.as_ref() }.map(|numbers| numbers.owner);
    let values = unsafe { slice(numbers, count as usize) }.to_vec();
    let vectors = unsafe { box_vectors.cast::<[[f64; 3]; 3]>().as_ref() }.copied();
    Box::into_raw(Box::new(VertexNumbers::new(values, vectors, owner)))
}

/// A version of such numbers that no others have.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Numbers_takeVersion() -> u64 {
    VertexNumbers::take_version()
}

/// Let the vertices have each other's numbers, or values of their own that go with these; fails if they are not as many as
/// before.
///
/// # Safety
/// `numbers` must come from [`Helfrich_Numbers_create`] and be used by no other thread; `values` must hold `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Numbers_rearrange(
    numbers: *mut VertexNumbers,
    values: *const f64,
    count: i64,
    version: u64,
) -> Status {
    guarded("openmm-helfrich", || {
        let (numbers, values) = unsafe { (&mut *numbers, slice(values, count as usize)) };
        if values.len() != numbers.values.len() {
            return Err(Error::Contract(format!(
                "vertices have {} numbers, got {}",
                numbers.values.len(),
                values.len()
            )));
        }
        numbers.values.copy_from_slice(values);
        numbers.version = version;
        Ok(())
    })
}

/// Destroy them; null is allowed.
///
/// # Safety
/// `numbers` must come from [`Helfrich_Numbers_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Numbers_destroy(numbers: *mut VertexNumbers) {
    if !numbers.is_null() {
        drop(unsafe { Box::from_raw(numbers) });
    }
}

/// Whether a potential, by the index that [`Helfrich_Potential_find`] gave, is one of contacts, so that it may act on several
/// membranes together.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Potential_isContact(potential: c_int) -> c_int {
    let contacts = [surface_repulsion::NAME, particle_surface::NAME];
    REGISTRY.get(potential as usize).is_some_and(|named| contacts.contains(&named.name())).into()
}

/// The index of a potential in the registry.
///
/// # Safety
/// `potential` must end with a NUL; `index` must be writable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Potential_find(
    potential: *const c_char,
    index: *mut c_int,
) -> Status {
    let subject = unsafe { text(potential) };
    guarded(subject, || {
        let known = potentials::find(subject)?.name();
        let position = REGISTRY.iter().position(|entry| entry.name() == known).unwrap_or(0);
        unsafe { index.write(position as c_int) };
        Ok(())
    })
}
