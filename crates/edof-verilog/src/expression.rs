//! Typed expressions: every node knows its width and signedness, no literal is without, nothing is left to context.

use crate::scope::{Scope, SignalId, State};
use crate::types::Type;

/// An expression and its type.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Expression {
    pub ty: Type,
    pub node: Node,
}

/// What an expression does. Operands have the type that the operation needs; the result wraps at the expression's width.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Node {
    Signal(SignalId),
    Literal(i128),
    State(State),
    Not(Box<Expression>),
    Negate(Box<Expression>),
    /// `&`, `|` or `^` over all bits.
    Reduce(&'static str, Box<Expression>),
    /// `+ - & | ^` on operands of the result's type.
    Wrapping(&'static str, Box<Expression>, Box<Expression>),
    /// The full product of two 16-bit operands.
    Product(Box<Expression>, Box<Expression>),
    /// Comparison of two operands of one type.
    Compare(&'static str, Box<Expression>, Box<Expression>),
    /// `&&` or `||`.
    Logical(&'static str, Box<Expression>, Box<Expression>),
    /// `<<` or `>>` by an unsigned amount of any width.
    Shift(&'static str, Box<Expression>, Box<Expression>),
    /// Extension by the operand's own sign, or truncation.
    Resize(Box<Expression>),
    /// The same bits as another type of the same width.
    Reinterpret(Box<Expression>),
    /// One bit.
    Bit(Box<Expression>, Box<Expression>),
    /// Bits from a constant place; all of them inside.
    Slice(Box<Expression>, usize),
    /// Bits from a variable place; zeros beyond the operand.
    Window(Box<Expression>, Box<Expression>),
    /// The operand with one bit replaced.
    Replace(Box<Expression>, Box<Expression>, Box<Expression>),
    /// The second operand where the first is 1, else the third.
    Choose(Box<Expression>, Box<Expression>, Box<Expression>),
}

impl Expression {
    pub fn new(ty: Type, node: Node) -> Self {
        Self { ty, node }
    }

    pub fn signal(scope: &Scope, id: SignalId) -> Self {
        Self::new(scope.signals[id].ty, Node::Signal(id))
    }

    /// A literal, wrapped into the type.
    pub fn literal(ty: Type, value: i128) -> Self {
        Self::new(ty, Node::Literal(wrap(value, ty)))
    }

    /// The constant that this is.
    pub fn constant(&self) -> Option<i128> {
        match &self.node {
            Node::Literal(value) => Some(*value),
            _ => None,
        }
    }

    /// The bit that a constant names; beyond all for what is none.
    fn as_place(&self) -> usize {
        self.constant().and_then(|at| usize::try_from(at).ok()).unwrap_or(usize::MAX)
    }

    /// The value at another width, extended by its own sign.
    pub fn resize(self, bits: usize) -> Self {
        let ty = self.ty.with_bits(bits);
        match self.node {
            Node::Literal(value) => Self::literal(ty, value),
            _ if bits == self.ty.bits => self,
            _ if bits < self.ty.bits => self.low(bits),
            _ => Self::new(ty, Node::Resize(Box::new(self))),
        }
    }

    /// The same bits, signed or not.
    pub fn reinterpret(self, signed: bool) -> Self {
        let ty = Type { signed, ..self.ty };
        match self.node {
            Node::Literal(value) => Self::literal(ty, value),
            _ if ty == self.ty => self,
            _ => Self::new(ty, Node::Reinterpret(Box::new(self))),
        }
    }

    /// The lowest bits. Operations whose low bits depend on low bits alone are done at the smaller width.
    fn low(self, bits: usize) -> Self {
        let ty = self.ty.with_bits(bits);
        let low = |operand: Box<Self>| Box::new(operand.resize(bits));
        match self.node {
            Node::Not(x) => Self::new(ty, Node::Not(low(x))),
            Node::Negate(x) => Self::new(ty, Node::Negate(low(x))),
            Node::Wrapping(op, l, r) => Self::new(ty, Node::Wrapping(op, low(l), low(r))),
            Node::Shift("<<", x, by) => Self::new(ty, Node::Shift("<<", low(x), by)),
            Node::Resize(x) => x.resize(bits),
            Node::Reinterpret(x) => x.resize(bits).reinterpret(ty.signed),
            Node::Slice(x, at) => Self::new(ty, Node::Slice(x, at)),
            Node::Window(x, at) => Self::new(ty, Node::Window(x, at)),
            Node::Shift(">>", x, by) if by.constant().is_none() && stays_inside(&by, x.ty.bits + 1) => {
                Self::new(ty, Node::Window(x, by))
            }
            Node::Shift(">>", x, by) if by.constant().is_some() => x.slice(bits, by.as_place()),
            _ => Self::new(ty, Node::Slice(Box::new(self), 0)),
        }
    }

    /// Bits from `at` on, zeros beyond the operand.
    pub fn slice(self, bits: usize, at: usize) -> Self {
        let ty = self.ty.with_bits(bits);
        let inside = self.ty.bits.saturating_sub(at);
        if let Node::Literal(value) = self.node {
            let pattern = wrap(value, Type::bits(self.ty.bits));
            return Self::literal(ty, if at < 127 { pattern >> at } else { 0 });
        }
        if inside == 0 {
            return Self::literal(ty, 0);
        }
        if bits > inside {
            return self.reinterpret(false).slice(inside, at).resize(bits).reinterpret(ty.signed);
        }
        match self.node {
            _ if at == 0 => self.resize(bits),
            Node::Shift(">>", x, by) if by.constant().is_some() => {
                x.slice(bits, by.as_place().saturating_add(at))
            }
            Node::Slice(x, deeper) => Self::new(ty, Node::Slice(x, at + deeper)),
            _ => Self::new(ty, Node::Slice(Box::new(self), at)),
        }
    }

    /// The operands.
    pub fn operands(&self) -> Vec<&Self> {
        match &self.node {
            Node::Signal(_) | Node::Literal(_) | Node::State(_) => vec![],
            Node::Not(x) | Node::Negate(x) | Node::Reduce(_, x) => vec![x],
            Node::Resize(x) | Node::Reinterpret(x) | Node::Slice(x, _) => vec![x],
            Node::Wrapping(_, x, y) | Node::Product(x, y) | Node::Compare(_, x, y) => vec![x, y],
            Node::Logical(_, x, y) | Node::Shift(_, x, y) | Node::Bit(x, y) | Node::Window(x, y) => {
                vec![x, y]
            }
            Node::Replace(x, y, z) | Node::Choose(x, y, z) => vec![x, y, z],
        }
    }

    /// The expression with `change` made to each operand.
    pub fn map(self, change: &mut dyn FnMut(Self) -> Self) -> Self {
        let mut of = |x: Box<Self>| Box::new(change(*x));
        let node = match self.node {
            node @ (Node::Signal(_) | Node::Literal(_) | Node::State(_)) => node,
            Node::Not(x) => Node::Not(of(x)),
            Node::Negate(x) => Node::Negate(of(x)),
            Node::Reduce(op, x) => Node::Reduce(op, of(x)),
            Node::Resize(x) => Node::Resize(of(x)),
            Node::Reinterpret(x) => Node::Reinterpret(of(x)),
            Node::Slice(x, at) => Node::Slice(of(x), at),
            Node::Wrapping(op, x, y) => Node::Wrapping(op, of(x), of(y)),
            Node::Product(x, y) => Node::Product(of(x), of(y)),
            Node::Compare(op, x, y) => Node::Compare(op, of(x), of(y)),
            Node::Logical(op, x, y) => Node::Logical(op, of(x), of(y)),
            Node::Shift(op, x, y) => Node::Shift(op, of(x), of(y)),
            Node::Bit(x, y) => Node::Bit(of(x), of(y)),
            Node::Window(x, y) => Node::Window(of(x), of(y)),
            Node::Replace(x, y, z) => Node::Replace(of(x), of(y), of(z)),
            Node::Choose(x, y, z) => Node::Choose(of(x), of(y), of(z)),
        };
        Self { node, ..self }
    }

    /// Whether the expression reads the signal.
    pub fn reads(&self, id: SignalId) -> bool {
        let mut reads = false;
        self.walk(&mut |part| reads |= matches!(part.node, Node::Signal(other) if other == id));
        reads
    }

    /// Calls `visit` with this expression and all inside it.
    pub fn walk<'a>(&'a self, visit: &mut dyn FnMut(&'a Self)) {
        visit(self);
        self.operands().into_iter().for_each(|operand| operand.walk(visit));
    }
}

/// Whether the place is below `range` whatever its bits are. A window may begin where its operand ends, not further on.
fn stays_inside(at: &Expression, range: usize) -> bool {
    at.ty.bits < 16 && 1 << at.ty.bits <= range
}

/// The value in two's complement at the type's width.
pub(crate) fn wrap(value: i128, ty: Type) -> i128 {
    if ty.bits >= 128 {
        return value;
    }
    let low = value & ((1_i128 << ty.bits).wrapping_sub(1));
    if ty.signed && low >> (ty.bits - 1) == 1 { low.wrapping_sub(1 << ty.bits) } else { low }
}
