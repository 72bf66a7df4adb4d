//! Statements.

use super::functions::{Writer, name_of};
use naga::{AtomicFunction, Block, Expression, Handle, Statement, SwitchValue};
use std::fmt::Write;

impl Writer<'_> {
    pub(super) fn block(
        &self,
        text: &mut String,
        block: &Block,
        depth: usize,
    ) -> Result<(), String> {
        block.iter().try_for_each(|statement| self.statement(text, statement, depth))
    }

    pub(super) fn statement(
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
    pub(super) fn between(
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
