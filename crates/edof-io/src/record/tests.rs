use super::*;
use crate::raw;
use ndarray::Array2;

fn taken(folder: &Path, name: &str, phase: CfaPhase) -> (PathBuf, RawFrame, RawRecord) {
    let values = Array2::from_shape_fn((4, 6), |(r, c)| (r * 600 + c * 37) as u16);
    let frame = RawFrame::from_values(values, 12, phase).unwrap();
    let path = folder.join(name);
    let record = RawRecord {
        phase,
        depth: 12,
        alignment: raw::writer(&path).unwrap().alignment,
        video: None,
        size: raw::of_ending(&path).filter(|format| format.is_headerless()).map(|_| Size::of(&frame)),
        black_level: Black::from(64),
        white_level: None,
        white_balance: Some(WhiteBalance::try_from([2.0, 1.0, 1.5]).unwrap()),
        colour_matrix: None,
        camera: Camera::resolve("clear").unwrap(),
        psi: vec![8.0],
        tone: Tone::Linear,
        values: Tone::Linear,
        noise: Noise::gaussian(0.01),
        exposure: None,
        sha256: Input::raw_frame("", &frame).sha256,
        provenance: Provenance { command: "edof capture".into(), ..Provenance::default() },
    };
    raw::save(&path, &frame).unwrap();
    save(&path, &record).unwrap();
    (path, frame, record)
}

#[test]
fn a_frame_with_its_record_needs_no_option_in_any_format_or_phase() {
    let folder = tempfile::tempdir().unwrap();
    for phase in CfaPhase::ALL {
        for ending in ["png", "tif", "pgm", "npy", "raw", "bin"] {
            let (path, frame, record) = taken(folder.path(), &format!("frame.{ending}"), phase);
            let found = load(&path).unwrap().record().unwrap();
            assert_eq!(found, record);
            let options = found.options(RawOptions::default());
            let back = raw::load(&path, &options).unwrap();
            assert_eq!(back, frame, "{ending}");
            found.check(&path, &back).unwrap();
        }
    }
}

#[test]
fn a_frame_without_a_record_has_none() {
    assert_eq!(load(Path::new("no-such-frame.png")).unwrap(), Sidecar::Absent);
}

#[test]
fn a_file_of_another_program_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let (path, ..) = taken(folder.path(), "frame.png", CfaPhase::Rggb);
    let large = format!("{{\"phase\": 1, \"sha256\": \"{}\"}}", "0".repeat(1 << 20));
    for foreign in [
        "{\"rating\": 4, \"history\": [{\"module\": \"exposure\"}]}",
        "{\"provenance\": {\"tool\": \"other\"}, \"depth\": 14, \"camera\": \"X\"}",
        "{\"phase\": \"rggb\", \"depth\": 14}",
        "{\"phase\": 0.25, \"alignment\": \"left\"}",
        "[1, 2]",
        "not JSON",
        "",
        "{",
        &large,
    ] {
        std::fs::write(path_of(&path), foreign).unwrap();
        let found = load(&path).unwrap();
        assert_eq!(found, Sidecar::Foreign(path_of(&path)), "{foreign}");
        assert!(!is_beside(&path));
    }
    std::fs::write(path_of(&path), [0xff, 0xfe, 0]).unwrap();
    assert_eq!(load(&path).unwrap(), Sidecar::Foreign(path_of(&path)));
}

#[test]
fn everything_that_is_stated_otherwise_is_a_contradiction() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _, record) = taken(folder.path(), "frame.png", CfaPhase::Gbrg);
    let told = |stated: Stated| -> Vec<String> {
        record.contradictions(&path, &stated).iter().map(ToString::to_string).collect()
    };
    let as_taken = Stated {
        phase: Some(CfaPhase::Gbrg),
        depth: Some(12),
        alignment: Some(Alignment::Top),
        size: None,
        packing: None,
        black_level: Some(64.into()),
        white_level: Some(4096.0),
        tone: Some(Tone::Linear),
        gain: None,
        camera: Some(Camera { name: "same lens".into(), ..record.camera.clone() }),
    };
    assert_eq!(told(as_taken), [""; 0]);
    let otherwise = Stated {
        phase: Some(CfaPhase::Rggb),
        depth: Some(10),
        alignment: Some(Alignment::Bottom),
        size: None,
        packing: None,
        black_level: Some(0.into()),
        white_level: Some(4000.0),
        tone: Some(Tone::Srgb),
        gain: Some(4.0),
        camera: Some(Camera::resolve("ring-outer").unwrap()),
    };
    let says = ["gbrg", "12", "top", "64", "4096", "linear", "clear (they differ in ", "0.01"];
    let found = told(otherwise.clone());
    assert_eq!(found.len(), says.len(), "{found:?}");
    for (line, says) in found.iter().zip(says) {
        assert!(line.contains(&format!("states {says}")), "{line}");
    }
    let overruled = record.with(otherwise.clone());
    assert!(overruled.contradictions(&path, &otherwise).is_empty());
}

#[test]
fn the_record_of_another_frame_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let (path, frame, record) = taken(folder.path(), "frame.png", CfaPhase::Rggb);
    let mut values = frame.values();
    values[(2, 3)] += 1;
    let replaced = RawFrame::from_values(values, 12, CfaPhase::Rggb).unwrap();
    let error = record.check(&path, &replaced).unwrap_err();
    assert!(matches!(error, RecordError::OtherFrame { .. }));
    assert!(error.to_string().ends_with("phase rggb, bit depth 12, alignment top"), "{error}");
}

#[test]
fn a_damaged_record_is_rejected_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let (path, ..) = taken(folder.path(), "frame.png", CfaPhase::Rggb);
    let whole = std::fs::read_to_string(path_of(&path)).unwrap();
    let longer = format!("{whole}{{}}");
    let no_hash = whole.replace("\"sha256\"", "\"sha1\"");
    for damaged in
        [&whole[..whole.len() / 2], &whole[..14], &longer, &no_hash, "{\"phase\": \"rggb\", \"sha256\": 3}"]
    {
        std::fs::write(path_of(&path), damaged).unwrap();
        let error = load(&path).unwrap_err();
        assert!(matches!(error, RecordError::Invalid { .. }) && is_beside(&path), "{damaged}");
        assert!(error.to_string().ends_with("; correct the file, or move it elsewhere"), "{error}");
    }
    std::fs::remove_file(path_of(&path)).unwrap();
    std::fs::create_dir(path_of(&path)).unwrap();
    assert!(matches!(load(&path), Err(RecordError::Read { .. })));
}

#[test]
fn a_record_states_an_exposure_only_where_several_share_the_time() {
    let folder = tempfile::tempdir().unwrap();
    let (path, _, record) = taken(folder.path(), "frame.png", CfaPhase::Rggb);
    assert!(!std::fs::read_to_string(path_of(&path)).unwrap().contains("exposure"));
    let second = RawRecord { exposure: Some(Exposure { number: 2, of: 2 }), ..record };
    save(&path, &second).unwrap();
    assert_eq!(load(&path).unwrap().record(), Some(second));
    let text = std::fs::read_to_string(path_of(&path)).unwrap().replace("\"of\"", "\"off\"");
    std::fs::write(path_of(&path), text).unwrap();
    assert!(matches!(load(&path), Err(RecordError::Invalid { .. })));
}
