//! Whether several threads are faster than one, found by trying.
//!
//! What threads cost and gain depends on the processor and on what else it has to do, which may change; so both
//! ways are timed in turns when a simulation begins and now and then later, and the faster one is
//! taken meanwhile. Results do not depend on it.

use std::time::{Duration, Instant};

/// Evaluations of a trial, half of them either way.
const TRIAL: u32 = 16;

/// Evaluations from one trial to the next.
const PERIOD: u32 = 5000;

/// Whether the members of a team share an evaluation of one mesh.
pub struct Sharing {
    evaluation: u32,
    /// The shortest times of the present trial, alone and together.
    shortest: [Duration; 2],
    together: bool,
}

/// One evaluation that is being timed, if it belongs to a trial.
pub struct Attempt {
    /// Whether to share the work.
    pub together: bool,
    start: Option<Instant>,
}

impl Sharing {
    /// Nothing known yet.
    pub fn new() -> Self {
        Self { evaluation: 0, shortest: [Duration::MAX; 2], together: false }
    }

    /// How to do the next evaluation.
    pub fn next(&self) -> Attempt {
        let trial = self.evaluation < TRIAL;
        // In the order ABBA, so that neither way gets all evaluations of one kind where two kinds alternate.
        let together = if trial { matches!(self.evaluation % 4, 1 | 2) } else { self.together };
        Attempt { together, start: trial.then(Instant::now) }
    }

    /// It is done.
    pub fn done(&mut self, attempt: &Attempt) {
        if let Some(start) = attempt.start {
            let shortest = &mut self.shortest[usize::from(attempt.together)];
            *shortest = (*shortest).min(start.elapsed());
        }
        self.evaluation += 1;
        if self.evaluation == TRIAL {
            self.together = self.shortest[1] < self.shortest[0];
            self.shortest = [Duration::MAX; 2];
        }
        if self.evaluation == PERIOD {
            self.evaluation = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(sharing: &mut Sharing, alone: Duration, together: Duration) {
        for _ in 0..TRIAL {
            let mut attempt = sharing.next();
            let taken = if attempt.together { together } else { alone };
            attempt.start = Instant::now().checked_sub(taken);
            sharing.done(&attempt);
        }
    }

    #[test]
    fn the_faster_way_is_taken_until_the_next_trial() {
        let (short, long) = (Duration::from_millis(1), Duration::from_millis(900));
        let mut sharing = Sharing::new();
        trial(&mut sharing, long, short);
        for _ in TRIAL..PERIOD {
            let attempt = sharing.next();
            assert!(attempt.together && attempt.start.is_none());
            sharing.done(&attempt);
        }
        trial(&mut sharing, short, long);
        assert!(!sharing.next().together);
    }
}
