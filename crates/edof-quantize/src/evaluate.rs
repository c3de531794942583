//! What integers cost: the same scenes through the float network in the board's output format and through the golden
//! pipeline.

use edof_core::{ColourFrame, RawFrame, ReconstructError, Reconstructor, Tone};
use edof_golden::{Counts, Golden};

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
/// [`ReconstructError`] for a scene that is too small; what `psnr` returns.
pub fn evaluate<E: From<ReconstructError>>(
    float: &dyn Reconstructor,
    fixed: &Golden,
    scenes: &[Scene<'_>],
    psnr: impl Fn(&ColourFrame, &ColourFrame) -> Result<f64, E>,
) -> Result<Evaluation, E> {
    let mut counts = Counts::new(fixed.network().form.layers);
    let losses = scenes
        .iter()
        .map(|scene| {
            let (out, light) = fixed.frame_of_light(&scene.raw).map_err(ReconstructError::from)?;
            counts.merge(&out.counts);
            let psnr = |light: &ColourFrame| psnr(scene.sharp, &scene.tone.encoded(light));
            Ok(SceneLoss {
                name: scene.name.clone(),
                float_db: psnr(&float.reconstruct(&scene.raw)?.frame)?,
                fixed_db: psnr(&light)?,
            })
        })
        .collect::<Result<_, E>>()?;
    Ok(Evaluation { scenes: losses, counts })
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::CfaPhase;
    use edof_golden::GoldenReconstructor;
    use ndarray::{Array2, Array3};

    fn loss(name: &str, float_db: f64, fixed_db: f64) -> SceneLoss {
        SceneLoss { name: name.to_owned(), float_db, fixed_db }
    }

    #[test]
    fn what_is_lost_is_the_float_figure_less_that_of_the_integers() {
        let scenes = vec![loss("a", 30.0, 29.5), loss("b", 20.0, 17.0), loss("c", 25.0, 25.5)];
        assert_eq!(scenes.iter().map(SceneLoss::lost_db).collect::<Vec<_>>(), [0.5, 3.0, -0.5]);
        let all = Evaluation { scenes, counts: Counts::default() };
        assert_eq!(all.mean_lost_db(), 1.0);
        assert_eq!(all.worst().unwrap().name, "b");
        let none = Evaluation { scenes: vec![], counts: Counts::default() };
        assert_eq!((none.mean_lost_db(), none.worst()), (0.0, None));
    }

    #[test]
    fn every_scene_is_measured_in_its_tone_through_both_and_counted() {
        let network = |seed| edof_device::random::natural(8, 8, seed);
        let (float, fixed) =
            (GoldenReconstructor::new(network(1), "float").unwrap(), Golden::new(network(2)).unwrap());
        let sharp = ColourFrame { planes: Array3::from_elem((3, 16, 24), 0.25) };
        let raw = |level: u16| {
            let values = Array2::from_shape_fn((16, 24), |(r, c)| level + (r * 31 + c * 17) as u16);
            RawFrame::from_values(values, 12, CfaPhase::Rggb).unwrap()
        };
        let scenes = [(Tone::Linear, 600), (Tone::Srgb, 1800)].map(|(tone, level)| Scene {
            name: format!("scene {level}"),
            raw: raw(level),
            sharp: &sharp,
            tone,
        });
        let psnr = |sharp: &ColourFrame, other: &ColourFrame| {
            f64::from(other.planes.mean().unwrap()) - 10.0 * f64::from(sharp.planes.mean().unwrap())
        };
        let found =
            evaluate(&float, &fixed, &scenes, |sharp, other| Ok::<_, ReconstructError>(psnr(sharp, other)))
                .unwrap();
        let mut counts = Counts::new(4);
        for (scene, loss) in scenes.iter().zip(&found.scenes) {
            let out = fixed.frame(&scene.raw).unwrap();
            counts.merge(&out.counts);
            let float = float.reconstruct(&scene.raw).unwrap().frame;
            assert_eq!(loss.name, scene.name);
            assert_eq!(loss.float_db, psnr(&sharp, &scene.tone.encoded(&float)));
            assert_eq!(loss.fixed_db, psnr(&sharp, &scene.tone.encoded(&out.colour())));
        }
        assert_eq!((found.scenes.len(), found.counts), (2, counts));
    }
}
