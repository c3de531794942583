//! Parsers of files.

use edof_core::CfaPhase;
use edof_core::camera::Camera;
use edof_core::camera::Kernels;
use edof_device::Design;
use edof_device::design::memory::{self, Space};
use edof_golden::cycle::estimate::estimate;
use edof_io::dng::Overrides;
use edof_io::packing::{ByteOrder, Packing};
use edof_io::raw::{Alignment, RawOptions, Size};
use edof_network::weight_file::{WeightFileError, parse_fixed, parse_network};
use edof_optics::SceneFile;
use edof_study::journal::{Header, Journal, Line, Mixing};
use edof_study::methods::dictionary::Dictionary;
use edof_study::{aperture, kodak, single_depth, tolerances};
use std::path::{Path, PathBuf};

/// A file with these bytes, in the folder for temporary files.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, bytes).expect("a file for the input");
    path
}

/// Both kinds of weight files. A changed file has another hash than it states; the right one is put in, so that what follows is tried, too.
pub fn weights(bytes: &[u8]) {
    let path = Path::new("w.safetensors");
    let found = match parse_network(bytes.to_vec(), path) {
        Err(WeightFileError::Hash { found, stated, .. }) if found.len() == stated.len() => {
            let at = bytes.windows(stated.len()).rposition(|text| text == stated.as_bytes());
            at.map(|at| [&bytes[..at], found.as_bytes(), &bytes[at + found.len()..]].concat())
        }
        _ => None,
    };
    let bytes = found.unwrap_or_else(|| bytes.to_vec());
    let _ = parse_network(bytes.clone(), path);
    if let Ok(network) = parse_fixed(bytes, path) {
        network.check().expect("a network that was read is legal");
    }
}

/// Designs, and what is worked out of each.
pub fn design(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(design) = Design::from_json(text) {
        let _ = design.check_board();
        assert!(estimate(&design, None).cycles_per_patch >= 1.0, "a patch takes cycles");
        for stage in design.stages() {
            let _ = stage.drain_latency();
            // Every row of all sets has an address, and is known by it.
            for (space, rows) in memory::rows_of_a_set(&stage).into_iter().enumerate() {
                let (row, half) = (design.sets * rows - 1, 1);
                let last = match space {
                    0 => Space::Weights { bank: stage.banks() - 1, row, half },
                    1 => Space::Thresholds { row },
                    2 => Space::PreviousThresholds { row },
                    _ => Space::Register { row },
                };
                let address = memory::address(stage.index, last);
                assert_eq!(memory::set_of(&design, address).as_ref(), design.sets().last(), "{address:#x}");
            }
        }
    }
}

/// Cameras.
pub fn camera(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(camera) = Camera::from_json(text, "camera.json") {
        let _ = camera.f_number();
    }
}

/// Arrays of NPZ, NPY and safetensors files.
pub fn arrays(bytes: &[u8]) {
    let _ = edof_core::storage::arrays::read(&file("arrays", bytes));
}

/// Banks of PSFs: the first byte chooses NPZ, or NPY with its ψ beside it.
pub fn bank(bytes: &[u8]) {
    let Some((first, bytes)) = bytes.split_first() else { return };
    if first % 2 == 0 {
        let _ = Kernels::load(&file("bank.npz", bytes));
    } else {
        let (psi, psf) = bytes.split_at(bytes.len() / 2);
        file("psi.npy", psi);
        let _ = Kernels::load(&file("psf.npy", psf));
    }
}

/// DNG.
pub fn dng(bytes: &[u8]) {
    let _ = edof_io::dng::decode(bytes, Path::new("shot.dng"), &Overrides::default());
}

/// PNG, TIFF, JPEG, BMP, WebP, PGM and PPM as photographs with their stated curves, and as grey pictures: mattes, depth maps, heights of
/// a mask.
pub fn picture(bytes: &[u8]) {
    let _ = edof_io::picture::decode(bytes, Path::new("picture"));
    let _ = edof_io::photo::open(&file("photo", bytes));
    let _ = edof_io::photo::load_grey(&file("grey", bytes));
    if let Ok(map) = edof_io::photo::load_integers(&file("map", bytes))
        && let Some(filled) = edof_optics::depth_map::fill(map)
    {
        assert!(filled.map.iter().all(|value| edof_optics::depth_map::is_reading(*value)));
    }
}

/// PGM and PPM.
pub fn pnm(bytes: &[u8]) {
    if let Ok(samples) = edof_io::pnm::decode(bytes) {
        let again = edof_io::pnm::decode(&edof_io::pnm::encode(&samples)).expect("what was written is read");
        assert_eq!(again.planes, samples.planes);
    }
}

/// Raw frames in picture files and headerless ones: five bytes of options, then the file.
pub fn raw(bytes: &[u8]) {
    let Some((options, bytes)) = bytes.split_first_chunk::<5>() else { return };
    let [kind, packing, depth, width, height] = *options;
    let options = RawOptions {
        phase: [CfaPhase::Rggb, CfaPhase::Grbg, CfaPhase::Gbrg, CfaPhase::Bggr][usize::from(kind & 3)],
        depth: (kind & 4 != 0).then_some(u32::from(depth)),
        size: (kind & 8 != 0)
            .then_some(Size { width: usize::from(width).max(1), height: usize::from(height).max(1) }),
        alignment: (kind & 16 != 0).then_some(if kind & 32 != 0 {
            Alignment::Top
        } else {
            Alignment::Bottom
        }),
        order: if kind & 64 != 0 { ByteOrder::Big } else { ByteOrder::Little },
        packing: Packing::ALL[usize::from(packing) % Packing::ALL.len()],
    };
    let _ = edof_io::raw::open(&file("frame", bytes), &options, &Overrides::default());
}

/// Sensor files, each used on a frame.
pub fn sensor(bytes: &[u8]) {
    if let Ok((sensor, _)) = edof_io::sensor::file::load(&file("sensor.safetensors", bytes)) {
        let Size { width, height } = sensor.tables().size;
        sensor.correct(ndarray::Array2::from_elem((height, width), 40_000).view_mut());
    }
}

/// Lists of a sensor's defects.
pub fn defects(bytes: &[u8]) {
    let _ = edof_io::sensor::list::load(&file("defects.txt", bytes));
}

/// Scenes of layers.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(scene) = SceneFile::parse(text) {
        assert!(scene.files().count() == 2 * scene.layers.len() - 1, "each layer but the first has a matte");
    }
}

/// Records beside raw frames.
pub fn record(bytes: &[u8]) {
    let raw = file("raw.pgm", b"");
    file("raw.json", bytes);
    let at = edof_io::record::path_of(&raw);
    std::fs::write(at, bytes).expect("a file for the input");
    let _ = edof_io::record::load(&raw);
}

/// Dictionaries of sharp atoms.
pub fn dictionary(bytes: &[u8]) {
    let _ = Dictionary::load(Some(&file("dictionary.safetensors", bytes)));
}

/// Rows of studies: the first byte chooses the study.
pub fn rows(bytes: &[u8]) {
    let Some((first, bytes)) = bytes.split_first() else { return };
    match first % 4 {
        0 => rows_of::<kodak::Row>(bytes),
        1 => rows_of::<single_depth::Row>(bytes),
        2 => rows_of::<tolerances::Row>(bytes),
        _ => rows_of::<aperture::Row>(bytes),
    }
}

/// Merged with itself, then opened for more rows, which cuts a torn last line off: what was opened once can be opened again.
fn rows_of<L: Line>(bytes: &[u8]) {
    let path = file("rows.jsonl", bytes);
    let Ok(header) = Header::read(&path) else { return };
    let mixing = Mixing { any_revision: true, any_machine: true };
    let _ =
        Journal::<L>::merged(&std::env::temp_dir().join("all.jsonl"), &[path.clone(), path.clone()], mixing);
    if let Ok(opened) = Journal::<L>::open(&path, header.clone(), mixing) {
        let rows = opened.rows().len();
        drop(opened);
        let again = Journal::<L>::open(&path, header, mixing).expect("what was opened can be opened again");
        assert_eq!(again.rows().len(), rows);
    }
}
