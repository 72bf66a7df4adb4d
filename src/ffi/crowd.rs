//! The C interface to [`crate::membrane::Crowd`].

use super::membrane::{like_positions, of_terms, with_terms};
use super::{Status, TurnInput, guarded, slice, text};
use crate::error::Result;
use crate::membrane::Crowd;
use crate::potentials::Request;
use crate::team::Team;

/// Make what several membranes need to be evaluated side by side.
#[unsafe(no_mangle)]
pub extern "C" fn Helfrich_Crowd_create() -> *mut Crowd {
    Box::into_raw(Box::default())
}

/// Destroy it; null is allowed.
///
/// # Safety
/// `crowd` must come from [`Helfrich_Crowd_create`] and not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn Helfrich_Crowd_destroy(crowd: *mut Crowd) {
    if !crowd.is_null() {
        drop(unsafe { Box::from_raw(crowd) });
    }
}

/// What is evaluated of one membrane, and what has come of it.
struct Turn<'a> {
    input: &'a TurnInput,
    outcome: Result<()>,
}

// SAFETY: the membranes are used by nobody else, and the rest is only read.
unsafe impl Send for Turn<'_> {}

/// The positions and forces of all particles.
struct Arrays<'a> {
    positions: &'a [f64],
    forces: *mut f64,
}

// SAFETY: no two membranes touch the same forces.
unsafe impl Sync for Arrays<'_> {}

impl Arrays<'_> {
    /// # Safety
    /// As of [`Helfrich_Crowd_evaluate`].
    unsafe fn evaluate(&self, input: &TurnInput) -> Result<()> {
        let given = (input.terms, input.num_terms);
        let at = (self.positions.as_ptr(), (self.positions.len() / 3) as i64);
        unsafe {
            with_terms(given, at, input.box_vectors, |terms, at| {
                let (sums, forces) =
                    (of_terms(input.contributions, terms), like_positions(self.forces, &at));
                let request =
                    Request::new(terms, at.positions).with_energies(sums).with_forces(forces);
                (*input.membrane).evaluate(request, at.cell)
            })
        }
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
) -> Status {
    let inputs = unsafe { slice(turns, num_turns as usize) };
    let positions = unsafe { slice(positions, 3 * num_particles as usize) };
    let (crowd, team) = unsafe { (&mut *crowd, team.as_mut()) };
    let arrays = Arrays { positions, forces };
    let size = |turn: &Turn| unsafe { &*turn.input.membrane }.mesh().num_vertices();
    let mut turns: Vec<_> = inputs.iter().map(|input| Turn { input, outcome: Ok(()) }).collect();
    let status = guarded("MembraneForce", || {
        let evaluate = |turn: &mut Turn| turn.outcome = unsafe { arrays.evaluate(turn.input) };
        crowd.evaluate(team, &mut turns, size, evaluate);
        Ok(())
    });
    match turns.into_iter().find(|turn| turn.outcome.is_err()) {
        Some(Turn { input, outcome }) => guarded(unsafe { text(input.subject) }, || outcome),
        None => status,
    }
}
