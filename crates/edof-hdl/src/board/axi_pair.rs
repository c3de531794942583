//! Two agents each way on one memory.

use crate::describe::Circuit;
use crate::ports::{AxiReadMaster, AxiReadSlave, AxiWriteMaster, AxiWriteSlave};
use rust_hdl::prelude::*;

/// Two writers and two readers on one memory: they take turns, burst by burst, and their ids tell them apart.
///
/// Addresses wait a cycle at most where only one asks. Words and answers pass within the cycle. A writer's words pass in the order in which
/// the bursts were accepted; at most 16 bursts are on their way.
#[derive(Circuit)]
pub struct AxiPair<const W: usize, const S: usize> {
    /// Clock.
    pub clock: Signal<In, Clock>,
    /// Forgets what is on its way.
    pub reset: Signal<In, Bit>,
    /// Writer 0.
    pub write_0: AxiWriteSlave<W, S>,
    /// Writer 1.
    pub write_1: AxiWriteSlave<W, S>,
    /// Reader 0.
    pub read_0: AxiReadSlave<W>,
    /// Reader 1.
    pub read_1: AxiReadSlave<W>,
    /// Writes to the memory.
    pub dram_write: AxiWriteMaster<W, S>,
    /// Reads from the memory.
    pub dram_read: AxiReadMaster<W>,
    write_turn: DFF<Bit>,
    read_turn: DFF<Bit>,
    // Whose words come next, the next one lowest; of how many bursts, as the place of a single bit.
    order: DFF<Bits<16>>,
    bursts: DFF<Bits<17>>,
    announces: Signal<Local, Bit>,
    asks: Signal<Local, Bit>,
    has_room: Signal<Local, Bit>,
    announced: Signal<Local, Bit>,
    ended: Signal<Local, Bit>,
    owner: Signal<Local, Bit>,
    has_burst: Signal<Local, Bit>,
    offers: Signal<Local, Bit>,
    is_last: Signal<Local, Bit>,
    place: Signal<Local, Bits<17>>,
    turn: Signal<Local, Bits<16>>,
}

impl<const W: usize, const S: usize> Logic for AxiPair<W, S> {
    #[hdl_gen]
    fn update(&mut self) {
        dff_setup!(self, clock, write_turn, read_turn, order, bursts);

        // Addresses of writes: whose turn it is, is offered; the turn passes on once a burst is accepted, and when only the other asks.
        self.has_room.next = !self.bursts.q.val().get_bit(16);
        self.dram_write.aw_id.next = 0.into();
        self.dram_write.aw_addr.next = self.write_0.aw_addr.val();
        self.dram_write.aw_len.next = self.write_0.aw_len.val();
        self.dram_write.aw_size.next = self.write_0.aw_size.val();
        self.dram_write.aw_burst.next = self.write_0.aw_burst.val();
        self.announces.next = self.write_0.aw_valid.val() && self.has_room.val();
        self.write_0.aw_ready.next = self.dram_write.aw_ready.val() && self.has_room.val();
        self.write_1.aw_ready.next = false;
        if self.write_turn.q.val() {
            self.dram_write.aw_id.next = 1.into();
            self.dram_write.aw_addr.next = self.write_1.aw_addr.val();
            self.dram_write.aw_len.next = self.write_1.aw_len.val();
            self.dram_write.aw_size.next = self.write_1.aw_size.val();
            self.dram_write.aw_burst.next = self.write_1.aw_burst.val();
            self.announces.next = self.write_1.aw_valid.val() && self.has_room.val();
            self.write_0.aw_ready.next = false;
            self.write_1.aw_ready.next = self.dram_write.aw_ready.val() && self.has_room.val();
        }
        self.dram_write.aw_valid.next = self.announces.val();
        self.announced.next = self.announces.val() && self.dram_write.aw_ready.val();
        if self.announced.val() || !self.announces.val() {
            if self.write_turn.q.val() && self.write_0.aw_valid.val() {
                self.write_turn.d.next = false;
            } else if !self.write_turn.q.val() && self.write_1.aw_valid.val() {
                self.write_turn.d.next = true;
            }
        }

        // Their words, in the same order.
        self.has_burst.next = !self.bursts.q.val().get_bit(0);
        self.owner.next = self.order.q.val().get_bit(0);
        self.dram_write.w_data.next = self.write_0.w_data.val();
        self.dram_write.w_strb.next = self.write_0.w_strb.val();
        self.is_last.next = self.write_0.w_last.val();
        self.offers.next = self.write_0.w_valid.val() && self.has_burst.val();
        self.write_0.w_ready.next = self.dram_write.w_ready.val() && self.has_burst.val();
        self.write_1.w_ready.next = false;
        if self.owner.val() {
            self.dram_write.w_data.next = self.write_1.w_data.val();
            self.dram_write.w_strb.next = self.write_1.w_strb.val();
            self.is_last.next = self.write_1.w_last.val();
            self.offers.next = self.write_1.w_valid.val() && self.has_burst.val();
            self.write_0.w_ready.next = false;
            self.write_1.w_ready.next = self.dram_write.w_ready.val() && self.has_burst.val();
        }
        self.dram_write.w_last.next = self.is_last.val();
        self.dram_write.w_valid.next = self.offers.val();
        self.ended.next = self.offers.val() && self.is_last.val() && self.dram_write.w_ready.val();
        self.place.next = self.bursts.q.val();
        if self.ended.val() {
            self.place.next = self.bursts.q.val() >> 1;
        }
        self.turn.next = 0.into();
        if self.announced.val() && self.write_turn.q.val() {
            self.turn.next = self.place.val().get_bits::<16>(0);
        }
        self.order.d.next = self.order.q.val() | self.turn.val();
        if self.ended.val() {
            self.order.d.next = (self.order.q.val() >> 1) | self.turn.val();
        }
        self.bursts.d.next = self.place.val();
        if self.announced.val() {
            self.bursts.d.next = self.place.val() << 1;
        }

        // Their answers, by id.
        self.write_0.b_id.next = 0.into();
        self.write_1.b_id.next = 0.into();
        self.write_0.b_resp.next = self.dram_write.b_resp.val();
        self.write_1.b_resp.next = self.dram_write.b_resp.val();
        self.write_0.b_valid.next = self.dram_write.b_valid.val() && (self.dram_write.b_id.val() == 0);
        self.write_1.b_valid.next = self.dram_write.b_valid.val() && (self.dram_write.b_id.val() == 1);
        self.dram_write.b_ready.next = self.write_0.b_ready.val();
        if self.dram_write.b_id.val() == 1 {
            self.dram_write.b_ready.next = self.write_1.b_ready.val();
        }

        // Addresses of reads, by turns too.
        self.dram_read.ar_id.next = 0.into();
        self.dram_read.ar_addr.next = self.read_0.ar_addr.val();
        self.dram_read.ar_len.next = self.read_0.ar_len.val();
        self.dram_read.ar_size.next = self.read_0.ar_size.val();
        self.dram_read.ar_burst.next = self.read_0.ar_burst.val();
        self.asks.next = self.read_0.ar_valid.val();
        self.read_0.ar_ready.next = self.dram_read.ar_ready.val();
        self.read_1.ar_ready.next = false;
        if self.read_turn.q.val() {
            self.dram_read.ar_id.next = 1.into();
            self.dram_read.ar_addr.next = self.read_1.ar_addr.val();
            self.dram_read.ar_len.next = self.read_1.ar_len.val();
            self.dram_read.ar_size.next = self.read_1.ar_size.val();
            self.dram_read.ar_burst.next = self.read_1.ar_burst.val();
            self.asks.next = self.read_1.ar_valid.val();
            self.read_0.ar_ready.next = false;
            self.read_1.ar_ready.next = self.dram_read.ar_ready.val();
        }
        self.dram_read.ar_valid.next = self.asks.val();
        if self.dram_read.ar_ready.val() || !self.asks.val() {
            if self.read_turn.q.val() && self.read_0.ar_valid.val() {
                self.read_turn.d.next = false;
            } else if !self.read_turn.q.val() && self.read_1.ar_valid.val() {
                self.read_turn.d.next = true;
            }
        }

        // Words that were read, by id.
        self.read_0.r_id.next = 0.into();
        self.read_1.r_id.next = 0.into();
        self.read_0.r_data.next = self.dram_read.r_data.val();
        self.read_1.r_data.next = self.dram_read.r_data.val();
        self.read_0.r_resp.next = self.dram_read.r_resp.val();
        self.read_1.r_resp.next = self.dram_read.r_resp.val();
        self.read_0.r_last.next = self.dram_read.r_last.val();
        self.read_1.r_last.next = self.dram_read.r_last.val();
        self.read_0.r_valid.next = self.dram_read.r_valid.val() && (self.dram_read.r_id.val() == 0);
        self.read_1.r_valid.next = self.dram_read.r_valid.val() && (self.dram_read.r_id.val() == 1);
        self.dram_read.r_ready.next = self.read_0.r_ready.val();
        if self.dram_read.r_id.val() == 1 {
            self.dram_read.r_ready.next = self.read_1.r_ready.val();
        }

        if self.reset.val() {
            self.write_turn.d.next = false;
            self.read_turn.d.next = false;
            self.order.d.next = 0.into();
            self.bursts.d.next = 1.into();
        }
    }
}
