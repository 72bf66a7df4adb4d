//! Part of build.rs: makes one WGSL module for each precision of the files here and validates it, so that a
//! slip in a shader stops the build with its file and line.
//!
//! A potential is a file in `potentials/` under the stem of its Rust twin, with a function `STEM_totals`,
//! `STEM_triangle`, `STEM_edge` or `STEM_vertex` for each kind of element on which it has energy. The functions
//! `energy_of_…`, which choose among them by the number of a term's potential, are written here.

use crate::{constants, dialect};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::fs;
use std::path::Path;

/// What every module is made of, beside its potentials; `*` stands for its precision.
const BEFORE: [&str; 9] = [
    "precision_*.wgsl",
    "bindings.wgsl",
    "functions.wgsl",
    "geometry.wgsl",
    "vertex_vectors.wgsl",
    "sums.wgsl",
    "totals_*.wgsl",
    "springs.wgsl",
    "strain.wgsl",
];
const AFTER: &str = "passes.wgsl";

/// A kind of element, its struct, and the type of the derivatives with respect to it.
const KINDS: [(&str, &str, &str); 4] = [
    ("totals", "", "TotalPartials"),
    ("triangle", "TriangleGeometry", "TrianglePartials"),
    ("edge", "EdgeGeometry", "real"),
    ("vertex", "VertexGeometry", "VertexPartials"),
];

/// A module with the file and line that each of its parts came from.
#[derive(Default)]
struct Module {
    text: String,
    parts: Vec<(String, usize)>,
}

impl Module {
    fn add(&mut self, name: &str, text: &str) {
        self.parts.push((name.to_owned(), self.text.lines().count()));
        self.text.push_str(text);
        self.text.push('\n');
    }

    /// The file and line of a line of the module.
    fn place(&self, line: usize) -> String {
        let part = self.parts.iter().rev().find(|(_, before)| *before < line);
        part.map_or_else(String::new, |(name, before)| format!("{name}:{}", line - before))
    }
}

/// Compose and validate the modules, and write them to `out` as `single.wgsl`, `double.wgsl`, with a Rust file
/// `shaders.rs` that has them and the names of the potentials in the order of their numbers.
pub fn write_modules(folder: &Path, out: &Path) -> Result<(), String> {
    let stems = stems(&folder.join("potentials"))?;
    let integers = read(&folder.join("openmm_integers.c"))?;
    for (precision, real, capabilities) in
        [("single", 4, Capabilities::empty()), ("double", 8, Capabilities::FLOAT64)]
    {
        let module = compose(folder, precision, &stems)?;
        let program = validate(&module, real, capabilities, &integers)
            .map_err(|error| format!("In {precision} precision: {error}"))?;
        write(&out.join(format!("{precision}.wgsl")), &module.text)?;
        let [before, after] =
            ["prelude", "kernels"].map(|name| read(&folder.join(format!("openmm_{name}.c"))));
        write(&out.join(format!("{precision}.c")), &format!("{}{program}{}\0", before?, after?))?;
    }
    let classes: Vec<_> = stems.iter().map(|stem| class_of(stem)).collect();
    let mut rust = format!(
        "/// The names of the potentials; a term has the index of its potential.\n\
         pub const POTENTIALS: &[&str] = &{classes:?};\n"
    );
    for precision in ["single", "double"] {
        let name = precision.to_uppercase();
        rust += &format!(
            "/// In {precision} precision.\npub const {name}: &str = include_str!(\"{precision}.wgsl\");\n\
             /// The same in OpenMM's dialect.\npub const {name}_PROGRAM: &std::ffi::CStr = \
             match std::ffi::CStr::from_bytes_with_nul(include_bytes!(\"{precision}.c\")) {{\n\
             \x20   Ok(text) => text,\n    Err(_) => panic!(\"a program ends with a NUL\"),\n}};\n"
        );
    }
    write(&out.join("shaders.rs"), &rust)
}

fn read(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("cannot read {}: {error}", path.display()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))
}

/// "TriangleHeightForce" for "triangle_height".
fn class_of(stem: &str) -> String {
    let words = stem.split('_').filter_map(|word| word.split_at_checked(1));
    words.map(|(first, rest)| first.to_uppercase() + rest).collect::<String>() + "Force"
}

/// The names of the potentials' files, sorted.
fn stems(folder: &Path) -> Result<Vec<String>, String> {
    let entries = fs::read_dir(folder)
        .map_err(|error| format!("cannot read {}: {error}", folder.display()))?;
    let mut stems: Vec<String> = entries
        .flatten()
        .filter_map(|entry| entry.file_name().to_str()?.strip_suffix(".wgsl").map(str::to_owned))
        .collect();
    stems.sort();
    Ok(stems)
}

fn compose(folder: &Path, precision: &str, stems: &[String]) -> Result<Module, String> {
    let mut module = Module::default();
    module.add("the constants and bindings (shaders/constants.rs)", &constants::declarations());
    for name in BEFORE {
        let name = name.replace('*', precision);
        module.add(&format!("shaders/{name}"), &read(&folder.join(&name))?);
    }
    let mut found: [Vec<usize>; 4] = Default::default();
    for (number, stem) in stems.iter().enumerate() {
        let text = read(&folder.join(format!("potentials/{stem}.wgsl")))?;
        for (kind, numbers) in KINDS.iter().zip(&mut found) {
            if text.contains(&format!("fn {stem}_{}(", kind.0)) {
                numbers.push(number);
            }
        }
        module.add(&format!("shaders/potentials/{stem}.wgsl"), &text);
    }
    if let Some(number) = (0..stems.len()).find(|n| !found.iter().flatten().any(|m| m == n)) {
        let stem = &stems[number];
        return Err(format!(
            "shaders/potentials/{stem}.wgsl has no function {stem}_totals, {stem}_triangle, \
             {stem}_edge or {stem}_vertex"
        ));
    }
    for (kind, numbers) in KINDS.iter().zip(&found) {
        module
            .add("the choice of a potential (shaders/compose.rs)", &choice(*kind, numbers, stems));
    }
    module.add(&format!("shaders/{AFTER}"), &read(&folder.join(AFTER))?);
    Ok(module)
}

/// The function that calls the potential of a term for an element of one kind.
fn choice(
    (kind, geometry, partials): (&str, &str, &str),
    numbers: &[usize],
    stems: &[String],
) -> String {
    let (parameters, arguments) = if geometry.is_empty() {
        (String::new(), "")
    } else {
        (format!("element: u32, geometry: {geometry}, "), "element, geometry, ")
    };
    let mut text = format!(
        "fn energy_of_{kind}(term: u32, {parameters}partials: ptr<function, {partials}>) -> Contribution {{\n\
         \x20   switch frame.terms[term].potential {{\n"
    );
    for &number in numbers {
        let stem = &stems[number];
        text += &format!(
            "        case {number}u: {{ return {stem}_{kind}(term, {arguments}partials); }}\n"
        );
    }
    text + "        default: { return nothing(); }\n    }\n}\n"
}

/// Refuse a module with a slip, else write it as a program for OpenMM's platforms.
fn validate(
    module: &Module,
    real: usize,
    capabilities: Capabilities,
    integers: &str,
) -> Result<String, String> {
    let at = |line: Option<u32>| line.map_or_else(String::new, |line| module.place(line as usize));
    let parsed = naga::front::wgsl::parse_str(&module.text).map_err(|error| {
        let line = error.location(&module.text).map(|place| place.line_number);
        format!("{}: {}", at(line), error.emit_to_string(&module.text))
    })?;
    let mut validator = Validator::new(ValidationFlags::all(), capabilities);
    let info = validator.validate(&parsed).map_err(|error| {
        let line = error.location(&module.text).map(|place| place.line_number);
        format!("{}: {}", at(line), error.emit_to_string(&module.text))
    })?;
    constants::check_layout(&parsed, real)?;
    dialect::write(&parsed, &info, integers)
}
