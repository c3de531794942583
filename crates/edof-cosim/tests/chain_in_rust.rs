//! The chain in rust-hdl's own simulator gives the golden model's words.

use edof_golden::sample::{self, Draw};
use edof_golden::scalar;
use edof_hdl::blocks::chain::Chain;
use edof_spec::Design;
use rust_hdl::prelude::*;

fn settle(chain: &mut Chain) {
    assert!(simulate(chain, 100), "the circuit does not settle");
}

fn tick(chain: &mut Chain) {
    chain.clock.next = Clock { clk: true };
    settle(chain);
    chain.clock.next = Clock { clk: false };
    settle(chain);
}

#[test]
fn tiny_restores_windows_bit_for_bit() {
    let design = Design::from_json(include_str!("../../../designs/tiny.json")).unwrap();
    let network = sample::extreme(design.form, design.code_bits, design.frame.stride, false, 7);
    let mut chain = Chain::checked(&design, [&network, &network]).unwrap();
    chain.connect_all();
    chain.reset.next = true;
    (0..20).for_each(|_| tick(&mut chain));
    chain.reset.next = false;
    let draw = &mut Draw::new(1);
    let windows: Vec<Vec<i16>> = (0..5).map(|_| sample::extreme_window(draw, 64)).collect();
    let beats: Vec<[i16; 2]> = windows.iter().flatten().copied().collect::<Vec<_>>().chunks(2).map(|c| [c[0], c[1]]).collect();
    let (mut sent, mut got) = (0, Vec::new());
    chain.patch_ready.next = true;
    for cycle in 0..1500 {
        chain.window_valid.next = sent < beats.len();
        if let Some([even, odd]) = beats.get(sent) {
            let word = u64::from(*even as u16) | (u64::from(*odd as u16) << 16);
            chain.window_data.next = word.into();
            chain.window_last.next = sent % 32 == 31;
        }
        settle(&mut chain);
        if chain.window_valid.val() && chain.window_ready.val() {
            sent += 1;
        }
        if chain.patch_valid.val() {
            if got.len() % 128 == 0 { println!("patch {} at {cycle}", got.len() / 128); }
            let word = chain.patch_data.val().to_u64();
            got.extend([word as u16 as i16, (word >> 16) as u16 as i16]);
        }
        tick(&mut chain);
    }
    let expected: Vec<i16> = windows.iter().flat_map(|w| scalar::run(&network, w).output).collect();
    assert_eq!(got.len(), expected.len());
    assert_eq!(got, expected);
}
