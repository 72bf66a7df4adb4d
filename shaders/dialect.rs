//! Part of build.rs: writes a module as a program in the dialect of C that OpenMM compiles for OpenCL, CUDA and HIP.
//!
//! Vectors and arrays become structures around arrays of C, and operations on vectors one of each component, since
//! OpenCL and CUDA have no vectors in common. Buffers and the memory of workgroups are handed from function to
//! function, because OpenCL has no variables of programs. `openmm_prelude.c` begins each program with what differs
//! between the three, and `openmm_kernels.c` ends it with the kernels that only OpenMM's platforms need.

use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{
    AddressSpace, ArraySize, AtomicFunction, BinaryOperator, Block, BuiltIn, Expression, Function,
    GlobalVariable, Handle, Literal, LocalVariable, MathFunction, Module, RelationalFunction,
    ScalarKind, Statement, SwitchValue, Type, TypeInner, UnaryOperator,
};
use std::collections::HashSet;
use std::fmt::Write;

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

fn name_of(name: &Option<String>) -> String {
    format!("h_{}", name.as_deref().unwrap_or("unnamed"))
}

fn scalar(kind: ScalarKind, width: u8) -> Text {
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
fn type_name(module: &Module, handle: Handle<Type>) -> Text {
    inner_name(module, &module.types[handle].inner, module.types[handle].name.as_deref())
}

fn inner_name(module: &Module, inner: &TypeInner, name: Option<&str>) -> Text {
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
fn definition(module: &Module, handle: Handle<Type>, inner: &TypeInner, align: u32) -> Text {
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

/// Writes one function.
struct Writer<'a> {
    module: &'a Module,
    info: &'a FunctionInfo,
    all: &'a ModuleInfo,
    function: &'a Function,
}

impl Writer<'_> {
    /// The buffers and workgroup variables that a function uses, itself or through others.
    fn globals(&self, info: &FunctionInfo) -> Vec<Handle<GlobalVariable>> {
        let variables = self.module.global_variables.iter().map(|(handle, _)| handle);
        variables.filter(|handle| !info[*handle].is_empty()).collect()
    }

    fn global_name(&self, handle: Handle<GlobalVariable>) -> String {
        name_of(&self.module.global_variables[handle].name)
    }

    fn is_shared(&self, handle: Handle<GlobalVariable>) -> bool {
        self.module.global_variables[handle].space == AddressSpace::WorkGroup
    }

    /// What a global variable points to: its items if it is an array, else itself.
    fn item_type(&self, handle: Handle<GlobalVariable>) -> Text {
        let ty = self.module.global_variables[handle].ty;
        match self.module.types[ty].inner {
            TypeInner::Array { base, .. } => type_name(self.module, base),
            _ => type_name(self.module, ty),
        }
    }

    fn is_array(&self, handle: Handle<GlobalVariable>) -> bool {
        let ty = self.module.global_variables[handle].ty;
        matches!(self.module.types[ty].inner, TypeInner::Array { .. })
    }

    fn parameter(&self, handle: Handle<GlobalVariable>) -> Text {
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
    fn kernel(&self, name: &str) -> Text {
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

    fn function(&self, name: &str) -> Text {
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

    fn local_name(&self, handle: Handle<LocalVariable>) -> String {
        let name = name_of(&self.function.local_variables[handle].name);
        format!("{name}_{}", handle.index())
    }

    fn zero(&self, handle: Handle<Type>) -> Text {
        Ok(match self.module.types[handle].inner {
            TypeInner::Scalar(_) => "0".to_owned(),
            _ => format!("h_zero_{}()", type_name(self.module, handle)?),
        })
    }

    fn inner(&self, handle: Handle<Expression>) -> &TypeInner {
        self.info[handle].ty.inner_with(&self.module.types)
    }

    fn type_of(&self, handle: Handle<Expression>) -> Text {
        let resolution = &self.info[handle].ty;
        let name = resolution.handle().and_then(|ty| self.module.types[ty].name.as_deref());
        inner_name(self.module, self.inner(handle), name)
    }

    fn is_pointer(&self, handle: Handle<Expression>) -> bool {
        self.inner(handle).pointer_space().is_some()
    }

    /// Whether a value is of use where it is computed: what a variable begins as is written there.
    fn is_used(&self, handle: Handle<Expression>) -> bool {
        let variables = self.function.local_variables.iter();
        let begins = variables.filter(|(_, variable)| variable.init == Some(handle)).count();
        self.info[handle].ref_count > begins
    }

    /// How many components a value has, if it is a vector.
    fn components(&self, handle: Handle<Expression>) -> Option<u8> {
        match self.inner(handle) {
            TypeInner::Vector { size, .. } => Some(*size as u8),
            _ => None,
        }
    }

    fn block(&self, text: &mut String, block: &Block, depth: usize) -> Result<(), String> {
        block.iter().try_for_each(|statement| self.statement(text, statement, depth))
    }

    fn statement(
        &self,
        text: &mut String,
        statement: &Statement,
        depth: usize,
    ) -> Result<(), String> {
        let indent = "    ".repeat(depth);
        let mut line = |code: String| {
            let _ = writeln!(text, "{indent}{code}");
        };
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    if !self.is_pointer(handle) && self.is_used(handle) {
                        line(self.baked(handle)?);
                    }
                }
            }
            Statement::Block(block) => {
                line("{".to_owned());
                self.block(text, block, depth + 1)?;
                let _ = writeln!(text, "{indent}}}");
            }
            Statement::If { condition, accept, reject } => {
                line(format!("if ({}) {{", self.value(*condition)?));
                self.block(text, accept, depth + 1)?;
                if !reject.is_empty() {
                    let _ = writeln!(text, "{indent}}} else {{");
                    self.block(text, reject, depth + 1)?;
                }
                let _ = writeln!(text, "{indent}}}");
            }
            Statement::Switch { selector, cases } => {
                line(format!("switch ({}) {{", self.value(*selector)?));
                for case in cases {
                    let label = match case.value {
                        SwitchValue::I32(value) => format!("case {value}:"),
                        SwitchValue::U32(value) => format!("case {value}u:"),
                        SwitchValue::Default => "default:".to_owned(),
                    };
                    let _ = writeln!(text, "{indent}{label} {{");
                    self.block(text, &case.body, depth + 1)?;
                    let end = if case.fall_through { "" } else { " break;" };
                    let _ = writeln!(text, "{indent}}}{end}");
                }
                let _ = writeln!(text, "{indent}}}");
            }
            Statement::Loop { body, continuing, break_if } => {
                // A `continue` passes by what comes between two rounds, unless that is at the begin of the next.
                let first = has_continue(body).then(|| format!("h_first_{}", text.len()));
                if let Some(first) = &first {
                    let _ = writeln!(text, "{indent}bool {first} = true;\n{indent}for (;;) {{");
                    let _ = writeln!(text, "{indent}    if (!{first}) {{");
                    self.between(text, continuing, *break_if, depth + 2)?;
                    let _ = writeln!(text, "{indent}    }}\n{indent}    {first} = false;");
                    self.block(text, body, depth + 1)?;
                } else {
                    let _ = writeln!(text, "{indent}for (;;) {{");
                    self.block(text, body, depth + 1)?;
                    self.between(text, continuing, *break_if, depth + 1)?;
                }
                let _ = writeln!(text, "{indent}}}");
            }
            Statement::Break => line("break;".to_owned()),
            Statement::Continue => line("continue;".to_owned()),
            Statement::Return { value: None } => line("return;".to_owned()),
            Statement::Return { value: Some(value) } => {
                line(format!("return {};", self.value(*value)?))
            }
            Statement::ControlBarrier(_) => line("SYNC_THREADS".to_owned()),
            Statement::Store { pointer, value } => {
                line(format!("{} = {};", self.place(*pointer)?, self.value(*value)?));
            }
            // Nobody looks at the number before.
            Statement::Atomic { pointer, fun: AtomicFunction::Add, value, .. } => {
                line(format!("H_COUNT(&{}, {});", self.place(*pointer)?, self.value(*value)?));
            }
            Statement::Call { function, arguments, result } => {
                let callee = &self.module.functions[*function];
                let mut values = Vec::new();
                for argument in arguments {
                    values.push(if self.is_pointer(*argument) {
                        format!("&{}", self.place(*argument)?)
                    } else {
                        self.value(*argument)?
                    });
                }
                values.extend(
                    self.globals(&self.all[*function]).into_iter().map(|g| self.global_name(g)),
                );
                let call = format!("{}({});", name_of(&callee.name), values.join(", "));
                match result {
                    Some(result) if self.is_used(*result) => line(format!(
                        "const {} h_e{} = {call}",
                        self.type_of(*result)?,
                        result.index()
                    )),
                    _ => line(call),
                }
            }
            other => return Err(format!("OpenMM's dialect has no statement {other:?}")),
        }
        Ok(())
    }

    /// What comes between two rounds of a loop.
    fn between(
        &self,
        text: &mut String,
        continuing: &Block,
        break_if: Option<Handle<Expression>>,
        depth: usize,
    ) -> Result<(), String> {
        self.block(text, continuing, depth)?;
        if let Some(condition) = break_if {
            let _ =
                writeln!(text, "{}if ({}) break;", "    ".repeat(depth), self.value(condition)?);
        }
        Ok(())
    }

    /// The declaration of a value.
    fn baked(&self, handle: Handle<Expression>) -> Text {
        let (kind, initial) = (self.type_of(handle)?, self.initial(handle)?);
        Ok(format!("const {kind} h_e{} = {initial};", handle.index()))
    }

    /// What a variable begins as.
    fn initial(&self, handle: Handle<Expression>) -> Text {
        if self.function.expressions[handle].needs_pre_emit() {
            return self.value(handle);
        }
        let pieces = self.pieces(handle)?;
        if let [Piece::Whole(value)] = pieces.as_slice() {
            return Ok(value.clone());
        }
        let list: Vec<_> = pieces.iter().map(Piece::text).collect();
        Ok(match self.inner(handle) {
            TypeInner::Struct { .. } => format!("{{{}}}", list.join(", ")),
            // A structure around an array.
            _ => format!("{{{{{}}}}}", list.join(", ")),
        })
    }

    /// A value: its name, or what it is if it has none.
    fn value(&self, handle: Handle<Expression>) -> Text {
        Ok(match &self.function.expressions[handle] {
            Expression::Literal(literal) => number(literal)?,
            Expression::Constant(constant) => {
                let init = self.module.constants[*constant].init;
                match &self.module.global_expressions[init] {
                    Expression::Literal(literal) => number(literal)?,
                    other => return Err(format!("a constant is {other:?}, and not a number")),
                }
            }
            Expression::ZeroValue(ty) => self.zero(*ty)?,
            Expression::FunctionArgument(index) => {
                name_of(&self.function.arguments[*index as usize].name)
            }
            _ => format!("h_e{}", handle.index()),
        })
    }

    /// A component of a value that may be a scalar, which stands for all.
    fn component(&self, handle: Handle<Expression>, k: u8) -> Text {
        let value = self.value(handle)?;
        Ok(if self.components(handle).is_some() { format!("{value}.c[{k}]") } else { value })
    }

    /// What a pointer points to.
    fn place(&self, handle: Handle<Expression>) -> Text {
        Ok(match &self.function.expressions[handle] {
            Expression::GlobalVariable(global) => {
                let name = self.global_name(*global);
                if self.is_array(*global) { name } else { format!("(*{name})") }
            }
            Expression::LocalVariable(local) => self.local_name(*local),
            Expression::FunctionArgument(_) => format!("(*{})", self.value(handle)?),
            Expression::Access { base, index } => {
                format!("{}[{}]", self.items(*base)?, self.value(*index)?)
            }
            Expression::AccessIndex { base, index } => {
                self.member(self.place(*base)?, *base, *index)?
            }
            other => return Err(format!("OpenMM's dialect has no pointer {other:?}")),
        })
    }

    /// The array of C that a pointer's target consists of.
    fn items(&self, base: Handle<Expression>) -> Text {
        let place = self.place(base)?;
        if self.is_global_array(base) {
            return Ok(place);
        }
        self.array_in(place, self.target(base)?)
    }

    /// Whether a pointer is to a variable that C knows by the address of its first item.
    fn is_global_array(&self, pointer: Handle<Expression>) -> bool {
        let expression = &self.function.expressions[pointer];
        matches!(expression, Expression::GlobalVariable(global) if self.is_array(*global))
    }

    fn array_in(&self, place: String, inner: &TypeInner) -> Text {
        Ok(match inner {
            TypeInner::Vector { .. } => format!("{place}.c"),
            TypeInner::Array { size: ArraySize::Constant(_), .. } => format!("{place}.a"),
            TypeInner::Array { .. } => place,
            other => return Err(format!("{other:?} has no items")),
        })
    }

    /// The type that a pointer points to, or of a value.
    fn target(&self, handle: Handle<Expression>) -> Result<&TypeInner, String> {
        match self.inner(handle) {
            TypeInner::Pointer { base, .. } => Ok(&self.module.types[*base].inner),
            // A pointer to a component.
            TypeInner::ValuePointer { .. } => Err("a component has no items".to_owned()),
            inner => Ok(inner),
        }
    }

    fn member(&self, whole: String, base: Handle<Expression>, index: u32) -> Text {
        let inner = self.target(base)?;
        if let TypeInner::Struct { members, .. } = inner {
            let name = members[index as usize].name.as_deref().unwrap_or_default();
            return Ok(format!("{whole}.h_{name}"));
        }
        if self.is_global_array(base) {
            return Ok(format!("{whole}[{index}]"));
        }
        Ok(format!("{}[{index}]", self.array_in(whole, inner)?))
    }

    /// An expression: one piece, or one for each component.
    fn pieces(&self, handle: Handle<Expression>) -> Result<Vec<Piece>, String> {
        let size = self.components(handle);
        let each = |one: &OfComponent| -> Result<Vec<Piece>, String> {
            match size {
                None => Ok(vec![Piece::Whole(one(0)?)]),
                Some(size) => (0..size).map(|k| one(k).map(Piece::Part)).collect(),
            }
        };
        let whole = |text: String| Ok(vec![Piece::Whole(text)]);
        match &self.function.expressions[handle] {
            Expression::Load { pointer } => whole(self.place(*pointer)?),
            Expression::Access { base, index } => {
                let items = self.array_in(self.value(*base)?, self.inner(*base))?;
                whole(format!("{items}[{}]", self.value(*index)?))
            }
            Expression::AccessIndex { base, index } => {
                whole(self.member(self.value(*base)?, *base, *index)?)
            }
            Expression::Compose { components, .. } => {
                let mut pieces = Vec::new();
                for component in components {
                    match (size, self.components(*component)) {
                        (Some(_), Some(count)) => {
                            for k in 0..count {
                                pieces.push(Piece::Part(self.component(*component, k)?));
                            }
                        }
                        _ => pieces.push(Piece::Part(self.value(*component)?)),
                    }
                }
                Ok(pieces)
            }
            Expression::Splat { value, .. } => each(&|_| self.value(*value)),
            Expression::Swizzle { vector, pattern, .. } => {
                each(&|k| self.component(*vector, pattern[usize::from(k)] as u8))
            }
            Expression::Unary { op, expr } => each(&|k| {
                let sign = match op {
                    UnaryOperator::Negate => "-",
                    UnaryOperator::LogicalNot => "!",
                    UnaryOperator::BitwiseNot => "~",
                };
                Ok(format!("{sign}({})", self.component(*expr, k)?))
            }),
            Expression::Binary { op, left, right } => each(&|k| {
                let (left, right) = (self.component(*left, k)?, self.component(*right, k)?);
                Ok(format!("{left} {} {right}", operator(*op)))
            }),
            Expression::Select { condition, accept, reject } => {
                if self.components(*condition).is_none() {
                    let (accept, reject) = (self.value(*accept)?, self.value(*reject)?);
                    return whole(format!("{} ? {accept} : {reject}", self.value(*condition)?));
                }
                each(&|k| {
                    let condition = self.component(*condition, k)?;
                    let (accept, reject) =
                        (self.component(*accept, k)?, self.component(*reject, k)?);
                    Ok(format!("{condition} ? {accept} : {reject}"))
                })
            }
            Expression::Relational { fun, argument } => {
                let join = match fun {
                    RelationalFunction::All => " && ",
                    RelationalFunction::Any => " || ",
                    other => return Err(format!("OpenMM's dialect has no {other:?}")),
                };
                let count = self.components(*argument).unwrap_or(1);
                let parts: Result<Vec<_>, _> =
                    (0..count).map(|k| self.component(*argument, k)).collect();
                whole(parts?.join(join))
            }
            Expression::As { expr, kind, convert } => each(&|k| {
                let value = self.component(*expr, k)?;
                let from = self.inner(*expr).scalar().ok_or("a cast of what is no number")?;
                match (convert, from.kind, kind) {
                    (Some(width), _, _) => Ok(format!("({}) ({value})", scalar(*kind, *width)?)),
                    (None, ScalarKind::Float, ScalarKind::Uint) => {
                        Ok(format!("H_AS_UINT({value})"))
                    }
                    (None, ScalarKind::Uint, ScalarKind::Float) => {
                        Ok(format!("H_AS_FLOAT({value})"))
                    }
                    (
                        None,
                        ScalarKind::Sint | ScalarKind::Uint,
                        ScalarKind::Sint | ScalarKind::Uint,
                    ) => Ok(format!("({}) ({value})", scalar(*kind, from.width)?)),
                    _ => Err(format!("OpenMM's dialect does not read {from:?} as {kind:?}")),
                }
            }),
            Expression::Math { fun, arg, arg1, .. } => self.math(*fun, *arg, *arg1, &each),
            other => Err(format!("OpenMM's dialect has no expression {other:?}")),
        }
    }

    fn math(
        &self,
        fun: MathFunction,
        arg: Handle<Expression>,
        arg1: Option<Handle<Expression>>,
        each: &dyn Fn(&OfComponent) -> Result<Vec<Piece>, String>,
    ) -> Result<Vec<Piece>, String> {
        let kind = self.inner(arg).scalar().ok_or("a function of what is no number")?;
        let is_float = kind.kind == ScalarKind::Float;
        let other = || arg1.ok_or_else(|| format!("{fun:?} wants two arguments"));
        let call = |name: &str| {
            let name = name.to_owned();
            each(&|k| {
                let first = self.component(arg, k)?;
                Ok(match arg1 {
                    Some(second) => format!("{name}({first}, {})", self.component(second, k)?),
                    None => format!("{name}({first})"),
                })
            })
        };
        match fun {
            MathFunction::Dot => {
                let second = other()?;
                let count = self.components(arg).unwrap_or(1);
                let terms: Result<Vec<_>, String> = (0..count)
                    .map(|k| {
                        Ok(format!("{}*{}", self.component(arg, k)?, self.component(second, k)?))
                    })
                    .collect();
                Ok(vec![Piece::Whole(terms?.join(" + "))])
            }
            MathFunction::Cross => {
                let second = other()?;
                each(&|k| {
                    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                    let (a, b) = (self.component(arg, i)?, self.component(second, j)?);
                    let (c, d) = (self.component(arg, j)?, self.component(second, i)?);
                    Ok(format!("{a}*{b} - {c}*{d}"))
                })
            }
            MathFunction::Min if is_float => call(if kind.width == 4 { "H_MIN32" } else { "fmin" }),
            MathFunction::Max if is_float => call(if kind.width == 4 { "H_MAX32" } else { "fmax" }),
            MathFunction::Min => call("min"),
            MathFunction::Max => call("max"),
            MathFunction::Abs if is_float => call(if kind.width == 4 { "H_ABS32" } else { "fabs" }),
            MathFunction::Sqrt => call(if kind.width == 4 { "H_SQRT32" } else { "sqrt" }),
            MathFunction::Round => call(if kind.width == 4 { "H_ROUND32" } else { "rint" }),
            MathFunction::Sign if is_float => {
                each(&|k| self.component(arg, k).map(|x| format!("({x} > 0) - ({x} < 0)")))
            }
            MathFunction::CountLeadingZeros => call("H_LEADING_ZEROS"),
            other => Err(format!("OpenMM's dialect has no function {other:?}")),
        }
    }
}

/// Whether a block goes on with the next round of the loop around it.
fn has_continue(block: &Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Continue => true,
        Statement::Block(block) => has_continue(block),
        Statement::If { accept, reject, .. } => has_continue(accept) || has_continue(reject),
        Statement::Switch { cases, .. } => cases.iter().any(|case| has_continue(&case.body)),
        _ => false,
    })
}

/// Part of a value.
enum Piece {
    /// All of it.
    Whole(String),
    /// A component or member.
    Part(String),
}

impl Piece {
    fn text(&self) -> &str {
        match self {
            Self::Whole(text) | Self::Part(text) => text,
        }
    }
}

fn operator(operator: BinaryOperator) -> &'static str {
    match operator {
        BinaryOperator::Add => "+",
        BinaryOperator::Subtract => "-",
        BinaryOperator::Multiply => "*",
        BinaryOperator::Divide => "/",
        BinaryOperator::Modulo => "%",
        BinaryOperator::Equal => "==",
        BinaryOperator::NotEqual => "!=",
        BinaryOperator::Less => "<",
        BinaryOperator::LessEqual => "<=",
        BinaryOperator::Greater => ">",
        BinaryOperator::GreaterEqual => ">=",
        BinaryOperator::And => "&",
        BinaryOperator::ExclusiveOr => "^",
        BinaryOperator::InclusiveOr => "|",
        BinaryOperator::LogicalAnd => "&&",
        BinaryOperator::LogicalOr => "||",
        BinaryOperator::ShiftLeft => "<<",
        BinaryOperator::ShiftRight => ">>",
    }
}

fn number(literal: &Literal) -> Text {
    Ok(match literal {
        Literal::F32(x) if x.is_finite() => format!("{x:?}f"),
        Literal::F64(x) if x.is_finite() => format!("{x:?}"),
        Literal::U32(x) => format!("{x}u"),
        Literal::I32(x) => format!("{x}"),
        Literal::Bool(x) => format!("{x}"),
        other => return Err(format!("OpenMM's dialect has no number {other:?}")),
    })
}
