//! The seven expressions that rust-hdl's own printer translates wrongly, and its simulation as the judge.

use crate::testbench::{BOTH, Random, emit, run};
use edof_verilog::describe::Circuit;
use rust_hdl::core::simulate::simulate;
use rust_hdl::prelude::*;

/// The seven rows.
#[derive(Circuit)]
struct Rows {
    pub a: Signal<In, Bits<8>>,
    pub b: Signal<In, Bits<8>>,
    pub x: Signal<In, Signed<16>>,
    pub wraps_to_zero: Signal<Out, Bit>,
    pub halves_after_wrap: Signal<Out, Bits<8>>,
    pub masks_before_comparing: Signal<Out, Bit>,
    pub is_positive: Signal<Out, Bit>,
    pub extends_the_sign: Signal<Out, Signed<48>>,
    pub complement_is_zero: Signal<Out, Bit>,
    pub widens_after_wrap: Signal<Out, Bits<9>>,
}

impl Logic for Rows {
    #[hdl_gen]
    fn update(&mut self) {
        self.wraps_to_zero.next = self.a.val() + 1 == 0;
        self.halves_after_wrap.next = (self.a.val() + 1) >> 1;
        self.masks_before_comparing.next = self.a.val() & self.b.val() == self.b.val();
        self.is_positive.next = self.x.val() > 0.into();
        self.extends_the_sign.next = signed_bit_cast::<48, 16>(self.x.val()) + 1.into();
        self.complement_is_zero.next = !self.a.val() == 0;
        self.widens_after_wrap.next = bit_cast::<9, 8>(self.a.val() + self.b.val());
    }
}

/// What rust-hdl's simulation gives.
fn expected(row: &[u128]) -> Vec<u128> {
    let mut rows = Rows::default();
    rows.connect_all();
    rows.a.next = (row[0] as u64).into();
    rows.b.next = (row[1] as u64).into();
    rows.x.next = i64::from(row[2] as u16 as i16).into();
    assert!(simulate(&mut rows, 10));
    vec![
        rows.wraps_to_zero.val().into(),
        rows.halves_after_wrap.val().to_u128(),
        rows.masks_before_comparing.val().into(),
        rows.is_positive.val().into(),
        rows.extends_the_sign.val().inner().to_u128(),
        rows.complement_is_zero.val().into(),
        rows.widens_after_wrap.val().to_u128(),
    ]
}

#[test]
fn the_seven_rows_mean_what_rust_means() {
    let emitted = emit(&mut Rows::default());
    let mut rows = vec![vec![255, 3, 0xfffb], vec![5, 200, 0]];
    // rust-hdl's own cast of the most negative number does not end.
    rows.extend(Random(7).rows(&emitted, 500).into_iter().filter(|row| row[2] != 0x8000));
    let want: Vec<_> = rows.iter().map(|row| expected(row)).collect();
    assert_eq!(want[0], [1, 0, 1, 0, 0xffff_ffff_fffc, 1, 2]);
    assert_eq!(want[1][2], 0);
    for simulator in BOTH {
        assert_eq!(run(&emitted, simulator, &rows), want, "{simulator:?}\n{}", emitted.modules[0].text);
    }
}
