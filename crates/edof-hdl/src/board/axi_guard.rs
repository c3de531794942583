//! A memory's port that outlives a reset of those who use it.

use crate::describe::{Circuit, kernel};
use crate::ports::{AxiReadMaster, AxiReadSlave, AxiWriteMaster, AxiWriteSlave};
use rust_hdl::prelude::*;

/// Guards the memory's port while the masters behind it are reset: each accepted burst is completed.
///
/// After a reset it closes: what is left of a burst is written with no byte enabled, answers and words that are still to come are taken and
/// dropped, however late they are, and then it opens again. Only a reset of the memory itself forgets them. An address and a word are held
/// in registers until the memory takes them, so a word is offered whether or not its address was accepted. Latency one cycle for addresses
/// and words that are written, none for answers and words that are read. The words of a burst end before the next address is taken.
#[derive(Circuit)]
#[circuit(registers(clock, memory_reset))]
pub struct AxiGuard<const W: usize, const S: usize> {
    /// Clock, the memory's.
    pub clock: Signal<In, Clock>,
    /// The masters behind the guard are reset.
    pub reset: Signal<In, Bit>,
    /// The memory is reset: nothing is in flight.
    pub memory_reset: Signal<In, Bit>,
    /// Writes that are asked for.
    pub write: AxiWriteSlave<W, S>,
    /// Reads that are asked for.
    pub read: AxiReadSlave<W>,
    /// Writes to the memory.
    pub dram_write: AxiWriteMaster<W, S>,
    /// Reads from the memory.
    pub dram_read: AxiReadMaster<W>,
    // After a reset, until nothing is in flight.
    #[reset(true)]
    closed: DFF<Bit>,
    #[reset(false)]
    aw_valid: DFF<Bit>,
    aw_id: DFF<Bits<1>>,
    aw_addr: DFF<Bits<32>>,
    aw_len: DFF<Bits<8>>,
    aw_size: DFF<Bits<3>>,
    aw_burst: DFF<Bits<2>>,
    #[reset(false)]
    w_valid: DFF<Bit>,
    w_data: DFF<Bits<W>>,
    w_strb: DFF<Bits<S>>,
    w_last: DFF<Bit>,
    #[reset(false)]
    ar_valid: DFF<Bit>,
    ar_id: DFF<Bits<1>>,
    ar_addr: DFF<Bits<32>>,
    ar_len: DFF<Bits<8>>,
    ar_size: DFF<Bits<3>>,
    ar_burst: DFF<Bits<2>>,
    // A burst whose words have not all come, and how many are to come after the next one.
    #[reset(false)]
    open: DFF<Bit>,
    remaining: DFF<Bits<8>>,
    // Bursts that are not answered, as the place of a single bit.
    #[reset(1)]
    writes: DFF<Bits<32>>,
    #[reset(1)]
    reads: DFF<Bits<32>>,
    push_address: Signal<Local, Bit>,
    advance: Signal<Local, Bit>,
    push_word: Signal<Local, Bit>,
    answered: Signal<Local, Bit>,
    request: Signal<Local, Bit>,
    ended: Signal<Local, Bit>,
    is_quiet: Signal<Local, Bit>,
}

impl<const W: usize, const S: usize> Logic for AxiGuard<W, S> {
    #[kernel]
    fn update(&mut self) {
        // Addresses of writes.
        self.write.aw_ready.next = !self.closed.q.val()
            && !self.aw_valid.q.val()
            && !self.open.q.val()
            && !self.writes.q.val().get_bit(31);
        self.push_address.next = self.write.aw_valid.val() && self.write.aw_ready.val();
        if self.dram_write.aw_ready.val() {
            self.aw_valid.d.next = false;
        }
        if self.push_address.val() {
            self.aw_valid.d.next = true;
            self.open.d.next = true;
            self.remaining.d.next = self.write.aw_len.val();
        }
        if !self.aw_valid.q.val() {
            self.aw_id.d.next = self.write.aw_id.val();
            self.aw_addr.d.next = self.write.aw_addr.val();
            self.aw_len.d.next = self.write.aw_len.val();
            self.aw_size.d.next = self.write.aw_size.val();
            self.aw_burst.d.next = self.write.aw_burst.val();
        }

        // Words of the bursts; after a reset of their master, words without byte enables.
        self.advance.next = !self.w_valid.q.val() || self.dram_write.w_ready.val();
        self.write.w_ready.next = self.advance.val() && self.open.q.val() && !self.closed.q.val();
        self.push_word.next =
            self.advance.val() && self.open.q.val() && (self.closed.q.val() || self.write.w_valid.val());
        if self.advance.val() {
            self.w_valid.d.next = self.push_word.val();
            self.w_data.d.next = self.write.w_data.val();
            self.w_strb.d.next = self.write.w_strb.val();
            self.w_last.d.next = self.write.w_last.val();
            if self.closed.q.val() {
                self.w_strb.d.next = 0.into();
                self.w_last.d.next = !self.remaining.q.val().any();
            }
        }
        if self.push_word.val() {
            self.remaining.d.next = self.remaining.q.val() - 1;
            if !self.remaining.q.val().any() {
                self.open.d.next = false;
            }
        }

        // Responses to the bursts.
        self.write.b_id.next = self.dram_write.b_id.val();
        self.write.b_resp.next = self.dram_write.b_resp.val();
        self.write.b_valid.next = self.dram_write.b_valid.val() && !self.closed.q.val();
        self.dram_write.b_ready.next = self.write.b_ready.val() || self.closed.q.val();
        self.answered.next = self.dram_write.b_valid.val() && self.dram_write.b_ready.val();
        if self.push_address.val() && !self.answered.val() {
            self.writes.d.next = self.writes.q.val() << 1;
        } else if self.answered.val() && !self.push_address.val() {
            self.writes.d.next = self.writes.q.val() >> 1;
        }

        // Addresses of reads, and the words that come.
        self.read.ar_ready.next =
            !self.closed.q.val() && !self.ar_valid.q.val() && !self.reads.q.val().get_bit(31);
        self.request.next = self.read.ar_valid.val() && self.read.ar_ready.val();
        if self.dram_read.ar_ready.val() {
            self.ar_valid.d.next = false;
        }
        if self.request.val() {
            self.ar_valid.d.next = true;
        }
        if !self.ar_valid.q.val() {
            self.ar_id.d.next = self.read.ar_id.val();
            self.ar_addr.d.next = self.read.ar_addr.val();
            self.ar_len.d.next = self.read.ar_len.val();
            self.ar_size.d.next = self.read.ar_size.val();
            self.ar_burst.d.next = self.read.ar_burst.val();
        }
        self.read.r_id.next = self.dram_read.r_id.val();
        self.read.r_data.next = self.dram_read.r_data.val();
        self.read.r_resp.next = self.dram_read.r_resp.val();
        self.read.r_last.next = self.dram_read.r_last.val();
        self.read.r_valid.next = self.dram_read.r_valid.val() && !self.closed.q.val();
        self.dram_read.r_ready.next = self.read.r_ready.val() || self.closed.q.val();
        self.ended.next =
            self.dram_read.r_valid.val() && self.dram_read.r_ready.val() && self.dram_read.r_last.val();
        if self.request.val() && !self.ended.val() {
            self.reads.d.next = self.reads.q.val() << 1;
        } else if self.ended.val() && !self.request.val() {
            self.reads.d.next = self.reads.q.val() >> 1;
        }

        // From a reset on it is closed until nothing is in flight: what is not answered is not over.
        self.is_quiet.next = self.writes.q.val().get_bit(0)
            && self.reads.q.val().get_bit(0)
            && !self.w_valid.q.val()
            && !self.aw_valid.q.val();
        if self.is_quiet.val() {
            self.closed.d.next = false;
        }
        if self.reset.val() {
            self.closed.d.next = true;
        }

        self.dram_write.aw_id.next = self.aw_id.q.val();
        self.dram_write.aw_addr.next = self.aw_addr.q.val();
        self.dram_write.aw_len.next = self.aw_len.q.val();
        self.dram_write.aw_size.next = self.aw_size.q.val();
        self.dram_write.aw_burst.next = self.aw_burst.q.val();
        self.dram_write.aw_valid.next = self.aw_valid.q.val();
        self.dram_write.w_data.next = self.w_data.q.val();
        self.dram_write.w_strb.next = self.w_strb.q.val();
        self.dram_write.w_last.next = self.w_last.q.val();
        self.dram_write.w_valid.next = self.w_valid.q.val();
        self.dram_read.ar_id.next = self.ar_id.q.val();
        self.dram_read.ar_addr.next = self.ar_addr.q.val();
        self.dram_read.ar_len.next = self.ar_len.q.val();
        self.dram_read.ar_size.next = self.ar_size.q.val();
        self.dram_read.ar_burst.next = self.ar_burst.q.val();
        self.dram_read.ar_valid.next = self.ar_valid.q.val();
    }
}
