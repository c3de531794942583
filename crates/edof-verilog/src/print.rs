//! Typed expressions as Verilog text.
//!
//! Every operand has the width of its operation, so Verilog's rule of the widest operand never applies. Where Rust changes
//! a width, the text says so: `{1'd0, a + b}` (inside braces an operand keeps its own width), a slice, or, for what has no
//! such form, a signal of the right width in between.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::expression::{Expression, Node};
use crate::names::Names;
use crate::scope::{Role, Scope, SignalId, State};
use crate::text::{Form, Text, Use, convert, literal, range};
use crate::types::Type;

/// A value between two steps of an expression.
#[derive(Debug)]
pub(crate) struct Between {
    pub name: String,
    pub ty: Type,
    /// The value, where it is a wire; none where a process assigns it.
    pub value: Option<String>,
    /// Only some of its bits are read.
    pub in_part: bool,
}

/// Prints the expressions of one module; `statements` prints its blocks.
pub(crate) struct Printer<'a> {
    pub scope: &'a Scope,
    /// What each signal is called, after all direct connections.
    pub resolved: &'a [Expression],
    pub signal_names: &'a [String],
    pub names: &'a mut Names,
    /// Constants that the text names, and what for.
    pub constants: BTreeMap<SignalId, Use>,
    /// States that the text names, and their names.
    pub states: BTreeMap<(String, usize, String), (String, State)>,
    pub between: Vec<Between>,
    known: HashMap<(Type, String), usize>,
    /// Targets of the current process, its values in between, and those that the next statement needs.
    pub driven: BTreeSet<SignalId>,
    pub steps: Vec<usize>,
    pub pending: Vec<String>,
    pub subject: String,
    /// Registers are assigned themselves.
    pub at_edge: bool,
    /// The Rust line of the current text.
    pub line: Option<usize>,
    /// Comments that stand already, each with its Rust line.
    pub said: BTreeSet<(usize, String)>,
    /// Purpose of the current number.
    number: Use,
}

impl<'a> Printer<'a> {
    pub fn new(
        scope: &'a Scope,
        resolved: &'a [Expression],
        signal_names: &'a [String],
        names: &'a mut Names,
    ) -> Self {
        Self {
            scope,
            resolved,
            signal_names,
            names,
            constants: BTreeMap::new(),
            states: BTreeMap::new(),
            between: vec![],
            known: HashMap::new(),
            driven: BTreeSet::new(),
            steps: vec![],
            pending: vec![],
            subject: String::new(),
            at_edge: false,
            line: None,
            said: BTreeSet::new(),
            number: Use::Value,
        }
    }

    /// The value of a whole signal, outside of any process.
    pub fn value(&mut self, value: &Expression, target: &str) -> String {
        self.subject = target.into();
        self.driven.clear();
        self.root(value)
    }

    /// A value that goes into a signal of its own width: only here Verilog's context is as wide as a product.
    pub fn root(&mut self, value: &Expression) -> String {
        match &value.node {
            Node::Product(left, right) => {
                let (left, right) = (self.factor(left), self.factor(right));
                format!("{left} * {right}")
            }
            Node::Reinterpret(inner) => self.root(inner),
            _ => self.print(value).text,
        }
    }

    /// A factor is extended to the width of the product, so it must be complete in itself.
    fn factor(&mut self, factor: &Expression) -> String {
        let text = self.print(factor);
        if text.form == Form::Atom && text.signed == factor.ty.signed {
            text.text
        } else {
            convert(text, factor.ty.signed)
        }
    }

    /// An operand whose numbers are for something.
    fn print_as(&mut self, number: Use, operand: &Expression) -> Text {
        let before = std::mem::replace(&mut self.number, number);
        let text = self.print(operand);
        self.number = before;
        text
    }

    fn print(&mut self, expression: &Expression) -> Text {
        if let Some(pieces) = side_by_side(expression) {
            let texts: Vec<String> = pieces.into_iter().map(|piece| self.piece(piece)).collect();
            return Text::atom(format!("{{{}}}", texts.join(", ")), false);
        }
        let ty = expression.ty;
        match &expression.node {
            Node::Signal(id) => self.signal(*id),
            Node::Literal(value) if *value < 0 => {
                Text::operation(literal(ty, *value, self.number), ty.signed)
            }
            Node::Literal(value) => Text::atom(literal(ty, *value, self.number), ty.signed),
            Node::State(state) => Text::atom(self.state(state), false),
            Node::Not(x) => self.not(ty, x),
            Node::Negate(x) => {
                let x = self.print(x);
                let signed = x.signed;
                Text::operation(format!("-{}", x.unary_operand()), signed)
            }
            Node::Reduce(_, x) if x.ty.bits == 1 => self.print(x),
            Node::Reduce(op, x) => Text::operation(format!("{op}{}", self.print(x).unary_operand()), false),
            Node::Wrapping(op, x, y) => {
                let number = if ["+", "-"].contains(op) { Use::Count } else { Use::Mask };
                Text::binary(op, self.print_as(number, x), self.print_as(number, y))
            }
            Node::Compare(op, x, y) => {
                let ordered = !matches!(*op, "==" | "!=");
                let mut side = |operand: &Expression| {
                    let text = self.print_as(Use::Count, operand);
                    if ordered && text.signed != operand.ty.signed {
                        convert(text, operand.ty.signed)
                    } else {
                        text.operand()
                    }
                };
                let (x, y) = (side(x), side(y));
                Text::operation(format!("{x} {op} {y}"), false)
            }
            Node::Logical(op, x, y) => {
                let (x, y) = (self.print_as(Use::Value, x), self.print_as(Use::Value, y));
                Text { signed: false, ..Text::binary(op, x, y) }
            }
            Node::Choose(test, x, y) => {
                let test = self.print_as(Use::Value, test);
                let (x, y) = (self.print(x), self.print(y));
                let signed = x.signed && y.signed;
                Text::operation(format!("{} ? {} : {}", test.operand(), x.operand(), y.operand()), signed)
            }
            Node::Shift(op, x, by) => {
                let x = self.print(x);
                let signed = x.signed;
                let by = by.constant().map_or_else(|| self.print(by).operand(), |by| by.to_string());
                Text::operation(format!("{} {op} {by}", x.operand()), signed)
            }
            Node::Resize(x) => self.extend(x, ty.bits - x.ty.bits),
            Node::Reinterpret(x) => self.print(x),
            Node::Product(..) => Text::atom(self.between(expression, false), ty.signed),
            Node::Bit(x, at) => self.bit(x, at),
            Node::Slice(x, at) => {
                Text::atom(format!("{}{}", self.selectable(x, true), range(*at, ty.bits)), false)
            }
            Node::Window(x, at) => {
                let wide = (**x).clone().reinterpret(false).resize(x.ty.bits + ty.bits);
                let (name, at) = (self.selectable(&wide, false), self.place(at, wide.ty.bits));
                Text::atom(format!("{name}[{at} +: {}]", ty.bits), false)
            }
            Node::Replace(x, at, bit) => self.replace(x, at, bit),
        }
    }

    /// Every bit turned round; of a bit, the opposite.
    fn not(&mut self, ty: Type, x: &Expression) -> Text {
        // The value has one bit, so that nothing depends on the width around it.
        if let (1, Node::Not(twice)) = (ty.bits, &x.node)
            && twice.ty == ty
        {
            return self.print(twice);
        }
        if let Node::Reduce("|", number) = &x.node
            && number.ty.bits > 1
        {
            let zero = Expression::literal(number.ty, 0);
            return self.print(&Expression::new(ty, Node::Compare("==", number.clone(), Box::new(zero))));
        }
        let x = self.print(x);
        let signed = x.signed && ty.bits > 1;
        let form = if x.form == Form::Atom { Form::Not } else { Form::Operation };
        let text = format!("{}{}", if ty.bits == 1 { "!" } else { "~" }, x.unary_operand());
        Text { text, form, signed }
    }

    fn signal(&mut self, id: SignalId) -> Text {
        let expression = self.resolved[id].clone();
        let Node::Signal(id) = expression.node else { return self.print(&expression) };
        let signal = &self.scope.signals[id];
        if matches!(signal.role, Role::Constant(_)) {
            let number = self.number;
            self.constants.entry(id).and_modify(|known| *known = number.max(*known)).or_insert(number);
        }
        Text::atom(self.signal_names[id].clone(), signal.ty.signed)
    }

    pub fn state(&mut self, state: &State) -> String {
        let key = (state.label.0.clone(), state.value, state.label.1.clone());
        if let Some((name, _)) = self.states.get(&key) {
            return name.clone();
        }
        let name = self.names.take(&state.constant());
        self.states.insert(key, (name.clone(), state.clone()));
        name
    }

    fn extend(&mut self, x: &Expression, by: usize) -> Text {
        if !x.ty.signed {
            let low = self.print(x).text;
            return Text::atom(format!("{{{}, {low}}}", literal(Type::bits(by), 0, Use::Value)), false);
        }
        let (name, sign) = match unsigned(x) {
            Expression { ty, node: Node::Slice(whole, first) } if ty.bits > 1 => {
                let name = self.selectable(whole, true);
                let top = first + ty.bits - 1;
                (format!("{name}{}", range(*first, ty.bits)), format!("{name}[{top}]"))
            }
            x => {
                let name = self.selectable(x, false);
                let sign = if x.ty.bits == 1 { name.clone() } else { format!("{name}[{}]", x.ty.bits - 1) };
                (name, sign)
            }
        };
        let signs = if by == 1 { sign } else { format!("{{{by}{{{sign}}}}}") };
        Text::atom(format!("{{{signs}, {name}}}"), false)
    }

    fn bit(&mut self, x: &Expression, at: &Expression) -> Text {
        if x.ty.bits == 1 {
            return Text::atom(self.print(x).operand(), false);
        }
        let name = self.selectable(x, true);
        let at = at.constant().map_or_else(|| self.place(at, x.ty.bits), |at| at.to_string());
        Text::atom(format!("{name}[{at}]"), false)
    }

    /// An index with as many bits as its range needs. Rust panics at those that this cuts off.
    fn place(&mut self, at: &Expression, range: usize) -> String {
        let bits = usize::BITS as usize - (range - 1).leading_zeros() as usize;
        let at = at.clone().resize(bits.max(1));
        let text = self.print(&at);
        // Icarus takes a sign before an index for wider than the index is.
        if text.form == Form::Not { self.between(&at, false) } else { text.text }
    }

    fn replace(&mut self, x: &Expression, at: &Expression, bit: &Expression) -> Text {
        let ty = x.ty;
        if ty.bits == 1 {
            return Text::atom(self.print(bit).operand(), false);
        }
        if let Some(at) = at.constant() {
            let (name, at) = (self.selectable(x, true), at as usize);
            let above = (at + 1 < ty.bits).then(|| format!("{name}{}", range(at + 1, ty.bits - at - 1)));
            let below = (at > 0).then(|| format!("{name}{}", range(0, at)));
            let parts: Vec<_> = above.into_iter().chain([self.print(bit).text]).chain(below).collect();
            return Text::atom(format!("{{{}}}", parts.join(", ")), false);
        }
        let shifted = |what: Expression| {
            Box::new(Expression::new(ty, Node::Shift("<<", Box::new(what), Box::new(at.clone()))))
        };
        let hole = Expression::new(ty, Node::Not(shifted(Expression::literal(ty, 1))));
        let rest = Expression::new(ty, Node::Wrapping("&", Box::new(x.clone()), Box::new(hole)));
        self.print(&Expression::new(
            ty,
            Node::Wrapping("|", Box::new(rest), shifted(bit.clone().resize(ty.bits))),
        ))
    }

    fn piece(&mut self, piece: Piece<'_>) -> String {
        match piece {
            Piece::Value(value) => self.print(value).text,
            Piece::Zeros(bits) => literal(Type::bits(bits), 0, Use::Value),
        }
    }

    /// The name of a signal that has this value and of which bits can be taken.
    fn selectable(&mut self, x: &Expression, in_part: bool) -> String {
        if let Node::Signal(id) = x.node
            && let Node::Signal(id) = self.resolved[id].node
            && !matches!(self.scope.signals[id].role, Role::Constant(_))
        {
            return self.signal_names[id].clone();
        }
        if let Node::Reinterpret(inner) = &x.node {
            return self.selectable(inner, in_part);
        }
        self.between(x, in_part)
    }

    /// The name of a value in between: a wire, or a step of the process where it depends on what the process drives.
    fn between(&mut self, x: &Expression, in_part: bool) -> String {
        let mut in_process = false;
        x.walk(&mut |part| in_process |= matches!(part.node, Node::Signal(id) if self.depends(id)));
        let number = std::mem::replace(&mut self.number, Use::Value);
        let text = self.root(x);
        self.number = number;
        let key = (x.ty, text);
        if let Some(&known) = self.known.get(&key).filter(|_| !in_process) {
            self.between[known].in_part &= in_part;
            return self.between[known].name.clone();
        }
        let name = self.names.take(&format!("{}_{}", self.subject, kind(x)));
        let (index, (ty, text)) = (self.between.len(), key.clone());
        if in_process {
            self.pending.push(format!("{name} = {text};"));
            self.steps.push(index);
        } else {
            self.known.insert(key, index);
        }
        self.between.push(Between { name: name.clone(), ty, value: (!in_process).then_some(text), in_part });
        name
    }

    fn depends(&self, id: SignalId) -> bool {
        matches!(self.resolved[id].node, Node::Signal(id) if self.driven.contains(&id))
    }
}

/// The bits that a number is made of.
fn unsigned(x: &Expression) -> &Expression {
    match &x.node {
        Node::Reinterpret(inner) => unsigned(inner),
        _ => x,
    }
}

/// A part of a concatenation.
enum Piece<'e> {
    Value(&'e Expression),
    Zeros(usize),
}

/// The values of a concatenation.
pub(crate) fn pieces(joined: &Expression) -> Option<Vec<&Expression>> {
    let value = |piece| match piece {
        Piece::Value(value) => Some(value),
        Piece::Zeros(_) => None,
    };
    side_by_side(joined).map(|pieces| pieces.into_iter().filter_map(value).collect())
}

/// Values that are shifted to places of their own, and joined by `|` where there are several, with the zeros between them, from the highest
/// place down.
fn side_by_side(joined: &Expression) -> Option<Vec<Piece<'_>>> {
    let mut placed = vec![];
    let is_joined = matches!(joined.node, Node::Wrapping("|", ..) | Node::Shift("<<", ..));
    if joined.ty.signed || !is_joined || !place(joined, &mut placed) {
        return None;
    }
    placed.sort_by_key(|(at, _)| *at);
    let (mut pieces, mut end) = (vec![], 0);
    for (at, value) in placed {
        if at < end {
            return None;
        }
        pieces.extend((at > end).then_some(Piece::Zeros(at - end)));
        pieces.push(Piece::Value(value));
        end = at.checked_add(value.ty.bits)?;
    }
    let above = joined.ty.bits.checked_sub(end)?;
    pieces.extend((above > 0).then_some(Piece::Zeros(above)));
    Some(pieces.into_iter().rev().collect())
}

/// Adds where the values lie that are joined; false if that is not known of one.
fn place<'e>(part: &'e Expression, placed: &mut Vec<(usize, &'e Expression)>) -> bool {
    let at = match &part.node {
        Node::Wrapping("|", x, y) => return place(x, placed) && place(y, placed),
        Node::Shift("<<", _, by) => by.constant().and_then(|by| usize::try_from(by).ok()),
        _ => Some(0),
    };
    let wide = if let Node::Shift("<<", wide, _) = &part.node { wide } else { part };
    match (at, &wide.node) {
        (Some(at), Node::Resize(value)) if !value.ty.signed => placed.push((at, value)),
        _ => return false,
    }
    true
}

/// What a value in between is called after.
fn kind(x: &Expression) -> &'static str {
    match &x.node {
        Node::Product(..) => "product",
        Node::Wrapping("+", ..) => "sum",
        Node::Wrapping("-", ..) => "difference",
        Node::Shift(..) => "shifted",
        Node::Resize(_) => "wide",
        Node::Negate(_) => "negated",
        _ => "value",
    }
}
