//! Syncs that come inside of the pixels: what comes out are the pixels between the codes, and blanking where the codes say so.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::Source;
use edof_cosim::verilator::{Library, Start};
use edof_golden::video::SyncCodes;
use edof_hdl::board::EmbeddedSyncs;

/// The four words before a line's pixels, or after them.
fn code(vertical: bool, ends: bool) -> [u16; 4] {
    let code = [[0x80, 0x9d], [0xab, 0xb6]][usize::from(vertical)][usize::from(ends)];
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
        let count = draw.whole(4, 40);
        let mut byte = || draw.whole(1, 254) as u16;
        let pixels: Vec<u16> = (0..count).map(|_| byte() << 8 | byte()).collect();
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
    let counts = ["codes_o", "malformed_o"].map(port);
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
        assert_eq!(counts.map(|port| model.peek(port).unwrap()), [121, 0]);
    }
}

/// Words of which some are damaged: a bit that fell over, a word that is there twice, or is lost.
fn damaged(draw: &mut Draw) -> Vec<u16> {
    let (mut words, _) = video(draw);
    for _ in 0..draw.whole(0, 40) {
        let at = draw.whole(0, words.len() as i64 - 1) as usize;
        match draw.whole(0, 3) {
            0 => drop(words.remove(at)),
            1 => words.insert(at, words[at]),
            2 => words[at] = [0, 0xffff, 0xff00, 0x00ff, 0x9d9d][draw.whole(0, 4) as usize],
            _ => words[at] ^= 1 << draw.whole(0, 15),
        }
    }
    words
}

#[test]
fn codes_are_counted_as_the_model_counts_them() {
    let source = Source::circuit(&mut EmbeddedSyncs::default()).unwrap();
    let library = Library::build(&source, &support::options()).unwrap();
    let port = |name: &str| source.port(name).unwrap();
    let [reset, data, codes, malformed] = ["reset_i", "data_i", "codes_o", "malformed_o"].map(port);
    let mut max = 0;
    for seed in 0..40 {
        let mut circuit = library.start(&Start { seed, ..Start::default() }).unwrap();
        let mut model = SyncCodes::default();
        circuit.poke(reset, 1).unwrap();
        circuit.poke(data, 0x8010).unwrap();
        (0..8).for_each(|_| circuit.tick().unwrap());
        circuit.poke(reset, 0).unwrap();
        (0..8).for_each(|_| circuit.tick().unwrap());
        for word in damaged(&mut Draw::new(seed)).into_iter().chain([0x8010; 8]) {
            circuit.poke(data, word.into()).unwrap();
            circuit.tick().unwrap();
            model.push(word);
        }
        let found = [codes, malformed].map(|port| circuit.peek(port).unwrap() as u32);
        assert_eq!(found, [model.codes, model.malformed], "seed {seed}");
        max = max.max(model.malformed);
    }
    assert!(max > 10, "{max} were damaged");
}
