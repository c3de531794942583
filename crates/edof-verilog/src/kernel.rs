//! The kernel as typed statements: loops unrolled, links and macros written out, names resolved.

use rust_hdl::prelude::ast::{
    VerilogBlock, VerilogBlockOrConditional as Otherwise, VerilogConditional, VerilogExpression as Source,
    VerilogLink, VerilogLinkDetails, VerilogMatch, VerilogStatement,
};

use crate::error::{EmitError, Fault};
use crate::expression::Expression;
use crate::scope::{Meaning, Role, Scope, SignalId, State};
use crate::source::{quote, rust_number};
use crate::types::Type;
use crate::typing::Typing;

/// A typed statement.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Statement {
    Comment(Note),
    Assign(Assign),
    If { test: Expression, then: Vec<Statement>, otherwise: Vec<Statement> },
    Case { subject: Expression, arms: Vec<Arm>, default: Option<Vec<Statement>> },
}

impl Statement {
    /// A comment without words.
    pub fn is_silent(&self) -> bool {
        matches!(self, Self::Comment(note) if note.text.is_empty())
    }
}

/// What the kernel says of the statement behind it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Note {
    /// The Rust file, and the line in it.
    pub file: String,
    pub line: Option<usize>,
    /// What its comment says.
    pub text: String,
    /// The text is a statement of its own, not a comment.
    is_own: bool,
}

impl Note {
    /// The label of a last arm, which Verilog calls `default`.
    pub fn label(&self) -> Option<&str> {
        (self.is_own && !self.text.contains('\n')).then_some(self.text.as_str())
    }

    fn own(text: &str) -> Self {
        let lines = text.trim().trim_matches('"').lines().map(str::trim);
        Self { file: String::new(), line: None, text: lines.collect::<Vec<_>>().join("\n"), is_own: true }
    }

    /// Reads a mark of `#[kernel]`, `… "@ src/uart.rs:143 What the step reads.`, or any other comment.
    fn of(comment: &str) -> Self {
        let mark = comment.split_once("\"@ ").map(|(_, mark)| mark.trim_end_matches('"'));
        let (place, text) = mark.map_or(("", ""), |mark| mark.split_once(' ').unwrap_or((mark, "")));
        let (file, line) = place.rsplit_once(':').unwrap_or_default();
        match line.parse() {
            Ok(line) => Self { file: file.into(), line: Some(line), text: text.into(), is_own: false },
            Err(_) => Self::own(comment),
        }
    }

    /// One note of two that follow each other.
    fn and(self, next: Self) -> Self {
        let (file, line) = if next.line.is_some() { (next.file, next.line) } else { (self.file, self.line) };
        let (text, is_own) =
            if self.is_own && !next.is_own { (self.text, true) } else { (next.text, next.is_own) };
        Self { file, line, text, is_own }
    }
}

/// A target and its new value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Assign {
    pub target: SignalId,
    /// First bit, where only a part is written.
    pub at: Option<usize>,
    pub value: Expression,
    /// From `dff_setup!`: the register holds.
    pub holds: bool,
}

/// One arm of a match.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Arm {
    pub label: Label,
    pub body: Vec<Statement>,
}

/// What an arm matches.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Label {
    State(State),
    Number(i128),
}

/// The statements of a kernel.
pub(crate) fn lower(scope: &Scope, kernel: &VerilogBlock) -> Result<Vec<Statement>, EmitError> {
    let mut lowering = Lowering { scope, loops: vec![], macros: 0 };
    Ok(each_with_its_line(lowering.block(kernel)?))
}

/// The statements that one line of the kernel makes, for instance a loop, all with its note.
fn each_with_its_line(statements: Vec<Statement>) -> Vec<Statement> {
    let mut known: Option<Note> = None;
    let mut all: Vec<Statement> = vec![];
    for statement in statements {
        match &statement {
            Statement::Comment(note) => {
                known = note.line.map(|_| Note { text: String::new(), ..note.clone() });
            }
            _ if matches!(all.last(), Some(Statement::Comment(_))) => {}
            _ => all.extend(known.clone().map(Statement::Comment)),
        }
        all.push(statement);
    }
    all
}

struct Lowering<'a> {
    scope: &'a Scope,
    loops: Vec<(String, i128)>,
    macros: usize,
}

type Lowered = Result<Vec<Statement>, EmitError>;

impl Lowering<'_> {
    fn typing(&self) -> Typing<'_> {
        Typing { scope: self.scope, loops: &self.loops }
    }

    fn refuse(&self, field: &str, fault: Fault) -> EmitError {
        EmitError::field(&self.scope.path, field, fault)
    }

    fn block(&mut self, block: &VerilogBlock) -> Lowered {
        let mut statements = vec![];
        for statement in block {
            for statement in self.statement(statement)? {
                match (statement, statements.last_mut()) {
                    (Statement::Comment(next), Some(Statement::Comment(note))) => {
                        *note = std::mem::take(note).and(next);
                    }
                    (statement, _) => statements.push(statement),
                }
            }
        }
        Ok(statements)
    }

    fn statement(&mut self, statement: &VerilogStatement) -> Lowered {
        match statement {
            VerilogStatement::Comment(text) => Ok(vec![Statement::Comment(Note::of(text))]),
            VerilogStatement::Assignment(target, value) => Ok(vec![self.assign(target, value)?]),
            VerilogStatement::SliceAssignment { base, width, offset, replacement } => {
                Ok(vec![self.assign_part(base, *width, offset, replacement)?])
            }
            VerilogStatement::If(condition) => self.condition(condition),
            VerilogStatement::Match(choice) => self.choice(choice),
            VerilogStatement::Loop(turns) => {
                let mut statements = vec![];
                for turn in turns.from.as_usize()..turns.to.as_usize() {
                    self.loops.push((turns.index.clone(), turn as i128));
                    let body = self.block(&turns.block);
                    self.loops.pop();
                    statements.extend(body?);
                }
                Ok(statements)
            }
            VerilogStatement::Link(links) => links.iter().map(|link| self.link(link)).collect(),
            VerilogStatement::Macro(block) => {
                self.macros += 1;
                let statements = self.block(block);
                self.macros -= 1;
                statements
            }
        }
    }

    /// The signal that an assignment drives.
    fn target(&self, source: &Source) -> Result<SignalId, EmitError> {
        let Source::Signal(name) = source else {
            let reason = "only signals can be driven";
            return Err(self.refuse("", Fault::Operand { expression: quote(source), reason }));
        };
        match self.scope.meaning(name, &self.loops).map_err(|fault| self.refuse(name, fault))? {
            Meaning::Signal(id) => match self.scope.signals[id].role {
                Role::Input | Role::Constant(_) | Role::Register | Role::PartOutput => {
                    Err(self.refuse(name, Fault::NotDrivable))
                }
                _ => Ok(id),
            },
            _ => Err(self.refuse(name, Fault::NotDrivable)),
        }
    }

    fn assign(&self, target: &Source, value: &Source) -> Result<Statement, EmitError> {
        let target = self.target(target)?;
        let signal = &self.scope.signals[target];
        let value = self.typing().value(value, signal.ty).map_err(|fault| self.refuse(&signal.key, fault))?;
        let holds = self.macros > 0 && signal.role == Role::Next;
        Ok(Statement::Assign(Assign { target, at: None, value, holds }))
    }

    fn assign_part(
        &self,
        base: &Source,
        bits: usize,
        at: &Source,
        value: &Source,
    ) -> Result<Statement, EmitError> {
        let target = self.target(base)?;
        let signal = &self.scope.signals[target];
        let refuse = |fault| self.refuse(&signal.key, fault);
        let place = self.typing().number(at).map_err(refuse)?;
        let inside = |at: &i128| *at >= 0 && at + bits as i128 <= signal.ty.bits as i128;
        let at = place.filter(inside).ok_or_else(|| refuse(Fault::OutOfRange(quote(at))))?;
        let value = self.typing().value(value, Type::bits(bits)).map_err(refuse)?;
        Ok(Statement::Assign(Assign { target, at: Some(at as usize), value, holds: false }))
    }

    fn link(&self, link: &VerilogLink) -> Result<Statement, EmitError> {
        let end = |side: &str, details: &VerilogLinkDetails| {
            let field = details.my_name.trim_start_matches('.');
            Source::Signal(if field.is_empty() { side.into() } else { format!("{side}.{field}") })
        };
        match link {
            VerilogLink::Forward(link) => {
                self.assign(&end(&link.other_name, link), &end(&link.owner_name, link))
            }
            VerilogLink::Backward(link) => {
                self.assign(&end(&link.owner_name, link), &end(&link.other_name, link))
            }
            VerilogLink::Bidirectional(link) => Err(self.refuse(&link.owner_name, Fault::InOut)),
        }
    }

    fn condition(&mut self, condition: &VerilogConditional) -> Lowered {
        let test = self.typing().value(&condition.test, Type::BIT).map_err(|fault| self.refuse("", fault))?;
        if let Some(known) = test.constant() {
            return if known == 1 {
                self.block(&condition.then)
            } else {
                self.otherwise(&condition.otherwise)
            };
        }
        let (then, otherwise) = (self.block(&condition.then)?, self.otherwise(&condition.otherwise)?);
        Ok(vec![Statement::If { test, then, otherwise }])
    }

    fn otherwise(&mut self, otherwise: &Otherwise) -> Lowered {
        match otherwise {
            Otherwise::Block(block) => self.block(block),
            Otherwise::Conditional(statement) => self.statement(statement),
            Otherwise::None => Ok(vec![]),
        }
    }

    fn choice(&mut self, choice: &VerilogMatch) -> Lowered {
        if let Some(number) = self.typing().number(&choice.test).map_err(|fault| self.refuse("", fault))? {
            return self.known_choice(choice, number);
        }
        let subject = self.typing().subject(&choice.test).map_err(|fault| self.refuse("", fault))?;
        let (mut arms, mut default) = (vec![], None);
        for case in &choice.cases {
            let body = self.block(&case.block)?;
            if case.condition == "default" {
                default = Some(body);
                break;
            }
            arms.push(Arm { label: self.label(&case.condition, subject.ty)?, body });
        }
        if default.is_none() && is_exhaustive(&arms, subject.ty) {
            default = arms.pop().map(last_as_default);
        }
        Ok(vec![Statement::Case { subject, arms, default }])
    }

    /// A match on a loop variable.
    fn known_choice(&mut self, choice: &VerilogMatch, number: i128) -> Lowered {
        for case in &choice.cases {
            if case.condition == "default" || rust_number(&case.condition) == Some(number) {
                return self.block(&case.block);
            }
        }
        Ok(vec![])
    }

    fn label(&self, pattern: &str, ty: Type) -> Result<Label, EmitError> {
        let fault = || self.refuse("", Fault::Pattern(crate::error::rust_path(pattern)));
        if let Some(number) = rust_number(pattern) {
            let misfit = || self.refuse("", Fault::Misfit { value: pattern.into(), wanted: ty });
            return if ty.holds(number) { Ok(Label::Number(number)) } else { Err(misfit()) };
        }
        match self.scope.meaning(pattern, &[]) {
            Ok(Meaning::State(state)) if state.bits == ty.bits => Ok(Label::State(state.clone())),
            _ => Err(fault()),
        }
    }
}

/// Whether the arms name every state, or every value.
fn is_exhaustive(arms: &[Arm], ty: Type) -> bool {
    let values = if ty.bits < 16 { 1 << ty.bits } else { usize::MAX };
    match arms.last().map(|arm| &arm.label) {
        Some(Label::State(state)) => arms.len() == state.of,
        Some(Label::Number(_)) => arms.len() == values,
        None => false,
    }
}

/// The last arm of a match without `_` covers also what no state is encoded as.
fn last_as_default(arm: Arm) -> Vec<Statement> {
    let note = match arm.label {
        Label::State(state) => state.constant(),
        Label::Number(number) => number.to_string(),
    };
    std::iter::once(Statement::Comment(Note::own(&note))).chain(arm.body).collect()
}
