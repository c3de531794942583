//! Figures of a camera's optics: MTF at several depths, contrast through focus (the paper's Figure 1), and a sheet of PSFs.

use crate::report::picture::{caption, enlarged, psf_picture, sheet, stacked};
use crate::report::plot::{Axis, Mark, Plot, SMALL, Series, USUAL, grid, sequential};
use crate::tables::psi_words;
use edof_core::camera::Camera;
use edof_core::{Channel, ColourFrame, Tone};
use edof_optics::bank;
use edof_optics::distance_m;
use edof_optics::psf::{NoPsf, Psf, Settings, channel_psfs};
use edof_optics::{
    Footprint, Otf, green_cutoff_per_mm, has_one_response, otf, otfs, otfs_of_psf, through_focus,
};
use ndarray::Array2;

/// Points of a curve.
pub const POINTS: u32 = 60;
/// Colours of red, green and blue.
const CHANNELS: [(&str, &str); 3] = [("red", "#d62728"), ("green", "#2ca02c"), ("blue", "#1f77b4")];
/// The sheet shows PSFs as far as any of them has so much of its peak, but no more and no fewer pixels than these.
const FAINTEST: f32 = 0.004;
const SHOWN: [usize; 2] = [9, 63];
/// Side of a PSF on the sheet, about; and the space between two.
const CELL: usize = 150;
const GAP: usize = 4;
/// Pixels of the sensor that the sheet's scale is long.
const SCALE: usize = 5;

/// What figures and numbers show of a camera at one ψ.
#[derive(Debug, Clone, PartialEq)]
pub struct AtDepth {
    /// The depth.
    pub psi: f64,
    /// PSFs of red, green and blue.
    pub psfs: [Psf; 3],
    /// OTFs of red, green and blue along a row of pixels and along a column; the lens alone.
    pub otfs: [[Otf; 2]; 3],
}

impl AtDepth {
    /// Computes the PSFs by `settings`, and the OTFs by the default ones.
    ///
    /// # Errors
    /// [`NoPsf`].
    pub fn new(camera: &Camera, psi: f64, settings: &Settings) -> Result<Self, NoPsf> {
        let psfs = channel_psfs(camera, psi, settings)?;
        let otfs = if camera.psf_bank.is_some() && *settings == Settings::default() {
            psfs.each_ref().map(|psf| otfs_of_psf(camera, psf, Footprint::Lens))
        } else {
            let [red, green, blue] = Channel::ALL.map(|channel| otfs(camera, channel, psi, Footprint::Lens));
            [red?, green?, blue?]
        };
        Ok(Self { psi, psfs, otfs })
    }
}

/// The same lens, sensor and focus without the mask; computed, even if the camera has a PSF bank.
#[must_use]
pub fn without_mask(camera: &Camera) -> Camera {
    let name = format!("{} without mask", camera.name);
    Camera { name, ..camera.without_mask() }
}

/// Contrast of red, green and blue at a quarter of green's cut-off for each ψ; the lens alone. Negative values are reversed contrast.
///
/// # Errors
/// [`NoPsf`].
pub fn contrast(camera: &Camera, psis: &[f64]) -> Result<Vec<[f64; 3]>, NoPsf> {
    through_focus(camera, green_cutoff_per_mm(camera) / 4.0, psis, Footprint::Lens)
}

/// Depths of a curve over a camera's range of ψ.
#[must_use]
pub fn curve_depths(camera: &Camera) -> Vec<f64> {
    let [low, high] = depths(camera);
    (0..=32).map(|i| low + (high - low) * f64::from(i) / 32.0).collect()
}

/// Response of red, green and blue at [`POINTS`] + 1 frequencies from 0 to green's cut-off; the lens alone.
///
/// # Errors
/// [`NoPsf`].
pub fn responses(camera: &Camera, psi: f64) -> Result<[Vec<f64>; 3], NoPsf> {
    let cutoff = green_cutoff_per_mm(camera);
    let [red, green, blue] = Channel::ALL.map(|channel| otf(camera, channel, psi, Footprint::Lens));
    let curve = |response: Otf| {
        (0..=POINTS).map(|i| response.at(f64::from(i) / f64::from(POINTS) * cutoff)).collect()
    };
    Ok([curve(red?), curve(green?), curve(blue?)])
}

/// Figure 1(a): green's response over spatial frequency, as a share of the cut-off, at each ψ; negative where contrast is
/// reversed. The lens alone, without the pixel.
#[must_use]
pub fn mtf_plot(camera: &Camera, depths: &[AtDepth]) -> Plot {
    let title = format!("Response to spatial frequency, green: {}", camera.name);
    response_plot(camera, depths, |depth| &depth.otfs[Channel::Green.plane()][0], (title, USUAL))
}

/// Returns the responses of red, green and blue as one SVG: a row of diagrams without the mask (`clear`) and one with it, on the same scales. Where a
/// lens is not round, or a bank states its PSFs, there is a row along rows of pixels and one along columns.
#[must_use]
pub fn mtf_figure(camera: (&Camera, &[AtDepth]), clear: (&Camera, &[AtDepth])) -> String {
    let mut plots = vec![];
    if is_masked(camera.0) {
        plots.extend(response_plots(clear));
    }
    plots.extend(response_plots(camera));
    let values = plots.iter().flat_map(|plot| &plot.series).flat_map(|series| &series.points);
    let lowest = values.map(|point| point[1]).fold(0.0, f64::min);
    plots.iter_mut().for_each(|plot| plot.y = plot.y.clone().from((10.0 * lowest).floor() / 10.0));
    grid(&plots, CHANNELS.len())
}

fn response_plots((camera, depths): (&Camera, &[AtDepth])) -> Vec<Plot> {
    let directions: &[&str] =
        if has_one_response(camera) { &[""] } else { &[" along rows", " along columns"] };
    let mut plots = vec![];
    for (direction, along) in directions.iter().enumerate() {
        for (channel, (name, _)) in Channel::ALL.into_iter().zip(CHANNELS) {
            let title = format!("{}: {name}{along}", camera.name);
            let own = response_plot(
                camera,
                depths,
                |depth| &depth.otfs[channel.plane()][direction],
                (title, SMALL),
            );
            plots.push(own);
        }
    }
    plots
}

/// Whether the lens differs from [`without_mask`].
fn is_masked(camera: &Camera) -> bool {
    !camera.is_clear() || camera.psf_bank.is_some()
}

/// One response for each ψ over frequency. A bank does not say what is beyond half a cycle a pixel: its lines end there.
fn response_plot(
    camera: &Camera,
    depths: &[AtDepth],
    response: impl Fn(&AtDepth) -> &Otf,
    (title, size): (String, [f64; 2]),
) -> Plot {
    let cutoff = green_cutoff_per_mm(camera);
    let last = depths.len().saturating_sub(1).max(1) as f64;
    let series = depths.iter().enumerate().map(|(index, at)| {
        let response = response(at);
        let shares = (0..=POINTS).map(|i| f64::from(i) / f64::from(POINTS));
        let known = shares.filter(|share| share * cutoff <= response.end_per_mm() + 1e-9);
        let points: Vec<_> = known.map(|share| [share, response.at(share * cutoff)]).collect();
        Series::new(depth(camera, at.psi), Mark::Line, points).coloured(sequential(index as f64 / last))
    });
    Plot {
        title,
        x: Axis::linear("frequency / cut-off of green").from(0.0).to(1.0),
        y: Axis::linear("contrast").to(1.0),
        size,
        series: series.collect(),
    }
}

/// Figure 1(b): contrast of red, green and blue at a quarter of green's cut-off through focus, as [`contrast`] gives it at [`curve_depths`]; dotted
/// without the mask.
///
/// # Errors
/// [`NoPsf`].
pub fn contrast_plot(camera: &Camera, contrasts: &[[f64; 3]]) -> Result<Plot, NoPsf> {
    let [low, high] = depths(camera);
    let psis = curve_depths(camera);
    let curves = |contrasts: &[[f64; 3]], mark: Mark, note: &str| -> Vec<Series> {
        let curve = |(channel, (name, colour)): (usize, (&str, &str))| {
            let points = psis.iter().zip(contrasts).map(|(&psi, c)| [psi, c[channel].abs()]);
            Series::new(format!("{name}{note}"), mark, points).coloured(colour)
        };
        CHANNELS.into_iter().enumerate().map(curve).collect()
    };
    let mut series = curves(contrasts, Mark::Line, "");
    if is_masked(camera) {
        series.extend(curves(&contrast(&without_mask(camera), &psis)?, Mark::Dotted, ", no mask"));
    }
    Ok(Plot {
        title: format!("Contrast at a quarter of the cut-off: {}", camera.name),
        x: Axis::linear("ψ (radians)").from(low).to(high),
        y: Axis::linear("contrast").from(0.0),
        size: USUAL,
        series,
    })
}

/// A depth as figures name it: in metres, too, where the camera knows the distance of ψ = 0.
fn depth(camera: &Camera, psi: f64) -> String {
    let metres =
        camera.nominal_m.and_then(|nominal| distance_m(camera, psi, nominal)).filter(|m| m.is_finite());
    let psi = psi_words(psi);
    metres.map_or_else(|| format!("ψ = {psi}"), |metres| format!("ψ = {psi}, {metres:.2} m"))
}

/// The distance of each ψ before a camera, as a sentence. A camera that does not know the distance of ψ = 0 has it at infinity.
#[must_use]
pub fn in_metres(camera: &Camera, psis: &[f64]) -> String {
    let nominal = camera.nominal_m.unwrap_or(f64::INFINITY);
    let distance = |psi: f64| match distance_m(camera, psi, nominal) {
        Some(metres) if metres.is_finite() => format!("at {metres:.1} m"),
        Some(_) => "at infinity".to_owned(),
        None => "beyond infinity".to_owned(),
    };
    let each: Vec<String> = psis.iter().map(|&psi| format!("ψ = {psi:.1} is {}", distance(psi))).collect();
    let focus = if camera.nominal_m.is_some() { "" } else { " if ψ = 0 is at infinity" };
    format!(
        "For this lens (camera {}, an aperture {:.2} mm wide), {}{focus}.",
        camera.name,
        2.0 * camera.aperture_radius_mm,
        each.join(", ")
    )
}

/// The camera's range of ψ, no wider than its bank's.
fn depths(camera: &Camera) -> [f64; 2] {
    let [low, high] = camera.psi_range;
    match camera.psf_bank.as_ref().and_then(|own| own.kernels.as_ref()).map(|kernels| bank::ends(kernels)) {
        Some([first, last]) => [low.clamp(first, last), high.clamp(first, last)],
        None => [low, high],
    }
}

/// PSFs of one camera a row, each ψ a column, and a scale; every channel scaled to its own peak, brightness raised to show faint
/// rings. What lies farther out than anything that could be seen is cut off. To be shown as it is ([`Tone::Linear`]).
#[must_use]
pub fn psf_sheet(cameras: &[(&Camera, &[AtDepth])]) -> ColourFrame {
    let psfs = cameras.iter().flat_map(|(_, depths)| *depths).flat_map(|depth| &depth.psfs);
    let reach = psfs.map(|psf| reach(psf.kernel())).max().unwrap_or(0);
    let side = (2 * reach + 1).clamp(SHOWN[0], SHOWN[1]);
    let factor = (CELL / side).max(2);
    let columns = cameras.first().map_or(0, |(_, depths)| depths.len());
    let width = GAP + columns * (side * factor + GAP);
    let mut parts = vec![];
    for (camera, depths) in cameras {
        let named = |AtDepth { psi, psfs, .. }: &AtDepth| {
            let picture = enlarged(&psf_picture(psfs.each_ref().map(|p| p.kernel()), side), factor);
            stacked(&[picture, caption(&depth(camera, *psi), side * factor, Tone::Linear)], Tone::Linear)
        };
        parts.push(caption(&camera.name, width, Tone::Linear));
        parts.push(sheet(&[depths.iter().map(named).collect()], GAP));
    }
    let mut scale = ColourFrame::zeros(2 * GAP, GAP + SCALE * factor);
    scale.planes.fill(1.0);
    scale.planes.slice_mut(ndarray::s![.., GAP.., GAP..]).fill(0.0);
    let pitch = cameras.first().map_or(0.0, |(camera, _)| camera.pixel_pitch_um);
    let length = (SCALE as f64 * pitch * 100.0).round() / 100.0;
    parts.push(scale);
    parts.push(caption(&format!("{SCALE} pixels = {length} µm"), width, Tone::Linear));
    stacked(&parts, Tone::Linear)
}

/// How far from its middle, along rows or columns, a kernel can still be seen.
fn reach(kernel: &Array2<f32>) -> usize {
    let (height, width) = kernel.dim();
    let peak = kernel.iter().fold(0.0f32, |max, v| max.max(*v));
    let seen = kernel.indexed_iter().filter(|(_, v)| **v > FAINTEST * peak);
    seen.map(|((r, c), _)| r.abs_diff(height / 2).max(c.abs_diff(width / 2))).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use edof_core::camera::{Kernels, PsfBank};

    fn at_depths(camera: &Camera, psis: &[f64]) -> Vec<AtDepth> {
        psis.iter().map(|&psi| AtDepth::new(camera, psi, &Settings::default()).unwrap()).collect()
    }

    fn through_focus_of(name: &str) -> Plot {
        let camera = Camera::resolve(name).unwrap();
        contrast_plot(&camera, &contrast(&camera, &curve_depths(&camera)).unwrap()).unwrap()
    }

    #[test]
    fn contrast_is_shown_with_and_without_the_mask() {
        let plot = through_focus_of("ring-2018");
        assert_eq!(plot.series.len(), 6);
        let peak = |series: &Series| series.points.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap()[0];
        assert!(peak(&plot.series[2]) > 4.0, "blue focuses far with the mask");
        assert!(peak(&plot.series[5]) < 0.1, "and at zero without");
        assert_eq!(through_focus_of("clear").series.len(), 3);
    }

    #[test]
    fn every_response_starts_at_one() {
        let camera = Camera::resolve("clear").unwrap();
        let plot = mtf_plot(&camera, &at_depths(&camera, &[0.0, 5.0]));
        assert!(plot.series.iter().all(|s| s.points[0] == [0.0, 1.0]));
        assert!(plot.series[1].points.iter().any(|p| p[1] < 0.0), "reversed contrast at 5");
    }

    /// A lens of two points, one above the other, at depths 0 and 4.
    fn banked() -> Camera {
        let points =
            ndarray::Array4::from_shape_fn(
                (2, 3, 3, 3),
                |(_, _, row, column)| {
                    if column == 1 && row < 2 { 0.5 } else { 0.0 }
                },
            );
        let kernels = Some(Kernels::new(vec![0.0, 4.0], points.view(), None).unwrap().into());
        let bank = PsfBank { file: "points".into(), sha256: String::new(), centre: false, kernels };
        Camera { psf_bank: Some(bank), ..Camera::resolve("clear").unwrap() }
    }

    /// Titles of a figure's diagrams.
    fn titles(svg: &str) -> Vec<&str> {
        svg.split("class=\"title\"")
            .skip(1)
            .map(|rest| &rest[rest.find('>').unwrap() + 1..rest.find('<').unwrap()])
            .collect()
    }

    #[test]
    fn a_figure_has_a_diagram_for_each_colour_and_where_they_differ_for_rows_and_columns() {
        let ring = Camera::resolve("ring-outer").unwrap();
        let figure = |camera: &Camera| {
            let clear = without_mask(camera);
            let [own, open] = [camera, &clear].map(|camera| at_depths(camera, &[0.0, 4.0]));
            mtf_figure((camera, &own), (&clear, &open))
        };
        let round = figure(&ring);
        assert_eq!(
            titles(&round),
            [
                "ring-outer without mask: red",
                "ring-outer without mask: green",
                "ring-outer without mask: blue",
                "ring-outer: red",
                "ring-outer: green",
                "ring-outer: blue"
            ]
        );
        assert_eq!((round.matches(">ψ = 0</text>").count(), round.matches(">ψ = 4</text>").count()), (1, 1));
        let clear = figure(&Camera::resolve("clear").unwrap());
        assert_eq!(titles(&clear).len(), 3);
        let banked = figure(&banked());
        let titles = titles(&banked);
        assert_eq!(titles.len(), 9);
        assert_eq!((titles[3], titles[8]), ("clear: red along rows", "clear: blue along columns"));
    }

    #[test]
    fn a_response_ends_where_a_bank_knows_no_more() {
        let camera = banked();
        let plots = response_plots((&camera, &at_depths(&camera, &[0.0])));
        let [along_rows, along_columns] =
            [1, 4].map(|plot: usize| *plots[plot].series[0].points.last().unwrap());
        let nyquist = 500.0 / camera.pixel_pitch_um / green_cutoff_per_mm(&camera);
        assert!(along_rows[0] <= nyquist && nyquist < along_rows[0] + 1.0 / f64::from(POINTS), "{nyquist}");
        assert!(along_rows[1] > 0.9 && along_columns[1].abs() < 0.2, "{along_rows:?} {along_columns:?}");
    }

    #[test]
    fn a_sentence_states_the_distance_of_each_depth() {
        let camera = Camera::resolve("ring-outer").unwrap();
        let unknown = in_metres(&camera, &[0.0, 8.0]);
        let near = distance_m(&camera, 8.0, f64::INFINITY).unwrap();
        assert!(
            unknown.contains("ψ = 0.0 is at infinity") && unknown.ends_with("if ψ = 0 is at infinity."),
            "{unknown}"
        );
        assert!(unknown.contains(&format!("ψ = 8.0 is at {near:.1} m")), "{unknown}");
        let known = in_metres(&Camera { nominal_m: Some(10.0), ..camera }, &[0.0, -1e4]);
        assert!(known.ends_with("ψ = 0.0 is at 10.0 m, ψ = -10000.0 is beyond infinity."), "{known}");
    }

    #[test]
    fn depths_are_reported_in_metres_where_the_camera_knows_its_focus() {
        let camera = Camera::resolve("ring-2018").unwrap();
        assert_eq!(depth(&camera, 8.0), "ψ = 8");
        let camera = Camera { nominal_m: Some(10.0), ..camera };
        assert_eq!(depth(&camera, 7.9999), "ψ = 8, 3.11 m");
        assert_eq!(mtf_plot(&camera, &at_depths(&camera, &[8.0])).series[0].label, "ψ = 8, 3.11 m");
        let camera = Camera { nominal_m: Some(f64::INFINITY), ..camera };
        assert_eq!(depth(&camera, 0.0), "ψ = 0");
    }

    #[test]
    fn every_depth_has_a_colour_of_its_own_along_one_scale() {
        let psis: Vec<f64> = (0..=8).map(f64::from).collect();
        let camera = Camera::resolve("clear").unwrap();
        let plot = mtf_plot(&camera, &at_depths(&camera, &psis));
        let colours: std::collections::BTreeSet<_> = plot.series.iter().map(|s| s.colour.clone()).collect();
        assert_eq!(colours.len(), 9);
        assert!(mtf_plot(&camera, &at_depths(&camera, &[2.0])).series[0].colour.is_some());
    }

    #[test]
    fn a_sheet_has_a_row_a_camera_and_a_column_a_depth_and_is_cut_to_what_is_seen() {
        let camera = Camera::resolve("clear").unwrap();
        let size = |rows: usize, psis: &[f64]| {
            let depths = at_depths(&camera, psis);
            psf_sheet(&vec![(&camera, &depths[..]); rows]).size()
        };
        let reach_at = |psi| {
            channel_psfs(&camera, psi, &Settings::default())
                .unwrap()
                .map(|p| reach(p.kernel()))
                .into_iter()
                .max()
        };
        let cell = |psi| {
            let side = (2 * reach_at(psi).unwrap() + 1).clamp(SHOWN[0], SHOWN[1]);
            side * (CELL / side)
        };
        assert_eq!(size(1, &[0.0]).1, cell(0.0) + 2 * GAP);
        assert_eq!(size(1, &[0.0, 4.0, 8.0]).1, 3 * (cell(8.0) + GAP) + GAP);
        assert!(reach_at(8.0) > reach_at(0.0));
        let (one, two) = (size(1, &[4.0]).0, size(2, &[4.0]).0);
        assert!(two - one > cell(4.0), "{one} {two}");
    }

    #[test]
    fn a_kernel_reaches_as_far_as_it_can_be_seen() {
        let mut kernel = Array2::zeros((9, 7));
        kernel[(4, 3)] = 1.0;
        assert_eq!(reach(&kernel), 0);
        kernel[(4, 5)] = 0.01;
        kernel[(1, 3)] = 0.001;
        assert_eq!(reach(&kernel), 2);
    }
}
