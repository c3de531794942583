//! Crop and orientation that a file asks for.

use super::directory::Directory;
use super::finish::Crop;
use super::rejection::Rejection;
use super::tags;
use crate::orientation::Orientation;

/// The part of the active area that is the picture, in whole pixels; none if it is all of it.
///
/// # Errors
/// [`Rejection`] for a part that is not inside.
pub fn crop(raw: &Directory<'_>, (height, width): (usize, usize)) -> Result<Option<Crop>, Rejection> {
    let whole = [0.0, 0.0, height as f64, width as f64];
    let [left, top] = raw.exactly::<2>(tags::CROP_ORIGIN)?.unwrap_or([0.0; 2]);
    let [columns, rows] =
        raw.exactly::<2>(tags::CROP_SIZE)?.unwrap_or([width as f64 - left, height as f64 - top]);
    let crop = [top, left, top + rows, left + columns];
    if !is_inside(crop, whole) {
        let (tag, found) = if raw.has(tags::CROP_SIZE) {
            (tags::CROP_SIZE, [columns, rows])
        } else {
            (tags::CROP_ORIGIN, [left, top])
        };
        let expected = format!("a part of the active area of {width} columns and {height} rows");
        return Err(Rejection::wrong(tag, &found, expected));
    }
    let shares = raw.exactly::<4>(tags::USER_CROP)?.unwrap_or([0.0, 0.0, 1.0, 1.0]);
    if !is_inside(shares, [0.0, 0.0, 1.0, 1.0]) {
        let expected = "top, left, bottom, right as shares of the default crop";
        return Err(Rejection::wrong(tags::USER_CROP, &shares, expected));
    }
    // Origin and size are rounded each, as Adobe's SDK has it.
    let [top, left, rows, columns] = [top, left, rows, columns].map(f64::round);
    let corner = |at: usize| {
        [top + (shares[at] * rows).round(), left + (shares[at + 1] * columns).round()].map(|v| v as usize)
    };
    let [from, to] = [corner(0), corner(2)];
    // An odd last row or column of the active area is no part of the frame.
    let end = [to[0].min(height & !1), to[1].min(width & !1)];
    let [height, width] = [height & !1, width & !1];
    let crop = Crop {
        top: from[0],
        left: from[1],
        height: end[0].saturating_sub(from[0]),
        width: end[1].saturating_sub(from[1]),
    };
    if crop.height == 0 || crop.width == 0 {
        return Err(Rejection::wrong(tags::CROP_SIZE, &[columns, rows], "at least one whole pixel"));
    }
    Ok(Some(crop).filter(|crop| *crop != Crop { top: 0, left: 0, height, width }))
}

/// Whether a part with some extent is inside of another; both top, left, bottom, right.
fn is_inside([top, left, bottom, right]: [f64; 4], outer: [f64; 4]) -> bool {
    outer[0] <= top
        && outer[1] <= left
        && top < bottom
        && left < right
        && bottom <= outer[2]
        && right <= outer[3]
}

/// How the camera was held.
///
/// # Errors
/// [`Rejection`] for another number than 1 to 8.
pub fn orientation(first: &Directory<'_>, raw: &Directory<'_>) -> Result<Orientation, Rejection> {
    let of = if first.has(tags::ORIENTATION) { first } else { raw };
    let Some(number) = of.whole(tags::ORIENTATION)? else { return Ok(Orientation::NoTransforms) };
    let orientation = u8::try_from(number).ok().and_then(Orientation::from_exif);
    orientation.ok_or_else(|| Rejection::wrong(tags::ORIENTATION, &[number as f64], "1 to 8"))
}
