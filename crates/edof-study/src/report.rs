//! A report as one HTML file that needs nothing else: pictures and plots are inside it.

use crate::plot::escape;
use base64::prelude::{BASE64_STANDARD, Engine};
use edof_spec::atomic::{self, WriteError};
use std::fmt::Write;
use std::path::Path;

/// A report, built from top to bottom.
#[derive(Debug, Clone)]
pub struct Report {
    title: String,
    body: String,
}

/// A picture and what stands below it.
#[derive(Debug, Clone)]
pub struct Figure {
    /// First line below the picture.
    pub title: String,
    /// Second line: a number, a setting.
    pub note: String,
    /// PNG bytes.
    pub png: Vec<u8>,
}

impl Report {
    /// An empty report.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), body: String::new() }
    }

    /// A heading for what follows.
    pub fn heading(&mut self, text: &str) -> &mut Self {
        self.add(&format!("<h2>{}</h2>", escape(text)))
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) -> &mut Self {
        self.add(&format!("<p>{}</p>", escape(text)))
    }

    /// Pictures side by side; where there is no room they wrap.
    pub fn figures(&mut self, figures: &[Figure]) -> &mut Self {
        let mut row = String::from("<div class=\"row\">");
        for figure in figures {
            let _ = write!(
                row,
                "<figure><a href=\"data:image/png;base64,{0}\"><img alt=\"{1}\" src=\"data:image/png;base64,{0}\"></a>\
                 <figcaption><b>{1}</b><br>{2}</figcaption></figure>",
                BASE64_STANDARD.encode(&figure.png),
                escape(&figure.title),
                escape(&figure.note)
            );
        }
        self.add(&(row + "</div>"))
    }

    /// A table; cells that are numbers stand right.
    pub fn table(&mut self, header: &[&str], rows: &[Vec<String>]) -> &mut Self {
        let mut table = String::from("<table><thead><tr>");
        for cell in header {
            let _ = write!(table, "<th>{}</th>", escape(cell));
        }
        table.push_str("</tr></thead><tbody>");
        for row in rows {
            table.push_str("<tr>");
            for cell in row {
                let number = cell.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '−');
                let class = if number { " class=\"n\"" } else { "" };
                let _ = write!(table, "<td{class}>{}</td>", escape(cell));
            }
            table.push_str("</tr>\n");
        }
        self.add(&(table + "</tbody></table>"))
    }

    /// A plot, as [`crate::plot::Plot::to_svg`] gives it.
    pub fn plot(&mut self, svg: &str) -> &mut Self {
        self.add(&format!("<div class=\"plot\">{svg}</div>"))
    }

    /// The whole document.
    #[must_use]
    pub fn to_html(&self) -> String {
        let title = escape(&self.title);
        format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>{STYLE}</style></head>\n<body><h1>{title}</h1>\n{}</body></html>\n",
            self.body
        )
    }

    /// Writes the document.
    ///
    /// # Errors
    /// [`WriteError`]; whatever stood there before is then untouched.
    pub fn save(&self, path: &Path) -> Result<(), WriteError> {
        atomic::write(path, self.to_html().as_bytes())
    }

    fn add(&mut self, html: &str) -> &mut Self {
        self.body.push_str(html);
        self.body.push('\n');
        self
    }
}

const STYLE: &str = "\
body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#fafafa;max-width:90rem;margin:2rem auto;padding:0 1.5rem}\
h1{font-weight:600;margin-bottom:.3em}h2{font-weight:600;margin:1.6em 0 .4em;border-bottom:1px solid #ddd}\
p{max-width:50rem}.row{display:flex;flex-wrap:wrap;gap:1rem}figure{margin:0;flex:1 1 22rem;max-width:44rem}\
figure img{width:100%;border:1px solid #ccc;display:block}figcaption{font-size:.9rem;padding:.3rem 0;color:#444}\
table{border-collapse:collapse;font-variant-numeric:tabular-nums}th,td{padding:.25rem .8rem;text-align:left}\
thead{border-bottom:2px solid #444}tbody tr:nth-child(even){background:#f0f0f0}td.n{text-align:right}\
.plot svg{max-width:100%;height:auto}";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_holds_its_parts_in_order_and_escapes_text() {
        let mut report = Report::new("R & D");
        report
            .heading("First")
            .paragraph("a < b")
            .table(&["net", "dB"], &[vec!["x".into(), "31.2".into()]])
            .figures(&[Figure { title: "truth".into(), note: "n".into(), png: vec![1, 2, 3] }]);
        let html = report.to_html();
        let places = ["R &amp; D", "First", "a &lt; b", "<td class=\"n\">31.2</td>", "base64,AQID"]
            .map(|s| html.find(s).unwrap());
        assert!(places.is_sorted(), "{places:?}");
    }
}
