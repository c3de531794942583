//! Verdicts of a study in sentences, computed from the rows in either direction.

use crate::metrics::paired::Paired;

/// Smaller differences in dB are no difference to a viewer.
pub(crate) const TIE_DB: f64 = 0.05;

/// How the first of two compares with the second: who is ahead and by how much, unless the difference may be chance.
pub(crate) fn compared(difference: &Paired) -> String {
    let by = match difference.standard_error {
        Some(error) => format!("{:.2} ± {error:.2} dB", difference.mean.abs()),
        None => format!("{:.2} dB", difference.mean.abs()),
    };
    match is_ahead(difference) {
        Some(true) => format!("better by {by}"),
        Some(false) => format!("worse by {by}"),
        None => format!("equally good within the error ({difference} dB)"),
    }
}

/// Whether the first of two is ahead; none where the difference is less than twice its standard error, or than anybody sees.
pub(crate) fn is_ahead(difference: &Paired) -> Option<bool> {
    let chance = difference.standard_error.map_or(0.0, |error| 2.0 * error);
    (difference.mean.abs() > chance.max(TIE_DB)).then_some(difference.mean > 0.0)
}

/// How long one thing takes beside another, as in `6.7 times as fast`.
pub(crate) fn speed(own: f64, other: f64) -> String {
    let ratio = other / own;
    match ratio {
        ratio if !ratio.is_finite() => "of unknown speed".to_owned(),
        ratio if ratio >= 1.05 => format!("{} times as fast", short(ratio)),
        ratio if ratio <= 1.0 / 1.05 => format!("{} times as slow", short(1.0 / ratio)),
        _ => "equally fast".to_owned(),
    }
}

fn short(ratio: f64) -> String {
    if ratio < 9.95 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

/// The part of a Markdown page that the verdicts are; empty where there are none.
pub(crate) fn listed(verdicts: &[String]) -> String {
    match verdicts {
        [] => String::new(),
        [only] => format!("**Verdict.** {only}\n\n"),
        all => format!("**Verdict.**\n\n- {}\n\n", all.join("\n- ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paired(mean: f64, standard_error: Option<f64>) -> Paired {
        Paired { mean, standard_error, photos: 8 }
    }

    #[test]
    fn a_difference_counts_from_twice_its_standard_error() {
        assert_eq!(compared(&paired(1.486, Some(0.22))), "better by 1.49 ± 0.22 dB");
        assert_eq!(compared(&paired(-0.31, Some(0.1))), "worse by 0.31 ± 0.10 dB");
        assert_eq!(compared(&paired(0.19, Some(0.1))), "equally good within the error (+0.19 ± 0.10 dB)");
        assert_eq!(compared(&paired(-0.04, Some(0.001))), "equally good within the error (-0.04 ± 0.00 dB)");
        assert_eq!(compared(&paired(-2.0, None)), "worse by 2.00 dB");
    }

    #[test]
    fn several_verdicts_are_a_list() {
        assert_eq!(listed(&[]), "");
        assert_eq!(listed(&["a.".into()]), "**Verdict.** a.\n\n");
        assert_eq!(listed(&["a.".into(), "b.".into()]), "**Verdict.**\n\n- a.\n- b.\n\n");
    }

    #[test]
    fn speeds_are_stated_from_the_first_ones_side() {
        assert_eq!(speed(0.1, 4.8), "48 times as fast");
        assert_eq!(speed(3.0, 1.0), "3.0 times as slow");
        assert_eq!(speed(1.0, 1.01), "equally fast");
        assert_eq!(speed(0.0, 1.0), "of unknown speed");
    }
}
