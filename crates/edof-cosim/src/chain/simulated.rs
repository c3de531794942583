//! The chain in rust-hdl's own simulator: slow, and the meaning that the Verilog must have.

use super::device::{Beat, Device, Inputs, Offer, Outputs, join, set, split};
use crate::Error;
use edof_device::design::memory::Set;
use edof_hdl::blocks::chain::Chain;
use rust_hdl::prelude::{Block, Clock, simulate};

/// Rounds after which a circuit that still changes is said to oscillate.
const MAX_ROUNDS: usize = 100;

/// A chain, connected and ready to run.
pub struct Simulated {
    chain: Chain,
}

impl Simulated {
    /// A chain in rust-hdl's simulator.
    #[must_use]
    pub fn new(mut chain: Chain) -> Self {
        chain.connect_all();
        Self { chain }
    }

    fn settle(&mut self) -> Result<(), Error> {
        let settled = simulate(&mut self.chain, MAX_ROUNDS);
        if settled { Ok(()) } else { Err(Error::Stopped("the circuit does not settle".into())) }
    }
}

impl Device for Simulated {
    fn cycle(&mut self, inputs: &Inputs, outputs: &mut Outputs) -> Result<(), Error> {
        let chain = &mut self.chain;
        chain.reset.next = inputs.reset;
        chain.flush.next = inputs.flush;
        chain.window_valid.next = inputs.window.is_some();
        if let Some(beat) = inputs.window {
            chain.window_data.next = u64::from(join(beat.words)).into();
            chain.window_last.next = beat.last;
            chain.window_set.next = beat.set == Set::Second;
        }
        chain.patch_ready.next = inputs.patch_ready;
        chain.write_valid.next = inputs.write.is_some();
        let (address, data) = inputs.write.unwrap_or_default();
        chain.write_address.next = u64::from(address).into();
        chain.write_data.next = u64::from(data).into();
        chain.status_address.next = u64::from(inputs.status_address).into();
        self.settle()?;

        let chain = &self.chain;
        outputs.window_ready = chain.window_ready.val();
        outputs.status = chain.status.val().to_u32();
        outputs.window_fault = chain.window_fault.val();
        outputs.between.clear();
        outputs.between.extend((0..chain.between_valid.len()).map(|gap| Offer {
            beat: chain.between_valid[gap].val().then(|| Beat {
                words: split(chain.between_data[gap].val().to_u32()),
                base: split(chain.between_base[gap].val().to_u32()),
                last: chain.between_last[gap].val(),
                set: set(chain.between_set[gap].val()),
            }),
            ready: chain.between_ready[gap].val(),
        }));
        outputs.patch = chain.patch_valid.val().then(|| Beat {
            words: split(chain.patch_data.val().to_u32()),
            base: [0; 2],
            last: chain.patch_last.val(),
            set: set(chain.patch_set.val()),
        });

        self.chain.clock.next = Clock { clk: true };
        self.settle()?;
        self.chain.clock.next = Clock { clk: false };
        self.settle()
    }
}
