//! Nothing saturates where a network looks through its own camera: every fixed network in `weights/`, photographs at both ends of the
//! range of depths. (A sharp photograph without the camera's blur is no frame that it ever gives.) Photographs: `EDOF_KODAK`, else
//! `../shared/data/kodak` beside the project.

use edof_core::RawFrame;
use edof_core::camera::Camera;
use edof_golden::Golden;
use edof_network::weight_file;
use edof_optics::Scene;
use edof_optics::Sensor;
use edof_optics::capture::{Approximation, capture};
use std::path::{Path, PathBuf};

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> =
        entries.map(|e| e.path()).filter(|p| p.to_string_lossy().ends_with(ending)).collect();
    paths.sort();
    paths
}

fn taken(camera: &Camera, photo: &Path, psi: f64) -> RawFrame {
    let scene = Scene::flat("photo", edof_io::photo::load(photo).unwrap(), psi);
    capture(&scene, camera, &Sensor::default(), &Approximation::default()).unwrap().raw
}

#[test]
#[ignore = "needs photographs: scripts/test-photographs.sh"]
fn nothing_saturates_on_photographs_that_a_networks_own_camera_takes() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("EDOF_KODAK").map(PathBuf::from);
    let photos = files(&folder.unwrap_or_else(|| project.join("../shared/data/kodak")), ".png");
    assert!(
        !photos.is_empty(),
        "no photographs: EDOF_KODAK must name a folder with kodim01.png ... kodim24.png"
    );
    let networks = files(&project.join("weights"), ".fixed.safetensors");
    assert!(!networks.is_empty(), "no fixed networks in weights/");
    // Many networks look through the same lens: each photograph is taken once.
    let mut shots: Vec<(Camera, &Path, RawFrame)> = vec![];
    for (file, network) in networks.iter().map(|file| (file, weight_file::load_fixed(file).unwrap())) {
        let camera = network.origin.camera.clone();
        let golden = Golden::new(network).unwrap();
        for (photo, psi) in photos.iter().step_by(8).zip(camera.psi_range.into_iter().cycle()) {
            let known = shots.iter().position(|(lens, of, _)| *lens == camera && *of == photo.as_path());
            let at = known.unwrap_or_else(|| {
                shots.push((camera.clone(), photo, taken(&camera, photo, psi)));
                shots.len() - 1
            });
            let count = golden.frame(&shots[at].2).unwrap().counts.saturations();
            assert_eq!(count, 0, "{}, {}, psi {psi}", file.display(), photo.display());
        }
    }
}
