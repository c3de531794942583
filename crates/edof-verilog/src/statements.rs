//! Statements as the lines of a block.

use std::collections::{BTreeMap, BTreeSet};

use crate::expression::{Expression, Node};
use crate::kernel::{Arm, Assign, Label, Note, Statement};
use crate::layout::{PLACE, WIDTH, code};
use crate::print::{Between, Printer};
use crate::scope::{Role, SignalId};
use crate::text::{Use, literal, range};

/// A statement stands behind its condition or label as long as both are shorter than a line less the indentation that blocks have.
const SHORT: usize = WIDTH - 12;

/// Branches of an `if` that may do without `begin` and `end`.
const INLINE: usize = 4;

/// A condition, if any, and what it guards.
type Branch = (Option<String>, Vec<String>);

impl Printer<'_> {
    /// The lines of an `always @*` block.
    pub fn process(&mut self, statements: &[Statement], driven: &BTreeSet<SignalId>) -> Vec<String> {
        self.driven.clone_from(driven);
        self.steps.clear();
        self.line = None;
        let (first, rest) = match statements {
            [Statement::Comment(note), rest @ ..] => (self.note(note), rest),
            all => (vec![], all),
        };
        let place = self.line;
        let body = self.lines(rest);
        let start = |step: &usize| {
            let Between { name, ty, .. } = &self.between[*step];
            format!("{name} = {};", literal(*ty, 0, Use::Value))
        };
        let starts: Vec<String> = self.steps.iter().map(start).collect();
        let lines = [first, block("always @* begin", &[starts, body].concat())].concat();
        self.line = place;
        lines.into_iter().map(|line| self.placed(line)).collect()
    }

    /// The lines of a block at a clock's edge: statements, then registers that take their next value.
    pub fn edge(&mut self, clock: &str, statements: &[Statement], taken: &[(String, String)]) -> Vec<String> {
        self.driven.clear();
        self.line = None;
        self.at_edge = true;
        let mut body: Vec<String> = taken.iter().map(|(value, next)| format!("{value} <= {next};")).collect();
        body.extend(self.lines(statements));
        self.at_edge = false;
        self.line = statements.iter().find_map(|statement| match statement {
            Statement::Comment(note) => note.line,
            _ => None,
        });
        let lines = block(&format!("always @(posedge {clock}) begin"), &body);
        lines.into_iter().map(|line| self.placed(line)).collect()
    }

    fn lines(&mut self, statements: &[Statement]) -> Vec<String> {
        let rows = if self.at_edge { self.cleared_together(statements) } else { BTreeMap::new() };
        let mut lines = vec![];
        for (n, statement) in statements.iter().enumerate() {
            let new = match rows.get(&n) {
                Some(row) if row.len() > 1 => vec![self.cleared(row)],
                Some(row) if row.is_empty() => vec![],
                _ => self.statement(statement),
            };
            lines.extend(new.into_iter().map(|line| self.placed(line)));
        }
        lines
    }

    /// For each statement that clears a register, the registers that one row clears in its place: those of statements after it, too, and none in
    /// place of these. Only constants that other registers take, and no words, stand between them.
    fn cleared_together(&self, statements: &[Statement]) -> BTreeMap<usize, Vec<SignalId>> {
        let is_constant = |value: &Expression| match value.node {
            Node::Signal(id) => matches!(self.scope.signals[id].role, Role::Constant(_)),
            Node::Literal(_) | Node::State(_) => true,
            _ => false,
        };
        let mut rows: BTreeMap<usize, Vec<SignalId>> = BTreeMap::new();
        let mut row = None;
        let mut between = BTreeSet::new();
        for (n, statement) in statements.iter().enumerate() {
            match statement {
                silent if silent.is_silent() => {}
                Statement::Assign(Assign { target, at: None, value, .. }) if is_constant(value) => {
                    if value.constant() != Some(0) {
                        between.insert(*target);
                    } else if let Some(first) = row.filter(|_| !between.contains(target)) {
                        let row = rows.entry(first).or_default();
                        if !row.contains(target) {
                            row.push(*target);
                        }
                        rows.insert(n, vec![]);
                    } else {
                        row = Some(n);
                        rows.insert(n, vec![*target]);
                        between.clear();
                    }
                }
                _ => row = None,
            }
        }
        rows
    }

    /// Registers that become 0 together: `{count_q, valid_q} <= 0;`.
    fn cleared(&self, registers: &[SignalId]) -> String {
        let name = |next: &SignalId| {
            let register = self.scope.registers.iter().find(|register| register.next == *next);
            self.signal_names[register.map_or(*next, |register| register.value)].as_str()
        };
        format!("{{{}}} <= 0;", registers.iter().map(name).collect::<Vec<_>>().join(", "))
    }

    /// The line with the number of the Rust line that it comes from.
    pub fn placed(&self, line: String) -> String {
        match self.line {
            Some(number) if !line.contains(PLACE) => format!("{line}{PLACE}{number}"),
            _ => line,
        }
    }

    /// The comment before a statement: once in a module, where the first part of the statement stands.
    pub fn note(&mut self, note: &Note) -> Vec<String> {
        self.line = note.line.or(self.line);
        let is_new = note.line.is_none_or(|line| self.said.insert((line, note.text.clone())));
        let lines = note.text.lines().filter(|_| is_new);
        lines.map(|line| format!("// {line}").trim_end().into()).collect()
    }

    fn statement(&mut self, statement: &Statement) -> Vec<String> {
        match statement {
            Statement::Comment(note) => self.note(note),
            Statement::Assign(assign) => {
                let line = self.assign(assign);
                self.after_steps(vec![line])
            }
            Statement::If { test, then, otherwise } => {
                let test = self.test(test);
                let steps = std::mem::take(&mut self.pending);
                [steps, self.choice(test, then, otherwise)].concat()
            }
            Statement::Case { subject, arms, default } => {
                let test = self.test(subject);
                let steps = std::mem::take(&mut self.pending);
                let mut lines = vec![];
                for Arm { label, body } in arms {
                    let label = match label {
                        Label::State(state) => self.state(state),
                        Label::Number(number) => literal(subject.ty, *number, Use::Count),
                    };
                    lines.extend(arm(&label, "", self.lines(body)));
                }
                let (note, body) = match default.as_deref().unwrap_or_default() {
                    [Statement::Comment(note), body @ ..] if note.label().is_some() => (note.label(), body),
                    body => (None, body),
                };
                let note = note.map_or(String::new(), |label| format!(" // {label}"));
                lines.extend(arm("default", &note, self.lines(body)));
                [steps, enclosed(&format!("case ({test})"), &lines, "endcase")].concat()
            }
        }
    }

    /// What the lines need is computed before them.
    fn after_steps(&mut self, lines: Vec<String>) -> Vec<String> {
        [std::mem::take(&mut self.pending), lines].concat()
    }

    fn choice(&mut self, test: String, then: &[Statement], otherwise: &[Statement]) -> Vec<String> {
        let mut branches: Vec<Branch> = vec![(Some(test), self.lines(then))];
        let mut rest = otherwise;
        while let [Statement::If { test, then, otherwise }] = rest {
            let test = self.test(test);
            if !self.pending.is_empty() {
                let steps = std::mem::take(&mut self.pending);
                branches.push((None, [steps, self.choice(test, then, otherwise)].concat()));
                return choice_lines(&branches);
            }
            branches.push((Some(test), self.lines(then)));
            rest = otherwise;
        }
        if !rest.is_empty() {
            branches.push((None, self.lines(rest)));
        }
        choice_lines(&branches)
    }

    fn test(&mut self, test: &Expression) -> String {
        self.subject = "test".into();
        self.root(test)
    }

    fn assign(&mut self, assign: &Assign) -> String {
        let register = self.scope.registers.iter().find(|register| register.next == assign.target);
        let (target, sign) = match register.filter(|_| self.at_edge) {
            Some(register) => (register.value, "<="),
            None => (assign.target, "="),
        };
        let name = self.signal_names[target].clone();
        self.subject.clone_from(&name);
        let value = self.root(&assign.value);
        let whole = self.scope.signals[assign.target].ty.bits == assign.value.ty.bits;
        let place = assign.at.filter(|_| !whole).map_or(String::new(), |at| range(at, assign.value.ty.bits));
        format!("{name}{place} {sign} {value};")
    }
}

fn block(head: &str, body: &[String]) -> Vec<String> {
    enclosed(head, body, "end")
}

fn enclosed(head: &str, body: &[String], end: &str) -> Vec<String> {
    let body = body.iter().map(|line| format!("    {line}"));
    std::iter::once(head.to_string()).chain(body).chain([end.to_string()]).collect()
}

/// `LABEL: x = y;`, or a block; `note` stands behind the first line.
fn arm(label: &str, note: &str, body: Vec<String>) -> Vec<String> {
    match &body[..] {
        [] => vec![format!("{label}: ;{note}")],
        [one] if is_statement(one) && label.len() + code(one).len() + note.len() < SHORT => {
            let (code, place) = one.split_at(code(one).len());
            vec![format!("{label}: {code}{note}{place}")]
        }
        _ => block(&format!("{label}: begin{note}"), &body),
    }
}

/// One assignment, under a condition or not, and no comment.
fn is_statement(line: &str) -> bool {
    is_assignment(line) || (line.starts_with("if (") && code(line).ends_with(';'))
}

/// One assignment: nothing to which an `else` could belong.
fn is_assignment(line: &str) -> bool {
    code(line).ends_with(';')
        && !["if (", "else", "case", "//", " "].iter().any(|word| line.starts_with(word))
}

fn choice_lines(branches: &[Branch]) -> Vec<String> {
    let fits = |(test, body): &Branch| match &body[..] {
        [one] => is_assignment(one) && test.as_ref().map_or(0, String::len) + code(one).len() < SHORT,
        _ => false,
    };
    let inline = branches.len() <= INLINE && branches.iter().all(fits);
    let mut lines = vec![];
    for (n, (test, body)) in branches.iter().enumerate() {
        let word = match (n, test) {
            (0, Some(test)) => format!("if ({test})"),
            (_, Some(test)) => format!("else if ({test})"),
            (_, None) => "else".into(),
        };
        if inline {
            lines.push(format!("{word} {}", body[0]));
            continue;
        }
        lines.push(if n == 0 { format!("{word} begin") } else { format!("end {word} begin") });
        lines.extend(body.iter().map(|line| format!("    {line}")));
    }
    if !inline {
        lines.push("end".into());
    }
    lines
}
