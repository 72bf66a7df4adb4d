//! What the team finds in place of the standard library.

pub use loom::cell::UnsafeCell;
pub use loom::hint::spin_loop;
pub use loom::sync::atomic::{AtomicBool, AtomicU32, AtomicU64};
pub use loom::sync::{Condvar, Mutex};

use loom::sync::atomic::{Ordering, fence};
use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::time::Duration;
use std::{io, thread};

/// How members wait for each other in a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Manner {
    /// They look until they see it. No fence adds an order that the team's own loads and stores do not have.
    Look,
    /// They look once and then sleep.
    LookOnce,
    /// They sleep at once.
    Sleep,
}

thread_local! {
    // loom runs all threads of a model on one.
    static MANNER: Cell<Manner> = const { Cell::new(Manner::Look) };
}

/// From here on, teams of this thread wait in this manner.
pub fn set_manner(manner: Manner) {
    MANNER.set(manner);
}

pub fn patience(_usual: u32) -> u32 {
    if MANNER.get() == Manner::Look { u32::MAX } else { 1 }
}

/// Between a store and a load with SeqCst: loom takes these for AcqRel, and fences for what they are.
pub fn one_order() {
    if MANNER.get() != Manner::Look {
        fence(Ordering::SeqCst);
    }
}

/// Time, which here is over when one has looked.
pub struct Instant(Cell<bool>);

impl Instant {
    pub fn now() -> Self {
        Self(Cell::new(false))
    }

    pub fn elapsed(&self) -> Duration {
        if self.0.replace(true) { Duration::MAX } else { Duration::ZERO }
    }
}

/// Whether a thread may go on, for it to wait for. loom's own `unpark` wakes threads that wait for a lock, too, and
/// what it leaves for a later `park` can get lost.
#[derive(Default)]
pub struct Permit {
    given: Mutex<bool>,
    wake: Condvar,
}

impl Permit {
    pub fn unpark(&self) {
        *self.given.lock().unwrap() = true;
        self.wake.notify_one();
    }

    fn take(&self) {
        let mut given = self.given.lock().unwrap();
        while !*given {
            given = self.wake.wait(given).unwrap();
        }
        *given = false;
    }
}

loom::thread_local! {
    static PERMIT: RefCell<Option<Arc<Permit>>> = RefCell::new(None);
}

/// Wait for the permit of this thread.
pub fn park() {
    let permit = PERMIT.with(|own| own.borrow().clone());
    permit.expect("a thread of `Builder`").take();
}

/// Starts threads that can park.
pub struct Builder;

impl Builder {
    pub fn new() -> Self {
        Self
    }

    pub fn name(self, _name: String) -> Self {
        self
    }

    pub fn spawn(self, work: impl FnOnce() + 'static) -> io::Result<JoinHandle> {
        let permit = Arc::new(Permit::default());
        let own = permit.clone();
        let thread = loom::thread::spawn(move || {
            PERMIT.with(|place| *place.borrow_mut() = Some(own));
            work();
        });
        Ok(JoinHandle { permit, thread })
    }
}

/// A thread that was started.
pub struct JoinHandle {
    permit: Arc<Permit>,
    thread: loom::thread::JoinHandle<()>,
}

impl JoinHandle {
    pub fn thread(&self) -> &Permit {
        &self.permit
    }

    pub fn join(self) -> thread::Result<()> {
        self.thread.join()
    }
}
