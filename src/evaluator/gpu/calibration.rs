//! Whether a GPU is faster than the processor: measured once for a size of mesh and kind of terms, and kept in
//! memory and in a file of the user's cache folder.

use super::evaluator::GpuEvaluator;
use super::{Precision, adapters};
use crate::potentials::{Needs, Term};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock};
use std::time::{Duration, Instant};

/// What a measurement holds for.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Key {
    /// Version of the plugin, adapter, driver, precision, cores: what else decides how fast something is.
    machine: String,
    /// What the terms need.
    needs: u32,
    /// 2 log₂ of the number of vertices, rounded: sizes within a fifth count as alike.
    size: u32,
}

impl Key {
    /// For terms on a mesh of so many vertices.
    pub fn new(gpu: &GpuEvaluator, vertices: usize, terms: &[Term], threads: usize) -> Self {
        let (adapter, driver) = gpu.adapter();
        let precision = match gpu.precision() {
            Precision::Single => "single",
            Precision::Double => "double",
        };
        let version = env!("CARGO_PKG_VERSION");
        let machine = format!("{version}|{adapter}|{driver}|{precision}|{threads} threads");
        let needs = terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        let size = (2.0 * (vertices as f64).log2()).round() as u32;
        Self { machine: machine.replace(['\t', '\n'], " "), needs: needs.bits(), size }
    }
}

/// The times of an evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// On the processor.
    pub cpu: Duration,
    /// On the GPU.
    pub gpu: Duration,
}

/// The shortest of a few runs, after one that does not count.
pub fn fastest(mut body: impl FnMut()) -> Duration {
    body();
    (0..3)
        .map(|_| {
            let start = Instant::now();
            body();
            start.elapsed()
        })
        .min()
        .unwrap_or_default()
}

/// Whether there is an adapter that could be faster than the processor. One that computes on the processor
/// itself never is.
pub fn has_candidate(index: Option<usize>) -> bool {
    adapters::find(index).is_ok_and(|(_, adapter)| prefers_gpu() || !adapter.is_software())
}

static PREFERS_GPU: AtomicBool = AtomicBool::new(false);

/// For tests: let `auto` take any GPU for any mesh without measuring.
pub fn prefer_gpu(on: bool) {
    PREFERS_GPU.store(on, Ordering::Relaxed);
}

/// Whether `auto` takes any GPU.
pub fn prefers_gpu() -> bool {
    PREFERS_GPU.load(Ordering::Relaxed)
}

/// An earlier measurement.
pub fn recall(key: &Key) -> Option<Times> {
    known().get(key).copied()
}

/// Keep a measurement. A cache folder that cannot be written to costs the next process a measurement.
pub fn remember(key: Key, times: Times) {
    let line = line(&key, times);
    known().insert(key, times);
    if let Some(path) = cache_file() {
        let folder = path.parent().map(fs::create_dir_all);
        if matches!(folder, Some(Ok(()))) {
            let file = fs::OpenOptions::new().create(true).append(true).open(path);
            let _ = file.and_then(|mut file| file.write_all(line.as_bytes()));
        }
    }
}

/// All measurements, one a line: machine, needs, vertices (about), microseconds on the processor and on the GPU.
pub fn report() -> String {
    let mut text = String::new();
    let mut all: Vec<_> = known().iter().map(|(key, times)| (key.clone(), *times)).collect();
    all.sort_by(|a, b| {
        (&a.0.machine, a.0.needs, a.0.size).cmp(&(&b.0.machine, b.0.needs, b.0.size))
    });
    for (key, times) in all {
        let vertices = 2f64.powf(f64::from(key.size) / 2.0);
        let [cpu, gpu] = [times.cpu, times.gpu].map(|time| time.as_secs_f64() * 1e6);
        let _ = writeln!(text, "{}\t{}\t{vertices:.0}\t{cpu:.1}\t{gpu:.1}", key.machine, key.needs);
    }
    text
}

fn line(key: &Key, times: Times) -> String {
    let [cpu, gpu] = [times.cpu, times.gpu].map(|time| time.as_nanos());
    format!("{}\t{}\t{}\t{cpu}\t{gpu}\n", key.machine, key.needs, key.size)
}

/// A line of the file; one that another release wrote, or half a line, is passed over.
fn parse(line: &str) -> Option<(Key, Times)> {
    let mut words = line.split('\t');
    let machine = words.next()?.to_owned();
    let (needs, size) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?);
    let mut time = || Some(Duration::from_nanos(words.next()?.parse().ok()?));
    let times = Times { cpu: time()?, gpu: time()? };
    Some((Key { machine, needs, size }, times))
}

fn known() -> MutexGuard<'static, HashMap<Key, Times>> {
    static KNOWN: OnceLock<Mutex<HashMap<Key, Times>>> = OnceLock::new();
    let known = KNOWN.get_or_init(|| {
        let text = cache_file().and_then(|path| fs::read_to_string(path).ok());
        Mutex::new(text.unwrap_or_default().lines().filter_map(parse).collect())
    });
    known.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Where the user's caches are, by the custom of the system.
fn cache_file() -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let base = if cfg!(windows) {
        PathBuf::from(folder("LOCALAPPDATA")?)
    } else if cfg!(target_os = "macos") {
        PathBuf::from(folder("HOME")?).join("Library/Caches")
    } else {
        folder("XDG_CACHE_HOME")
            .map(PathBuf::from)
            .or_else(|| folder("HOME").map(|home| PathBuf::from(home).join(".cache")))?
    };
    Some(base.join("openmm-helfrich").join("backends.tsv"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_as_they_are_written() {
        let key =
            Key { machine: "0.1|A card|driver 3|single|8 cores".to_owned(), needs: 27, size: 33 };
        let times = Times { cpu: Duration::from_micros(812), gpu: Duration::from_nanos(90_001) };
        let line = line(&key, times);
        assert_eq!(parse(line.trim_end()), Some((key, times)));
        for broken in ["", "machine", "m\t1\t2\t3", "m\tx\t2\t3\t4", &line[..line.len() - 12]] {
            assert_eq!(parse(broken), None, "{broken:?}");
        }
    }
}
