//! Types of values and what declares them.

use super::Text;
use naga::{AddressSpace, ArraySize, Handle, Module, ScalarKind, Type, TypeInner};
use std::fmt::Write;

pub fn scalar(kind: ScalarKind, width: u8) -> Text {
    Ok(match (kind, width) {
        (ScalarKind::Bool, _) => "bool",
        (ScalarKind::Sint, 4) => "h_i32",
        (ScalarKind::Uint, 4) => "h_u32",
        (ScalarKind::Float, 4) => "h_f32",
        (ScalarKind::Float, 8) => "h_f64",
        _ => return Err(format!("OpenMM's dialect has no {kind:?} of {width} bytes")),
    }
    .to_owned())
}

/// The name of a type of values.
pub fn type_name(module: &Module, handle: Handle<Type>) -> Text {
    inner_name(module, &module.types[handle].inner, module.types[handle].name.as_deref())
}

pub fn inner_name(module: &Module, inner: &TypeInner, name: Option<&str>) -> Text {
    Ok(match inner {
        TypeInner::Scalar(s) | TypeInner::Atomic(s) => scalar(s.kind, s.width)?,
        TypeInner::Vector { size, scalar: s } => {
            format!("{}_{}", scalar(s.kind, s.width)?, *size as u8)
        }
        TypeInner::Array { base, size: ArraySize::Constant(size), .. } => {
            format!("{}_array{size}", type_name(module, *base)?)
        }
        TypeInner::Struct { .. } => format!("h_{}", name.unwrap_or("unnamed")),
        TypeInner::Pointer { base, space: AddressSpace::Function } => {
            format!("{}*", type_name(module, *base)?)
        }
        other => return Err(format!("OpenMM's dialect has no type {other:?}")),
    })
}

/// What declares a type before it is used; nothing for scalars and pointers.
pub fn definition(module: &Module, handle: Handle<Type>, inner: &TypeInner, align: u32) -> Text {
    let Ok(name) = type_name(module, handle) else { return Ok(String::new()) };
    let mut text = match inner {
        TypeInner::Vector { size, scalar: s } => {
            // No buffer has vectors of three.
            let align = if *size as u8 == 3 { u32::from(s.width) } else { align };
            format!("H_VECTOR({name}, {}, {}, {align})\n", scalar(s.kind, s.width)?, *size as u8)
        }
        TypeInner::Array { base, size: ArraySize::Constant(size), .. } => {
            format!("typedef struct {{ {} a[{size}]; }} {name};\n", type_name(module, *base)?)
        }
        TypeInner::Struct { members, .. } => {
            let mut text = "typedef struct {\n".to_owned();
            for member in members {
                let field = member.name.as_deref().unwrap_or_default();
                let _ = match module.types[member.ty].inner {
                    // The last member of a buffer, of which there are as many as the host has written.
                    TypeInner::Array { base, size: ArraySize::Dynamic, .. } => {
                        writeln!(text, "    {} h_{field}[1];", type_name(module, base)?)
                    }
                    _ => writeln!(text, "    {} h_{field};", type_name(module, member.ty)?),
                };
            }
            text + &format!("}} {name};\n")
        }
        _ => return Ok(String::new()),
    };
    let _ = writeln!(
        text,
        "DEVICE {name} h_zero_{name}(void) {{ {name} zero = H_ZERO; return zero; }}"
    );
    Ok(text)
}
