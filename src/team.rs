//! A few threads that work on one thing together, at a cost of tenths of a microsecond.
//!
//! A time step of a small membrane takes some ten microseconds and needs its threads to meet several times. A
//! general pool costs as much as there is to gain: `rayon::broadcast` takes several microseconds a call.
//! The members of a [`Team`] stay at their post instead. Within a run they meet at barriers that spin; between
//! runs they spin for [`IDLE_SPIN`], then sleep, so that an idle simulation leaves its cores to others.
//! Whoever waits for longer than the work of a step takes gives its core away, so that a team with
//! more members than there are cores is slow but never stands still.
//!
//! ```
//! use openmm_helfrich::team::Team;
//! use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
//!
//! let mut team = Team::new(2)?;
//! let (squares, total) = ([const { AtomicU64::new(0) }; 100], AtomicU64::new(0));
//! team.run(|member| {
//!     for i in member.share(100) {
//!         squares[i].store((i * i) as u64, Relaxed);
//!     }
//!     member.barrier();
//!     if member.index() == 0 {
//!         total.store(squares.iter().map(|square| square.load(Relaxed)).sum(), Relaxed);
//!     }
//! });
//! assert_eq!(total.into_inner(), 328_350);
//! # Ok::<(), std::io::Error>(())
//! ```

use std::any::Any;
use std::cell::UnsafeCell;
use std::hint::spin_loop;
use std::io;
use std::marker::PhantomData;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::slice;
use std::sync::atomic::Ordering::{AcqRel, Acquire, Relaxed, Release, SeqCst};
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// How long members look out for the next run before they sleep.
const IDLE_SPIN: Duration = Duration::from_micros(50);

/// How often a waiting member looks before it lets other threads have its core: some 10 µs.
const PATIENCE: u32 = 500;

/// The number of the run that ends all runs.
const STOP: u64 = u64::MAX;

/// What all members execute; the lifetime is that of the present [`Team::run`].
type Job = *const (dyn Fn(Member<'_>) + Sync + 'static);

/// Keeps what one thread writes out of the cache lines that others watch (prefetchers fetch lines in pairs).
#[repr(align(128))]
struct Apart<T>(T);

/// Threads that run a closure each and meet at barriers; the caller of [`Team::run`] is member 0.
pub struct Team {
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
}

struct Shared {
    size: usize,
    /// Whether every member can have a core of its own; spinning for each other makes sense only then.
    spins: bool,
    /// The number of the present or last run; the job belongs to it.
    run: Apart<AtomicU64>,
    /// How many members have finished the present run, the caller not among them.
    finished: Apart<AtomicU32>,
    /// How many members have come to the present barrier.
    arrived: Apart<AtomicU32>,
    gate: Apart<Gate>,
    job: UnsafeCell<Option<Job>>,
    /// What the first member to panic said.
    panic: Mutex<Option<Box<dyn Any + Send>>>,
    /// Which members sleep, or are about to.
    sleeping: Box<[Apart<AtomicBool>]>,
}

/// What members at a barrier watch.
struct Gate {
    /// How many barriers have opened.
    passed: AtomicU32,
    /// Whether a member has panicked and will never come.
    broken: AtomicBool,
}

// SAFETY: `job` is the only field that is not Sync by itself. It is written by the caller of `run` (which has
// `&mut Team`) while no member is in a run, and read by members after they have seen the number of the run,
// which is stored after the job with Release or stronger. The pointee is Sync.
unsafe impl Sync for Shared {}
// SAFETY: as above; the pointer is used during the run that made it only.
unsafe impl Send for Shared {}

/// What a barrier throws in members whose comrade has panicked.
struct Abandoned;

/// One of the threads of a run.
#[derive(Clone, Copy)]
pub struct Member<'run> {
    index: usize,
    shared: &'run Shared,
}

impl Team {
    /// A team of some threads, at least one: the caller of [`Team::run`]. Fails where the system has no
    /// threads left.
    pub fn new(threads: usize) -> io::Result<Self> {
        let size = threads.max(1);
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let shared = Arc::new(Shared {
            size,
            spins: size <= cores,
            run: Apart(AtomicU64::new(0)),
            finished: Apart(AtomicU32::new(0)),
            arrived: Apart(AtomicU32::new(0)),
            gate: Apart(Gate { passed: AtomicU32::new(0), broken: AtomicBool::new(false) }),
            job: UnsafeCell::new(None),
            panic: Mutex::new(None),
            sleeping: (0..size).map(|_| Apart(AtomicBool::new(false))).collect(),
        });
        // A team that fails half-way is dropped here, which sends those home that have come.
        let mut team = Self { shared, workers: Vec::with_capacity(size - 1) };
        for index in 1..size {
            let shared = team.shared.clone();
            let name = format!("helfrich-{index}");
            let worker = thread::Builder::new().name(name).spawn(move || shared.work(index))?;
            team.workers.push(worker);
        }
        Ok(team)
    }

    /// Number of members.
    pub fn size(&self) -> usize {
        self.shared.size
    }

    /// Let every member execute `job`; returns when all are done. If members panic, the first panic goes on
    /// in the caller, and the team stays usable.
    pub fn run<F: Fn(Member<'_>) + Sync>(&mut self, job: F) {
        let shared = &*self.shared;
        if shared.size == 1 {
            return job(Member { index: 0, shared });
        }
        let borrowed: &(dyn Fn(Member<'_>) + Sync) = &job;
        // SAFETY: the transmute changes the lifetime of the closure only, and this function does not return, nor
        // unwind, before all members have finished with it.
        let job: Job = unsafe {
            std::mem::transmute::<*const (dyn Fn(Member<'_>) + Sync + '_), Job>(borrowed)
        };
        // SAFETY: between runs, members do not read the job.
        unsafe { *shared.job.get() = Some(job) };
        // Nobody else writes the number. A member stores that it goes to sleep and then looks at the number; here
        // the number is stored first and then looked who sleeps. With one order of these four
        // (SeqCst), no member can miss a run.
        shared.run.0.store(shared.run.0.load(Relaxed) + 1, SeqCst);
        self.wake();
        shared.take_part(0);
        shared.wait(|| shared.finished.0.load(Acquire) as usize == shared.size - 1);
        shared.finished.0.store(0, Relaxed);
        // SAFETY: all members have finished.
        unsafe { *shared.job.get() = None };
        if shared.gate.0.broken.load(Relaxed) {
            shared.gate.0.broken.store(false, Relaxed);
            shared.arrived.0.store(0, Relaxed);
            let panic = shared.panic.lock().unwrap_or_else(PoisonError::into_inner).take();
            resume_unwind(panic.unwrap_or_else(|| Box::new("a thread has failed")));
        }
    }

    fn wake(&self) {
        for (worker, sleeping) in self.workers.iter().zip(&self.shared.sleeping[1..]) {
            if sleeping.0.load(SeqCst) {
                worker.thread().unpark();
            }
        }
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        self.shared.run.0.store(STOP, SeqCst);
        self.wake();
        for worker in self.workers.drain(..) {
            // A worker catches the panics of its jobs; there is nothing that could be lost here.
            let _ = worker.join();
        }
    }
}

impl Shared {
    /// The life of a member other than the caller.
    fn work(&self, index: usize) {
        let mut last = 0;
        loop {
            last = self.next_run(index, last);
            if last == STOP {
                return;
            }
            self.take_part(index);
            self.finished.0.fetch_add(1, Release);
        }
    }

    /// Wait for a run other than the last one.
    fn next_run(&self, index: usize, last: u64) -> u64 {
        if self.spins {
            let start = Instant::now();
            while start.elapsed() < IDLE_SPIN {
                for _ in 0..16 {
                    let run = self.run.0.load(Acquire);
                    if run != last {
                        return run;
                    }
                    spin_loop();
                }
            }
        }
        let sleeping = &self.sleeping[index].0;
        sleeping.store(true, SeqCst);
        loop {
            let run = self.run.0.load(SeqCst);
            if run != last {
                sleeping.store(false, Relaxed);
                return run;
            }
            thread::park();
        }
    }

    /// Execute the job of the present run.
    fn take_part(&self, index: usize) {
        // SAFETY: the job was stored before the number of the run, which this thread has seen.
        let Some(job) = (unsafe { *self.job.get() }) else { return };
        // SAFETY: the caller of `run` keeps the closure alive until every member has finished.
        let job = unsafe { &*job };
        let member = Member { index, shared: self };
        // A closure that was shared with other threads and has panicked may leave broken data behind; the
        // panic reaches the caller, who is the one to know.
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| job(member))) {
            if !panic.is::<Abandoned>() {
                let mut first = self.panic.lock().unwrap_or_else(PoisonError::into_inner);
                first.get_or_insert(panic);
            }
            self.gate.0.broken.store(true, Release);
        }
    }

    fn wait(&self, is_over: impl Fn() -> bool) {
        let mut patience = if self.spins { PATIENCE } else { 0 };
        while !is_over() {
            if patience > 0 {
                patience -= 1;
                spin_loop();
            } else {
                thread::yield_now();
            }
        }
    }
}

impl Member<'_> {
    /// Which member this is: 0 is the caller of the run.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Number of members.
    pub fn size(&self) -> usize {
        self.shared.size
    }

    /// Wait until every member is here. All members must call this equally often in a run. What any of
    /// them wrote before, all can read after it.
    pub fn barrier(&self) {
        let (shared, gate) = (self.shared, &self.shared.gate.0);
        if shared.size == 1 {
            return;
        }
        let passed = gate.passed.load(Relaxed);
        if shared.arrived.0.fetch_add(1, AcqRel) as usize == shared.size - 1 {
            shared.arrived.0.store(0, Relaxed);
            gate.passed.store(passed.wrapping_add(1), Release);
            return;
        }
        let is_open = || gate.passed.load(Acquire) != passed;
        shared.wait(|| is_open() || gate.broken.load(Relaxed));
        if !is_open() {
            // Unwinds without a message: the one who broke the barrier has given his.
            resume_unwind(Box::new(Abandoned));
        }
    }

    /// The part of `0..count` that falls to this member; the parts are contiguous and equal up to one.
    pub fn share(&self, count: usize) -> Range<usize> {
        let bound = |k: usize| count * k / self.shared.size;
        bound(self.index)..bound(self.index + 1)
    }
}

/// A slice that the members of a team divide among themselves.
pub struct Parts<'slice, T> {
    start: *mut T,
    length: usize,
    borrow: PhantomData<&'slice mut [T]>,
}

// SAFETY: a shared `Parts` hands out exclusive parts of its slice only, as `part` demands of its callers; so it is
// like sending these parts to other threads.
unsafe impl<T: Send> Sync for Parts<'_, T> {}

impl<'slice, T> Parts<'slice, T> {
    /// Divide a slice, which nobody else can use meanwhile.
    pub fn new(slice: &'slice mut [T]) -> Self {
        Self { start: slice.as_mut_ptr(), length: slice.len(), borrow: PhantomData }
    }

    /// A part of the slice; panics if there is no such part.
    ///
    /// # Safety
    /// Parts that are in use at the same time must not overlap.
    #[allow(clippy::mut_from_ref, reason = "the caller promises that parts are apart")]
    pub unsafe fn part(&self, range: Range<usize>) -> &mut [T] {
        assert!(range.start <= range.end && range.end <= self.length, "no part {range:?}");
        // SAFETY: the range lies in the slice, and the caller promises that nobody else uses it.
        unsafe { slice::from_raw_parts_mut(self.start.add(range.start), range.len()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [usize; 4] = [1, 2, 3, 8];

    #[test]
    fn every_member_runs_once_a_run() {
        for size in SIZES {
            let mut team = Team::new(size).unwrap();
            let counts: Vec<_> = (0..size).map(|_| AtomicU64::new(0)).collect();
            for round in 1..=2000 {
                team.run(|member| {
                    assert_eq!(member.size(), size);
                    counts[member.index()].fetch_add(1, Relaxed);
                });
                assert!(counts.iter().all(|count| count.load(Relaxed) == round));
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
            for _ in 0..200 {
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
        for round in 1..=20 {
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
                    for _ in 0..500 {
                        team.run(|member| {
                            member.barrier();
                            total.fetch_add(1, Relaxed);
                        });
                    }
                });
            }
        });
        assert_eq!(total.into_inner(), 3000);
    }
}
