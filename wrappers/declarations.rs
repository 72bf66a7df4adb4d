//! Part of build.rs: Rust for what the headers declare, so that nothing is declared twice by hand.
//!
//! bindgen reads the headers. Written are the structures that cross the border (`records.rs`), what there is to compare
//! with those that are Rust's own (`layouts.rs`) and with the functions that Rust exports (`exported.rs`), the
//! functions of the shim (`shim.rs`), and the C API of the force classes (`c_api.rs`), whose functions follow from their
//! declarations. `src/ffi/` includes all of it.

use bindgen::{Builder, CodegenConfig};
use std::fs;
use std::path::{Path, PathBuf};

/// Types that are Rust's own: `src/ffi/records.rs` knows them by these names. Of the first C++ sees pointers only.
const OPAQUE: &str =
    "Helfrich(Membrane|Numbers|Native|Team|Crowd|Dynamics|VariableMasses|Viscosity)";
const STATUS: &str = "Helfrich_Status";
const SHARED: &str = "Helfrich(Stream|Contribution|FlipRules|FlipState|SwapRules|SwapState)";
const CORE: &str = "#include <HelfrichDynamics.h>\n";
const C_API: &str = "#include <OpenMMHelfrichCWrapper.h>\n";
const SHIM: &str = "#include <Shim.h>\n#include <CApi.h>\n";

/// The functions of the C API under the names that the shim has them by, for its compiler to check.
pub fn shim_header(wrappers: &Path) -> String {
    let read = |name: &str| {
        fs::read_to_string(wrappers.join("include").join(name))
            .expect("the wrappers are part of the project")
    };
    read("OpenMMHelfrichCWrapper.h")
        .replace("#include \"OpenMMHelfrichCForces.h\"\n", &read("OpenMMHelfrichCForces.h"))
        .replace("Helfrich_", "helfrich_shim_")
        .replace("helfrich_shim_Status", STATUS)
        .replace("OPENMM_HELFRICH_", "HELFRICH_SHIM_")
}

/// Write the files. `CApi.h` must be in one of the folders.
pub fn write(
    folders: &[PathBuf],
    out: &Path,
    generate: impl Fn(Builder) -> String,
) -> std::io::Result<()> {
    let include = folders.iter().map(|folder| format!("-I{}", folder.display()));
    let read = |headers: &str, parts: CodegenConfig| {
        Builder::default()
            .header_contents("declarations.hpp", headers)
            .clang_args(["-x", "c++", "-std=c++17"])
            .clang_args(include.clone())
            .with_codegen_config(parts)
            .layout_tests(false)
            .ctypes_prefix("std::ffi")
            .formatter(bindgen::Formatter::Prettyplease)
    };
    let functions = |headers: &str| {
        let names = "[Hh]elfrich_.*|register(Platforms|KernelFactories)";
        generate(read(headers, CodegenConfig::FUNCTIONS).allowlist_function(names))
    };
    let structures = |builder: Builder| with_snake_fields(&generate(builder));
    let (core, c_api) = (functions(CORE), functions(C_API));
    let core = parsed(&core);
    let mut c_api = parsed(&c_api);
    c_api.retain(|function| core.iter().all(|known| known.name != function.name));
    let types = || read(CORE, CodegenConfig::TYPES);
    let foreign = format!("{OPAQUE}|{SHARED}|{STATUS}");
    let records = types().allowlist_type("Helfrich.*").blocklist_type(foreign);
    fs::write(out.join("records.rs"), structures(records))?;
    fs::write(out.join("layouts.rs"), structures(types().allowlist_type(SHARED)))?;
    fs::write(out.join("shim.rs"), functions(SHIM))?;
    fs::write(out.join("exported.rs"), comparison(&core))?;
    let definitions = c_api.iter().map(definition).collect::<String>() + &created(&c_api);
    fs::write(out.join("c_api.rs"), definitions)
}

/// A function that a header declares.
struct Function<'a> {
    name: &'a str,
    /// Attributes with its comment.
    comment: String,
    /// Name and type of each.
    arguments: Vec<(&'a str, &'a str)>,
    /// With its arrow; empty if there is none.
    result: &'a str,
}

impl Function<'_> {
    /// The force class that has scalars, and what the function does with it.
    fn of_force(&self) -> Option<(&str, &str)> {
        let names = self.name.strip_prefix("Helfrich_")?.split_once('_')?;
        (names.0.ends_with("Force") && names.0 != "MembraneForce").then_some(names)
    }

    /// The arguments of a type behind the triangles and their number.
    fn of_type(&self, wanted: &str) -> Vec<&str> {
        let chosen = self.arguments.iter().skip(2).filter(|(_, kind)| *kind == wanted);
        chosen.map(|(name, _)| *name).collect()
    }
}

/// The functions in bindgen's text.
fn parsed(text: &str) -> Vec<Function<'_>> {
    let mut found = Vec::new();
    let mut comment = "";
    for part in text.split("pub fn ") {
        if let Some((name, rest)) = part.split_once('(')
            && let Some((arguments, rest)) = rest.split_once(')')
            && let Some((result, _)) = rest.split_once(';')
        {
            let arguments = arguments.split(',').filter_map(|argument| argument.split_once(':'));
            found.push(Function {
                name,
                comment: comment
                    .lines()
                    .filter(|line| line.trim_start().starts_with("#[doc"))
                    .collect(),
                arguments: arguments.map(|(name, kind)| (name.trim(), kind.trim())).collect(),
                result: result.trim(),
            });
        }
        comment = part.rsplit_once(';').map_or(part, |(_, rest)| rest);
    }
    found
}

/// The names of fields as Rust writes them.
fn with_snake_fields(records: &str) -> String {
    let mut text = String::new();
    for line in records.lines() {
        match line.strip_prefix("    pub ").and_then(|rest| rest.split_once(':')) {
            Some((field, kind)) => {
                text += &format!("    pub {}:{kind}\n", snake(field));
            }
            None => text += &format!("{line}\n"),
        }
    }
    text
}

fn snake(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        if letter.is_ascii_uppercase() {
            text.push('_');
        }
        text.push(letter.to_ascii_lowercase());
    }
    text
}

/// Constants that compile only if Rust has functions of these names with these types.
fn comparison(functions: &[Function]) -> String {
    let mut text = String::new();
    for Function { name, arguments, result, .. } in functions {
        let kinds: Vec<_> = arguments.iter().map(|(_, kind)| *kind).collect();
        text += &format!(
            "const _: unsafe extern \"C\" fn({}) {result} = exported::{name};\n",
            kinds.join(", ")
        );
    }
    let names: Vec<_> = functions.iter().map(|function| format!("{:?}", function.name)).collect();
    text + &format!("#[cfg(test)]\nconst NAMES: &[&str] = &[{}];\n", names.join(", "))
}

/// The force classes with the scalars that their `create` takes, for a test.
fn created(c_api: &[Function]) -> String {
    let mut text = "#[cfg(test)]\nconst CREATED: &[(&str, &[&str])] = &[".to_owned();
    for function in c_api {
        if let Some((class, "create")) = function.of_force() {
            text += &format!("({class:?}, &{:?}), ", function.of_type("f64"));
        }
    }
    text + "];\n"
}

/// A function of the C API, by one of the macros of `src/ffi/c_api.rs`: scalars are told by their names, and all else
/// is passed on.
fn definition(function: &Function) -> String {
    let Function { name, comment, arguments, result } = function;
    if let Some((class, verb)) = function.of_force() {
        let scalar = |verb: &str| verb[..1].to_ascii_lowercase() + &verb[1..];
        let (scalars, form) = (function.of_type("f64"), function.of_type("std::ffi::c_int"));
        match (verb, verb.split_at(verb.len().min(3)), &arguments[..]) {
            ("create", ..) => {
                let (scalars, form) = (scalars.join(", "), form.join(", "));
                return format!("create! {{ {comment} {name} {class}({scalars}) {form} }}\n");
            }
            (_, ("get", of), [_]) => {
                return format!("get! {{ {comment} {name} {class} {} }}\n", scalar(of));
            }
            (_, ("set", of), [_, (_, "f64")]) => {
                return format!("set! {{ {comment} {name} {class} {} }}\n", scalar(of));
            }
            _ => {}
        }
    }
    let shim = name.replacen("Helfrich_", "helfrich_shim_", 1);
    let arguments: Vec<_> =
        arguments.iter().map(|(name, kind)| format!("{name}: {kind}")).collect();
    format!("forward! {{ {comment} {name} => {shim}({}) {result} }}\n", arguments.join(", "))
}
