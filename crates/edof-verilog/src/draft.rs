//! One block as a module whose values are still open: what two blocks have in common is one [`Sheet`].

use std::collections::{BTreeSet, HashMap};

use rust_hdl::prelude::Verilog;

use crate::arrays::{self, Array, Pin, count_name};
use crate::collect::Tree;
use crate::constants::INTEGER;
use crate::cycles::{self, Path};
use crate::describe::Description;
use crate::error::{EmitError, Fault, rust_path};
use crate::expression::Expression;
use crate::kernel::Statement;
use crate::kind::{Kind, pins_of};
use crate::names::Names;
use crate::print::Printer;
use crate::process::{self, Process};
use crate::quiet::quieten;
use crate::scope::{Part, Role, Scope, SignalId};
use crate::sheet::Sheet;
use crate::single::{plain, single_elements};
use crate::text::range;
use crate::value::Value;
use crate::wiring::Wiring;
use crate::write::Writer;
use crate::{Direction, Port};
use crate::{blocks, edge, flow, kernel, live, order, simplify, tidy};

/// A block as a module.
pub(crate) struct Draft {
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

/// The sheet of a block whose parts have theirs; `kinds` has one entry for each part of the tree. The top keeps inputs that it does not read.
pub(crate) fn draft(
    tree: &Tree,
    description: &Description,
    kinds: &[Option<Kind>],
    is_top: bool,
    style: Style,
) -> Result<Draft, EmitError> {
    let kernel = match &tree.hdl {
        Verilog::Combinatorial(kernel) => kernel,
        other => return Err(EmitError::block(&tree.path, Fault::NotAKernel(what(other)))),
    };
    let mut scope = Scope::of(tree)?;
    let statements = kernel::lower(&scope, kernel)?;
    flow::check(&scope, &statements)?;
    let source = in_workspace(&source_of(&statements).unwrap_or_else(|| description.source.into()));
    let paths = paths_of_parts(&scope, kinds);
    let Logic { blocks, processes } = Logic::of(&mut scope, statements, &paths, style)?;
    let (processes, live) = live::prune(&scope, processes, &dropped(&scope, kinds));
    let edges: Vec<Path> = cycles::signal_edges(&scope, &processes).into_iter().chain(paths).collect();
    let paths = cycles::paths(&scope, &edges);
    let reads: BTreeSet<SignalId> =
        processes.iter().flat_map(|process| process.reads.iter().copied()).collect();

    let mut wired = Wired::of(&scope, tree, kinds, processes, &reads)?;
    if style == Style::Readable {
        wired.processes = blocks::join(&scope, wired.processes, &blocks, &edges);
    }
    let placed = placed(&scope, kinds, &wired.arrays);
    let order = order::order(&scope, &wired.processes, &placed, &wired.resolved);
    let mut names = Names::default();
    let has_port = |id: SignalId| is_top || scope.signals[id].role != Role::Input || live.contains(&id);
    let ports_of: Vec<SignalId> = (0..scope.signals.len())
        .filter(|id| matches!(scope.signals[*id].role, Role::Input | Role::Output) && has_port(*id))
        .collect();
    let single = single_elements(tree, &scope);
    let plain_key = |key: &str| match description.element(key) {
        Some((field, name, rest)) => format!("{field}_{name}{rest}"),
        None => plain(key, &single).into_owned(),
    };
    let mut signal_names =
        name_signals(&scope, kinds, &plain_key, &ports_of, &reads, &wired.arrays, &mut names);
    select_formulas(&scope, description, &mut signal_names);
    let writer = Writer {
        tree,
        scope: &scope,
        description,
        source: &source,
        wiring: &wired.wiring,
        processes: &wired.processes,
        arrays: &wired.arrays,
        ports: &ports_of,
        order: &order,
        paths: &paths,
        single: &single,
        kinds,
        printer: Printer::new(&scope, &wired.resolved, &signal_names, &mut names),
        declared: 0,
        named: BTreeSet::new(),
    };
    let (sheet, values, instances) = writer.sheet()?;
    let number = |id: SignalId| ports_of.iter().position(|port| *port == id);
    let paths = paths.into_iter().filter_map(|(from, to)| Some((number(from)?, number(to)?))).collect();
    Ok(Draft { sheet, values, ports: ports(&scope, &ports_of, &signal_names), paths, names, instances })
}

/// How the text says what the kernel says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Style {
    /// As people write it.
    #[default]
    Readable,
    /// Expressions as they are in Rust, a process for each target.
    Literal,
}

/// What a kernel computes.
struct Logic {
    /// The combinational blocks of the kernel, whole.
    blocks: Vec<Process>,
    /// A process for each target, and the clocked one last.
    processes: Vec<Process>,
}

impl Logic {
    fn of(
        scope: &mut Scope,
        statements: Vec<Statement>,
        paths: &[Path],
        style: Style,
    ) -> Result<Self, EmitError> {
        let tidy = |process: Process| match style {
            Style::Readable => Process::of(tidy::statements(process.statements), process.origin),
            Style::Literal => process,
        };
        let (statements, edge) = match style {
            Style::Readable => edge::split(scope, &tidy::statements(statements)),
            Style::Literal => (statements, None),
        };
        let blocks: Vec<Process> = process::split(scope, statements)?.into_iter().map(tidy).collect();
        let cut = quieten(scope, cycles::cut(scope, blocks.clone(), paths)?, paths);
        let simple = |process: Process| match style {
            Style::Readable => tidy(simplify::simplify(scope, tidy(process))),
            Style::Literal => process,
        };
        let chosen = |process: Process| match style {
            Style::Readable => Process::of(simplify::choices(scope, process.statements), process.origin),
            Style::Literal => process,
        };
        let processes = cut.into_iter().map(simple).chain(edge.map(tidy)).map(chosen).collect();
        Ok(Self { blocks, processes })
    }
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
        tree: &Tree,
        kinds: &[Option<Kind>],
        processes: Vec<Process>,
        reads: &BTreeSet<SignalId>,
    ) -> Result<Self, EmitError> {
        let mut candidates = arrays::candidates(scope, tree, kinds);
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

/// The Rust file of a kernel that says it.
fn source_of(statements: &[Statement]) -> Option<String> {
    statements.iter().find_map(|statement| match statement {
        Statement::Comment(note) if note.line.is_some() => Some(note.file.clone()),
        _ => None,
    })
}

/// A source as its own workspace names it. For a crate of another workspace, as Python's extension is, the compiler states where it lies on this machine.
fn in_workspace(source: &str) -> String {
    source.rsplit_once("/crates/").map_or_else(|| source.to_owned(), |(_, rest)| format!("crates/{rest}"))
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

/// The instances, loops of them by their first, and the signals at their pins; wires of loops are declared elsewhere.
fn placed(scope: &Scope, kinds: &[Option<Kind>], arrays: &[Array]) -> Vec<(usize, Vec<SignalId>)> {
    let pins = |n: usize| -> Vec<SignalId> {
        let part = &scope.parts[n];
        let pins = kinds[part.index].as_ref().map_or(vec![], |kind| pins_of(part, kind));
        pins.into_iter().map(|pin| pin.1).collect()
    };
    let is_input = |id: &SignalId| scope.signals[*id].role == Role::PartInput;
    let placed = |n: usize| match arrays.iter().find(|array| array.parts.contains(&n)) {
        None => kinds[scope.parts[n].index].is_some().then(|| (n, pins(n))),
        Some(array) if array.parts[0] == n => {
            Some((n, array.parts.iter().flat_map(|part| pins(*part)).filter(is_input).collect()))
        }
        Some(_) => None,
    };
    (0..scope.parts.len()).filter_map(placed).collect()
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

/// `_i` and `_o` for ports, `_q` and `_d` for registers, capitals for constants, `part_port` for wires between.
fn name_signals(
    scope: &Scope,
    kinds: &[Option<Kind>],
    plain_key: &dyn Fn(&str) -> String,
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
            // Ports keep their numbers, so that readers need not count them.
            let key = if ports.contains(&id) { signal.key.clone() } else { plain_key(&signal.key) };
            if let Some(wanted) = wanted(id, &key, &signal.role) {
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
    name(&|id, key, role| match role {
        Role::Register => Some(field(key, "$q") + "_q"),
        Role::Next => Some(field(key, "$d") + "_d"),
        Role::Constant(_) if scope.fixed(id).is_none() => Some(key.to_uppercase()),
        Role::Local => Some(key.into()),
        _ => None,
    });
    let plain_names = plain_names(scope);
    name(&|id, key, role| match role {
        Role::PartOutput if in_array.contains_key(&id) => None,
        Role::PartOutput if !reads.contains(&id) => Some(format!("{key}_unused")),
        Role::PartOutput if plain_names.contains_key(&id) => Some(plain_names[&id].clone()),
        Role::PartInput | Role::PartOutput => Some(key.into()),
        _ => None,
    });
    in_array.into_iter().for_each(|(id, name)| given[id] = name);
    given
}

/// A constant with a formula is a whole number, of which as many bits are read as the constant has.
fn select_formulas(scope: &Scope, description: &Description, names: &mut [String]) {
    for (signal, name) in scope.signals.iter().zip(names) {
        if matches!(signal.role, Role::Constant(_))
            && (2..INTEGER).contains(&signal.ty.bits)
            && description.formula(&signal.key, "").is_some()
        {
            *name += &range(0, signal.ty.bits);
        }
    }
}

/// Outputs of parts that are called as their port is, because no other signal is: a name of several words, or a long one.
fn plain_names(scope: &Scope) -> HashMap<SignalId, String> {
    let is_output = |id: &SignalId| scope.signals[*id].role == Role::PartOutput;
    let outputs = || scope.parts.iter().flat_map(|part| part.ports.iter()).filter(|(_, id)| is_output(id));
    let own: BTreeSet<&str> = (scope.signals.iter())
        .filter(|signal| !matches!(signal.role, Role::PartInput | Role::PartOutput | Role::Constant(_)))
        .map(|signal| signal.key.split('$').next().unwrap_or_default())
        .collect();
    let is_telling = |port: &str| port.len() > 5 || port.contains('_');
    let is_plain = |(port, _): &&(String, SignalId)| {
        is_telling(port)
            && !own.contains(port.as_str())
            && outputs().filter(|(other, _)| other == port).count() == 1
    };
    outputs().filter(is_plain).map(|(port, id)| (*id, port.clone())).collect()
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
