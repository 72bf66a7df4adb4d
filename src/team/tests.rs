//! What a team promises, for teams of one to more than there are cores.

use super::waiting::IDLE_SPIN;
use super::*;
use std::thread;

const SIZES: [usize; 4] = [1, 2, 3, 8];

/// So many rounds, and few where Miri interprets them.
const fn rounds(usual: u32) -> u32 {
    if cfg!(miri) { 1 + usual / 100 } else { usual }
}

#[test]
fn every_member_runs_once_a_run() {
    for size in SIZES {
        let mut team = Team::new(size).unwrap();
        let counts: Vec<_> = (0..size).map(|_| AtomicU64::new(0)).collect();
        for round in 1..=rounds(500) {
            team.run(|member| {
                assert_eq!(member.size(), size);
                counts[member.index()].fetch_add(1, Relaxed);
            });
            assert!(counts.iter().all(|count| count.load(Relaxed) == u64::from(round)));
        }
    }
}

/// A running sum over the shares of all members, which is wrong if any of them is early or late once.
#[test]
fn members_see_what_others_wrote_before_a_barrier() {
    for size in SIZES {
        let mut team = Team::new(size).unwrap();
        // Plain writes through pointers, so that a missing order shows in the numbers.
        let slots: Vec<_> = (0..size).map(|_| Apart(AtomicU64::new(1))).collect();
        let mut expected = vec![1u64; size];
        for _ in 0..rounds(50) {
            team.run(|member| {
                for _ in 0..10 {
                    let me = member.index();
                    let left = slots[(me + size - 1) % size].0.load(Relaxed);
                    member.barrier();
                    let mine = slots[me].0.load(Relaxed);
                    slots[me].0.store(mine.wrapping_mul(3).wrapping_add(left), Relaxed);
                    member.barrier();
                }
            });
            for _ in 0..10 {
                let before = expected.clone();
                for me in 0..size {
                    let left = before[(me + size - 1) % size];
                    expected[me] = before[me].wrapping_mul(3).wrapping_add(left);
                }
            }
            let found: Vec<_> = slots.iter().map(|slot| slot.0.load(Relaxed)).collect();
            assert_eq!(found, expected);
        }
    }
}

#[test]
fn shares_cover_everything_once() {
    for size in SIZES {
        let mut team = Team::new(size).unwrap();
        for count in [0, 1, 7, 1000] {
            let hits: Vec<_> = (0..count).map(|_| AtomicU32::new(0)).collect();
            team.run(|member| {
                for i in member.share(count) {
                    hits[i].fetch_add(1, Relaxed);
                }
            });
            assert!(hits.iter().all(|hit| hit.load(Relaxed) == 1));
        }
    }
}

#[test]
fn members_fill_their_parts_of_a_slice() {
    for size in SIZES {
        let mut team = Team::new(size).unwrap();
        let mut numbers = vec![0; 1001];
        let parts = Parts::new(&mut numbers);
        team.run(|member| {
            let share = member.share(1001);
            // SAFETY: the shares of members do not overlap.
            let part = unsafe { parts.part(share.clone()) };
            for (number, i) in part.iter_mut().zip(share) {
                *number = i;
            }
        });
        assert!(numbers.iter().enumerate().all(|(i, &number)| number == i));
    }
}

#[test]
#[should_panic(expected = "no part 2..4")]
fn there_is_no_part_beyond_the_end() {
    let mut numbers = [1, 2, 3];
    // SAFETY: there is no other part.
    unsafe { Parts::new(&mut numbers).part(2..4) };
}

#[test]
fn sleepers_wake_up() {
    let mut team = Team::new(3).unwrap();
    let count = AtomicU32::new(0);
    for round in 1..=rounds(20) {
        thread::sleep(4 * IDLE_SPIN);
        team.run(|_| {
            count.fetch_add(1, Relaxed);
        });
        assert_eq!(count.load(Relaxed), 3 * round);
    }
    thread::sleep(4 * IDLE_SPIN);
    drop(team);
}

#[test]
fn a_panic_reaches_the_caller_and_leaves_the_team_usable() {
    for size in SIZES {
        let mut team = Team::new(size).unwrap();
        for culprit in 0..size {
            let result = catch_unwind(AssertUnwindSafe(|| {
                team.run(|member| {
                    if member.index() == culprit {
                        // Not `panic!`, which would write a report to the test's output.
                        resume_unwind(Box::new(format!("member {culprit}")));
                    }
                    member.barrier();
                });
            }));
            let panic = result.unwrap_err();
            assert_eq!(*panic.downcast::<String>().unwrap(), format!("member {culprit}"));
            let sum = AtomicU32::new(0);
            team.run(|member| {
                sum.fetch_add(member.index() as u32, Relaxed);
                member.barrier();
                assert_eq!(sum.load(Relaxed) as usize, size * (size - 1) / 2);
            });
        }
    }
}

#[test]
fn several_teams_live_side_by_side() {
    let total = AtomicU64::new(0);
    thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| {
                let mut team = Team::new(2).unwrap();
                for _ in 0..rounds(500) {
                    team.run(|member| {
                        member.barrier();
                        total.fetch_add(1, Relaxed);
                    });
                }
            });
        }
    });
    assert_eq!(total.into_inner(), 3 * 2 * u64::from(rounds(500)));
}
