//! How exactly PSFs are computed.

use edof_core::words::number;

/// How exactly PSFs are computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Share of the energy that a cut kernel keeps, 0…1; at 1 nothing is cut.
    pub energy: f64,
    /// Share of the energy that may lie wrong because a spectrum is sampled at few wavelengths; at 0 it is sampled at the most.
    pub wavelength_tolerance: f64,
    /// Nothing left out: the whole computed support, and as many wavelengths as the program ever takes.
    pub exact: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { energy: 0.999, wavelength_tolerance: 0.01, exact: false }
    }
}

/// Settings that no PSF is computed by.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// No share.
    #[error("energy {}: must be more than 0 and at most 1", number(*.0))]
    Energy(f64),
    /// Negative, or more than all.
    #[error("wavelength-tolerance {}: must be 0 or more", number(*.0))]
    Wavelengths(f64),
    /// More than all of the energy.
    #[error("wavelength-tolerance {}: a share, must be 0 to 1", number(*.0))]
    Share(f64),
    /// Of a capture: negative, or no number.
    #[error("depth-tolerance {}: must be 0 or more", number(*.0))]
    Depths(f64),
}

impl Settings {
    /// # Errors
    /// [`SettingsError`] for shares outside of 0…1.
    pub fn check(&self) -> Result<(), SettingsError> {
        if !(self.energy > 0.0 && self.energy <= 1.0) {
            return Err(SettingsError::Energy(self.energy));
        }
        match self.wavelength_tolerance {
            share if !(share.is_finite() && share >= 0.0) => Err(SettingsError::Wavelengths(share)),
            share if share > 1.0 => Err(SettingsError::Share(share)),
            _ => Ok(()),
        }
    }

    /// Nothing left out.
    #[must_use]
    pub fn exact() -> Self {
        Self { exact: true, ..Self::default() }
    }

    pub(super) fn cuts_kernels(&self) -> bool {
        !self.exact && self.energy < 1.0
    }

    pub(super) fn cuts_wavelengths(&self) -> bool {
        !self.exact && self.wavelength_tolerance > 0.0
    }
}
