//! The demo's report: the verdict first, where we lose in words, then pictures, enlarged parts of each depth, and numbers.

use crate::demo::{Demo, DemoError, Picture};
use crate::metrics::{BORDER, luma};
use crate::picture::{jpeg, png};
use crate::report::{Figure, Layout, Report};
use edof_spec::{ColourFrame, Tone};
use ndarray::{Array2, ArrayView2, s};

/// Sides in pixels of the enlarged parts, largest first: the first that a depth has room for.
const SIDES: [usize; 3] = [80, 48, 24];
/// Pixels from one place that is looked at to the next.
const STEP: usize = 8;
/// Depths where another is better by less than this many dB are no loss.
const TIE_DB: f64 = 0.05;

impl Demo {
    /// The report, pictures inside; `command` tells how to make it again.
    ///
    /// # Errors
    /// [`DemoError::Picture`].
    pub fn report(&self, command: &str) -> Result<Report, DemoError> {
        let mut report = Report::new("Extended depth of field: one scene, four depths");
        report.verdict(&self.verdict());
        report.paragraph(&format!(
            "The scene “{}” ({}×{} pixels) has four parts, each at its own depth. Every lens sees it once; a {}-bit sensor \
             with Bayer filters and noise “{}” gives one raw frame. Pictures are encoded as sRGB. Depth is told as ψ, in radians: how \
             far out of focus a plain lens is; a larger ψ is nearer.",
            self.scene, self.width, self.height, self.depth, self.noise
        ));
        report.terms(&self.terms());
        report.heading("Pictures");
        report.paragraph("Each opens at a click; arrows flip between them, E shows the difference to the scene. Exact PNG files lie beside this page.");
        report.figures(&self.figures()?, Layout::Wide);
        report.heading("Each depth, enlarged");
        for psi in self.psis() {
            let figures = self.parts(psi)?;
            if !figures.is_empty() {
                report.paragraph(&format!("ψ = {psi:.1}"));
                report.figures(&figures, Layout::Enlarged);
            }
        }
        report.heading("Numbers");
        let measured = match self.tone {
            Tone::Linear => "light",
            Tone::Srgb => "the encoded picture, clipped to 0…1, and of its light beside it",
        };
        report.paragraph(&format!(
            "PSNR in dB of {measured}, over red, green and blue, peak 1, {BORDER} pixels of border cropped; by depth where it is \
             seen. The best of each column is set off."
        ));
        self.table().add_to(&mut report, &self.best());
        report.paragraph(&format!("Made by: {command}"));
        Ok(report)
    }

    /// Ours against the best of the others, and where we lose, in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let Some((ours, others)) = self.pictures.split_last() else { return String::new() };
        let better = |a: &&Picture, b: &&Picture| a.picture.psnr_db.total_cmp(&b.picture.psnr_db);
        let Some(rival) = others.iter().max_by(better) else { return String::new() };
        let worst =
            |p: &Picture| p.psi_db.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap_or_default();
        let ([our_psi, our_worst], [its_psi, its_worst]) = (worst(ours), worst(rival));
        let losses: Vec<String> =
            (0..ours.psi_db.len()).filter_map(|depth| loss(ours, others, depth)).collect();
        let losses = match losses[..] {
            [] => "At no depth is any of the others better.".to_owned(),
            _ => format!("It loses at {}.", losses.join(", and at ")),
        };
        format!(
            "{}: {:.1} dB over the whole picture, {our_worst:.1} at its worst depth (ψ = {our_psi:.1}). The best of the others, {}: \
             {:.1} and {its_worst:.1} (ψ = {its_psi:.1}). {losses}",
            capitalised(&name(ours)),
            ours.picture.psnr_db,
            name(rival),
            rival.picture.psnr_db,
        )
    }

    /// What each lens and treatment is, a line each.
    fn terms(&self) -> Vec<(String, String)> {
        let treatments = [
            (
                "Demosaiced",
                "what a plain camera would show of the raw frame (Malvar, He and Cutler's filter).",
            ),
            (
                "Reconstructed",
                "the network, in the integers that the board computes with; behind the clear lens one that was trained for it, likewise.",
            ),
        ];
        let lenses = self.lenses.iter().map(|(title, about)| (capitalised(title), about.clone()));
        lenses.chain(treatments.map(|(term, text)| (term.to_owned(), text.to_owned()))).collect()
    }

    pub(crate) fn figures(&self) -> Result<Vec<Figure>, DemoError> {
        let truth = Figure {
            title: "The scene itself".into(),
            note: "no blur, no noise".into(),
            picture: png(&self.truth, Tone::Srgb)?,
        };
        let shown = |p: &Picture| -> Result<Figure, DemoError> {
            let Picture { picture, camera, method, .. } = p;
            let note =
                format!("{:.2} dB, SSIM {:.3}; camera {camera}, {method}", picture.psnr_db, picture.ssim);
            Ok(Figure { title: name(p), note, picture: jpeg(&p.frame, Tone::Srgb)? })
        };
        std::iter::once(Ok(truth)).chain(self.pictures.iter().map(shown)).collect()
    }

    /// The busiest part that lies at one depth, of the scene and of all pictures; nothing where the depth has no such part.
    pub(crate) fn parts(&self, psi: f64) -> Result<Vec<Figure>, DemoError> {
        let busy = luma(&self.truth);
        let found =
            SIDES.iter().find_map(|&side| Some((busiest(&busy, &self.depths, psi as f32, side)?, side)));
        let Some(((row, column), side)) = found else { return Ok(vec![]) };
        let figure = |title: String, frame: &ColourFrame, note: String| -> Result<Figure, DemoError> {
            Ok(Figure { title, note, picture: png(&frame.crop(row, column, side, side), Tone::Srgb)? })
        };
        let mut figures = vec![figure("The scene itself".into(), &self.truth, String::new())?];
        for picture in &self.pictures {
            let db = picture.psi_db.iter().find(|d| d[0] == psi).map_or(f64::NAN, |d| d[1]);
            figures.push(figure(name(picture), &picture.frame, format!("{db:.1} dB at this depth"))?);
        }
        Ok(figures)
    }

    /// Row and column of the largest number of each column but the last, which is time.
    pub(crate) fn best(&self) -> Vec<(usize, usize)> {
        let table = self.table();
        let number =
            |row: usize, column: usize| table.rows[row][column].parse::<f64>().unwrap_or(f64::NEG_INFINITY);
        let column = |c: usize| {
            let row = (0..table.rows.len()).max_by(|&a, &b| number(a, c).total_cmp(&number(b, c)))?;
            Some((row, c))
        };
        (1..table.header.len() - 1).filter_map(column).collect()
    }
}

/// How far the best of the others is ahead at one depth, if it is.
fn loss(ours: &Picture, others: &[Picture], depth: usize) -> Option<String> {
    let [psi, db] = *ours.psi_db.get(depth)?;
    let ahead = |p: &Picture| Some((p.psi_db.get(depth)?[1] - db, name(p)));
    let (by, who) = others.iter().filter_map(ahead).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (by > TIE_DB).then(|| format!("ψ = {psi:.1} by {by:.1} dB ({who})"))
}

fn name(picture: &Picture) -> String {
    format!("{}, {}", picture.lens, picture.treatment)
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Row and column of the square of that side, all at `psi`, in which neighbours differ most.
fn busiest(light: &Array2<f32>, depths: &Array2<f32>, psi: f32, side: usize) -> Option<(usize, usize)> {
    let (height, width) = light.dim();
    let starts = |length: usize| (BORDER..(length + 1).saturating_sub(side + BORDER)).step_by(STEP);
    let places = starts(height).flat_map(|row| starts(width).map(move |column| (row, column)));
    let square = |(row, column): (usize, usize)| s![row..row + side, column..column + side];
    let inside = places.filter(|&at| depths.slice(square(at)).iter().all(|depth| *depth == psi));
    let busy = |at: &(usize, usize)| change(light.slice(square(*at)));
    inside.max_by(|a, b| busy(a).total_cmp(&busy(b)))
}

fn change(part: ArrayView2<'_, f32>) -> f64 {
    let step = |pair: ndarray::ArrayView1<'_, f32>| f64::from((pair[1] - pair[0]).powi(2));
    part.rows().into_iter().flat_map(|row| row.windows(2).into_iter().map(step).collect::<Vec<_>>()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo::tests::demo;

    #[test]
    fn the_report_shows_every_picture_and_every_depth_and_how_to_make_it() {
        let demo = demo();
        let html = demo.report("edof demo --scene chart").unwrap().to_html();
        assert_eq!(html.matches("<figure>").count(), 3 + 4 * 3);
        assert!(html.contains("edof demo --scene chart") && html.contains("ring-outer"));
        assert!(html.find("class=\"verdict\"") < html.find("<h2>"));
        assert_eq!(html.matches("class=\"n best\"").count(), 7, "one cell of each column");
    }

    #[test]
    fn the_verdict_says_where_we_lose() {
        let mut demo = demo();
        for (picture, db) in demo.pictures.iter_mut().zip([30.0, 31.0]) {
            picture.psi_db.iter_mut().for_each(|d| d[1] = db);
            picture.picture.psnr_db = db;
        }
        assert!(demo.verdict().contains("At no depth"), "{}", demo.verdict());
        demo.pictures[0].psi_db[1][1] = 32.5;
        let verdict = demo.verdict();
        assert!(verdict.ends_with("It loses at ψ = 3.0 by 1.5 dB (clear, demosaiced)."), "{verdict}");
    }

    #[test]
    fn the_busiest_part_lies_at_its_depth() {
        let light =
            Array2::from_shape_fn(
                (60, 80),
                |(r, c)| if (30..50).contains(&c) { ((r + c) % 2) as f32 } else { 0.5 },
            );
        let depths = Array2::from_shape_fn((60, 80), |(_, c)| if c < 60 { 1.0 } else { 5.0 });
        let (_, column) = busiest(&light, &depths, 1.0, 24).unwrap();
        assert!((24..=32).contains(&column), "{column}");
        assert_eq!(busiest(&light, &depths, 5.0, 24), None);
    }
}
