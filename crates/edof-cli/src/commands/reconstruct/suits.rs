//! Whether a network suits a frame: its lens, its tone, its noise.

use super::{Job, Taken};
use crate::error::Error;
use crate::lens;
use crate::ui::Ui;
use crate::weights;
use edof_core::Tone;
use edof_network::Fit;
use edof_network::network::{Condition, Origin};

impl Job<'_> {
    /// Rejects a network for another lens; prints what is lost where it was trained for another tone or noise.
    pub(super) fn suits(&self, origin: &Origin, taken: &Taken, ui: &Ui) -> Result<(), Error> {
        self.fits_camera(origin, taken, ui)?;
        self.suits_tone(origin, taken, ui);
        self.suits_noise(origin, taken, ui);
        Ok(())
    }

    /// The network must have been trained for the lens that took the frame, as its record or the user says.
    fn fits_camera(&self, origin: &Origin, taken: &Taken, ui: &Ui) -> Result<(), Error> {
        let args = self.args;
        let Some(camera) = &taken.camera else { return Ok(()) };
        if origin.camera.same_lens(camera) {
            return Ok(());
        }
        let fields = origin.camera.differences(camera).join(", ");
        let (name, trained, tone) = (self.network(taken), origin.camera.in_words(), self.tone(taken));
        let taken_by = match taken.record {
            Some(_) => format!("{} was taken by {}", self.raw.display(), camera.in_words()),
            None => format!("--camera is {}", camera.in_words()),
        };
        let problem = format!(
            "--weights {name}: trained for the camera {trained}, but {taken_by}, another lens or mask (they differ in {fields})"
        );
        if args.force {
            ui.note(format!("{problem}; used nevertheless"));
            return Ok(());
        }
        let instead = match weights::trained_for(camera, tone) {
            Some(name) => format!("use --weights {name}"),
            None => lens::how_to_train(camera),
        };
        Err(Error::message(format!("{problem}; {instead}")))
    }

    /// Prints what a network loses on a frame of a tone that it was not trained on, as the frame's record or the user says.
    fn suits_tone(&self, origin: &Origin, taken: &Taken, ui: &Ui) {
        let tone = self.tone(taken);
        let is_known = taken.record.is_some() || self.args.tone.is_some();
        let Some(trained) = origin.conditions.first().map(|condition| condition.tone) else { return };
        if !is_known || origin.conditions.iter().any(|condition| condition.tone == tone) {
            return;
        }
        let instead = match weights::trained_on(&origin.camera, tone) {
            Some(name) => format!("use --weights {name}"),
            None => format!("train one by 'edof train --tone {tone}'"),
        };
        ui.note(format!(
            "--weights {}: trained on pictures of tone {trained}, {} is of {tone}: expect {} (docs/decisions/0041-one-tone.md); {instead}",
            self.network(taken),
            self.raw.display(),
            loss_of(tone),
        ));
    }

    /// Prints that the frame's noise, as its record states it, is outside of the range that the network was trained for.
    fn suits_noise(&self, origin: &Origin, taken: &Taken, ui: &Ui) {
        let (name, tone) = (self.network(taken), self.tone(taken));
        let Some(noise) = taken.record.as_ref().map(|record| record.noise) else { return };
        if origin.fit(tone, noise).is_none_or(Fit::is_inside) {
            return;
        }
        let of_tone = origin.conditions.iter().filter(|condition| condition.tone == tone);
        let trained: Vec<String> = of_tone.map(Condition::noise_in_words).collect();
        let instead = match weights::for_noise(name, tone, noise) {
            better if better != name => format!("use --weights {better}"),
            _ => "no network of the program for this lens is nearer".to_owned(),
        };
        ui.note(format!(
            "{}: its noise is {noise}, --weights {name} was trained for noise {}: expect noise that is left, or detail that is lost; \
             {instead}",
            self.raw.display(),
            trained.join(" or "),
        ));
    }
}

/// What a network loses on frames of a tone where it was trained on the other one, as measured with the program's own.
const fn loss_of(tone: Tone) -> &'static str {
    match tone {
        Tone::Srgb => "about 2 dB less than of one that was, at any noise",
        Tone::Linear => "about 3 dB less than of one that was, 1 dB where noise is 0.01",
    }
}
