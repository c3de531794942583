//! The suite as a page of cards, as Markdown and as lines for a terminal.

use crate::made::Made;
use crate::report::table::{markdown_row, markdown_rule};
use crate::report::{Figure, Layout, Report};
use crate::stability::case::{Promise, Trial};
use crate::stability::outcome::{Measurement, Outcome};
use crate::stability::suite::Suite;
use std::fmt::Write;

/// Kinds of cases in the order in which tables tell them, and what each is about.
const KINDS: [(&str, &str); 13] = [
    ("frames", "Raw frames, every method"),
    ("phase", "Frames read with another phase"),
    ("sizes", "Sizes of frames"),
    ("bounds", "Fixed point and f32 against f64, bounds told before"),
    ("words", "Sums and saturations of integers"),
    ("pursuits", "Pursuits"),
    ("learning", "Learned dictionaries"),
    ("solves", "Systems of equations"),
    ("fitting", "More noise than was trained for"),
    ("lenses", "Point spread functions and blur"),
    ("deblurring", "Deconvolution"),
    ("numbers", "Sums, tables, steps"),
    ("refusals", "What is refused"),
];

const fn kind(trial: &Trial) -> &'static str {
    match trial {
        Trial::Frame(_) => KINDS[0].0,
        Trial::Phase { .. } => KINDS[1].0,
        Trial::Size { .. } | Trial::Megapixels(_) => KINDS[2].0,
        Trial::Bounds { .. } => KINDS[3].0,
        Trial::Words(_) => KINDS[4].0,
        Trial::Pursuit { .. } => KINDS[5].0,
        Trial::Learning { .. } => KINDS[6].0,
        Trial::Solve(_) => KINDS[7].0,
        Trial::Fitted { .. } => KINDS[8].0,
        Trial::Lens(_) => KINDS[9].0,
        Trial::Deblur { .. } => KINDS[10].0,
        Trial::Numbers(_) => KINDS[11].0,
        Trial::Refusal(_) => KINDS[12].0,
    }
}

/// Losses that the page's head names.
const MAX_TOLD: usize = 3;
/// The share of its limit from which on a case is among them.
const MIN_TOLD: f64 = 0.05;

impl Suite {
    /// What matters, in a sentence.
    #[must_use]
    pub fn verdict(&self) -> String {
        let (all, seconds) = (self.cases.len(), self.seconds);
        match self.broken().as_slice() {
            [] => format!("All {all} promises hold ({seconds:.0} s)."),
            broken => format!("{} of {all} promises are broken: {}.", broken.len(), broken.join(", ")),
        }
    }

    /// What came nearest to its limit, and what a network may lose at worst: what somebody who uses one wants to know.
    fn matters(&self) -> String {
        let degrades = |outcome: &&Outcome| matches!(outcome.case.promise, Promise::Graceful { .. });
        let losses: Vec<String> = self
            .cases
            .iter()
            .filter(degrades)
            .filter_map(|outcome| Some((outcome.worst()?, outcome)))
            .filter(|(_, outcome)| outcome.share() >= MIN_TOLD)
            .take(MAX_TOLD)
            .map(|(worst, outcome)| {
                format!("{} ({})", outcome.case.intent.trim_end_matches('.'), worst.words())
            })
            .collect();
        let refused = self.cases.iter().filter(|o| matches!(o.case.promise, Promise::Refused { .. })).count();
        let same = self.cases.len() - refused - self.cases.iter().filter(degrades).count();
        let losses = match losses[..] {
            [] => String::new(),
            _ => format!(
                " Of the cases that may lose quality these use most of their limits: {}.",
                losses.join("; ")
            ),
        };
        format!(
            "{same} cases give the result of a reference within a stated error; {refused} are rejected with a message.{losses}"
        )
    }

    /// For a terminal: a line a case, those nearest to their limits first.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for outcome in &self.cases {
            let verdict = if outcome.held { "held" } else { "BROKEN" };
            let _ = writeln!(
                text,
                "{verdict:6}  {:>6}  {:36}  {}",
                used(outcome),
                outcome.case.id,
                told(outcome)
            );
        }
        text + &self.verdict()
    }

    /// A table for each kind of case.
    #[must_use]
    pub fn to_markdown(&self, made: &Made) -> String {
        let mut text = format!("# Hard cases\n\n{made}\n\n{}\n", self.verdict());
        for (name, title) in KINDS {
            let own: Vec<&Outcome> = self.cases.iter().filter(|o| kind(&o.case.trial) == name).collect();
            if own.is_empty() {
                continue;
            }
            let _ = write!(
                text,
                "\n## {title}\n\n| case | intent | promised | worst seen | of its limit | saturations |\n|---|---|---|---|---|---|\n"
            );
            for outcome in own {
                let Outcome { case, saturations, .. } = outcome;
                let cells = [
                    format!("`{}`", case.id),
                    case.intent.clone(),
                    case.promise.words(),
                    told(outcome),
                    used(outcome),
                    saturations.to_string(),
                ];
                text.push_str(&markdown_row(&cells));
            }
        }
        let bounds = self.bounds();
        if !bounds.is_empty() {
            let _ = write!(
                text,
                "\n## Every stage\n\nIn last bits of the stage's result. The ratio is that of the result which came nearest to its own bound.\n\n{}{}",
                markdown_row(&STAGE_HEADER),
                markdown_rule(STAGE_HEADER.len())
            );
            bounds.iter().for_each(|row| text.push_str(&markdown_row(row)));
        }
        text
    }

    /// The page.
    #[must_use]
    pub fn report(&self, command: &str) -> Report {
        let mut report = Report::new("Hard cases");
        report.verdict(&self.verdict()).verdict(&self.matters()).made_by(command).paragraph(
            "Broken promises come first, then cases in which quality may be lost, then all others; among these, those that use most of their \
             limits. Every case says what could go wrong, what is promised, why the limit is \
             what it is, and the worst that was seen of every method, solver or network.",
        );
        let bounds = self.bounds();
        if !bounds.is_empty() {
            report.heading("Bounds of error, stage by stage").paragraph(
                "What no window exceeds, told before any was seen, and the worst found on random windows and on windows that climb \
                 towards the bound; in last bits of the stage's result. The ratio is that of the result which came nearest to its own \
                 bound; the furthest is of any result.",
            );
            report.table(&STAGE_HEADER, &bounds, &[]);
        }
        let mut cases: Vec<&Outcome> = self.cases.iter().collect();
        // Stable: those nearest to their limits stay first in each group.
        cases.sort_by_key(|outcome| match outcome.case.promise {
            _ if !outcome.held => 0,
            Promise::Graceful { .. } => 1,
            _ => 2,
        });
        for outcome in cases {
            card(&mut report, outcome);
        }
        report
    }

    /// A row for every stage of every network, as [`STAGE_HEADER`] has it.
    fn bounds(&self) -> Vec<Vec<String>> {
        let own = self.cases.iter().filter(|outcome| matches!(outcome.case.trial, Trial::Bounds { .. }));
        let mut own: Vec<&Outcome> = own.collect();
        own.sort_by(|a, b| a.case.id.cmp(&b.case.id));
        own.into_iter().flat_map(|outcome| &outcome.seen).filter_map(stage_row).collect()
    }
}

const STAGE_HEADER: [&str; 10] = [
    "network",
    "against",
    "stage",
    "bound",
    "seen",
    "ratio",
    "largest bound",
    "furthest",
    "statistical",
    "violations",
];

fn stage_row(seen: &Measurement) -> Option<Vec<String>> {
    let stage = seen.stage.as_ref()?;
    let bits = |value: f64| format!("{value:.2}");
    Some(vec![
        seen.subject.clone(),
        stage.against.to_owned(),
        stage.stage.clone(),
        bits(stage.bound),
        bits(stage.seen),
        format!("{:.4}", seen.worst),
        bits(stage.largest_bound),
        bits(stage.furthest),
        stage.statistical.map_or_else(|| "–".to_owned(), bits),
        format!("{} in {} windows", stage.violations, stage.windows),
    ])
}

fn used(outcome: &Outcome) -> String {
    match outcome.share() {
        share if share.is_finite() => format!("{:.0} %", 100.0 * share),
        _ => "beyond".to_owned(),
    }
}

fn told(outcome: &Outcome) -> String {
    let worst = || outcome.worst().map(Measurement::words).unwrap_or_default();
    outcome.broken().unwrap_or_else(worst)
}

fn card(report: &mut Report, outcome: &Outcome) {
    let Outcome { case, seen, .. } = outcome;
    let verdict = if outcome.held { "held" } else { "BROKEN" };
    report.heading(&case.intent).paragraph(&format!(
        "{}: {verdict}, {} of its limit",
        case.id,
        used(outcome)
    ));
    let mut terms = vec![
        ("Danger".to_owned(), case.danger.clone()),
        ("Promised".to_owned(), format!("{}; {}", case.promise.words(), case.promise.because())),
        ("Worst seen".to_owned(), told(outcome)),
    ];
    if outcome.saturations > 0 {
        terms.push(("Saturations counted".to_owned(), outcome.saturations.to_string()));
    }
    report.terms(&terms);
    if let Some(picture) = &outcome.picture {
        let title = case.id.clone();
        report
            .figures(&[Figure { title, note: case.intent.clone(), picture: picture.clone() }], Layout::Wide);
    }
    // Facts that hold say no more than their number.
    let measured: Vec<&Measurement> = seen.iter().filter(|seen| !seen.held || seen.limit > 0.0).collect();
    let facts = seen.len() - measured.len();
    let row = |seen: &&Measurement| {
        let number = crate::stability::case::short;
        vec![
            seen.subject.clone(),
            seen.what.clone(),
            number(seen.worst),
            number(seen.limit),
            seen.note.clone(),
        ]
    };
    let rows: Vec<Vec<String>> = measured.iter().map(row).collect();
    if !rows.is_empty() {
        report.table(&["what", "measured", "worst", "limit", "remark"], &rows, &[]);
    }
    match facts {
        0 => {}
        1 => _ = report.paragraph("One yes-or-no check holds, too."),
        several => _ = report.paragraph(&format!("{several} yes-or-no checks hold, too.")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::bench::Bench;
    use crate::stability::case;
    use std::ops::ControlFlow;

    #[test]
    fn cards_come_nearest_to_their_limits_first_and_say_what_was_promised() {
        let ids = ["gamma-index", "solve-twin-inputs", "bounds-drawn-8-8", "deblur-flat-black"];
        let cases: Vec<_> =
            case::own().unwrap().into_iter().filter(|case| ids.contains(&case.id.as_str())).collect();
        let suite = Suite::run(&Bench::new(vec![], 200), &cases, |_, _| ControlFlow::Continue(())).unwrap();
        let page = suite.report("edof study stability").to_html();
        let place =
            |id: &str| page.find(&format!("<p>{id}: held")).unwrap_or_else(|| panic!("{id} in {page}"));
        assert!(place("bounds-drawn-8-8") < place("deblur-flat-black"));
        assert!(place("deblur-flat-black") < place("gamma-index"));
        // A picture where there is one, and a row for each stage in words and in f32.
        assert_eq!(page.matches("<figure>").count(), 1);
        assert_eq!(page.matches("<td>words without rounding</td>").count(), 4);
        assert!(page.contains("<dt>Promised</dt><dd>same, to a bound told before; formats and weights"));
        let table =
            suite.to_markdown(&Made { command: "edof study stability".into(), makers: vec![], rows: None });
        assert!(table.contains("## Deconvolution") && !table.contains("## What is refused"), "{table}");
        assert!(table.contains("| drawn-8-8.f32 | f64 | M1 |"), "{table}");
    }
}
