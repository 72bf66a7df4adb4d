//! Several membranes that are evaluated side by side, each by one thread.

use super::{Configuration, Membrane};
use crate::error::Result;
use crate::evaluator::simd::Choice;
use crate::mesh::Cell;
use crate::potentials::{Contribution, Term};
use crate::team::{Parts, Team};

/// What a crowd evaluates of one membrane.
pub struct Turn<'a> {
    /// The membrane, which is to have one thread.
    pub membrane: &'a mut Membrane,
    /// As of [`Membrane::evaluate`], and so is the rest.
    pub terms: &'a [Term<'a>],
    /// The periodic box, if it lives in one.
    pub cell: Option<Cell>,
    /// One a term, or none.
    pub contributions: &'a mut [Contribution],
    /// Those of all particles; each membrane adds to its own.
    pub forces: Option<&'a mut [f64]>,
    /// What has come of it.
    pub outcome: Result<()>,
}

impl Turn<'_> {
    fn take(&mut self, positions: &[f64]) {
        let at = Configuration::new(positions, self.cell.as_ref());
        let forces = self.forces.as_deref_mut();
        self.outcome = self.membrane.evaluate(self.terms, at, self.contributions, forces);
    }
}

/// Membranes of a Context, and whether several threads are faster for them.
pub struct Crowd {
    choice: Choice,
}

impl Default for Crowd {
    fn default() -> Self {
        Self { choice: Choice::new() }
    }
}

impl Crowd {
    /// Evaluate all membranes at the positions of all particles. Results do not depend on the team. No particle may
    /// belong to two of them.
    pub fn evaluate(&mut self, team: Option<&mut Team>, positions: &[f64], turns: &mut [Turn]) {
        let attempt = self.choice.next();
        match team.filter(|team| attempt.together && team.size() > 1) {
            None => turns.iter_mut().for_each(|turn| turn.take(positions)),
            Some(team) => {
                // Each thread has the same ones in every step, which are in its cache then.
                let size = |turn: &Turn| turn.membrane.mesh().num_vertices();
                let (all, mut before) = (turns.iter().map(size).sum::<usize>(), 0);
                let mut ends = vec![turns.len(); team.size()];
                for (k, turn) in turns.iter().enumerate() {
                    let middle = before + size(turn) / 2;
                    before += size(turn);
                    ends[..middle * team.size() / all].iter_mut().for_each(|end| *end = k.min(*end));
                }
                let turns = Parts::new(turns);
                team.run(|member| {
                    let start = member.index().checked_sub(1).map_or(0, |other| ends[other]);
                    // SAFETY: each member has its own.
                    let own = unsafe { turns.part(start..ends[member.index()]) };
                    own.iter_mut().for_each(|turn| turn.take(positions));
                });
            }
        }
        self.choice.done(&attempt);
    }
}
