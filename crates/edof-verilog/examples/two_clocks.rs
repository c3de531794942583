//! A level from one clock domain to another, through a leaf that is declared a crossing. Without the leaf the circuit is rejected.

use edof_verilog::describe::Circuit;
use edof_verilog::leaf::Leaf;
use rust_hdl::prelude::*;

/// Two flip-flops.
const TEXT: &str = "module level_sync (input wire clock_i, input wire level_i, output wire level_o);
    (* ASYNC_REG = \"TRUE\" *) reg [1:0] level_q;
    always @(posedge clock_i) level_q <= {level_q[0], level_i};
    assign level_o = level_q[1];
endmodule
";

/// Brings a level into the domain of `clock`, two cycles later.
#[derive(Circuit, Default)]
struct LevelSync {
    pub clock: Signal<In, Clock>,
    pub from: Signal<In, Bit>,
    pub to: Signal<Out, Bit>,
    _seen: [bool; 2],
}

impl Logic for LevelSync {
    fn update(&mut self) {
        if self.clock.pos_edge() {
            self._seen = [self.from.val(), self._seen[0]];
        }
        self.to.next = self._seen[1];
    }

    fn connect(&mut self) {
        self.to.connect();
    }

    fn hdl(&self) -> Verilog {
        Leaf::new("level_sync", TEXT)
            .port("clock_i", "clock")
            .port("level_i", "from")
            .port("level_o", "to")
            // `level_i` may come from any domain.
            .crossing(&[("level_o", "clock_i")])
            .verilog()
    }
}

/// A switch that toggles in one domain and is seen in the other.
#[derive(Circuit)]
#[circuit(default(LevelSync))]
struct Switch {
    /// Clock of the switch.
    pub here: Signal<In, Clock>,
    /// Clock of the reader.
    pub there: Signal<In, Clock>,
    /// Toggles the switch; in the domain of `here`.
    pub toggle: Signal<In, Bit>,
    /// The switch; in the domain of `there`.
    pub is_on: Signal<Out, Bit>,
    state: DFF<Bit>,
    sync: LevelSync,
}

impl Logic for Switch {
    #[hdl_gen]
    fn update(&mut self) {
        self.state.clock.next = self.here.val();
        self.state.d.next = self.state.q.val() ^ self.toggle.val();
        self.sync.clock.next = self.there.val();
        self.sync.from.next = self.state.q.val();
        self.is_on.next = self.sync.to.val();
    }
}

fn main() -> Result<(), edof_verilog::EmitError> {
    let mut switch = Switch::default();
    switch.connect_all();
    let emitted = edof_verilog::emit(&switch)?;
    for crossing in &emitted.crossings {
        println!("// {} crosses: {:?}", crossing.path.join("."), crossing.clocks);
    }
    print!("{}", emitted.modules[0].text);
    Ok(())
}
