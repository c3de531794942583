//! A camera's bus: in every cycle what the model says, whatever its lines and pauses; mistakes that are put into it are found.

use crate::support;
use edof_core::draw::Draw;
use edof_cosim::Source;
use edof_cosim::verilator::{Library, Start};
use edof_golden::video::{CameraIn as Model, Pins};
use edof_hdl::video::camera_in::CameraIn;

/// Cycles without a horizontal sync after which the receiver behind the bus gives a frame up.
const LOST: usize = 8191;

/// Vertical sync, line reference and byte in each cycle: lines and pauses of any length.
fn pins(draw: &mut Draw) -> Vec<(bool, bool, u8)> {
    let mut pins = vec![];
    while pins.len() < 60_000 {
        let is_long = draw.whole(0, 9) == 0;
        let (vs, href) = (draw.whole(0, 3) == 0, !is_long && draw.whole(0, 1) == 1);
        let length = draw.whole(1, if is_long { 10_000 } else { 40 });
        pins.extend((0..length).map(|_| (vs, href, draw.bits() as u8)));
    }
    pins
}

/// Whether the circuit of a black has the model's pins in every cycle after its edit.
fn agrees(black: u8, edit: &dyn Fn(String) -> String) -> bool {
    let mut source = Source::circuit(&mut CameraIn::new(black)).unwrap();
    let (_, text) = source.files.iter_mut().find(|(name, _)| name == "camera_in.v").unwrap();
    *text = edit(std::mem::take(text));
    let mut circuit = Library::build(&source, &support::options())
        .unwrap()
        .start(&Start { seed: black.into(), ..Start::default() })
        .unwrap();
    let port = |name: &str| source.port(name).unwrap();
    let inputs = ["camera_vs_i", "camera_href_i", "camera_data_i"].map(port);
    let outputs = ["hs_o", "vs_o", "de_o", "data_o"].map(port);
    circuit.poke(port("reset_i"), 1).unwrap();
    circuit.tick().unwrap();
    circuit.poke(port("reset_i"), 0).unwrap();
    let (mut model, mut since_sync) = (Model::new(black), 0);
    pins(&mut Draw::new(black.into())).into_iter().all(|(vs, href, byte)| {
        for (port, value) in inputs.into_iter().zip([vs.into(), href.into(), byte.into()]) {
            circuit.poke(port, value).unwrap();
        }
        circuit.tick().unwrap();
        model.step(vs, href, byte);
        let Pins { hs, vs, de, data } = model.pins();
        since_sync = if hs { 0 } else { since_sync + 1 };
        assert!(since_sync < LOST);
        let expected: [u64; 4] = [hs.into(), vs.into(), de.into(), data.into()];
        outputs.map(|port| circuit.peek(port).unwrap()) == expected
    })
}

#[test]
fn a_cameras_bus_is_the_models_for_any_black_and_pauses() {
    for black in [0, 1, 16, 255] {
        assert!(agrees(black, &|text| text), "black {black}");
    }
}

#[test]
fn mistakes_in_a_cameras_bus_are_found() {
    for (right, wrong) in [
        ("vs_q <= camera_vs_i;", "vs_q <= camera_href_i;"),
        ("href_q <= camera_href_i;", "href_q <= href_q || camera_href_i;"),
        ("light_q[6:1]} | 16'h4080", "light_q[7:2]} | 16'h4080"),
        ("data_o ^ 16'hc000", "data_o ^ 16'h4000"),
        ("camera_data_i - BLACK", "camera_data_i"),
        ("pause_q[11]", "pause_q[10]"),
    ] {
        let edit = |text: String| {
            assert_eq!(text.matches(right).count(), 1, "{right}: {text}");
            text.replace(right, wrong)
        };
        assert!(!agrees(16, &edit), "{wrong} is not found");
    }
}
