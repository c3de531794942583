//! How well any lens could do, and how near to that a lens comes: the linear limit of a camera over a range of depths.
//!
//! | what | module | gives |
//! |---|---|---|
//! | lens | [`transfer`] | the transfer of lens and pixel at each spatial frequency, colour and depth |
//! | estimate | [`wiener`] | the error of the best linear estimate behind it, blind or with the depth known |
//! | limit | [`pupil`] | the most contrast that any pupil keeps on average over a range of depths |
//! | | [`relaxed`] | what an ideal lens with that contrast would reach behind a Bayer sensor |
//! | | [`ceiling`](mod@ceiling) | both limits in dB |
//! | choice | [`lenses`] | the clear lens, masks of the cubic family, smaller apertures |
//! | | [`judge`] | the best stop and focus of a lens |
//! | | [`advise`](mod@advise) | the lens that a range of depths and a light need |
//!
//! Photographs vary as [`Statistics`](crate::Statistics) have it, on a torus of [`GRID`] pixels. Light is stated as the electrons of a
//! white pixel behind the open aperture; noise is that of a pixel of mean light. All decibels are PSNR of linear light, peak 1.
//!
//! ```
//! use edof_optics::bound::pupil;
//! // A range of ψ of width 8, blue light at the Nyquist frequency: no pupil keeps more of the squared contrast.
//! let limit = pupil::mean_square(0.533, 8.0);
//! assert!((limit - 0.237).abs() < 0.001);
//! ```

pub mod advise;
pub mod ceiling;
pub mod judge;
pub mod lenses;
pub mod pupil;
pub mod relaxed;
pub mod transfer;
pub mod wiener;

use edof_core::noise::{Noise, SensorNoise};

/// Side in pixels of the torus on which lenses are judged.
pub const GRID: usize = 32;

/// Light that reaches the sensor, and what reading it adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Electrons of a white pixel behind the open aperture.
    pub electrons: f64,
    /// Read noise in electrons, standard deviation.
    pub read_noise_e: f64,
    /// Mean light of the scene, full scale 1.
    pub mean: f64,
}

impl Light {
    /// Mean light of photographs.
    pub const MEAN: f64 = 0.4;

    /// Returns the noise variance of a pixel of mean light behind an aperture closed by `stops`, in units of full scale squared: the gain is
    /// raised until white fills the scale again.
    #[must_use]
    pub fn variance(&self, stops: f64) -> f64 {
        let full_well_e = self.electrons * (-stops).exp2();
        Noise::Sensor(SensorNoise { full_well_e, read_noise_e: self.read_noise_e, gain: 1.0 })
            .variance(self.mean)
    }
}

/// PSNR in dB over a range of depths.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Reached {
    /// Average over the range.
    pub average_db: f64,
    /// At the worst depth.
    pub worst_db: f64,
}

impl Reached {
    /// Returns average and worst of mean square errors, one for each depth.
    #[must_use]
    pub fn of_errors(errors: &[f64]) -> Self {
        let db = errors.iter().map(|e| decibels(*e));
        let average_db = db.clone().sum::<f64>() / errors.len() as f64;
        Self { average_db, worst_db: db.fold(f64::INFINITY, f64::min) }
    }

    /// Returns the figure by which lenses, stops and foci are chosen: average and worst depth have equal weight.
    #[must_use]
    pub const fn score(self) -> f64 {
        0.5 * (self.average_db + self.worst_db)
    }

    /// Returns the difference in both figures.
    #[must_use]
    pub const fn minus(self, other: Self) -> Self {
        Self { average_db: self.average_db - other.average_db, worst_db: self.worst_db - other.worst_db }
    }

    /// Returns the mixture with `share` of another.
    #[must_use]
    pub const fn mixed(self, other: Self, share: f64) -> Self {
        Self {
            average_db: (1.0 - share) * self.average_db + share * other.average_db,
            worst_db: (1.0 - share) * self.worst_db + share * other.worst_db,
        }
    }
}

/// Returns the PSNR in dB, peak 1, of a mean square error.
#[must_use]
pub fn decibels(error: f64) -> f64 {
    -10.0 * error.max(1e-12).log10()
}

/// Returns the depths at which a range of ψ is judged, evenly spread with both ends: 9 of them, more from a width of 16 on, 25 at most.
#[must_use]
pub fn depths([low, high]: [f64; 2]) -> Vec<f64> {
    let count = (7.0 + 0.25 * (high - low)).clamp(9.0, 25.0) as usize;
    let count = count - (count + 1) % 2;
    (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect()
}
