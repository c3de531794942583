use super::*;
use crate::fixed_network::CalibratedOn;
use crate::network::{Condition, Recurrence, Shrinkage};
use edof_core::camera::Camera;
use edof_core::geometry::Window;
use edof_core::noise::Noise;
use edof_core::storage::provenance::Provenance;
use edof_core::tone::Tone;

fn small_network() -> Network {
    let form = Form {
        window: Window::new(8).unwrap(),
        codes: 4,
        layers: 4,
        shrinkage: Shrinkage::OneSided,
        recurrence: Recurrence::Direct,
        linear_path: true,
        tied: false,
        exposures: 1,
    };
    let ramp = |h, w| Array2::from_shape_fn((h, w), |(r, c)| (r * w + c) as f32 / 100.0);
    Network {
        form,
        analysis: ramp(4, 64),
        thresholds: vec![Array1::zeros(4); 3],
        recurrent: vec![ramp(4, 4), ramp(4, 4)],
        dictionary: ramp(192, 4),
        linear_path: Some(ramp(192, 64)),
        origin: Origin::untrained("small", Camera::resolve("clear").unwrap()),
    }
}

fn saved(change: impl FnOnce(&mut Network)) -> (tempfile::TempDir, PathBuf, Network) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("net.safetensors");
    let mut network = small_network();
    change(&mut network);
    save_network(&path, &network).unwrap();
    (dir, path, network)
}

#[test]
fn a_network_comes_back_and_the_same_network_gives_the_same_bytes() {
    let (dir, path, network) = saved(|_| ());
    assert_eq!(load_network(&path).unwrap(), network);
    let again = dir.path().join("again");
    save_network(&again, &network).unwrap();
    assert_eq!(std::fs::read(path).unwrap(), std::fs::read(again).unwrap());
}

#[test]
fn a_network_of_two_exposures_comes_back_and_others_say_nothing_of_exposures() {
    let (_dir, path, network) = saved(two_exposures);
    assert_eq!(load_network(&path).unwrap(), network);
    let cameras = network.origin.cameras();
    assert_eq!(cameras[0], network.origin.camera);
    assert_eq!(cameras[1], Camera { focus_psi: 6.0, ..cameras[0].clone() });
    let mut unfocused = network;
    unfocused.origin.further_foci.clear();
    assert_eq!(
        unfocused.check().unwrap_err().to_string(),
        "further_foci: 0 given, a form of exposures 2 has 1"
    );
    let (_dir, path, _) = saved(|_| ());
    let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    assert!(text.contains("window") && !text.contains("exposures") && !text.contains("foci"), "{text}");
}

#[test]
fn integers_have_one_exposure() {
    let mut fixed = small_fixed();
    fixed.form.exposures = 2;
    let why = "exposures 2: must be 1 here; a network of several raw frames is computed in floating point on the CPU alone, by 'edof \
               reconstruct' with all raw frames of a scene";
    assert_eq!(fixed.check().unwrap_err().to_string(), why);
    let (_dir, path, _) = saved(two_exposures);
    assert_eq!(load_fixed(&path).unwrap_err().to_string(), format!("{}: {why}", path.display()));
    let (_dir, path, _) = saved(|_| ());
    assert!(
        load_fixed(&path).unwrap_err().to_string().ends_with("holds a float network, expected a fixed one")
    );
}

/// Makes a network take two exposures.
fn two_exposures(network: &mut Network) {
    network.form.exposures = 2;
    network.origin.further_foci = vec![6.0];
    network.analysis = Array2::ones((4, 128));
    network.linear_path = Some(Array2::ones((192, 128)));
}

fn small_fixed() -> FixedNetwork {
    let float = small_network();
    let whole = |m: &Array2<f32>| FixedMatrix { weights: m.mapv(|v| v as i16), fraction: 12 };
    FixedNetwork {
        form: float.form,
        code_bits: 16,
        stride: Stride::PATCH,
        overlap: Overlap::Hann,
        analysis: whole(&float.analysis),
        thresholds: vec![Array1::zeros(4); 3],
        recurrent: float.recurrent.iter().map(whole).collect(),
        dictionary: FixedMatrix { weights: Array2::ones((128, 4)), fraction: 12 },
        linear_path: Some(FixedMatrix { weights: Array2::ones((128, 64)), fraction: 12 }),
        code_fractions: vec![12, 11, 13],
        origin: float.origin,
        float_hash: "0".into(),
        quantized: Some(Quantized {
            headroom: 2.0,
            calibration: CalibratedOn {
                stride: Stride::new(2).unwrap(),
                windows: 5,
                psis: vec![0.0, 0.1],
                conditions: vec![Condition {
                    tone: Tone::Srgb,
                    noise: Noise::sensor(2.0),
                    least_noise: Noise::None,
                }],
                depth: 12,
            },
            finetune_steps: 0,
            provenance: Provenance { command: "edof quantize small".into(), ..Provenance::default() },
        }),
    }
}

#[test]
fn a_fixed_network_comes_back() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("net.fixed.safetensors");
    let fixed = small_fixed();
    save_fixed(&path, &fixed).unwrap();
    assert_eq!(load_fixed(&path).unwrap(), fixed);
    assert!(matches!(load_network(&path), Err(WeightFileError::Kind { found: "fixed", .. })));
}

/// The metadata's text of a saved file, changed and put back at the same length.
fn with_metadata(path: &Path, change: impl Fn(&str) -> String) {
    let bytes = std::fs::read(path).unwrap();
    let header = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    let text = String::from_utf8(bytes[8..8 + header].to_vec()).unwrap();
    let changed = change(&text);
    assert_ne!(changed, text);
    let header = (changed.len() as u64).to_le_bytes();
    std::fs::write(path, [&header[..], changed.as_bytes(), &bytes[8 + text.len()..]].concat()).unwrap();
}

#[test]
fn a_changed_word_of_the_metadata_is_noticed() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("net.fixed.safetensors");
    let texts = [
        ("edof quantize small", "edof quantize large"),
        (r#"\"headroom\":2.0"#, r#"\"headroom\":3.0"#),
        (r#"\"code_fractions\":[12,11,13]"#, r#"\"code_fractions\":[12,11,12]"#),
        (r#"\"name\":\"small\""#, r#"\"name\":\"other\""#),
        (r#"\"float_sha256\":\"0\""#, r#"\"float_sha256\":\"1\""#),
    ];
    for (old, new) in texts {
        save_fixed(&path, &small_fixed()).unwrap();
        with_metadata(&path, |text| text.replacen(old, new, 1));
        assert!(matches!(load_fixed(&path), Err(WeightFileError::Hash { .. })), "{old}");
    }
}

#[test]
fn outputs_in_another_format_are_rejected() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("net.fixed.safetensors");
    let fixed = small_fixed();
    save_fixed(&path, &fixed).unwrap();
    let (hash, digits) = (parse_hash(std::fs::read(&path).unwrap(), &path).unwrap(), 64);
    assert_eq!(hash.len(), digits);
    // A file of another maker, whose hash is right.
    with_metadata(&path, |text| text.replacen(r#"\"output_fraction\":14"#, r#"\"output_fraction\":13"#, 1));
    let Err(WeightFileError::Hash { found, .. }) = load_fixed(&path) else { panic!("hash") };
    with_metadata(&path, |text| text.replacen(&hash, &found, 1));
    let error = load_fixed(&path).unwrap_err().to_string();
    assert!(error.contains("its outputs have 13 fraction bits"), "{error}");
}

#[test]
fn fraction_bits_beyond_every_format_are_rejected() {
    for change in [
        |n: &mut FixedNetwork| n.analysis.fraction = u32::MAX,
        |n: &mut FixedNetwork| n.recurrent[1].fraction = u32::MAX - 3,
        |n: &mut FixedNetwork| n.dictionary.fraction = 1 << 31,
        |n: &mut FixedNetwork| n.code_fractions[2] = u32::MAX,
        |n: &mut FixedNetwork| n.linear_path.as_mut().unwrap().fraction = 49,
    ] {
        let mut fixed = small_fixed();
        change(&mut fixed);
        assert!(matches!(fixed.check(), Err(FixedNetworkError::Fraction { .. })));
    }
}

#[test]
fn a_truncated_file_is_rejected_wherever_it_ends() {
    let (_dir, path, _) = saved(|_| ());
    let whole = std::fs::read(&path).unwrap();
    for kept in [0, 4, 100, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..kept]).unwrap();
        assert!(matches!(load_network(&path), Err(WeightFileError::Container { .. })), "{kept} bytes");
    }
}

#[test]
fn a_changed_weight_is_noticed() {
    let (_dir, path, _) = saved(|_| ());
    let mut bytes = std::fs::read(&path).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    std::fs::write(&path, bytes).unwrap();
    assert!(matches!(load_network(&path), Err(WeightFileError::Hash { .. })));
}

#[test]
fn nan_in_weights_is_rejected_on_saving() {
    let dir = tempfile::tempdir().unwrap();
    let mut network = small_network();
    network.recurrent[1][(0, 0)] = f32::NAN;
    let error = save_network(&dir.path().join("n"), &network).unwrap_err().to_string();
    assert!(error.ends_with("recurrent: holds NaN, every weight must be a finite number"), "{error}");
}

#[test]
fn a_foreign_safetensors_file_is_rejected() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("foreign");
    let none: Vec<(&str, TensorView<'_>)> = vec![];
    std::fs::write(&path, safetensors::serialize(none, None).unwrap()).unwrap();
    assert!(matches!(load_network(&path), Err(WeightFileError::Foreign { .. })));
}
