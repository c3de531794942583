//! Syncs that come inside of the pixels: what comes out are the pixels between the codes, and blanking where the codes say so.

use crate::support;
use edof_cosim::Source;
use edof_cosim::verilator::{Library, Start};
use edof_hdl::board::EmbeddedSyncs;
use edof_spec::draw::Draw;

/// The four words before a line's pixels, or after them.
fn code(vertical: bool, ends: bool) -> [u16; 4] {
    let code = 0x80 | u16::from(vertical) << 5 | u16::from(ends) << 4;
    [0xffff, 0, 0, code << 8 | code]
}

/// Lines with blanking, some of them seen: the words on the bus, and the pixels of each seen line.
fn video(draw: &mut Draw) -> (Vec<u16>, Vec<Vec<u16>>) {
    let (mut words, mut lines) = (vec![], vec![]);
    for row in 0..60 {
        let vertical = row % 12 < 3;
        words.extend(code(vertical, true));
        words.extend((0..draw.whole(3, 20)).map(|_| 0x8010));
        words.extend(code(vertical, false));
        // Y has less than 128; 0 on both, and 255 on C, are pixels like others.
        let pixel = |draw: &mut Draw| match draw.whole(0, 5) {
            0 => 0,
            1 => 0xff00,
            _ => (draw.bits() & 0xff7f) as u16,
        };
        let pixels: Vec<u16> = (0..draw.whole(4, 40)).map(|_| pixel(draw)).collect();
        words.extend(&pixels);
        if !vertical {
            lines.push(pixels);
        }
    }
    words.extend(code(true, true));
    words.extend([0x8010; 12]);
    (words, lines)
}

#[test]
fn lines_come_out_as_they_went_in() {
    let source = Source::circuit(&mut EmbeddedSyncs::default()).unwrap();
    let library = Library::build(&source, &support::options()).unwrap();
    let port = |name: &str| source.port(name).unwrap();
    let (reset, data) = (port("reset_i"), port("data_i"));
    let [hs, vs, de, pixel] = ["hs_o", "vs_o", "de_o", "pixel_o"].map(port);
    for seed in 0..5 {
        let mut model = library.start(&Start { seed, ..Start::default() }).unwrap();
        let draw = &mut Draw::new(seed);
        for (level, word) in
            [(1, 0x8010), (1, 0x8010), (1, 0x8010), (1, 0x8010), (1, 0x8010), (1, 0x8010), (0, 0x8010)]
        {
            model.poke(reset, level).unwrap();
            model.poke(data, word).unwrap();
            model.tick().unwrap();
        }
        let (words, expected) = video(draw);
        let (mut lines, mut line, mut frames, mut before): (Vec<Vec<u16>>, Vec<u16>, usize, bool) =
            (vec![], vec![], 0, false);
        for word in words {
            model.poke(data, word.into()).unwrap();
            model.tick().unwrap();
            let [hs, vs, de] = [hs, vs, de].map(|port| model.peek(port).unwrap() == 1);
            if de {
                assert!(!hs && !vs, "a pixel while a sync is on");
                line.push(model.peek(pixel).unwrap() as u16);
            } else if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            frames += usize::from(vs && !before);
            before = vs;
        }
        assert_eq!(lines, expected);
        assert_eq!(frames, 6);
    }
}
