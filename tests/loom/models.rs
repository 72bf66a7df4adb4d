use crate::stand_ins::{Manner, UnsafeCell, set_manner};
use crate::team::{Member, Team};
use loom::model::Builder;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// A number that nothing protects but the team; loom watches who reads and writes it.
struct Plain(UnsafeCell<u32>);

// SAFETY: loom says if threads get in each other's way.
unsafe impl Sync for Plain {}

impl Plain {
    fn new() -> Self {
        Self(UnsafeCell::new(0))
    }

    fn read(&self) -> u32 {
        // SAFETY: loom watches.
        self.0.with(|number| unsafe { *number })
    }

    fn add(&self, more: u32) {
        // SAFETY: loom watches.
        self.0.with_mut(|number| unsafe { *number += more });
    }
}

fn plain(size: usize) -> Vec<Plain> {
    (0..size).map(|_| Plain::new()).collect()
}

/// Try a team in all orders with at most so many preemptions, `usual` unless LOOM_MAX_PREEMPTIONS says otherwise.
fn try_all(manner: Manner, size: usize, usual: Option<usize>, model: fn(&mut Team)) {
    let mut builder = Builder::new();
    builder.preemption_bound = builder.preemption_bound.or(usual);
    builder.max_branches = 10_000;
    builder.check(move || {
        set_manner(manner);
        model(&mut Team::of(size, manner != Manner::Sleep).unwrap());
    });
}

/// Models of two members in three manners, and of three that sleep:
/// if two of them look, loom has them take turns for ever.
macro_rules! try_models {
    ($($name:ident)*) => { $(mod $name {
        use super::*;

        #[test]
        fn two_look() {
            try_all(Manner::Look, 2, Some(4), super::$name);
        }

        #[test]
        fn two_look_once() {
            try_all(Manner::LookOnce, 2, Some(3), super::$name);
        }

        #[test]
        fn two_sleep() {
            try_all(Manner::Sleep, 2, Some(3), super::$name);
        }

        #[test]
        fn three_sleep() {
            try_all(Manner::Sleep, 3, Some(2), super::$name);
        }
    })* };
}

try_models! { nobody_is_needed two_runs barriers a_member_panics the_caller_panics }

/// A team that is dropped before it has anything to do.
fn nobody_is_needed(_: &mut Team) {}

/// Members find what the caller wrote before a run, and the caller what they have written.
fn two_runs(team: &mut Team) {
    let (asked, done) = (Plain::new(), plain(team.size()));
    for run in 1..=2 {
        asked.add(1);
        team.run(|member| done[member.index()].add(asked.read()));
        assert!(done.iter().all(|number| number.read() == [0, 1, 3][run]));
    }
}

/// What the left neighbour wrote before a barrier is there after it, and not overwritten before the next.
fn barriers(team: &mut Team) {
    let numbers = plain(team.size());
    team.run(|member| {
        let (me, size) = (member.index(), member.size());
        numbers[me].add(me as u32 + 1);
        member.barrier();
        let left = (me + size - 1) % size;
        assert_eq!(numbers[left].read(), left as u32 + 1);
        member.barrier();
        numbers[me].add(10);
    });
    assert!((0..team.size()).all(|i| numbers[i].read() == i as u32 + 11));
}

fn a_member_panics(team: &mut Team) {
    panics(team, 1);
}

fn the_caller_panics(team: &mut Team) {
    panics(team, 0);
}

/// One panics while the others wait at a barrier: the panic reaches the caller, and the next run is a run.
fn panics(team: &mut Team, culprit: usize) {
    let numbers = plain(team.size());
    let job = |member: Member<'_>| {
        numbers[member.index()].add(1);
        if member.index() == culprit {
            resume_unwind(Box::new(culprit));
        }
        member.barrier();
    };
    let panic = catch_unwind(AssertUnwindSafe(|| team.run(job))).unwrap_err();
    assert_eq!(panic.downcast_ref(), Some(&culprit));
    team.run(|member| {
        numbers[member.index()].add(1);
        member.barrier();
        assert!(numbers.iter().all(|number| number.read() == 2));
    });
}
