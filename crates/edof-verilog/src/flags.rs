//! A bit that is set under a condition is that condition, beside the other bits: `{ready, 3'd0}`.

use crate::expression::{Expression, Node};
use crate::kernel::{Assign, Statement};
use crate::print::pieces;
use crate::types::Type;

/// `c ? x | 8 : x` as x with c at its place in it, where nothing else is there.
pub(crate) fn flag(test: &Expression, then: &Expression, otherwise: &Expression) -> Option<Expression> {
    let ty = otherwise.ty;
    let (before, at) = match &then.node {
        Node::Wrapping("|", x, bit) if **x == *otherwise => (Some(otherwise), place(bit)?),
        _ if otherwise.constant() == Some(0) => (None, place(then)?),
        _ => return None,
    };
    if ty.signed || ty.bits == 1 {
        return None;
    }
    let bit = Box::new(test.clone().resize(ty.bits));
    let by = Box::new(Expression::literal(Type::bits(32), at));
    let bit = if at == 0 { *bit } else { Expression::new(ty, Node::Shift("<<", bit, by)) };
    let Some(before) = before else { return Some(bit) };
    let joined = Expression::new(ty, Node::Wrapping("|", Box::new(before.clone()), Box::new(bit)));
    pieces(&joined).is_some().then_some(joined)
}

/// The place of the only bit that a number has.
fn place(number: &Expression) -> Option<i128> {
    let (bit, by) = match &number.node {
        Node::Shift("<<", bit, by) => (bit.constant()?, by.constant()?),
        _ => (number.constant()?, 0),
    };
    (bit.count_ones() == 1 && bit > 0).then(|| by + i128::from(bit.trailing_zeros()))
}

/// Makes one assignment of the last statement and the next one, where that is `if (c) x = a | 8;` after `x = a;`.
pub(crate) fn joins(last: &mut Vec<Statement>, next: &Statement) -> bool {
    let Some(at) = last.iter().rposition(|statement| !statement.is_silent()) else { return false };
    let Statement::Assign(assign) = &last[at] else { return false };
    let Some(value) = with_flag(assign, next) else { return false };
    last[at] = Statement::Assign(Assign { value, ..assign.clone() });
    last.truncate(at + 1);
    true
}

fn with_flag(assign: &Assign, next: &Statement) -> Option<Expression> {
    let (test, value) = overriding(assign, next)?;
    flag(test, value, &assign.value)
}

/// The condition and the value of a statement `if (c) x = b;` after `x = a;`, where neither of them reads x.
pub(crate) fn overriding<'s>(
    assign: &Assign,
    next: &'s Statement,
) -> Option<(&'s Expression, &'s Expression)> {
    let Statement::If { test, then, otherwise } = next else { return None };
    let mut body = then.iter().filter(|statement| !statement.is_silent());
    let (Some(Statement::Assign(set)), None, []) = (body.next(), body.next(), &otherwise[..]) else {
        return None;
    };
    let reads = [test, &set.value, &assign.value].iter().any(|value| value.reads(assign.target));
    let is_whole = set.target == assign.target && set.at.is_none() && assign.at.is_none();
    (is_whole && !reads).then_some((test, &set.value))
}
