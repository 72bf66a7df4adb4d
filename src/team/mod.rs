//! A few threads that work on one thing together, at a cost of tenths of a microsecond.
//!
//! A time step of a small membrane takes some ten microseconds and needs its threads to meet several times. A
//! general pool costs as much as there is to gain: `rayon::broadcast` takes several microseconds a call.
//! The members of a [`Team`] stay at their post instead. Within a run they meet at barriers that spin; between
//! runs they spin for `IDLE_SPIN`, then sleep, so that an idle simulation leaves its cores to others.
//! Whoever waits for longer than the work of a step takes sleeps, too, so that a team with more members than there
//! are free cores is slow but never stands still: threads that spin or yield would burn the time that
//! the system has for those that they wait for.
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

mod parts;
mod sharing;
mod sync;
#[cfg(all(test, not(loom)))]
mod tests;
mod waiting;

pub use parts::Parts;
pub(crate) use sharing::Sharing;

use std::any::Any;
use std::io;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::Ordering::{AcqRel, Relaxed, SeqCst};
use std::sync::{Arc, PoisonError};
use std::thread::available_parallelism;
use sync::{
    AtomicBool, AtomicU32, AtomicU64, Builder, Condvar, JoinHandle, Mutex, UnsafeCell, one_order,
};

/// As many threads as the environment variable OPENMM_CPU_THREADS says, which OpenMM's CPU platform follows too,
/// or else as there are processors for this process.
pub fn default_threads() -> usize {
    let wanted = std::env::var("OPENMM_CPU_THREADS").ok().and_then(|value| value.parse().ok());
    wanted.filter(|&threads| threads > 0).unwrap_or_else(processors)
}

/// How many processors there are for this process.
fn processors() -> usize {
    available_parallelism().map_or(1, usize::from)
}

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
    workers: Vec<JoinHandle>,
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
    /// Which members sleep between runs, or are about to.
    sleeping: Box<[Apart<AtomicBool>]>,
    /// How many members sleep within a run, or are about to.
    blocked: Apart<AtomicU32>,
    asleep: Mutex<()>,
    wake: Condvar,
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
        Self::of(size, size <= processors())
    }

    /// A team of `size` members, which spin for each other before they sleep or do not.
    pub(crate) fn of(size: usize, spins: bool) -> io::Result<Self> {
        let shared = Arc::new(Shared {
            size,
            spins,
            run: Apart(AtomicU64::new(0)),
            finished: Apart(AtomicU32::new(0)),
            arrived: Apart(AtomicU32::new(0)),
            gate: Apart(Gate { passed: AtomicU32::new(0), broken: AtomicBool::new(false) }),
            job: UnsafeCell::new(None),
            panic: Mutex::new(None),
            sleeping: (0..size).map(|_| Apart(AtomicBool::new(false))).collect(),
            blocked: Apart(AtomicU32::new(0)),
            asleep: Mutex::new(()),
            wake: Condvar::new(),
        });
        // A team that fails half-way is dropped here, which sends those home that have come.
        let mut team = Self { shared, workers: Vec::with_capacity(size - 1) };
        for index in 1..size {
            let shared = team.shared.clone();
            let name = format!("helfrich-{index}");
            let worker = Builder::new().name(name).spawn(move || shared.work(index))?;
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
        shared.job.with_mut(|place| unsafe { *place = Some(job) });
        // Nobody else writes the number. A member stores that it goes to sleep and then looks at the number; here
        // the number is stored first and then looked who sleeps. With one order of these four
        // (SeqCst), no member can miss a run.
        shared.run.0.store(shared.run.0.load(Relaxed) + 1, SeqCst);
        self.wake();
        shared.take_part(0);
        shared.wait(|| shared.finished.0.load(SeqCst) as usize == shared.size - 1);
        shared.finished.0.store(0, Relaxed);
        // SAFETY: all members have finished.
        shared.job.with_mut(|place| unsafe { *place = None });
        if shared.gate.0.broken.load(Relaxed) {
            shared.gate.0.broken.store(false, Relaxed);
            shared.arrived.0.store(0, Relaxed);
            let panic = shared.panic.lock().unwrap_or_else(PoisonError::into_inner).take();
            resume_unwind(panic.unwrap_or_else(|| Box::new("a thread has failed")));
        }
    }

    fn wake(&self) {
        one_order();
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
            self.finished.0.fetch_add(1, SeqCst);
            self.wake_all();
        }
    }

    /// Execute the job of the present run.
    fn take_part(&self, index: usize) {
        // SAFETY: the job was stored before the number of the run, which this thread has seen.
        let Some(job) = self.job.with(|place| unsafe { *place }) else { return };
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
            self.gate.0.broken.store(true, SeqCst);
            self.wake_all();
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
            gate.passed.store(passed.wrapping_add(1), SeqCst);
            shared.wake_all();
            return;
        }
        let is_open = || gate.passed.load(SeqCst) != passed;
        shared.wait(|| is_open() || gate.broken.load(SeqCst));
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
