//! Gives every expression of the syntax tree its type, as rustc did before the types were dropped.
//!
//! A literal has the type of its peer or target. So has `signed_bit_cast`, whose width the tree does not keep; if its context does not determine the width, it is rejected. [`Typing::guess`] looks from below, [`Typing::check`] from above.

use rust_hdl::prelude::ast::{VerilogExpression as Source, VerilogOp as Op, VerilogOpUnary as Unary};

use crate::error::Fault;
use crate::expression::{Expression, Node};
use crate::scope::{Fixed, Meaning, Scope};
use crate::source::{is_bool, number, quote, symbol};
use crate::types::Type;

/// What an expression says of its own type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Guess {
    Type(Type),
    /// A number of no type yet.
    Number(i128),
    /// A cast whose width comes from outside.
    Open {
        signed: bool,
    },
}

/// The names in scope, and the values of the loop variables.
pub(crate) struct Typing<'a> {
    pub scope: &'a Scope,
    pub loops: &'a [(String, i128)],
}

type Typed = Result<Expression, Fault>;

impl Typing<'_> {
    /// The value assigned to a target of type `wanted`.
    pub fn value(&self, source: &Source, wanted: Type) -> Typed {
        self.check(source, wanted)
    }

    /// A value whose type only the source states: the subject of a match.
    pub fn subject(&self, source: &Source) -> Typed {
        match self.guess(source)? {
            Guess::Type(ty) => self.check(source, ty),
            _ => Err(Fault::Ambiguous(quote(source))),
        }
    }

    /// A number that is known now, such as the place of a field.
    pub fn number(&self, source: &Source) -> Result<Option<i128>, Fault> {
        Ok(match self.guess(source)? {
            Guess::Number(value) => Some(value),
            _ => None,
        })
    }

    fn guess(&self, source: &Source) -> Result<Guess, Fault> {
        Ok(match source {
            Source::Signal(name) => match self.scope.meaning(name, self.loops)? {
                Meaning::Number(value) => Guess::Number(value),
                Meaning::Signal(id) => Guess::Type(self.scope.signals[id].ty),
                Meaning::State(state) => Guess::Type(Type::bits(state.bits)),
            },
            Source::Literal(literal) if is_bool(literal) => Guess::Type(Type::BIT),
            Source::Literal(literal) => {
                let misfit = || Fault::Misfit { value: literal.to_string(), wanted: Type::bits(127) };
                Guess::Number(number(literal).ok_or_else(misfit)?)
            }
            Source::Cast(_, bits) => Guess::Type(Type::bits(*bits)),
            Source::Signed(inner) => match self.guess(inner)? {
                Guess::Type(ty) if !ty.signed => Guess::Type(Type::signed(ty.bits)),
                Guess::Number(value) => Guess::Number(value),
                _ => Guess::Open { signed: true },
            },
            Source::Unsigned(inner) => match self.guess(inner)? {
                Guess::Type(ty) => Guess::Type(Type::bits(ty.bits)),
                _ => Guess::Open { signed: false },
            },
            Source::Paren(inner) | Source::IndexReplace(inner, _, _) => self.guess(inner)?,
            Source::Unary(Unary::Not, inner) => match self.guess(inner)? {
                Guess::Number(_) => return Err(Fault::Ambiguous(quote(source))),
                guess => guess,
            },
            Source::Unary(Unary::Neg, inner) => match self.guess(inner)? {
                Guess::Number(value) => Guess::Number(-value),
                guess => guess,
            },
            Source::Unary(Unary::All | Unary::Any | Unary::Xor, _) | Source::Index(..) => {
                Guess::Type(Type::BIT)
            }
            Source::Slice(inner, bits, _) => {
                Guess::Type(Type { bits: *bits, signed: self.slice_is_signed(inner)? })
            }
            Source::Binary(left, op, right) => self.guess_binary(left, op, right)?,
        })
    }

    fn guess_binary(&self, left: &Source, op: &Op, right: &Source) -> Result<Guess, Fault> {
        let comparison = matches!(op, Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge);
        if comparison || matches!(op, Op::LogicalAnd | Op::LogicalOr) {
            return Ok(Guess::Type(Type::BIT));
        }
        let guesses = (self.guess(left)?, self.guess(right)?);
        if let (Guess::Number(l), Guess::Number(r)) = guesses {
            let value = fold(l, op, r).ok_or_else(|| Fault::Ambiguous(quote_binary(left, op, right)))?;
            return Ok(Guess::Number(value));
        }
        Ok(match (op, guesses) {
            // In Rust, a number shifted by a signal is a Bits<64>.
            (Op::Shl | Op::Shr, (Guess::Number(_), _)) => Guess::Type(Type::bits(64)),
            (Op::Shl | Op::Shr, (guess, _)) => guess,
            (Op::Mul, _) => Guess::Type(factor(guesses).with_bits(32)),
            (_, (Guess::Type(ty), _) | (_, Guess::Type(ty))) => Guess::Type(ty),
            (_, (open @ Guess::Open { .. }, _) | (_, open)) => open,
        })
    }

    /// A slice is as signed as its operand.
    fn slice_is_signed(&self, inner: &Source) -> Result<bool, Fault> {
        match self.guess(inner)? {
            Guess::Type(ty) => Ok(ty.signed),
            _ => Err(Fault::Ambiguous(quote(inner))),
        }
    }

    fn check(&self, source: &Source, wanted: Type) -> Typed {
        match self.guess(source)? {
            Guess::Number(value) if wanted.holds(value) => return Ok(Expression::literal(wanted, value)),
            Guess::Number(value) => return Err(Fault::Misfit { value: value.to_string(), wanted }),
            Guess::Type(found) if found != wanted => {
                return Err(Fault::Mismatch { expression: quote(source), found, wanted });
            }
            Guess::Open { signed } if signed != wanted.signed => {
                let found = Type { signed, ..wanted };
                return Err(Fault::Mismatch { expression: quote(source), found, wanted });
            }
            _ => {}
        }
        let refuse = |reason| Err(Fault::Operand { expression: quote(source), reason });
        Ok(match source {
            Source::Signal(name) => match self.scope.meaning(name, self.loops)? {
                Meaning::Number(value) => Expression::literal(wanted, value),
                Meaning::Signal(id) => match self.scope.fixed(id) {
                    Some(Fixed::Number(value)) => Expression::literal(wanted, *value),
                    Some(Fixed::Named(state)) => Expression::new(wanted, Node::State(state.clone())),
                    None => Expression::signal(self.scope, id),
                },
                Meaning::State(state) => Expression::new(wanted, Node::State(state.clone())),
            },
            Source::Literal(literal) => Expression::literal(wanted, number(literal).unwrap_or_default()),
            Source::Paren(inner) => self.check(inner, wanted)?,
            Source::Cast(inner, _) => self.cast(source, inner, wanted)?,
            Source::Signed(inner) => match self.guess(inner)? {
                Guess::Type(ty) if ty.signed => self.check(inner, ty)?.resize(wanted.bits),
                Guess::Type(ty) => self.check(inner, ty)?.reinterpret(true),
                _ => return Err(Fault::Ambiguous(quote(inner))),
            },
            Source::Unsigned(inner) => self.check(inner, Type::signed(wanted.bits))?.reinterpret(false),
            Source::Unary(op, inner) => self.unary(source, op, inner, wanted)?,
            Source::Binary(left, op, right) => self.binary(source, (left, op, right), wanted)?,
            Source::Index(inner, index) => self.bit(source, inner, index)?,
            Source::Slice(inner, bits, at) => self.slice(source, inner, *bits, at)?,
            Source::IndexReplace(inner, index, bit) => {
                let (operand, bit) = (self.check(inner, wanted)?, self.check(bit, Type::BIT)?);
                if wanted.signed {
                    return refuse("Rust replaces bits of Bits only");
                }
                let index = self.place(source, index, operand.ty.bits)?;
                Expression::new(wanted, Node::Replace(Box::new(operand), Box::new(index), Box::new(bit)))
            }
        })
    }

    fn cast(&self, source: &Source, inner: &Source, wanted: Type) -> Typed {
        match self.guess(inner)? {
            Guess::Type(ty) if ty.signed => {
                Err(Fault::Operand { expression: quote(source), reason: "a cast of Bits needs Bits" })
            }
            Guess::Type(ty) => Ok(self.check(inner, ty)?.resize(wanted.bits)),
            Guess::Number(_) => self.check(inner, wanted),
            Guess::Open { .. } => Err(Fault::Ambiguous(quote(inner))),
        }
    }

    fn unary(&self, source: &Source, op: &Unary, inner: &Source, wanted: Type) -> Typed {
        let refuse = |reason| Err(Fault::Operand { expression: quote(source), reason });
        let reduce = |op| Ok(Expression::new(Type::BIT, Node::Reduce(op, Box::new(self.unsigned(inner)?))));
        match op {
            Unary::All => reduce("&"),
            Unary::Any => reduce("|"),
            Unary::Xor => reduce("^"),
            Unary::Not if wanted.signed => refuse("Rust has no ! for Signed"),
            Unary::Neg if !wanted.signed => refuse("Rust has no negation for Bits"),
            Unary::Not => Ok(Expression::new(wanted, Node::Not(Box::new(self.check(inner, wanted)?)))),
            Unary::Neg => Ok(Expression::new(wanted, Node::Negate(Box::new(self.check(inner, wanted)?)))),
        }
    }

    fn binary(&self, source: &Source, (left, op, right): (&Source, &Op, &Source), wanted: Type) -> Typed {
        let refuse = |reason| Err(Fault::Operand { expression: quote(source), reason });
        let both = |ty| Ok((Box::new(self.check(left, ty)?), Box::new(self.check(right, ty)?)));
        let node = match op {
            Op::Add | Op::Sub => both(wanted).map(|(l, r)| Node::Wrapping(symbol(op), l, r))?,
            Op::BitAnd | Op::BitOr | Op::BitXor if wanted.signed => {
                return refuse("Rust has no & | ^ for Signed");
            }
            Op::BitAnd | Op::BitOr | Op::BitXor => {
                both(wanted).map(|(l, r)| Node::Wrapping(symbol(op), l, r))?
            }
            Op::Mul => {
                both(factor((self.guess(left)?, self.guess(right)?))).map(|(l, r)| Node::Product(l, r))?
            }
            Op::LogicalAnd | Op::LogicalOr => {
                both(Type::BIT).map(|(l, r)| Node::Logical(symbol(op), l, r))?
            }
            Op::Shl | Op::Shr if wanted.signed => return refuse("Rust has no shift for Signed"),
            Op::Shl | Op::Shr => {
                let amount = match self.number(right)? {
                    Some(amount) if (0..1 << 31).contains(&amount) => {
                        Expression::literal(Type::bits(32), amount)
                    }
                    Some(_) => return Err(Fault::OutOfRange(quote(source))),
                    None => self.unsigned(right)?,
                };
                Node::Shift(symbol(op), Box::new(self.check(left, wanted)?), Box::new(amount))
            }
            Op::Eq | Op::Ne | Op::Lt | Op::Le | Op::Gt | Op::Ge => {
                let ty = match (self.guess(left)?, self.guess(right)?) {
                    (Guess::Type(ty), _) | (_, Guess::Type(ty)) => ty,
                    (Guess::Number(l), Guess::Number(r)) => {
                        return Ok(Expression::literal(Type::BIT, compare(l, op, r).into()));
                    }
                    _ => return Err(Fault::Ambiguous(quote(source))),
                };
                both(ty).map(|(l, r)| Node::Compare(symbol(op), l, r))?
            }
        };
        Ok(Expression::new(wanted, node))
    }

    fn unsigned(&self, source: &Source) -> Typed {
        let operand = self.subject(source)?;
        if operand.ty.signed {
            return Err(Fault::Operand { expression: quote(source), reason: "Rust has this for Bits only" });
        }
        Ok(operand)
    }

    fn bit(&self, source: &Source, inner: &Source, index: &Source) -> Typed {
        let operand = self.subject(inner)?;
        let index = self.place(source, index, operand.ty.bits)?;
        Ok(Expression::new(Type::BIT, Node::Bit(Box::new(operand), Box::new(index))))
    }

    /// A bit index: a number inside the operand, or an unsigned expression.
    fn place(&self, source: &Source, index: &Source, bits: usize) -> Typed {
        match self.number(index)? {
            Some(at) if (0..bits as i128).contains(&at) => Ok(Expression::literal(Type::bits(32), at)),
            Some(_) => Err(Fault::OutOfRange(quote(source))),
            None => self.unsigned(index),
        }
    }

    fn slice(&self, source: &Source, inner: &Source, bits: usize, at: &Source) -> Typed {
        let operand = self.subject(inner)?;
        match self.number(at)? {
            Some(at) if (0..=operand.ty.bits as i128).contains(&at) => Ok(operand.slice(bits, at as usize)),
            Some(_) => Err(Fault::OutOfRange(quote(source))),
            None => {
                let ty = operand.ty.with_bits(bits);
                let at = self.unsigned(at)?;
                Ok(Expression::new(ty, Node::Window(Box::new(operand), Box::new(at))))
            }
        }
    }
}

/// The type of both factors of a product: rust-hdl multiplies 16 by 16 bits only.
fn factor(guesses: (Guess, Guess)) -> Type {
    let signed = match guesses {
        (Guess::Type(ty), _) | (_, Guess::Type(ty)) => ty.signed,
        (Guess::Open { signed }, _) | (_, Guess::Open { signed }) => signed,
        _ => false,
    };
    Type { bits: 16, signed }
}

fn quote_binary(left: &Source, op: &Op, right: &Source) -> String {
    format!("{} {} {}", quote(left), symbol(op), quote(right))
}

/// Arithmetic of two numbers of the kernel.
fn fold(l: i128, op: &Op, r: i128) -> Option<i128> {
    match op {
        Op::Add => l.checked_add(r),
        Op::Sub => l.checked_sub(r),
        Op::Mul => l.checked_mul(r),
        Op::BitAnd => Some(l & r),
        Op::BitOr => Some(l | r),
        Op::BitXor => Some(l ^ r),
        Op::Shl => u32::try_from(r).ok().filter(|r| *r < 64).and_then(|r| l.checked_mul(1 << r)),
        Op::Shr => u32::try_from(r).ok().and_then(|r| l.checked_shr(r)),
        _ => None,
    }
}

fn compare(l: i128, op: &Op, r: i128) -> bool {
    match op {
        Op::Eq => l == r,
        Op::Ne => l != r,
        Op::Lt => l < r,
        Op::Le => l <= r,
        Op::Gt => l > r,
        _ => l >= r,
    }
}
