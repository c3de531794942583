//! EDIDs of the receiver read by `edid-decode`, for every video mode of a board.

use edof_device::i2c::edid::edid;
use edof_device::video::VideoTiming;
use std::fs;
use std::process::Command;

/// Whether `edid-decode` finds no failure, and what it prints.
fn decoded(bytes: &[u8]) -> (bool, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("edid.bin");
    fs::write(&file, bytes).unwrap();
    let output = Command::new("edid-decode").args(["--check", "--native-resolution"]).arg(&file).output();
    let output = output.expect("edid-decode is missing: scripts/prepare.sh, need_simulators installs it");
    (output.status.success(), String::from_utf8(output.stdout).unwrap())
}

/// Native, preferred and listed modes, rates and pixel clock follow from the design's mode; 640x480 stands beside it.
#[test]
fn the_edid_of_every_mode_conforms_and_names_that_mode_first() {
    let modes = [
        (
            VideoTiming::P720_60,
            "1280x720    60.000000 Hz",
            "VIC   4",
            "59-60 Hz V, 31-45 kHz H, max dotclock 80 MHz",
        ),
        (
            VideoTiming::P1080_60,
            "1920x1080   60.000000 Hz",
            "VIC  16",
            "59-60 Hz V, 31-68 kHz H, max dotclock 150 MHz",
        ),
        (
            VideoTiming::P1080_30,
            "1920x1080   30.000000 Hz",
            "VIC  34",
            "30-60 Hz V, 31-34 kHz H, max dotclock 80 MHz",
        ),
    ];
    assert_eq!(modes.map(|(mode, ..)| mode), VideoTiming::MODES);
    for (mode, timing, code, limits) in modes {
        let (passes, report) = decoded(&edid(mode));
        assert!(passes && report.contains("EDID conformity: PASS"), "{report}");
        let lines: Vec<&str> = report.lines().map(str::trim).collect();
        let of = |start: &str| -> Vec<&str> {
            lines.iter().filter(|line| line.starts_with(start)).copied().collect()
        };
        let [detailed] = of("DTD")[..] else { panic!("{report}") };
        assert!(detailed.contains(timing), "{detailed}");
        let [first, second] = of("VIC")[..] else { panic!("{report}") };
        assert!(first.starts_with(code) && first.contains(timing), "{first}");
        assert!(second.starts_with("VIC   1:   640x480"), "{second}");
        assert_eq!(of("Native detailed modes"), ["Native detailed modes: 1"]);
        assert!(report.contains(limits), "{report}");
        let native = lines.iter().position(|line| *line == "Native Video Resolution:").unwrap();
        assert_eq!(lines[native + 1], mode.size());
    }
}

/// What `edid-decode` must not pass: rates below the mode's, and no word on the range of RGB.
#[test]
fn injected_mistakes_fail() {
    let whole = |mut bytes: [u8; 256]| {
        for block in bytes.chunks_mut(128) {
            block[127] = block[..127].iter().fold(0u8, |sum, byte| sum.wrapping_sub(*byte));
        }
        bytes
    };
    let mut slow = edid(VideoTiming::P1080_60);
    slow[0x5a + 8] = 45;
    let mut silent = edid(VideoTiming::P720_60);
    silent[0x89] = 0;
    for wrong in [slow, silent] {
        let (passes, report) = decoded(&whole(wrong));
        assert!(!passes && report.contains("EDID conformity: FAIL"), "{report}");
    }
}
