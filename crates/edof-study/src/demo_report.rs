//! The demo's report: the verdict first, where we lose in words, then pictures, enlarged parts of each depth, and numbers.

use crate::demo::{CodesRead, Demo, DemoError};
use crate::metrics::quality::{cell, columns};
use crate::metrics::{BORDER, Quality};
use crate::pictures::{self, Part, Picture, capitalised};
use crate::report::picture::{jpeg, png};
use crate::report::{Figure, Layout, Report};
use edof_core::{ColourFrame, Tone};

impl Demo {
    /// The report, pictures inside; `command` is the command that makes it again, `remark` what is expected of other scenes.
    ///
    /// # Errors
    /// [`DemoError::Picture`].
    pub fn report(&self, command: &str, remark: Option<&str>) -> Result<Report, DemoError> {
        let mut report = Report::new("Extended depth of field: one scene, four depths");
        report.verdict(&self.verdict());
        if let Some(remark) = remark {
            report.paragraph(&format!("On photographs: {remark}."));
        }
        report.figures(&[self.figure_by_depth()?], Layout::Wide);
        report.paragraph(&format!(
            "The scene “{}” ({}×{} pixels) has four parts, each at its own depth. Every lens sees it once; a {}-bit sensor \
             with Bayer filters and noise “{}” gives one raw frame. Pictures are encoded as sRGB. ψ is the defocus of a plain lens, in \
             radians; a larger ψ is nearer. {}",
            self.scene, self.width, self.height, self.depth, self.noise, self.metres
        ));
        report.terms(&self.terms());
        report.heading("Pictures");
        report.paragraph("Each picture opens at a click; arrows flip between them, E shows the difference to the scene. Exact PNG files are next to this page.");
        report.figures(&self.figures()?, Layout::Wide);
        report.heading("Each depth, enlarged");
        for part in &self.parts {
            report.paragraph(&format!("ψ = {:.1}", part.psi));
            report.figures(&self.figures_of(part)?, Layout::Enlarged);
        }
        report.heading("Numbers");
        let measured = match self.tone {
            Tone::Linear => "light",
            Tone::Srgb => "the encoded picture, clipped to 0…1, and of its light",
        };
        report.paragraph(&format!(
            "PSNR in dB of {measured}, over red, green and blue, peak 1, {BORDER} pixels of border cropped; at each \
             depth of the scene. The best number of each column is highlighted."
        ));
        self.table().add_to(&mut report, &self.best());
        report.made_by(command);
        Ok(report)
    }

    /// Whether network and mask pay here, ours against the best of the others, where we lose, and the codes that are read, in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let codes = self.codes.as_ref().map_or_else(String::new, |CodesRead { of, read }| {
            let each = self.pictures.iter().zip(read).map(|(p, read)| format!("{read} ({})", p.name()));
            format!(
                " Of {of} codes that rxing reads in the scene itself, it reads {}.",
                each.collect::<Vec<_>>().join(", ")
            )
        });
        pictures::answer(&self.pictures) + &pictures::verdict(&self.pictures) + &codes
    }

    fn figure_by_depth(&self) -> Result<Figure, DemoError> {
        let depths: Vec<String> = self.large_parts.iter().map(|part| format!("{:.1}", part.psi)).collect();
        let note = format!("Parts at ψ = {}, two screen pixels a pixel", depths.join(", "));
        Ok(Figure { title: "The same depths".into(), note, picture: png(&self.by_depth(), Tone::Srgb)? })
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
                "the network, in the integers that the board computes with; the clear lens has a network that was trained for it.",
            ),
        ];
        let lenses = self.lenses.iter().map(|(title, about)| (capitalised(title), about.clone()));
        lenses.chain(treatments.map(|(term, text)| (term.to_owned(), text.to_owned()))).collect()
    }

    fn figures(&self) -> Result<Vec<Figure>, DemoError> {
        let truth = figure_of_scene("no blur, no noise", png(&self.truth, Tone::Srgb)?);
        let shown = |(picture, frame): (&Picture, &ColourFrame)| -> Result<Figure, DemoError> {
            Ok(figure(picture, jpeg(frame, Tone::Srgb)?))
        };
        std::iter::once(Ok(truth)).chain(self.pictures.iter().zip(&self.frames).map(shown)).collect()
    }

    /// A part of the scene and of all pictures.
    fn figures_of(&self, part: &Part) -> Result<Vec<Figure>, DemoError> {
        let shown = |(picture, frame): (&Picture, &ColourFrame)| -> Result<Figure, DemoError> {
            Ok(figure_at(picture, part.psi, png(&part.of(frame), Tone::Srgb)?))
        };
        let truth = figure_of_scene("", png(&part.of(&self.truth), Tone::Srgb)?);
        std::iter::once(Ok(truth)).chain(self.pictures.iter().zip(&self.frames).map(shown)).collect()
    }
}

/// The scene itself, whole or a part, as an encoded picture.
pub(crate) fn figure_of_scene(note: &str, picture: Vec<u8>) -> Figure {
    Figure { title: "The scene itself".into(), note: note.into(), picture }
}

/// A whole picture.
pub(crate) fn figure(of: &Picture, picture: Vec<u8>) -> Figure {
    let Picture { picture: quality, camera, method, .. } = of;
    let means = Quality::means(&[*quality]);
    let metrics = columns([&means].into_iter());
    let metrics = metrics.iter().map(|metric| format!(", {} {}", metric.title, cell(&means, metric)));
    let note =
        format!("{:.2} dB{}; camera {camera}, {method}", quality.psnr_db(), metrics.collect::<String>());
    Figure { title: of.name(), note, picture }
}

/// A part of a picture at a depth.
pub(crate) fn figure_at(of: &Picture, psi: f64, picture: Vec<u8>) -> Figure {
    let note = of.db_at(psi).map_or_else(String::new, |db| format!("{db:.1} dB at this depth"));
    Figure { title: of.name(), note, picture }
}

#[cfg(test)]
mod tests {
    use crate::demo::tests::demo;

    #[test]
    fn the_report_shows_every_picture_and_every_depth_and_how_to_make_it() {
        let demo = demo();
        let html = demo.report("edof demo --scene chart", Some("a clear lens is ahead")).unwrap().to_html();
        assert_eq!(html.matches("<figure>").count(), 1 + 3 + 4 * 3);
        assert!(html.contains("<span>edof demo</span> <span>--scene chart") && html.contains("ring-outer"));
        assert!(html.find("class=\"verdict\"") < html.find("On photographs: a clear lens is ahead."));
        assert!(html.find("class=\"verdict\"") < html.find("<h2>"));
        let columns = crate::pictures::table(&demo.pictures).header.len() - 2;
        assert_eq!(html.matches("class=\"n best\"").count(), columns, "one cell of each but name and time");
    }
}
