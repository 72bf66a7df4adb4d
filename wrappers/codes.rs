//! Part of build.rs: C++ that compares the headers with `src/potentials/codes.rs`, so that the build stops where
//! they differ.

use crate::codes::{FORMS, MAX_PARAMETERS, Status};
use crate::interface::{Binding, NUMBERS};
use std::ffi::CStr;

/// A source that compiles only if the enumerations of the headers have the numbers of Rust's and no others.
pub fn comparison() -> String {
    let mut text = "#include <OpenMMHelfrich.h>\n#include <OpenMMHelfrichCWrapper.h>\n\
                    #include <HelfrichDynamics.h>\n#include <cstddef>\n"
        .to_owned();
    text += &format!(
        "static_assert(HELFRICH_MAX_PARAMETERS == {MAX_PARAMETERS}, \
         \"MAX_PARAMETERS is not what src/potentials/codes.rs says\");\n"
    );
    text += &enumeration("Helfrich_Status", "Helfrich_", Status::NAMES);
    for (class, kind, _, names) in FORMS {
        let in_cpp = format!("HelfrichPlugin::{class}::");
        text += &enumeration(&format!("{in_cpp}{kind}"), &in_cpp, names);
        let in_c = format!("Helfrich_{class}_");
        text += &enumeration(&format!("{in_c}{kind}"), &in_c, names);
    }
    text
}

/// A header with what C++ has to know of `src/evaluator/gpu/interface.rs`.
pub fn native_codes() -> String {
    let mut text = "// Written by build.rs from src/evaluator/gpu/interface.rs.\n#ifndef HELFRICH_NATIVE_CODES_H_\n\
                    #define HELFRICH_NATIVE_CODES_H_\n\nnamespace HelfrichPlugin {\nnamespace NativeCodes {\n"
        .to_owned();
    for (name, value) in NUMBERS {
        text += &format!("constexpr unsigned {name} = {value}u;\n");
    }
    text += "/** The buffers, in the order of their numbers. */\nenum Buffer {\n";
    for (name, ..) in Binding::INFO {
        text += &format!("    {name},\n");
    }
    text + "};\n} // namespace NativeCodes\n} // namespace HelfrichPlugin\n\n#endif\n"
}

/// Values by assertions; that there are no more by a switch, of which the compiler says what it lacks.
fn enumeration(kind: &str, prefix: &str, names: &[&CStr]) -> String {
    let (mut assertions, mut cases) = (String::new(), String::new());
    for (number, name) in names.iter().enumerate() {
        let name = name.to_string_lossy();
        assertions += &format!(
            "static_assert((int) {prefix}{name} == {number}, \
             \"{prefix}{name} is not what src/potentials/codes.rs says\");\n"
        );
        cases += &format!("        case {prefix}{name}: return true;\n");
    }
    format!(
        "{assertions}[[maybe_unused]] static bool isKnown({kind} value) {{\n    switch (value) {{\n{cases}    }}\n    \
         return false;\n}}\n"
    )
}
