//! The modules of the crate stand on floors, and use what is below them only.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// From the ground up; those beside each other do not know each other.
const FLOORS: [&[&str]; 9] = [
    &["error", "openmm", "real"],
    &["backend", "lanes", "mesh", "team"],
    &["potentials", "test_meshes"],
    &["contact", "dynamics", "evaluator", "remembered"],
    &["moves"],
    &["membrane"],
    &["ffi"],
    &["force"],
    &["lib"],
];

/// Modules that a file names, without what its tests need.
fn used(text: &str) -> impl Iterator<Item = &str> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    code.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| line.split("crate::").skip(1))
        .filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next())
        .filter(|name| !name.is_empty())
}

fn files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn modules_use_what_is_below_them() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let floor: BTreeMap<_, _> = FLOORS
        .iter()
        .enumerate()
        .flat_map(|(n, names)| names.iter().map(move |m| (*m, n)))
        .collect();
    let mut all = Vec::new();
    files(&source, &mut all);
    assert!(all.len() > 100, "the sources are there");
    let mut wrong = Vec::new();
    for path in all {
        let inside = path.strip_prefix(&source).unwrap();
        let first = inside.components().next().unwrap().as_os_str().to_str().unwrap();
        let module = first.trim_end_matches(".rs");
        if inside.ends_with("tests.rs") {
            continue;
        }
        let here = *floor.get(module).unwrap_or_else(|| panic!("{module} is on no floor"));
        let text = fs::read_to_string(&path).unwrap();
        for name in used(&text) {
            // Macros are of the crate, too.
            let Some(&there) = floor.get(name) else { continue };
            if name != module && there >= here && module != "lib" {
                wrong.push(format!("{} uses {name}", inside.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
