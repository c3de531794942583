//! A report as one HTML file that needs nothing else: pictures, plots and a viewer for the pictures are inside it.

use crate::report::plot::Plot;
use base64::prelude::{BASE64_STANDARD, Engine};
use edof_core::storage::atomic::{self, WriteError};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::path::Path;

/// A report, built from top to bottom.
#[derive(Debug, Clone)]
pub struct Report {
    title: String,
    body: String,
    has_pictures: bool,
    has_tables: bool,
    /// Plots or tables, which may be wider than a phone.
    is_wide: bool,
}

/// A picture and what stands below it.
#[derive(Debug, Clone)]
pub struct Figure {
    /// First line below the picture.
    pub title: String,
    /// Second line: a number, a setting.
    pub note: String,
    /// PNG or JPEG bytes.
    pub picture: Vec<u8>,
}

/// How figures of one group are laid out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// As large as there is room for.
    Wide,
    /// Small ones, each pixel two to three times as large.
    Enlarged,
}

impl Report {
    /// An empty report.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        let (title, body) = (title.into(), String::new());
        Self { title, body, has_pictures: false, has_tables: false, is_wide: false }
    }

    /// A heading for what follows.
    pub fn heading(&mut self, text: &str) -> &mut Self {
        self.add(&html! { h2 { (tied(text)) } })
    }

    /// A heading within what follows a heading.
    pub fn subheading(&mut self, text: &str) -> &mut Self {
        self.add(&html! { h3 { (tied(text)) } })
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) -> &mut Self {
        self.add(&html! { p { (tied(text)) } })
    }

    /// The command that made it, which breaks between its options alone where there is room for them.
    pub fn made_by(&mut self, command: &str) -> &mut Self {
        let mut parts: Vec<String> = vec![];
        for word in command.split_whitespace() {
            match parts.last_mut() {
                Some(part) if !word.starts_with("--") && word != "#" => *part += &format!(" {word}"),
                _ => parts.push(word.to_owned()),
            }
        }
        self.add(&html! {
            p.made {
                "Made by "
                code { @for (place, part) in parts.iter().enumerate() { @if place > 0 { " " } span { (part) } } }
            }
        })
    }

    /// How the numbers were made: a section that is closed until a reader opens it.
    pub fn method(&mut self, text: &str) -> &mut Self {
        self.add(&html! { details { summary { "How this was measured" } p { (text) } } })
    }

    /// What matters most, in a box.
    pub fn verdict(&mut self, text: &str) -> &mut Self {
        self.add(&html! { p.verdict { (tied(text)) } })
    }

    /// Words and what they mean.
    pub fn terms(&mut self, terms: &[(String, String)]) -> &mut Self {
        self.add(&html! { dl { @for (term, text) in terms { dt { (term) } dd { (text) } } } })
    }

    /// Pictures side by side; where there is no room they wrap. Each opens in the viewer, which flips between those of one group and
    /// shows how they differ from the first.
    pub fn figures(&mut self, figures: &[Figure], layout: Layout) -> &mut Self {
        self.has_pictures = true;
        let class = match layout {
            Layout::Wide => "row",
            Layout::Enlarged => "row enlarged",
        };
        let data = |picture: &[u8]| {
            let kind = if picture.starts_with(&[0xff, 0xd8]) { "jpeg" } else { "png" };
            format!("data:image/{kind};base64,{}", BASE64_STANDARD.encode(picture))
        };
        self.add(&html! {
            div class=(class) {
                @for Figure { title, note, picture } in figures {
                    figure {
                        button.shown { img alt=(title) src=(data(picture)); }
                        figcaption { b { (title) } br; (note) }
                    }
                }
            }
        })
    }

    /// A table; columns of numbers stand right, and a click on the name of a column sorts by it. `best` holds row and column of cells that are set off.
    pub fn table(&mut self, header: &[&str], rows: &[Vec<String>], best: &[(usize, usize)]) -> &mut Self {
        (self.has_tables, self.is_wide) = (true, true);
        let numbers: Vec<bool> = (0..header.len()).map(|column| is_of_numbers(rows, column)).collect();
        let class = |row: usize, column: usize| match numbers.get(column) {
            Some(true) if best.contains(&(row, column)) => Some("n best"),
            Some(true) => Some("n"),
            _ => None,
        };
        self.add(&html! {
            div.wide {
                table {
                    thead {
                        tr {
                            @for (cell, is_number) in header.iter().zip(&numbers) {
                                // An equation is one word; many words have room where a table is scrolled.
                                th class=[head(cell, *is_number)] {
                                    @if !cell.is_empty() {
                                        button.sort { (words(cell, LONGEST_HEAD)) }
                                    }
                                }
                            }
                        }
                    }
                    tbody {
                        @for (r, row) in rows.iter().enumerate() {
                            tr {
                                @for (c, cell) in row.iter().enumerate() {
                                    @if numbers.get(c) == Some(&true) {
                                        td class=[class(r, c)] { (cell) }
                                    } @else {
                                        td class=[(cell.chars().count() > LONG).then_some("t")] { (words(cell, LONGEST_NAME)) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        })
    }

    /// Plots side by side, or below each other where there is no room; none is shown so small that its text cannot be read. A legend stands
    /// below its plot as text, so that it is seen whole where the plot is not.
    pub fn plots(&mut self, plots: &[Plot]) -> &mut Self {
        self.is_wide = true;
        let style = |plot: &Plot| {
            let [min, max] = [READABLE, LARGE].map(|share| share * plot.size[0]);
            format!("--least:{min:.0}px;--most:{max:.0}px")
        };
        self.add(&html! {
            div.plots {
                @for plot in plots {
                    div.diagram style=(style(plot)) {
                        div.plot { (PreEscaped(plot.to_svg_for_page())) }
                        (legend(plot))
                    }
                }
            }
        })
    }

    /// The whole document.
    #[must_use]
    pub fn to_html(&self) -> String {
        let parts = [(self.has_pictures, VIEWER), (self.has_tables, SORTER), (self.is_wide, CUT)];
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    title { (self.title) }
                    link rel="icon" href="data:,";
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (self.title) }
                    (PreEscaped(&self.body))
                    @for (_, part) in parts.iter().filter(|(is_needed, _)| *is_needed) { (PreEscaped(part)) }
                }
            }
        };
        page.into_string() + "\n"
    }

    /// Writes the document.
    ///
    /// # Errors
    /// [`WriteError`]; whatever stood there before is then untouched.
    pub fn save(&self, path: &Path) -> Result<(), WriteError> {
        atomic::write(path, self.to_html().as_bytes())
    }

    fn add(&mut self, markup: &Markup) -> &mut Self {
        self.body.push_str(&markup.0);
        self.body.push('\n');
        self
    }
}

/// What the lines and dots of a plot stand for.
fn legend(plot: &Plot) -> Markup {
    let entries: Vec<(String, &str)> = plot.legend();
    html! {
        @if !entries.is_empty() {
            ul.legend { @for (mark, label) in entries { li { (PreEscaped(mark)) (label) } } }
        }
    }
}

/// Letters of the longest name that stays on one line in a cell, and in a column's name.
const LONGEST_NAME: usize = 24;
const LONGEST_HEAD: usize = 10;
/// A cell of more letters than this is a sentence, a column's name of more would be a tower of words.
const LONG: usize = 40;
const LONG_HEAD: usize = 14;

/// The class of a column's name.
fn head(name: &str, is_number: bool) -> Option<&'static str> {
    match (is_number, name.chars().count() > LONG_HEAD) {
        (true, true) => Some("n l"),
        (true, false) => Some("n"),
        (false, true) => Some("l"),
        (false, false) => None,
    }
}

/// A text whose equations, errors and units stay with their numbers.
fn tied(text: &str) -> String {
    let tied = [(" = ", "\u{a0}=\u{a0}"), (" ± ", "\u{a0}±\u{a0}"), (" dB", "\u{a0}dB")];
    tied.iter().fold(text.to_owned(), |text, (loose, tied)| text.replace(loose, tied))
}

/// A cell's text, which breaks between its words: not within a name of ours such as `edof-t4w12.fixed`, nor before a unit.
fn words(cell: &str, longest: usize) -> Markup {
    let joined = tied(cell);
    let breaks = |word: &str| {
        word.contains(['-', '/', '\u{a0}', '.']) && (4..=longest).contains(&word.chars().count())
    };
    html! {
        @for (place, word) in joined.split(' ').enumerate() {
            @if place > 0 { " " }
            @if breaks(word) { span.word { (word) } } @else { (word) }
        }
    }
}

/// The share of its size below which a plot's text is too small to be read.
const READABLE: f64 = 0.9;
/// The share above which it shouts.
const LARGE: f64 = 1.4;

const STYLE: &str = include_str!("html/style.css");
const VIEWER: &str = include_str!("html/viewer.html");
const SORTER: &str = include_str!("html/sorter.html");
const CUT: &str = include_str!("html/cut.html");

/// Whether a column holds numbers, and dashes where there are none.
fn is_of_numbers(rows: &[Vec<String>], column: usize) -> bool {
    // Several in one cell stand as in "31.2 / 30.1", "+1.15 ± 0.17" or "0.02 (0.31)".
    let is_number = |cell: &str| {
        let cell = cell.replace('−', "-").replace(" ± ", " / ");
        let cell = match cell.strip_suffix(')').and_then(|cell| cell.split_once(" (")) {
            Some((first, second)) => format!("{first} / {second}"),
            None => cell,
        };
        cell.split(" / ").all(|word| word.parse::<f64>().is_ok())
    };
    let mut cells = rows.iter().filter_map(|row| row.get(column)).filter(|cell| *cell != "–").peekable();
    cells.peek().is_some() && cells.all(|cell| is_number(cell))
}
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_holds_its_parts_in_order_and_escapes_text() {
        let mut report = Report::new("R & D");
        report
            .heading("First")
            .paragraph("a < b")
            .table(
                &["net", "dB"],
                &[vec!["x".into(), "31.2".into()], vec!["y".into(), "31.3".into()]],
                &[(1, 1)],
            )
            .terms(&[("ψ".into(), "defocus".into())])
            .figures(
                &[Figure { title: "truth".into(), note: "n".into(), picture: vec![1, 2, 3] }],
                Layout::Wide,
            );
        let html = report.to_html();
        let parts = [
            "R &amp; D",
            "First",
            "a &lt; b",
            "<td class=\"n\">31.2</td>",
            "<td class=\"n best\">31.3</td>",
            "<dt>ψ</dt>",
        ];
        let places = parts.into_iter().chain(["base64,AQID", "id=\"viewer\""]).map(|s| html.find(s).unwrap());
        assert!(places.is_sorted());
        assert_eq!(html.matches("base64,AQID").count(), 1, "a picture is embedded once");
    }

    #[test]
    fn a_command_breaks_between_its_options() {
        let html = Report::new("t").made_by("edof study x --psi 4,8 --exact  # edof 1, 2026").to_html();
        let parts = "<code><span>edof study x</span> <span>--psi 4,8</span> <span>--exact</span> <span># edof 1, 2026</span></code>";
        assert!(html.contains(parts), "{html}");
    }

    #[test]
    fn columns_of_numbers_stand_right_and_others_left() {
        let row = |cells: [&str; 4]| cells.map(str::to_owned).to_vec();
        let rows = [row(["a", "1.5", "–", "3 times"]), row(["2", "−2 / 1", "7", "4"])];
        let html = Report::new("t").table(&["a", "b", "c", "d"], &rows, &[]).to_html();
        assert!(html.contains("<td class=\"n\">–</td><td>3 times</td>"), "{html}");
        assert!(
            html.contains("<td>2</td><td class=\"n\">−2 / 1</td><td class=\"n\">7</td><td>4</td>"),
            "{html}"
        );
    }

    #[test]
    fn cells_break_between_words_alone() {
        let row = vec!["edof-t4w12.fixed/s8 is faster".into(), "a-very-long-name-of-somebody-elses".into()];
        let html = Report::new("t").table(&["what", ""], &[row], &[]).to_html();
        assert!(
            html.contains("<td><span class=\"word\">edof-t4w12.fixed/s8</span> is faster</td>"),
            "{html}"
        );
        assert!(html.contains("<td>a-very-long-name-of-somebody-elses</td>"), "{html}");
        assert!(html.contains("<th></th>"), "a column without a name has nothing to click: {html}");
        let gain = Report::new("t").table(&["here"], &[vec!["+1.15 ± 0.17 dB".into()]], &[]).to_html();
        assert!(gain.contains("+1.15\u{a0}±\u{a0}0.17\u{a0}dB</span>"), "{gain}");
    }

    #[test]
    fn a_report_without_pictures_has_no_viewer_and_asks_for_nothing_elsewhere() {
        let html = Report::new("plain").paragraph("text").to_html();
        assert!(!html.contains("<script"));
        for part in [html.as_str(), VIEWER, SORTER, STYLE] {
            assert!(!part.contains("http"), "a report needs nothing else");
        }
    }
}
