//! The sensor: colour filters, noise, saturation and bit depth make a raw frame of the light that falls on it.

use edof_core::frame::FrameError;
use edof_core::noise::NoiseError;
use edof_core::{CfaPhase, ColourFrame, Noise, RawFrame};
use ndarray::Array2;
use rand::SeedableRng;
use rand_distr::{Distribution, Poisson, StandardNormal};
use rand_pcg::Pcg64;

/// How a sensor turns light into values.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Bits per pixel, 8…16.
    pub depth: u32,
    /// Colour of the first pixel's filter.
    pub phase: CfaPhase,
    /// Noise added before saturation.
    pub noise: Noise,
    /// Same seed, same noise.
    pub seed: u64,
    /// Value of no light; what noise takes below it is kept.
    pub black_level: u16,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { depth: 12, phase: CfaPhase::Rggb, noise: Noise::default(), seed: 0, black_level: 0 }
    }
}

/// A sensor that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SensorError {
    /// Odd sides or a depth outside 8…16.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A noise parameter out of range.
    #[error(transparent)]
    Noise(#[from] NoiseError),
    /// No room for light above it.
    #[error("black level {black}: must be less than {full}, for a sensor of {depth} bits")]
    Black {
        /// The level.
        black: u16,
        /// One more than the largest value.
        full: u32,
        /// Bits of the sensor.
        depth: u32,
    },
}

impl Sensor {
    /// # Errors
    /// [`SensorError`] for noise or a depth that no sensor has.
    pub fn check(&self) -> Result<(), SensorError> {
        self.noise.check()?;
        let Self { depth, black_level: black, .. } = *self;
        if !(8..=16).contains(&depth) {
            return Err(FrameError::Depth(depth).into());
        }
        let full = 1u32 << depth;
        if u32::from(black) < full { Ok(()) } else { Err(SensorError::Black { black, full, depth }) }
    }
}

/// Linear light behind the colour filters, noise added: rows × columns, not yet saturated.
///
/// # Errors
/// [`SensorError::Noise`].
pub fn mosaic_with_noise(frame: &ColourFrame, sensor: &Sensor) -> Result<Array2<f32>, SensorError> {
    sensor.noise.check()?;
    Ok(sensed(frame, sensor, |light| light))
}

/// What `value` makes of the light on each pixel, noise added.
fn sensed<T>(frame: &ColourFrame, sensor: &Sensor, value: impl Fn(f32) -> T) -> Array2<T> {
    let mut generator = Pcg64::seed_from_u64(sensor.seed);
    Array2::from_shape_fn(frame.size(), |(row, column)| {
        let light = f64::from(frame.planes[(sensor.phase.channel(row, column).plane(), row, column)]);
        value(noisy(light, sensor.noise, &mut generator) as f32)
    })
}

/// One draw of what a pixel reads at a light of `value`.
fn noisy(value: f64, noise: Noise, generator: &mut Pcg64) -> f64 {
    match noise {
        Noise::None => value,
        Noise::Gaussian { sigma } => value + sigma * normal(generator),
        Noise::Sensor(sensor) => {
            let full_scale = sensor.full_scale_e();
            let read = sensor.read_noise_e * normal(generator);
            (electrons(value * full_scale, generator) + read) / full_scale
        }
    }
}

fn normal(generator: &mut Pcg64) -> f64 {
    StandardNormal.sample(generator)
}

/// A count of electrons of that mean. Where there is no such distribution, darkness gives none, and a mean beyond 10¹⁹ is so
/// sharp that it stands for every draw.
fn electrons(mean: f64, generator: &mut Pcg64) -> f64 {
    if mean <= 0.0 { 0.0 } else { Poisson::new(mean).map_or(mean, |p| p.sample(generator)) }
}

/// The raw frame: mosaic, noise, then value = round(black + light·(2^depth − black)), saturated to 0…2^depth − 1.
///
/// # Errors
/// [`SensorError`]: odd sides, a depth outside 8…16, noise or a black level out of range.
pub fn expose(frame: &ColourFrame, sensor: &Sensor) -> Result<RawFrame, SensorError> {
    sensor.check()?;
    let (full_scale, black) = ((1u32 << sensor.depth) as f32, f32::from(sensor.black_level));
    let range = full_scale - black;
    let value = |light: f32| (black + light * range).round().clamp(0.0, full_scale - 1.0) as u16;
    let values = sensed(frame, sensor, value);
    Ok(RawFrame::from_values(values, sensor.depth, sensor.phase)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::noise::SensorNoise;

    fn flat(level: f32) -> ColourFrame {
        let mut frame = ColourFrame::zeros(200, 200);
        frame.planes.fill(level);
        frame
    }

    fn mean_and_variance(light: &Array2<f32>) -> (f64, f64) {
        let mean = light.iter().map(|&v| f64::from(v)).sum::<f64>() / light.len() as f64;
        let square = light.iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>();
        (mean, square / light.len() as f64)
    }

    #[test]
    fn each_pixel_measures_the_colour_of_its_filter() {
        let mut frame = ColourFrame::zeros(4, 6);
        for (plane, level) in [0.25, 0.5, 0.75].into_iter().enumerate() {
            frame.planes.index_axis_mut(ndarray::Axis(0), plane).fill(level);
        }
        for phase in CfaPhase::ALL {
            let raw = expose(&frame, &Sensor { phase, depth: 8, ..Sensor::default() }).unwrap();
            for ((r, c), &code) in raw.values().indexed_iter() {
                assert_eq!(code, [64, 128, 192][phase.channel(r, c).plane()]);
            }
        }
    }

    #[test]
    fn light_beyond_full_scale_and_below_zero_saturates() {
        for depth in 8..=16 {
            let sensor = Sensor { depth, ..Sensor::default() };
            let max = ((1u32 << depth) - 1) as u16;
            assert!(expose(&flat(1.5), &sensor).unwrap().values().iter().all(|&c| c == max));
            assert!(expose(&flat(-0.5), &sensor).unwrap().values().iter().all(|&c| c == 0));
        }
    }

    #[test]
    fn darkness_reads_as_the_black_level_and_full_light_as_full_scale() {
        let sensor = Sensor { black_level: 64, ..Sensor::default() };
        for (light, value) in [(0.0, 64), (0.5, 2080), (1.0, 4095), (-0.01, 24)] {
            assert!(expose(&flat(light), &sensor).unwrap().values().iter().all(|&v| v == value), "{light}");
        }
    }

    #[test]
    fn gaussian_noise_has_its_deviation_and_no_bias() {
        let noise = Noise::gaussian(0.02);
        let light = mosaic_with_noise(&flat(0.5), &Sensor { noise, ..Sensor::default() }).unwrap();
        let (mean, variance) = mean_and_variance(&light);
        assert!((mean - 0.5).abs() < 5e-4 && (variance.sqrt() - 0.02).abs() < 3e-4, "{mean} {variance}");
    }

    #[test]
    fn photon_noise_grows_with_the_light() {
        let noise = Noise::Sensor(SensorNoise { full_well_e: 1000.0, read_noise_e: 0.0, gain: 1.0 });
        for level in [0.0, 0.01, 0.1, 0.8] {
            let light = mosaic_with_noise(&flat(level), &Sensor { noise, ..Sensor::default() }).unwrap();
            let (mean, variance) = mean_and_variance(&light);
            let expected = f64::from(level) / 1000.0;
            assert!((mean - f64::from(level)).abs() < 1e-3);
            assert!((variance - expected).abs() <= 0.05 * expected, "{level}: {variance} not {expected}");
        }
    }

    #[test]
    fn a_sensors_noise_has_the_variance_that_it_states() {
        for gain in [1.0, 8.0] {
            let noise = Noise::sensor(gain);
            for level in [0.0, 0.02, 0.5] {
                let light = mosaic_with_noise(&flat(level), &Sensor { noise, ..Sensor::default() }).unwrap();
                let (mean, variance) = mean_and_variance(&light);
                let expected = noise.variance(f64::from(level));
                assert!((mean - f64::from(level)).abs() < 5e-4, "{level}: {mean}");
                assert!((variance - expected).abs() <= 0.05 * expected, "{level}: {variance} not {expected}");
            }
        }
    }

    #[test]
    fn light_too_strong_for_a_poisson_draw_stays_light() {
        let noise = Noise::Sensor(SensorNoise { full_well_e: 1e9, read_noise_e: 0.0, gain: 1.0 });
        for level in [1.0, 1e12, f32::MAX] {
            let raw = expose(&flat(level), &Sensor { noise, ..Sensor::default() }).unwrap();
            assert!(raw.values().iter().all(|&c| c >= 4094), "{level}");
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_frame_and_another_seed_another() {
        let noise = Noise::sensor(2.0);
        let shot = |seed| expose(&flat(0.3), &Sensor { noise, seed, ..Sensor::default() }).unwrap();
        assert_eq!(shot(7), shot(7));
        assert_ne!(shot(7), shot(8));
    }

    #[test]
    fn impossible_sensors_are_rejected() {
        let refused = |sensor: Sensor| expose(&flat(0.1), &sensor).unwrap_err().to_string();
        assert_eq!(refused(Sensor { depth: 20, ..Sensor::default() }), "bit depth 20: must be 8 to 16");
        assert_eq!(
            refused(Sensor { depth: 8, black_level: 256, ..Sensor::default() }),
            "black level 256: must be less than 256, for a sensor of 8 bits"
        );
        let noise = Noise::sensor(0.0);
        assert!(refused(Sensor { noise, ..Sensor::default() }).starts_with("noise: gain is 0, expected 1"));
        assert!(
            expose(&ColourFrame::zeros(3, 4), &Sensor::default()).unwrap_err().to_string().contains("4x3")
        );
    }
}
