//! What weights keep to while they are trained, so that a circuit could multiply less for the same codes. The trained network is an ordinary one;
//! what its structure is worth is measured in docs/results/forms.md.

use crate::precondition::Precondition;
use edof_core::geometry::{PATCH, PATCH_PIXELS};
use edof_network::float::parameters::Layout;
use edof_network::network::Form;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// What weights keep to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Structure {
    /// Nothing.
    Free,
    /// Each code of the first half has a partner in the second, which is the same for a transposed window. (RGGB is its own transposition.) Sums and
    /// differences of pixels across the diagonal then give both partners for the multiplications of one, and the same holds for R.
    Symmetric,
    /// This share of the blocks of A and of R is zero: those of the least energy at the start.
    Blocks(f32),
}

/// Rows and columns of a block: lanes that multiply together, and pixels that come together.
pub const BLOCK: [usize; 2] = [8, 4];

impl Structure {
    /// What keeps a form from having it: what is expected in its place.
    #[must_use]
    pub fn objection(self, form: &Form) -> Option<&'static str> {
        let whole = form.codes.is_multiple_of(BLOCK[0]) && form.inputs().is_multiple_of(BLOCK[1]);
        match self {
            Self::Symmetric if !form.codes.is_multiple_of(2) => Some("free where the number of codes is odd"),
            Self::Blocks(share) if !(share > 0.0 && share < 1.0) => {
                Some("a share above 0 and below 1, as in blocks:0.5")
            }
            Self::Blocks(_) if !whole => Some("free where the number of codes is no multiple of 8"),
            _ => None,
        }
    }

    /// Whether the structure holds single pixels' weights. Whitened coordinates mix pixels, so a step in them would undo what is held.
    #[must_use]
    pub const fn is_of_pixels(self) -> bool {
        matches!(self, Self::Blocks(_))
    }

    /// Whether weights keep to the structure, up to rounding. Training from others would begin by ruining them. Blocks are chosen from any weights.
    #[must_use]
    pub fn is_kept_by(self, form: &Form, weights: &[f32]) -> bool {
        let Held::Equal(partner) = self.held(form, &Layout::new(form), weights) else { return true };
        let apart: f32 = weights.iter().zip(&partner).map(|(w, other)| (w - weights[*other]).powi(2)).sum();
        apart <= 1e-4 * weights.iter().map(|w| w * w).sum::<f32>()
    }

    /// What is held of a network's weights, decided by these.
    #[must_use]
    pub fn held(self, form: &Form, layout: &Layout, weights: &[f32]) -> Held {
        match self {
            Self::Free => Held::Nothing,
            Self::Symmetric => Held::Equal(partners(form, layout)),
            Self::Blocks(share) => {
                let inputs = form.inputs();
                let matrices = [&layout.analysis, &layout.linear_path].into_iter().filter(|m| !m.is_empty());
                Held::Zero(matrices.flat_map(|matrix| weakest(weights, matrix, inputs, share)).collect())
            }
        }
    }
}

impl fmt::Display for Structure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Free => f.write_str("free"),
            Self::Symmetric => f.write_str("symmetric"),
            Self::Blocks(share) => write!(f, "blocks:{share}"),
        }
    }
}

impl FromStr for Structure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let share = text.strip_prefix("blocks:").and_then(|share| share.parse().ok());
        match (text, share) {
            ("free", _) => Ok(Self::Free),
            ("symmetric", _) => Ok(Self::Symmetric),
            (_, Some(share)) => Ok(Self::Blocks(share)),
            _ => Err("expected free, symmetric, or blocks:SHARE as in blocks:0.5".into()),
        }
    }
}

/// Weights that are held.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Held {
    /// None.
    Nothing,
    /// Each weight equals the one at this place.
    Equal(Vec<usize>),
    /// These are zero.
    Zero(Vec<Range<usize>>),
}

impl Held {
    /// Codes of the second half become partners of the first; D and R stay as they are.
    pub fn begin(&self, layout: &Layout, weights: &mut [f32]) {
        let Self::Equal(partner) = self else { return };
        let matrices = [&layout.analysis].into_iter().chain(&layout.thresholds).chain(&layout.recurrent);
        for matrix in matrices {
            for second in matrix.start + matrix.len() / 2..matrix.end {
                weights[second] = weights[partner[second]];
            }
        }
    }

    /// Moves a network's weights to the nearest that are held.
    pub fn impose(&self, weights: &mut [f32]) {
        match self {
            Self::Nothing => (),
            Self::Equal(partner) => {
                for (i, other) in partner.iter().enumerate().filter(|(i, other)| *i < **other) {
                    let mean = 0.5 * (weights[i] + weights[*other]);
                    (weights[i], weights[*other]) = (mean, mean);
                }
            }
            Self::Zero(pieces) => pieces.iter().for_each(|piece| weights[piece.clone()].fill(0.0)),
        }
    }

    /// After a step: the network's weights for the trained ones, both held.
    pub fn hold(&self, condition: &Precondition, trained: &mut [f32], network: &mut [f32]) {
        condition.to_network(trained, network);
        if *self != Self::Nothing {
            self.impose(network);
            condition.to_trained(network, trained);
        }
    }
}

/// For each weight, where its partner is: of the other code of a pair, across the diagonals of window and patch.
fn partners(form: &Form, layout: &Layout) -> Vec<usize> {
    let (codes, inputs, side) = (form.codes, form.inputs(), form.window.side());
    let pixels = form.window.pixels();
    let code = |k: usize| (k + codes / 2) % codes;
    let pixel = |p: usize| p / pixels * pixels + p % side * side + p % pixels / side;
    let output = |o: usize| o / PATCH_PIXELS * PATCH_PIXELS + o % PATCH * PATCH + o % PATCH_PIXELS / PATCH;
    let mut partner = vec![0; layout.len()];
    let mut matrix = |range: &Range<usize>,
                      columns: usize,
                      row: &dyn Fn(usize) -> usize,
                      column: &dyn Fn(usize) -> usize| {
        for i in 0..range.len() {
            partner[range.start + i] = range.start + row(i / columns) * columns + column(i % columns);
        }
    };
    matrix(&layout.analysis, inputs, &code, &pixel);
    layout.thresholds.iter().for_each(|theta| matrix(theta, codes, &|row| row, &code));
    layout.recurrent.iter().for_each(|s| matrix(s, codes, &code, &code));
    matrix(&layout.dictionary, codes, &output, &code);
    matrix(&layout.linear_path, inputs, &output, &pixel);
    partner
}

/// Pieces of a matrix's rows that make up its weakest blocks.
fn weakest(weights: &[f32], matrix: &Range<usize>, columns: usize, share: f32) -> Vec<Range<usize>> {
    let [rows, wide] = BLOCK;
    let pieces = |block: usize| {
        let (top, left) = (block / (columns / wide) * rows, block % (columns / wide) * wide);
        (top..top + rows).map(move |row| matrix.start + row * columns + left).map(move |at| at..at + wide)
    };
    let energy = |block: usize| pieces(block).flat_map(|piece| &weights[piece]).map(|w| w * w).sum::<f32>();
    let mut blocks: Vec<usize> = (0..matrix.len() / (rows * wide)).collect();
    blocks.sort_by(|a, b| energy(*a).total_cmp(&energy(*b)));
    blocks.truncate((share * blocks.len() as f32).round() as usize);
    blocks.sort_unstable();
    blocks.into_iter().flat_map(pieces).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::Window;
    use edof_network::network::{Recurrence, Shrinkage};
    use edof_numerics::random::Random;

    fn form() -> Form {
        Form {
            window: Window::new(8).unwrap(),
            codes: 16,
            layers: 3,
            shrinkage: Shrinkage::OneSided,
            recurrence: Recurrence::Direct,
            linear_path: true,
            tied: false,
            exposures: 2,
        }
    }

    fn random(count: usize) -> Vec<f32> {
        let mut random = Random::new(3, 0, 0);
        (0..count).map(|_| random.normal()).collect()
    }

    /// Windows through the network.
    fn outputs(weights: &[f32], window: &[f32]) -> Vec<f32> {
        let mut pass = edof_network::float::pass::Pass::new(form(), 1);
        pass.forward(weights, window, 1).to_vec()
    }

    #[test]
    fn a_symmetric_network_gives_the_transposed_patch_of_a_transposed_window() {
        let layout = Layout::new(&form());
        let mut weights: Vec<f32> = random(layout.len()).iter().map(|w| 0.1 * w).collect();
        let held = Structure::Symmetric.held(&form(), &layout, &weights);
        held.impose(&mut weights);
        let window = random(form().inputs());
        let turned: Vec<f32> =
            (0..window.len()).map(|i| window[i / 64 * 64 + i % 8 * 8 + i % 64 / 8]).collect();
        let (patch, of_turned) = (outputs(&weights, &window), outputs(&weights, &turned));
        assert!(patch.iter().any(|v| v.abs() > 0.01));
        for (o, value) in patch.iter().enumerate() {
            let other = of_turned[o / 64 * 64 + o % 8 * 8 + o % 64 / 8];
            assert!((value - other).abs() < 1e-5, "output {o}: {value}, turned {other}");
        }
    }

    #[test]
    fn imposing_twice_is_imposing_once_and_partners_of_partners_are_the_same() {
        let layout = Layout::new(&form());
        for structure in [Structure::Symmetric, Structure::Blocks(0.5)] {
            let mut weights = random(layout.len());
            assert_eq!(structure.is_kept_by(&form(), &weights), structure != Structure::Symmetric);
            let held = structure.held(&form(), &layout, &weights);
            held.impose(&mut weights);
            let once = weights.clone();
            held.impose(&mut weights);
            assert_eq!(once, weights, "{structure}");
            assert!(structure.is_kept_by(&form(), &weights), "{structure}");
            // A resumed run finds what is held again.
            assert!(structure.held(&form(), &layout, &weights) == held, "{structure}");
        }
    }

    #[test]
    fn the_weakest_blocks_of_a_and_r_are_zero_and_nothing_else() {
        let layout = Layout::new(&form());
        let mut weights = random(layout.len());
        weights[layout.analysis.clone()]
            .iter_mut()
            .enumerate()
            .for_each(|(i, w)| *w *= 1.0 + (i % 64 / 32) as f32);
        Structure::Blocks(0.5).held(&form(), &layout, &weights.clone()).impose(&mut weights);
        let zeros = |range: &Range<usize>| weights[range.clone()].iter().filter(|w| **w == 0.0).count();
        assert_eq!(zeros(&layout.analysis), layout.analysis.len() / 2);
        assert_eq!(zeros(&layout.linear_path), layout.linear_path.len() / 2);
        assert_eq!(zeros(&layout.dictionary) + zeros(&layout.recurrent[0]), 0);
        let strong = |i: &usize| i % 64 / 32 == 1;
        let kept = (0..layout.analysis.len()).filter(|i| weights[layout.analysis.start + i] != 0.0);
        assert!(kept.filter(strong).count() > layout.analysis.len() / 3, "the stronger half of A is kept");
    }

    #[test]
    fn words_of_a_structure_are_read_as_they_are_written() {
        for structure in [Structure::Free, Structure::Symmetric, Structure::Blocks(0.25)] {
            assert_eq!(structure.to_string().parse(), Ok(structure));
        }
        assert!("blocks".parse::<Structure>().unwrap_err().contains("blocks:0.5"));
        assert!(Structure::Blocks(1.0).objection(&form()).is_some_and(|why| why.contains("blocks:0.5")));
        let odd = Form { codes: 15, ..form() };
        assert!(Structure::Symmetric.objection(&odd).is_some() && Structure::Free.objection(&odd).is_none());
    }
}
