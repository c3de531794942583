//! Each thing that the backend refuses, and the words in which it does.

use edof_hdl::crossing::{PixelFifo, Sync};
use edof_hdl::describe::Circuit;
use edof_hdl::leaf::Leaf;
use edof_hdl::ports::{StreamIn, StreamOut};
use edof_hdl::verilog;
use rust_hdl::prelude::*;

/// The refusal of a circuit.
fn refusal<B: Circuit + Default>() -> String {
    let mut top = B::default();
    top.connect_all();
    verilog::emit(&top).unwrap_err().to_string()
}

/// A block of the given ports whose kernel is the given statements.
macro_rules! block {
    ($name:ident { $($field:ident: $ty:ty),* } $($kernel:tt)*) => {
        /// A block to refuse.
        #[derive(Circuit)]
        #[circuit(default)]
        struct $name { $(pub $field: $ty),* }
        impl Logic for $name {
            $($kernel)*
        }
    };
}

block!(Latch { on: Signal<In, Bit>, y: Signal<Out, Bits<4>> }
    #[hdl_gen]
    fn update(&mut self) {
    if self.on.val() { self.y.next = 1.into(); }
});

block!(Undriven { x: Signal<In, Bit>, y: Signal<Out, Bit>, z: Signal<Out, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.x.val();
});

block!(Unconnected { y: Signal<Out, Bits<4>>, part: Latch }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.part.y.val();
});

block!(Early { x: Signal<In, Bit>, y: Signal<Out, Bit>, t: Signal<Local, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.t.val();
    self.t.next = self.x.val();
});

block!(Inverter { x: Signal<In, Bit>, y: Signal<Out, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = !self.x.val();
});

block!(Ring { y: Signal<Out, Bit>, part: Inverter }
    #[hdl_gen]
    fn update(&mut self) {
    self.part.x.next = self.part.y.val();
    self.y.next = self.part.y.val();
});

block!(Wide { x: Signal<In, Signed<8>>, y: Signal<Out, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = signed_bit_cast::<16, 8>(self.x.val()) < signed_bit_cast::<16, 8>(self.x.val());
});

block!(Literal { x: Signal<In, Signed<4>>, y: Signal<Out, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.x.val() > 8.into();
});

block!(Outside { x: Signal<In, Bits<4>>, y: Signal<Out, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.x.val().get_bit(4);
});

block!(Gated { clock: Signal<In, Clock>, y: Signal<Out, Bit>, r: DFF<Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.r.clock.next = !self.clock.val();
    self.r.d.next = !self.r.q.val();
    self.y.next = self.r.q.val();
});

#[derive(LogicBlock, Default)]
struct Nameless {
    pub x: Signal<In, Bit>,
    pub y: Signal<Out, Bit>,
}

impl Circuit for Nameless {}

impl Logic for Nameless {
    #[hdl_gen]
    fn update(&mut self) {
        self.y.next = self.x.val();
    }
}

block!(Owner { x: Signal<In, Bit>, y: Signal<Out, Bit>, part: Nameless }
    #[hdl_gen]
    fn update(&mut self) {
    self.part.x.next = self.x.val();
    self.y.next = self.part.y.val();
});

macro_rules! foreign {
    ($name:ident, $hdl:expr) => {
        /// Not a kernel.
        #[derive(Circuit)]
        struct $name {
            pub y: Signal<Out, Bit>,
        }
        impl Logic for $name {
            fn update(&mut self) {}
            fn hdl(&self) -> Verilog {
                $hdl
            }
        }
    };
}

foreign!(Custom, Verilog::Custom("assign y = 1;".into()));
foreign!(Top, Leaf::new("edof_thing").verilog());
foreign!(WrongLeaf, Leaf::new("edof_thing").port("y_o", "why").verilog());

block!(Holder { y: Signal<Out, Bit>, part: WrongLeaf }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.part.y.val();
});

/// A pin.
#[derive(Circuit)]
struct Pin {
    pub pin: Signal<InOut, Bit>,
}

impl Logic for Pin {
    #[hdl_gen]
    fn update(&mut self) {}
}

#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum One {
    Only,
}

block!(NoBits { x: Signal<In, One>, y: Signal<Out, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.x.val() == One::Only;
});

const LIMIT: u64 = 5;

block!(Unknown { x: Signal<In, Bits<4>>, y: Signal<Out, Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = self.x.val() == LIMIT;
});

block!(Still { y: Signal<Out, Bits<2>> }
    #[hdl_gen]
    fn update(&mut self) {
    self.y.next = 0.into();
    self.y.next = 1.into();
});

block!(Leap { fast: Signal<In, Clock>, slow: Signal<In, Clock>, x: Signal<In, Bit>, y: Signal<Out, Bit>, one: DFF<Bit>, other: DFF<Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.one.clock.next = self.fast.val();
    self.other.clock.next = self.slow.val();
    self.one.d.next = self.x.val();
    self.other.d.next = !self.one.q.val();
    self.y.next = self.other.q.val();
});

block!(Store { clock: Signal<In, Clock>, x: Signal<In, Bit>, y: Signal<Out, Bit>, r: DFF<Bit> }
    #[hdl_gen]
    fn update(&mut self) {
    self.r.clock.next = self.clock.val();
    self.r.d.next = self.x.val();
    self.y.next = !self.r.q.val();
});

block!(LeapBetween { fast: Signal<In, Clock>, slow: Signal<In, Clock>, x: Signal<In, Bit>, y: Signal<Out, Bit>, parts: [Store; 2] }
    #[hdl_gen]
    fn update(&mut self) {
    self.parts[0].clock.next = self.fast.val();
    self.parts[1].clock.next = self.slow.val();
    self.parts[0].x.next = self.x.val();
    self.parts[1].x.next = self.parts[0].y.val();
    self.y.next = self.parts[1].y.val();
});

block!(TakenTwice { fast: Signal<In, Clock>, slow: Signal<In, Clock>, x: Signal<In, Bit>, y: Signal<Out, Bits<2>>, parts: [Store; 2] }
    #[hdl_gen]
    fn update(&mut self) {
    self.parts[0].clock.next = self.fast.val();
    self.parts[1].clock.next = self.slow.val();
    self.parts[0].x.next = self.x.val();
    self.parts[1].x.next = self.x.val();
    self.y.next = 0.into();
});

block!(MixedOut { fast: Signal<In, Clock>, slow: Signal<In, Clock>, x: Signal<In, Bit>, z: Signal<In, Bit>, y: Signal<Out, Bit>, parts: [Store; 2] }
    #[hdl_gen]
    fn update(&mut self) {
    self.parts[0].clock.next = self.fast.val();
    self.parts[1].clock.next = self.slow.val();
    self.parts[0].x.next = self.x.val();
    self.parts[1].x.next = self.z.val();
    self.y.next = self.parts[0].y.val() && self.parts[1].y.val();
});

/// A leaf of two clocks that is no crossing.
#[derive(Circuit)]
struct Bridge {
    pub fast: Signal<In, Clock>,
    pub slow: Signal<In, Clock>,
    pub x: Signal<In, Bit>,
    pub y: Signal<Out, Bit>,
}

impl Logic for Bridge {
    fn update(&mut self) {}
    fn connect(&mut self) {
        self.y.connect();
    }
    fn hdl(&self) -> Verilog {
        let leaf = Leaf::new("edof_bridge").port("fast_i", "fast").port("slow_i", "slow");
        leaf.port("x_i", "x").port("y_o", "y").verilog()
    }
}

block!(Bridged { fast: Signal<In, Clock>, slow: Signal<In, Clock>, x: Signal<In, Bit>, y: Signal<Out, Bit>, part: Bridge }
    #[hdl_gen]
    fn update(&mut self) {
    self.part.fast.next = self.fast.val();
    self.part.slow.next = self.slow.val();
    self.part.x.next = self.x.val();
    self.y.next = self.part.y.val();
});

#[test]
fn ways_between_clock_domains_are_refused_unless_a_leaf_is_made_for_them() {
    let refusals = [
        refusal::<Leap>(),
        refusal::<LeapBetween>(),
        refusal::<TakenTwice>(),
        refusal::<MixedOut>(),
        refusal::<Bridged>(),
    ];
    let wanted = [
        "top.other.d: leads from the domain of `fast` to that of `slow` without a synchroniser",
        "top.parts[1].x: leads from the domain of `fast` to that of `slow` without a synchroniser",
        "top.x: leads from the domain of `slow` to that of `fast` without a synchroniser",
        "top.y: leads from the domain of `slow` to that of `fast` without a synchroniser",
        "top.part: the leaf `edof_bridge` has several clocks and is no crossing",
    ];
    assert_eq!(refusals, wanted);
}

/// A level and a stream of pixels into another domain.
#[derive(Circuit)]
struct Crossed {
    pub fast: Signal<In, Clock>,
    pub slow: Signal<In, Clock>,
    pub fast_reset: Signal<In, Bit>,
    pub slow_reset: Signal<In, Bit>,
    pub from: StreamIn<16>,
    pub to: StreamOut<16>,
    pub level: Signal<Out, Bits<1>>,
    kept: DFF<Bits<1>>,
    sync: Sync<1>,
    pixels: PixelFifo,
}

impl Logic for Crossed {
    #[hdl_gen]
    fn update(&mut self) {
        self.kept.clock.next = self.fast.val();
        self.kept.d.next = !self.kept.q.val();
        self.sync.clock.next = self.slow.val();
        self.sync.from.next = self.kept.q.val();
        self.level.next = self.sync.to.val();
        self.pixels.from_clock.next = self.fast.val();
        self.pixels.from_reset.next = self.fast_reset.val();
        self.pixels.to_clock.next = self.slow.val();
        self.pixels.to_reset.next = self.slow_reset.val();
        StreamIn::<16>::link(&mut self.from, &mut self.pixels.from);
        StreamOut::<16>::link(&mut self.to, &mut self.pixels.to);
    }
}

#[test]
fn crossings_are_listed_with_their_clocks() {
    let mut top = Crossed::from_parts(CrossedParts { sync: Sync::default(), pixels: PixelFifo::new(4) });
    top.connect_all();
    let crossings = verilog::emit(&top).unwrap().crossings;
    let found: Vec<(String, &str, Vec<&str>)> = crossings
        .iter()
        .map(|c| {
            (c.path.join("/"), c.leaf.as_str(), c.clocks.iter().map(|(_, clock)| clock.as_str()).collect())
        })
        .collect();
    let wanted = [
        ("sync".to_string(), "edof_sync", vec!["slow"]),
        ("pixels/fifo".to_string(), "edof_async_fifo", vec!["fast", "slow"]),
    ];
    assert_eq!(found, wanted);
}

#[test]
fn what_cannot_be_translated_is_refused_with_its_place() {
    let refusals = [
        refusal::<Latch>(),
        refusal::<Undriven>(),
        refusal::<Unconnected>(),
        refusal::<Early>(),
        refusal::<Ring>(),
        refusal::<Wide>(),
        refusal::<Literal>(),
        refusal::<Outside>(),
        refusal::<Gated>(),
        refusal::<Nameless>(),
        refusal::<Owner>(),
        refusal::<Custom>(),
        refusal::<Top>(),
        refusal::<Holder>(),
        refusal::<Pin>(),
        refusal::<NoBits>(),
        refusal::<Unknown>(),
        refusal::<Still>(),
    ];
    println!("{refusals:#?}");
    let wanted = [
        "top.y: is not driven on every path, which would be a latch",
        "top.z: is never driven",
        "top.part.y: is not driven on every path, which would be a latch",
        "top.y: `t` is read before it is written",
        "top.part.x: depends on itself without a register between: part.x, part.y",
        "top.y: the width of `signed(x) < signed(x)` follows from nothing around it; assign it to a signal first",
        "top.y: 8 does not fit Signed<4>",
        "top.y: `x.get_bit(4)` reaches outside of its operand",
        "top.r.clock: a clock must be driven once, by a plain signal",
        "top: has no description; #[derive(Circuit)] gives it one",
        "top.part: has no description; #[derive(Circuit)] gives it one",
        "top: its hdl() is Verilog text; only #[hdl_gen] kernels, registers and leaves are translated",
        "top: is a leaf or a register and cannot be the top",
        "top.part: the leaf `edof_thing` connects the field `why`, which the block does not have",
        "top.pin: bidirectional ports are not translated",
        "top.x: has no bits",
        "top.y: `LIMIT` is neither a signal, a state nor a loop variable; constants belong into a Constant<T>",
        "top.y: is driven by statements that depend on no signal; write one assignment",
    ];
    for (found, wanted) in refusals.iter().zip(wanted) {
        assert_eq!(found, wanted);
    }
}
