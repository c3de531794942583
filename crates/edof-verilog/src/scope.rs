//! The signals that a kernel can name: those of its block, of its registers and of its parts.

use std::collections::{BTreeMap, HashMap};

use rust_hdl::prelude::{AtomKind, TypeDescriptor, TypeKind, clog2};

use crate::collect::{Tree, Wire};
use crate::error::{EmitError, Fault};
use crate::leaf::Leaf;
use crate::names::snake_case;
use crate::source;
use crate::types::Type;

/// Index into [`Scope::signals`].
pub(crate) type SignalId = usize;

/// What a signal is to the kernel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Role {
    Input,
    Output,
    Local,
    /// Value in hexadecimal.
    Constant(String),
    /// Next value of a register.
    Next,
    /// Value of a register.
    Register,
    /// Clock of a register.
    Clock,
    /// Input of a part.
    PartInput,
    /// Output of a part.
    PartOutput,
}

/// A signal that the kernel can name.
#[derive(Debug, Clone)]
pub(crate) struct Signal {
    /// The kernel's name for it, for instance `banks$3$data`.
    pub key: String,
    pub ty: Type,
    pub role: Role,
    pub is_clock: bool,
}

/// A register: rust-hdl's `DFF` or `DFFWithInit`.
#[derive(Debug)]
pub(crate) struct Register {
    pub next: SignalId,
    pub value: SignalId,
    pub clock: SignalId,
    /// Start-up value in hexadecimal.
    pub start: Option<String>,
}

/// The signals of one part, in the order of its ports, each with the part's own name for it.
#[derive(Debug)]
pub(crate) struct Part {
    /// Index into the tree's parts.
    pub index: usize,
    pub ports: Vec<(String, SignalId)>,
}

/// One state of an enum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct State {
    /// Name of the enum and of the state.
    pub label: (String, String),
    pub value: usize,
    pub bits: usize,
    /// How many states the enum has.
    pub of: usize,
}

impl State {
    /// Returns the name that its constant has in Verilog where no other has it: `PHASE_IDLE` of `Phase::Idle`.
    pub fn constant(&self) -> String {
        format!("{}_{}", snake_case(&self.label.0), snake_case(&self.label.1)).to_uppercase()
    }
}

/// What a constant is printed as, other than by the name of its field.
#[derive(Debug)]
pub(crate) enum Fixed {
    Number(i128),
    /// An element of an array whose elements have names.
    Named(State),
}

/// Everything that has a name in a kernel.
#[derive(Debug, Default)]
pub(crate) struct Scope {
    pub path: String,
    pub signals: Vec<Signal>,
    pub registers: Vec<Register>,
    pub parts: Vec<Part>,
    /// Constants that are printed as their values, or as named ones.
    literals: HashMap<SignalId, Fixed>,
    ids: HashMap<String, SignalId>,
    states: BTreeMap<String, State>,
}

/// What a name in a kernel stands for.
pub(crate) enum Meaning<'a> {
    Number(i128),
    Signal(SignalId),
    State(&'a State),
}

impl Scope {
    /// The scope of a block's kernel.
    pub fn of(tree: &Tree) -> Result<Self, EmitError> {
        let mut scope = Self { path: tree.path.clone(), ..Self::default() };
        for wire in &tree.wires {
            let role = match wire.kind {
                AtomKind::InputParameter => Role::Input,
                AtomKind::OutputParameter => Role::Output,
                AtomKind::LocalSignal => Role::Local,
                AtomKind::Constant => Role::Constant(wire.value.clone()),
                _ => return Err(EmitError::field(&tree.path, &wire.key, Fault::InOut)),
            };
            let id = scope.add(wire.key.clone(), wire, role)?;
            if let Some(literal) = literal(tree, wire) {
                scope.literals.insert(id, literal);
            }
        }
        for (index, part) in tree.parts.iter().enumerate() {
            let start = part.start_value();
            if part.is_register() || start.is_some() {
                scope.add_register(part, start)?;
            } else {
                scope.add_part(index, part)?;
            }
        }
        Ok(scope)
    }

    fn add(&mut self, key: String, wire: &Wire, role: Role) -> Result<SignalId, EmitError> {
        if wire.ty.bits == 0 {
            return Err(EmitError::field(&self.path, &key, Fault::NoBits));
        }
        self.add_states(&wire.descriptor).map_err(|fault| EmitError::field(&self.path, &key, fault))?;
        self.ids.insert(key.clone(), self.signals.len());
        self.signals.push(Signal { key, ty: wire.ty, role, is_clock: wire.is_clock });
        Ok(self.signals.len() - 1)
    }

    fn add_register(&mut self, part: &Tree, start: Option<&Wire>) -> Result<(), EmitError> {
        let mut add = |port: &str, role| {
            let wire = part.wire(port).expect("a register has d, q and clock");
            self.add(format!("{}${port}", part.key), wire, role)
        };
        let (value, next, clock) =
            (add("q", Role::Register)?, add("d", Role::Next)?, add("clock", Role::Clock)?);
        let start = start.map(|init| init.value.clone());
        self.registers.push(Register { next, value, clock, start });
        Ok(())
    }

    fn add_part(&mut self, index: usize, part: &Tree) -> Result<(), EmitError> {
        let leaf = Leaf::of(&part.hdl);
        let is_port =
            |key: &str| leaf.as_ref().is_none_or(|leaf| leaf.ports.iter().any(|(_, port)| port == key));
        let mut ports = vec![];
        for wire in part.wires.iter().filter(|wire| is_port(&wire.key)) {
            let role = match wire.kind {
                AtomKind::InputParameter => Role::PartInput,
                AtomKind::OutputParameter => Role::PartOutput,
                AtomKind::Constant | AtomKind::LocalSignal => continue,
                _ => return Err(EmitError::field(&part.path, &wire.key, Fault::InOut)),
            };
            ports.push((wire.key.clone(), self.add(format!("{}${}", part.key, wire.key), wire, role)?));
        }
        self.parts.push(Part { index, ports });
        Ok(())
    }

    fn add_states(&mut self, descriptor: &TypeDescriptor) -> Result<(), Fault> {
        match &descriptor.kind {
            TypeKind::Enum(labels) => {
                for (value, label) in labels.iter().enumerate() {
                    let name = label.rsplit("::").next().unwrap_or(label).to_string();
                    let (bits, of) = (clog2(labels.len()), labels.len());
                    let state = State { label: (descriptor.name.clone(), name), value, bits, of };
                    let known = self.states.entry(label.replace("::", "$")).or_insert_with(|| state.clone());
                    if *known != state {
                        return Err(Fault::TwoMeanings(label.clone()));
                    }
                }
                Ok(())
            }
            TypeKind::Composite(fields) => fields.iter().try_for_each(|field| self.add_states(&field.kind)),
            _ => Ok(()),
        }
    }

    /// What a constant is printed as, if not by the name of its field.
    pub fn fixed(&self, id: SignalId) -> Option<&Fixed> {
        self.literals.get(&id)
    }

    /// What a name means where the loop variables have these values.
    pub fn meaning(&self, name: &str, loops: &[(String, i128)]) -> Result<Meaning<'_>, Fault> {
        if let Some((_, value)) = loops.iter().rev().find(|(variable, _)| variable == name) {
            return Ok(Meaning::Number(*value));
        }
        let key = plain_key(name, loops)?;
        if let Some(id) = self.ids.get(&key) {
            return Ok(Meaning::Signal(*id));
        }
        // A state may be named by a longer path than its descriptor has.
        let starts = std::iter::once(0).chain(key.match_indices('$').map(|(at, _)| at + 1));
        let state = starts.into_iter().find_map(|start| self.states.get(&key[start..]));
        state.map(Meaning::State).ok_or_else(|| Fault::Unknown(crate::error::rust_path(&key)))
    }
}

/// What stands for a constant that the block wants as its value, or that has a name of its own.
fn literal(tree: &Tree, wire: &Wire) -> Option<Fixed> {
    let description = tree.description.as_ref().filter(|_| wire.kind == AtomKind::Constant)?;
    let value = i128::from_str_radix(&wire.value, 16).ok().filter(|_| wire.ty.bits < 100)?;
    let field = wire.key.split('$').next().unwrap_or_default();
    if let Some((field, name, _)) = description.element(&wire.key) {
        let (label, value) = ((field.into(), name.into()), usize::try_from(value).ok()?);
        return Some(Fixed::Named(State { label, value, bits: wire.ty.bits, of: usize::MAX }));
    }
    description.literals.contains(&field).then_some(Fixed::Number(value))
}

/// `banks[i+1]$data$next` as `banks$4$data`.
fn plain_key(name: &str, loops: &[(String, i128)]) -> Result<String, Fault> {
    let name = name.trim_start_matches('.').replace("::", "$").replace('.', "$");
    let mut rest = name.strip_suffix("$next").unwrap_or(&name);
    let mut key = String::new();
    while let Some((before, after)) = rest.split_once('[') {
        let fault = || Fault::Index(after.split(']').next().unwrap_or(after).into());
        let (inside, tail) = after.split_once(']').ok_or_else(fault)?;
        let value = source::index(inside, loops).filter(|value| *value >= 0).ok_or_else(fault)?;
        key += &format!("{before}${value}");
        rest = tail;
    }
    Ok(key + rest.trim_end_matches('$'))
}
