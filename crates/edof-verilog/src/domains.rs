//! Which clock each signal belongs to: from one clock domain to another leads nothing but a leaf that is made for it.
//!
//! A register belongs to its clock, and so does what follows it within the cycle. Of a block it is known which outputs come from
//! registers of which clock, and which inputs go to them; so a block is looked at by itself, and the top at last.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use rust_hdl::prelude::{AtomKind, Verilog};

use crate::collect::Tree;
use crate::cycles::{Sources, collect};
use crate::error::{EmitError, Fault, rust_path};
use crate::expression::Node;
use crate::kernel::{self, Statement};
use crate::leaf::Leaf;
use crate::scope::{Role, Scope, SignalId};
use crate::single::{plain, single_elements};

/// An instance of a leaf that leads from one clock domain to another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crossing {
    /// Names of the instances from the top down.
    pub path: Vec<String>,
    /// The leaf.
    pub leaf: String,
    /// Clocks of the crossing: port of the leaf, and the clock of the top that drives it.
    pub clocks: Vec<(String, String)>,
}

/// What is known of a block from outside, by the names of its ports.
#[derive(Default)]
struct Summary {
    /// Outputs, and the clocks whose registers they come from.
    launches: BTreeSet<(String, String)>,
    /// Inputs, and the clocks whose registers take them.
    captures: BTreeSet<(String, String)>,
    /// Inputs, and outputs that follow them within the cycle.
    paths: BTreeSet<(String, String)>,
    crossings: Vec<Crossing>,
}

/// Where the value of a signal comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Origin {
    /// Registers of a clock.
    Clock(SignalId),
    /// An input of the block.
    Input(SignalId),
}

/// The crossings of a circuit.
///
/// # Errors
/// [`Fault::Crossing`] where something else leads from one domain to another.
pub(crate) fn check(top: &Tree) -> Result<Vec<Crossing>, EmitError> {
    let summary = block(top)?;
    for (input, clock) in &summary.captures {
        if let Some((_, other)) =
            summary.captures.iter().find(|(name, other)| name == input && other != clock)
        {
            let fault = Fault::Crossing(rust_path(other), rust_path(clock));
            return Err(EmitError::field(&top.path, input, fault));
        }
    }
    for (output, clock) in &summary.launches {
        if let Some((_, other)) =
            summary.launches.iter().find(|(name, other)| name == output && other != clock)
        {
            let fault = Fault::Crossing(rust_path(other), rust_path(clock));
            return Err(EmitError::field(&top.path, output, fault));
        }
    }
    Ok(summary.crossings)
}

/// Whether a way from one clock domain to another stands in a block.
pub(crate) fn crosses(tree: &Tree) -> bool {
    let is_crossing = Leaf::of(&tree.hdl).is_some_and(|leaf| leaf.crossing.is_some());
    is_crossing || tree.parts.iter().any(crosses)
}

fn block(tree: &Tree) -> Result<Summary, EmitError> {
    let Verilog::Combinatorial(code) = &tree.hdl else { return Ok(Summary::default()) };
    let scope = Scope::of(tree)?;
    let statements = kernel::lower(&scope, code)?;
    let mut view = View::new(tree, &scope, &statements);
    view.parts()?;
    view.registers();
    view.spread();
    view.summary()
}

/// Signals that are another signal and nothing else: clocks are.
fn drivers(statements: &[Statement]) -> HashMap<SignalId, SignalId> {
    let plain = statements.iter().filter_map(|statement| match statement {
        Statement::Assign(assign) => match assign.value.node {
            Node::Signal(from) => Some((assign.target, from)),
            _ => None,
        },
        _ => None,
    });
    plain.collect()
}

/// From every signal to those that follow it directly.
fn edges(statements: &[Statement]) -> BTreeSet<(SignalId, SignalId)> {
    let mut sources = Sources::new();
    collect(statements, &BTreeSet::new(), &mut sources);
    sources.into_iter().flat_map(|(target, from)| from.into_iter().map(move |from| (from, target))).collect()
}

struct View<'a> {
    tree: &'a Tree,
    scope: &'a Scope,
    drivers: HashMap<SignalId, SignalId>,
    edges: BTreeSet<(SignalId, SignalId)>,
    origins: Vec<BTreeSet<Origin>>,
    /// Signals that registers take, and their clocks.
    taken: Vec<(SignalId, SignalId)>,
    crossings: Vec<Crossing>,
}

impl<'a> View<'a> {
    fn new(tree: &'a Tree, scope: &'a Scope, statements: &[Statement]) -> Self {
        let origins = scope.signals.iter().enumerate().map(|(id, signal)| match signal.role {
            Role::Input if !signal.is_clock => BTreeSet::from([Origin::Input(id)]),
            _ => BTreeSet::new(),
        });
        let (drivers, edges) = (drivers(statements), edges(statements));
        Self { tree, scope, drivers, edges, origins: origins.collect(), taken: vec![], crossings: vec![] }
    }

    /// The signal that a clock is, where it comes into the block.
    fn clock(&self, mut id: SignalId) -> SignalId {
        for _ in 0..self.scope.signals.len() {
            match self.drivers.get(&id) {
                Some(from) => id = *from,
                None => break,
            }
        }
        id
    }

    fn registers(&mut self) {
        for register in &self.scope.registers {
            let clock = self.clock(register.clock);
            self.origins[register.value].insert(Origin::Clock(clock));
            self.taken.push((register.next, clock));
        }
    }

    fn parts(&mut self) -> Result<(), EmitError> {
        let single = single_elements(self.tree, self.scope);
        for part in &self.scope.parts {
            let tree = &self.tree.parts[part.index];
            let ids: BTreeMap<&str, SignalId> =
                part.ports.iter().map(|(key, id)| (key.as_str(), *id)).collect();
            let summary = match Leaf::of(&tree.hdl) {
                Some(leaf) => leaf_summary(tree, &leaf)?,
                None => block(tree)?,
            };
            let id = |key: &String| ids.get(key.as_str()).copied();
            for (output, clock) in &summary.launches {
                if let (Some(output), Some(clock)) = (id(output), id(clock)) {
                    let clock = self.clock(clock);
                    self.origins[output].insert(Origin::Clock(clock));
                }
            }
            for (input, clock) in &summary.captures {
                if let (Some(input), Some(clock)) = (id(input), id(clock)) {
                    self.taken.push((input, self.clock(clock)));
                }
            }
            self.edges.extend(summary.paths.iter().filter_map(|(from, to)| Some((id(from)?, id(to)?))));
            let name = plain(&tree.key, &single).replace('$', "_");
            for mut crossing in summary.crossings {
                crossing.path.insert(0, name.clone());
                for (_, clock) in &mut crossing.clocks {
                    if let Some(id) = id(clock) {
                        *clock = self.scope.signals[self.clock(id)].key.clone();
                    }
                }
                self.crossings.push(crossing);
            }
        }
        Ok(())
    }

    /// Lets every signal know where its value comes from.
    fn spread(&mut self) {
        let mut follows: Vec<Vec<SignalId>> = vec![vec![]; self.scope.signals.len()];
        self.edges.iter().for_each(|(from, to)| follows[*from].push(*to));
        let mut open: Vec<SignalId> = (0..self.scope.signals.len()).collect();
        while let Some(id) = open.pop() {
            for to in &follows[id] {
                let before = self.origins[*to].len();
                let more = self.origins[id].clone();
                self.origins[*to].extend(more);
                if self.origins[*to].len() > before {
                    open.push(*to);
                }
            }
        }
    }

    fn key(&self, id: SignalId) -> String {
        self.scope.signals[id].key.clone()
    }

    fn summary(self) -> Result<Summary, EmitError> {
        let mut summary = Summary::default();
        for (signal, clock) in &self.taken {
            for origin in &self.origins[*signal] {
                match origin {
                    Origin::Clock(other) if other != clock => {
                        let names = [*other, *clock].map(|id| rust_path(&self.key(id)));
                        let [from, to] = names;
                        let key = self.key(*signal);
                        return Err(EmitError::field(&self.scope.path, &key, Fault::Crossing(from, to)));
                    }
                    Origin::Clock(_) => {}
                    Origin::Input(input) => _ = summary.captures.insert((self.key(*input), self.key(*clock))),
                }
            }
        }
        let outputs = self.scope.signals.iter().enumerate().filter(|(_, signal)| signal.role == Role::Output);
        for (id, output) in outputs {
            for origin in &self.origins[id] {
                match origin {
                    Origin::Clock(clock) => {
                        summary.launches.insert((output.key.clone(), self.key(*clock)));
                        // What is mixed with a domain's values must belong to it.
                        let inputs = self.origins[id].iter().filter_map(|origin| match origin {
                            Origin::Input(input) => Some(*input),
                            Origin::Clock(_) => None,
                        });
                        summary.captures.extend(inputs.map(|input| (self.key(input), self.key(*clock))));
                    }
                    Origin::Input(input) => _ = summary.paths.insert((self.key(*input), output.key.clone())),
                }
            }
        }
        summary.crossings = self.crossings;
        Ok(summary)
    }
}

/// A leaf with one clock belongs to it. A crossing states the clock of each port ([`Leaf::crossing`]).
fn leaf_summary(tree: &Tree, leaf: &Leaf) -> Result<Summary, EmitError> {
    let wires: Vec<_> =
        tree.wires.iter().filter(|wire| leaf.ports.iter().any(|(_, field)| *field == wire.key)).collect();
    let clocks: Vec<&str> = wires.iter().filter(|wire| wire.is_clock).map(|wire| wire.key.as_str()).collect();
    let mut summary = Summary::default();
    let mut add = |wire: &crate::collect::Wire, clock: &str| {
        let entry = (wire.key.clone(), clock.to_string());
        match wire.kind {
            AtomKind::InputParameter => summary.captures.insert(entry),
            _ => summary.launches.insert(entry),
        }
    };
    let data = || wires.iter().filter(|wire| !wire.is_clock);
    match (&leaf.crossing, clocks.as_slice()) {
        (Some(_), _) => {
            let field = |port: &str| {
                leaf.ports.iter().find(|(name, _)| name == port).map(|(_, field)| field.as_str())
            };
            for wire in data() {
                let port =
                    leaf.ports.iter().find(|(_, field)| *field == wire.key).map_or("", |(port, _)| port);
                if let Some(clock) = leaf.clock_of(port).and_then(field) {
                    add(wire, clock);
                }
            }
            let clocks = leaf.ports.iter().filter(|(_, field)| clocks.contains(&field.as_str()));
            let (path, leaf) = (vec![], leaf.module.clone());
            summary.crossings.push(Crossing { path, leaf, clocks: clocks.cloned().collect() });
        }
        (None, [clock]) => data().for_each(|wire| _ = add(wire, clock)),
        (None, []) => {
            let inputs = || data().filter(|wire| wire.kind == AtomKind::InputParameter);
            let outputs = || data().filter(|wire| wire.kind == AtomKind::OutputParameter);
            let paths = inputs().flat_map(|from| outputs().map(|to| (from.key.clone(), to.key.clone())));
            summary.paths.extend(paths);
        }
        (None, _) => return Err(EmitError::block(&tree.path, Fault::Clocks(leaf.module.clone()))),
    }
    Ok(summary)
}
