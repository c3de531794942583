//! Comparisons of one subject with numbers, as a `case`.

use std::collections::HashSet;

use crate::expression::{Expression, Node};
use crate::flow::collect_targets;
use crate::kernel::{Arm, Assign, Label, Statement};
use crate::scope::SignalId;

/// Fewer comparisons stay as they are.
const MIN_ARMS: usize = 3;

/// A chain of comparisons that has an `else`, as a `case`.
pub(crate) fn chain(statement: Statement) -> Statement {
    match comparisons(&statement) {
        Some((subject, arms, otherwise)) if arms.len() >= MIN_ARMS && !otherwise.is_empty() => {
            Statement::Case { subject, arms, default: Some(otherwise) }
        }
        _ => statement,
    }
}

/// The statements, those that compare one subject with different numbers as one `case` where a default is known.
pub(crate) fn together(statements: Vec<Statement>) -> Vec<Statement> {
    let mut kept: Vec<Statement> = vec![];
    let mut rest = statements.into_iter().peekable();
    while let Some(first) = rest.next() {
        let mut run = vec![first];
        while let Some(next) = rest.next_if(|next| next.is_silent() || joins(&run, next)) {
            run.push(next);
        }
        let silent = run.iter().rev().take_while(|statement| statement.is_silent()).count();
        let after = run.split_off(run.len() - silent);
        match exclusive(&run).and_then(|(subject, arms)| as_case(subject, arms, &mut kept)) {
            Some(case) => kept.push(case),
            None => kept.extend(run),
        }
        kept.extend(after);
    }
    kept
}

/// Whether the statement compares the subject of the others, which they leave as it is, with another number.
fn joins(run: &[Statement], next: &Statement) -> bool {
    let Some((subject, arms)) = exclusive(run) else { return false };
    let targets = targets(&arms);
    exclusive(std::slice::from_ref(next)).is_some_and(|(same, more)| {
        let is_new = |arm: &Arm| arms.iter().all(|known| number(&known.label) != number(&arm.label));
        same == subject && more.iter().all(is_new) && !targets.iter().any(|target| subject.reads(*target))
    })
}

/// Subject and arms of statements `if (s == 1) …` without an `else`.
fn exclusive(run: &[Statement]) -> Option<(Expression, Vec<Arm>)> {
    let mut found: Option<(Expression, Vec<Arm>)> = None;
    for statement in run.iter().filter(|statement| !statement.is_silent()) {
        let (subject, arms, otherwise) = comparisons(statement)?;
        if !otherwise.is_empty() {
            return None;
        }
        match &mut found {
            Some((_, all)) => all.extend(arms),
            None => found = Some((subject, arms)),
        }
    }
    found
}

/// Subject, arms and the rest of `if (s == 1) … else if (s == 2) …`.
fn comparisons(statement: &Statement) -> Option<(Expression, Vec<Arm>, Vec<Statement>)> {
    let Statement::If { test, then, otherwise } = statement else { return None };
    let Node::Compare("==", subject, number_of) = &test.node else { return None };
    let label = match &number_of.node {
        Node::Literal(value) => Label::Number(*value),
        Node::State(state) => Label::State(state.clone()),
        _ => return None,
    };
    if !matches!(subject.node, Node::Signal(_) | Node::Slice(..)) {
        return None;
    }
    let mut arms = vec![Arm { label, body: then.clone() }];
    if let [rest] = &otherwise[..]
        && let Some((same, more, last)) = comparisons(rest)
        && same == **subject
        && more.iter().all(|arm| number(&arm.label) != number(&arms[0].label))
    {
        arms.extend(more);
        return Some((same, arms, last));
    }
    Some(((**subject).clone(), arms, otherwise.clone()))
}

fn number(label: &Label) -> i128 {
    match label {
        Label::Number(number) => *number,
        Label::State(state) => state.value as i128,
    }
}

/// The arms as a `case`, if there is something to say for all other numbers: what an assignment before it says. It moves there.
fn as_case(subject: Expression, mut arms: Vec<Arm>, before: &mut Vec<Statement>) -> Option<Statement> {
    if arms.len() < MIN_ARMS {
        return None;
    }
    let is_full = subject.ty.bits < 16 && arms.len() == 1 << subject.ty.bits;
    let mut default = None;
    for n in (0..before.len()).rev() {
        let first = match &before[n] {
            Statement::Comment(_) => continue,
            Statement::Assign(first) => first,
            _ => break,
        };
        if !is_movable(first, &before[n + 1..], &subject) {
            continue;
        }
        if arms.iter().all(|arm| is_overwritten(arm, first.target)) {
            default = Some(vec![before.remove(n)]);
            break;
        }
        if let Some(value) = common(&arms, first.target, &before[n + 1..]) {
            let target = first.target;
            let said = Statement::Assign(Assign { value, ..first.clone() });
            default = Some(vec![std::mem::replace(&mut before[n], said)]);
            arms.iter_mut().for_each(|arm| arm.body.retain(|statement| !is_assignment(statement, target)));
            break;
        }
    }
    let last = if is_full { arms.pop().map(|arm| arm.body) } else { None };
    Some(Statement::Case { subject, arms, default: Some(last.or(default)?) })
}

/// Whether an assignment means the same behind those that follow it, and does not change the subject.
fn is_movable(first: &Assign, following: &[Statement], subject: &Expression) -> bool {
    let is_apart = |statement: &Statement| match statement {
        Statement::Comment(_) => true,
        Statement::Assign(other) => {
            other.target != first.target
                && !other.value.reads(first.target)
                && !first.value.reads(other.target)
        }
        _ => false,
    };
    first.at.is_none() && !first.holds && !subject.reads(first.target) && following.iter().all(is_apart)
}

/// Whether the arm does nothing but give the target values that do not depend on the one before.
fn is_overwritten(arm: &Arm, target: SignalId) -> bool {
    let starts = match arm.body.first() {
        Some(Statement::Assign(assign)) => {
            assign.target == target && assign.at.is_none() && !assign.value.reads(target)
        }
        _ => false,
    };
    starts && targets(std::slice::from_ref(arm)).len() == 1
}

/// The value that each arm gives the target, the same in all, in one of its assignments; it can be given before them and `following`.
fn common(arms: &[Arm], target: SignalId, following: &[Statement]) -> Option<Expression> {
    let only = |arm: &Arm| {
        let mut given = None;
        for statement in &arm.body {
            let Statement::Assign(assign) = statement else { return None };
            match () {
                () if assign.target != target => (!assign.value.reads(target)).then_some(())?,
                () if given.is_none() && assign.at.is_none() => given = Some(assign.value.clone()),
                () => return None,
            }
        }
        given.filter(|_| arm.body.len() > 1)
    };
    let value = only(&arms[0])?;
    let changes = |id: SignalId| value.reads(id);
    let is_said = arms.iter().all(|arm| only(arm).as_ref() == Some(&value));
    let is_kept = !targets(arms).into_iter().any(changes);
    let is_early = following.iter().all(|statement| match statement {
        Statement::Assign(assign) => !changes(assign.target),
        _ => true,
    });
    (is_said && is_kept && is_early).then_some(value)
}

fn is_assignment(statement: &Statement, target: SignalId) -> bool {
    matches!(statement, Statement::Assign(assign) if assign.target == target)
}

fn targets(arms: &[Arm]) -> HashSet<SignalId> {
    let mut targets = HashSet::new();
    arms.iter().for_each(|arm| collect_targets(&arm.body, &mut targets));
    targets
}
