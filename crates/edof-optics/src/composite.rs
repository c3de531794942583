//! Layers blurred tile by tile and laid over each other, of each tile only what can be seen.

use crate::psf::Psf;
use crate::tiles::{Tile, Tiles, Transfer, Workspace};
use ndarray::{Array3, ArrayView1, ArrayView2, ArrayView3, ArrayViewMut3, Axis, s};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// What lies at one depth.
pub struct Sheet<'a> {
    /// Light, planes × rows × columns, none where the matte is 0.
    pub light: ArrayView3<'a, f32>,
    /// Share of each pixel that is covered; none where all are.
    pub matte: Option<ArrayView2<'a, f32>>,
    /// What blurs each plane of the light, and the matte in front of that plane.
    pub transfers: &'a [Transfer],
}

/// The blurred planes of sheets from back to front; what lies behind one shines through where its blurred matte does not cover.
pub fn composite(tiles: &Tiles, sheets: &[Sheet]) -> Array3<f32> {
    let (height, width) = tiles.size();
    let planes = sheets.first().map_or(0, |sheet| sheet.transfers.len());
    let mut seen = Array3::zeros((planes, height, width));
    let idle: Mutex<Vec<Workspace>> = Mutex::default();
    let idle = || idle.lock().unwrap_or_else(PoisonError::into_inner);
    cut(seen.view_mut(), tiles.step()).into_par_iter().with_max_len(1).for_each(|(tile, mut part)| {
        let last = idle().pop();
        let mut space = last.unwrap_or_else(|| Workspace::new(tiles, planes));
        lay(tiles, sheets, &mut space, &tile, &mut part);
        idle().push(space);
    });
    seen
}

/// Planes, each blurred with a PSF of its own.
pub fn blurred(tiles: &Tiles, light: ArrayView3<f32>, psfs: &[Psf]) -> Array3<f32> {
    let transfers: Vec<Transfer> = psfs.iter().map(|psf| tiles.transfer(psf)).collect();
    composite(tiles, &[Sheet { light, matte: None, transfers: &transfers }])
}

/// The tiles of planes.
fn cut(planes: ArrayViewMut3<f32>, (down, across): (usize, usize)) -> Vec<(Tile, ArrayViewMut3<f32>)> {
    let (mut parts, mut top, mut below) = (vec![], 0, planes);
    while below.dim().1 > 0 {
        let rows = down.min(below.dim().1);
        let (mut right, rest) = below.split_at(Axis(1), rows);
        let mut left = 0;
        while right.dim().2 > 0 {
            let columns = across.min(right.dim().2);
            let (part, rest) = right.split_at(Axis(2), columns);
            parts.push((Tile { rows: top..top + rows, columns: left..left + columns }, part));
            (left, right) = (left + columns, rest);
        }
        (top, below) = (top + rows, rest);
    }
    parts
}

/// Blurs and lays the sheets of one tile, where nothing lies yet.
fn lay(tiles: &Tiles, sheets: &[Sheet], space: &mut Workspace, tile: &Tile, seen: &mut ArrayViewMut3<f32>) {
    let around = tiles.around(tile);
    let cover = |sheet: &Sheet| {
        sheet.matte.map_or(Cover::All, |matte| {
            Cover::of(matte.slice(s![around.rows.clone(), around.columns.clone()]))
        })
    };
    let covers: Vec<Cover> = sheets.iter().map(cover).collect();
    // A kernel's sum is 1, so behind a matte that is 1 all around nothing is seen.
    let last = covers.iter().rposition(|cover| *cover == Cover::All).unwrap_or(0);
    let visible = sheets.iter().zip(covers).skip(last).filter(|(_, cover)| *cover != Cover::None);
    for (index, (sheet, cover)) in visible.enumerate() {
        let transfers: Vec<&Transfer> = sheet.transfers.iter().collect();
        if let (Cover::Some, Some(matte), 1..) = (cover, sheet.matte, index) {
            space.blur(tiles, matte, tile, &transfers, |plane, row, covered| {
                let mut behind = seen.slice_mut(s![plane, row, ..]);
                behind.zip_mut_with(&ArrayView1::from(covered), |light, matte| *light *= 1.0 - matte);
            });
        }
        for (plane, (light, transfer)) in sheet.light.outer_iter().zip(transfers).enumerate() {
            space.blur(tiles, light, tile, &[transfer], |_, row, light| {
                let (mut all, light) = (seen.slice_mut(s![plane, row, ..]), ArrayView1::from(light));
                if index == 0 {
                    // Memory that was never read is cheaper to write.
                    all.assign(&light);
                } else {
                    all += &light;
                }
            });
        }
    }
}

/// What a matte covers of the pixels that a tile's blur looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cover {
    None,
    Some,
    All,
}

impl Cover {
    fn of(part: ArrayView2<f32>) -> Self {
        let is = |value: f32| part.rows().into_iter().all(|row| row.iter().all(|v| *v == value));
        match part.first() {
            Some(0.0) if is(0.0) => Self::None,
            Some(1.0) if is(1.0) => Self::All,
            _ => Self::Some,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::{direct, kernel, picture};
    use ndarray::{Array2, stack};
    use proptest::prelude::*;

    #[test]
    fn what_cannot_be_seen_is_not_looked_at() {
        let (psf, tiles) = (kernel(2, true), Tiles::with_periods((30, 40), 2, (16, 16)));
        let (light, transfers) = (picture(30, 40, 5).insert_axis(Axis(0)), [tiles.transfer(&psf)]);
        let dark = Array3::from_elem((1, 30, 40), f32::NAN);
        let sheet = |light, matte| Sheet { light, matte, transfers: &transfers };
        let [none, all] = [0.0, 1.0].map(|cover| Array2::from_elem((30, 40), cover));
        let hidden = [
            sheet(dark.view(), None),
            sheet(light.view(), Some(all.view())),
            sheet(dark.view(), Some(none.view())),
        ];
        assert_eq!(composite(&tiles, &hidden), blurred(&tiles, light.view(), &[psf]));
    }

    #[test]
    fn half_of_what_lies_behind_a_matte_of_one_half_shines_through() {
        let (psf, tiles) = (kernel(2, true), Tiles::with_periods((30, 40), 2, (16, 16)));
        let transfers = [tiles.transfer(&psf)];
        let [back, front] = [0.5, 0.25].map(|light| Array3::from_elem((1, 30, 40), light));
        let matte = Array2::from_elem((30, 40), 0.5);
        let sheet = |light, matte| Sheet { light, matte, transfers: &transfers };
        let seen = composite(&tiles, &[sheet(back.view(), None), sheet(front.view(), Some(matte.view()))]);
        assert!(seen.iter().all(|v| (v - 0.5).abs() < 1e-6));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn blurring_in_tiles_is_convolution_with_mirrored_borders(
            height in 1usize..40, width in 1usize..40, halves in [0usize..9, 0usize..9], even in any::<bool>(),
            more in [1usize..30, 1usize..30], seed in any::<u32>()
        ) {
            let psfs = halves.map(|half| kernel(half, even));
            let planes = [seed, !seed].map(|seed| picture(height, width, seed));
            let reach = halves[0].max(halves[1]);
            let tiles = Tiles::with_periods((height, width), reach, (2 * reach + more[0], 2 * reach + more[1]));
            let light = stack(Axis(0), &[planes[0].view(), planes[1].view()]).unwrap();
            let seen = blurred(&tiles, light.view(), &psfs);
            for ((plane, psf), seen) in planes.iter().zip(&psfs).zip(seen.outer_iter()) {
                for (a, b) in seen.iter().zip(&direct(plane, psf)) { prop_assert!((a - b).abs() < 1e-5); }
            }
        }
    }
}
