//! What threads are coordinated with: the standard library's, or in `tests/loom` stand-ins that try all orders.

#[cfg(loom)]
pub use crate::stand_ins::*;
#[cfg(not(loom))]
pub use std::{
    hint::spin_loop,
    sync::{
        Condvar, Mutex,
        atomic::{AtomicBool, AtomicU32, AtomicU64},
    },
    thread::{Builder, park},
    time::Instant,
};

/// One of a team's threads.
#[cfg(not(loom))]
pub type JoinHandle = std::thread::JoinHandle<()>;

/// A place for a value without any lock, with loom's functions.
#[cfg(not(loom))]
pub struct UnsafeCell<T>(std::cell::UnsafeCell<T>);

#[cfg(not(loom))]
impl<T> UnsafeCell<T> {
    pub fn new(value: T) -> Self {
        Self(std::cell::UnsafeCell::new(value))
    }

    /// Read the value in `read`.
    pub fn with<R>(&self, read: impl FnOnce(*const T) -> R) -> R {
        read(self.0.get())
    }

    /// Change the value in `write`.
    pub fn with_mut<R>(&self, write: impl FnOnce(*mut T) -> R) -> R {
        write(self.0.get())
    }
}

/// How often a member that has something to wait for looks before it sleeps.
#[cfg(not(loom))]
pub fn patience(usual: u32) -> u32 {
    usual
}

/// Stands where a store with SeqCst is followed by a load with SeqCst, whose order loom knows of fences only.
#[cfg(not(loom))]
pub fn one_order() {}
