//! A network's form in words, as `--form` takes it: `one-sided,w12,t4,r`.

use crate::network::{Form, Recurrence, Shrinkage};
use edof_core::Window;

/// Returns the keywords of `--form`, for its help.
#[must_use]
pub fn help() -> String {
    let shrinkages: Vec<&str> = Shrinkage::ALL.iter().rev().map(|shrinkage| shrinkage.name()).collect();
    format!(
        "paper-t4 or edof-t4w12, or words from the left: {}, w8 | w12 | w16 (window), t2…t10 (layers), c1…c1024 (codes), \
         r (linear path), tied, difference, e1…e4 (exposures: raw frames at one focus each, see edof train --focus)",
        shrinkages.join(" | ")
    )
}

/// Returns the shrinkage of that name.
fn shrinkage(word: &str) -> Option<Shrinkage> {
    Shrinkage::ALL.into_iter().find(|shrinkage| shrinkage.name() == word)
}

/// Reads a form. It starts as the paper's (two-sided, window 8, T = 4, 192 codes); each word changes it.
///
/// # Errors
/// One line naming the first unknown word, or a window or number of layers that no form has.
pub fn parse(text: &str) -> Result<Form, String> {
    let mut form = Form {
        window: Window::new(8).map_err(|e| e.to_string())?,
        codes: 192,
        layers: 4,
        shrinkage: Shrinkage::TwoSided,
        recurrence: Recurrence::Direct,
        linear_path: false,
        tied: false,
        exposures: 1,
    };
    let mut given: Vec<&str> = vec![];
    for word in text.split(',').map(str::trim) {
        apply(&mut form, word)?;
        if !given.is_empty() && PRESETS.contains(&word) {
            return Err(format!("keyword '{word}': must be the first one; those after it change that form"));
        }
        if let Some(other) = given.iter().find(|other| subject(other) == subject(word)) {
            return Err(format!("keywords '{other}' and '{word}' set the same thing; leave one out"));
        }
        given.push(word);
    }
    form.check().map_err(|e| e.to_string())?;
    Ok(form)
}

/// Forms of whole networks.
const PRESETS: [&str; 2] = ["paper-t4", "edof-t4w12"];

/// What a keyword sets: numbers are known by their first letter.
fn subject(word: &str) -> &str {
    match word {
        word if shrinkage(word).is_some() => "shrinkage",
        word if word.ends_with(|c: char| c.is_ascii_digit()) && !PRESETS.contains(&word) => &word[..1],
        word => word,
    }
}

fn apply(form: &mut Form, word: &str) -> Result<(), String> {
    let number = |prefix: char| word.strip_prefix(prefix).and_then(|digits| digits.parse::<usize>().ok());
    match word {
        "paper-t4" => (),
        "edof-t4w12" => ["one-sided", "w12", "r"].iter().try_for_each(|w| apply(form, w))?,
        "r" => form.linear_path = true,
        "tied" => form.tied = true,
        "difference" => form.recurrence = Recurrence::Difference,
        _ => match (shrinkage(word), number('w'), number('t'), number('c'), number('e')) {
            (Some(shrinkage), ..) => form.shrinkage = shrinkage,
            (_, Some(side), ..) => form.window = Window::new(side).map_err(|e| e.to_string())?,
            (.., Some(layers), _, _) => form.layers = layers,
            (.., Some(codes), _) => form.codes = codes,
            (.., Some(exposures)) => form.exposures = exposures,
            _ => return Err(format!("unknown keyword '{word}', expected {}", help())),
        },
    }
    Ok(())
}

/// The form in words that [`parse`] reads.
#[must_use]
pub fn words(form: &Form) -> String {
    let mut words = vec![
        form.shrinkage.to_string(),
        format!("w{}", form.window.side()),
        format!("t{}", form.layers),
        format!("c{}", form.codes),
    ];
    let flags = [
        (form.linear_path, "r"),
        (form.tied, "tied"),
        (form.recurrence == Recurrence::Difference, "difference"),
    ];
    words.extend((form.exposures != 1).then(|| format!("e{}", form.exposures)));
    words.extend(flags.iter().filter(|(on, _)| *on).map(|(_, word)| (*word).to_owned()));
    words.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_back() {
        for text in
            ["two-sided,w8,t4,c192", "one-sided,w12,t4,c192,e2,r,tied", "one-sided,w16,t10,c64,difference"]
        {
            assert_eq!(words(&parse(text).unwrap()), text);
        }
        assert_eq!(words(&parse("edof-t4w12,t3").unwrap()), "one-sided,w12,t3,c192,r");
    }

    #[test]
    fn a_form_that_no_network_has_is_rejected() {
        assert_eq!(parse("w9").unwrap_err(), "window 9: must be 8, 12 or 16");
        assert_eq!(parse("t11").unwrap_err(), "layers 11: must be 2 to 10");
        assert_eq!(parse("e5").unwrap_err(), "exposures 5: must be 1 to 4");
        assert_eq!(
            parse("c8,t2,c16").unwrap_err(),
            "keywords 'c8' and 'c16' set the same thing; leave one out"
        );
        assert!(parse("one-sided,two-sided").unwrap_err().contains("set the same thing"));
        assert!(parse("t2,edof-t4w12").unwrap_err().contains("keyword 'edof-t4w12': must be the first"));
        assert!(parse("w8,three").unwrap_err().starts_with("unknown keyword 'three'"));
    }
}
