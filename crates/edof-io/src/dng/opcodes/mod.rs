//! Opcode lists: corrections that a file asks for (DNG 1.7, chapter 7). List 1 works on stored values, list 2 on the light of the mosaic,
//! list 3 on the picture.
//!
//! | opcode | module | lists |
//! |---|---|---|
//! | FixBadPixelsConstant, FixBadPixelsList | `defects` | 1, 2 |
//! | MapTable, MapPolynomial, GainMap, DeltaPerRow, DeltaPerColumn, ScalePerRow, ScalePerColumn | `pointwise` | 1, 2, 3 |
//! | FixVignetteRadial | `lens` | 2, 3 |
//! | WarpRectilinear, WarpFisheye | `lens` | 3 |
//!
//! Another opcode is left out with a note if its flag calls it optional, else the file is rejected.

mod defects;
mod lens;
mod parameters;
mod pointwise;

use super::directory::Directory;
use super::pixels::Sample;
use super::rejection::Rejection;
use super::tags::{self, Tag};
use defects::Defects;
use edof_core::{CfaPhase, ColourFrame};
use lens::{Vignette, Warp};
use ndarray::{Array2, ArrayViewMut2, Axis};
use parameters::Parameters;
use pointwise::Pointwise;

/// One of the three lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum List {
    /// On values as they are stored, the whole picture.
    Stored,
    /// On the light of the active area.
    Mosaic,
    /// On the picture of the active area, in the sensor's colours.
    Picture,
}

impl List {
    const fn tag(self) -> Tag {
        match self {
            Self::Stored => tags::OPCODES_1,
            Self::Mosaic => tags::OPCODES_2,
            Self::Picture => tags::OPCODES_3,
        }
    }
}

/// What the numbers of an opcode are measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Units {
    /// The largest value of the image.
    full: f64,
    /// A difference of one.
    delta: f64,
    /// Whether values are whole numbers, as in a list before a LinearizationTable.
    is_whole: bool,
}

impl Units {
    /// As Adobe's SDK has them: list 1 in stored numbers, the others in light of 0 to 1, differences of integer files in 65535ths of it.
    const fn of(list: List, sample: Sample) -> Self {
        let word = 65535.0;
        match (list, sample) {
            (_, Sample::Float(_)) => Self { full: 1.0, delta: 1.0, is_whole: false },
            (List::Stored, Sample::Whole(..=16)) => Self { full: word, delta: 1.0, is_whole: true },
            (List::Stored, Sample::Whole(_)) => Self { full: 4_294_967_295.0, delta: 1.0, is_whole: true },
            (_, Sample::Whole(_)) => Self { full: 1.0, delta: 1.0 / word, is_whole: false },
        }
    }

    /// A result as the image holds it.
    fn kept(self, value: f64) -> f32 {
        let value = value.clamp(0.0, self.full);
        (if self.is_whole { value.round() } else { value }) as f32
    }
}

/// A correction.
#[derive(Debug, Clone, PartialEq)]
enum Opcode {
    Defects(Defects),
    Pointwise(Pointwise),
    Vignette(Vignette),
    Warp(Warp),
    /// Keeps this part of the picture: top, left, bottom, right.
    Trim([u32; 4]),
}

/// The corrections of one list, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Opcodes {
    all: Vec<Opcode>,
    units: Units,
}

/// Names by identifier, from 1 on.
const NAMES: [&str; 14] = [
    "WarpRectilinear",
    "WarpFisheye",
    "FixVignetteRadial",
    "FixBadPixelsConstant",
    "FixBadPixelsList",
    "TrimBounds",
    "MapTable",
    "MapPolynomial",
    "GainMap",
    "DeltaPerRow",
    "DeltaPerColumn",
    "ScalePerRow",
    "ScalePerColumn",
    "WarpRectilinear2",
];

fn name(id: u32) -> String {
    let known = (id as usize).checked_sub(1).and_then(|index| NAMES.get(index));
    known.map_or_else(|| format!("opcode {id}"), |name| format!("{name} ({id})"))
}

/// Reads the list of a frame; what is left out is added to `notes`.
///
/// # Errors
/// [`Rejection`] for an opcode that is needed and not supported, or whose parameters are cut or out of range.
pub fn read(
    raw: &Directory<'_>,
    list: List,
    sample: Sample,
    notes: &mut Vec<String>,
) -> Result<Opcodes, Rejection> {
    let tag = list.tag();
    let units = Units::of(list, sample);
    let Some(bytes) = raw.bytes(tag)? else { return Ok(Opcodes { all: vec![], units }) };
    let cut = || {
        let found = format!("a list of {} bytes that ends within an opcode", bytes.len());
        Rejection::Wrong { tag, found, expected: "as many opcodes as it states".to_owned() }
    };
    let mut parameters = Parameters::new(bytes);
    let mut all = vec![];
    for _ in 0..parameters.whole().ok_or_else(cut)? {
        let id = parameters.whole().ok_or_else(cut)?;
        let version = parameters.bytes(4).ok_or_else(cut)?;
        let flags = parameters.whole().ok_or_else(cut)?;
        let length = parameters.whole().ok_or_else(cut)?;
        let content = parameters.bytes(length as usize).ok_or_else(cut)?;
        let is_newer = version > [1, 7, 1, 0].as_slice();
        let supported = if is_newer { None } else { opcode(id, list, Parameters::new(content)) };
        match supported {
            Some(Some(opcode)) => all.push(opcode),
            Some(None) => {
                let found = format!("wrong parameters of {}", name(id));
                let expected = "those of the specification".to_owned();
                return Err(Rejection::Wrong { tag, found, expected });
            }
            None if flags & 1 == 1 => notes.push(format!("{tag}: {} is optional and left out", name(id))),
            None => return Err(Rejection::value(tag, name(id), "opcodes that docs/dng.md lists for it")),
        }
    }
    Ok(Opcodes { all, units })
}

/// The correction of an identifier, if it is supported in that list; inside, none if its parameters are wrong.
fn opcode(id: u32, list: List, parameters: Parameters<'_>) -> Option<Option<Opcode>> {
    let is_mosaic = list != List::Picture;
    match id {
        1 | 2 if list == List::Picture => Some(Warp::read(id == 2, parameters).map(Opcode::Warp)),
        3 if list != List::Stored => Some(Vignette::read(parameters).map(Opcode::Vignette)),
        4 if is_mosaic => Some(Defects::constant(parameters).map(Opcode::Defects)),
        5 if is_mosaic => Some(Defects::list(parameters).map(Opcode::Defects)),
        6 => Some(parameters.wholes().map(Opcode::Trim)),
        7..=13 => Some(Pointwise::read(id, parameters).map(Opcode::Pointwise)),
        _ => None,
    }
}

impl Opcodes {
    /// Whether there is nothing to do.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Rejects parts that a trim would cut off an image of that size.
    ///
    /// # Errors
    /// [`Rejection`] naming the list.
    pub(super) fn check(&self, list: List, (height, width): (usize, usize)) -> Result<(), Rejection> {
        let whole = [0, 0, height as u32, width as u32];
        let trims = |opcode: &Opcode| matches!(opcode, Opcode::Trim(area) if *area != whole);
        if self.all.iter().any(trims) {
            let expected = format!("TrimBounds of the whole image, {height} rows and {width} columns");
            return Err(Rejection::value(list.tag(), "TrimBounds (6) of a part", expected));
        }
        Ok(())
    }

    /// Corrects a mosaic of a phase in place.
    pub(super) fn correct_mosaic(&self, mosaic: &mut Array2<f32>, phase: CfaPhase) {
        for opcode in &self.all {
            match opcode {
                Opcode::Defects(defects) => defects.repair(mosaic, phase, self.units),
                Opcode::Pointwise(pointwise) => pointwise.apply(&mut [mosaic.view_mut()], self.units),
                Opcode::Vignette(vignette) => vignette.apply(&mut [mosaic.view_mut()]),
                Opcode::Warp(_) | Opcode::Trim(_) => (),
            }
        }
    }

    /// Corrects a picture in the sensor's colours in place.
    pub fn correct_picture(&self, picture: &mut ColourFrame) {
        for opcode in &self.all {
            let mut planes: Vec<ArrayViewMut2<'_, f32>> = picture.planes.axis_iter_mut(Axis(0)).collect();
            match opcode {
                Opcode::Pointwise(pointwise) => pointwise.apply(&mut planes, self.units),
                Opcode::Vignette(vignette) => vignette.apply(&mut planes),
                Opcode::Warp(warp) => warp.apply(&mut planes),
                Opcode::Defects(_) | Opcode::Trim(_) => (),
            }
        }
    }
}
