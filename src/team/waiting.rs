//! How members wait for each other: for a while they spin, then they sleep.

use super::Shared;
use super::sync::{Instant, one_order, park, patience, spin_loop};
use std::sync::PoisonError;
use std::sync::atomic::Ordering::{Acquire, Relaxed, SeqCst};
use std::time::Duration;

/// How long members look out for the next run before they sleep.
pub const IDLE_SPIN: Duration = Duration::from_micros(50);

/// How often a waiting member looks before it sleeps: some 40 µs.
const PATIENCE: u32 = 2000;

impl Shared {
    /// Wait for a run other than the last one.
    pub fn next_run(&self, index: usize, last: u64) -> u64 {
        if self.spins {
            let start = Instant::now();
            while start.elapsed() < IDLE_SPIN {
                for _ in 0..patience(16) {
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
        one_order();
        loop {
            let run = self.run.0.load(SeqCst);
            if run != last {
                sleeping.store(false, Relaxed);
                return run;
            }
            park();
        }
    }

    /// Wait for what another member does before it calls [`Self::wake_all`]; both use SeqCst.
    pub fn wait(&self, is_over: impl Fn() -> bool) {
        let patience = if self.spins { patience(PATIENCE) } else { 0 };
        for _ in 0..patience {
            if is_over() {
                return;
            }
            spin_loop();
        }
        let mut guard = self.asleep.lock().unwrap_or_else(PoisonError::into_inner);
        self.blocked.0.fetch_add(1, SeqCst);
        one_order();
        while !is_over() {
            guard = self.wake.wait(guard).unwrap_or_else(PoisonError::into_inner);
        }
        self.blocked.0.fetch_sub(1, SeqCst);
    }

    /// Wake those who wait. In the one order of SeqCst, either this sees that somebody is blocked, or he looks
    /// after the change that he waits for; and he holds the lock from before he looks until he sleeps.
    pub fn wake_all(&self) {
        one_order();
        if self.blocked.0.load(SeqCst) > 0 {
            drop(self.asleep.lock().unwrap_or_else(PoisonError::into_inner));
            self.wake.notify_all();
        }
    }
}
