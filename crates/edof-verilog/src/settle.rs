//! Which reads see a signal as it stands, because it is assigned once more further on.

use std::collections::{BTreeMap, BTreeSet};

use crate::expression::{Expression, Node};
use crate::kernel::Statement;
use crate::process::in_order;
use crate::scope::{Scope, SignalId};

/// For each target, the local signals and outputs that it reads before their last assignment.
pub(crate) fn unsettled(scope: &Scope, statements: &[Statement]) -> BTreeMap<SignalId, BTreeSet<SignalId>> {
    let mut order = Order { scope, now: 0, last: BTreeMap::new(), reads: vec![] };
    order.block(statements, &[]);
    let mut unsettled: BTreeMap<SignalId, BTreeSet<SignalId>> = BTreeMap::new();
    for (target, read, at) in order.reads {
        if order.last.get(&read).is_some_and(|last| *last >= at) {
            unsettled.entry(target).or_default().insert(read);
        }
    }
    unsettled
}

/// Assignments, numbered as the text has them.
struct Order<'a> {
    scope: &'a Scope,
    now: usize,
    /// Number of the last assignment of each signal.
    last: BTreeMap<SignalId, usize>,
    /// What each target reads, and the number of the next assignment then.
    reads: Vec<(SignalId, SignalId, usize)>,
}

impl Order<'_> {
    fn seen(&self, expression: &Expression) -> Vec<(SignalId, usize)> {
        let mut seen = vec![];
        expression.walk(&mut |part| match part.node {
            Node::Signal(id) if in_order(self.scope, id) => seen.push((id, self.now)),
            _ => {}
        });
        seen
    }

    fn block(&mut self, statements: &[Statement], above: &[(SignalId, usize)]) {
        for statement in statements {
            match statement {
                Statement::Comment(_) => {}
                Statement::Assign(assign) => {
                    let seen = self.seen(&assign.value);
                    let all = above.iter().chain(&seen).map(|(read, at)| (assign.target, *read, *at));
                    self.reads.extend(all);
                    self.last.insert(assign.target, self.now);
                    self.now += 1;
                }
                Statement::If { test, then, otherwise } => {
                    let above = [above, &self.seen(test)].concat();
                    self.block(then, &above);
                    self.block(otherwise, &above);
                }
                Statement::Case { subject, arms, default } => {
                    let above = [above, &self.seen(subject)].concat();
                    arms.iter().map(|arm| &arm.body).chain(default).for_each(|body| self.block(body, &above));
                }
            }
        }
    }
}
