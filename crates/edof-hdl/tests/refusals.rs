//! Each construct that the backend rejects, with the error message.

use edof_hdl::crossing::{PixelFifo, Sync};
use edof_hdl::describe::Circuit;
use edof_hdl::leaf::Leaf;
use edof_hdl::ports::{StreamIn, StreamOut};
use edof_hdl::verilog;
use rust_hdl::prelude::*;

/// The error with which the backend rejects a circuit.
fn refusal<B: Circuit + Default>() -> String {
    let mut top = B::default();
    top.connect_all();
    verilog::emit(&top).unwrap_err().to_string()
}

/// A block of the given ports whose kernel is the given statements.
macro_rules! block {
    ($name:ident { $($field:ident: $ty:ty),* } $($kernel:tt)*) => {
        /// A block that the backend rejects.
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
const THING: &str = "module edof_thing #(parameter N = 1) (input wire x_i, output wire [N-1:0] y_o);
    assign y_o = {N{x_i}};
endmodule";

foreign!(Top, Leaf::new("edof_thing", THING).verilog());

/// A leaf of one bit in and one out, and a block that holds it.
macro_rules! leaf {
    ($leaf:ident, $holder:ident, $hdl:expr) => {
        /// A leaf.
        #[derive(Circuit)]
        struct $leaf {
            pub x: Signal<In, Bit>,
            pub y: Signal<Out, Bit>,
        }
        impl Logic for $leaf {
            fn update(&mut self) {}
            fn connect(&mut self) {
                self.y.connect();
            }
            fn hdl(&self) -> Verilog {
                $hdl.verilog()
            }
        }
        block!($holder { y: Signal<Out, Bit>, part: $leaf }
            #[hdl_gen]
            fn update(&mut self) {
            self.part.x.next = self.part.y.val();
            self.y.next = self.part.y.val();
        });
    };
}

fn thing() -> Leaf {
    Leaf::new("edof_thing", THING)
}

leaf!(NoField, NoFieldHolder, thing().port("x_i", "x").port("y_o", "why"));
leaf!(NoPort, NoPortHolder, thing().port("x_i", "x").port("z_o", "y"));
leaf!(NoParameter, NoParameterHolder, thing().parameter("M", 2).port("x_i", "x").port("y_o", "y"));
leaf!(TooWide, TooWideHolder, thing().parameter("N", 2).port("x_i", "x").port("y_o", "y"));
leaf!(Backwards, BackwardsHolder, thing().port("x_i", "y").port("y_o", "x"));
leaf!(Open, OpenHolder, thing().port("y_o", "y"));
leaf!(NoText, NoTextHolder, Leaf::new("edof_unknown", "").port("y_o", "y"));
leaf!(Looping, LoopingHolder, thing().port("x_i", "x").port("y_o", "y"));

#[test]
fn a_leaf_is_held_to_its_own_text() {
    let refusals = [
        (
            refusal::<NoFieldHolder>(),
            "the leaf `edof_thing` connects the field `why`, which the block does not have",
        ),
        (refusal::<NoPortHolder>(), "the leaf `edof_thing` has no port `z_o`"),
        (refusal::<NoParameterHolder>(), "the leaf `edof_thing` has no parameter `M`"),
        (
            refusal::<TooWideHolder>(),
            "the leaf `edof_thing` has `y_o` as output of 2 bits, the block has `y` as output of 1 bit",
        ),
        (
            refusal::<BackwardsHolder>(),
            "the leaf `edof_thing` has `x_i` as input of 1 bit, the block has `y` as output of 1 bit",
        ),
        (
            refusal::<OpenHolder>(),
            "the leaf `edof_thing` has the input `x_i`, which the block does not connect",
        ),
        (refusal::<NoTextHolder>(), "the text of its leaf cannot be read: it has no module"),
    ];
    for (found, wanted) in refusals {
        assert_eq!(found, format!("top.part: {wanted}"));
    }
}

#[test]
fn a_loop_through_a_leaf_is_rejected() {
    let wanted = "top.part.x: depends on itself without a register between: part.x, part.y";
    assert_eq!(refusal::<LoopingHolder>(), wanted);
}

/// Has the name of a leaf's module.
#[derive(Circuit)]
struct EdofThing {
    pub x: Signal<In, Bit>,
    pub y: Signal<Out, Bit>,
}

impl Logic for EdofThing {
    #[hdl_gen]
    fn update(&mut self) {
        self.y.next = !self.x.val();
    }
}

block!(Namesakes { x: Signal<In, Bit>, y: Signal<Out, Bit>, block: EdofThing, leaf: Looping }
    #[hdl_gen]
    fn update(&mut self) {
    self.block.x.next = self.x.val();
    self.leaf.x.next = self.block.y.val();
    self.y.next = self.leaf.y.val();
});

#[test]
fn a_block_never_takes_the_name_of_a_leaf() {
    let mut top = Namesakes::default();
    top.connect_all();
    let emitted = verilog::emit(&top).unwrap();
    assert_eq!(emitted.modules[0].name, "edof_thing_2");
}

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

#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
#[allow(dead_code, reason = "what can never be is what the block waits for")]
enum Which {
    One,
    Two,
}

/// Waits for nothing.
#[derive(Circuit)]
struct Still {
    pub y: Signal<Out, Bits<2>>,
    which: Constant<Which>,
}

impl Default for Still {
    fn default() -> Self {
        Self::from_parts(StillParts { which: Constant::new(Which::One) })
    }
}

impl Logic for Still {
    #[hdl_gen]
    fn update(&mut self) {
        match self.which.val() {
            Which::One => {
                self.y.next = 1.into();
            }
            Which::Two => {
                self.y.next = 2.into();
            }
        }
    }
}

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

const BRIDGE: &str =
    "module edof_bridge (input wire fast_i, input wire slow_i, input wire x_i, output wire y_o);
    reg q;
    always @(posedge slow_i) q <= x_i;
    assign y_o = q;
endmodule";

/// A leaf with two clocks that is not a crossing.
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
        let leaf = Leaf::new("edof_bridge", BRIDGE).port("fast_i", "fast").port("slow_i", "slow");
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
fn ways_between_clock_domains_are_rejected_unless_a_leaf_is_made_for_them() {
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
fn what_cannot_be_translated_is_rejected_with_its_place() {
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
        "top.pin: bidirectional ports are not translated",
        "top.x: has no bits",
        "top.y: `LIMIT` is neither a signal, a state nor a loop variable; constants belong into a Constant<T>",
        "top.y: is driven by statements that depend on no signal; write one assignment",
    ];
    for (found, wanted) in refusals.iter().zip(wanted) {
        assert_eq!(found, wanted);
    }
}
