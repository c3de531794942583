//! Cells under a header, for a terminal, as Markdown and in a page.

use crate::html::Report;

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

    /// A Markdown table.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let line = |row: &Vec<String>| format!("| {} |\n", row.join(" | "));
        let rule = format!("|{}\n", "---|".repeat(self.header.len()));
        line(&self.header) + &rule + &self.rows.iter().map(line).collect::<String>()
    }

    /// Adds the table to a report; `best` holds row and column of cells to set off.
    pub fn add_to(&self, report: &mut Report, best: &[(usize, usize)]) {
        report.table(&self.header.iter().map(String::as_str).collect::<Vec<_>>(), &self.rows, best);
    }
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
}
