//! One assignment where several statements say no more.
//!
//! `x = 0; x = y;` is `x = y`, and `x = a; if (c) x = b;` is `x = c ? b : a`. Only what is the same for every input is rewritten: a value
//! that is replaced before anything reads it, a choice both of whose sides are known. A bit that is set under a condition is that condition, beside
//! the other bits. What would be long stays a block.

use crate::expression::{Expression, Node};
use crate::flags::{flag, overriding};
use crate::kernel::{Assign, Statement};
use crate::process::Process;
use crate::scope::{Scope, SignalId};
use crate::tidy;
use crate::types::Type;

/// Letters, and choices, that a single assignment has at most, approximately; one that decides nothing may be longer.
const LONGEST: usize = 100;
const LONGEST_OF_ALL: usize = 400;
const CHOICES: usize = 2;

/// The process, with one target, as one assignment if that is short; else without what is overwritten unread.
pub(crate) fn simplify(scope: &Scope, process: Process) -> Process {
    let [target] = process.targets.iter().copied().collect::<Vec<_>>()[..] else { return process };
    if process.plain().is_some() || !process.is_combinational() {
        return process;
    }
    let comments = process.statements.iter().filter(|s| matches!(s, Statement::Comment(_)));
    match value(scope, &process.statements, target, None) {
        Some(value) => {
            let assign = Statement::Assign(Assign { target, at: None, value, holds: false });
            Process::of(comments.cloned().chain([assign]).collect(), process.origin)
        }
        None => Process::of(without_dead(process.statements, target), process.origin),
    }
}

/// The statements with `x = c ? b : a` for `x = a; if (c) x = b;`, where that is one short choice. Resets stay as they are.
pub(crate) fn choices(scope: &Scope, statements: Vec<Statement>) -> Vec<Statement> {
    let mut kept: Vec<Statement> = vec![];
    for statement in statements {
        let statement = match statement {
            Statement::If { test, then, otherwise } => {
                let (then, otherwise) = (choices(scope, then), choices(scope, otherwise));
                Statement::If { test, then, otherwise }
            }
            Statement::Case { subject, mut arms, default } => {
                arms.iter_mut().for_each(|arm| arm.body = choices(scope, std::mem::take(&mut arm.body)));
                Statement::Case { subject, arms, default: default.map(|body| choices(scope, body)) }
            }
            other => other,
        };
        let last = kept.iter().rposition(|statement| !statement.is_silent());
        match last.and_then(|last| Some((last, chosen(scope, &kept[last], &statement)?))) {
            Some((last, assign)) => {
                kept[last] = Statement::Assign(assign);
                kept.truncate(last + 1);
            }
            None => kept.push(statement),
        }
    }
    kept
}

/// One assignment for the last and the next statement, where the next gives the same target another value under a condition.
fn chosen(scope: &Scope, last: &Statement, next: &Statement) -> Option<Assign> {
    let Statement::Assign(assign) = last else { return None };
    let (test, value) = overriding(assign, next)?;
    let is_reset = matches!(test.node, Node::Signal(id) if scope.signals[id].key.ends_with("reset"));
    let value = tidy::expression(choose(test.clone(), value.clone(), assign.value.clone()));
    let mut choices = 0;
    value.walk(&mut |part| choices += usize::from(matches!(part.node, Node::Choose(..))));
    (!is_reset && choices <= 1 && is_short(scope, &value)).then(|| Assign { value, ..assign.clone() })
}

fn is_short(scope: &Scope, value: &Expression) -> bool {
    let (mut letters, mut choices, mut decides) = (0, 0, false);
    value.walk(&mut |part| {
        choices += usize::from(matches!(part.node, Node::Choose(..)));
        decides |= matches!(part.node, Node::Choose(..) | Node::Logical(..));
        letters += match part.node {
            Node::Signal(id) => scope.signals[id].key.len(),
            Node::Resize(_) if part.ty.signed => 30,
            Node::Resize(_) => 8,
            _ => 5,
        };
    });
    letters <= if decides { LONGEST } else { LONGEST_OF_ALL } && choices <= CHOICES
}

/// The target's value after the statements, where it was `before` before them, as long as it is short: with every choice that reads
/// what was before it grows to twice its length.
fn value(
    scope: &Scope,
    statements: &[Statement],
    target: SignalId,
    before: Option<Expression>,
) -> Option<Expression> {
    let mut now = before;
    for statement in statements {
        now = match statement {
            Statement::Comment(_) => now,
            Statement::Assign(assign) if assign.at.is_none() => {
                Some(with(&assign.value, target, now.as_ref())?)
            }
            Statement::If { test, then, otherwise } => {
                let test = with(test, target, now.as_ref())?;
                let then = value(scope, then, target, now.clone())?;
                let otherwise = value(scope, otherwise, target, now)?;
                Some(tidy::expression(choose(test, then, otherwise)))
            }
            _ => return None,
        };
        if now.as_ref().is_some_and(|value| !is_short(scope, value)) {
            return None;
        }
    }
    now
}

fn choose(test: Expression, then: Expression, otherwise: Expression) -> Expression {
    if then == otherwise {
        return then;
    }
    if then.ty == test.ty && (then.constant(), otherwise.constant()) == (Some(1), Some(0)) {
        return test;
    }
    // One choice in another, both of which leave the same.
    if let Node::Choose(also, inner, left) = &then.node
        && **left == otherwise
    {
        let both = Expression::new(Type::BIT, Node::Logical("&&", Box::new(test), also.clone()));
        return choose(both, (**inner).clone(), otherwise);
    }
    if let Some(joined) = flag(&test, &then, &otherwise) {
        return joined;
    }
    Expression::new(then.ty, Node::Choose(Box::new(test), Box::new(then), Box::new(otherwise)))
}

/// The expression, what it reads of the target replaced by the target's value so far.
fn with(expression: &Expression, target: SignalId, now: Option<&Expression>) -> Option<Expression> {
    let mut reads = false;
    expression.walk(&mut |part| reads |= matches!(part.node, Node::Signal(id) if id == target));
    if !reads {
        return Some(expression.clone());
    }
    let now = now?;
    let same = |x: &Expression| with(x, target, Some(now)).map(Box::new);
    Some(match &expression.node {
        Node::Signal(_) => now.clone(),
        Node::Logical(op, x, y) => joined(op, same(x)?, same(y)?),
        Node::Wrapping(op @ ("&" | "|"), x, y) => merged(op, expression.ty, same(x)?, same(y)?),
        _ => return None,
    })
}

fn joined(op: &'static str, x: Box<Expression>, y: Box<Expression>) -> Expression {
    match (op, x.constant(), y.constant()) {
        ("&&", Some(1), _) | ("||", Some(0), _) => *y,
        ("&&", _, Some(1)) | ("||", _, Some(0)) => *x,
        _ => Expression::new(Type::BIT, Node::Logical(op, x, y)),
    }
}

fn merged(op: &'static str, ty: Type, x: Box<Expression>, y: Box<Expression>) -> Expression {
    match (op, x.constant(), y.constant()) {
        ("|", Some(0), _) => *y,
        ("|", _, Some(0)) => *x,
        _ => Expression::new(ty, Node::Wrapping(op, x, y)),
    }
}

/// Drops an assignment of the whole target that the next statement assigns again without reading it.
pub(crate) fn without_dead(statements: Vec<Statement>, target: SignalId) -> Vec<Statement> {
    let mut kept: Vec<Statement> = vec![];
    for statement in statements {
        let statement = match statement {
            Statement::If { test, then, otherwise } => Statement::If {
                test,
                then: without_dead(then, target),
                otherwise: without_dead(otherwise, target),
            },
            Statement::Case { subject, mut arms, default } => {
                arms.iter_mut().for_each(|arm| {
                    arm.body = without_dead(std::mem::take(&mut arm.body), target);
                });
                Statement::Case { subject, arms, default: default.map(|body| without_dead(body, target)) }
            }
            other => other,
        };
        let last = kept.iter().rposition(|statement| !matches!(statement, Statement::Comment(_)));
        if let Some(last) = last
            && overwrites(&statement, target)
            && overwrites(&kept[last], target)
        {
            kept.remove(last);
        }
        kept.push(statement);
    }
    kept
}

/// Gives the whole target a value that does not depend on the one it has.
fn overwrites(statement: &Statement, target: SignalId) -> bool {
    let Statement::Assign(assign) = statement else { return false };
    let mut reads = false;
    assign.value.walk(&mut |part| reads |= matches!(part.node, Node::Signal(id) if id == target));
    assign.target == target && assign.at.is_none() && !reads
}
