//! Random typed expressions: what the kernel's syntax tree would be, and what Rust would compute.
//!
//! The value comes from the types that the random tree was made with, by rules written down here and nowhere else.

use edof_hdl::describe::{Circuit, Description, Descriptions};
use proptest::prelude::*;
use rust_hdl::core::constraint::PinConstraint;
use rust_hdl::prelude::ast::{VerilogBlock, VerilogStatement};
use rust_hdl::prelude::ast::{VerilogExpression as Source, VerilogOp as Op, VerilogOpUnary as Unary};
use rust_hdl::prelude::*;

/// Width and sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ty {
    pub bits: usize,
    pub signed: bool,
}

const fn bits(bits: usize) -> Ty {
    Ty { bits, signed: false }
}

const fn signed(bits: usize) -> Ty {
    Ty { bits, signed: true }
}

/// The inputs of the module that computes the expressions.
pub const SIGNALS: [(&str, Ty); 14] = [
    ("flag", bits(1)),
    ("tiny", bits(3)),
    ("byte", bits(8)),
    ("other", bits(8)),
    ("odd", bits(13)),
    ("half", bits(16)),
    ("word", bits(32)),
    ("more", bits(33)),
    ("long", bits(64)),
    ("few", signed(4)),
    ("small", signed(8)),
    ("pixel", signed(16)),
    ("sum", signed(32)),
    ("acc", signed(48)),
];

/// A typed expression.
#[derive(Debug, Clone)]
pub struct Tree {
    pub ty: Ty,
    node: Node,
}

#[derive(Debug, Clone)]
enum Node {
    Signal(usize),
    Literal(i128),
    Binary(&'static str, Box<Tree>, Box<Tree>),
    Unary(&'static str, Box<Tree>),
    Cast(Box<Tree>),
    Bit(Box<Tree>, Box<Tree>),
    Slice(Box<Tree>, Box<Tree>),
    Replace(Box<Tree>, Box<Tree>, Box<Tree>),
}

fn mask(value: u128, ty: Ty) -> u128 {
    value & ((1 << ty.bits) - 1)
}

fn as_signed(value: u128, ty: Ty) -> i128 {
    let negative = ty.signed && value >> (ty.bits - 1) == 1;
    if negative { value as i128 - (1 << ty.bits) } else { value as i128 }
}

impl Tree {
    /// The value in Rust, as a bit pattern.
    pub fn value(&self, inputs: &[u128]) -> u128 {
        let ty = self.ty;
        match &self.node {
            Node::Signal(signal) => inputs[*signal],
            Node::Literal(value) => mask(*value as u128, ty),
            Node::Unary("!", x) => mask(!x.value(inputs), ty),
            Node::Unary("-", x) => mask(x.value(inputs).wrapping_neg(), ty),
            Node::Unary("all", x) => (x.value(inputs) == mask(u128::MAX, x.ty)).into(),
            Node::Unary("any", x) => (x.value(inputs) != 0).into(),
            Node::Unary(_, x) => (x.value(inputs).count_ones() % 2).into(),
            Node::Cast(x) => mask(as_signed(x.value(inputs), x.ty) as u128, ty),
            Node::Bit(x, at) => x.value(inputs) >> at.value(inputs) & 1,
            Node::Slice(x, at) => mask(x.value(inputs) >> at.value(inputs), ty),
            Node::Replace(x, at, bit) => {
                let at = at.value(inputs);
                x.value(inputs) & !(1 << at) | bit.value(inputs) << at
            }
            Node::Binary(op, l, r) => {
                let (left, right) = (l.value(inputs), r.value(inputs));
                let (sl, sr) = (as_signed(left, l.ty), as_signed(right, r.ty));
                let truth = |is: bool| u128::from(is);
                let far = right >= l.ty.bits as u128;
                match *op {
                    "+" => mask(left.wrapping_add(right), ty),
                    "-" => mask(left.wrapping_sub(right), ty),
                    "*" => mask((sl * sr) as u128, ty),
                    "&" | "&&" => left & right,
                    "|" | "||" => left | right,
                    "^" => left ^ right,
                    "<<" => {
                        if far {
                            0
                        } else {
                            mask(left << right, ty)
                        }
                    }
                    ">>" => {
                        if far {
                            0
                        } else {
                            left >> right
                        }
                    }
                    "==" => truth(sl == sr),
                    "!=" => truth(sl != sr),
                    "<" => truth(sl < sr),
                    "<=" => truth(sl <= sr),
                    ">" => truth(sl > sr),
                    _ => truth(sl >= sr),
                }
            }
        }
    }

    /// The syntax tree that the macro would build: types dropped, parentheses as rustc needs them.
    pub fn source(&self) -> Source {
        let boxed = |tree: &Tree| Box::new(tree.source());
        match &self.node {
            Node::Signal(signal) => Source::Signal(SIGNALS[*signal].0.into()),
            Node::Literal(value) if *value < 0 => {
                let magnitude = Source::Literal(value.unsigned_abs().into());
                Source::Paren(Box::new(Source::Unary(Unary::Neg, Box::new(magnitude))))
            }
            Node::Literal(value) if self.ty.bits == 1 => Source::Literal((*value == 1).into()),
            Node::Literal(value) => Source::Literal(value.unsigned_abs().into()),
            Node::Unary(op, x) => Source::Unary(unary(op), Box::new(Source::Paren(boxed(x)))),
            Node::Cast(x) => match (x.ty.signed, self.ty.signed) {
                (false, false) => Source::Cast(boxed(x), self.ty.bits),
                (true, false) => Source::Unsigned(boxed(x)),
                _ => Source::Signed(boxed(x)),
            },
            Node::Bit(x, at) => Source::Index(boxed(x), boxed(at)),
            Node::Slice(x, at) => Source::Slice(boxed(x), self.ty.bits, boxed(at)),
            Node::Replace(x, at, bit) => Source::IndexReplace(boxed(x), boxed(at), boxed(bit)),
            // Left without parentheses: the tree, not the text, says what belongs together.
            Node::Binary(op, l, r) => Source::Binary(boxed(l), binary(op), boxed(r)),
        }
    }
}

fn unary(op: &str) -> Unary {
    match op {
        "!" => Unary::Not,
        "-" => Unary::Neg,
        "all" => Unary::All,
        "any" => Unary::Any,
        _ => Unary::Xor,
    }
}

fn binary(op: &str) -> Op {
    match op {
        "+" => Op::Add,
        "-" => Op::Sub,
        "*" => Op::Mul,
        "&" => Op::BitAnd,
        "&&" => Op::LogicalAnd,
        "|" => Op::BitOr,
        "||" => Op::LogicalOr,
        "^" => Op::BitXor,
        "<<" => Op::Shl,
        ">>" => Op::Shr,
        "==" => Op::Eq,
        "!=" => Op::Ne,
        "<" => Op::Lt,
        "<=" => Op::Le,
        ">" => Op::Gt,
        _ => Op::Ge,
    }
}

/// Draws trees from a stream of choices, so that proptest can replay and shorten them.
pub struct Draw<'a> {
    choices: std::slice::Iter<'a, u32>,
}

impl Draw<'_> {
    fn below(&mut self, n: usize) -> usize {
        // Where the choices run out, trees end.
        self.choices.next().map_or(0, |choice| *choice as usize % n)
    }

    fn of(&mut self, from: &[&'static str]) -> &'static str {
        from[self.below(from.len())]
    }

    /// A signal, cast to the type if no signal has the type.
    fn leaf(&mut self, ty: Ty) -> Tree {
        let fitting: Vec<usize> = (0..SIGNALS.len()).filter(|signal| SIGNALS[*signal].1 == ty).collect();
        if !fitting.is_empty() {
            let signal = fitting[self.below(fitting.len())];
            return Tree { ty, node: Node::Signal(signal) };
        }
        let signal = self.below(9);
        let narrow = Tree { ty: SIGNALS[signal].1, node: Node::Signal(signal) };
        let cast = Tree { ty: bits(ty.bits), node: Node::Cast(Box::new(narrow)) };
        if ty.signed { Tree { ty, node: Node::Cast(Box::new(cast)) } } else { cast }
    }

    fn some_type(&mut self) -> Ty {
        SIGNALS[self.below(SIGNALS.len())].1
    }

    fn some_bits(&mut self) -> Ty {
        let drawn = self.below(12);
        if drawn < 9 { SIGNALS[drawn].1 } else { bits([5, 7, 24][drawn - 9]) }
    }

    fn literal(&mut self, ty: Ty) -> Tree {
        let bits = ty.bits - usize::from(ty.signed);
        let top = if bits == 64 { u64::MAX } else { (1 << bits) - 1 };
        let raw = self.below(1 << 31) as u64;
        let magnitude = match self.below(4) {
            0 => top,
            1 => raw.wrapping_mul(0x9e37_79b9_7f4a_7c15) & top,
            _ => (raw % 4).min(top),
        };
        let negative = ty.signed && self.below(2) == 1;
        Tree { ty, node: Node::Literal(if negative { -i128::from(magnitude) } else { magnitude.into() }) }
    }

    /// An operand whose peer determines the type: a literal or an open cast will do.
    fn peer(&mut self, ty: Ty, depth: usize) -> Tree {
        match self.below(6) {
            1 => self.literal(ty),
            2 if ty.signed => self.open(ty, depth),
            _ => self.tree(ty, depth),
        }
    }

    /// `signed_bit_cast`, whose width the syntax tree does not keep.
    fn open(&mut self, ty: Ty, depth: usize) -> Tree {
        let from = signed([4, 8, 16, 32, 48][self.below(5)]);
        Tree { ty, node: Node::Cast(Box::new(self.tree(from, depth.saturating_sub(1)))) }
    }

    /// A bit index that stays inside: a literal, or as many bits as cannot reach beyond.
    fn place(&mut self, range: usize, depth: usize) -> Tree {
        let k = range.ilog2() as usize;
        if k > 0 && self.below(2) == 1 {
            return self.tree(bits(k), depth);
        }
        let at = self.below(range) as i128;
        Tree { ty: bits(32), node: Node::Literal(at) }
    }

    /// The value of an assignment.
    pub fn root(&mut self, ty: Ty) -> Tree {
        if ty.signed && self.below(5) == 4 { self.open(ty, 3) } else { self.tree(ty, 4) }
    }

    /// A tree that determines its own type.
    fn tree(&mut self, ty: Ty, depth: usize) -> Tree {
        if depth == 0 {
            return self.leaf(ty);
        }
        let d = depth - 1;
        let choice = self.below(10);
        let node = match (ty.bits, ty.signed) {
            (1, false) => return self.condition(choice, d),
            (32, _) if choice == 9 => {
                let from = Ty { bits: 16, ..ty };
                Node::Binary("*", Box::new(self.tree(from, d)), Box::new(self.peer(from, d)))
            }
            (64, false) if choice == 9 => {
                let (one, by) = (self.literal(bits(64)), self.tree(bits(3), d));
                Node::Binary(self.of(&["<<", ">>"]), Box::new(one), Box::new(by))
            }
            (_, true) => return self.signed(ty, choice, d),
            _ => return self.unsigned(ty, choice, d),
        };
        Tree { ty, node }
    }

    fn either_way(&mut self, op: &'static str, ty: Ty, depth: usize) -> Node {
        let (told, peer) = (Box::new(self.tree(ty, depth)), Box::new(self.peer(ty, depth)));
        if self.below(2) == 0 { Node::Binary(op, told, peer) } else { Node::Binary(op, peer, told) }
    }

    fn unsigned(&mut self, ty: Ty, choice: usize, d: usize) -> Tree {
        let node = match choice {
            0 => return self.leaf(ty),
            1..=3 => {
                let op = self.of(&["+", "-", "&", "|", "^"]);
                self.either_way(op, ty, d)
            }
            4 => Node::Unary("!", Box::new(self.tree(ty, d))),
            5 => {
                let x = Box::new(self.tree(ty, d));
                let by = if self.below(2) == 0 {
                    Tree { ty: bits(32), node: Node::Literal(self.below(ty.bits + 3) as i128) }
                } else {
                    let amount = bits([3, 8, 5][self.below(3)]);
                    self.tree(amount, d)
                };
                Node::Binary(self.of(&["<<", ">>"]), x, Box::new(by))
            }
            6 => {
                let from = self.some_bits();
                Node::Cast(Box::new(self.tree(from, d)))
            }
            7 => Node::Cast(Box::new(self.tree(signed(ty.bits), d))),
            8 => {
                let from = self.some_bits();
                let (x, at) = (Box::new(self.tree(from, d)), Box::new(self.place(from.bits, d)));
                Node::Slice(x, at)
            }
            _ => {
                let (x, at) = (Box::new(self.tree(ty, d)), Box::new(self.place(ty.bits, d)));
                Node::Replace(x, at, Box::new(self.tree(bits(1), d)))
            }
        };
        Tree { ty, node }
    }

    fn signed(&mut self, ty: Ty, choice: usize, d: usize) -> Tree {
        let node = match choice {
            0 | 1 => return self.leaf(ty),
            2..=4 => {
                let op = self.of(&["+", "-"]);
                self.either_way(op, ty, d)
            }
            5 | 6 => Node::Unary("-", Box::new(self.tree(ty, d))),
            7 => {
                let from = signed([8, 16, 48][self.below(3)]);
                let (x, at) = (Box::new(self.tree(from, d)), Box::new(self.place(from.bits, d)));
                Node::Slice(x, at)
            }
            _ => Node::Cast(Box::new(self.tree(bits(ty.bits), d))),
        };
        Tree { ty, node }
    }

    fn condition(&mut self, choice: usize, d: usize) -> Tree {
        let ty = bits(1);
        let node = match choice {
            0 => return self.leaf(ty),
            1..=4 => {
                let of = self.some_type();
                let op = self.of(&["==", "!=", "<", "<=", ">", ">="]);
                self.either_way(op, of, d)
            }
            5 => Node::Unary("!", Box::new(self.tree(ty, d))),
            6 => {
                let op = self.of(&["&&", "||", "&", "|", "^"]);
                Node::Binary(op, Box::new(self.tree(ty, d)), Box::new(self.peer(ty, d)))
            }
            7 | 8 => {
                let of = self.some_bits();
                Node::Unary(self.of(&["all", "any", "xor"]), Box::new(self.tree(of, d)))
            }
            _ => {
                let of = self.some_type();
                let (x, at) = (Box::new(self.tree(of, d)), Box::new(self.place(of.bits, d)));
                Node::Bit(x, at)
            }
        };
        Tree { ty, node }
    }
}

/// Typed expressions of depth up to four.
pub fn expressions() -> impl Strategy<Value = Tree> {
    prop::collection::vec(any::<u32>(), 2..120).prop_map(|choices| {
        let mut draw = Draw { choices: choices.iter() };
        let ty = draw.some_type();
        draw.root(ty)
    })
}

/// A block whose outputs are expressions of its inputs.
pub struct Table {
    wires: Vec<Wire>,
    kernel: VerilogBlock,
}

impl Table {
    pub fn new(trees: &[Tree]) -> Self {
        let input =
            |(name, ty): &(&str, Ty)| Wire { name: (*name).into(), ty: *ty, kind: AtomKind::InputParameter };
        let output = |(n, tree): (usize, &Tree)| Wire {
            name: format!("y{n}"),
            ty: tree.ty,
            kind: AtomKind::OutputParameter,
        };
        let assign = |(n, tree): (usize, &Tree)| {
            VerilogStatement::Assignment(Source::Signal(format!("y{n}$next")), tree.source())
        };
        Self {
            wires: SIGNALS.iter().map(input).chain(trees.iter().enumerate().map(output)).collect(),
            kernel: trees.iter().enumerate().map(assign).collect(),
        }
    }
}

impl Logic for Table {
    fn update(&mut self) {}
    fn hdl(&self) -> Verilog {
        Verilog::Combinatorial(self.kernel.clone())
    }
}

impl Circuit for Table {
    fn describe(&self, key: &str, found: &mut Descriptions) {
        let description = Description {
            name: "Table",
            source: file!(),
            header: "Random expressions.",
            role: String::new(),
            fields: &[],
            names: vec![],
            literals: &[],
            signed: &[],
            formulas: vec![],
        };
        found.block(key, description, |_| {});
    }
}

impl Block for Table {
    fn connect_all(&mut self) {}
    fn update_all(&mut self) {}
    fn has_changed(&self) -> bool {
        false
    }
    fn accept(&self, name: &str, probe: &mut dyn Probe) {
        probe.visit_start_scope(name, self);
        self.wires.iter().for_each(|wire| probe.visit_atom(&wire.name, wire));
        probe.visit_end_scope(name, self);
    }
}

struct Wire {
    name: String,
    ty: Ty,
    kind: AtomKind,
}

impl Atom for Wire {
    fn bits(&self) -> usize {
        self.ty.bits
    }
    fn connected(&self) -> bool {
        true
    }
    fn changed(&self) -> bool {
        false
    }
    fn kind(&self) -> AtomKind {
        self.kind
    }
    fn descriptor(&self) -> TypeDescriptor {
        let kind = if self.ty.signed { TypeKind::Signed(self.ty.bits) } else { TypeKind::Bits(self.ty.bits) };
        TypeDescriptor { name: String::new(), kind }
    }
    fn vcd(&self) -> VCDValue {
        VCDValue::String(String::new())
    }
    fn id(&self) -> usize {
        0
    }
    fn verilog(&self) -> VerilogLiteral {
        0.into()
    }
    fn constraints(&self) -> Vec<PinConstraint> {
        vec![]
    }
}
