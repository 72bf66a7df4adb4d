//! Part of build.rs: writes a module as a program in the dialect of C that OpenMM compiles for OpenCL, CUDA and HIP.
//!
//! Vectors and arrays become structures around arrays of C, and operations on vectors one of each component, since
//! OpenCL and CUDA have no vectors in common. Buffers and the memory of workgroups are handed from function to
//! function, because OpenCL has no variables of programs. `openmm_prelude.c` begins each program with what differs
//! between the three, and `openmm_kernels.c` ends it with the kernels that only OpenMM's platforms need.

mod functions;
mod statements;
mod types;
mod values;

use functions::{Writer, name_of};
use naga::valid::ModuleInfo;
use naga::{Expression, Module};
use std::collections::HashSet;
use std::fmt::Write;
use types::definition;
use values::number;

type Text = Result<String, String>;

/// An expression for each component of a vector.
type OfComponent<'a> = dyn Fn(u8) -> Text + 'a;

/// Write all types, functions and entry points of a module. Functions that `integers` has, under their names in C, are taken
/// from there.
pub fn write(module: &Module, info: &ModuleInfo, integers: &str) -> Text {
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).map_err(|error| error.to_string())?;
    let mut text = String::new();
    // Types that differ in their names only are one in C.
    let mut known = HashSet::new();
    for (handle, kind) in module.types.iter() {
        let align = layouter[handle].alignment * 1u32;
        let definition = definition(module, handle, &kind.inner, align)?;
        if known.insert(definition.clone()) {
            text += &definition;
        }
    }
    // The host's own kernels read some of the constants.
    for (_, constant) in module.constants.iter() {
        if let (Some(name), Expression::Literal(literal)) =
            (&constant.name, &module.global_expressions[constant.init])
            && let Ok(number) = number(literal)
        {
            let _ = writeln!(text, "#define H_{name} {number}");
        }
    }
    let is_there = |name: &str| integers.contains(&format!(" {name}("));
    if module.functions.iter().any(|(_, function)| is_there(&name_of(&function.name))) {
        text += integers;
    }
    for (handle, function) in module.functions.iter() {
        let name = name_of(&function.name);
        if is_there(&name) {
            continue;
        }
        text += &Writer { module, info: &info[handle], all: info, function }.function(&name)?;
    }
    for (number, entry) in module.entry_points.iter().enumerate() {
        let info_here = info.get_entry_point(number);
        let writer = Writer { module, info: info_here, all: info, function: &entry.function };
        text += &writer.function(&format!("h_{}_of_group", entry.name))?;
        text += &writer.kernel(&entry.name)?;
    }
    Ok(text)
}
