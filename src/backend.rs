//! What computes the forces: the processor, a GPU, or whichever is faster.
//!
//! A choice is written `KIND[:PRECISION][@ADAPTER]`, for example `gpu`, `gpu:double` or `auto:single@1`. There
//! is one for the process, which [`set_global`] or the environment variable `HELFRICH_BACKEND` changes, and a
//! force can have its own. It takes effect when a Context is made.

use crate::error::{Error, Result};
use std::fmt;
use std::str::FromStr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// What shall compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// OpenMM's GPU platforms themselves where the device is a GPU; elsewhere a GPU for large meshes, if it is faster, and
    /// the processor for all others, and when the GPU fails.
    Auto,
    /// The processor.
    Cpu,
    /// The GPU; its failures are errors.
    Gpu,
    /// OpenMM's GPU platforms themselves; a Context on another platform is an error.
    Native,
}

/// A kind with what is asked of the GPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    /// What shall compute.
    pub kind: Kind,
    /// Whether the GPU shall compute in double precision; `None` leaves it to us, which is single.
    pub double: Option<bool>,
    /// The index of the adapter; `None` for the best.
    pub adapter: Option<usize>,
}

impl FromStr for Choice {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let unknown = || Error::UnknownBackend { name: text.to_owned() };
        let (rest, adapter) = match text.split_once('@') {
            None => (text, None),
            Some((rest, index)) => (rest, Some(index.parse().map_err(|_| unknown())?)),
        };
        let (kind, precision) = rest.split_once(':').map_or((rest, None), |(k, p)| (k, Some(p)));
        let kind = match kind {
            "auto" => Kind::Auto,
            "cpu" => Kind::Cpu,
            "gpu" => Kind::Gpu,
            "native" => Kind::Native,
            _ => return Err(unknown()),
        };
        let double = match precision {
            None => None,
            // OpenMM's platforms have a precision of their own.
            _ if matches!(kind, Kind::Cpu | Kind::Native) => return Err(unknown()),
            Some("single") => Some(false),
            Some("double") => Some(true),
            Some(_) => return Err(unknown()),
        };
        if matches!(kind, Kind::Cpu | Kind::Native) && adapter.is_some() {
            return Err(unknown());
        }
        Ok(Self { kind, double, adapter })
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self.kind {
            Kind::Auto => "auto",
            Kind::Cpu => "cpu",
            Kind::Gpu => "gpu",
            Kind::Native => "native",
        })?;
        if let Some(double) = self.double {
            out.write_str(if double { ":double" } else { ":single" })?;
        }
        self.adapter.map_or(Ok(()), |index| write!(out, "@{index}"))
    }
}

static GLOBAL: Mutex<Option<Choice>> = Mutex::new(None);

fn global_slot() -> std::sync::MutexGuard<'static, Option<Choice>> {
    GLOBAL.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The choice for all forces that have none of their own.
///
/// # Errors
/// The environment variable has no choice in it.
pub fn global() -> Result<Choice> {
    let mut slot = global_slot();
    if let Some(choice) = *slot {
        return Ok(choice);
    }
    let text = std::env::var("HELFRICH_BACKEND").unwrap_or_default();
    let choice = if text.is_empty() { "auto" } else { &text }.parse().map_err(|_| {
        Error::Contract(format!(
            "the environment variable HELFRICH_BACKEND is \"{text}\"; it must be one of auto, cpu, native, \
             gpu, gpu:single, gpu:double"
        ))
    })?;
    *slot = Some(choice);
    Ok(choice)
}

/// Change it; Contexts that exist stay as they are.
/// [`check_backend`](crate::evaluator::check_backend) tells whether it can be.
pub fn set_global(choice: Choice) {
    *global_slot() = Some(choice);
}

/// Evaluations on the processor, on GPUs and by OpenMM's GPU platforms since the process began.
static EVALUATIONS: [AtomicU64; 3] = [const { AtomicU64::new(0) }; 3];

pub(crate) fn count_evaluation(by: Kind) {
    let place = match by {
        Kind::Gpu => 1,
        Kind::Native => 2,
        Kind::Cpu | Kind::Auto => 0,
    };
    EVALUATIONS[place].fetch_add(1, Ordering::Relaxed);
}

/// How many evaluations the processor, GPUs and OpenMM's GPU platforms have done in this process.
pub fn evaluations() -> [u64; 3] {
    [0, 1, 2].map(|place| EVALUATIONS[place].load(Ordering::Relaxed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_read_as_they_are_written() {
        for text in
            ["auto", "cpu", "gpu", "gpu:single", "gpu:double@2", "auto:double", "gpu@0", "native"]
        {
            assert_eq!(text.parse::<Choice>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "GPU",
            "gpu:half",
            "gpu:",
            "gpu@",
            "gpu@-1",
            "cpu:double",
            "cpu@0",
            "gpu@1:single",
            "native:single",
        ] {
            let error = text.parse::<Choice>().unwrap_err();
            assert_eq!(error, Error::UnknownBackend { name: text.to_owned() });
        }
    }
}
