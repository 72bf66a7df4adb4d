//! Part of build.rs: what `src/potentials/codes.rs` and `src/evaluator/gpu/interface.rs` state, as WGSL, and the check
//! that a device lays it out as they do.

use crate::codes::{FORMS, Needs, UNSIGNED};
use crate::interface::{Binding, FieldInfo, FrameRecord, Item, NUMBERS, TermRecord, Wishes};
use naga::{Module, TypeInner};
use std::ffi::CStr;
use std::fmt::Write;

/// The constants, structures and bindings, for the head of a module.
pub fn declarations() -> String {
    let mut text = String::new();
    let mut constant = |name: &str, value: u32| {
        let _ = writeln!(text, "const {name} = {value}u;");
    };
    let needs = Needs::all();
    needs.iter_names().for_each(|(name, bit)| constant(name, bit.bits()));
    let wishes = Wishes::all();
    wishes.iter_names().for_each(|(name, bit)| constant(name, bit.bits()));
    NUMBERS.iter().for_each(|(name, value)| constant(name, *value));
    constant("UNSIGNED", UNSIGNED);
    for (_, _, prefix, names) in FORMS {
        let Some(prefix) = prefix else { continue };
        for (number, name) in names.iter().enumerate() {
            let name = snake_case(name).to_uppercase();
            constant(&format!("{prefix}_{name}"), number as u32);
        }
    }
    structure(&mut text, "Term", TermRecord::FIELDS, "");
    structure(&mut text, "Frame", FrameRecord::FIELDS, "    terms: array<Term>,\n");
    for (number, (name, access, item)) in Binding::INFO.into_iter().enumerate() {
        let (name, wgsl) = (snake(name), item.wgsl());
        let _ =
            writeln!(text, "@group(0) @binding({number}) var<storage, {access}> {name}: {wgsl};");
    }
    text
}

fn structure(text: &mut String, name: &str, fields: &[FieldInfo], rest: &str) {
    let _ = writeln!(text, "struct {name} {{");
    for (field, wgsl, _) in fields {
        let _ = writeln!(text, "    {field}: {wgsl},");
    }
    let _ = writeln!(text, "{rest}}}");
}

fn snake_case(name: &CStr) -> String {
    snake(&name.to_string_lossy())
}

/// "GompperKroll" as "gompper_kroll".
fn snake(name: &str) -> String {
    let mut result = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !result.is_empty() {
            result.push('_');
        }
        result.extend(letter.to_lowercase());
    }
    result
}

/// Refuse a module in which a record has gaps, or the items of a buffer have another size than on the processor.
pub fn check_layout(module: &Module, real: usize) -> Result<(), String> {
    let size = |(words, reals): (usize, usize)| 4 * words + real * reals;
    for (name, fields) in [("Term", TermRecord::FIELDS), ("Frame", FrameRecord::FIELDS)] {
        let found = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some(name));
        let Some(TypeInner::Struct { members, span }) = found.map(|(_, kind)| &kind.inner) else {
            return Err(format!("the shaders do not use the structure {name}"));
        };
        let mut offset = 0;
        for (member, (field, _, parts)) in members.iter().zip(fields) {
            if member.offset as usize != offset {
                return Err(format!(
                    "src/evaluator/gpu/interface.rs: {field} of {name} is written {offset} bytes from its begin, \
                     but devices read it at {}; reorder the fields, or pad them",
                    member.offset
                ));
            }
            offset += size(*parts);
        }
        let end = members.get(fields.len()).map_or(*span, |terms| terms.offset);
        if end as usize != offset {
            return Err(format!(
                "src/evaluator/gpu/interface.rs: {name} has {offset} bytes, but devices give it {end}; pad it"
            ));
        }
    }
    let mut layouter = naga::proc::Layouter::default();
    layouter.update(module.to_ctx()).map_err(|error| error.to_string())?;
    for (name, _, item) in Binding::INFO {
        let variables = || module.global_variables.iter().map(|(_, variable)| variable);
        let Some(variable) = variables().find(|v| v.name.as_ref() == Some(&snake(name))) else {
            return Err(format!("the shaders do not use the buffer {name}"));
        };
        let stride = match module.types[variable.ty].inner {
            TypeInner::Array { stride, .. } => stride,
            _ if item == Item::Frame => 0,
            _ => layouter[variable.ty].size,
        };
        if stride as usize != item.size(real) {
            return Err(format!(
                "src/evaluator/gpu/interface.rs: an item of {name} has {} bytes, but {stride} on devices",
                item.size(real)
            ));
        }
    }
    Ok(())
}
