//! `edof stream`: frames through pipes and files become the pictures that the same frames become one by one.

use crate::support::{Place, Run};
use serde_json::Value;
use std::process::Command;

const FRAMES: usize = 3;
const SIZE: (usize, usize) = (48, 32);
const LINE: &str = "--size 48x32 --weights net.fixed.safetensors";

/// A place with three frames of 12 bits in words, as one file and one by one, and as `12p`.
fn ready() -> Place {
    let place = Place::new();
    place.fixed_network("net.fixed.safetensors");
    let (mut all, mut packed) = (vec![], vec![]);
    for frame in 0..FRAMES {
        let value = |i: usize| ((i * 37 + i / 48 * 101 + 900 * frame) % 4096) as u16;
        let values: Vec<u16> = (0..SIZE.0 * SIZE.1).map(value).collect();
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        place.write(&format!("{frame}.raw"), &bytes);
        all.extend(bytes);
        for pair in values.chunks_exact(2) {
            let bits = u32::from(pair[0]) | u32::from(pair[1]) << 12;
            packed.extend(&bits.to_le_bytes()[..3]);
        }
    }
    place.write("all.raw", all);
    place.write("all.12p", packed);
    place
}

/// A line of bash with `edof` in place of the program, ended after a minute.
fn bash(place: &Place, line: &str) -> Run {
    let line = line.replace("edof ", &format!("timeout 60 {} ", env!("CARGO_BIN_EXE_edof")));
    Command::new("bash").args(["-c", &line]).current_dir(place.path("")).output().unwrap().into()
}

fn read(place: &Place, file: &str) -> Vec<u8> {
    std::fs::read(place.path(file)).unwrap()
}

/// The planes of the frames of a y4m file, one after the other.
fn planes(y4m: &[u8]) -> Vec<&[u8]> {
    let header = b"YUV4MPEG2 W48 H32 F30:1 Ip A1:1 C422 XCOLORRANGE=LIMITED\n";
    let frames = y4m.strip_prefix(header).unwrap().chunks_exact(6 + 2 * SIZE.0 * SIZE.1);
    assert!(frames.remainder().is_empty());
    frames.map(|frame| frame.strip_prefix(b"FRAME\n").unwrap()).collect()
}

#[test]
fn a_stream_of_frames_gives_the_pictures_of_the_frames() {
    let place = ready();
    bash(&place, &format!("cat all.12p | edof stream - {LINE} --packing 12p --phase gbrg --out - > all.y4m"))
        .done();
    let file = read(&place, "all.y4m");
    let pictures = planes(&file);
    assert_eq!(pictures.len(), FRAMES);
    let yuyv = |planes: &[u8]| -> Vec<u8> {
        let (luma, chroma) = planes.split_at(SIZE.0 * SIZE.1);
        let (cb, cr) = chroma.split_at(chroma.len() / 2);
        luma.chunks_exact(2).zip(cb.iter().zip(cr)).flat_map(|(y, (cb, cr))| [y[0], *cb, y[1], *cr]).collect()
    };
    // The board's pictures are of the upper 14 of 16 bits, which 12 bits leave as they are.
    for (frame, planes) in pictures.iter().enumerate() {
        let line = format!("reconstruct {frame}.raw --size 48x32 --bit-depth 12 --phase gbrg");
        place.edof(&format!("{line} --weights net.fixed.safetensors --board --out {frame}.png")).done();
        assert!(read(&place, &format!("{frame}.yuyv")) == yuyv(planes), "frame {frame}");
    }
    // The same from words in a file, in other formats.
    let words = format!("stream all.raw {LINE} --bit-depth 12 --phase gbrg");
    place.edof(&format!("{words} --format yuv422p --out all.planes")).done();
    assert!(read(&place, "all.planes") == pictures.concat());
    place.edof(&format!("{words} --format yuyv422 --live --out some.yuyv --json pace.json")).done();
    let pace: Value = serde_json::from_slice(&read(&place, "pace.json")).unwrap();
    let [frames, dropped] = ["frames", "dropped"].map(|key| pace[key].as_u64().unwrap() as usize);
    assert_eq!((frames + dropped, read(&place, "some.yuyv").len()), (FRAMES, frames * 2 * SIZE.0 * SIZE.1));
}

#[test]
fn a_cameras_name_for_its_pixels_states_packing_phase_and_bits() {
    let place = ready();
    let picture = |options: &str| {
        place.edof(&format!("{options} {LINE} --out a.y4m")).done();
        read(&place, "a.y4m")
    };
    let stated = picture("stream all.12p --packing 12p --phase gbrg");
    for options in [
        "stream all.12p --packing BayerGB12p",
        "stream all.12p --packing bayergb12P --phase BayerGB",
        "stream all.12p --phase BayerGB12p",
        "stream all.raw --packing GB12",
        "stream all.raw --phase SGBRG12",
    ] {
        assert!(picture(options) == stated, "{options}");
    }
    let frame = "reconstruct 0.raw --size 48x32 --weights net.fixed.safetensors --board";
    place.edof(&format!("{frame} --packing BayerGB12 --out named.png")).done();
    place.edof(&format!("{frame} --bit-depth 12 --phase gbrg --out plain.png")).done();
    assert!(read(&place, "named.yuyv") == read(&place, "plain.yuyv"));
    for (options, message) in [
        (
            "--packing BayerRG12p --phase gbrg",
            "--phase gbrg: --packing BayerRG12p states rggb; leave --phase out",
        ),
        (
            "--packing bytes --phase BayerRG12p",
            "--packing bytes: --phase BayerRG12p states 12p; leave --packing out",
        ),
        ("--packing pRAA --phase pRCC", "--packing pRAA: --phase pRCC states mipi12; leave --packing out"),
        (
            "--packing BayerRG12 --bit-depth 10",
            "--bit-depth 10: --packing BayerRG12 states 12 bits; leave --bit-depth out",
        ),
        ("--packing BayerRG12p --bit-depth 12", "--bit-depth 12: 12p states the bits"),
    ] {
        place.edof(&format!("stream all.raw {LINE} --out o.y4m {options}")).refused(&[message]);
    }
    place.raw("shot.png", 48, 32);
    let named = "--phase BayerRG12p: states a packing, which only files without a header have; state their --size, or give --phase rggb";
    place.edof("reconstruct shot.png --phase BayerRG12p --out o.png").refused(&[named]);
    place.edof("sensor --dark shot.png --phase BayerRG12p --out o").refused(&[named]);
    let run = place.edof(&format!("stream all.raw {LINE} --out o.y4m --packing BayerRG10Packed"));
    let expected = "10p, mipi12, 12p, 12packed or 2vuy, or a camera's name for its pixels, such as BayerRG12p or pRCC (docs/stream.md)";
    assert!(run.code == Some(2) && run.err.contains(expected), "{}", run.err);
}

#[test]
fn a_stream_takes_the_network_of_a_clear_lens_and_names_what_a_network_was_trained_for() {
    let place = ready();
    let line = "stream all.raw --size 48x32 --bit-depth 12";
    let run = place.edof(&format!("{line} --out usual.y4m")).done();
    let named = "network edof-t4w12-clear-light, trained for the lens clear-mid\n";
    assert_eq!(run.err.matches(named).count(), 1, "{}", run.err);
    let run = place.edof(&format!("{line} --weights edof-t4w12-outer --out other.y4m")).done();
    for part in [
        "network edof-t4w12-outer, trained for the lens ring-outer on pictures of tone linear: expect about 2 dB less",
        "use --weights edof-t4w12-outer-light",
    ] {
        assert!(run.err.contains(part), "{}", run.err);
    }
}

#[test]
fn lines_with_padding_are_read_without_it() {
    let place = ready();
    let padded: Vec<u8> =
        read(&place, "all.raw").chunks(2 * SIZE.0).flat_map(|line| [line, &[7; 32]].concat()).collect();
    place.write("padded.raw", padded);
    let line = format!("{LINE} --bit-depth 12 --format yuyv422");
    place.edof(&format!("stream all.raw {line} --out plain.yuyv")).done();
    place.edof(&format!("stream padded.raw {line} --line-bytes 128 --out padded.yuyv")).done();
    assert!(read(&place, "plain.yuyv") == read(&place, "padded.yuyv"));
    // Frames from files, and frames of a sensor, are read so, too.
    let frame = "--size 48x32 --bit-depth 12 --weights net.fixed.safetensors --board";
    place.write("two.raw", &read(&place, "padded.raw")[..2 * 128 * SIZE.1]);
    place.write("one.raw", &read(&place, "padded.raw")[..128 * SIZE.1]);
    place.edof(&format!("reconstruct one.raw {frame} --line-bytes 128 --out one.png")).done();
    place.edof(&format!("reconstruct 0.raw {frame} --out plain.png")).done();
    assert!(read(&place, "one.yuyv") == read(&place, "plain.yuyv"));
    let lost = "as many as 1 frame with lines of 128 bytes: --line-bytes 128";
    place.edof(&format!("reconstruct one.raw {frame} --out o.png")).refused(&[lost]);
    place
        .edof(&format!("stream two.raw {line} --out o.yuyv"))
        .refused(&["as many as 2 frames with lines of 128 bytes: --line-bytes 128"]);
    place
        .edof(&format!("reconstruct all.raw {frame} --out o.png"))
        .refused(&["as many as 3 frames have, which 'edof stream' and 'edof sensor' read"]);
    place
        .edof(&format!("stream all.raw {line} --line-bytes 100 --out o.yuyv"))
        .refused(&["as many as 3 frames without padding: leave out --line-bytes"]);
    place.write("cut.raw", &read(&place, "all.raw")[..2 * 3072 + 6]);
    for command in ["stream cut.raw --size 48x32 --out o.yuyv", "sensor --dark cut.raw --size 48x32 --out o"]
    {
        place.edof(command).refused(&["cut.raw: 6150 bytes, expected", "; 2 whole frames and 6 bytes"]);
    }
    place
        .edof(&format!("stream padded.raw {line} --line-bytes 95 --out o.yuyv"))
        .refused(&["--line-bytes: 95 bytes for a line of 48 pixels, expected at least 96 packed as words"]);
}

#[test]
fn words_that_seem_to_have_fewer_bits_are_named_and_a_record_is_believed() {
    let place = ready();
    let pale: Vec<u8> = vec![200; SIZE.0 * SIZE.1];
    place.write("pale.raw", &pale);
    let line = format!("stream pale.raw {LINE} --packing bytes --out pale.y4m");
    let grey = "the least value of the first frame is 200 of 255, and --black-level is 0";
    assert!(place.edof(&line).done().err.contains(grey));
    assert!(!place.edof(&format!("{line} --black-level 16")).done().err.contains(grey));
    let lost = "--black-level 240: 100 % of the first frame's values are below it, the largest is 200 of 255";
    assert!(place.edof(&format!("{line} --black-level 240")).done().err.contains(lost));
    let dark = "the largest value of the first frame is 4088 of 65535";
    let run = place.edof(&format!("stream all.raw {LINE} --out dark.y4m")).done();
    assert!(run.err.contains(dark) && run.err.contains("as in --bit-depth 12"), "{}", run.err);
    let run = place.edof(&format!("stream all.raw {LINE} --bit-depth 12 --out light.y4m")).done();
    assert!(!run.err.contains(dark), "{}", run.err);
    let top: Vec<u8> = read(&place, "0.raw")
        .as_chunks()
        .0
        .iter()
        .flat_map(|value| (u16::from_le_bytes(*value) << 4).to_le_bytes())
        .collect();
    place.write("top.raw", &top);
    let line = "reconstruct top.raw --size 48x32 --weights net.fixed.safetensors --out o.png --black-level";
    let bits = "every value is a multiple of 16, as of 12 bits at the top of 16, and --black-level 168 is taken as of 16 bits";
    let told = |options: &str| place.edof(&format!("{line} {options}")).done().err;
    assert!(told("168").contains(bits), "{}", told("168"));
    for options in ["2688", "168 --bit-depth 12 --align top"] {
        assert!(!told(options).contains("every value is"), "{options}");
    }
    place.photo("photo.png", 48, 32);
    let captured = "capture photo.png --camera clear-mid --psi 1 --bit-depth 12 --phase gbrg --out shot.raw";
    place.edof(captured).done();
    let line = format!("stream shot.raw {LINE} --out shot.y4m");
    place
        .edof(&line)
        .refused(&["--phase rggb: shot.raw.json says gbrg; state --phase gbrg, or move that file elsewhere"]);
    place.edof(&format!("{line} --phase gbrg --bit-depth 12")).done();
}

#[test]
fn a_first_frame_of_another_phase_or_with_black_too_high_is_named() {
    let place = ready();
    // Red and blue of a warm light at the places of grbg.
    let light: Vec<u8> = (0..SIZE.0 * SIZE.1)
        .map(|i| match (i / SIZE.0 % 2, i % 2) {
            (0, 1) => 180,
            (1, 0) => 60,
            _ => 120,
        })
        .collect();
    place.write("warm.raw", &light);
    let line = format!("stream warm.raw {LINE} --packing bytes --black-level 4 --out warm.y4m");
    let other = "what --phase rggb takes for green differs as red and blue do; it may have been taken with --phase grbg or --phase gbrg";
    let run = place.edof(&format!("{line} --phase rggb")).done();
    assert!(run.err.contains(&format!("the first frame: {other}")), "{}", run.err);
    let frame = "reconstruct warm.raw --size 48x32 --packing bytes --black-level 4 --weights net.fixed.safetensors --out warm.png";
    assert!(place.edof(frame).done().err.contains(&format!("warm.raw: {other}")));
    assert!(!place.edof(&format!("{line} --phase grbg")).done().err.contains("takes for green"));
    let words = format!("stream all.raw {LINE} --bit-depth 12 --out high.y4m --black-level");
    let run = place.edof(&format!("{words} 3900")).done();
    let high = "of the first frame's values are below it, the largest is 4088 of 4095; if it is of words of 16 bits, divide it by 16";
    assert!(run.err.contains(high), "{}", run.err);
    assert!(!place.edof(&format!("{words} 168")).done().err.contains("below it"));
}

#[test]
fn a_named_pipe_is_read_as_long_as_somebody_writes() {
    let place = ready();
    place.pipe("camera");
    let line = format!("edof stream camera {LINE} --bit-depth 12 --out - > piped.y4m");
    bash(&place, &format!("(for i in 0 1 2; do cat $i.raw; sleep 0.1; done) > camera & {line}; wait")).done();
    place.edof(&format!("stream all.raw {LINE} --bit-depth 12 --out all.y4m")).done();
    assert!(read(&place, "piped.y4m") == read(&place, "all.y4m"));
    // And written, as long as somebody reads.
    place.pipe("screen");
    let line = format!("edof stream all.raw {LINE} --bit-depth 12 --out screen");
    bash(&place, &format!("cat screen > shown.y4m & {line}; wait")).done();
    assert!(read(&place, "shown.y4m") == read(&place, "all.y4m"));
}

#[test]
fn pictures_that_nobody_reads_and_frames_that_are_cut_end_a_stream_in_one_line() {
    let place = ready();
    // More pictures than a pipe holds.
    let frames = "for i in {1..40}; do cat all.raw; done";
    let stream = format!("edof stream - {LINE} --bit-depth 12 --out - --progress json");
    let run = bash(&place, &format!("{frames} | {stream} | head -c 4000 | wc -c")).done();
    assert_eq!(run.out.trim(), "4000");
    assert!(run.err.contains("standard output: was closed by its reader"), "{}", run.err);
    let cut = format!("head -c 5000 all.raw | edof stream - {LINE} --bit-depth 12 --quiet --out cut.y4m");
    bash(&place, &cut).refused(&["standard input: frame 2: ends after 1928 of 3072 bytes"]);
    assert_eq!(planes(&read(&place, "cut.y4m")).len(), 1, "the picture before the cut frame is kept");
    let nothing = format!("edof stream - {LINE} --quiet --out none.y4m < /dev/null");
    bash(&place, &nothing).refused(&["standard input: ended before the first frame"]);
}

#[test]
fn an_interrupted_stream_keeps_whole_pictures() {
    let place = ready();
    place.pipe("camera");
    // The shell holds the pipe open, so that it does not end.
    let line = format!(
        "exec 9<>camera; edof stream camera {LINE} --bit-depth 12 --out kept.y4m & p=$!; cat all.raw >&9"
    );
    let size = "YUV4MPEG2 W48 H32 F30:1 Ip A1:1 C422 XCOLORRANGE=LIMITED\n".len()
        + FRAMES * (6 + 2 * SIZE.0 * SIZE.1);
    let waits = format!(
        "for i in $(seq 500); do [ \"$(stat -c %s kept.y4m 2>/dev/null)\" = {size} ] && break; sleep 0.05; done"
    );
    let run = bash(&place, &format!("{line}; {waits}; kill -TERM $p; wait $p"));
    assert_eq!(run.code, Some(130), "{}", run.err);
    assert!(run.err.ends_with("edof: interrupted\n"), "{}", run.err);
    assert_eq!(planes(&read(&place, "kept.y4m")).len(), FRAMES);
}

#[test]
fn options_that_cannot_be_are_rejected_before_anything_is_written() {
    let place = ready();
    let line = format!("stream all.raw {LINE} --out o.y4m");
    for (options, words) in [
        ("--bit-depth 12 --packing 12p", "--bit-depth 12: 12p states the bits"),
        ("--fps 25 --format yuv422p", "--fps: only y4m states a rate"),
        ("--gain 0", "--gain 0: must be from 0.001 to 1000"),
        (
            "--gain 8",
            "--gain 8: chooses among the networks of the program, and --weights net.fixed.safetensors is a file",
        ),
        ("--packing 10p", "all.raw: 9216 bytes, expected whole frames of 1920 (48x32 packed as 10p)"),
        ("--white-level 1e9", "--black-level, --white-level: white level 1000000000: must be"),
        ("--bit-depth 7", "--bit-depth, --size: bit depth 7: must be 8 to 16"),
    ] {
        place.edof(&format!("{line} {options}")).refused(&[words]);
    }
    place
        .edof(&format!("stream all.raw {LINE} --out - --json"))
        .refused(&["--json: standard output has the pictures"]);
    place.edof(&format!("stream all.raw {LINE} --out all.raw")).refused(&["would replace all.raw"]);
    place
        .edof(&format!("stream none.raw {LINE} --out o.y4m"))
        .refused(&["none.raw: cannot read: No such file"]);
    for options in ["--white-balance blue", "--packing raw", "--fps 29.97", "--size 48", "--format avi"] {
        let run = place.edof(&format!("{line} {options}"));
        assert!(run.code == Some(2) && run.err.starts_with("error: "), "{options}: {}", run.err);
    }
    assert!(!place.path("o.y4m").exists());
}

#[test]
fn a_file_with_a_header_is_no_stream_and_bytes_have_no_order() {
    let place = ready();
    place.raw("shot.png", 48, 32);
    let words = ["is a PNG picture, expected frames without headers", "'edof reconstruct'"];
    place.edof(&format!("stream shot.png {LINE} --out o.y4m")).refused(&["shot.png: ", words[0], words[1]]);
    bash(&place, &format!("cat shot.png | edof stream - {LINE} --out o.y4m")).refused(&[
        "standard input: ",
        words[0],
        words[1],
    ]);
    place.write("shot.dng", b"II*\0\x08\0\0\0\0\0\0\0\0\0");
    place.edof(&format!("stream shot.dng {LINE} --out o.y4m")).refused(&["shot.dng: is a TIFF"]);
    place
        .edof(&format!("stream all.12p {LINE} --packing 12p --order big --out o.y4m"))
        .refused(&["--order big: has no effect on 12p"]);
    assert!(!place.files().contains(&"o.y4m".to_owned()));
}
