//! Names that cameras and their drivers have for the pixels of raw Bayer frames.
//!
//! | names | packed pixels | source |
//! |---|---|---|
//! | `BayerRG12`, `BayerRG12p` | `p`: one stream of bits, lowest first | PFNC of GenICam |
//! | `BayerRG12Packed` | low nibbles of both pixels between their high bytes | GigE Vision |
//! | `RG12`, `pRCC` | `p`: as MIPI CSI-2 packs them | V4L2's codes |
//! | `SRGGB12`, `SRGGB12P`, `SRGGB12_CSI2P` | `P`: as MIPI CSI-2 packs them | V4L2's constants without `V4L2_PIX_FMT_`, libcamera |
//!
//! The letters' case counts only in V4L2's codes that differ in nothing else (`pgAA` and `pGAA`).

use crate::packing::Packing;
use edof_core::CfaPhase;

/// What a name states of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelFormat {
    /// Packing of the pixels.
    pub packing: Packing,
    /// Colour filter of the first pixel.
    pub phase: CfaPhase,
    /// Bits of the sensor's values.
    pub bits: u32,
}

/// Packings and bits of V4L2's codes.
const PIXELS: [(Packing, u32); 7] = [
    (Packing::Bytes, 8),
    (Packing::Words, 10),
    (Packing::Words, 12),
    (Packing::Words, 14),
    (Packing::Words, 16),
    (Packing::Mipi10, 10),
    (Packing::Mipi12, 12),
];

/// V4L2's codes of each phase, in the order of [`PIXELS`].
const CODES: [(CfaPhase, [&str; PIXELS.len()]); 4] = [
    (CfaPhase::Rggb, ["RGGB", "RG10", "RG12", "RG14", "RG16", "pRAA", "pRCC"]),
    (CfaPhase::Grbg, ["GRBG", "BA10", "BA12", "GR14", "GR16", "pgAA", "pgCC"]),
    (CfaPhase::Gbrg, ["GBRG", "GB10", "GB12", "GB14", "GB16", "pGAA", "pGCC"]),
    (CfaPhase::Bggr, ["BA81", "BG10", "BG12", "BG14", "BYR2", "pBAA", "pBCC"]),
];

impl PixelFormat {
    /// Returns what a name states, if it is one of pixels that can be read.
    ///
    /// ```
    /// use edof_core::CfaPhase;
    /// use edof_io::packing::Packing;
    /// use edof_io::pixel_format::PixelFormat;
    /// let format = PixelFormat { packing: Packing::Bits12, phase: CfaPhase::Grbg, bits: 12 };
    /// assert_eq!(PixelFormat::named("BayerGR12p"), Some(format));
    /// assert_eq!(PixelFormat::named("BayerGR12pmsb"), None);
    /// ```
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let lower = name.to_ascii_lowercase();
        of_code(name).or_else(|| of_camera(&lower)).or_else(|| of_driver(&lower))
    }
}

/// Returns the phase that a name of the filter alone states: `BayerRG`, as in GenICam's `PixelColorFilter`.
#[must_use]
pub fn filter_named(name: &str) -> Option<CfaPhase> {
    bayer(&name.to_ascii_lowercase()).filter(|(_, pixels)| pixels.is_empty()).map(|(phase, _)| phase)
}

/// Reads a code of V4L2.
fn of_code(name: &str) -> Option<PixelFormat> {
    let format = |phase| move |(code, (packing, bits))| (code, PixelFormat { packing, phase, bits });
    let codes = CODES.into_iter().flat_map(|(phase, codes)| codes.into_iter().zip(PIXELS).map(format(phase)));
    let alike: Vec<(&str, PixelFormat)> = codes.filter(|(code, _)| code.eq_ignore_ascii_case(name)).collect();
    match alike[..] {
        [(_, one)] => Some(one),
        _ => alike.into_iter().find(|(code, _)| *code == name).map(|(_, format)| format),
    }
}

/// Reads a name in lower case of GenICam or GigE Vision.
fn of_camera(name: &str) -> Option<PixelFormat> {
    let (phase, pixels) = bayer(name)?;
    let (packing, bits) = match pixels {
        "10p" => (Packing::Bits10, 10),
        "12p" => (Packing::Bits12, 12),
        "12packed" => (Packing::Packed12, 12),
        bits => unpacked(bits)?,
    };
    Some(PixelFormat { packing, phase, bits })
}

/// Reads a name in lower case of V4L2's constants or libcamera.
fn of_driver(name: &str) -> Option<PixelFormat> {
    let name = name.strip_prefix('s')?;
    let phase = CfaPhase::ALL.into_iter().find(|phase| name.starts_with(&phase.to_string()))?;
    let (packing, bits) = match name.strip_prefix(&phase.to_string())? {
        "10p" | "10_csi2p" => (Packing::Mipi10, 10),
        "12p" | "12_csi2p" => (Packing::Mipi12, 12),
        bits => unpacked(bits)?,
    };
    Some(PixelFormat { packing, phase, bits })
}

/// Reads the phase at the beginning of a name in lower case of GenICam, and returns the rest.
fn bayer(name: &str) -> Option<(CfaPhase, &str)> {
    let name = name.strip_prefix("bayer")?;
    let rest = |phase: CfaPhase| name.strip_prefix(&phase.to_string()[..2]).map(|rest| (phase, rest));
    CfaPhase::ALL.into_iter().find_map(rest)
}

/// Reads the bits of pixels in bytes or words of their own.
fn unpacked(bits: &str) -> Option<(Packing, u32)> {
    match bits {
        "8" => Some((Packing::Bytes, 8)),
        "10" | "12" | "14" | "16" => Some((Packing::Words, bits.parse().ok()?)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Option<(&'static str, String, u32)> {
        PixelFormat::named(name).map(|format| (format.packing.name(), format.phase.to_string(), format.bits))
    }

    #[test]
    fn names_of_cameras_and_drivers_state_packing_phase_and_bits() {
        for (names, packing, phase, bits) in [
            ("BayerRG8 bayerrg8 RGGB SRGGB8", "bytes", "rggb", 8),
            ("BayerGR10 BA10 ba10 SGRBG10", "words", "grbg", 10),
            ("BayerGB12 GB12 SGBRG12", "words", "gbrg", 12),
            ("BayerBG14 BG14 SBGGR14", "words", "bggr", 14),
            ("BayerBG16 BYR2 SBGGR16", "words", "bggr", 16),
            ("BayerBG10p", "10p", "bggr", 10),
            ("BayerGR12p BAYERGR12P", "12p", "grbg", 12),
            ("BayerGB12Packed", "12packed", "gbrg", 12),
            ("pRAA praa SRGGB10P SRGGB10_CSI2P", "mipi10", "rggb", 10),
            ("pgCC SGRBG12P SGRBG12_CSI2P", "mipi12", "grbg", 12),
            ("pGCC SGBRG12P", "mipi12", "gbrg", 12),
        ] {
            for name in names.split(' ') {
                assert_eq!(named(name), Some((packing, phase.to_owned(), bits)), "{name}");
            }
        }
    }

    #[test]
    fn every_name_in_the_tables_of_the_page_is_read_as_they_state() {
        let page = include_str!("../../../docs/stream.md");
        let rows = page.lines().filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
        let mut read = 0;
        for (first, rest) in rows {
            let cells: Vec<&str> = rest.split('|').collect();
            let (cells, phase, packing) = match (first.parse::<CfaPhase>(), first.parse::<Packing>()) {
                (Ok(phase), _) => (&cells[3..4], phase, None),
                (_, Ok(packing)) => (&cells[1..4], CfaPhase::Rggb, Some(packing)),
                _ => continue,
            };
            for name in cells.iter().flat_map(|cell| cell.split('`').skip(1).step_by(2)) {
                let format = PixelFormat::named(name).expect(name);
                assert_eq!(
                    (format.phase, packing.unwrap_or(format.packing)),
                    (phase, format.packing),
                    "{name}"
                );
                read += 1;
            }
        }
        assert_eq!(read, 4 * 7 + 5 * 3 + 2 * 2 + 3);
    }

    #[test]
    fn what_is_not_read_or_stands_for_two_phases_has_no_name() {
        for name in [
            "BayerRG10Packed",
            "BayerRG14p",
            "BayerRG12pmsb",
            "pREE",
            "SRGGB14P",
            "Mono12p",
            "BayerRG",
            "pGcc",
            "PGAA",
            "12p",
            "",
        ] {
            assert_eq!(named(name), None, "{name}");
        }
        assert_eq!(filter_named("BayerGB"), Some(CfaPhase::Gbrg));
        assert_eq!(["BayerRG8", "RG", "BayerXX"].map(filter_named), [None; 3]);
    }
}
