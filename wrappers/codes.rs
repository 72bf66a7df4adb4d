//! Part of build.rs: C++ that compares the headers with `src/potentials/codes.rs`, `src/ffi/records.rs` and
//! `src/moves/records.rs`, so that the
//! build stops where they differ.

use crate::codes::{
    Attraction, Coefficients, Contribution, Form, MAX_PARAMETERS, Scheme, SpringForm,
};
use crate::interface::{Binding, NUMBERS};
use crate::move_records::{FlipRules, FlipState, SwapRules, SwapState};
use crate::records::{
    EdgeBath, FollowerInput, NativeBuffer, NativePass, NativePlan, ParameterInfo, ParticleArrays,
    SheetInput, TermInput, TurnInput,
};
use std::ffi::CStr;
use std::mem::offset_of;

/// Assertions on the size of a structure and on where its fields are.
macro_rules! structure {
    ($rust:ident, $cpp:literal, $($field:ident)*) => {
        structure($cpp, size_of::<$rust>(), &[$((stringify!($field), offset_of!($rust, $field))),*])
    };
}

/// A source that compiles only if the enumerations of the headers have the numbers of Rust's and no others, and the
/// structures the same layout.
pub fn comparison() -> String {
    let mut text = "#include <OpenMMHelfrich.h>\n#include <OpenMMHelfrichCWrapper.h>\n\
                    #include <HelfrichDynamics.h>\n#include <cstddef>\n"
        .to_owned();
    text += &format!(
        "static_assert(HELFRICH_MAX_PARAMETERS == {MAX_PARAMETERS}, \
         \"MAX_PARAMETERS is not what src/potentials/codes.rs says\");\n"
    );
    for (class, kind, names) in [
        ("BendingForce", "Scheme", Scheme::NAMES),
        ("DihedralForce", "Form", Form::NAMES),
        ("SpringForce", "Form", SpringForm::NAMES),
        ("ParticleSurfaceForce", "Attraction", Attraction::NAMES),
        ("LimForce", "Coefficients", Coefficients::NAMES),
    ] {
        let in_cpp = format!("HelfrichPlugin::{class}::");
        text += &enumeration(&format!("{in_cpp}{kind}"), &in_cpp, names);
        let in_c = format!("Helfrich_{class}_");
        text += &enumeration(&format!("{in_c}{kind}"), &in_c, names);
    }
    // Pointers of another machine may have another size.
    let width = std::env::var("CARGO_CFG_TARGET_POINTER_WIDTH").unwrap_or_default();
    if width == usize::BITS.to_string() {
        text += &structure!(ParameterInfo, "HelfrichParameterInfo", name energy length default_value per last);
        text += &structure!(Contribution, "HelfrichContribution", energy by_parameter);
        text += &structure!(
            ParticleArrays,
            "HelfrichParticleArrays",
            num_particles positions velocities forces
        );
        text += &structure!(EdgeBath, "HelfrichEdgeBath", friction kt lag);
        text += &structure!(SheetInput, "HelfrichSheet", corners num_triangles is_periodic);
        text += &structure!(
            FlipRules,
            "HelfrichFlipRules",
            temperature min_degree max_degree max_edge_length demon
        );
        text += &structure!(
            FlipState,
            "HelfrichFlipState",
            key attempts accepted by_border by_degree by_length by_shape by_energy by_edge demon_energy
        );
        text += &structure!(SwapRules, "HelfrichSwapRules", temperature demon);
        text += &structure!(
            SwapState,
            "HelfrichSwapState",
            key attempts accepted by_kind by_energy demon_energy
        );
        text += &structure!(
            TermInput,
            "HelfrichTerm",
            potential form switches wants_derivatives values fields field_lengths particles num_particles
            numbers
        );
        text += &structure!(
            TurnInput,
            "HelfrichTurn",
            subject membrane terms num_terms contributions box_vectors
        );
        text += &structure!(
            FollowerInput,
            "HelfrichFollower",
            membrane first_triangle terms num_terms
        );
        text += &structure!(
            NativeBuffer,
            "HelfrichNativeBuffer",
            item_size items data data_size version
        );
        text += &structure!(NativePass, "HelfrichNativePass", name groups);
        text += &structure!(
            NativePlan,
            "HelfrichNativePlan",
            num_buffers num_passes num_targets num_runs targets runs version extent unit num_vertices particles anchors
        );
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

fn structure(cpp: &str, size: usize, fields: &[(&str, usize)]) -> String {
    let differs = "has another layout in Rust";
    let mut text = format!("static_assert(sizeof({cpp}) == {size}, \"{cpp} {differs}\");\n");
    for (field, offset) in fields {
        let mut words = field.split('_');
        let mut name = words.next().unwrap_or_default().to_owned();
        for word in words {
            name += &word[..1].to_uppercase();
            name += &word[1..];
        }
        text += &format!(
            "static_assert(offsetof({cpp}, {name}) == {offset}, \"{cpp}::{name} {differs}\");\n"
        );
    }
    text
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
