//! Writes the lines of a module.

use std::collections::BTreeSet;

use crate::arrays::{Array, Pin, array_name, count_name};
use crate::collect::Tree;
use crate::cycles::keep;
use crate::describe::Description;
use crate::error::{EmitError, Fault};
use crate::expression::{Expression, Node};
use crate::kernel::{Assign, Statement};
use crate::kind::{Kind, pins_of};
use crate::layout::{WIDTH, code};
use crate::names::snake_case;
use crate::order::{self, Order, Step};
use crate::print::{Between, Printer};
use crate::process::Process;
use crate::scope::{Role, Scope, SignalId};
use crate::sheet::{Paragraph, Sheet, Written};
use crate::text::Use;
use crate::unread::Read;
use crate::value::{Value, of_type, pattern};
use crate::wiring::Wiring;

pub(crate) struct Writer<'a> {
    pub tree: &'a Tree,
    pub scope: &'a Scope,
    pub description: &'a Description,
    /// The Rust file of the kernel.
    pub source: &'a str,
    pub wiring: &'a Wiring,
    pub processes: &'a [Process],
    pub arrays: &'a [Array],
    /// The signals that are ports.
    pub ports: &'a [SignalId],
    /// Arrays of one element.
    pub single: &'a [String],
    pub kinds: &'a [Option<Kind<'a>>],
    /// What stands where.
    pub order: &'a Order,
    /// Which outputs follow which inputs within the cycle.
    pub paths: &'a [(SignalId, SignalId)],
    pub printer: Printer<'a>,
    /// Number of intermediate values that are declared.
    pub declared: usize,
    /// Constants that formulas name.
    pub named: BTreeSet<SignalId>,
}

impl Writer<'_> {
    /// The sheet, the values of its slots, and the tree's part that each instance stands for.
    pub fn sheet(mut self) -> Result<(Sheet, Vec<Value>, Vec<usize>), EmitError> {
        let (mut logic, mut parts) = self.logic()?;
        let ends = self.ends();
        logic.push(Paragraph::Lines(self.with_between(vec![])));
        let mut clocked: Vec<Vec<String>> = ends.into_iter().chain(self.clocked()).collect();
        clocked.extend(Some(self.unread()).filter(|lines| !lines.is_empty()));
        parts.iter_mut().try_for_each(|part| self.derive(part))?;
        let (mut constants, mut values) = self.constants()?;
        for part in &parts {
            if let Some((constant, value)) = &part.count {
                constants.push(constant.clone());
                values.push(value.clone());
            }
        }
        values.extend(parts.iter().flat_map(|part| part.values.iter().cloned()));
        let sheet = Sheet {
            name: self.name(),
            header: self.header(),
            source: self.source.into(),
            ports: self.ports(),
            constants,
            states: self.states(),
            signals: self.signals(),
            logic,
            instances: parts.iter().map(|part| part.instance.clone()).collect(),
            clocked,
        };
        Ok((sheet, values, parts.iter().map(|part| part.of).collect()))
    }

    fn name(&self) -> String {
        let name = snake_case(self.description.name);
        if self.description.role.is_empty() { name } else { format!("{name}_{}", self.description.role) }
    }

    pub fn signal_name(&self, id: SignalId) -> &str {
        &self.printer.signal_names[id]
    }

    /// What the field of a signal says; of an array's elements the first says it for all.
    pub fn said(&self, id: SignalId) -> String {
        let key = &self.scope.signals[id].key;
        let (field, rest) = key.split_once('$').unwrap_or((key, ""));
        let is_first = rest.is_empty() || rest == "0";
        self.description.of(field).filter(|_| is_first).unwrap_or_default().to_string()
    }

    fn ports(&self) -> Vec<(String, String)> {
        let registered = self.registered();
        let kind = |id: SignalId| match self.scope.signals[id].role {
            Role::Input => "input wire",
            _ if registered.contains(&id) => "output reg",
            _ => "output wire",
        };
        let line = |id: &SignalId| {
            let ty = of_type(self.scope.signals[*id].ty);
            // That a clock is a clock needs no words.
            let said = self.said(*id);
            let said = if said == "Clock." { String::new() } else { said };
            (format!("{} {ty}{}", kind(*id), self.signal_name(*id)), said)
        };
        let mut lines: Vec<(String, String)> = vec![];
        let has_bundles = self.ports.iter().any(|id| self.channel(*id).is_some());
        for (n, id) in self.ports.iter().enumerate() {
            let (port, said) = line(id);
            let before = (n > 0).then(|| self.ports[n - 1]);
            if has_bundles && before.is_some_and(|before| self.group(*id) != self.group(before)) {
                lines.push((String::new(), String::new()));
            }
            match lines.last_mut() {
                Some((last, comment)) if comment.is_empty() && n == 1 && self.group(*id) == "clock" => {
                    *last += &format!(", {port}");
                    *comment = said;
                }
                Some((last, comment))
                    if said.is_empty()
                        && comment.is_empty()
                        && before.and_then(|before| self.channel(before)) == self.channel(*id)
                        && self.channel(*id).is_some()
                        && last.len() + port.len() + 6 <= WIDTH =>
                {
                    *last += &format!(", {port}");
                }
                _ => lines.push((port, said)),
            }
        }
        lines
    }

    /// The bundle that a port belongs to, and its channel there: ports of one stand side by side.
    fn channel(&self, id: SignalId) -> Option<(&str, &str)> {
        let (bundle, rest) = self.scope.signals[id].key.split_once('$')?;
        let channel = rest.split_once('_').map_or("", |(channel, _)| channel);
        rest.starts_with(char::is_alphabetic).then_some((bundle, channel))
    }

    /// Ports of one group stand together: clocks and resets, those of a bundle, all others.
    fn group(&self, id: SignalId) -> &str {
        let signal = &self.scope.signals[id];
        let (field, rest) = signal.key.split_once('$').unwrap_or((&signal.key, ""));
        let is_bundle = rest.starts_with(char::is_alphabetic);
        match () {
            () if signal.is_clock || (field.ends_with("reset") && signal.role == Role::Input) => "clock",
            () if is_bundle => field,
            () => "",
        }
    }

    /// What `always @*` blocks drive.
    fn registered(&self) -> BTreeSet<SignalId> {
        let is_block = |process: &&Process| process.plain().is_none() && process.is_combinational();
        let blocks = self.processes.iter().filter(is_block);
        blocks.flat_map(|process| process.targets.iter().copied()).collect()
    }

    /// Declarations of registers, and of signals that are read above the place where they get their value.
    fn signals(&self) -> Vec<String> {
        let is_above =
            |id: &SignalId| self.scope.signals[*id].role == Role::Register || self.order.early.contains(id);
        let ids = (0..self.scope.signals.len()).filter(is_above);
        self.declarations(ids).into_iter().chain(self.array_wires()).collect()
    }

    /// Declarations beside the statements or the instance that give signals their values.
    fn beside(&self, ids: impl Iterator<Item = SignalId>) -> Vec<String> {
        self.declarations(ids.filter(|id| !self.order.early.contains(id)))
    }

    fn declarations(&self, ids: impl Iterator<Item = SignalId>) -> Vec<String> {
        let registered = self.registered();
        let start = |id: SignalId| {
            let register = self.scope.registers.iter().find(|register| register.value == id);
            let value = register.and_then(|register| register.start.as_ref());
            value.map_or(String::new(), |value| {
                format!(" = {}", pattern(self.scope.signals[id].ty, value, Use::Value))
            })
        };
        let in_array: BTreeSet<SignalId> = self.array_outputs().into_iter().collect();
        together(ids.filter_map(|id| {
            let signal = &self.scope.signals[id];
            let kind = match signal.role {
                Role::Register => "reg",
                Role::Local | Role::Next | Role::PartInput if registered.contains(&id) => "reg",
                Role::Local | Role::Next | Role::PartInput => "wire",
                Role::PartOutput if !in_array.contains(&id) && !self.wiring.is_replaced(id) => "wire",
                _ => return None,
            };
            Some((format!("{kind} {}", of_type(signal.ty)), format!("{}{}", self.signal_name(id), start(id))))
        }))
    }

    /// The declaration with the value, where an assignment is that.
    fn assignment(&self, target: SignalId, value: &str) -> String {
        let signal = &self.scope.signals[target];
        let name = self.signal_name(target);
        match signal.role == Role::Output || self.order.early.contains(&target) {
            true => format!("assign {name} = {value};"),
            false => format!("wire {}{name} = {value};", of_type(signal.ty)),
        }
    }

    /// The signals at pins of parts.
    fn pins(&self) -> BTreeSet<SignalId> {
        let of = |part: &crate::scope::Part| {
            let kind = self.kinds[part.index].as_ref();
            kind.map_or(vec![], |kind| pins_of(part, kind))
        };
        self.scope.parts.iter().flat_map(of).map(|pin| pin.1).collect()
    }

    fn array_outputs(&self) -> Vec<SignalId> {
        let of = |array: &Array| {
            let elements = (0..array.parts.len()).flat_map(|element| {
                array.signals(self.scope, self.kinds, element).into_iter().zip(&array.pins)
            });
            let outputs = elements.filter(|(_, pin)| matches!(pin, Pin::Output { .. })).map(|(id, _)| id);
            outputs.collect::<Vec<_>>()
        };
        self.arrays.iter().flat_map(of).collect()
    }

    /// The wires that the outputs of an array's parts are.
    fn array_wires(&self) -> Vec<String> {
        let of = |array: &Array| {
            let count = count_name(array);
            let first = array.signals(self.scope, self.kinds, 0);
            let line = |(id, pin): (&SignalId, &Pin)| {
                let Pin::Output { next } = pin else { return None };
                let last = if next.is_some() { count.clone() } else { format!("{count}-1") };
                let ty = of_type(self.scope.signals[*id].ty);
                Some(format!("wire {ty}{} [0:{last}];", array_name(self.signal_name(*id))))
            };
            first.iter().zip(&array.pins).filter_map(line).collect::<Vec<_>>()
        };
        self.arrays.iter().flat_map(of).collect()
    }

    /// What stands at the ends of chains.
    fn ends(&mut self) -> Vec<Vec<String>> {
        let mut lines = vec![];
        for array in self.arrays {
            let first = array.signals(self.scope, self.kinds, 0);
            let mut seen = BTreeSet::new();
            for pin in &array.pins {
                let Pin::Neighbour { from, next, end } = pin else { continue };
                if !seen.insert(*from) {
                    continue;
                }
                let at = if *next { count_name(array) } else { "0".into() };
                let value = self.printer.value(end, "");
                lines.push(format!("assign {}[{at}] = {value};", array_name(self.signal_name(first[*from]))));
            }
        }
        if lines.is_empty() { vec![] } else { vec![lines] }
    }

    /// Says of what not every bit is read.
    fn unread(&mut self) -> Vec<String> {
        let mut read = Read::nothing(self.scope, self.printer.resolved);
        self.processes.iter().for_each(|process| process.expressions(&mut |value| read.expression(value)));
        let pins = self.pins().into_iter().filter(|id| self.scope.signals[*id].role == Role::PartInput);
        let registers = self.scope.registers.iter().map(|register| register.next);
        let direct = self.processes.iter().find(|process| !process.is_combinational());
        let registers = registers.filter(|id| direct.is_none_or(|edge| !edge.targets.contains(id)));
        let clocks = self.scope.registers.iter().map(|register| register.clock);
        let ends = self.arrays.iter().flat_map(|array| &array.pins).filter_map(|pin| match pin {
            Pin::Neighbour { end, .. } => Some(end.clone()),
            _ => None,
        });
        let named = pins.chain(registers).chain(clocks).map(|id| Expression::signal(self.scope, id));
        named.chain(ends).for_each(|value| read.expression(&value));
        let outputs: BTreeSet<SignalId> =
            self.ports.iter().filter(|id| self.scope.signals[**id].role == Role::Output).copied().collect();
        let in_array: BTreeSet<SignalId> = self.array_outputs().into_iter().collect();
        let is_named = |id: &SignalId| match self.scope.signals[*id].role {
            Role::Input => self.ports.contains(id),
            Role::Local => self.processes.iter().any(|process| process.targets.contains(id)),
            Role::Register => !self.wiring.is_replaced(*id),
            Role::PartOutput => {
                let shown = !self.signal_name(*id).ends_with("_unused") && !self.wiring.is_replaced(*id);
                shown && !in_array.contains(id) && !self.signal_name(*id).is_empty()
            }
            _ => false,
        };
        let pins = self.pins();
        let signals = (0..self.scope.signals.len())
            .filter(|id| is_named(id) && !outputs.contains(id) && read.is_partial(*id))
            .filter(|id| pins.contains(id) || self.scope.signals[*id].role != Role::PartOutput)
            .map(|id| self.signal_name(id).to_string());
        let between = self.printer.between.iter().filter(|between| between.in_part);
        let all: Vec<String> = signals.chain(between.map(|between| between.name.clone())).collect();
        if all.is_empty() {
            return vec![];
        }
        let name = self.printer.names.take("unused");
        let note = "// Not every bit is read.";
        let line = match &all[..] {
            [one] => format!("wire {name} = ^{one};"),
            _ => format!("wire {name} = ^{{{}}};", all.join(", ")),
        };
        match line.len() + note.len() + 3 <= WIDTH {
            true => vec![format!("{line} {note}")],
            false => vec![note.into(), line],
        }
    }

    /// Assignments, `always @*` blocks and instances: a paragraph for each run of assignments, each block and each instance.
    fn logic(&mut self) -> Result<(Vec<Paragraph>, Vec<Written>), EmitError> {
        let (mut paragraphs, mut parts): (Vec<Paragraph>, Vec<Written>) = (vec![], vec![]);
        let mut after_assign = false;
        for step in &self.order.steps {
            match step {
                Step::Part(n) => {
                    let part = self.part(*n);
                    let outputs = self.scope.parts[*n].ports.iter().map(|(_, id)| *id);
                    let lines = self.beside(outputs.filter(|id| self.is_output(*id)));
                    let above = self.with_between(lines);
                    paragraphs.push(Paragraph::Instance { number: parts.len(), above });
                    parts.push(part);
                    after_assign = false;
                }
                Step::Process(n) => {
                    let process = &self.processes[*n];
                    let Some(assign) = process.plain() else {
                        paragraphs.push(Paragraph::Lines(self.block(process)?));
                        after_assign = false;
                        continue;
                    };
                    if !after_assign {
                        self.printer.line = None;
                    }
                    let (lines, has_comment) = self.assign(process, assign);
                    match paragraphs.last_mut() {
                        Some(Paragraph::Lines(last)) if after_assign && !has_comment => extend(last, lines),
                        _ => paragraphs.push(Paragraph::Lines(lines)),
                    }
                    after_assign = true;
                }
            }
        }
        Ok((paragraphs, parts))
    }

    fn is_output(&self, id: SignalId) -> bool {
        self.scope.signals[id].role == Role::PartOutput
    }

    /// The lines of an `always @*` block, after the declarations of what it drives.
    fn block(&mut self, process: &Process) -> Result<Vec<String>, EmitError> {
        if !is_started(self.scope, self.printer.resolved, process) {
            let first = process.targets.first().map(|id| self.scope.signals[*id].key.as_str());
            return Err(EmitError::field(&self.tree.path, first.unwrap_or_default(), Fault::Constant));
        }
        let declared = self.beside(order::declared(self.scope, process));
        let mut lines = self.printer.process(&process.statements, &process.targets);
        let comment = lines.iter().take_while(|line| line.starts_with("//")).count();
        lines.splice(comment..comment, declared);
        Ok(self.with_between(lines))
    }

    /// The lines of an assignment, and whether a comment is the first.
    fn assign(&mut self, process: &Process, assign: &Assign) -> (Vec<String>, bool) {
        let mut lines: Vec<String> = vec![];
        for statement in &process.statements {
            if let Statement::Comment(note) = statement {
                lines.extend(self.printer.note(note));
            }
        }
        let has_comment = !lines.is_empty();
        let name = self.signal_name(assign.target).to_string();
        let value = self.printer.value(&assign.value, &name);
        lines.push(self.assignment(assign.target, &value));
        let lines = lines.into_iter().map(|line| self.printer.placed(line)).collect();
        (self.with_between(lines), has_comment)
    }

    /// A block for the registers of each clock.
    fn clocked(&mut self) -> Vec<Vec<String>> {
        let edge = self.processes.iter().find(|process| !process.is_combinational());
        let is_direct = |id: &SignalId| edge.is_some_and(|edge| edge.targets.contains(id));
        let mut clocks: Vec<(String, BTreeSet<SignalId>)> = vec![];
        for register in &self.scope.registers {
            let clock = self.printer.value(&Expression::signal(self.scope, register.clock), "");
            match clocks.iter_mut().find(|(of, _)| *of == clock) {
                Some((_, nexts)) => _ = nexts.insert(register.next),
                None => clocks.push((clock, BTreeSet::from([register.next]))),
            }
        }
        let mut blocks = vec![];
        for (clock, nexts) in clocks {
            let mut taken = vec![];
            for register in &self.scope.registers {
                if nexts.contains(&register.next) && !is_direct(&register.next) {
                    let subject = self.signal_name(register.next).to_string();
                    let mut text = |id| self.printer.value(&Expression::signal(self.scope, id), &subject);
                    taken.push((text(register.value), text(register.next)));
                }
            }
            let statements = edge.map_or(vec![], |edge| keep(&edge.statements, &nexts));
            let lines = self.printer.edge(&clock, &statements, &taken);
            blocks.push(self.with_between(lines));
        }
        blocks
    }

    /// Lines after the values that they need and that are not declared yet. A comment stays the first.
    fn with_between(&mut self, mut lines: Vec<String>) -> Vec<String> {
        let declared = std::mem::replace(&mut self.declared, self.printer.between.len());
        let between = self.printer.between[declared..].iter().map(declare);
        let comment = lines.iter().take_while(|line| line.starts_with("//")).count();
        lines.splice(comment..comment, between);
        lines
    }
}

/// Adds lines to a run of assignments. Names and numbers stand side by side: `assign data_o = data_q, last_o = last_q;`, and so do wires of one type.
fn extend(run: &mut Vec<String>, lines: Vec<String>) {
    for line in lines {
        let both = run.last().and_then(|last| Some((given(last)?, given(&line)?)));
        match (run.last_mut(), both) {
            (Some(last), Some(((kind, before), (also, new))))
                if kind == also && kind.len() + before.len() + new.len() + 6 <= WIDTH =>
            {
                let place = last[code(last).len()..].to_string();
                *last = format!("{kind}{before}, {new};{place}");
            }
            _ => run.push(line),
        }
    }
}

/// `wire [7:0] ` or `assign `, and what follows, of a line that gives names or numbers to signals and does no more.
fn given(line: &str) -> Option<(String, String)> {
    let line = code(line).strip_suffix(';')?;
    let (first, _) = line.split_once(" = ")?;
    let (kind, _) = first.rsplit_once(' ')?;
    let pairs = line.get(kind.len() + 1..)?;
    let is_plain = |c: char| c.is_alphanumeric() || "_[]:'!".contains(c);
    let are_plain = (pairs.split(", "))
        .all(|pair| pair.split_once(" = ").is_some_and(|(_, value)| value.chars().all(is_plain)));
    ((kind == "assign" || kind.starts_with("wire")) && are_plain).then(|| (format!("{kind} "), pairs.into()))
}

/// Declarations: signals of one type share lines that are no longer than a line should be.
fn together(signals: impl Iterator<Item = (String, String)>) -> Vec<String> {
    let mut types: Vec<(String, Vec<String>)> = vec![];
    for (of_type, name) in signals {
        let known = types.iter_mut().find(|(other, _)| *other == of_type);
        let line = match known {
            Some((_, lines)) => lines,
            None => {
                types.push((of_type.clone(), vec![]));
                &mut types.last_mut().expect("one was pushed").1
            }
        };
        match line.last_mut() {
            Some(last) if last.len() + name.len() + 5 <= WIDTH => *last += &format!(", {name}"),
            _ => line.push(of_type + &name),
        }
    }
    types.into_iter().flat_map(|(_, lines)| lines).map(|line| line + ";").collect()
}

/// A wire with its value, or a register that a process assigns.
fn declare(between: &Between) -> String {
    let (ty, name) = (of_type(between.ty), &between.name);
    match &between.value {
        Some(value) => format!("wire {ty}{name} = {value};"),
        None => format!("reg {ty}{name};"),
    }
}

/// Whether the process waits for something: `always @*` does not start by itself.
fn is_started(scope: &Scope, resolved: &[Expression], process: &Process) -> bool {
    let changes = |id: &SignalId| match resolved[*id].node {
        Node::Signal(id) => {
            !matches!(scope.signals[id].role, Role::Constant(_)) && !process.targets.contains(&id)
        }
        _ => false,
    };
    process.reads.iter().any(changes)
}
