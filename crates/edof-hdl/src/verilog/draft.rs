//! One block as a module whose values are still open: what two blocks have in common is one [`Sheet`].

use std::collections::{BTreeSet, HashMap};

use rust_hdl::prelude::Verilog;

use super::arrays::{self, Array, Pin};
use super::collect::Tree;
use super::cycles::{self, Path};
use super::error::{EmitError, Fault, rust_path};
use super::expression::{Expression, Node};
use super::names::Names;
use super::print::Printer;
use super::process::{self, Process};
use super::scope::{Part, Role, Scope, SignalId};
use super::sheet::Sheet;
use super::value::Value;
use super::wiring::Wiring;
use super::write::{Writer, count_name};
use super::{Direction, Port};
use super::{flow, kernel, live, simplify};
use crate::describe::Description;
use crate::leaf::Leaf;

/// A block as a module.
pub(super) struct Draft {
    pub sheet: Sheet,
    /// Values of the sheet's slots: constants, then the parameters of leaves.
    pub values: Vec<Value>,
    pub ports: Vec<Port>,
    /// Which of the ports follow which within a cycle.
    pub paths: Vec<(usize, usize)>,
    /// The names that are taken in the module.
    pub names: Names,
    /// The tree's part that each instance of the sheet stands for.
    pub instances: Vec<usize>,
}

/// One block of the circuit: its module, the values of the module's slots, the same of its instances.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Occurrence {
    pub class: usize,
    pub values: Vec<Value>,
    /// None for leaves.
    pub parts: Vec<Option<Occurrence>>,
}

/// What a part is an instance of.
pub(super) enum Kind<'a> {
    /// A module of ours, its ports, and which of them follow which within a cycle.
    Module { occurrence: &'a Occurrence, ports: &'a [Port], paths: &'a [(usize, usize)] },
    /// A leaf, and which of its ports follow which within a cycle.
    Leaf(Leaf, Vec<(String, String)>),
}

impl Kind<'_> {
    /// Whether one of its pins follows another within a cycle.
    pub fn has_path(&self, from: &str, to: &str) -> bool {
        match self {
            Kind::Module { paths, ports, .. } => {
                paths.iter().any(|(input, output)| ports[*input].name == from && ports[*output].name == to)
            }
            Kind::Leaf(_, paths) => paths.iter().any(|(input, output)| input == from && output == to),
        }
    }

    /// Which parameters of a leaf the other has otherwise.
    pub fn differs(&self, other: &Self) -> Vec<bool> {
        match (self, other) {
            (Kind::Leaf(one, _), Kind::Leaf(other, _)) => {
                one.parameters.iter().zip(&other.parameters).map(|(one, other)| one != other).collect()
            }
            _ => vec![],
        }
    }

    /// Whether the other, number `i` of an array whose number 0 this is, is the same but for its number.
    pub fn is_like(&self, other: &Self, i: usize) -> bool {
        match (self, other) {
            (Kind::Module { occurrence: one, .. }, Kind::Module { occurrence: other, .. }) => one == other,
            (Kind::Leaf(one, _), Kind::Leaf(other, _)) => {
                let alike = |(one, other): (&(String, String), &(String, String))| {
                    one.0 == other.0 && (one.1 == other.1 || numbered(&one.1, i).as_ref() == Some(&other.1))
                };
                let count = one.parameters.len() == other.parameters.len();
                one.module == other.module
                    && one.ports == other.ports
                    && count
                    && one.parameters.iter().zip(&other.parameters).all(alike)
            }
            _ => false,
        }
    }
}

/// The text with its last `00` replaced by the number.
fn numbered(text: &str, number: usize) -> Option<String> {
    let (before, after) = split_number(text)?;
    Some(format!("{before}{number:02}{after}"))
}

/// What stands before and after the last `00` of a text.
pub(super) fn split_number(text: &str) -> Option<(&str, &str)> {
    text.starts_with('"').then_some(())?;
    text.rfind("00").map(|at| (&text[..at], &text[at + 2..]))
}

/// The sheet of a block whose parts have theirs; `kinds` has one entry for each part of the tree. The top keeps inputs that it does not read.
pub(super) fn draft(
    tree: &Tree,
    description: &Description,
    kinds: &[Option<Kind>],
    is_top: bool,
) -> Result<Draft, EmitError> {
    let kernel = match &tree.hdl {
        Verilog::Combinatorial(kernel) => kernel,
        other => return Err(EmitError::block(&tree.path, Fault::NotAKernel(what(other)))),
    };
    let scope = Scope::of(tree)?;
    let statements = kernel::lower(&scope, kernel)?;
    flow::check(&scope, &statements)?;
    let paths = paths_of_parts(&scope, kinds);
    let processes = cycles::cut(&scope, process::split(&scope, statements)?, &paths)?;
    let processes: Vec<Process> =
        processes.into_iter().map(|process| simplify::simplify(&scope, process)).collect();
    let (processes, live) = live::prune(&scope, processes, &dropped(&scope, kinds));
    let paths = cycles::paths(&scope, &processes, &paths);
    let reads: BTreeSet<SignalId> =
        processes.iter().flat_map(|process| process.reads.iter().copied()).collect();

    let keys: Vec<&str> = tree.parts.iter().map(|part| part.key.as_str()).collect();
    let wired = Wired::of(&scope, &keys, kinds, processes, &reads)?;
    let mut names = Names::default();
    let has_port = |id: SignalId| is_top || scope.signals[id].role != Role::Input || live.contains(&id);
    let ports_of: Vec<SignalId> = (0..scope.signals.len())
        .filter(|id| matches!(scope.signals[*id].role, Role::Input | Role::Output) && has_port(*id))
        .collect();
    let single = single_elements(tree, &scope);
    let signal_names = name_signals(&scope, kinds, &single, &ports_of, &reads, &wired.arrays, &mut names);
    let writer = Writer {
        tree,
        scope: &scope,
        description,
        wiring: &wired.wiring,
        processes: &wired.processes,
        arrays: &wired.arrays,
        ports: &ports_of,
        single: &single,
        kinds,
        printer: Printer::new(&scope, &wired.resolved, &signal_names, &mut names),
    };
    let (sheet, values, instances) = writer.sheet()?;
    let number = |id: SignalId| ports_of.iter().position(|port| *port == id);
    let paths = paths.into_iter().filter_map(|(from, to)| Some((number(from)?, number(to)?))).collect();
    Ok(Draft { sheet, values, ports: ports(&scope, &ports_of, &signal_names), paths, names, instances })
}

/// The processes that are left when parts are connected, and what stands for what.
struct Wired {
    wiring: Wiring,
    processes: Vec<Process>,
    resolved: Vec<Expression>,
    arrays: Vec<Array>,
}

impl Wired {
    fn of(
        scope: &Scope,
        keys: &[&str],
        kinds: &[Option<Kind>],
        processes: Vec<Process>,
        reads: &BTreeSet<SignalId>,
    ) -> Result<Self, EmitError> {
        let mut candidates = arrays::candidates(scope, keys, kinds);
        loop {
            let own = arrays::outputs(scope, candidates.iter().flat_map(|(_, parts)| parts));
            let mut left = processes.clone();
            let wiring = Wiring::find(scope, &mut left, &own, reads)?;
            let resolved: Vec<Expression> =
                (0..scope.signals.len()).map(|id| wiring.resolve(scope, id)).collect::<Result<_, _>>()?;
            let all = candidates.len();
            let arrays: Vec<Array> =
                candidates.iter().filter_map(|array| Array::of(scope, array, kinds, &resolved)).collect();
            if arrays.len() == all {
                return Ok(Self { wiring, processes: left, resolved, arrays });
            }
            // What is no loop is connected anew, without wires of its own.
            candidates.retain(|(key, _)| arrays.iter().any(|array| array.key == *key));
        }
    }
}

/// Pins of an instance: the module's name for each, and the signal, in the module's order.
pub(super) fn pins_of(part: &Part, kind: &Kind) -> Vec<(String, SignalId)> {
    match kind {
        Kind::Module { ports, .. } => {
            let of = |port: &Port| part.ports.iter().find(|(key, _)| rust_path(key) == port.field);
            ports.iter().filter_map(|port| Some((port.name.clone(), of(port)?.1))).collect()
        }
        Kind::Leaf(leaf, _) => {
            let name =
                |field: &str| leaf.ports.iter().find(|(_, of)| of == field).map(|(name, _)| name.clone());
            part.ports.iter().filter_map(|(key, id)| Some((name(key)?, *id))).collect()
        }
    }
}

/// Inputs of parts whose module does not read them.
fn dropped(scope: &Scope, kinds: &[Option<Kind>]) -> BTreeSet<SignalId> {
    let of_part = |part: &Part| -> Vec<SignalId> {
        let pins: Vec<SignalId> = match &kinds[part.index] {
            Some(kind) => pins_of(part, kind).into_iter().map(|pin| pin.1).collect(),
            None => vec![],
        };
        let inputs = part.ports.iter().map(|port| port.1);
        inputs.filter(|id| !pins.contains(id) && scope.signals[*id].role == Role::PartInput).collect()
    };
    scope.parts.iter().flat_map(of_part).collect()
}

/// Which outputs of parts follow which of their inputs within a cycle.
fn paths_of_parts(scope: &Scope, kinds: &[Option<Kind>]) -> Vec<Path> {
    let of_part = |part: &Part| -> Vec<Path> {
        let Some(kind) = &kinds[part.index] else { return vec![] };
        let pins = pins_of(part, kind);
        match kind {
            Kind::Module { paths, .. } => {
                paths.iter().map(|(from, to)| (pins[*from].1, pins[*to].1)).collect()
            }
            Kind::Leaf(_, paths) => {
                let id = |name: &str| pins.iter().find(|pin| pin.0 == name).map(|pin| pin.1);
                paths.iter().filter_map(|(from, to)| Some((id(from)?, id(to)?))).collect()
            }
        }
    };
    scope.parts.iter().flat_map(of_part).collect()
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

/// Arrays of one element: its number says nothing.
fn single_elements(tree: &Tree, scope: &Scope) -> Vec<String> {
    let keys = tree.parts.iter().map(|part| part.key.as_str());
    let keys: Vec<&str> = keys.chain(scope.signals.iter().map(|signal| signal.key.as_str())).collect();
    let first = keys.iter().filter_map(|key| key.strip_suffix("$0"));
    first.filter(|base| !keys.contains(&format!("{base}$1").as_str())).map(String::from).collect()
}

/// The key without the number of an array's only element.
pub(super) fn plain<'k>(key: &'k str, single: &[String]) -> std::borrow::Cow<'k, str> {
    for base in single {
        if let Some(rest) = key.strip_prefix(base.as_str()).and_then(|rest| rest.strip_prefix("$0"))
            && (rest.is_empty() || rest.starts_with('$'))
        {
            return format!("{base}{rest}").into();
        }
    }
    key.into()
}

/// `_i` and `_o` for ports, `_q` and `_d` for registers, capitals for constants, `part_port` for wires between.
fn name_signals(
    scope: &Scope,
    kinds: &[Option<Kind>],
    single: &[String],
    ports: &[SignalId],
    reads: &BTreeSet<SignalId>,
    arrays: &[Array],
    names: &mut Names,
) -> Vec<String> {
    let mut given = vec![String::new(); scope.signals.len()];
    arrays.iter().for_each(|array| names.reserve(&count_name(array)));
    let in_array = name_array_outputs(scope, kinds, reads, arrays, names);
    let mut name = |wanted: &dyn Fn(SignalId, &str, &Role) -> Option<String>| {
        for (id, signal) in scope.signals.iter().enumerate() {
            if let Some(wanted) = wanted(id, &plain(&signal.key, single), &signal.role) {
                given[id] = names.take(&wanted);
            }
        }
    };
    name(&|id, key, role| match role {
        Role::Input if ports.contains(&id) => Some(format!("{key}_i")),
        Role::Output => Some(format!("{key}_o")),
        _ => None,
    });
    let field = |key: &str, port: &str| {
        let field = key.strip_suffix(port).unwrap_or(key);
        field.strip_suffix("_q").unwrap_or(field).to_string()
    };
    name(&|_, key, role| match role {
        Role::Register => Some(field(key, "$q") + "_q"),
        Role::Next => Some(field(key, "$d") + "_d"),
        Role::Constant(_) => Some(key.to_uppercase()),
        Role::Local => Some(key.into()),
        _ => None,
    });
    name(&|id, key, role| match role {
        Role::PartOutput if in_array.contains_key(&id) => None,
        Role::PartOutput if !reads.contains(&id) => Some(format!("{key}_unused")),
        Role::PartInput | Role::PartOutput => Some(key.into()),
        _ => None,
    });
    in_array.into_iter().for_each(|(id, name)| given[id] = name);
    given
}

/// `banks_sum[3]`: the outputs of an array's parts are one array of wires.
fn name_array_outputs(
    scope: &Scope,
    kinds: &[Option<Kind>],
    reads: &BTreeSet<SignalId>,
    arrays: &[Array],
    names: &mut Names,
) -> HashMap<SignalId, String> {
    let mut given = HashMap::new();
    for array in arrays {
        let elements: Vec<Vec<SignalId>> =
            (0..array.parts.len()).map(|element| array.signals(scope, kinds, element)).collect();
        for (n, pin) in array.pins.iter().enumerate() {
            let Pin::Output { next } = pin else { continue };
            let key = &scope.signals[elements[0][n]].key;
            let port = key.strip_prefix(&format!("{}$0$", array.key)).unwrap_or(key);
            let is_read = elements.iter().any(|signals| reads.contains(&signals[n]));
            let name = names.take(&format!("{}_{port}{}", array.key, if is_read { "" } else { "_unused" }));
            // Where each reads the one before, the first element is what the first part reads.
            let first = usize::from(*next == Some(false));
            given.extend(
                elements
                    .iter()
                    .enumerate()
                    .map(|(i, signals)| (signals[n], format!("{name}[{}]", i + first))),
            );
        }
    }
    given
}

fn ports(scope: &Scope, ports: &[SignalId], names: &[String]) -> Vec<Port> {
    let port = |id: &SignalId| {
        let signal = &scope.signals[*id];
        Port {
            field: rust_path(&signal.key),
            name: names[*id].clone(),
            direction: if signal.role == Role::Input { Direction::Input } else { Direction::Output },
            bits: signal.ty.bits,
            signed: signal.ty.signed,
            is_clock: signal.is_clock,
        }
    };
    ports.iter().map(port).collect()
}

/// Whether the process waits for something: `always @*` does not start by itself.
pub(super) fn is_started(scope: &Scope, resolved: &[Expression], process: &Process) -> bool {
    let changes = |id: &SignalId| match resolved[*id].node {
        Node::Signal(id) => {
            !matches!(scope.signals[id].role, Role::Constant(_)) && !process.targets.contains(&id)
        }
        _ => false,
    };
    process.reads.iter().any(changes)
}
