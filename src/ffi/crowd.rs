//! The C interface to [`crate::membrane::Crowd`].

use super::membrane::{cell, read_terms};
use super::{TurnInput, guarded, slice, text};
use crate::membrane::{Crowd, Membrane, Turn};
use crate::team::Team;
use std::ffi::c_int;
use std::slice as slices;

/// Make what several membranes need to be evaluated side by side.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Crowd_create() -> *mut Crowd {
    Box::into_raw(Box::default())
}

/// End its life; null is allowed.
///
/// # Safety
/// `crowd` must come from [`Helfrich_Crowd_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Crowd_destroy(crowd: *mut Crowd) {
    if !crowd.is_null() {
        drop(unsafe { Box::from_raw(crowd) });
    }
}

/// Evaluate several membranes, of which no two have a particle in common, by the threads of a team or by this one alone.
/// The first that fails says why. `forces` may be null; otherwise forces are added to it.
///
/// # Safety
/// `crowd` must be alive; `team` must be null or alive, and used by no other thread; `turns` must hold `num_turns`
/// values, as of [`Helfrich_Membrane_evaluate`](super::Helfrich_Membrane_evaluate).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Crowd_evaluate(
    crowd: *mut Crowd,
    team: *mut Team,
    turns: *const TurnInput,
    num_turns: i64,
    num_particles: i64,
    positions: *const f64,
    forces: *mut f64,
) -> c_int {
    let inputs = unsafe { slice(turns, num_turns as usize) };
    let mut culprit = inputs.first().map_or("", |input| unsafe { text(input.subject) });
    let mut failure = Ok(());
    let evaluate = || {
        let length = 3 * num_particles as usize;
        let terms: Vec<_> =
            inputs.iter().map(|input| unsafe { read_terms(input.terms, input.num_terms) }).collect();
        let mut turns = Vec::with_capacity(inputs.len());
        for (input, terms) in inputs.iter().zip(&terms) {
            let contributions = match input.contributions.is_null() {
                true => &mut [],
                false => unsafe {
                    slices::from_raw_parts_mut(input.contributions, terms.len())
                },
            };
            turns.push(Turn {
                membrane: unsafe { &mut *input.membrane.cast::<Membrane>() },
                terms,
                cell: unsafe { cell(input.box_vectors) }?,
                contributions,
                // These overlap, but no two membranes touch the same numbers of them.
                forces: (!forces.is_null())
                    .then(|| unsafe { slices::from_raw_parts_mut(forces, length) }),
                outcome: Ok(()),
            });
        }
        let positions = unsafe { slice(positions, length) };
        unsafe { &mut *crowd }.evaluate(unsafe { team.as_mut() }, positions, &mut turns);
        for (input, turn) in inputs.iter().zip(turns) {
            if turn.outcome.is_err() {
                (culprit, failure) = (unsafe { text(input.subject) }, turn.outcome);
                break;
            }
        }
        Ok(())
    };
    let status = guarded("MembraneForce", evaluate);
    if status == 0 { guarded(culprit, || failure) } else { status }
}
