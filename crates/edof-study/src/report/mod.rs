//! Numbers and pictures for readers: plots, tables, CSV and HTML pages. Nothing here knows what was measured.
//!
//! | what | module |
//! |---|---|
//! | one HTML file with everything inside | [`html`] |
//! | line and scatter plots as SVG | [`plot`] |
//! | cells under a header, for a terminal, as Markdown and in a page | [`table`] |
//! | rows for spreadsheets | [`csv`] |
//! | frames as PNG or JPEG bytes, sheets, kernels, captions | [`picture`] |
//!
//! ```
//! use edof_study::report::{Report, Table};
//! let cells = |row: [&str; 2]| row.map(str::to_owned).to_vec();
//! let table = Table { header: cells(["net", "dB"]), rows: vec![cells(["a", "31.2"])] };
//! let mut report = Report::new("One network");
//! table.add_to(&mut report, &[]);
//! assert!(report.to_html().contains("31.2"));
//! assert_eq!(table.to_text(), "net  dB\na    31.2\n");
//! ```

pub mod csv;
pub mod html;
pub(crate) mod letters;
pub mod picture;
pub mod plot;
pub mod table;

pub use html::{Figure, Layout, Report};
pub use table::Table;
