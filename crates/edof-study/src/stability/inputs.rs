//! The suite's inputs for any network: what a circuit is fed with, so that it is tried on the cases that the software is.

use crate::stability::case::{Case, Trial};
use crate::stability::outcome::Stopped;
use crate::stability::{frames, words};
use edof_core::number::InputWord;
use edof_golden::fast::Fast;
use edof_network::FixedNetwork;

/// Input words of at most `max` windows of a case for a network: of a frame those all over it, as its own camera takes it; of words those
/// that drive this network's sums to their ends. None of cases that are about something else, or that are rejected.
///
/// # Errors
/// What the case itself would say, such as a depth without PSFs.
pub fn windows(case: &Case, network: &FixedNetwork, max: usize) -> Result<Vec<Vec<InputWord>>, String> {
    let all = match &case.trial {
        Trial::Frame(_) if matches!(case.promise, crate::stability::case::Promise::Refused { .. }) => vec![],
        Trial::Frame(frame) => {
            let (raw, _) = frames::raw(frame, &network.origin.camera).map_err(said)?;
            frames::windows(network, &raw)
        }
        Trial::Words(given) => words::windows(&Fast::new(network.clone()), Fast::traces, given.windows),
        _ => vec![],
    };
    let pixels = network.form.window.pixels();
    let count = all.len() / pixels;
    let every = count.div_ceil(max.max(1)).max(1);
    Ok(all.chunks_exact(pixels).step_by(every).map(<[InputWord]>::to_vec).collect())
}

fn said(stopped: Stopped) -> String {
    match stopped {
        Stopped::Refused(message) | Stopped::Panicked(message) => message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::case;

    #[test]
    fn frames_and_words_give_windows_and_all_else_gives_none() {
        let network = edof_device::random::natural(8, 8, 1);
        for case in case::own().unwrap() {
            let quick = ["words-extreme", "words-signs-of-rows", "psi-300", "gamma-index", "flat-black"];
            if !quick.contains(&case.id.as_str()) {
                continue;
            }
            let found = windows(&case, &network, 10).unwrap();
            let expected = matches!(case.id.as_str(), "words-extreme" | "words-signs-of-rows" | "flat-black");
            assert_eq!(!found.is_empty(), expected, "{}", case.id);
            assert!(found.len() <= 10 && found.iter().all(|window| window.len() == 64), "{}", case.id);
        }
    }
}
