//! Writes the lines of a module.

use std::collections::BTreeSet;

use crate::arrays::{Array, Pin};
use crate::collect::Tree;
use crate::describe::Description;
use crate::error::{EmitError, Fault};
use crate::expression::{Expression, Node};
use crate::kernel;
use crate::kind::{Kind, pins_of, split_number};
use crate::names::snake_case;
use crate::print::{Between, Printer, comment, literal};
use crate::process::Process;
use crate::scope::{Role, Scope, SignalId};
use crate::sheet::{Constant, Instance, LeafParameter, Of, Sheet, Turns, WIDTH};
use crate::single::plain;
use crate::types::Type;
use crate::unread::Read;
use crate::value::{Value, of_type, pattern};
use crate::wiring::Wiring;

pub(crate) struct Writer<'a> {
    pub tree: &'a Tree,
    pub scope: &'a Scope,
    pub description: &'a Description,
    pub wiring: &'a Wiring,
    pub processes: &'a [Process],
    pub arrays: &'a [Array],
    /// The signals that are ports.
    pub ports: &'a [SignalId],
    /// Arrays of one element.
    pub single: &'a [String],
    pub kinds: &'a [Option<Kind<'a>>],
    pub printer: Printer<'a>,
}

impl Writer<'_> {
    /// The sheet, the values of its slots, and the tree's part that each instance stands for.
    pub fn sheet(mut self) -> Result<(Sheet, Vec<Value>, Vec<usize>), EmitError> {
        let mut logic = self.logic()?;
        let parts = self.parts();
        logic.extend(self.ends());
        logic.extend(self.clocked());
        logic.extend(Some(self.unread()).filter(|lines| !lines.is_empty()));
        let (mut constants, mut values) = self.constants();
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
            ports: self.ports(),
            constants,
            states: self.states(),
            signals: self.signals(),
            between: self.between(),
            instances: parts.iter().map(|part| part.instance.clone()).collect(),
            logic,
        };
        Ok((sheet, values, parts.iter().map(|part| part.of).collect()))
    }

    fn name(&self) -> String {
        let name = snake_case(self.description.name);
        if self.description.role.is_empty() { name } else { format!("{name}_{}", self.description.role) }
    }

    fn header(&self) -> String {
        let line = |line: &str| format!("// {}", line.trim()).trim_end().to_string() + "\n";
        let text: String = self.description.header.trim().lines().map(line).collect();
        text + &format!(
            "//\n// From {} ({}).\n",
            in_workspace(self.description.source),
            self.description.name
        )
    }

    fn signal_name(&self, id: SignalId) -> &str {
        &self.printer.signal_names[id]
    }

    /// What the field of a signal says; of an array's elements the first says it for all.
    fn said(&self, id: SignalId) -> String {
        let key = &self.scope.signals[id].key;
        let (field, rest) = key.split_once('$').unwrap_or((key, ""));
        let is_first = rest.is_empty() || rest == "0";
        self.description.of(field).filter(|_| is_first).unwrap_or_default().to_string()
    }

    fn ports(&self) -> Vec<(String, String)> {
        let registered = self.registered();
        let kind = |id: SignalId| match self.scope.signals[id].role {
            Role::Input => "input  wire",
            _ if registered.contains(&id) => "output reg ",
            _ => "output wire",
        };
        let types = self.ports.iter().map(|id| of_type(self.scope.signals[*id].ty));
        let width = types.map(|ty| ty.len()).max().unwrap_or(0);
        let line = |id: &SignalId| {
            let ty = of_type(self.scope.signals[*id].ty);
            (format!("{} {ty:width$}{}", kind(*id), self.signal_name(*id)), self.said(*id))
        };
        self.ports.iter().map(line).collect()
    }

    /// What `always @*` blocks drive.
    fn registered(&self) -> BTreeSet<SignalId> {
        let blocks = self.processes.iter().filter(|process| process.plain().is_none());
        blocks.flat_map(|process| process.targets.iter().copied()).collect()
    }

    fn constants(&self) -> (Vec<Constant>, Vec<Value>) {
        let constants = self.printer.constants.iter().filter_map(|&id| {
            let signal = &self.scope.signals[id];
            let Role::Constant(digits) = &signal.role else { return None };
            let name = self.signal_name(id).to_string();
            let value = Value::constant(signal.ty, digits);
            Some((Constant { name, of_type: value.of_type.clone(), comment: self.said(id) }, value))
        });
        constants.unzip()
    }

    fn states(&self) -> Vec<String> {
        let line = |(name, state): &(String, crate::scope::State)| {
            let ty = Type::bits(state.bits);
            format!("localparam {}{name} = {};", of_type(ty), literal(ty, state.value as i128))
        };
        self.printer.states.values().map(line).collect()
    }

    /// Declarations of registers, local signals and wires between the parts.
    fn signals(&self) -> Vec<String> {
        let registered = self.registered();
        let start = |id: SignalId| {
            let register = self.scope.registers.iter().find(|register| register.value == id);
            let value = register.and_then(|register| register.start.as_ref());
            value.map_or(String::new(), |value| format!(" = {}", pattern(self.scope.signals[id].ty, value)))
        };
        let driven: BTreeSet<SignalId> =
            self.processes.iter().flat_map(|process| process.targets.iter().copied()).collect();
        let has_pin = self.pins();
        let in_array: BTreeSet<SignalId> = self.array_outputs().into_iter().collect();
        let declare = |id: SignalId| {
            let signal = &self.scope.signals[id];
            let kind = match signal.role {
                Role::Register => "reg ",
                Role::Local | Role::Next | Role::PartInput if registered.contains(&id) => "reg ",
                Role::Local | Role::Next | Role::PartInput if driven.contains(&id) => "wire",
                Role::PartOutput
                    if has_pin.contains(&id) && !in_array.contains(&id) && !self.wiring.is_replaced(id) =>
                {
                    "wire"
                }
                _ => return None,
            };
            Some((format!("{kind} {}", of_type(signal.ty)), format!("{}{}", self.signal_name(id), start(id))))
        };
        let signals = (0..self.scope.signals.len()).filter_map(declare);
        together(signals).into_iter().chain(self.array_wires()).collect()
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

    /// Values in between, each after those that it is made from.
    fn between(&self) -> Vec<String> {
        self.printer.between.iter().map(declare).collect()
    }

    /// Says of what not every bit is read.
    fn unread(&mut self) -> Vec<String> {
        let mut read = Read::nothing(self.scope, self.printer.resolved);
        self.processes.iter().for_each(|process| process.expressions(&mut |value| read.expression(value)));
        let pins = self.pins().into_iter().filter(|id| self.scope.signals[*id].role == Role::PartInput);
        let registers = self.scope.registers.iter().map(|register| register.next);
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
        let note = "// Not every bit of these is read.".to_string();
        let line = match &all[..] {
            [one] => format!("wire {name} = ^{one};"),
            _ => format!("wire {name} = ^{{{}}};", all.join(", ")),
        };
        if line.len() <= 100 {
            return vec![note, line];
        }
        let last = all.len() - 1;
        let each =
            all.iter().enumerate().map(|(n, one)| format!("    {one}{}", if n == last { "" } else { "," }));
        let (first, end) = (format!("wire {name} = ^{{"), "};".to_string());
        [note, first].into_iter().chain(each).chain([end]).collect()
    }

    /// Assignments and `always @*` blocks, one paragraph for each run of assignments and each block.
    fn logic(&mut self) -> Result<Vec<Vec<String>>, EmitError> {
        let mut paragraphs: Vec<Vec<String>> = vec![];
        let mut after_assign = false;
        for process in self.processes {
            let Some(assign) = process.plain() else {
                if !is_started(self.scope, self.printer.resolved, process) {
                    let first = process.targets.first().map(|id| self.scope.signals[*id].key.as_str());
                    return Err(EmitError::field(
                        &self.tree.path,
                        first.unwrap_or_default(),
                        Fault::Constant,
                    ));
                }
                paragraphs.push(self.printer.process(&process.statements, &process.targets));
                after_assign = false;
                continue;
            };
            let mut lines: Vec<String> = vec![];
            for statement in &process.statements {
                if let kernel::Statement::Comment(text) = statement {
                    lines.extend(comment(text));
                }
            }
            let starts = !after_assign || !lines.is_empty();
            let name = self.signal_name(assign.target).to_string();
            let value = self.printer.value(&assign.value, &name);
            lines.push(format!("assign {name} = {value};"));
            match paragraphs.last_mut() {
                Some(last) if !starts => last.extend(lines),
                _ => paragraphs.push(lines),
            }
            after_assign = true;
        }
        Ok(paragraphs)
    }

    fn parts(&mut self) -> Vec<Written> {
        let mut written = vec![];
        for (n, part) in self.scope.parts.iter().enumerate() {
            let array = self.arrays.iter().find(|array| array.parts.contains(&n));
            match array {
                Some(array) if array.parts[0] == n => written.push(self.array(array)),
                Some(_) => {}
                None if self.kinds[part.index].is_some() => written.push(self.instance(n)),
                None => {}
            }
        }
        written
    }

    fn instance(&mut self, n: usize) -> Written {
        let part = &self.scope.parts[n];
        let name = self.printer.names.take(&plain(&self.tree.parts[part.index].key, self.single));
        let Some(kind) = &self.kinds[part.index] else { unreachable!("a register is no instance") };
        let pins = pins_of(part, kind);
        let pins = pins.into_iter().map(|(port, id)| {
            let value = self.printer.value(&Expression::signal(self.scope, id), "");
            format!(".{port}({value})")
        });
        let pins = pins.collect();
        let (of, parameters, values) = parameters(kind, None);
        Written {
            instance: Instance { of, name, parameters, pins, turns: None },
            values,
            count: None,
            of: part.index,
        }
    }

    /// A loop of instances.
    fn array(&mut self, array: &Array) -> Written {
        let part = &self.scope.parts[array.parts[0]];
        let Some(kind) = &self.kinds[part.index] else { unreachable!("a register is no instance") };
        let count = count_name(array);
        let label = self.printer.names.take(&array.key);
        let singular = array.key.strip_suffix('s').filter(|word| !word.is_empty()).unwrap_or("i");
        let variable = self.printer.names.take(if singular == "element" { "i" } else { singular });
        let name = self.printer.names.take("element");
        let (number, digits) = (self.printer.names.take("NUMBER"), self.printer.names.take("DIGITS"));
        let mut inside = vec![];
        let pins: Vec<String> = pins_of(part, kind)
            .into_iter()
            .zip(&array.pins)
            .map(|((port, id), pin)| {
                let value = match pin {
                    Pin::Same(value) => self.printer.value(value, ""),
                    Pin::Number(bits) => {
                        let line = format!("localparam {}{number} = {variable};", of_type(Type::bits(*bits)));
                        if !inside.contains(&line) {
                            inside.push(line);
                        }
                        number.clone()
                    }
                    Pin::Neighbour { from, next, .. } => {
                        let first = array.signals(self.scope, self.kinds, 0);
                        let name = array_name(self.signal_name(first[*from])).to_string();
                        format!("{name}[{variable}{}]", if *next { " + 1" } else { "" })
                    }
                    Pin::Output { next } => {
                        let name = array_name(self.signal_name(id));
                        format!("{name}[{variable}{}]", if *next == Some(false) { " + 1" } else { "" })
                    }
                };
                format!(".{port}({value})")
            })
            .collect();
        let last = &self.scope.parts[array.parts[array.parts.len() - 1]];
        let last = self.kinds[last.index].as_ref().map(|last| (last, digits.as_str()));
        let (of, parameters, values) = parameters(kind, last);
        if parameters.iter().any(|parameter| parameter.numbered.is_some()) {
            let value = format!("\"00\" + 256 * ({variable} / 10) + {variable} % 10");
            inside.push(format!("localparam [15:0] {digits} = {value};"));
        }
        let turns = Some(Turns { variable, count: count.clone(), label, inside });
        Written {
            instance: Instance { of, name, parameters, pins, turns },
            values,
            count: Some((
                Constant { name: count, of_type: String::new(), comment: String::new() },
                Value::number(array.parts.len()),
            )),
            of: part.index,
        }
    }

    /// One block for all registers of a clock.
    fn clocked(&mut self) -> Vec<Vec<String>> {
        let mut blocks: Vec<(String, Vec<String>)> = vec![];
        for register in &self.scope.registers {
            let subject = self.signal_name(register.next).to_string();
            let mut text = |id| self.printer.value(&Expression::signal(self.scope, id), &subject);
            let (clock, value, next) = (text(register.clock), text(register.value), text(register.next));
            let line = format!("    {value} <= {next};");
            match blocks.iter_mut().find(|(of, _)| *of == clock) {
                Some((_, lines)) => lines.push(line),
                None => blocks.push((clock, vec![line])),
            }
        }
        let block = |(clock, lines): (String, Vec<String>)| {
            let first = format!("always @(posedge {clock}) begin");
            std::iter::once(first).chain(lines).chain(["end".to_string()]).collect()
        };
        blocks.into_iter().map(block).collect()
    }
}

/// Declarations: neighbours of one type share a line as long as it is no longer than a line should be.
fn together(signals: impl Iterator<Item = (String, String)>) -> Vec<String> {
    let mut lines: Vec<(String, String)> = vec![];
    for (of_type, name) in signals {
        match lines.last_mut() {
            Some((last, line)) if *last == of_type && line.len() + name.len() + 7 <= WIDTH => {
                *line += &format!(", {name}");
            }
            _ => lines.push((of_type.clone(), of_type + &name)),
        }
    }
    lines.into_iter().map(|(_, line)| line + ";").collect()
}

/// An instance and what belongs to it.
struct Written {
    instance: Instance,
    /// Values of the leaf's parameters.
    values: Vec<Value>,
    /// How often the loop turns.
    count: Option<(Constant, Value)>,
    /// Index of the tree's part.
    of: usize,
}

/// A leaf's parameters and their values; for an array `last` is its last part, which tells what is numbered, and the name of the digits.
fn parameters(kind: &Kind, last: Option<(&Kind, &str)>) -> (Of, Vec<LeafParameter>, Vec<Value>) {
    let leaf = match kind {
        Kind::Module { occurrence, .. } => return (Of::Module(occurrence.class), vec![], vec![]),
        Kind::Leaf(leaf, _) => leaf,
    };
    let other = |n: usize| match last {
        Some((Kind::Leaf(last, _), digits)) => Some((&last.parameters[n].1, digits)),
        _ => None,
    };
    let of = |(n, (name, text)): (usize, &(String, String))| {
        let numbered = other(n).filter(|(other, _)| *other != text).and_then(|(_, digits)| {
            let (before, after) = split_number(text)?;
            Some((before, digits, after))
        });
        match numbered {
            Some((before, digits, after)) => (
                LeafParameter { name: name.clone(), numbered: Some(format!(", {digits}, \"{after}")) },
                Value::plain(format!("{before}\"")),
            ),
            None => (LeafParameter { name: name.clone(), numbered: None }, Value::plain(text.clone())),
        }
    };
    let (parameters, values) = leaf.parameters.iter().enumerate().map(of).unzip();
    (Of::Leaf(leaf.module.clone()), parameters, values)
}

/// `BANKS` of `banks`.
pub(crate) fn count_name(array: &Array) -> String {
    array.key.replace('$', "_").to_uppercase()
}

/// `banks_sum` of `banks_sum[3]`.
fn array_name(element: &str) -> &str {
    element.split('[').next().unwrap_or(element)
}

/// A wire with its value, or a register that a process assigns.
fn declare(between: &Between) -> String {
    let (ty, name) = (of_type(between.ty), &between.name);
    match &between.value {
        Some(value) => format!("wire {ty}{name} = {value};"),
        None => format!("reg  {ty}{name};"),
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

/// A source as its own workspace names it. For a crate of another workspace, as Python's extension is, the compiler states where it lies on this machine.
fn in_workspace(source: &str) -> String {
    source.rsplit_once("/crates/").map_or_else(|| source.to_owned(), |(_, rest)| format!("crates/{rest}"))
}
