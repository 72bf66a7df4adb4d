//! Faults on demand, at the border to wgpu, for the tests of what happens when a GPU fails.

use std::sync::Mutex;

/// What can be made to go wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// No adapter is found.
    Adapter,
    /// The device has no memory for the buffers of a mesh.
    Memory,
    /// The device is destroyed before an evaluation.
    Lost,
}

/// The fault and the number of occasions that it still lets pass.
static NEXT: Mutex<Option<(Fault, u64)>> = Mutex::new(None);

/// Let a fault happen at its `after`-th next occasion, counted from 0; `None` for no more faults. A missing
/// adapter stays missing; the other faults happen once.
pub fn inject(fault: Option<Fault>, after: u64) {
    *lock() = fault.map(|fault| (fault, after));
}

/// Whether a fault is to happen now.
pub(super) fn strikes(fault: Fault) -> bool {
    let mut next = lock();
    match &mut *next {
        Some((due, after)) if *due == fault => {
            if *after > 0 {
                *after -= 1;
                return false;
            }
            if fault != Fault::Adapter {
                *next = None;
            }
            true
        }
        _ => false,
    }
}

fn lock() -> std::sync::MutexGuard<'static, Option<(Fault, u64)>> {
    NEXT.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}
