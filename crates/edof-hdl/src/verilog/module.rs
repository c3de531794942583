//! One block as the text of one module.

use std::collections::{BTreeSet, HashMap};

use rust_hdl::prelude::Verilog;

use super::collect::Tree;
use super::cycles::{self, Path};
use super::error::{EmitError, Fault};
use super::expression::{Expression, Node};
use super::flow;
use super::kernel;
use super::names::Names;
use super::print::{Between, Printer, comment, literal};
use super::process::{self, Process};
use super::scope::{Role, Scope, SignalId};
use super::types::Type;
use super::wiring::Wiring;
use super::{Direction, Port};
use crate::describe::Description;
use crate::leaf::Leaf;

/// Stands for the module's own name until all of its text is known.
pub(super) const NAME: &str = "\u{1}";

/// A module without its name.
pub(super) struct Draft {
    pub text: String,
    pub ports: Vec<Port>,
    pub paths: Vec<(usize, usize)>,
}

/// What a part is an instance of.
pub(super) enum Kind<'a> {
    /// A module of ours, its ports, and which of them follow which within a cycle.
    Module(&'a str, &'a [Port], &'a [(usize, usize)]),
    Leaf(Leaf),
}

/// The text of a block whose parts are modules or leaves already; `kinds` has one entry for each part of the scope.
pub(super) fn draft(
    tree: &Tree,
    description: &Description,
    kinds: &[Option<Kind>],
) -> Result<Draft, EmitError> {
    let kernel = match &tree.hdl {
        Verilog::Combinatorial(kernel) => kernel,
        other => return Err(EmitError::block(&tree.path, Fault::NotAKernel(what(other)))),
    };
    let scope = Scope::of(tree)?;
    let statements = kernel::lower(&scope, kernel)?;
    flow::check(&scope, &statements)?;
    let (known, possible) = paths_of_parts(&scope, kinds);
    let mut processes = cycles::cut(&scope, process::split(&scope, statements)?, &known, &possible)?;
    let paths = cycles::paths(&scope, &processes, &known);
    let reads: BTreeSet<SignalId> =
        processes.iter().flat_map(|process| process.reads.iter().copied()).collect();
    let wiring = Wiring::find(&scope, &mut processes)?;
    let resolved: Vec<Expression> =
        (0..scope.signals.len()).map(|id| wiring.resolve(&scope, id)).collect::<Result<_, _>>()?;
    let mut names = Names::default();
    let signal_names = name_signals(&scope, &reads, &mut names);
    let instances: Vec<String> =
        scope.parts.iter().map(|part| names.take(&tree.parts[part.index].key)).collect();
    let mut writer = Writer {
        tree,
        scope: &scope,
        wiring: &wiring,
        printer: Printer::new(&scope, &resolved, &signal_names, &mut names),
        processes: &processes,
    };
    let text = writer.module(description, kinds, &instances)?;
    let of_port = port_numbers(&scope);
    let paths = paths.into_iter().map(|(from, to)| (of_port[&from], of_port[&to])).collect();
    Ok(Draft { text, ports: ports(&scope, &signal_names), paths })
}

/// Number of each port among the block's ports.
fn port_numbers(scope: &Scope) -> HashMap<SignalId, usize> {
    let is_port = |id: &SignalId| matches!(scope.signals[*id].role, Role::Input | Role::Output);
    (0..scope.signals.len()).filter(is_port).enumerate().map(|(number, id)| (id, number)).collect()
}

/// Which outputs of parts follow which of their inputs, and which may: of leaves nothing is known.
fn paths_of_parts(scope: &Scope, kinds: &[Option<Kind>]) -> (Vec<Path>, Vec<Path>) {
    let (mut known, mut possible) = (vec![], vec![]);
    for part in &scope.parts {
        let id = |port: usize| part.ports[port].1;
        match &kinds[part.index] {
            Some(Kind::Module(_, _, paths)) => {
                known.extend(paths.iter().map(|(from, to)| (id(*from), id(*to))))
            }
            Some(Kind::Leaf(_)) => {
                let of = |role| {
                    part.ports.iter().map(|port| port.1).filter(move |id| scope.signals[*id].role == role)
                };
                let data = || of(Role::PartInput).filter(|id| !scope.signals[*id].is_clock);
                possible.extend(data().flat_map(|from| of(Role::PartOutput).map(move |to| (from, to))));
            }
            None => {}
        }
    }
    (known, possible)
}

fn what(hdl: &Verilog) -> &'static str {
    match hdl {
        Verilog::Empty => "empty",
        Verilog::Combinatorial(_) => "a kernel",
        Verilog::Custom(_) => "Verilog text",
        Verilog::Blackbox(_) => "a black box",
        Verilog::Wrapper(_) => "a wrapper",
    }
}

/// `_i` and `_o` for ports, `_q` and `_d` for registers, capitals for constants, `part_port` for wires between.
fn name_signals(scope: &Scope, reads: &BTreeSet<SignalId>, names: &mut Names) -> Vec<String> {
    let mut given = vec![String::new(); scope.signals.len()];
    let mut name = |wanted: &dyn Fn(SignalId, &str, &Role) -> Option<String>| {
        for (id, signal) in scope.signals.iter().enumerate() {
            if let Some(wanted) = wanted(id, &signal.key, &signal.role) {
                given[id] = names.take(&wanted);
            }
        }
    };
    name(&|_, key, role| match role {
        Role::Input => Some(format!("{key}_i")),
        Role::Output => Some(format!("{key}_o")),
        _ => None,
    });
    name(&|_, key, role| match role {
        Role::Register => Some(key.strip_suffix("$q").map(|field| format!("{field}_q")).unwrap_or_default()),
        Role::Next => Some(key.strip_suffix("$d").map(|field| format!("{field}_d")).unwrap_or_default()),
        Role::Constant(_) => Some(key.to_uppercase()),
        Role::Local => Some(key.into()),
        _ => None,
    });
    name(&|id, key, role| match role {
        Role::PartOutput if !reads.contains(&id) => Some(format!("{key}_unused")),
        Role::PartInput | Role::PartOutput => Some(key.into()),
        _ => None,
    });
    given
}

fn ports(scope: &Scope, names: &[String]) -> Vec<Port> {
    let ports = scope.signals.iter().enumerate().filter_map(|(id, signal)| {
        let direction = match signal.role {
            Role::Input => Direction::Input,
            Role::Output => Direction::Output,
            _ => return None,
        };
        Some(Port {
            field: super::error::rust_path(&signal.key),
            name: names[id].clone(),
            direction,
            bits: signal.ty.bits,
            signed: signal.ty.signed,
            is_clock: signal.is_clock,
        })
    });
    ports.collect()
}

struct Writer<'a> {
    tree: &'a Tree,
    scope: &'a Scope,
    wiring: &'a Wiring,
    printer: Printer<'a>,
    processes: &'a [Process],
}

impl Writer<'_> {
    fn module(
        &mut self,
        description: &Description,
        kinds: &[Option<Kind>],
        instances: &[String],
    ) -> Result<String, EmitError> {
        let logic = self.logic()?;
        let parts = self.parts(kinds, instances);
        let clocked = self.clocked();
        let paragraphs = [self.constants(), self.signals(), self.between()];
        let mut text = header(description);
        text += &format!("`default_nettype none\n\nmodule {NAME} (\n{}\n);\n", self.ports().join(",\n"));
        for lines in
            paragraphs.into_iter().chain(parts).chain(logic).chain(clocked).filter(|lines| !lines.is_empty())
        {
            text.push('\n');
            lines.iter().for_each(|line| {
                text += &if line.is_empty() { "\n".into() } else { format!("    {line}\n") }
            });
        }
        text += "endmodule\n\n`default_nettype wire\n";
        Ok(text)
    }

    fn name(&self, id: SignalId) -> &str {
        &self.printer.signal_names[id]
    }

    fn ports(&self) -> Vec<String> {
        let registered = self.registered();
        let ports: Vec<(&str, SignalId)> = (0..self.scope.signals.len())
            .filter_map(|id| match self.scope.signals[id].role {
                Role::Input => Some(("input  wire", id)),
                Role::Output if registered.contains(&id) => Some(("output reg ", id)),
                Role::Output => Some(("output wire", id)),
                _ => None,
            })
            .collect();
        let width = ports.iter().map(|(_, id)| of_type(self.scope.signals[*id].ty).len()).max().unwrap_or(0);
        let line = |(kind, id): &(&str, SignalId)| {
            format!("    {kind} {:width$}{}", of_type(self.scope.signals[*id].ty), self.name(*id))
        };
        ports.iter().map(line).collect()
    }

    /// What `always @*` blocks drive.
    fn registered(&self) -> BTreeSet<SignalId> {
        let blocks = self.processes.iter().filter(|process| process.plain().is_none());
        blocks.flat_map(|process| process.targets.iter().copied()).collect()
    }

    fn constants(&self) -> Vec<String> {
        let constants = self.printer.constants.iter().map(|&id| {
            let signal = &self.scope.signals[id];
            let Role::Constant(value) = &signal.role else { return String::new() };
            format!("localparam {}{} = {};", of_type(signal.ty), self.name(id), pattern(signal.ty, value))
        });
        let states = self.printer.states.values().map(|(name, state)| {
            let ty = Type::bits(state.bits);
            format!("localparam {}{name} = {};", of_type(ty), literal(ty, state.value as i128))
        });
        constants.chain(states).collect()
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
        let declare = |id: SignalId| {
            let signal = &self.scope.signals[id];
            let kind = match signal.role {
                Role::Register => "reg ",
                Role::Local | Role::Next | Role::PartInput if registered.contains(&id) => "reg ",
                Role::Local | Role::Next | Role::PartInput if driven.contains(&id) => "wire",
                Role::PartOutput if !self.wiring.is_replaced(id) => "wire",
                _ => return None,
            };
            Some(format!("{kind} {}{}{};", of_type(signal.ty), self.name(id), start(id)))
        };
        (0..self.scope.signals.len()).filter_map(declare).collect()
    }

    /// Values in between, each after those that it is made from.
    fn between(&self) -> Vec<String> {
        let mut lines = vec![];
        let mut is_quiet = false;
        for between in &self.printer.between {
            if between.in_part && !is_quiet {
                lines.push("// Only a part of what follows is used.".to_string());
                lines.push("/* verilator lint_off UNUSED */".into());
            } else if is_quiet && !between.in_part {
                lines.push("/* verilator lint_on UNUSED */".into());
            }
            is_quiet = between.in_part;
            lines.push(declare(between));
        }
        if is_quiet {
            lines.push("/* verilator lint_on UNUSED */".into());
        }
        lines
    }

    /// Assignments and `always @*` blocks, one paragraph for each run of assignments and each block.
    fn logic(&mut self) -> Result<Vec<Vec<String>>, EmitError> {
        let mut paragraphs: Vec<Vec<String>> = vec![];
        let mut after_assign = false;
        for process in self.processes {
            let Some(assign) = process.plain() else {
                self.check_started(process)?;
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
            let name = self.name(assign.target).to_string();
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

    /// `always @*` waits for a change of what it reads.
    fn check_started(&self, process: &Process) -> Result<(), EmitError> {
        let changes = |id: &SignalId| match self.printer.resolved[*id].node {
            Node::Signal(id) => {
                !matches!(self.scope.signals[id].role, Role::Constant(_)) && !process.targets.contains(&id)
            }
            _ => false,
        };
        if process.reads.iter().any(changes) {
            return Ok(());
        }
        let key = process.targets.first().map(|id| self.scope.signals[*id].key.as_str()).unwrap_or_default();
        Err(EmitError::field(&self.tree.path, key, Fault::Constant))
    }

    fn parts(&mut self, kinds: &[Option<Kind>], instances: &[String]) -> Vec<Vec<String>> {
        let scope = self.scope;
        let mut paragraphs = vec![];
        for (part, instance) in scope.parts.iter().zip(instances) {
            let Some(kind) = &kinds[part.index] else { continue };
            let (module, parameters, ports) = match kind {
                Kind::Module(name, ports, _) => {
                    (*name, &[][..], ports.iter().map(|port| port.name.clone()).collect())
                }
                Kind::Leaf(leaf) => (leaf.module.as_str(), &leaf.parameters[..], leaf_ports(leaf, part)),
            };
            let pins: Vec<String> =
                part.ports.iter().zip(ports).map(|((_, id), port)| self.pin(&port, *id)).collect();
            paragraphs.push(instance_lines(module, parameters, instance, &pins));
        }
        paragraphs
    }

    fn pin(&mut self, port: &str, id: SignalId) -> String {
        let value = Expression::signal(self.scope, id);
        format!(".{port}({})", self.printer.value(&value, ""))
    }

    /// One block for all registers of a clock.
    fn clocked(&mut self) -> Vec<Vec<String>> {
        let mut blocks: Vec<(String, Vec<String>)> = vec![];
        for register in &self.scope.registers {
            let mut text = |id| self.printer.value(&Expression::signal(self.scope, id), "");
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

fn header(description: &Description) -> String {
    let lines = description
        .header
        .trim()
        .lines()
        .map(|line| format!("// {}", line.trim()).trim_end().to_string() + "\n");
    lines.collect::<String>() + &format!("//\n// From {} ({}).\n", description.source, description.name)
}

/// The leaf's own names, in the order of the part's signals.
fn leaf_ports(leaf: &Leaf, part: &super::scope::Part) -> Vec<String> {
    let name =
        |field: &String| leaf.ports.iter().find(|(_, port)| port == field).map(|(name, _)| name.clone());
    part.ports.iter().map(|(field, _)| name(field).unwrap_or_default()).collect()
}

fn instance_lines(
    module: &str,
    parameters: &[(String, String)],
    instance: &str,
    pins: &[String],
) -> Vec<String> {
    let list = |items: &[String]| {
        let last = items.len().saturating_sub(1);
        let line = |(i, item): (usize, &String)| format!("    {item}{}", if i == last { "" } else { "," });
        items.iter().enumerate().map(line).collect::<Vec<_>>()
    };
    let mut lines = vec![];
    if parameters.is_empty() {
        lines.push(format!("{module} {instance} ("));
    } else {
        let values: Vec<String> =
            parameters.iter().map(|(name, value)| format!(".{name}({value})")).collect();
        lines.push(format!("{module} #("));
        lines.extend(list(&values));
        lines.push(format!(") {instance} ("));
    }
    lines.extend(list(pins));
    lines.push(");".into());
    lines
}

/// A wire with its value, or a register that a process assigns.
fn declare(between: &Between) -> String {
    let (ty, name) = (of_type(between.ty), &between.name);
    match &between.value {
        Some(value) => format!("wire {ty}{name} = {value};"),
        None => format!("reg  {ty}{name};"),
    }
}

/// `signed [15:0] ` before a name; nothing for one bit.
fn of_type(ty: Type) -> String {
    let signed = if ty.signed { "signed " } else { "" };
    let range = if ty.bits > 1 { format!("[{}:0] ", ty.bits - 1) } else { String::new() };
    signed.to_string() + &range
}

/// A constant from its hexadecimal digits.
fn pattern(ty: Type, digits: &str) -> String {
    let digits = digits.trim_start_matches('0');
    let digits = if digits.is_empty() { "0" } else { digits };
    format!("{}'{}h{digits}", ty.bits, if ty.signed { "s" } else { "" })
}
