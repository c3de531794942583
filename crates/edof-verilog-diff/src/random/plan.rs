//! A random circuit as data, and which of its outputs follow which inputs.

/// An expression of 8 bits.
#[derive(Debug, Clone)]
pub(super) enum Expr {
    Input(usize),
    Register(usize),
    Local(usize),
    Part(usize),
    Memory(usize),
    Number(u64),
    Binary(&'static str, Box<Expr>, Box<Expr>),
    Not(Box<Expr>),
    Shifted(Box<Expr>, u64),
}

/// A condition.
#[derive(Debug, Clone)]
pub(super) enum Test {
    Compare(&'static str, Expr, Expr),
    Bit(Expr, u64),
    Any(Expr),
    Not(Box<Test>),
    Both(&'static str, Box<Test>, Box<Test>),
}

/// What a statement drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Register(usize),
    Local(usize),
}

#[derive(Debug, Clone)]
pub(super) enum Statement {
    Assign(Target, Expr),
    If(Test, Vec<Statement>, Vec<Statement>),
    Match(Expr, Vec<(u64, Vec<Statement>)>, Vec<Statement>),
}

/// A circuit as data: two inputs and two outputs of 8 bits, and a reset of its registers.
#[derive(Debug, Clone)]
pub struct Plan {
    pub(super) name: String,
    pub(super) registers: usize,
    pub(super) locals: usize,
    pub(super) statements: Vec<Statement>,
    pub(super) parts: Vec<Plan>,
    /// What the inputs of each part follow.
    pub(super) feeds: Vec<[Expr; 2]>,
    /// Address, data and enable bit of each memory.
    pub(super) memories: Vec<[Expr; 3]>,
    pub(super) outputs: [Expr; 2],
}

impl Plan {
    /// Whether an output follows an input within the cycle, and which: `[output][input]`.
    #[must_use]
    pub fn paths(&self) -> [[bool; 2]; 2] {
        let sources = self.sources();
        let of = |expr: &Expr| [0, 1].map(|input| self.follows(expr, input, &sources, &mut vec![]));
        [of(&self.outputs[0]), of(&self.outputs[1])]
    }

    /// Whether the plan, or a part of it, has a loop without a register: only then does the backend reject the circuit, unless a number breaks the
    /// loop, as in `x | 255`.
    #[must_use]
    pub fn loops(&self) -> bool {
        let sources = self.sources();
        let through = |n: usize| {
            // From output o of part n back to an input of the part that o follows.
            let paths = self.parts[n].paths();
            (0..2).any(|o| {
                (0..2).any(|i| {
                    paths[o][i] && self.reaches_part(&self.feeds[n][i], n * 2 + o, &sources, &mut vec![])
                })
            })
        };
        self.parts.iter().any(Self::loops) || (0..self.parts.len()).any(through)
    }

    /// The expressions that each local follows.
    fn sources(&self) -> Vec<Vec<Expr>> {
        let mut sources = vec![vec![]; self.locals];
        collect(&self.statements, &[], &mut sources);
        sources
    }

    fn follows(&self, expr: &Expr, input: usize, sources: &[Vec<Expr>], open: &mut Vec<Expr2>) -> bool {
        self.search(expr, sources, open, &|leaf| matches!(leaf, Expr::Input(n) if *n == input))
    }

    fn reaches_part(&self, expr: &Expr, output: usize, sources: &[Vec<Expr>], open: &mut Vec<Expr2>) -> bool {
        self.search(expr, sources, open, &|leaf| matches!(leaf, Expr::Part(n) if *n == output))
    }

    fn search(
        &self,
        expr: &Expr,
        sources: &[Vec<Expr>],
        open: &mut Vec<Expr2>,
        is_found: &dyn Fn(&Expr) -> bool,
    ) -> bool {
        if is_found(expr) {
            return true;
        }
        match expr {
            Expr::Binary(_, x, y) => {
                self.search(x, sources, open, is_found) || self.search(y, sources, open, is_found)
            }
            Expr::Not(x) | Expr::Shifted(x, _) => self.search(x, sources, open, is_found),
            Expr::Local(local) => {
                let key = (false, *local);
                if open.contains(&key) {
                    return false;
                }
                open.push(key);
                sources[*local].iter().any(|source| self.search(source, sources, open, is_found))
            }
            Expr::Part(output) => {
                let key = (true, *output);
                if open.contains(&key) {
                    return false;
                }
                open.push(key);
                let (part, output) = (output / 2, output % 2);
                let paths = self.parts[part].paths();
                (0..2).any(|i| paths[output][i] && self.search(&self.feeds[part][i], sources, open, is_found))
            }
            _ => false,
        }
    }
}

/// A local or an output of a part that was looked at.
type Expr2 = (bool, usize);

/// What the locals follow: values, and the tests above them.
fn collect(statements: &[Statement], above: &[Expr], sources: &mut [Vec<Expr>]) {
    for statement in statements {
        match statement {
            Statement::Assign(Target::Local(local), value) => {
                sources[*local].extend(above.iter().cloned().chain([value.clone()]));
            }
            Statement::Assign(..) => {}
            Statement::If(test, then, otherwise) => {
                let above = [above, &test.operands()].concat();
                collect(then, &above, sources);
                collect(otherwise, &above, sources);
            }
            Statement::Match(subject, arms, default) => {
                let above = [above, std::slice::from_ref(subject)].concat();
                arms.iter().for_each(|(_, body)| collect(body, &above, sources));
                collect(default, &above, sources);
            }
        }
    }
}

impl Test {
    fn operands(&self) -> Vec<Expr> {
        match self {
            Self::Compare(_, x, y) => vec![x.clone(), y.clone()],
            Self::Bit(x, _) | Self::Any(x) => vec![x.clone()],
            Self::Not(test) => test.operands(),
            Self::Both(_, one, other) => [one.operands(), other.operands()].concat(),
        }
    }
}
