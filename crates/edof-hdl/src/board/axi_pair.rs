//! Two agents each way on one memory.

use super::axi_guard::AxiGuard;
use crate::describe::{Circuit, kernel};
use crate::ports::{AxiReadMaster, AxiReadSlave, AxiWriteMaster, AxiWriteSlave};
use rust_hdl::prelude::*;

/// Two writers and two readers on one memory; their ids tell them apart. Writers take turns, burst by burst. Reader 1 goes first, since a screen does not wait: reader 0
/// has its turn when reader 1 has not asked for three cycles, one more than a [`ReadAgent`](super::ReadAgent) takes between two bursts.
///
/// At the memory's port stands an [`AxiGuard`], which completes what is in flight when the pair and its agents are reset. A turn takes a
/// cycle, the guard another. A writer's words pass before the next writer's address is taken.
#[derive(Circuit)]
#[circuit(default(AxiGuard), registers(clock, reset))]
pub struct AxiPair<const W: usize, const S: usize> {
    /// Clock, the memory's.
    pub clock: Signal<In, Clock>,
    /// Reset of the agents.
    pub reset: Signal<In, Bit>,
    /// The memory is reset, and the agents with it: nothing is in flight.
    pub memory_reset: Signal<In, Bit>,
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
    guard: AxiGuard<W, S>,
    #[reset(false)]
    write_turn: DFF<Bit>,
    #[reset(false)]
    read_turn: DFF<Bit>,
    // Cycles in which reader 1 may still ask again.
    #[reset(0)]
    again: DFF<Bits<2>>,
    // Whose address was taken last: the words are that writer's.
    owner: DFF<Bit>,
    address_valid: Signal<Local, Bit>,
    request: Signal<Local, Bit>,
}

impl<const W: usize, const S: usize> Logic for AxiPair<W, S> {
    #[kernel]
    fn update(&mut self) {
        self.guard.clock.next = self.clock.val();
        self.guard.reset.next = self.reset.val();
        self.guard.memory_reset.next = self.memory_reset.val();
        AxiWriteMaster::<W, S>::link(&mut self.dram_write, &mut self.guard.dram_write);
        AxiReadMaster::<W>::link(&mut self.dram_read, &mut self.guard.dram_read);

        // Addresses of writes: whose turn it is, is offered; the turn passes on once a burst is accepted, and when only the other asks.
        self.guard.write.aw_id.next = 0.into();
        self.guard.write.aw_addr.next = self.write_0.aw_addr.val();
        self.guard.write.aw_len.next = self.write_0.aw_len.val();
        self.guard.write.aw_size.next = self.write_0.aw_size.val();
        self.guard.write.aw_burst.next = self.write_0.aw_burst.val();
        self.address_valid.next = self.write_0.aw_valid.val();
        self.write_0.aw_ready.next = self.guard.write.aw_ready.val();
        self.write_1.aw_ready.next = false;
        if self.write_turn.q.val() {
            self.guard.write.aw_id.next = 1.into();
            self.guard.write.aw_addr.next = self.write_1.aw_addr.val();
            self.guard.write.aw_len.next = self.write_1.aw_len.val();
            self.guard.write.aw_size.next = self.write_1.aw_size.val();
            self.guard.write.aw_burst.next = self.write_1.aw_burst.val();
            self.address_valid.next = self.write_1.aw_valid.val();
            self.write_0.aw_ready.next = false;
            self.write_1.aw_ready.next = self.guard.write.aw_ready.val();
        }
        self.guard.write.aw_valid.next = self.address_valid.val();
        if self.guard.write.aw_ready.val() || !self.address_valid.val() {
            if self.write_turn.q.val() && self.write_0.aw_valid.val() {
                self.write_turn.d.next = false;
            } else if !self.write_turn.q.val() && self.write_1.aw_valid.val() {
                self.write_turn.d.next = true;
            }
        }
        if self.guard.write.aw_ready.val() && self.address_valid.val() {
            self.owner.d.next = self.write_turn.q.val();
        }

        // Words of the burst that the guard waits for.
        self.guard.write.w_data.next = self.write_0.w_data.val();
        self.guard.write.w_strb.next = self.write_0.w_strb.val();
        self.guard.write.w_last.next = self.write_0.w_last.val();
        self.guard.write.w_valid.next = self.write_0.w_valid.val();
        self.write_0.w_ready.next = self.guard.write.w_ready.val();
        self.write_1.w_ready.next = false;
        if self.owner.q.val() {
            self.guard.write.w_data.next = self.write_1.w_data.val();
            self.guard.write.w_strb.next = self.write_1.w_strb.val();
            self.guard.write.w_last.next = self.write_1.w_last.val();
            self.guard.write.w_valid.next = self.write_1.w_valid.val();
            self.write_0.w_ready.next = false;
            self.write_1.w_ready.next = self.guard.write.w_ready.val();
        }

        // Responses, by id.
        self.write_0.b_id.next = 0.into();
        self.write_1.b_id.next = 0.into();
        self.write_0.b_resp.next = self.guard.write.b_resp.val();
        self.write_1.b_resp.next = self.guard.write.b_resp.val();
        self.write_0.b_valid.next = self.guard.write.b_valid.val() && (self.guard.write.b_id.val() == 0);
        self.write_1.b_valid.next = self.guard.write.b_valid.val() && (self.guard.write.b_id.val() == 1);
        self.guard.write.b_ready.next = self.write_0.b_ready.val();
        if self.guard.write.b_id.val() == 1 {
            self.guard.write.b_ready.next = self.write_1.b_ready.val();
        }

        // Addresses of reads, reader 1's first.
        self.guard.read.ar_id.next = 0.into();
        self.guard.read.ar_addr.next = self.read_0.ar_addr.val();
        self.guard.read.ar_len.next = self.read_0.ar_len.val();
        self.guard.read.ar_size.next = self.read_0.ar_size.val();
        self.guard.read.ar_burst.next = self.read_0.ar_burst.val();
        self.request.next = self.read_0.ar_valid.val();
        self.read_0.ar_ready.next = self.guard.read.ar_ready.val();
        self.read_1.ar_ready.next = false;
        if self.read_turn.q.val() {
            self.guard.read.ar_id.next = 1.into();
            self.guard.read.ar_addr.next = self.read_1.ar_addr.val();
            self.guard.read.ar_len.next = self.read_1.ar_len.val();
            self.guard.read.ar_size.next = self.read_1.ar_size.val();
            self.guard.read.ar_burst.next = self.read_1.ar_burst.val();
            self.request.next = self.read_1.ar_valid.val();
            self.read_0.ar_ready.next = false;
            self.read_1.ar_ready.next = self.guard.read.ar_ready.val();
        }
        self.guard.read.ar_valid.next = self.request.val();
        if self.again.q.val().any() {
            self.again.d.next = self.again.q.val() - 1;
        }
        if self.read_turn.q.val() {
            if self.request.val() {
                self.again.d.next = 3.into();
            } else if self.read_0.ar_valid.val() && !self.again.q.val().any() {
                self.read_turn.d.next = false;
            }
        } else if self.read_1.ar_valid.val() && (self.guard.read.ar_ready.val() || !self.request.val()) {
            self.read_turn.d.next = true;
        }

        // Words that were read, by id.
        self.read_0.r_id.next = 0.into();
        self.read_1.r_id.next = 0.into();
        self.read_0.r_data.next = self.guard.read.r_data.val();
        self.read_1.r_data.next = self.guard.read.r_data.val();
        self.read_0.r_resp.next = self.guard.read.r_resp.val();
        self.read_1.r_resp.next = self.guard.read.r_resp.val();
        self.read_0.r_last.next = self.guard.read.r_last.val();
        self.read_1.r_last.next = self.guard.read.r_last.val();
        self.read_0.r_valid.next = self.guard.read.r_valid.val() && (self.guard.read.r_id.val() == 0);
        self.read_1.r_valid.next = self.guard.read.r_valid.val() && (self.guard.read.r_id.val() == 1);
        self.guard.read.r_ready.next = self.read_0.r_ready.val();
        if self.guard.read.r_id.val() == 1 {
            self.guard.read.r_ready.next = self.read_1.r_ready.val();
        }
    }
}
