//! The mask in a lens's pupil: a list of terms whose phases add.
//!
//! A kind of term is a file here that implements [`PhaseTerm`], and a line in the list of [`Term`]. Nothing else names a kind but what makes
//! one: camera files, PSFs, derivatives, joint searches, tolerances and Python ask the terms.

pub mod glass;
pub mod height_map;
pub mod phase;
mod polynomial;
mod profile;
mod ring;
mod zernike;

pub use height_map::HeightMap;
pub use polynomial::{Monomial, Polynomial};
pub use profile::Profile;
pub use ring::{Delay, Ring};
pub use zernike::{Aberration, Zernike};

use phase::PhaseTerm;
use serde::{Deserialize, Serialize};
use std::ops::{Deref, DerefMut};

macro_rules! terms {
    ($($(#[$doc:meta])* $kind:ident),* $(,)?) => {
        /// One term of a mask's phase.
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Term {
            $($(#[$doc])* $kind($kind)),*
        }

        impl Deref for Term {
            type Target = dyn PhaseTerm;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$kind(term) => term),*
                }
            }
        }

        impl DerefMut for Term {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $(Self::$kind(term) => term),*
                }
            }
        }

        $(impl From<$kind> for Term {
            fn from(term: $kind) -> Self {
                Self::$kind(term)
            }
        })*
    };
}

terms! {
    /// Constant phase between two radii.
    Ring,
    /// A phase that changes smoothly with the radius.
    Profile,
    /// A surface of any shape, as a picture.
    HeightMap,
    /// A sum of Zernike polynomials.
    Zernike,
    /// A polynomial of the place, as in cubic masks.
    Polynomial,
}

/// The terms of a mask: rings first, then profiles, then height maps, then all others; terms of one kind in the order in which they were given.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mask(Vec<Term>);

impl Mask {
    /// The terms, in order.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.0
    }

    /// The terms, in order, to be changed.
    pub fn terms_mut(&mut self) -> &mut [Term] {
        &mut self.0
    }

    /// The terms as values.
    #[must_use]
    pub fn into_terms(self) -> Vec<Term> {
        self.0
    }

    /// Adds a term.
    pub fn add(&mut self, term: impl Into<Term>) {
        self.0.push(term.into());
        self.0.sort_by_key(place);
    }

    /// The rings.
    pub fn rings(&self) -> impl Iterator<Item = &Ring> {
        self.0.iter().filter_map(|term| if let Term::Ring(ring) = term { Some(ring) } else { None })
    }

    /// The rings, to be changed.
    pub fn rings_mut(&mut self) -> impl Iterator<Item = &mut Ring> {
        self.0.iter_mut().filter_map(|term| if let Term::Ring(ring) = term { Some(ring) } else { None })
    }

    /// The height maps.
    pub fn height_maps(&self) -> impl Iterator<Item = &HeightMap> {
        self.0.iter().filter_map(|term| if let Term::HeightMap(map) = term { Some(map) } else { None })
    }

    /// The height maps, to be read.
    pub fn height_maps_mut(&mut self) -> impl Iterator<Item = &mut HeightMap> {
        self.0.iter_mut().filter_map(|term| if let Term::HeightMap(map) = term { Some(map) } else { None })
    }
}

/// Place of a term's kind in a [`Mask`].
const fn place(term: &Term) -> u8 {
    match term {
        Term::Ring(_) => 0,
        Term::Profile(_) => 1,
        Term::HeightMap(_) => 2,
        _ => 3,
    }
}

impl<T: Into<Term>> FromIterator<T> for Mask {
    fn from_iter<I: IntoIterator<Item = T>>(terms: I) -> Self {
        let mut terms: Vec<Term> = terms.into_iter().map(Into::into).collect();
        terms.sort_by_key(place);
        Self(terms)
    }
}
