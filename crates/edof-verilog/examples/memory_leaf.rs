//! A memory with a registered output, which rust-hdl has no word for: a leaf with its model, as a part of a circuit.

use edof_verilog::describe::Circuit;
use edof_verilog::leaf::Leaf;
use rust_hdl::prelude::*;

/// The leaf's Verilog, usually a file beside the crate (`include_str!`).
const TEXT: &str = "module small_ram (
    input  wire       clock_i,
    input  wire       write_i,
    input  wire [3:0] address_i,
    input  wire [7:0] data_i,
    output reg  [7:0] data_o
);
    reg [7:0] words [0:15];
    always @(posedge clock_i) begin
        if (write_i) words[address_i] <= data_i;
        data_o <= words[address_i];
    end
endmodule
";

/// 16 bytes; the byte at `address` is at `q` one cycle later.
#[derive(Circuit)]
struct SmallRam {
    pub clock: Signal<In, Clock>,
    pub write: Signal<In, Bit>,
    pub address: Signal<In, Bits<4>>,
    pub data: Signal<In, Bits<8>>,
    pub q: Signal<Out, Bits<8>>,
    _words: Vec<Bits<8>>,
    _q: Bits<8>,
}

impl Default for SmallRam {
    fn default() -> Self {
        Self::from_parts(SmallRamParts { _words: vec![0.into(); 16], _q: 0.into() })
    }
}

impl Logic for SmallRam {
    /// The model: what the Verilog does, in Rust.
    fn update(&mut self) {
        if self.clock.pos_edge() {
            let at = self.address.val().index();
            self._q = self._words[at];
            if self.write.val() {
                self._words[at] = self.data.val();
            }
        }
        self.q.next = self._q;
    }

    fn connect(&mut self) {
        self.q.connect();
    }

    fn hdl(&self) -> Verilog {
        Leaf::new("small_ram", TEXT)
            .port("clock_i", "clock")
            .port("write_i", "write")
            .port("address_i", "address")
            .port("data_i", "data")
            .port("data_o", "q")
            .verilog()
    }
}

/// The last 16 bytes that came in; `oldest` is the one that the next replaces, one cycle late.
#[derive(Circuit)]
#[circuit(default(SmallRam))]
struct History {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Stores the byte.
    pub push: Signal<In, Bit>,
    /// The byte.
    pub byte: Signal<In, Bits<8>>,
    /// Oldest of the stored bytes; 1 cycle after it became the oldest.
    pub oldest: Signal<Out, Bits<8>>,
    ram: SmallRam,
    at: DFF<Bits<4>>,
}

impl Logic for History {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, at);
        if self.push.val() {
            self.at.d.next = self.at.q.val() + 1;
        }
        self.ram.clock.next = self.clock.val();
        self.ram.write.next = self.push.val();
        self.ram.address.next = self.at.q.val();
        self.ram.data.next = self.byte.val();
        self.oldest.next = self.ram.q.val();
    }
}

fn main() -> Result<(), edof_verilog::EmitError> {
    let mut history = History::default();
    history.connect_all();
    let emitted = edof_verilog::emit(&history)?;
    println!("// stands on: {:?}", emitted.leaves);
    print!("{}", emitted.modules[0].text);
    Ok(())
}
