//! What the backend prints, shown on small circuits.

use edof_hdl::describe::Circuit;
use edof_hdl::leaf::Leaf;
use edof_hdl::verilog;
use rust_hdl::prelude::*;

/// The text between the ports and `endmodule` of the last module.
fn body(top: &mut dyn Circuit) -> String {
    top.connect_all();
    let emitted = verilog::emit(top).unwrap_or_else(|error| panic!("{error}"));
    let text = &emitted.modules.last().unwrap().text;
    let (_, rest) = text.split_once(");\n").unwrap();
    rest.split_once("endmodule").unwrap().0.trim_matches('\n').to_string()
}

#[derive(Copy, Clone, Debug, PartialEq, LogicState)]
enum Phase {
    Idle,
    Fill,
    Drain,
}

/// Fills for 16 cycles, drains for one.
///
/// A pulse starts the count.
#[derive(Circuit)]
struct Sequencer {
    pub clock: Signal<In, Clock>,
    pub start: Signal<In, Bit>,
    pub busy: Signal<Out, Bit>,
    phase: DFF<Phase>,
    count: DFF<Bits<4>>,
    last: Signal<Local, Bit>,
}

impl Logic for Sequencer {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, phase, count);
        self.last.next = self.count.q.val() + 1 == 0;
        self.busy.next = self.phase.q.val() != Phase::Idle;
        match self.phase.q.val() {
            Phase::Idle => {
                if self.start.val() {
                    self.phase.d.next = Phase::Fill;
                    self.count.d.next = 0.into();
                }
            }
            Phase::Fill => {
                self.count.d.next = self.count.q.val() + 1;
                if self.last.val() {
                    self.phase.d.next = Phase::Drain;
                }
            }
            Phase::Drain => {
                self.phase.d.next = Phase::Idle;
            }
        }
    }
}

#[test]
fn a_whole_module_reads_like_this() {
    let mut top = Sequencer::default();
    top.connect_all();
    let emitted = verilog::emit(&top).unwrap();
    assert_eq!(emitted.modules[0].text, SEQUENCER);
    assert_eq!(verilog::emit(&top).unwrap(), emitted);
}

const SEQUENCER: &str = "\
// Fills for 16 cycles, drains for one.
//
// A pulse starts the count.
// From crates/edof-hdl/tests/printing.rs (Sequencer).
`default_nettype none
module sequencer (
  input wire clock_i,
  input wire start_i,
  output wire busy_o
);

  localparam [1:0] PHASE_IDLE = 2'd0, PHASE_FILL = 2'd1, PHASE_DRAIN = 2'd2;

  reg [1:0] phase_q;
  reg [3:0] count_q;

  wire last = count_q == 4'd15;
  assign busy_o = phase_q != PHASE_IDLE;

  always @(posedge clock_i) begin
    case (phase_q)
      PHASE_IDLE: begin
        if (start_i) begin
          phase_q <= PHASE_FILL;
          count_q <= 4'd0;
        end
      end
      PHASE_FILL: begin
        count_q <= count_q + 4'd1;
        if (last) phase_q <= PHASE_DRAIN;
      end
      default: phase_q <= PHASE_IDLE; // PHASE_DRAIN
    endcase
  end
endmodule
`default_nettype wire
";

/// Sums products.
#[derive(Circuit)]
struct Accumulator {
    pub clock: Signal<In, Clock>,
    pub clear: Signal<In, Bit>,
    pub a: Signal<In, Signed<16>>,
    pub b: Signal<In, Signed<16>>,
    pub sum: Signal<Out, Signed<48>>,
    acc: DFF<Signed<48>>,
}

impl Logic for Accumulator {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, acc);
        if self.clear.val() {
            self.acc.d.next = signed_bit_cast::<48, 32>(self.a.val() * self.b.val());
        } else {
            self.acc.d.next = self.acc.q.val() + signed_bit_cast::<48, 32>(self.a.val() * self.b.val());
        }
        self.sum.next = self.acc.q.val();
    }
}

/// Two accumulators.
#[derive(Circuit)]
#[circuit(default)]
struct Pair {
    pub clock: Signal<In, Clock>,
    pub a: Signal<In, Signed<16>>,
    pub b: [Signal<In, Signed<16>>; 2],
    pub sum: [Signal<Out, Signed<48>>; 2],
    lanes: [Accumulator; 2],
}

impl Logic for Pair {
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..2 {
            self.lanes[i].clock.next = self.clock.val();
            self.lanes[i].clear.next = false;
            self.lanes[i].a.next = self.a.val();
            self.lanes[i].b.next = self.b[1 - i].val();
            self.sum[i].next = self.lanes[i].sum.val();
        }
    }
}

#[test]
fn equal_parts_share_a_module() {
    let mut top = Pair::default();
    top.connect_all();
    let emitted = verilog::emit(&top).unwrap();
    let names: Vec<_> = emitted.modules.iter().map(|module| module.name.as_str()).collect();
    assert_eq!((names, emitted.top.as_str()), (vec!["accumulator", "pair"], "pair"));
    let fields: Vec<_> = emitted.ports.iter().map(|port| (port.field.as_str(), port.name.as_str())).collect();
    assert_eq!(fields[2..4], [("b[0]", "b_0_i"), ("b[1]", "b_1_i")]);
    assert!(emitted.ports[0].is_clock && emitted.ports[1].signed && emitted.ports[5].bits == 48);
}

#[test]
fn parts_are_connected_without_wires() {
    let lane = |n: usize, b: usize| {
        format!(
            "  accumulator lanes_{n} (.clock_i(clock_i), .clear_i(1'b0), .a_i(a_i), .b_i(b_{b}_i), .sum_o(sum_{n}_o));"
        )
    };
    assert_eq!(body(&mut Pair::default()), format!("{}\n{}", lane(0, 1), lane(1, 0)));
}

#[test]
fn products_are_signed_and_their_extension_is_spelled_out() {
    let text = body(&mut Accumulator::default());
    assert!(text.contains("wire signed [31:0] acc_q_product = a_i * b_i;"), "{text}");
    assert!(text.contains("else acc_q <= acc_q + {{16{acc_q_product[31]}}, acc_q_product};"), "{text}");
}

/// A leaf.
const MEMORY: &str = "module a_memory #(parameter DEPTH = 4, parameter INIT = \"\") (
    input wire clock_i, input wire [3:0] at_i, output reg [15:0] data_o
); endmodule";

/// An instance of the leaf `a_memory`.
#[derive(Circuit)]
struct Memory {
    pub clock: Signal<In, Clock>,
    pub at: Signal<In, Bits<4>>,
    pub data: Signal<Out, Bits<16>>,
}

impl Logic for Memory {
    fn update(&mut self) {}
    fn connect(&mut self) {
        self.data.connect();
    }
    fn hdl(&self) -> Verilog {
        let leaf = Leaf::new("a_memory", MEMORY).parameter("DEPTH", 16).text("INIT", "mem/a.mem");
        leaf.port("clock_i", "clock").port("at_i", "at").port("data_o", "data").verilog()
    }
}

/// Reads a memory in turn.
#[derive(Circuit)]
#[circuit(default)]
struct Reader {
    pub clock: Signal<In, Clock>,
    pub data: Signal<Out, Bits<8>>,
    memory: Memory,
    at: DFF<Bits<4>>,
}

impl Logic for Reader {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, at);
        clock!(self, clock, memory);
        self.at.d.next = self.at.q.val() + 1;
        self.memory.at.next = self.at.q.val();
        self.data.next = self.memory.data.val().get_bits::<8>(4);
    }
}

#[test]
fn leaves_are_instances() {
    let mut top = Reader::default();
    assert_eq!(
        body(&mut top),
        "  reg [3:0] at_q;

  wire [15:0] memory_data;
  a_memory #(.DEPTH(16), .INIT(\"mem/a.mem\")) memory (.clock_i(clock_i), .at_i(at_q), .data_o(memory_data));

  assign data_o = memory_data[11:4];

  always @(posedge clock_i) begin
    at_q <= at_q + 4'd1;
  end

  wire unused = ^memory_data; // Not every bit is read."
    );
    assert!(verilog::emit(&top).unwrap().leaves.contains("a_memory"));
}

/// A constant, a register that starts with it, a name that Verilog reserves, and an output that nobody reads.
#[derive(Circuit)]
#[circuit(default(Sequencer))]
struct Names {
    pub clock: Signal<In, Clock>,
    pub always: Signal<Out, Bits<8>>,
    logic: Signal<Local, Bits<8>>,
    first: Constant<Bits<8>>,
    value: DFFWithInit<Bits<8>>,
    part: Sequencer,
}

impl Default for Names {
    fn default() -> Self {
        Self::from_parts(NamesParts {
            first: Constant::new(0x2a.into()),
            value: DFFWithInit::new(0x2a.into()),
        })
    }
}

impl Logic for Names {
    #[hdl_gen]
    fn update(&mut self) {
        clock!(self, clock, part, value);
        self.part.start.next = self.value.q.val() == self.first.val();
        self.logic.next = !self.value.q.val();
        self.value.d.next = self.logic.val();
        self.always.next = bit_cast::<8, 4>(bit_cast::<4, 8>(self.value.q.val() >> self.logic.val()));
    }
}

#[test]
fn names_are_verilog_and_say_what_is_not_used() {
    assert_eq!(
        body(&mut Names::default()),
        "  localparam [7:0] FIRST = 8'd42;

  reg [7:0] value_q = 8'd42;

  wire [7:0] logic_ = ~value_q;
  wire [7:0] always_o_shifted = value_q >> logic_;
  assign always_o = {4'd0, always_o_shifted[3:0]};
  wire part_start = value_q == FIRST;

  wire part_busy_unused;
  sequencer part (.clock_i(clock_i), .start_i(part_start), .busy_o(part_busy_unused));

  always @(posedge clock_i) begin
    value_q <= logic_;
  end

  wire unused = ^always_o_shifted; // Not every bit is read."
    );
}

/// Values at places of their own, and two that overlap.
#[derive(Circuit)]
struct Places {
    narrow: Signal<In, Bits<3>>,
    bit: Signal<In, Bit>,
    joined: Signal<Out, Bits<12>>,
    mixed: Signal<Out, Bits<12>>,
}

impl Logic for Places {
    #[hdl_gen]
    fn update(&mut self) {
        self.joined.next = bit_cast::<12, 1>(self.bit.val().into())
            | (bit_cast::<12, 3>(self.narrow.val()) << 8)
            | (bit_cast::<12, 3>(self.narrow.val()) << 4);
        self.mixed.next = (bit_cast::<12, 3>(self.narrow.val()) << 2) | bit_cast::<12, 3>(self.narrow.val());
    }
}

#[test]
fn values_that_do_not_overlap_are_joined_side_by_side() {
    assert_eq!(
        body(&mut Places::default()),
        "  assign joined_o = {1'b0, narrow_i, 1'b0, narrow_i, 3'd0, bit_i};
  assign mixed_o = {7'd0, narrow_i, 2'd0} | {9'd0, narrow_i};"
    );
}

/// A stream into a block.
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "StreamOut"]
struct StreamIn {
    pub data: Signal<In, Bits<8>>,
    pub valid: Signal<In, Bit>,
    pub ready: Signal<Out, Bit>,
}

/// A stream out of a block.
#[derive(LogicInterface, Clone, Debug, Default)]
#[join = "StreamIn"]
struct StreamOut {
    pub data: Signal<Out, Bits<8>>,
    pub valid: Signal<Out, Bit>,
    pub ready: Signal<In, Bit>,
}

impl Circuit for StreamIn {}
impl Circuit for StreamOut {}

/// Passes a stream on, counted up.
#[derive(Circuit)]
#[circuit(default)]
struct Pass {
    pub from: StreamIn,
    pub to: StreamOut,
}

impl Logic for Pass {
    #[hdl_gen]
    fn update(&mut self) {
        self.to.data.next = self.from.data.val() + 1;
        self.to.valid.next = self.from.valid.val();
        self.from.ready.next = self.to.ready.val();
    }
}

/// Two in a row.
#[derive(Circuit)]
#[circuit(default)]
struct Chain {
    pub from: StreamIn,
    pub to: StreamOut,
    parts: [Pass; 2],
}

impl Logic for Chain {
    #[hdl_gen]
    fn update(&mut self) {
        StreamIn::link(&mut self.from, &mut self.parts[0].from);
        StreamOut::join(&mut self.parts[0].to, &mut self.parts[1].from);
        StreamOut::link(&mut self.to, &mut self.parts[1].to);
    }
}

#[test]
fn interfaces_are_linked_and_joined() {
    assert_eq!(
        body(&mut Chain::default()),
        "  wire parts_1_from_ready;

  wire [7:0] parts_0_to_data;
  wire parts_0_to_valid;
  pass parts_0 (
    .from_data_i(from_data_i), .from_valid_i(from_valid_i), .from_ready_o(from_ready_o),
    .to_data_o(parts_0_to_data), .to_valid_o(parts_0_to_valid), .to_ready_i(parts_1_from_ready)
  );

  pass parts_1 (
    .from_data_i(parts_0_to_data), .from_valid_i(parts_0_to_valid), .from_ready_o(parts_1_from_ready),
    .to_data_o(to_data_o), .to_valid_o(to_valid_o), .to_ready_i(to_ready_i)
  );"
    );
}

/// Counts to a number of its own, and hands on what came in.
#[derive(Circuit)]
struct Link {
    pub clock: Signal<In, Clock>,
    /// Which link it is.
    pub number: Signal<In, Bits<3>>,
    pub from: Signal<In, Bits<8>>,
    /// What came in a cycle ago.
    pub to: Signal<Out, Bits<8>>,
    pub never_read: Signal<In, Bit>,
    /// What is added.
    step: Constant<Bits<8>>,
    value: DFF<Bits<8>>,
}

impl Link {
    fn new(step: u64) -> Self {
        Self::from_parts(LinkParts { step: Constant::new(step.into()) })
    }
}

impl Logic for Link {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, value);
        self.value.d.next = 0.into();
        self.value.d.next = self.from.val() + self.step.val();
        if self.number.val() == 5 {
            self.value.d.next = self.from.val();
        }
        self.to.next = self.value.q.val();
    }
}

/// Two rows of links that differ in a constant, and one link alone.
#[derive(Circuit)]
struct Links {
    pub clock: Signal<In, Clock>,
    pub from: Signal<In, Bits<8>>,
    pub to: Signal<Out, Bits<8>>,
    pub of_one: Signal<Out, Bits<8>>,
    links: Vec<Link>,
    numbers: Vec<Constant<Bits<3>>>,
    alone: Vec<Link>,
}

impl Logic for Links {
    #[hdl_gen]
    fn update(&mut self) {
        for i in 0..4 {
            self.links[i].clock.next = self.clock.val();
            self.links[i].number.next = self.numbers[i].val();
            self.links[i].never_read.next = true;
        }
        for i in 0..3 {
            self.links[i].from.next = self.links[i + 1].to.val();
        }
        self.links[3].from.next = self.from.val();
        self.to.next = self.links[0].to.val();
        self.alone[0].clock.next = self.clock.val();
        self.alone[0].number.next = 5.into();
        self.alone[0].never_read.next = true;
        self.alone[0].from.next = self.from.val();
        self.of_one.next = self.alone[0].to.val();
    }
}

fn links(step: u64, alone: u64) -> Links {
    Links::from_parts(LinksParts {
        links: (0..4).map(|_| Link::new(step)).collect(),
        numbers: (0..4_u64).map(|number| Constant::new(number.into())).collect(),
        alone: vec![Link::new(alone)],
    })
}

#[test]
fn equal_parts_in_a_row_are_a_loop_and_a_constant_that_differs_is_a_parameter() {
    let mut top = links(1, 2);
    top.connect_all();
    let emitted = verilog::emit(&top).unwrap();
    assert_eq!(emitted.modules.len(), 2);
    assert!(emitted.modules[0].text.contains(LINK), "{}", emitted.modules[0].text);
    assert_eq!(body(&mut top), LINKS);
}

#[test]
fn a_constant_that_never_differs_is_no_parameter() {
    let mut top = links(1, 1);
    top.connect_all();
    let text = &verilog::emit(&top).unwrap().modules[0].text;
    assert!(
        !text.contains("parameter") && text.contains("localparam [7:0] STEP = 8'd1; // What is added."),
        "{text}"
    );
}

const LINK: &str = "\
module link #(
  parameter [7:0] STEP = 8'd1 // What is added.
) (
  input wire clock_i,
  input wire [2:0] number_i, // Which link it is.
  input wire [7:0] from_i,
  output wire [7:0] to_o     // What came in a cycle ago.
);

  reg [7:0] value_q;

  assign to_o = value_q;

  always @(posedge clock_i) begin
    value_q <= (number_i == 3'd5) ? from_i : (from_i + STEP);
  end
";

const LINKS: &str = "  localparam LINKS = 4;

  wire [7:0] links_to [0:LINKS];

  assign to_o = links_to[0];

  genvar link;
  generate
    for (link = 0; link < LINKS; link = link + 1) begin : links
      localparam [2:0] NUMBER = link;
      link #(.STEP(8'd1))
        element (.clock_i(clock_i), .number_i(NUMBER), .from_i(links_to[link + 1]), .to_o(links_to[link]));
    end
  endgenerate

  link #(.STEP(8'd2)) alone (.clock_i(clock_i), .number_i(3'd5), .from_i(from_i), .to_o(of_one_o));

  assign links_to[LINKS] = from_i;";
