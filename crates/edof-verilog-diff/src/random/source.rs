//! A plan as the syntax tree that `#[hdl_gen]` would make.

use super::plan::{Expr, Statement, Target, Test};
use rust_hdl::prelude::ast::{
    VerilogBlockOrConditional as Otherwise, VerilogCase, VerilogConditional, VerilogExpression as Source,
    VerilogMatch, VerilogOp as Op, VerilogOpUnary as Unary, VerilogStatement,
};

pub(super) fn name(key: &str) -> Source {
    Source::Signal(key.into())
}

pub(super) fn assign(target: String, value: Source) -> VerilogStatement {
    VerilogStatement::Assignment(Source::Signal(target), value)
}

fn paren(source: Source) -> Source {
    Source::Paren(Box::new(source))
}

fn binary(x: Source, op: &str, y: Source) -> Source {
    let op = match op {
        "+" => Op::Add,
        "-" => Op::Sub,
        "&" => Op::BitAnd,
        "|" => Op::BitOr,
        "^" => Op::BitXor,
        "&&" => Op::LogicalAnd,
        "||" => Op::LogicalOr,
        "==" => Op::Eq,
        "!=" => Op::Ne,
        "<" => Op::Lt,
        "<=" => Op::Le,
        ">" => Op::Gt,
        ">=" => Op::Ge,
        _ => Op::Shr,
    };
    Source::Binary(Box::new(paren(x)), op, Box::new(paren(y)))
}

impl Expr {
    pub(super) fn source(&self) -> Source {
        match self {
            Self::Input(0) => name("a"),
            Self::Input(_) => name("b"),
            Self::Register(n) => name(&format!("registers${n}$q")),
            Self::Local(n) => name(&format!("locals${n}")),
            Self::Part(n) => name(&format!("parts${}${}", n / 2, if n % 2 == 0 { "x" } else { "y" })),
            Self::Memory(n) => name(&format!("memories${n}$read")),
            // As a number of 8 bits, in every context.
            Self::Number(number) => Source::Cast(Box::new(Source::Literal((*number).into())), 8),
            Self::Not(x) => Source::Unary(Unary::Not, Box::new(paren(x.source()))),
            Self::Shifted(x, by) => binary(x.source(), ">>", Source::Literal((*by).into())),
            Self::Binary(op, x, y) => binary(x.source(), op, y.source()),
        }
    }
}

impl Test {
    pub(super) fn source(&self) -> Source {
        match self {
            Self::Compare(op, x, y) => binary(x.source(), op, y.source()),
            Self::Bit(x, at) => {
                Source::Index(Box::new(paren(x.source())), Box::new(Source::Literal((*at).into())))
            }
            Self::Any(x) => Source::Unary(Unary::Any, Box::new(paren(x.source()))),
            Self::Not(test) => Source::Unary(Unary::Not, Box::new(paren(test.source()))),
            Self::Both(op, one, other) => binary(one.source(), op, other.source()),
        }
    }
}

impl Statement {
    pub(super) fn source(&self) -> VerilogStatement {
        let block = |statements: &[Self]| statements.iter().map(Self::source).collect::<Vec<_>>();
        match self {
            Self::Assign(Target::Register(n), value) => assign(format!("registers${n}$d"), value.source()),
            Self::Assign(Target::Local(n), value) => assign(format!("locals${n}"), value.source()),
            Self::If(test, then, otherwise) => VerilogStatement::If(VerilogConditional {
                test: test.source(),
                then: block(then),
                otherwise: Otherwise::Block(block(otherwise)),
            }),
            Self::Match(subject, arms, default) => {
                let case = |condition: String, body: &[Self]| VerilogCase { condition, block: block(body) };
                let arms = arms.iter().map(|(number, body)| case(number.to_string(), body));
                VerilogStatement::Match(VerilogMatch {
                    test: subject.source(),
                    cases: arms.chain([case("default".into(), default)]).collect(),
                })
            }
        }
    }
}
