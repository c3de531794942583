//! Set-ups that makers and drivers give.

use edof_board::chip_models::hdmi::{Axis, Timing};
use edof_board::chip_models::source::{Picture, Source};
use edof_board::chip_models::{Bus, Delays, Imageon, Kc705, LowHotPlug, Master, Screen, edid};

/// A device and the bytes that are written to it.
pub type Write = (u8, Vec<u8>);

/// A frame of a few pixels, whose blanking has room for codes.
pub const SMALL: Timing = Timing {
    line: Axis { active: 16, front: 4, sync: 6, back: 6 },
    frame: Axis { active: 8, front: 2, sync: 2, back: 4 },
    khz: 148_500,
};

/// Release of the receiver, by Avnet's order.
pub fn release() -> Vec<Write> {
    vec![(0x70, vec![8]), (0x20, vec![3, 0xea]), (0x20, vec![1, 1]), (0x70, vec![4])]
}

/// Addresses of the maps.
pub fn addresses() -> Vec<Write> {
    let maps =
        [(0xf4, 0x80), (0xf5, 0x7c), (0xf8, 0x4c), (0xf9, 0x64), (0xfa, 0x6c), (0xfb, 0x68), (0xfd, 0x44)];
    maps.map(|(register, address)| (0x4c, vec![register, address])).into()
}

/// An EDID as a receiver would have it, checksums left to the chip.
pub fn edid() -> Vec<Write> {
    let mut edid = edid::screen(true);
    (edid[127], edid[255]) = (0, 0);
    let off = [(0x32, vec![0x77, 0]), (0x32, vec![0x74, 0])];
    let bytes = edid.iter().enumerate().map(|(place, byte)| (0x36, vec![place as u8, *byte]));
    off.into_iter().chain(bytes).chain([(0x32, vec![0x74, 1])]).collect()
}

/// Linux's settings of an ADV7611 for 16 bits with codes.
pub fn video() -> Vec<Write> {
    let io = [
        (0x00, 0x1e),
        (0x01, 0x05),
        (0x02, 0xf5),
        (0x03, 0x80),
        (0x04, 0x62),
        (0x05, 0x2c),
        (0x06, 0xa6),
        (0x0b, 0x44),
        (0x0c, 0x42),
        (0x14, 0x7f),
        (0x15, 0xa0),
        (0x19, 0x80),
        (0x33, 0x40),
    ];
    let cp = [(0x3e, 0x00), (0x6c, 0x00), (0xba, 0x01)];
    let hdmi = [
        (0x9b, 0x03),
        (0x6f, 0x08),
        (0x85, 0x1f),
        (0x87, 0x70),
        (0x57, 0xda),
        (0x58, 0x01),
        (0x03, 0x98),
        (0x4c, 0x44),
        (0x8d, 0x04),
        (0x8e, 0x1e),
        (0x83, 0xfe),
    ];
    let all = io
        .iter()
        .map(|w| (0x4c, w))
        .chain(cp.iter().map(|w| (0x22, w)))
        .chain(hdmi.iter().map(|w| (0x34, w)));
    all.map(|(device, (register, value))| (device, vec![*register, *value])).collect()
}

/// Hot plug of the cable rises.
pub fn hot_plug() -> Vec<Write> {
    vec![(0x70, vec![8]), (0x20, vec![1, 5]), (0x70, vec![4])]
}

/// The whole card.
pub fn card() -> Vec<Write> {
    [release(), addresses(), edid(), video(), hot_plug()].concat()
}

/// The transmitter: override first, fixed values, 16 bits right-justified in style 1, then the given output.
pub fn board(output: &[(u8, u8)]) -> Vec<Write> {
    let first = [
        (0xd6, 0xc0),
        (0x41, 0x10),
        (0x98, 0x03),
        (0x9a, 0xe0),
        (0x9c, 0x30),
        (0x9d, 0x61),
        (0xa2, 0xa4),
        (0xa3, 0xa4),
        (0xe0, 0xd0),
        (0xf9, 0x00),
        (0x15, 0x01),
        (0x48, 0x08),
        (0x17, 0x02),
    ];
    let all = first.iter().chain(output).map(|(register, value)| (0x39, vec![*register, *value]));
    [(0x74, vec![1 << 5])].into_iter().chain(all).collect()
}

/// 4:2:2 out.
pub const YCC: &[(u8, u8)] = &[(0x16, 0xb9), (0x18, 0x46), (0x55, 0x20), (0xaf, 0x06)];
/// RGB out: 4:4:4, CSC by Linux's table, scaled by 4.
pub const RGB: &[(u8, u8)] = &[
    (0x16, 0x38),
    (0x1a, 0x24),
    (0x18, 0xc7),
    (0x19, 0x34),
    (0x1b, 0xad),
    (0x1c, 0x00),
    (0x1d, 0x00),
    (0x1e, 0x1c),
    (0x1f, 0x1b),
    (0x20, 0x1d),
    (0x21, 0xdc),
    (0x22, 0x04),
    (0x23, 0xad),
    (0x24, 0x1f),
    (0x25, 0x24),
    (0x26, 0x01),
    (0x27, 0x35),
    (0x28, 0x00),
    (0x29, 0x00),
    (0x2a, 0x04),
    (0x2b, 0xad),
    (0x2c, 0x08),
    (0x2d, 0x7c),
    (0x2e, 0x1b),
    (0x2f, 0x77),
    (0x1a, 0x04),
    (0x55, 0x00),
    (0xaf, 0x06),
];

/// Writes all of it.
pub fn run<W: edof_board::chip_models::Wires>(bus: W, writes: &[Write]) {
    let mut master = Master::new(bus);
    for (device, bytes) in writes {
        master.write(*device, bytes).unwrap();
    }
}

/// A picture with every byte value, in both bytes.
pub fn ramp() -> Picture {
    (0..128).map(|i| [2 * i, 255 - 2 * i]).collect()
}

/// A card with a source that sends a picture, after these writes.
pub fn card_with(writes: &[Write], change: impl FnOnce(&mut Source)) -> Imageon {
    let mut card = Imageon::new(Delays::NONE);
    card.set_reset(true);
    card.shorten_free_run(SMALL);
    run(&mut card, writes);
    let mut source = Source::new(SMALL, vec![ramp()]);
    change(&mut source);
    card.plug(Some(source));
    card
}

/// Words of a whole frame, the second one since now; and which of them are the picture.
pub fn frame(card: &mut Imageon) -> Vec<Vec<u16>> {
    let (width, height) = (SMALL.line.total(), SMALL.frame.total());
    let mut words: Vec<u16> = vec![];
    for _ in 0..2 {
        words = (0..width * height).map(|_| card.pixel().unwrap()).collect();
    }
    words.chunks(width).map(<[u16]>::to_vec).collect()
}

/// The picture's words of a frame.
pub fn picture(card: &mut Imageon) -> Vec<u16> {
    frame(card)[..SMALL.frame.active].iter().flat_map(|line| line[..SMALL.line.active].to_vec()).collect()
}

/// The board with a screen, after these writes.
pub fn board_with(screen: Screen, writes: &[Write]) -> Kc705 {
    let mut board = Kc705::new(Delays::NONE, LowHotPlug::HoldsDefaults);
    board.set_reset(true);
    board.attach(Some(screen));
    run(&mut board, writes);
    board
}

/// Frames of words at the transmitter's pins.
pub fn send(board: &mut Kc705, words: &[u16], count: usize) {
    let (line, frame) = (SMALL.line, SMALL.frame);
    for i in 0..count * line.total() * frame.total() {
        let (row, column) = (i / line.total() % frame.total(), i % line.total());
        let de = row < frame.active && column < line.active;
        let vs = (frame.active + frame.front..frame.active + frame.front + frame.sync).contains(&row);
        let data = if de { words[row * line.active + column] } else { 0 };
        board.pixel(Bus { hs: false, vs, de, data });
    }
}
