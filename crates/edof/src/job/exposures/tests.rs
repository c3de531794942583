use crate::job::{CaptureJob, CaptureOutputs, SceneSource, Synthetic, VideoOutput};
use crate::presets::lens;
use edof_core::camera::{Camera, PsfBank};
use edof_core::storage::provenance::Provenance;
use edof_core::{Noise, RawFrame, Tone};
use edof_io::raw::{self, RawOptions, Size};
use edof_io::record::{self, Exposure, RawRecord};
use edof_optics::Sensor;
use edof_optics::capture::Approximation;
use edof_optics::draw::Builtin;
use std::path::{Path, PathBuf};

/// A capture of leaves into a folder.
fn job(folder: &Path, noise: &str) -> CaptureJob {
    CaptureJob {
        scene: SceneSource::Synthetic(Synthetic {
            kind: Builtin::Leaves,
            size: Size { width: 96, height: 64 },
            psi: vec![3.0],
            seed: 7,
        }),
        camera: lens::resolve("clear-mid", None).unwrap().camera,
        tone: None,
        sensor: Sensor { noise: noise.parse().unwrap(), seed: 5, ..Sensor::default() },
        exposure: None,
        approximation: Approximation::default(),
        is_measured: false,
        outputs: CaptureOutputs::raw(folder.join("o.png")),
        provenance: Provenance::default(),
    }
}

/// The frame and the record that a capture writes.
fn taken(job: &CaptureJob) -> (RawFrame, RawRecord) {
    job.run(&|note| panic!("{note:?}"), |_, _, _| ()).unwrap();
    let record = record::load(&job.outputs.raw).unwrap().record().unwrap();
    (raw::load(&job.outputs.raw, &record.options(RawOptions::default())).unwrap(), record)
}

#[test]
fn each_exposure_is_a_capture_of_its_focus_with_its_share_of_the_electrons_and_a_seed_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    for (foci, whole, share) in [
        (&[2.0, 6.0][..], "sensor", "sensor:gain=2"),
        (&[2.0, 2.0], "sensor:full-well=4000:read-noise=9", "sensor:full-well=4000:read-noise=9:gain=2"),
        (&[6.0, 0.0, 3.5], "sensor:gain=4", "sensor:gain=12"),
        (&[1.0, 7.0], "none", "none"),
    ] {
        let exposures = job(folder.path(), whole).exposures(foci).unwrap();
        for (place, (exposure, &focus_psi)) in exposures.iter().zip(foci).enumerate() {
            let (frame, record) = taken(exposure);
            let alone = job(folder.path(), share);
            let camera = Camera { focus_psi, ..alone.camera.clone() };
            let sensor = Sensor { seed: alone.sensor.seed + place as u64, ..alone.sensor.clone() };
            let (expected, single) = taken(&CaptureJob { camera, sensor, ..alone });
            assert_eq!(frame, expected, "{foci:?} {whole}, {place}");
            assert_eq!(record.exposure, Some(Exposure { number: place + 1, of: foci.len() }));
            assert_eq!(RawRecord { exposure: None, ..record }, single);
        }
    }
}

/// Mean and mean square difference from `truth` of the values of frames, summed pixel by pixel.
fn mean_and_error(frames: &[RawFrame], truth: &RawFrame) -> (f64, f64) {
    let count = truth.pixels().len() as f64;
    let values = truth
        .values()
        .indexed_iter()
        .map(|(at, &exact)| {
            let sum: f64 = frames.iter().map(|frame| f64::from(frame.values()[at])).sum();
            (sum / frames.len() as f64, f64::from(exact))
        })
        .collect::<Vec<_>>();
    let mean = values.iter().map(|(value, _)| value).sum::<f64>() / count;
    let error = values.iter().map(|(value, exact)| (value - exact).powi(2)).sum::<f64>() / count;
    (mean, error)
}

#[test]
fn two_exposures_at_one_focus_have_the_mean_of_the_whole_time_and_pay_for_reading_twice() {
    let folder = tempfile::tempdir().unwrap();
    let at = |noise: &str, foci: &[f64]| -> Vec<RawFrame> {
        job(folder.path(), noise).exposures(foci).unwrap().iter().map(|one| taken(one).0).collect()
    };
    let truth = &at("none", &[4.0])[0];
    let error = |noise: &str, foci: &[f64]| {
        let (mean, error) = mean_and_error(&at(noise, foci), truth);
        let exact = mean_and_error(std::slice::from_ref(truth), truth).0;
        assert!((mean / exact - 1.0).abs() < 0.005, "{noise}: mean {mean}, without noise {exact}");
        error
    };
    // Photons are the same ones, in two frames; what is read twice has twice the variance.
    let photons = "sensor:full-well=1000:read-noise=0";
    let ratio = error(photons, &[4.0, 4.0]) / error(photons, &[4.0]);
    assert!((ratio - 1.0).abs() < 0.1, "photons: {ratio}");
    let reading = "sensor:full-well=1e6:read-noise=20000";
    let ratio = error(reading, &[4.0, 4.0]) / error(reading, &[4.0]);
    assert!((ratio - 2.0).abs() < 0.2, "reading: {ratio}");
}

#[test]
fn one_focus_takes_the_whole_time_and_is_no_exposure_of_several() {
    let folder = tempfile::tempdir().unwrap();
    let whole = job(folder.path(), "0.01");
    let [one] = &whole.exposures(&[2.5]).unwrap()[..] else { panic!("several") };
    assert_eq!((one.camera.focus_psi, one.exposure), (2.5, None));
    assert_eq!((&one.sensor, &one.outputs.raw), (&whole.sensor, &whole.outputs.raw));
}

#[test]
fn files_have_the_number_of_their_exposure() {
    let light = Some("a/light.tif".into());
    let all =
        CaptureOutputs { sharp: Some("sharp.png".into()), light, ..CaptureOutputs::raw("a.b/o.pgm".into()) };
    let [first, second] = [1, 2].map(|number| all.of_exposure(number, 2));
    assert_eq!([first.raw, second.raw], ["a.b/o-1.pgm", "a.b/o-2.pgm"].map(PathBuf::from));
    assert_eq!([first.light, second.light], ["a/light-1.tif", "a/light-2.tif"].map(|file| Some(file.into())));
    assert_eq!([first.sharp, second.sharp], [all.sharp, None]);
    assert_eq!(CaptureOutputs::raw("o".into()).of_exposure(2, 3).raw, Path::new("o-2"));
}

#[test]
fn what_exposures_cannot_have_is_rejected() {
    let whole = job(Path::new("nowhere"), "sensor");
    let why = |job: &CaptureJob, foci: &[f64]| job.exposures(foci).unwrap_err().to_string();
    assert_eq!(why(&whole, &[]), "0 foci: must be 1 to 4, one for each exposure");
    assert_eq!(why(&whole, &[1.0; 5]), "5 foci: must be 1 to 4, one for each exposure");
    let noise = |noise| CaptureJob { sensor: Sensor { noise, ..whole.sensor.clone() }, ..whole.clone() };
    assert!(
        why(&noise(Noise::gaussian(0.01)), &[2.0, 6.0]).starts_with("noise 0.01: Gaussian noise states no")
    );
    let dark = noise("sensor:full-well=3:gain=2".parse().unwrap());
    assert!(
        why(&dark, &[2.0, 6.0])
            .starts_with("the share of each exposure: noise: gain is 4, expected 1 or more")
    );
    let kernels = PsfBank { file: "lens.npz".into(), sha256: String::new(), centre: false, kernels: None };
    let camera = Camera { psf_bank: Some(kernels), ..whole.camera.clone() };
    assert!(
        why(&CaptureJob { camera, ..whole.clone() }, &[2.0])
            .starts_with("the camera's PSFs are those of a bank")
    );
    let video = VideoOutput { path: "frame.2vuy".into(), values: Tone::Linear, greys: None };
    let outputs = CaptureOutputs { video: Some(video), ..whole.outputs.clone() };
    assert!(
        why(&CaptureJob { outputs, ..whole.clone() }, &[2.0, 6.0])
            .starts_with("the board takes one raw frame")
    );
}
