//! Several membranes that are evaluated side by side, each by one thread.

use crate::team::Sharing;
use crate::team::{Parts, Team};

/// Whether several threads are faster for some membranes, each of which is evaluated by one of them.
pub struct Crowd {
    sharing: Sharing,
}

impl Default for Crowd {
    fn default() -> Self {
        Self { sharing: Sharing::new() }
    }
}

impl Crowd {
    /// Let the members of a team, or this thread alone, evaluate all membranes, each of which takes about as long as its
    /// `size` says. Which thread evaluates which is the same in every step, so that it finds it in its cache.
    pub fn evaluate<M: Send>(
        &mut self,
        team: Option<&mut Team>,
        membranes: &mut [M],
        size: impl Fn(&M) -> usize,
        evaluate: impl Fn(&mut M) + Sync,
    ) {
        let attempt = self.sharing.next();
        match team.filter(|team| attempt.together && team.size() > 1) {
            None => membranes.iter_mut().for_each(evaluate),
            Some(team) => {
                let ends = shares(membranes.iter().map(&size), team.size());
                let membranes = Parts::new(membranes);
                team.run(|member| {
                    let start = member.index().checked_sub(1).map_or(0, |other| ends[other]);
                    // SAFETY: each member has its own.
                    let own = unsafe { membranes.part(start..ends[member.index()]) };
                    own.iter_mut().for_each(&evaluate);
                });
            }
        }
        self.sharing.done(&attempt);
    }
}

/// Where the shares of so many members end, which are about equal.
fn shares(sizes: impl Iterator<Item = usize> + Clone, members: usize) -> Vec<usize> {
    let all: usize = sizes.clone().sum();
    let mut ends = vec![0; members];
    let mut before = 0;
    for (k, size) in sizes.enumerate() {
        let member = (before + size / 2) * members / all.max(1);
        ends[member.min(members - 1)..].fill(k + 1);
        before += size;
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_about_equal() {
        let of = |sizes: &[usize], members| shares(sizes.iter().copied(), members);
        assert_eq!(of(&[5, 5, 5, 5], 2), [2, 4]);
        assert_eq!(of(&[5, 5, 5], 2), [2, 3]);
        assert_eq!(of(&[15, 5, 5, 5], 2), [1, 4]);
        assert_eq!(of(&[1, 1, 100], 3), [2, 3, 3]);
        assert_eq!(of(&[7], 4), [0, 1, 1, 1]);
        assert_eq!(of(&[], 2), [0, 0]);
    }

    #[test]
    fn everything_is_evaluated_once() {
        let mut team = Team::new(3).unwrap();
        let mut crowd = Crowd::default();
        let mut counts = vec![0; 10];
        for _ in 0..40 {
            crowd.evaluate(Some(&mut team), &mut counts, |_| 1, |count| *count += 1);
        }
        crowd.evaluate(None, &mut counts, |_| 1, |count| *count += 1);
        assert_eq!(counts, [41; 10]);
    }
}
