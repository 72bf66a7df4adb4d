//! The functions that Rust exports, compared with their declarations for C++.
//!
//! The build writes a constant for each function in `CoreFunctions.h` and `HelfrichDynamics.h`
//! (`wrappers/declarations.rs`), which compiles only if Rust has one of its name and type.

use super::records::*;
use crate::ffi as exported;

include!(concat!(env!("OUT_DIR"), "/exported.rs"));

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    /// The names of the functions in Rust's sources that C++ can call. Those that macros make are of the C API.
    fn exported(folder: &Path) -> BTreeSet<String> {
        let sources = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let texts =
            sources.filter(|path| path.is_file()).map(|path| fs::read_to_string(path).unwrap());
        let names = |text: String| -> Vec<String> {
            let marked = text.split("\n#[unsafe(no_mangle)]\n").skip(1);
            let name = |part: &str| {
                part.split_once(" fn ")?.1.split_once('(').map(|(name, _)| name.to_owned())
            };
            marked.filter_map(name).collect()
        };
        texts.flat_map(names).collect()
    }

    #[test]
    fn every_exported_function_is_declared() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut found = exported(&root.join("src/ffi"));
        found.extend(exported(&root.join("src")));
        let declared: BTreeSet<_> = super::NAMES.iter().map(|&name| name.to_owned()).collect();
        assert!(found.len() > 50);
        assert_eq!(found, declared);
    }
}
