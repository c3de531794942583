//! Cells under a header, for a terminal, as Markdown and in a page.

use crate::report::html::Report;

/// Cells under a header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    /// One for each column.
    pub header: Vec<String>,
    /// As many cells each as the header has.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Columns as wide as their widest cell.
    #[must_use]
    pub fn to_text(&self) -> String {
        let width = |column: usize| {
            let cells = self.rows.iter().chain([&self.header]).filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.header.len()).map(width).collect();
        let line = |row: &Vec<String>| {
            let cells: Vec<String> =
                row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:width$}")).collect();
            cells.join("  ").trim_end().to_owned() + "\n"
        };
        std::iter::once(&self.header).chain(&self.rows).map(line).collect()
    }

    /// Returns a Markdown table. Characters that would end a cell (`|`, line breaks) are escaped.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let line = |row: &Vec<String>| markdown_row(row);
        let rule = markdown_rule(self.header.len());
        line(&self.header) + &rule + &self.rows.iter().map(line).collect::<String>()
    }

    /// Adds the table to a report; `best` holds row and column of cells to set off.
    pub fn add_to(&self, report: &mut Report, best: &[(usize, usize)]) {
        report.table(&self.header.iter().map(String::as_str).collect::<Vec<_>>(), &self.rows, best);
    }
}

/// Returns one line of a Markdown table, with the cells escaped: `|` as `\\|`, a line break as `<br>`.
#[must_use]
pub fn markdown_row<T: AsRef<str>>(cells: &[T]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| markdown_cell(cell.as_ref())).collect();
    format!("| {} |\n", cells.join(" | "))
}

/// Returns the line below the header of a Markdown table.
#[must_use]
pub fn markdown_rule(columns: usize) -> String {
    format!("|{}\n", "---|".repeat(columns))
}

/// Backslashes in front of a bar are doubled, so that they do not undo its escape.
fn markdown_cell(text: &str) -> String {
    let text = text.replace("\r\n", "\n").replace(['\n', '\r'], "<br>");
    let parts: Vec<&str> = text.split('|').collect();
    let (last, before) = parts.split_last().unwrap_or((&"", &[]));
    let escaped = before.iter().map(|part| {
        let backslashes = part.len() - part.trim_end_matches('\\').len();
        format!("{part}{}\\|", "\\".repeat(backslashes))
    });
    escaped.collect::<String>() + last
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_text_stand_below_each_other() {
        let cells = |row: &[&str]| row.iter().map(|&c| c.to_owned()).collect::<Vec<_>>();
        let table =
            Table { header: cells(&["a", "b"]), rows: vec![cells(&["ψψψ", "1"]), cells(&["x", "2"])] };
        assert_eq!(table.to_text(), "a    b\nψψψ  1\nx    2\n");
    }

    /// Cells of a line of GitHub Flavored Markdown (specification 0.29, section 4.10): parted by bars without a backslash before them.
    fn cells_of(line: &str) -> Vec<String> {
        let mut cells = vec![String::new()];
        let mut chars = line.chars().peekable();
        while let Some(c) = chars.next() {
            match (c, chars.peek()) {
                ('\\', Some('|' | '\\')) => cells.last_mut().unwrap().extend(chars.next()),
                ('|', _) => cells.push(String::new()),
                _ => cells.last_mut().unwrap().push(c),
            }
        }
        let count = cells.len();
        cells[1..count - 1].iter().map(|cell| cell.trim().to_owned()).collect()
    }

    #[test]
    fn a_cell_of_markdown_stays_one_cell_whatever_it_contains() {
        let rows = [["a|b", "|"], ["two\nlines", "three\r\n|\nlines"], ["", "\\|"]];
        let owned = |row: &[&str; 2]| row.map(str::to_owned).to_vec();
        let table = Table { header: owned(&["x|y", "z"]), rows: rows.iter().map(owned).collect() };
        let text = table.to_markdown();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 5, "{text}");
        assert_eq!(cells_of(lines[0]), ["x|y", "z"]);
        assert_eq!(cells_of(lines[2]), ["a|b", "|"]);
        assert_eq!(cells_of(lines[3]), ["two<br>lines", "three<br>|<br>lines"]);
        assert_eq!(cells_of(lines[4]), ["", "\\|"]);
    }
}
