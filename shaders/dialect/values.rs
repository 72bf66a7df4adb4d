//! Values, which have names where they are computed, and places, which pointers point to.

use super::functions::{Writer, name_of};
use super::types::{inner_name, scalar};
use super::{OfComponent, Text};
use naga::{
    ArraySize, BinaryOperator, Expression, Handle, Literal, MathFunction, RelationalFunction,
    ScalarKind, TypeInner, UnaryOperator,
};

impl Writer<'_> {
    pub(super) fn inner(&self, handle: Handle<Expression>) -> &TypeInner {
        self.info[handle].ty.inner_with(&self.module.types)
    }

    pub(super) fn type_of(&self, handle: Handle<Expression>) -> Text {
        let resolution = &self.info[handle].ty;
        let name = resolution.handle().and_then(|ty| self.module.types[ty].name.as_deref());
        inner_name(self.module, self.inner(handle), name)
    }

    pub(super) fn is_pointer(&self, handle: Handle<Expression>) -> bool {
        self.inner(handle).pointer_space().is_some()
    }

    /// Whether a value is of use where it is computed: what a variable begins as is written there.
    pub(super) fn is_used(&self, handle: Handle<Expression>) -> bool {
        let variables = self.function.local_variables.iter();
        let begins = variables.filter(|(_, variable)| variable.init == Some(handle)).count();
        self.info[handle].ref_count > begins
    }

    /// How many components a value has, if it is a vector.
    pub(super) fn components(&self, handle: Handle<Expression>) -> Option<u8> {
        match self.inner(handle) {
            TypeInner::Vector { size, .. } => Some(*size as u8),
            _ => None,
        }
    }

    /// The declaration of a value.
    pub(super) fn baked(&self, handle: Handle<Expression>) -> Text {
        let (kind, initial) = (self.type_of(handle)?, self.initial(handle)?);
        Ok(format!("const {kind} h_e{} = {initial};", handle.index()))
    }

    /// What a variable begins as.
    pub(super) fn initial(&self, handle: Handle<Expression>) -> Text {
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
    pub(super) fn value(&self, handle: Handle<Expression>) -> Text {
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
    pub(super) fn place(&self, handle: Handle<Expression>) -> Text {
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

pub fn number(literal: &Literal) -> Text {
    Ok(match literal {
        Literal::F32(x) if x.is_finite() => format!("{x:?}f"),
        Literal::F64(x) if x.is_finite() => format!("{x:?}"),
        Literal::U32(x) => format!("{x}u"),
        Literal::I32(x) => format!("{x}"),
        Literal::Bool(x) => format!("{x}"),
        other => return Err(format!("OpenMM's dialect has no number {other:?}")),
    })
}
