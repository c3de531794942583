//! Rows as comma-separated values (RFC 4180), for spreadsheets and other people's plots.

use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// One line for each row, below one of names. What lies inside of another is named by both, as in `light.psnr_db`; lists stand in one
/// cell, their items parted by blanks; a field that a row has not is empty.
///
/// ```
/// #[derive(serde::Serialize)]
/// struct Row { method: &'static str, layers: Vec<f64>, ssim: Option<f64> }
/// let rows = [
///     Row { method: "omp", layers: vec![1.5, 2.0], ssim: None },
///     Row { method: "a, b", layers: vec![], ssim: Some(0.9) },
/// ];
/// assert_eq!(edof_study::report::csv::of(&rows), "method,layers,ssim\nomp,1.5 2,\n\"a, b\",,0.9\n");
/// ```
#[must_use]
pub fn of(rows: &[impl Serialize]) -> String {
    let mut header: Vec<String> = vec![];
    let mut lines: Vec<Vec<(usize, String)>> = vec![];
    for row in rows {
        let mut cells = vec![];
        tree(row).flatten(String::new(), &mut cells);
        let placed = cells.into_iter().map(|(name, cell)| {
            let place = header.iter().position(|known| *known == name).unwrap_or_else(|| {
                header.push(name);
                header.len() - 1
            });
            (place, cell)
        });
        lines.push(placed.collect());
    }
    if header.is_empty() {
        return String::new();
    }
    let mut table = csv::Writer::from_writer(vec![]);
    let mut add = |cells: &[String]| {
        table.write_record(cells).unwrap_or_else(|e| unreachable!("memory takes every row: {e}"));
    };
    add(&header);
    for cells in lines {
        let mut all = vec![String::new(); header.len()];
        cells.into_iter().for_each(|(place, cell)| all[place] = cell);
        add(&all);
    }
    let bytes = table.into_inner().unwrap_or_else(|e| unreachable!("memory takes every row: {e}"));
    String::from_utf8(bytes).unwrap_or_else(|e| unreachable!("cells are text: {e}"))
}

/// A value of JSON whose fields keep their order.
enum Tree {
    Nothing,
    Word(String),
    List(Vec<Tree>),
    Fields(Vec<(String, Tree)>),
}

fn tree(value: &impl Serialize) -> Tree {
    let text = serde_json::to_string(value).unwrap_or_else(|e| unreachable!("rows are plain data: {e}"));
    serde_json::from_str(&text).unwrap_or_else(|e| unreachable!("what was JSON is JSON: {e}"))
}

impl Tree {
    /// Names and cells of a value.
    fn flatten(self, name: String, cells: &mut Vec<(String, String)>) {
        match self {
            Self::Fields(fields) => {
                for (field, value) in fields {
                    value.flatten(if name.is_empty() { field } else { format!("{name}.{field}") }, cells);
                }
            }
            Self::List(items) => cells.push((name, words(items, " "))),
            other => cells.push((name, other.word())),
        }
    }

    /// A value in one word; a list inside of a list is parted by colons.
    fn word(self) -> String {
        match self {
            Self::Nothing => String::new(),
            Self::Word(word) => word,
            Self::List(items) => words(items, ":"),
            Self::Fields(fields) => words(fields.into_iter().map(|(_, value)| value).collect(), ":"),
        }
    }
}

fn words(items: Vec<Tree>, between: &str) -> String {
    items.into_iter().map(Tree::word).collect::<Vec<_>>().join(between)
}

impl<'de> Deserialize<'de> for Tree {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader)
    }
}

struct Reader;

impl<'de> Visitor<'de> for Reader {
    type Value = Tree;

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a value of JSON")
    }

    fn visit_unit<E>(self) -> Result<Tree, E> {
        Ok(Tree::Nothing)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Tree, E> {
        Ok(Tree::Word(value.to_string()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Tree, E> {
        Ok(Tree::Word(value.to_string()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Tree, E> {
        Ok(Tree::Word(value.to_string()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Tree, E> {
        Ok(Tree::Word(value.to_string()))
    }

    fn visit_str<E>(self, value: &str) -> Result<Tree, E> {
        Ok(Tree::Word(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Tree, A::Error> {
        let mut all = vec![];
        while let Some(item) = items.next_element()? {
            all.push(item);
        }
        Ok(Tree::List(all))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Tree, A::Error> {
        let mut all = vec![];
        while let Some(field) = fields.next_entry()? {
            all.push(field);
        }
        Ok(Tree::Fields(all))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct Row {
        text: &'static str,
        light: Light,
        psi_db: Vec<[f64; 2]>,
        missing: Option<u32>,
    }

    #[derive(Serialize)]
    struct Light {
        db: f64,
        lines: &'static str,
    }

    #[test]
    fn quotes_commas_and_line_ends_stay_inside_of_their_cells() {
        let light = Light { db: -30.25, lines: "1\n2" };
        let rows = [Row { text: "say \"b\"", light, psi_db: vec![[0.0, 31.5], [8.0, 29.0]], missing: None }];
        let expected =
            "text,light.db,light.lines,psi_db,missing\n\"say \"\"b\"\"\",-30.25,\"1\n2\",0:31.5 8:29,\n";
        assert_eq!(of(&rows), expected);
    }

    #[test]
    fn no_rows_are_no_text() {
        assert_eq!(of(&Vec::<Row>::new()), "");
    }
}
