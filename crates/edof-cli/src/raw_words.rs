//! Values of options on the words of raw files, which several commands take.

use crate::error::Error;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use edof_core::CfaPhase;
use edof_io::packing::{ByteOrder, Packing};
use edof_io::pixel_format::{PixelFormat, filter_named};
use edof_io::raw::Alignment;

/// Packing, colour filter and bits of pixels, as far as options state them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pixels {
    pub packing: Option<Packing>,
    pub phase: Option<CfaPhase>,
    pub depth: Option<u32>,
}

/// A value of `--packing` or `--phase`, and what it states. A camera's name for its pixels states more than the option asks for.
#[derive(Debug, Clone)]
pub struct PixelWord {
    pub word: String,
    pub pixels: Pixels,
}

/// Reads `--packing`.
///
/// # Errors
/// What a packing may be.
pub fn packing(word: &str) -> Result<PixelWord, String> {
    let own = |packing| Pixels { packing: Some(packing), ..Pixels::default() };
    pixel_word(word, word.parse().map(own))
}

/// Reads `--phase`.
///
/// # Errors
/// What a phase may be.
pub fn phase(word: &str) -> Result<PixelWord, String> {
    let own = |phase| Pixels { phase: Some(phase), ..Pixels::default() };
    pixel_word(word, filter_named(word).map_or_else(|| word.parse(), Ok).map(own))
}

/// Returns what a word states: the option's own values first, then the names of cameras.
fn pixel_word<E: std::fmt::Display>(word: &str, own: Result<Pixels, E>) -> Result<PixelWord, String> {
    // Packed pixels have as many bits as their packing states.
    let named = |PixelFormat { packing, phase, bits }| Pixels {
        packing: Some(packing),
        phase: Some(phase),
        depth: packing.is_words().then_some(bits),
    };
    let pixels = own.or_else(|error| {
        let expected = "or a camera's name for its pixels, such as BayerRG12p or pRCC (docs/stream.md)";
        PixelFormat::named(word).map(named).ok_or_else(|| format!("{error}, {expected}"))
    })?;
    Ok(PixelWord { word: word.to_owned(), pixels })
}

impl Pixels {
    /// Returns what is stated here, else there.
    fn or(self, other: Self) -> Self {
        Self {
            packing: self.packing.or(other.packing),
            phase: self.phase.or(other.phase),
            depth: self.depth.or(other.depth),
        }
    }

    /// Returns how many things are stated.
    fn count(self) -> usize {
        [self.packing.is_some(), self.phase.is_some(), self.depth.is_some()]
            .into_iter()
            .filter(|is| *is)
            .count()
    }

    /// Returns the first thing, in words, that is stated here and otherwise there.
    fn unlike(self, other: Self) -> Option<String> {
        fn unlike<T: PartialEq>(one: Option<T>, other: Option<T>) -> Option<T> {
            one.zip(other).filter(|(one, other)| one != other).map(|(one, _)| one)
        }
        let packing = unlike(self.packing, other.packing).map(|packing| packing.name().to_owned());
        let phase = || unlike(self.phase, other.phase).map(|phase| phase.to_string());
        let depth = || unlike(self.depth, other.depth).map(|depth| format!("{depth} bits"));
        packing.or_else(phase).or_else(depth)
    }
}

/// Returns what `--packing`, `--phase` and `--bit-depth` state together.
///
/// # Errors
/// An option that contradicts a camera's name for its pixels.
pub fn pixels(
    packing: Option<&PixelWord>,
    phase: Option<&PixelWord>,
    depth: Option<u32>,
) -> Result<Pixels, Error> {
    let word = |option, word: Option<&PixelWord>| word.map(|own| (option, own.word.clone(), own.pixels));
    let bits = depth.map(|bits| ("--bit-depth", bits.to_string(), Pixels { depth, ..Pixels::default() }));
    let stated: Vec<_> =
        [word("--packing", packing), word("--phase", phase), bits].into_iter().flatten().collect();
    for (place, one) in stated.iter().enumerate() {
        for other in &stated[place + 1..] {
            // A name that states more stays.
            let [(option, value, pixels), (name, word, all)] =
                if one.2.count() > other.2.count() { [other, one] } else { [one, other] };
            if let Some(stated) = all.unlike(*pixels) {
                return Err(Error::message(format!(
                    "{option} {value}: {name} {word} states {stated}; leave {option} out"
                )));
            }
        }
    }
    Ok(stated.into_iter().fold(Pixels::default(), |all, (.., own)| all.or(own)))
}

/// Rejects a packing that `--phase` states of files that may have a header.
///
/// # Errors
/// The option, and what to state instead.
pub fn check_header(phase: Option<&PixelWord>, is_headerless: bool) -> Result<(), Error> {
    match phase {
        Some(PixelWord { word, pixels: Pixels { packing: Some(_), phase: Some(phase), .. } })
            if !is_headerless =>
        {
            Err(Error::message(format!(
                "--phase {word}: states a packing, which only files without a header have; state their --size, or give --phase {phase}"
            )))
        }
        _ => Ok(()),
    }
}

/// Reads `--align`.
pub fn alignment() -> impl TypedValueParser<Value = Alignment> {
    PossibleValuesParser::new(["top", "bottom"])
        .map(|word| if word == "top" { Alignment::Top } else { Alignment::Bottom })
}

/// Reads `--order`.
pub fn byte_order() -> impl TypedValueParser<Value = ByteOrder> {
    PossibleValuesParser::new(["little", "big"])
        .map(|word| if word == "big" { ByteOrder::Big } else { ByteOrder::Little })
}

/// Rejects an order of bytes that has no effect on a packing.
///
/// # Errors
/// The option, and what to do.
pub fn check_order(order: ByteOrder, packing: Packing) -> Result<(), Error> {
    if order == ByteOrder::default() || packing == Packing::Words {
        return Ok(());
    }
    Err(Error::message(format!(
        "--order big: has no effect on {}, which has no words; leave --order out, or use --packing words",
        packing.name()
    )))
}
