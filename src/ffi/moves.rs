//! The C interface to moves of a membrane, and to its connectivity.

use super::membrane::{like_positions, read_terms, with_terms};
use super::{FollowerInput, Status, TermInput, guarded, slice, text};
use crate::membrane::{Connectivity, Follower, Membrane};
use crate::moves::{FlipRules, FlipState, Round, SwapRound, SwapRules, SwapState};
use smallvec::SmallVec;
use std::ffi::{c_char, c_int};
use std::slice as slices;

/// Refuse rules that make no sense, or that the present mesh violates.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive; `rules` must be readable.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_checkFlips(
    subject: *const c_char,
    membrane: *const Membrane,
    rules: *const FlipRules,
) -> Status {
    guarded(unsafe { text(subject) }, || unsafe { &*rules }.check(unsafe { &*membrane }.mesh()))
}

/// Try to flip so many edges at the present positions, with the energy of some terms. `made` gets how many
/// flips were made; `force_change`, if it is not null, the change of the forces, or nothing if there were
/// no flips. `box_vectors` has those of the periodic box, or is null if there is none.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive and used by no other thread; `terms` must hold
/// `num_terms` values, `positions` and `force_change` three values for each particle; `rules` must be readable, `state`
/// and `made` writable. `followers` must hold `num_followers` values, of other membranes that are alive and used by no other
/// thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_flip(
    subject: *const c_char,
    membrane: *mut Membrane,
    terms: *const TermInput,
    num_terms: i64,
    num_particles: i64,
    positions: *const f64,
    box_vectors: *const f64,
    rules: *const FlipRules,
    attempts: i64,
    state: *mut FlipState,
    made: *mut i64,
    force_change: *mut f64,
    followers: *const FollowerInput,
    num_followers: i64,
) -> Status {
    let (given, at) = ((terms, num_terms), (positions, num_particles));
    guarded(unsafe { text(subject) }, || {
        let (membrane, rules, state) = unsafe { (&mut *membrane, &*rules, &mut *state) };
        let round = Round { rules, attempts: attempts as u64, state };
        let followers = unsafe { slice(followers, num_followers as usize) };
        let their_terms: SmallVec<[_; 1]> = followers
            .iter()
            .map(|follower| unsafe { read_terms(follower.terms, follower.num_terms) })
            .collect();
        let pairs = followers.iter().zip(&their_terms);
        let mut followers: SmallVec<[Follower; 1]> = pairs
            .map(|(follower, terms)| Follower {
                membrane: unsafe { &mut *follower.membrane },
                first_triangle: follower.first_triangle as usize,
                terms,
            })
            .collect();
        let count = unsafe {
            with_terms(given, at, box_vectors, |terms, at| {
                membrane.flip(terms, at, round, like_positions(force_change, &at), &mut followers)
            })
        }?;
        unsafe { made.write(count as i64) };
        Ok(())
    })
}

/// Let the ends of so many edges exchange what they are at the present positions, with the energy of some terms. `kinds`
/// has the same number for vertices that are alike; `sources` gets the vertex whose values each one has then, and `made`
/// how many exchanges there were. `version` is what terms will have for theirs that have been changed; the rest is as of
/// [`Helfrich_Membrane_flip`].
///
/// # Safety
/// As of [`Helfrich_Membrane_flip`]; `kinds` and `sources` must have a value for each vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_swap(
    subject: *const c_char,
    membrane: *mut Membrane,
    terms: *const TermInput,
    num_terms: i64,
    num_particles: i64,
    positions: *const f64,
    box_vectors: *const f64,
    rules: *const SwapRules,
    attempts: i64,
    state: *mut SwapState,
    kinds: *const u32,
    sources: *mut u32,
    version: u64,
    made: *mut i64,
    force_change: *mut f64,
) -> Status {
    let (given, at) = ((terms, num_terms), (positions, num_particles));
    guarded(unsafe { text(subject) }, || {
        let (membrane, rules, state) = unsafe { (&mut *membrane, &*rules, &mut *state) };
        let count = membrane.mesh().num_vertices();
        let kinds = unsafe { slice(kinds, count) };
        let sources = unsafe { slices::from_raw_parts_mut(sources, count) };
        sources.iter_mut().zip(0..).for_each(|(source, vertex)| *source = vertex);
        let round = SwapRound { rules, attempts: attempts as u64, state, kinds, sources };
        let count = unsafe {
            with_terms(given, at, box_vectors, |terms, at| {
                membrane.swap(terms, at, round, version, like_positions(force_change, &at))
            })
        }?;
        unsafe { made.write(count as i64) };
        Ok(())
    })
}

/// Number of triangles, which never changes.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_numTriangles(membrane: *const Membrane) -> i64 {
    unsafe { &*membrane }.mesh().triangles().len() as i64
}

/// Number of vertices, which never changes.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_numVertices(membrane: *const Membrane) -> i64 {
    unsafe { &*membrane }.mesh().num_vertices() as i64
}

/// Write the particles at the corners of each triangle, as they are now.
///
/// # Safety
/// `membrane` must be alive; `corners` must have room for three values a triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_triangles(
    membrane: *const Membrane,
    corners: *mut c_int,
) {
    let mesh = unsafe { &*membrane }.mesh();
    let count = mesh.triangles().len();
    let out = unsafe { slices::from_raw_parts_mut(corners.cast::<[c_int; 3]>(), count) };
    for (triangle, slot) in out.iter_mut().enumerate() {
        *slot = mesh.particles_of(triangle).map(|particle| particle as c_int);
    }
}

/// Go on with other triangles of the same particles, as many as there are.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive and used by no other thread; `corners` must hold three
/// values a triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_setTriangles(
    subject: *const c_char,
    membrane: *mut Membrane,
    corners: *const c_int,
    num_triangles: i64,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let corners = unsafe { slice(corners.cast::<[c_int; 3]>(), num_triangles as usize) };
        let triangles: Vec<_> = corners.iter().map(|corners| corners.map(i64::from)).collect();
        unsafe { &mut *membrane }.set_triangles(&triangles)
    })
}

/// Write the order of the vertices that sums are formed in; returns how many flips there have been since it was made.
///
/// # Safety
/// `membrane` must be alive; `order` must have room for a value a vertex.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_order(
    membrane: *const Membrane,
    order: *mut u32,
) -> i64 {
    let Connectivity { order: from, flips, .. } = unsafe { &*membrane }.connectivity();
    unsafe { slices::from_raw_parts_mut(order, from.len()) }.copy_from_slice(&from);
    flips as i64
}

/// Go on with saved triangles, order of vertices and count of flips: the same bits follow.
///
/// # Safety
/// `subject` must end with a NUL; `membrane` must be alive and used by no other thread; `corners` must hold three
/// values for each of its triangles, `order` a value for each of its vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_restore(
    subject: *const c_char,
    membrane: *mut Membrane,
    corners: *const c_int,
    order: *const u32,
    flips: i64,
) -> Status {
    guarded(unsafe { text(subject) }, || {
        let membrane = unsafe { &mut *membrane };
        let (count, vertices) = (membrane.mesh().triangles().len(), membrane.mesh().num_vertices());
        let corners = unsafe { slice(corners.cast::<[u32; 3]>(), count) };
        let order = unsafe { slice(order, vertices) };
        let triangles = corners.to_vec();
        membrane.restore(&Connectivity { triangles, order: order.to_vec(), flips: flips as u64 })
    })
}

/// A whole number below 2⁵³ that tells the present triangles from any others: 0 for those that the membrane began with.
///
/// # Safety
/// `membrane` must be alive.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Membrane_fingerprint(membrane: *const Membrane) -> f64 {
    unsafe { &*membrane }.fingerprint()
}
