//! Whether several threads are faster than one, found by trying.
//!
//! What threads cost and gain depends on the processor and on what else it has to do, which may change; so both
//! ways are timed in turns when a simulation begins and now and then later, and the faster one is
//! taken meanwhile. Results do not depend on it.

use std::time::{Duration, Instant};

/// Evaluations of a trial, half of them either way.
const TRIAL: u32 = 16;

/// Evaluations from one trial to the next: after one that has changed what is taken, and at most. Each that changes nothing
/// doubles them, so that a trial in which the processor had other work does little harm.
const PERIODS: [u32; 2] = [128, 5000];

/// Whether the members of a team share an evaluation of one mesh.
pub struct Sharing {
    evaluation: u32,
    /// The shortest times of the present trial, alone and together.
    shortest: [Duration; 2],
    together: bool,
    /// Evaluations from the beginning of the last trial to that of the next.
    period: u32,
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
        // Whatever the first trial finds, the second comes as after a change.
        let period = PERIODS[0] / 2;
        Self { evaluation: 0, shortest: [Duration::MAX; 2], together: false, period }
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
            let together = self.shortest[1] < self.shortest[0];
            let [first, most] = PERIODS;
            let has_changed = together != self.together;
            self.period = if has_changed { first } else { most.min(2 * self.period) };
            self.together = together;
            self.shortest = [Duration::MAX; 2];
        }
        if self.evaluation == self.period {
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

    /// Evaluations until the next trial, all of which are done in one way.
    fn until_the_next(sharing: &mut Sharing, together: bool) -> u32 {
        let mut count = 0;
        loop {
            let attempt = sharing.next();
            if attempt.start.is_some() {
                return count;
            }
            assert_eq!(attempt.together, together);
            sharing.done(&attempt);
            count += 1;
        }
    }

    #[test]
    fn the_faster_way_is_taken_until_the_next_trial() {
        let (short, long) = (Duration::from_millis(1), Duration::from_millis(900));
        let mut sharing = Sharing::new();
        for expected in [128, 256, 512, 1024, 2048, 4096, 5000, 5000] {
            trial(&mut sharing, long, short);
            assert_eq!(until_the_next(&mut sharing, true), expected - TRIAL);
        }
        for expected in [128, 256] {
            trial(&mut sharing, short, long);
            assert_eq!(until_the_next(&mut sharing, false), expected - TRIAL);
        }
        trial(&mut sharing, long, short);
        assert_eq!(until_the_next(&mut sharing, true), 128 - TRIAL);
    }
}
