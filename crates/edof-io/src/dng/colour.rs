//! From the sensor's colours to linear sRGB: the neutral of the shot, and the calibration for daylight.

use super::Overrides;
use super::directory::Directory;
use super::rejection::Rejection;
use super::tags::{self, Tag};
use crate::rendering::{ColourMatrix, Rendering, WhiteBalance};

type Matrix = [[f64; 3]; 3];

/// Linear sRGB from XYZ under D50 (Bradford), the colours of a forward matrix.
const SRGB_FROM_D50: Matrix = [
    [3.133_856_1, -1.616_866_7, -0.490_614_6],
    [-0.978_768_4, 1.916_141_5, 0.033_454_0],
    [0.071_945_3, -0.228_991_4, 1.405_242_7],
];
/// XYZ under D65 from linear sRGB.
pub(super) const D65_FROM_SRGB: Matrix = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];
const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Correlated colour temperature of D65.
const DAYLIGHT: f64 = 6504.0;

/// Tags of one calibration.
struct Calibration {
    illuminant: Tag,
    data: Tag,
    colour: Tag,
    camera: Tag,
    forward: Tag,
}

const CALIBRATIONS: [Calibration; 3] = [
    Calibration {
        illuminant: tags::ILLUMINANT_1,
        data: tags::ILLUMINANT_DATA_1,
        colour: tags::COLOUR_MATRIX_1,
        camera: tags::CALIBRATION_1,
        forward: tags::FORWARD_MATRIX_1,
    },
    Calibration {
        illuminant: tags::ILLUMINANT_2,
        data: tags::ILLUMINANT_DATA_2,
        colour: tags::COLOUR_MATRIX_2,
        camera: tags::CALIBRATION_2,
        forward: tags::FORWARD_MATRIX_2,
    },
    Calibration {
        illuminant: tags::ILLUMINANT_3,
        data: tags::ILLUMINANT_DATA_3,
        colour: tags::COLOUR_MATRIX_3,
        camera: tags::CALIBRATION_3,
        forward: tags::FORWARD_MATRIX_3,
    },
];

/// Temperatures of Exif's light sources, as the colour science of DNG takes them.
const TEMPERATURES: [(usize, f64); 20] = [
    (1, 5500.0),
    (2, 4150.0),
    (3, 2850.0),
    (4, 5500.0),
    (9, 5500.0),
    (10, 6500.0),
    (11, 7500.0),
    (12, 6400.0),
    (13, 5050.0),
    (14, 4150.0),
    (15, 3525.0),
    (16, 2925.0),
    (17, 2850.0),
    (18, 5500.0),
    (19, 6500.0),
    (20, 5500.0),
    (21, 6504.0),
    (22, 7500.0),
    (23, 5000.0),
    (24, 3200.0),
];
/// The light source whose chromaticity a tag of its own has.
const OTHER: usize = 255;

/// What helps where a calibration cannot be used.
const INSTEAD: &str = "or state the white balance and the colour matrix";

/// Where a frame's colours are described: the file's first directory, else its own.
pub struct Described<'a, 'd>(pub [&'d Directory<'a>; 2]);

impl<'a> Described<'a, '_> {
    fn exactly<const N: usize>(&self, tag: Tag) -> Result<Option<[f64; N]>, Rejection> {
        self.0.iter().find(|directory| directory.has(tag)).map_or(Ok(None), |found| found.exactly(tag))
    }

    fn matrix(&self, tag: Tag) -> Result<Option<Matrix>, Rejection> {
        let rows =
            |all: [f64; 9]| std::array::from_fn(|row| std::array::from_fn(|column| all[3 * row + column]));
        Ok(self.exactly::<9>(tag)?.map(rows))
    }

    fn bytes(&self, tag: Tag) -> Result<&'a [u8], Rejection> {
        let found = self.0.iter().find(|directory| directory.has(tag));
        let bytes = found.map_or(Ok(None), |found| found.bytes(tag))?.unwrap_or_default();
        // Writers end a text by one zero byte or several.
        Ok(bytes.iter().rposition(|byte| *byte != 0).map_or(&[], |last| &bytes[..=last]))
    }

    /// The temperature of a calibration's light, if it is known.
    fn temperature(&self, of: &Calibration) -> Result<Option<f64>, Rejection> {
        let Some([source]) = self.exactly::<1>(of.illuminant)? else { return Ok(None) };
        if source == OTHER as f64 {
            let found = self.0.iter().find(|directory| directory.has(of.data));
            return Ok(found.map_or(Ok(None), |found| found.chromaticity(of.data))?.map(temperature_of));
        }
        Ok(TEMPERATURES.iter().find(|(code, _)| *code as f64 == source).map(|(_, kelvin)| *kelvin))
    }

    /// The calibration whose light is nearest to daylight, by reciprocal temperature; without any known light the last.
    fn daylight(&self) -> Result<Option<&'static Calibration>, Rejection> {
        let mut best: Option<(f64, &Calibration)> = None;
        for calibration in &CALIBRATIONS {
            if self.exactly::<9>(calibration.colour)?.is_none()
                && self.exactly::<9>(calibration.forward)?.is_none()
            {
                continue;
            }
            let kelvin = self.temperature(calibration)?;
            let distance = kelvin.map_or(f64::INFINITY, |kelvin| (1.0 / kelvin - 1.0 / DAYLIGHT).abs());
            // The second of two unknown lights is daylight in most files.
            let is_better = |least: f64| distance < least || (distance == least && kelvin.is_none());
            if best.as_ref().is_none_or(|(least, _)| is_better(*least)) {
                best = Some((distance, calibration));
            }
        }
        Ok(best.map(|(_, calibration)| calibration))
    }

    /// Balance of the analog gains times the calibration of this copy of the camera.
    fn individual(&self, of: &Calibration) -> Result<Matrix, Rejection> {
        let gains = self.exactly::<3>(tags::ANALOG_BALANCE)?.unwrap_or([1.0; 3]);
        if gains.iter().any(|gain| *gain <= 0.0) {
            let expected = format!("three numbers above 0; {INSTEAD}");
            return Err(Rejection::wrong(tags::ANALOG_BALANCE, &gains, expected));
        }
        let is_for_profile =
            self.bytes(tags::CALIBRATION_SIGNATURE)? == self.bytes(tags::PROFILE_SIGNATURE)?;
        let camera = self.matrix(of.camera)?.filter(|_| is_for_profile).unwrap_or(IDENTITY);
        if inverse(camera).is_none() {
            let expected = format!("a matrix that can be inverted; {INSTEAD}");
            return Err(Rejection::wrong(of.camera, camera.as_flattened(), expected));
        }
        Ok(product(diagonal(gains), camera))
    }

    /// What the sensor sees of white, in any unit.
    fn neutral(&self) -> Result<Option<[f64; 3]>, Rejection> {
        let expected = "three numbers above 0; or state the white balance";
        let is_possible = |neutral: &[f64]| neutral.iter().all(|v| v.is_finite() && *v > 0.0);
        if let Some(found) = self.0.iter().find(|directory| directory.has(tags::NEUTRAL)) {
            let numbers = found.numbers(tags::NEUTRAL)?.unwrap_or_default();
            return match <[f64; 3]>::try_from(&numbers[..]) {
                Ok(neutral) if is_possible(&neutral) => Ok(Some(neutral)),
                _ => Err(Rejection::wrong(tags::NEUTRAL, &numbers, expected)),
            };
        }
        let Some([x, y]) = self.exactly::<2>(tags::WHITE_XY)? else { return Ok(None) };
        let Some(calibration) = self.daylight()? else { return Ok(None) };
        let Some(colour) = self.matrix(calibration.colour)? else { return Ok(None) };
        let camera = product(self.individual(calibration)?, colour);
        let neutral = times(camera, [x / y, 1.0, (1.0 - x - y) / y]);
        if is_possible(&neutral) {
            Ok(Some(neutral))
        } else {
            let expected = "x and y of a white that the sensor sees; or state the white balance";
            Err(Rejection::wrong(tags::WHITE_XY, &[x, y], expected))
        }
    }
}

/// White balance and matrix of a frame. The balance is one over what the sensor sees of white. The matrix is that of the calibration for
/// the light nearest to daylight: forward to XYZ where it has one, else from XYZ, each of its rows scaled so that white is white (as LibRaw
/// does), and inverted.
///
/// # Errors
/// [`Rejection`] for colours that are no colours.
pub fn rendering(described: &Described<'_, '_>, overrides: &Overrides) -> Result<Rendering, Rejection> {
    let white_balance = match overrides.white_balance {
        Some(stated) => Some(stated),
        None => {
            let balance = |neutral: [f64; 3]| {
                let wrong = |_| Rejection::wrong(tags::NEUTRAL, &neutral, "three numbers of at least 0.01");
                WhiteBalance::try_from(neutral.map(|share| 1.0 / share)).map_err(wrong)
            };
            described.neutral()?.map(balance).transpose()?
        }
    };
    let matrix = match overrides.matrix {
        Some(stated) => Some(stated),
        None => matrix(described, white_balance)?,
    };
    Ok(Rendering { white_balance, matrix })
}

/// What light a shot was taken in, where it is nearer to that of another calibration than of the one that is taken.
///
/// # Errors
/// As [`rendering`].
pub fn other_light(described: &Described<'_, '_>) -> Result<Option<String>, Rejection> {
    let Some(chosen) = described.daylight()? else { return Ok(None) };
    let (Some(colour), Some(neutral)) = (described.matrix(chosen.colour)?, described.neutral()?) else {
        return Ok(None);
    };
    let camera = product(described.individual(chosen)?, colour);
    let Some([x, y, z]) = inverse(camera).map(|xyz| times(xyz, neutral)) else { return Ok(None) };
    let shot = temperature_of([x / (x + y + z), y / (x + y + z)]);
    if !(1000.0..=50_000.0).contains(&shot) {
        return Ok(None);
    }
    let (own, mut others) = (described.temperature(chosen)?, vec![]);
    for other in &CALIBRATIONS {
        if described.exactly::<9>(other.colour)?.is_some() || described.exactly::<9>(other.forward)?.is_some()
        {
            others.extend(described.temperature(other)?);
        }
    }
    let distance = |kelvin: f64| (1.0 / kelvin - 1.0 / shot).abs();
    let nearer = |own: f64| {
        let nearer = others.into_iter().filter(|other| distance(*other) < distance(own));
        nearer.min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
    };
    Ok(own.and_then(|own| Some((own, nearer(own)?))).map(|(own, other)| {
        format!(
            "was taken in light of about {:.0} K, nearer to its calibration for {other:.0} K than to that for {own:.0} K, which is taken \
             as for every shot; state the colour matrix for other colours",
            (shot / 100.0).round() * 100.0
        )
    }))
}

fn matrix(
    described: &Described<'_, '_>,
    white_balance: Option<WhiteBalance>,
) -> Result<Option<ColourMatrix>, Rejection> {
    let Some(calibration) = described.daylight()? else { return Ok(None) };
    let individual = described.individual(calibration)?;
    let singular = |tag, of: Matrix| {
        move || {
            Rejection::wrong(
                tag,
                of.as_flattened(),
                "a matrix that can be inverted; or state the colour matrix",
            )
        }
    };
    let (tag, rows) = if let Some(forward) = described.matrix(calibration.forward)? {
        let neutral =
            white_balance.map_or([1.0; 3], |balance| <[f64; 3]>::from(balance).map(|gain| 1.0 / gain));
        let reference = inverse(individual).ok_or_else(singular(calibration.camera, individual))?;
        let balance = diagonal(times(reference, neutral).map(|share| 1.0 / share));
        let balanced = product(product(balance, reference), diagonal(neutral));
        (calibration.forward, scaled(product(SRGB_FROM_D50, product(forward, balanced))))
    } else if let Some(colour) = described.matrix(calibration.colour)? {
        let seen = product(product(individual, colour), D65_FROM_SRGB);
        (calibration.colour, inverse(scaled(seen)).ok_or_else(singular(calibration.colour, colour))?)
    } else {
        return Ok(None);
    };
    let wrong = |_| Rejection::wrong(tag, rows.as_flattened(), "a matrix that keeps white white");
    ColourMatrix::try_from(rows).map(Some).map_err(wrong)
}

/// McCamy's correlated colour temperature of a chromaticity.
fn temperature_of([x, y]: [f64; 2]) -> f64 {
    let n = (x - 0.3320) / (0.1858 - y);
    449.0 * n.powi(3) + 3525.0 * n.powi(2) + 6823.3 * n + 5520.33
}

pub(super) fn product(a: Matrix, b: Matrix) -> Matrix {
    a.map(|row| std::array::from_fn(|column| (0..3).map(|i| row[i] * b[i][column]).sum()))
}

fn times(m: Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| (0..3).map(|i| row[i] * v[i]).sum())
}

fn diagonal(v: [f64; 3]) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| if row == column { v[row] } else { 0.0 }))
}

/// Rows scaled to add up to 1.
fn scaled(matrix: Matrix) -> Matrix {
    matrix.map(|row| row.map(|v| v / row.iter().sum::<f64>()))
}

fn inverse(m: Matrix) -> Option<Matrix> {
    let minor = |row: usize, column: usize| {
        let [r, s] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    let determinant: f64 = (0..3).map(|column| m[0][column] * minor(0, column)).sum();
    (determinant.abs() > 1e-9)
        .then(|| std::array::from_fn(|row| std::array::from_fn(|column| minor(column, row) / determinant)))
}
