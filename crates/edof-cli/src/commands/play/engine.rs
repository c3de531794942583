//! What the page is answered: a function of its state, with what was computed last kept.

use super::networks::{Choice, Networks};
use super::pictures::{self, Behind, DepthDb, Method};
use super::state::{AdviceState, ClearLens, LensState, MAX_STOPS, State, view};
use super::training::{Lesson, Training};
use crate::commands::optics::advise;
use crate::error::Error;
use edof::job::photograph::{self, Tones};
use edof_core::Tone;
use edof_core::camera::{Camera, PRESETS, Sign, centroid};
use edof_core::words::alternatives;
use edof_io::photo;
use edof_network::Network;
use edof_network::form;
use edof_network::network::{Form, Origin};
use edof_optics::Statistics;
use edof_optics::bound::advise::{Advice, Kind, advise as advised};
use edof_optics::bound::lenses::without_mask;
use edof_optics::distance_m;
use edof_optics::draw::{Builtin, MIN_SIDE, draw};
use edof_optics::psf::Psf;
use edof_study::labels;
use edof_study::lens::{contrast, curve_depths, responses};
use edof_study::live::{Live, Recent, Shot, Subject, View, fitted};
use edof_study::report::picture::{psf_picture, rgba};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Rows and columns of pictures, at most.
const ROOM: (usize, usize) = (384, 512);
/// The scenes that are drawn, by name. Their seed is that of commands without options.
const SCENES: [&str; 3] = ["chart", "labels", "leaves"];
const SEED: u64 = 0;
/// The name of a picture of the user.
const PHOTOGRAPH: &str = "photograph";
/// Side of the picture of PSFs.
const PSF_SIDE: usize = 31;

/// Contrast over depth, of a lens and of the same without its mask.
struct Contrast {
    psis: Vec<f64>,
    curves: [Vec<[f64; 3]>; 2],
}

pub struct Engine {
    camera: Camera,
    scenes: Vec<(&'static str, Arc<Subject>)>,
    live: Live<Method>,
    networks: Networks,
    contrasts: Recent<Camera, Contrast>,
    lessons: u32,
}

impl Engine {
    /// Draws the scenes. The page begins with that camera.
    ///
    /// # Errors
    /// None that anybody has seen: the scenes are of one size.
    pub fn new(camera: Camera) -> Result<Self, Error> {
        let (height, width) = ROOM;
        let scene = |name: &'static str| {
            let light = match name.parse::<Builtin>() {
                Ok(kind) => draw(kind, height, width, &[0.0], SEED)?.sharp(),
                Err(_) => labels::draw(height, width, [0.0; 4], SEED)?.scene.sharp(),
            };
            Ok::<_, Error>((name, Arc::new(Subject::new(light))))
        };
        let scenes = SCENES.into_iter().map(scene).collect::<Result<_, _>>()?;
        Ok(Self {
            camera,
            scenes,
            live: Live::default(),
            networks: Networks::new(),
            contrasts: Recent::new(16),
            lessons: 0,
        })
    }

    /// Takes the bytes of a photograph as the picture `photograph`, made small enough; `file` names it. Returns remarks on it.
    ///
    /// # Errors
    /// No photograph, or one too small.
    pub fn take(&mut self, bytes: &[u8], file: &Path) -> Result<Vec<String>, Error> {
        let photo = photo::of_bytes(bytes, file)?;
        let (height, width) = photo.frame.size();
        if height.min(width) < MIN_SIDE {
            let name = file.display();
            return Err(Error::message(format!(
                "{name}: {width}x{height}, both sides must be at least {MIN_SIDE} pixels"
            )));
        }
        let notes = std::cell::RefCell::new(vec![]);
        let tones = Tones { given: None, usual: Tone::Srgb };
        let note = |note| notes.borrow_mut().push(crate::pictures::in_words(&note));
        let (values, tone) = photograph::ready(photo, file, tones, &note);
        let subject = Subject::new(fitted(&tone.into_decoded(values), ROOM));
        self.scenes.retain(|(name, _)| *name != PHOTOGRAPH);
        self.scenes.push((PHOTOGRAPH, Arc::new(subject)));
        Ok(notes.into_inner())
    }

    /// What the page begins with: cameras, networks, pictures, limits.
    ///
    /// # Errors
    /// A network or camera of the program that cannot be read.
    pub fn setup(&self, training: &Training) -> Result<Value, Error> {
        let camera = |(name, text): &(&str, &str)| Camera::from_json(text, name);
        let presets = PRESETS.iter().map(camera).collect::<Result<Vec<_>, _>>()?;
        let network = |(name, form, origin): (&str, &Form, &Origin)| {
            let tones: Vec<Tone> = origin.conditions.iter().map(|condition| condition.tone).collect();
            let (camera, words) = (&origin.camera.name, form::words(form));
            json!({ "name": name, "camera": camera, "form": words, "layers": form.layers, "tones": tones })
        };
        let networks: Vec<Value> = self.networks.all().map(network).collect();
        let scenes: Vec<&str> = self.scenes.iter().map(|(name, _)| *name).collect();
        Ok(json!({
            "camera": self.camera, "presets": presets, "networks": networks, "scenes": scenes, "max_stops": MAX_STOPS,
            "room": { "width": ROOM.1, "height": ROOM.0 }, "photograph": PHOTOGRAPH, "steps": training.steps,
        }))
    }

    /// All pictures of a state ([`pictures`]).
    ///
    /// # Errors
    /// A state that no lens, sensor or network has.
    pub fn pictures(&mut self, state: &State) -> Result<Vec<u8>, Error> {
        let begun = Instant::now();
        let (coded, clear) = self.behind(state)?;
        let train = advise::train(Path::new(pictures::CAMERA_FILE), state.light.light()?, state.stops);
        pictures::answer(&mut self.live, &coded, &clear, train, begun)
    }

    /// What a training for the lens and the light of a state is to learn.
    ///
    /// # Errors
    /// A state that no lens or sensor has.
    pub fn lesson(&mut self, state: &State) -> Result<Lesson, Error> {
        let camera = view(&state.camera, state.stops, state.psi)?.camera;
        let noise = state.light.noise(state.stops)?;
        let from = self.networks.beginning(state.network.as_deref(), &camera, noise)?;
        let gains = advise::gains(state.light.light()?, state.stops);
        self.lessons += 1;
        Ok(Lesson { name: format!("page-{}", self.lessons), camera, from, gains })
    }

    /// Takes a network that a training made.
    pub fn learned(&mut self, network: Network) {
        self.networks.take(network);
    }

    /// Returns the weight file of a network that a training made.
    ///
    /// # Errors
    /// No such network.
    pub fn weights(&self, file: &str) -> Result<Vec<u8>, Error> {
        self.networks.file(file)
    }

    /// dB of a state's depth.
    ///
    /// # Errors
    /// As [`Engine::pictures`].
    pub fn depth_db(&mut self, state: &State) -> Result<DepthDb, Error> {
        let (coded, clear) = self.behind(state)?;
        pictures::depth_db(&mut self.live, state.psi, &coded, &clear)
    }

    /// The lens of a state, and the clear one beside it.
    fn behind(&mut self, state: &State) -> Result<(Behind, Behind), Error> {
        let subject = self.subject(&state.scene)?;
        let ClearLens { stops, focus_psi } = state.clear;
        // Without a mask both signs are the same lens.
        let clear = Camera { focus_psi, defocus_sign: Sign::Plus, ..without_mask(&state.camera) };
        let own = (state.network.clone(), state.layers);
        Ok((
            self.one(&subject, state, (&state.camera, state.stops), own)?,
            self.one(&subject, state, (&clear, stops), (None, None))?,
        ))
    }

    /// A lens with its network.
    fn one(
        &mut self,
        subject: &Arc<Subject>,
        state: &State,
        (open, stops): (&Camera, f64),
        (name, layers): (Option<String>, Option<usize>),
    ) -> Result<Behind, Error> {
        let view = view(open, stops, state.psi)?;
        let noise = state.light.noise(stops)?;
        let name = name.unwrap_or_else(|| self.networks.name_for(&view.camera, noise));
        let choice = Choice { name, layers, stride: state.stride };
        let network = self.networks.ready(choice.clone())?;
        let shot = Shot { subject: Arc::clone(subject), view, sensor: pictures::sensor(noise, state.seed) };
        Ok(Behind { shot, network, choice })
    }

    fn subject(&self, name: &str) -> Result<Arc<Subject>, Error> {
        let found = self.scenes.iter().find(|(own, _)| *own == name);
        found.map(|(_, subject)| Arc::clone(subject)).ok_or_else(|| {
            let names = alternatives(self.scenes.iter().map(|(name, _)| *name));
            Error::message(format!("scene '{name}': expected {names}"))
        })
    }

    /// PSFs, MTF and contrast over depth of a lens.
    ///
    /// # Errors
    /// A lens that could not be built, a depth where it has no PSFs.
    pub fn lens(&mut self, state: &LensState) -> Result<Value, Error> {
        let view = view(&state.camera, state.stops, state.psi)?;
        let View { camera, psi } = &view;
        let psfs = self.live.psfs(&view)?;
        let over_depth = self.contrasts.get(camera.clone(), |camera| {
            let psis = curve_depths(camera);
            let curves = [contrast(camera, &psis)?, contrast(&without_mask(camera), &psis)?];
            Ok::<_, Error>(Contrast { psis, curves })
        })?;
        let [own, clear] = &over_depth.curves;
        let open = state.stops.exp2();
        let metres =
            camera.nominal_m.and_then(|nominal| distance_m(camera, *psi, nominal)).filter(|m| m.is_finite());
        Ok(json!({
            "f_number": camera.f_number(),
            "distance_m": metres,
            "psf": { "side": PSF_SIDE, "rgba": rgba(&psf_picture(psfs.each_ref().map(Psf::kernel), PSF_SIDE), Tone::Linear) },
            "kernel_side": psfs.each_ref().map(Psf::side),
            "centroid": psfs.each_ref().map(|psf| centroid(psf.kernel().view())),
            "contrast_quarter_cutoff": contrast(camera, &[*psi])?[0],
            "mtf": responses(camera, *psi)?,
            "over_depth": {
                "psi": over_depth.psis.iter().map(|psi| psi * open).collect::<Vec<_>>(), "contrast": own, "clear": clear,
            },
        }))
    }
}

/// The advice for a lens and a light in the words of `edof optics advise`, and the best clear lens in it. It takes seconds and needs nothing that is kept.
///
/// # Errors
/// A lens or range that cannot be compared.
pub fn advice(state: &AdviceState) -> Result<Value, Error> {
    state.camera.check()?;
    let light = state.light.light()?;
    let advice = advised(&state.camera, light, &Statistics::natural())?;
    let Advice { advised, others, .. } = &advice;
    let clear = std::iter::once(advised).chain(others).find(|choice| choice.kind == Kind::Clear);
    let clear = clear.map(|choice| ClearLens { stops: choice.stops, focus_psi: choice.focus_psi });
    Ok(json!({ "lines": advise::lines(&advice, &state.camera, light, None), "clear": clear }))
}
