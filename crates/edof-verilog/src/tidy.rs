//! Shorter expressions and statements of the same meaning.
//!
//! Each rule holds for every value of its operands at its width; `tests/equal.rs` of `edof-cosim` proves it of whole designs: Yosys compares
//! what is printed with and without this pass.

use crate::cases;
use crate::expression::{Expression, Node};
use crate::flags;
use crate::kernel::{Arm, Assign, Label, Note, Statement};
use crate::types::Type;

/// The statements, tidied.
pub(crate) fn statements(statements: Vec<Statement>) -> Vec<Statement> {
    let mut tidied: Vec<Statement> = vec![];
    for statement in statements {
        let statement = match statement {
            Statement::Assign(assign) => {
                Statement::Assign(Assign { value: expression(assign.value), ..assign })
            }
            Statement::If { test, then, otherwise } => {
                let parts = (expression(test), self::statements(then), self::statements(otherwise));
                match condition(parts) {
                    Some(statement) => cases::chain(statement),
                    None => continue,
                }
            }
            Statement::Case { subject, arms, default } => {
                let tidy = |arm: Arm| Arm { body: self::statements(arm.body), ..arm };
                let arms = arms.into_iter().map(tidy).collect();
                case(expression(subject), arms, default.map(self::statements))
            }
            comment => comment,
        };
        if !flags::joins(&mut tidied, &statement) {
            tidied.push(statement);
        }
    }
    cases::together(tidied)
}

/// An `if` whose first side does something, and that is one with an `if` that stands alone in it.
fn condition((test, then, otherwise): (Expression, Vec<Statement>, Vec<Statement>)) -> Option<Statement> {
    let (test, then, otherwise) = match (then.is_empty(), otherwise.is_empty()) {
        (true, true) => return None,
        (true, false) => (not(test), otherwise, vec![]),
        _ => (test, then, otherwise),
    };
    if otherwise.is_empty()
        && matches!(&then[..], [Statement::If { otherwise, .. }] if otherwise.is_empty())
        && let Some(Statement::If { test: also, then, .. }) = then.first().cloned()
    {
        return Some(Statement::If { test: conjunction(test, also), then, otherwise });
    }
    Some(Statement::If { test, then, otherwise })
}

/// A `case` in which every arm does something: otherwise a chain of comparisons.
fn case(subject: Expression, arms: Vec<Arm>, default: Option<Vec<Statement>>) -> Statement {
    let is_full =
        arms.iter().all(|arm| !arm.body.is_empty()) && default.as_ref().is_some_and(|d| !d.is_empty());
    if is_full {
        return Statement::Case { subject, arms, default };
    }
    let is_empty = default.as_ref().is_none_or(Vec::is_empty);
    // Empty arms matter where the rest does something.
    let kept = arms.into_iter().filter(|arm| !(is_empty && arm.body.is_empty()));
    let mut rest = default.unwrap_or_default();
    for arm in kept.rev() {
        let number = match arm.label {
            Label::Number(number) => Expression::literal(subject.ty, number),
            Label::State(state) => Expression::new(subject.ty, Node::State(state)),
        };
        let test = compare("==", subject.clone(), number);
        rest = condition((test, arm.body, rest)).into_iter().collect();
    }
    rest.pop().unwrap_or(Statement::Comment(Note::default()))
}

/// The expression, tidied from the inside out.
pub(crate) fn expression(whole: Expression) -> Expression {
    let whole = whole.map(&mut expression);
    let ty = whole.ty;
    match whole.node {
        Node::Not(x) if ty == Type::BIT => not(*x),
        Node::Compare(op @ ("==" | "!="), x, y) => equality(op, *x, *y),
        Node::Logical("&&", x, y) => conjunction(*x, *y),
        Node::Logical("||", x, y) => disjunction(*x, *y),
        Node::Wrapping("&", x, y) if is_all_ones(&y) => *x,
        Node::Choose(test, x, y) if ty == Type::BIT => choice(*test, *x, *y),
        Node::Choose(test, x, y) => match sign_extended(ty, &test, &x, &y) {
            Some(number) => number,
            None => Expression::new(ty, Node::Choose(test, x, y)),
        },
        node => Expression::new(ty, node),
    }
}

/// A mask that lets everything through.
fn is_all_ones(mask: &Expression) -> bool {
    mask.ty.bits < 100 && mask.constant() == Some((1 << mask.ty.bits) - 1)
}

/// `x[7] ? {8'd0, x} | 16'hff00 : {8'd0, x}` as the number x with its own sign; x may be a slice, whose highest bit is then one of the whole.
fn sign_extended(ty: Type, test: &Expression, ones: &Expression, zeros: &Expression) -> Option<Expression> {
    let (Node::Bit(of, at), Node::Resize(x), Node::Wrapping("|", low, high)) =
        (&test.node, &zeros.node, &ones.node)
    else {
        return None;
    };
    let (narrow, wide) = (x.ty.bits, ty.bits);
    let first = match &x.node {
        _ if of == x => 0,
        Node::Slice(whole, first) if of == whole => *first,
        _ => return None,
    };
    if ty.signed || x.ty.signed || narrow >= wide || wide > 100 || **low != *zeros {
        return None;
    }
    let is_top = at.constant() == Some((first + narrow) as i128 - 1);
    let is_above = high.constant() == Some((1 << wide) - (1 << narrow));
    (is_top && is_above).then(|| (**x).clone().reinterpret(true).resize(wide).reinterpret(false))
}

fn bit(node: Node) -> Expression {
    Expression::new(Type::BIT, node)
}

fn compare(op: &'static str, x: Expression, y: Expression) -> Expression {
    bit(Node::Compare(op, Box::new(x), Box::new(y)))
}

/// The opposite of a bit.
pub(crate) fn not(x: Expression) -> Expression {
    let opposite = |op| match op {
        "==" => "!=",
        "!=" => "==",
        "<" => ">=",
        ">=" => "<",
        ">" => "<=",
        _ => ">",
    };
    let is_free = |x: &Expression| matches!(x.node, Node::Not(_) | Node::Compare(..)) && x.ty == Type::BIT;
    match x.node {
        Node::Literal(value) => Expression::literal(Type::BIT, 1 - value),
        Node::Not(x) if x.ty == Type::BIT => *x,
        Node::Compare(op, x, y) => compare(opposite(op), *x, *y),
        // De Morgan, where it takes negations away.
        Node::Logical(op, x, y) if is_free(&x) && is_free(&y) => {
            let op = if op == "&&" { "||" } else { "&&" };
            bit(Node::Logical(op, Box::new(not(*x)), Box::new(not(*y))))
        }
        node => bit(Node::Not(Box::new(bit(node)))),
    }
}

/// `x + 1 == 8` is `x == 7`, at any width: both sides wrap.
fn equality(op: &'static str, x: Expression, y: Expression) -> Expression {
    let (Some(right), ty) = (y.constant(), x.ty) else { return compare(op, x, y) };
    match &x.node {
        Node::Wrapping(sum @ ("+" | "-"), value, step) if ty.bits < 100 => match step.constant() {
            Some(step) => {
                let number = if *sum == "+" { right - step } else { right + step };
                compare(op, (**value).clone(), Expression::literal(ty, number))
            }
            None => compare(op, x, y),
        },
        _ if ty == Type::BIT && (right == 1) == (op == "==") => x,
        _ if ty == Type::BIT => not(x),
        _ => compare(op, x, y),
    }
}

fn conjunction(x: Expression, y: Expression) -> Expression {
    match (x.constant(), y.constant()) {
        (Some(1), _) | (_, Some(0)) => return y,
        (Some(0), _) | (_, Some(1)) => return x,
        _ => {}
    }
    let mut terms = vec![];
    conjuncts(x, &mut terms);
    conjuncts(y, &mut terms);
    // What equals one number is unlike all others.
    let fixed: Vec<(Expression, i128)> = terms.iter().filter_map(|term| compared("==", term)).collect();
    let is_implied = |term: &Expression| {
        compared("!=", term).is_some_and(|(subject, number)| {
            fixed.iter().any(|(other, value)| *other == subject && *value != number)
        })
    };
    terms.retain(|term| !is_implied(term));
    let mut kept: Vec<Expression> = vec![];
    for term in terms {
        if !kept.contains(&term) {
            kept.push(term);
        }
    }
    let all = kept.into_iter().reduce(|x, y| bit(Node::Logical("&&", Box::new(x), Box::new(y))));
    all.unwrap_or(Expression::literal(Type::BIT, 1))
}

fn conjuncts(x: Expression, terms: &mut Vec<Expression>) {
    match x.node {
        Node::Logical("&&", x, y) => {
            conjuncts(*x, terms);
            conjuncts(*y, terms);
        }
        _ => terms.push(x),
    }
}

/// Subject and number of a comparison with a number.
fn compared(op: &str, term: &Expression) -> Option<(Expression, i128)> {
    match &term.node {
        Node::Compare(found, x, y) if *found == op => Some(((**x).clone(), number(y)?)),
        _ => None,
    }
}

/// The number that a literal or a state is.
fn number(x: &Expression) -> Option<i128> {
    match &x.node {
        Node::State(state) => i128::try_from(state.value).ok(),
        _ => x.constant(),
    }
}

fn disjunction(x: Expression, y: Expression) -> Expression {
    match (x.constant(), y.constant()) {
        (Some(0), _) | (_, Some(1)) => y,
        (Some(1), _) | (_, Some(0)) => x,
        _ if x == y => x,
        _ => bit(Node::Logical("||", Box::new(x), Box::new(y))),
    }
}

/// A choice between bits of which one is known.
fn choice(test: Expression, x: Expression, y: Expression) -> Expression {
    match (x.constant(), y.constant()) {
        (Some(1), Some(0)) => test,
        (Some(0), Some(1)) => not(test),
        (Some(1), _) => disjunction(test, y),
        (Some(0), _) => conjunction(not(test), y),
        (_, Some(0)) => conjunction(test, x),
        (_, Some(1)) => disjunction(not(test), x),
        _ => bit(Node::Choose(Box::new(test), Box::new(x), Box::new(y))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: Type = Type::bits(4);

    fn signal(ty: Type, id: usize) -> Expression {
        Expression::new(ty, Node::Signal(id))
    }

    fn number(value: i128) -> Expression {
        Expression::literal(WIDE, value)
    }

    fn logical(op: &'static str, x: Expression, y: Expression) -> Expression {
        bit(Node::Logical(op, Box::new(x), Box::new(y)))
    }

    /// The value of an expression where signal 0 of four bits and signals 1 and 2 of one are known.
    fn value(x: &Expression, of: [i128; 3]) -> i128 {
        let wrap = |value: i128| value & ((1 << x.ty.bits) - 1);
        match &x.node {
            Node::Signal(id) => of[*id],
            Node::Literal(value) => *value,
            Node::Not(y) => wrap(!value(y, of)),
            Node::Wrapping("+", y, z) => wrap(value(y, of) + value(z, of)),
            Node::Wrapping(_, y, z) => wrap(value(y, of) - value(z, of)),
            Node::Compare(op, y, z) => {
                let (y, z) = (value(y, of), value(z, of));
                i128::from(match *op {
                    "==" => y == z,
                    "!=" => y != z,
                    "<" => y < z,
                    ">=" => y >= z,
                    ">" => y > z,
                    _ => y <= z,
                })
            }
            Node::Logical("&&", y, z) => value(y, of) & value(z, of),
            Node::Logical(_, y, z) => value(y, of) | value(z, of),
            Node::Choose(t, y, z) => value(if value(t, of) == 1 { y } else { z }, of),
            other => unreachable!("{other:?}"),
        }
    }

    /// Every bit expression of some depth, from a small generator.
    fn drawn(state: &mut u64, depth: usize) -> Expression {
        let mut next = |below: u64| {
            *state ^= *state << 13;
            *state ^= *state >> 7;
            *state ^= *state << 17;
            *state % below
        };
        let kind = if depth == 0 { next(3) } else { next(9) };
        let (value, step, op) = (next(16), next(16), next(6) as usize);
        let ops = ["==", "!=", "<", "<=", ">", ">="];
        match kind {
            0 => signal(Type::BIT, 1),
            1 => signal(Type::BIT, 2),
            2 => compare(ops[op], signal(WIDE, 0), number(value.into())),
            3 => {
                let sum = if step % 2 == 0 { "+" } else { "-" };
                let node = Node::Wrapping(sum, Box::new(signal(WIDE, 0)), Box::new(number(step.into())));
                compare(ops[op], Expression::new(WIDE, node), number(value.into()))
            }
            4 => bit(Node::Not(Box::new(drawn(state, depth - 1)))),
            5 => Expression::literal(Type::BIT, (value % 2).into()),
            6 => {
                let (test, x) = (drawn(state, depth - 1), drawn(state, depth - 1));
                bit(Node::Choose(Box::new(test), Box::new(x), Box::new(drawn(state, depth - 1))))
            }
            7 => logical("&&", drawn(state, depth - 1), drawn(state, depth - 1)),
            _ => logical("||", drawn(state, depth - 1), drawn(state, depth - 1)),
        }
    }

    #[test]
    fn a_tidied_expression_has_the_same_value_for_every_input() {
        let mut state = 7;
        for _ in 0..3_000 {
            let whole = drawn(&mut state, 5);
            let tidied = expression(whole.clone());
            for inputs in 0..64_i128 {
                let of = [inputs & 15, inputs >> 4 & 1, inputs >> 5];
                assert_eq!(value(&tidied, of), value(&whole, of), "{whole:?} became {tidied:?} at {of:?}");
            }
        }
    }

    #[test]
    fn a_choice_that_copies_the_sign_upwards_is_an_extension_and_no_other_is() {
        let (narrow, byte) = (signal(WIDE, 0), Type::bits(8));
        let choose = |top: i128, above: i128| {
            let test = bit(Node::Bit(Box::new(narrow.clone()), Box::new(number(top))));
            let zeros = narrow.clone().resize(8);
            let high = Box::new(Expression::literal(byte, above));
            let ones = Expression::new(byte, Node::Wrapping("|", Box::new(zeros.clone()), high));
            Expression::new(byte, Node::Choose(Box::new(test), Box::new(ones), Box::new(zeros)))
        };
        let extended = narrow.clone().reinterpret(true).resize(8).reinterpret(false);
        assert_eq!(expression(choose(3, 0xf0)), extended);
        for (top, above) in [(2, 0xf0), (3, 0xe0), (3, 0xf8)] {
            assert_eq!(expression(choose(top, above)), choose(top, above));
        }
    }

    #[test]
    fn a_choice_by_the_highest_bit_of_a_slice_is_an_extension_and_no_other_is() {
        let (whole, byte) = (signal(Type::bits(12), 0), Type::bits(8));
        let slice = Expression::new(WIDE, Node::Slice(Box::new(whole.clone()), 5));
        let choose = |top: i128| {
            let test = bit(Node::Bit(Box::new(whole.clone()), Box::new(number(top))));
            let zeros = slice.clone().resize(8);
            let high = Box::new(Expression::literal(byte, 0xf0));
            let ones = Expression::new(byte, Node::Wrapping("|", Box::new(zeros.clone()), high));
            Expression::new(byte, Node::Choose(Box::new(test), Box::new(ones), Box::new(zeros)))
        };
        assert_eq!(expression(choose(8)), slice.clone().reinterpret(true).resize(8).reinterpret(false));
        for top in [3, 7, 9] {
            assert_eq!(expression(choose(top)), choose(top));
        }
    }

    #[test]
    fn the_third_of_a_chain_is_one_comparison() {
        let is = |value| compare("==", signal(WIDE, 0), number(value));
        let third = logical("&&", not(is(0)), logical("&&", not(is(1)), is(2)));
        assert_eq!(expression(third), is(2));
    }
}
