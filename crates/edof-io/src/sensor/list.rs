//! A list of defects that a person wrote: a line `ROW,COLUMN` per pixel, `*,COLUMN` per column, `ROW,*` per row, counted from 0; `#` begins a
//! remark.

use super::correction::Defects;
use edof_core::storage::json;
use std::path::{Path, PathBuf};

/// Most bytes of a list.
const MAX_BYTES: u64 = 1 << 26;

/// A list that cannot be used.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum ListError {
    /// Cannot be read.
    #[error("{path}: cannot read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    /// No line.
    #[error("{path}: names no defect, expected lines ROW,COLUMN counted from 0", path = path.display())]
    Empty { path: PathBuf },
    /// A line of another form.
    #[error(
        "{path}: line {line}: '{text}', expected ROW,COLUMN counted from 0, with * for a whole row or column, as in 17,250 or *,250",
        path = path.display()
    )]
    Line { path: PathBuf, line: usize, text: String },
}

/// Reads a list of defects.
///
/// # Errors
/// [`ListError`].
pub fn load(path: &Path) -> Result<Defects, ListError> {
    let text =
        json::text(path, MAX_BYTES).map_err(|source| ListError::Read { path: path.to_owned(), source })?;
    let mut defects = Defects::default();
    for (line, text) in (1..).zip(text.lines()) {
        let text = text.split('#').next().unwrap_or_default().trim();
        if !text.is_empty() && add(&mut defects, text).is_none() {
            return Err(ListError::Line { path: path.to_owned(), line, text: text.to_owned() });
        }
    }
    if defects == Defects::default() { Err(ListError::Empty { path: path.to_owned() }) } else { Ok(defects) }
}

/// Adds the defect of a line, if it is one.
fn add(defects: &mut Defects, line: &str) -> Option<()> {
    let (row, column) = line.split_once(',')?;
    match (row.trim(), column.trim()) {
        ("*", "*") => return None,
        ("*", column) => defects.columns.push(column.parse().ok()?),
        (row, "*") => defects.rows.push(row.parse().ok()?),
        (row, column) => defects.pixels.push([row.parse().ok()?, column.parse().ok()?]),
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_pixels_columns_and_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("list.txt");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            load(&path)
        };
        let found = read("# of the vendor\n17, 250\n\n*,9 # dead\n 4,*\n0,0\n").unwrap();
        assert_eq!(found, Defects { pixels: vec![[17, 250], [0, 0]], columns: vec![9], rows: vec![4] });
        assert!(read("# nothing\n").unwrap_err().to_string().contains("list.txt: names no defect"));
        for wrong in ["17", "17,", "-1,2", "*,*", "1,2,3", "1.5,2"] {
            let told = read(&format!("1,2\n{wrong}\n")).unwrap_err().to_string();
            assert!(told.contains(&format!("line 2: '{wrong}', expected ROW,COLUMN")), "{told}");
        }
    }
}
