//! Functions and entry points: their parameters, and the variables of a function.

use super::Text;
use super::types::type_name;
use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{
    AddressSpace, ArraySize, BuiltIn, Function, GlobalVariable, Handle, LocalVariable, Module,
    Type, TypeInner,
};
use std::fmt::Write;

pub fn name_of(name: &Option<String>) -> String {
    format!("h_{}", name.as_deref().unwrap_or("unnamed"))
}

/// Writes one function.
pub struct Writer<'a> {
    pub(super) module: &'a Module,
    pub(super) info: &'a FunctionInfo,
    pub(super) all: &'a ModuleInfo,
    pub(super) function: &'a Function,
}

impl Writer<'_> {
    /// The buffers and workgroup variables that a function uses, itself or through others.
    pub(super) fn globals(&self, info: &FunctionInfo) -> Vec<Handle<GlobalVariable>> {
        let variables = self.module.global_variables.iter().map(|(handle, _)| handle);
        variables.filter(|handle| !info[*handle].is_empty()).collect()
    }

    pub(super) fn global_name(&self, handle: Handle<GlobalVariable>) -> String {
        name_of(&self.module.global_variables[handle].name)
    }

    pub(super) fn is_shared(&self, handle: Handle<GlobalVariable>) -> bool {
        self.module.global_variables[handle].space == AddressSpace::WorkGroup
    }

    /// What a global variable points to: its items if it is an array, else itself.
    pub(super) fn item_type(&self, handle: Handle<GlobalVariable>) -> Text {
        let ty = self.module.global_variables[handle].ty;
        match self.module.types[ty].inner {
            TypeInner::Array { base, .. } => type_name(self.module, base),
            _ => type_name(self.module, ty),
        }
    }

    pub(super) fn is_array(&self, handle: Handle<GlobalVariable>) -> bool {
        let ty = self.module.global_variables[handle].ty;
        matches!(self.module.types[ty].inner, TypeInner::Array { .. })
    }

    pub(super) fn parameter(&self, handle: Handle<GlobalVariable>) -> Text {
        let (item, name) = (self.item_type(handle)?, self.global_name(handle));
        Ok(match self.module.global_variables[handle].space {
            AddressSpace::WorkGroup => format!("LOCAL_ARG {item}* {name}"),
            AddressSpace::Storage { access } if access.contains(naga::StorageAccess::STORE) => {
                format!("GLOBAL {item}* {name}")
            }
            AddressSpace::Storage { .. } => format!("GLOBAL const {item}* {name}"),
            other => return Err(format!("OpenMM's dialect has no variable in {other:?}")),
        })
    }

    /// A kernel with all buffers as parameters. A block of OpenMM's has room for several groups, and blocks take turns, since
    /// OpenMM may start fewer than are asked for.
    pub(super) fn kernel(&self, name: &str) -> Text {
        let mut parameters = Vec::new();
        for (handle, variable) in self.module.global_variables.iter() {
            if variable.space != AddressSpace::WorkGroup {
                parameters.push(self.parameter(handle)?.replacen("* ", "* RESTRICT ", 1));
            }
        }
        let mut text = format!("KERNEL void {name}(int h_groups, {}) {{\n", parameters.join(", "));
        let mut arguments = Vec::new();
        let mut id = "";
        for argument in &self.function.arguments {
            match argument.binding {
                Some(naga::Binding::BuiltIn(BuiltIn::WorkGroupId)) => {
                    id = "h_u32_3 h_id = {{(h_u32) (first + h_part), 0, 0}};\n        ";
                    arguments.push("h_id".to_owned());
                }
                Some(naga::Binding::BuiltIn(BuiltIn::LocalInvocationIndex)) => {
                    arguments.push("LOCAL_ID%H_GROUP_SIZE".to_owned());
                }
                _ => return Err(format!("{name} has an argument that OpenMM's kernels lack")),
            }
        }
        for handle in self.globals(self.info) {
            let variable = self.global_name(handle);
            if !self.is_shared(handle) {
                arguments.push(variable);
                continue;
            }
            let item = self.item_type(handle)?;
            let ty = self.module.global_variables[handle].ty;
            let size = match self.module.types[ty].inner {
                TypeInner::Array { size: ArraySize::Constant(size), .. } => size.get(),
                _ => 1,
            };
            let _ = writeln!(text, "    LOCAL {item} {variable}[H_GROUPS_OF_BLOCK*{size}];");
            arguments.push(format!("{variable} + {size}*h_part"));
        }
        let _ = write!(
            text,
            "    const int h_part = LOCAL_ID/H_GROUP_SIZE, h_parts = LOCAL_SIZE/H_GROUP_SIZE;\n\
             \x20   for (int first = GROUP_ID*h_parts; first < h_groups; first += NUM_GROUPS*h_parts) {{\n\
             \x20       {}h_{name}_of_group({});\n\
             \x20       SYNC_THREADS\n    }}\n}}\n\n",
            id,
            arguments.join(", ")
        );
        Ok(text)
    }

    pub(super) fn function(&self, name: &str) -> Text {
        let result = match &self.function.result {
            Some(result) => type_name(self.module, result.ty)?,
            None => "void".to_owned(),
        };
        let mut parameters = Vec::new();
        for argument in &self.function.arguments {
            let (kind, name) = (type_name(self.module, argument.ty)?, name_of(&argument.name));
            parameters.push(format!("{kind} {name}"));
        }
        for handle in self.globals(self.info) {
            parameters.push(self.parameter(handle)?);
        }
        let list = if parameters.is_empty() { "void".to_owned() } else { parameters.join(", ") };
        let mut text = format!("DEVICE {result} {name}({list}) {{\n");
        for (handle, variable) in self.function.local_variables.iter() {
            let value = match variable.init {
                Some(init) => self.initial(init)?,
                None => self.zero(variable.ty)?,
            };
            let kind = type_name(self.module, variable.ty)?;
            let _ = writeln!(text, "    {kind} {} = {value};", self.local_name(handle));
        }
        self.block(&mut text, &self.function.body, 1)?;
        Ok(text + "}\n\n")
    }

    pub(super) fn local_name(&self, handle: Handle<LocalVariable>) -> String {
        let name = name_of(&self.function.local_variables[handle].name);
        format!("{name}_{}", handle.index())
    }

    pub(super) fn zero(&self, handle: Handle<Type>) -> Text {
        Ok(match self.module.types[handle].inner {
            TypeInner::Scalar(_) => "0".to_owned(),
            _ => format!("h_zero_{}()", type_name(self.module, handle)?),
        })
    }
}
