//! What a stage hands to the next, and what its counters say.

use edof_core::colour::OUTPUTS_422;
use edof_core::number::{InputWord, OutputWord};
use edof_core::reconstructor::{Counters, Multiplications};
use edof_network::FixedNetwork;

/// One patch on its way through the network: the words at every stage boundary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trace {
    /// y: the window's input words, row by row.
    pub input: Vec<InputWord>,
    /// What I and each M stage made, t = 1…T−1.
    pub layers: Vec<LayerWords>,
    /// F's 128 words: luma, Cb, Cr.
    pub output: Vec<OutputWord>,
    /// Counters of I, each M, F for this patch alone.
    pub stages: Vec<StageCounts>,
}

/// The words that I or an M stage makes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LayerWords {
    /// Pre-activations b_t, rounded.
    pub b: Vec<i16>,
    /// Sparse codes z_t = shrink(b_t).
    pub z: Vec<i16>,
    /// What the next stage multiplies: z_t, or z_t − z_{t−1} where the difference form's next stage is an M.
    pub sent: Vec<i16>,
}

/// Counters of one stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StageCounts {
    /// Accumulators that did not fit when rounded to b or to the output.
    pub saturated_results: u64,
    /// Sparse codes that did not fit (b − θ with a negative θ).
    pub saturated_codes: u64,
    /// Differences z_t − z_{t−1} that did not fit.
    pub saturated_differences: u64,
    /// Non-zero words sent as pairs to the next stage; F sends none.
    pub nonzeros: u64,
}

impl StageCounts {
    /// All saturations of the stage, as its register shows them.
    #[must_use]
    pub const fn saturations(&self) -> u64 {
        self.saturated_results + self.saturated_codes + self.saturated_differences
    }
}

impl std::ops::AddAssign for StageCounts {
    fn add_assign(&mut self, other: Self) {
        self.saturated_results += other.saturated_results;
        self.saturated_codes += other.saturated_codes;
        self.saturated_differences += other.saturated_differences;
        self.nonzeros += other.nonzeros;
    }
}

/// Counters of a whole frame.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts {
    /// Patches reconstructed.
    pub patches: u64,
    /// I, each M, F.
    pub stages: Vec<StageCounts>,
    /// Luma and chroma words whose overlap sum did not fit 16 bits.
    pub saturated_sums: u64,
}

impl Counts {
    /// Counters at zero for a network of `layers` layers.
    #[must_use]
    pub fn new(layers: usize) -> Self {
        Self { stages: vec![StageCounts::default(); layers], ..Self::default() }
    }

    /// Counts one more patch.
    pub fn add(&mut self, stages: &[StageCounts]) {
        self.patches += 1;
        for (sum, stage) in self.stages.iter_mut().zip(stages) {
            *sum += *stage;
        }
    }

    /// Adds the counts of another part of the frame.
    pub fn merge(&mut self, other: &Self) {
        self.patches += other.patches;
        self.saturated_sums += other.saturated_sums;
        for (sum, stage) in self.stages.iter_mut().zip(&other.stages) {
            *sum += *stage;
        }
    }

    /// Saturations of all stages and of the overlap sum.
    #[must_use]
    pub fn saturations(&self) -> u64 {
        self.stages.iter().map(StageCounts::saturations).sum::<u64>() + self.saturated_sums
    }

    /// What every method may count, of these counts.
    #[must_use]
    pub fn counters(&self) -> Counters {
        let shrinkages = self.stages.len().saturating_sub(1);
        let nonzeros = self.stages.iter().take(shrinkages).map(|s| s.nonzeros).collect();
        Counters { patches: self.patches, nonzeros, saturations: self.saturations() }
    }

    /// Multiplications for these patches; executed are those of a machine that skips zero sparse codes (of M and F: every word
    /// that is sent and not zero, times the rows of the matrix), as [`crate::fast`] and the board do.
    #[must_use]
    pub fn multiplications(&self, network: &FixedNetwork) -> Multiplications {
        let (codes, pixels) = (network.form.codes as u64, network.form.window.pixels() as u64);
        let outputs = OUTPUTS_422 as u64;
        let (last, middle) = match self.stages.get(..network.form.shrinkages()) {
            Some([middle @ .., last]) => (last.nonzeros, middle.iter().map(|s| s.nonzeros).sum::<u64>()),
            _ => (0, 0),
        };
        let linear = if network.linear_path.is_some() { pixels * outputs } else { 0 };
        Multiplications {
            dense: self.patches * network.form.dense_multiplications(OUTPUTS_422),
            executed: self.patches * (pixels * codes + linear) + middle * codes + last * outputs,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::{Stride, Window};
    use edof_network::network::{Form, Recurrence, Shrinkage};

    fn network(linear_path: bool) -> FixedNetwork {
        let window = Window::new(8).unwrap();
        let (shrinkage, recurrence) = (Shrinkage::OneSided, Recurrence::Direct);
        let form = Form {
            window,
            codes: 10,
            layers: 4,
            shrinkage,
            recurrence,
            linear_path,
            tied: false,
            exposures: 1,
        };
        edof_device::random::extreme(form, 16, Stride::PATCH, false, 1)
    }

    /// Five patches through I, two M and F.
    fn counts() -> Counts {
        let stage =
            |nonzeros, saturated_codes| StageCounts { nonzeros, saturated_codes, ..StageCounts::default() };
        let mut counts = Counts { saturated_sums: 1000, ..Counts::new(4) };
        for patch in 0..5 {
            counts.add(&[stage(7, 1), stage(5, 0), stage(3, patch), StageCounts::default()]);
        }
        counts
    }

    #[test]
    fn saturations_are_those_of_the_stages_and_of_the_overlap_sum() {
        assert_eq!(counts().saturations(), 5 + 10 + 1000);
        assert_eq!(counts().counters().saturations, 1015);
    }

    #[test]
    fn an_executed_multiplication_has_a_word_that_is_not_zero_but_in_the_dense_stages() {
        // I multiplies every pixel; each word of I and the first M meets 10 rows of the next M, each of the last M 128 rows of F.
        let without = 5 * 64 * 10 + (35 + 25) * 10 + 15 * 128;
        assert_eq!(counts().multiplications(&network(false)).executed, without);
        assert_eq!(counts().multiplications(&network(true)).executed, without + 5 * 64 * 128);
        let dense = 5 * network(true).form.dense_multiplications(128);
        assert_eq!(counts().multiplications(&network(true)).dense, dense);
    }

    #[test]
    fn parts_of_a_frame_add_up() {
        let mut whole = counts();
        whole.merge(&counts());
        assert_eq!((whole.patches, whole.saturated_sums, whole.stages[0].nonzeros), (10, 2000, 70));
    }
}
