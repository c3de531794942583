//! What a page states of its making: the command that made it, and the programs that measured what it says.

use crate::journal::{Maker, RowsFile};
use edof_core::words::count;

/// How a page was made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Made {
    /// The command, as the run's own arguments give it.
    pub command: String,
    /// What measured it: one program, or those of all rows.
    pub makers: Vec<Maker>,
    /// The file of rows that it was made from, if there is one.
    pub rows: Option<RowsFile>,
}

/// What a page says of rows whose program did not state itself.
pub const OLD: &str = "the rows are of an old format, which does not state the revision that measured them";

impl Made {
    /// What a report adds to its command: the programs that measured the rows, as remarks of a shell; nothing where `own` measured all of them.
    #[must_use]
    pub fn remarks(makers: &[Maker], own: &Maker) -> String {
        let remark = |maker: &Maker| match maker {
            Maker::Program(p) => format!("  # rows of revision {}, {}", p.revision, p.machine()),
            Maker::Old { machine, .. } => format!("  # rows of an unknown revision, {machine}"),
        };
        makers.iter().filter(|maker| *maker != own).map(remark).collect()
    }
}

impl std::fmt::Display for Made {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let maker = |maker: &Maker| match maker {
            Maker::Program(p) => {
                format!("revision `{}`, {}, on {}; {}", p.revision, p.compiler, p.machine(), p.host.isa)
            }
            Maker::Old { .. } => OLD.to_owned(),
        };
        let makers: Vec<String> = self.makers.iter().map(maker).collect();
        write!(f, "Made by `{}`", self.command)?;
        match &makers[..] {
            [] => f.write_str("."),
            [one] => write!(f, " ({one})."),
            several => write!(f, " (rows of {} programs: {}).", several.len(), several.join("; ")),
        }?;
        let Some(RowsFile { rows, sha256, git }) = &self.rows else { return Ok(()) };
        write!(f, " The file of its {} has SHA-256 `{sha256}`", count(*rows, "row"))?;
        match git {
            Some(place) => write!(f, "; `git show {place}` prints it."),
            None => f.write_str("."),
        }
    }
}

/// CPU and threads that times are of; of rows of several machines all of them.
#[must_use]
pub fn machines(makers: &[Maker]) -> String {
    let mut all: Vec<String> = makers.iter().map(Maker::machine).collect();
    all.sort();
    all.dedup();
    all.join("; ")
}

#[cfg(test)]
impl Made {
    /// By no command, for tests.
    pub(crate) fn by(command: &str) -> Self {
        Self { command: command.into(), makers: vec![], rows: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::Program;

    #[test]
    fn a_page_names_every_program_that_measured_its_rows() {
        let program = |revision: &str| Maker::Program(Program::stub(revision, "a CPU"));
        let made = |makers| Made { command: "edof study".into(), makers, rows: None }.to_string();
        assert_eq!(made(vec![]), "Made by `edof study`.");
        let one = made(vec![program("r")]);
        assert_eq!(one, "Made by `edof study` (revision `r`, rustc, on a CPU, 2 threads; ).");
        let old = Maker::Old { exact: false, machine: "a CPU, 2 threads".into() };
        let both = [program("r"), program("s"), old];
        assert!(made(both.to_vec()).starts_with("Made by `edof study` (rows of 3 programs: revision `r`, "));
        assert!(made(both.to_vec()).ends_with(&format!("; {OLD}).")));
        assert_eq!(machines(&both), "a CPU, 2 threads");
        let rows = |git: Option<&str>| RowsFile { rows: 2, sha256: "ab".into(), git: git.map(str::to_owned) };
        let of_rows = |git| Made { rows: Some(rows(git)), ..Made::by("edof") }.to_string();
        assert_eq!(of_rows(None), "Made by `edof`. The file of its 2 rows has SHA-256 `ab`.");
        assert!(of_rows(Some("r:x.jsonl")).ends_with("`ab`; `git show r:x.jsonl` prints it."));
        // A report names those that did not make it.
        let remarks =
            "  # rows of revision s, a CPU, 2 threads  # rows of an unknown revision, a CPU, 2 threads";
        assert_eq!(Made::remarks(&both, &program("r")), remarks);
    }
}
