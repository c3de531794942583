//! What integers cost: the same scenes through the float network in the board's output format and through the golden
//! pipeline.

use edof_golden::{Counts, Golden};
use edof_image::{ColourFrame, RawFrame, ReconstructError, Reconstructor, Tone};

/// A raw frame and what a perfect lens would have shown.
#[derive(Debug, Clone)]
pub struct Scene<'a> {
    /// What it is, for messages.
    pub name: String,
    /// What the sensor gave.
    pub raw: RawFrame,
    /// The sharp picture.
    pub sharp: &'a ColourFrame,
    /// What the picture's numbers mean; what is reconstructed is light.
    pub tone: Tone,
}

/// One scene's two results.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneLoss {
    /// The scene.
    pub name: String,
    /// PSNR of the float network in 4:2:2, in dB.
    pub float_db: f64,
    /// PSNR of the integers.
    pub fixed_db: f64,
}

impl SceneLoss {
    /// dB that integers cost; negative where they happen to be better.
    #[must_use]
    pub fn lost_db(&self) -> f64 {
        self.float_db - self.fixed_db
    }
}

/// All scenes, and what the golden pipeline counted on them.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Scene by scene.
    pub scenes: Vec<SceneLoss>,
    /// Saturations and non-zeros of every stage, over all scenes.
    pub counts: Counts,
}

impl Evaluation {
    /// Mean dB lost.
    #[must_use]
    pub fn mean_lost_db(&self) -> f64 {
        self.scenes.iter().map(SceneLoss::lost_db).sum::<f64>() / self.scenes.len().max(1) as f64
    }

    /// The scene that lost most.
    #[must_use]
    pub fn worst(&self) -> Option<&SceneLoss> {
        self.scenes.iter().max_by(|a, b| a.lost_db().total_cmp(&b.lost_db()))
    }
}

/// Runs both on every scene. `float` must give the board's format: 4:2:2, 16-bit luma, 8-bit chroma. `psnr(sharp, estimate)`
/// is the metric, in dB; it compares pictures in the tone of the sharp one.
///
/// # Errors
/// [`ReconstructError`] for a scene that is too small.
pub fn evaluate(
    float: &dyn Reconstructor,
    fixed: &Golden,
    scenes: &[Scene<'_>],
    psnr: impl Fn(&ColourFrame, &ColourFrame) -> f64,
) -> Result<Evaluation, ReconstructError> {
    let mut counts = Counts::new(fixed.network().form.layers);
    let losses = scenes
        .iter()
        .map(|scene| {
            let out = fixed.frame(&scene.raw)?;
            counts.merge(&out.counts);
            let psnr = |light: &ColourFrame| psnr(scene.sharp, &scene.tone.encoded(light));
            Ok(SceneLoss {
                name: scene.name.clone(),
                float_db: psnr(&float.reconstruct(&scene.raw)?.frame),
                fixed_db: psnr(&out.colour()),
            })
        })
        .collect::<Result<_, ReconstructError>>()?;
    Ok(Evaluation { scenes: losses, counts })
}
