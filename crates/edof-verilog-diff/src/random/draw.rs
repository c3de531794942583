//! Draws plans.

use super::plan::{Expr, Plan, Statement, Target, Test};
use crate::drive::Random;

/// What expressions of a plan may name.
struct Names {
    registers: usize,
    locals: usize,
    parts: usize,
    memories: usize,
}

impl Plan {
    /// A random plan with parts of at most `depth` levels.
    #[must_use]
    pub fn drawn(random: &mut Random, depth: usize, name: &str) -> Self {
        let parts: Vec<Self> = (0..if depth == 0 { 0 } else { random.below(3) })
            .map(|n| Self::drawn(random, depth - 1, &format!("{name}_{n}")))
            .collect();
        let registers = 1 + random.below(4);
        let (locals, memories) = (random.below(4), usize::from(random.chance(80)));
        let mut names = Names { registers, locals: 0, parts: parts.len(), memories };
        let mut statements = vec![];
        for local in 0..locals {
            statements.push(Statement::Assign(Target::Local(local), expr(random, &names, 2)));
            if random.chance(160) {
                names.locals = local + 1;
                let targets = [Target::Local(local), Target::Register(random.below(registers))];
                statements.extend(guarded(random, &names, &targets, 2));
            }
            names.locals = local + 1;
        }
        for _ in 0..1 + random.below(4) {
            let targets: Vec<Target> = (0..2).map(|_| Target::Register(random.below(registers))).collect();
            statements.extend(guarded(random, &names, &targets, 2));
        }
        let feeds = parts.iter().map(|_| [expr(random, &names, 1), expr(random, &names, 1)]).collect();
        let memories = (0..memories)
            .map(|_| [expr(random, &names, 1), expr(random, &names, 1), expr(random, &names, 1)]);
        let memories = memories.collect();
        let outputs = [expr(random, &names, 1), Expr::Register(random.below(registers))];
        Self { name: name.into(), registers, locals, statements, parts, feeds, memories, outputs }
    }
}

const OPERATIONS: [&str; 5] = ["+", "-", "&", "|", "^"];
const COMPARISONS: [&str; 6] = ["==", "!=", "<", "<=", ">", ">="];

fn expr(random: &mut Random, names: &Names, depth: usize) -> Expr {
    if depth > 0 && random.chance(150) {
        let x = Box::new(expr(random, names, depth - 1));
        return match random.below(6) {
            0 => Expr::Not(x),
            1 => Expr::Shifted(x, random.below(8) as u64),
            _ => Expr::Binary(OPERATIONS[random.below(5)], x, Box::new(expr(random, names, depth - 1))),
        };
    }
    match random.below(8) {
        0 => Expr::Number(random.word(8) as u64),
        1 if names.locals > 0 => Expr::Local(random.below(names.locals)),
        2 if names.parts > 0 => Expr::Part(random.below(names.parts * 2)),
        3 if names.memories > 0 => Expr::Memory(random.below(names.memories)),
        4 | 5 => Expr::Input(random.below(2)),
        _ => Expr::Register(random.below(names.registers)),
    }
}

fn test(random: &mut Random, names: &Names, depth: usize) -> Test {
    match random.below(if depth == 0 { 4 } else { 7 }) {
        0 => Test::Bit(expr(random, names, 0), random.below(8) as u64),
        1 => Test::Any(expr(random, names, 1)),
        2 => Test::Compare("==", expr(random, names, 1), Expr::Number(random.below(4) as u64)),
        4 => Test::Not(Box::new(test(random, names, depth - 1))),
        5 | 6 => {
            let op = if random.chance(128) { "&&" } else { "||" };
            Test::Both(op, Box::new(test(random, names, depth - 1)), Box::new(test(random, names, depth - 1)))
        }
        _ => Test::Compare(COMPARISONS[random.below(6)], expr(random, names, 1), expr(random, names, 1)),
    }
}

/// Statements under conditions.
fn guarded(random: &mut Random, names: &Names, targets: &[Target], depth: usize) -> Vec<Statement> {
    let body = |random: &mut Random| -> Vec<Statement> {
        if depth > 0 && random.chance(90) {
            return guarded(random, names, targets, depth - 1);
        }
        let count = 1 + random.below(2);
        (0..count)
            .map(|_| Statement::Assign(targets[random.below(targets.len())], expr(random, names, 2)))
            .collect()
    };
    match random.below(6) {
        0 => vec![Statement::Assign(targets[0], expr(random, names, 2))],
        // A chain of comparisons with numbers, as people write it in place of a match.
        1 => {
            let subject = Expr::Register(random.below(names.registers));
            let last = if random.chance(128) { body(random) } else { vec![] };
            (0..4).rev().fold(last, |rest, number| {
                let test = Test::Compare("==", subject.clone(), Expr::Number(number));
                vec![Statement::If(test, body(random), rest)]
            })
        }
        2 => {
            let subject = expr(random, names, 0);
            let arms = (0..1 + random.below(4)).map(|n| (n as u64, body(random))).collect();
            let default = if random.chance(128) { body(random) } else { vec![] };
            vec![Statement::Match(subject, arms, default)]
        }
        _ => {
            let test = test(random, names, 2);
            let then = body(random);
            let otherwise = if random.chance(100) { body(random) } else { vec![] };
            vec![Statement::If(test, then, otherwise)]
        }
    }
}
