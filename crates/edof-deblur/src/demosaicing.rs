//! Demosaicing methods by name.

use crate::{Directional, Malvar};
use edof_core::Reconstructor;
use edof_core::words::alternatives;

/// A demosaicing method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Demosaicing {
    /// Linear filters ([`Malvar`]).
    Malvar,
    /// Along edges instead of across them ([`Directional`]).
    Directional,
}

impl Demosaicing {
    /// All methods.
    pub const ALL: [Self; 2] = [Self::Malvar, Self::Directional];

    /// Returns the name by which options and arguments select the method.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Malvar => "malvar",
            Self::Directional => "directional",
        }
    }

    /// Returns the method, ready for frames.
    #[must_use]
    pub fn reconstructor(self) -> Box<dyn Reconstructor + Send> {
        match self {
            Self::Malvar => Box::new(Malvar::default()),
            Self::Directional => Box::new(Directional::default()),
        }
    }
}

/// A name of no demosaicing method.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("method '{0}': must be {names}", names = alternatives(Demosaicing::ALL.map(Demosaicing::name)))]
pub struct UnknownDemosaicing(String);

impl std::str::FromStr for Demosaicing {
    type Err = UnknownDemosaicing;

    fn from_str(name: &str) -> Result<Self, UnknownDemosaicing> {
        let named = |method: &Self| method.name() == name;
        Self::ALL.into_iter().find(named).ok_or_else(|| UnknownDemosaicing(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_known_by_name() {
        for method in Demosaicing::ALL {
            assert_eq!(method.name().parse(), Ok(method));
            assert_eq!(method.reconstructor().name(), format!("demosaic-{}", method.name()));
        }
        let error = "bilinear".parse::<Demosaicing>().unwrap_err().to_string();
        assert_eq!(error, "method 'bilinear': must be malvar or directional");
    }
}
