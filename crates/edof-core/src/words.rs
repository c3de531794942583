//! Numbers and counts as errors and reports write them.

/// Significant digits that are printed of a number.
const DIGITS: usize = 6;

/// A number in few digits, whatever its size.
///
/// ```
/// use edof_core::words::number;
/// assert_eq!([0.5, 900.0, 1e308, f64::NAN].map(number), ["0.5", "900", "1e308", "NaN"]);
/// ```
#[must_use]
pub fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.DIGITS$e}").parse().unwrap_or(value);
    let plain = rounded == 0.0 || !rounded.is_finite() || (1e-4..1e12).contains(&rounded.abs());
    if plain { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Numbers with commas between, in few digits each, at most as many as fit one line.
///
/// ```
/// assert_eq!(edof_core::words::numbers(&[4.0, 0.0]), "4, 0");
/// assert_eq!(edof_core::words::numbers(&[1.0; 100]), "1, 1, 1, 1, 1, 1, 1, 1, … (100 numbers)");
/// ```
#[must_use]
pub fn numbers(values: &[f64]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<String> = values.iter().take(SHOWN).copied().map(number).collect();
    match values.len() {
        0 => "no number".to_owned(),
        all if all > SHOWN => format!("{}, … ({all} numbers)", shown.join(", ")),
        _ => shown.join(", "),
    }
}

/// A count and what is counted, one thing or several.
///
/// ```
/// use edof_core::words::count;
/// assert_eq!(count(1, "photograph"), "1 photograph");
/// assert_eq!(count(3, "photograph"), "3 photographs");
/// ```
#[must_use]
pub fn count(count: usize, what: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {what}{ending}")
}

/// Words as alternatives.
///
/// ```
/// use edof_core::words::alternatives;
/// assert_eq!(alternatives([".png", ".tif", ".pgm"]), ".png, .tif or .pgm");
/// assert_eq!(alternatives(["none"]), "none");
/// ```
#[must_use]
pub fn alternatives<T: ToString>(words: impl IntoIterator<Item = T>) -> String {
    let words: Vec<String> = words.into_iter().map(|word| word.to_string()).collect();
    match &words[..] {
        [others @ .., last] if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        words => words.concat(),
    }
}

/// The sides of an array as people write them.
///
/// ```
/// assert_eq!(edof_core::words::sides(&[2, 3, 7]), "2 x 3 x 7");
/// assert_eq!(edof_core::words::sides(&[]), "a single number");
/// ```
#[must_use]
pub fn sides(shape: &[usize]) -> String {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    if sides.is_empty() { "a single number".to_owned() } else { sides.join(" x ") }
}
