//! The ports of an AXI4 bundle, and what its address channels offer.

use super::super::rule_broken;
use crate::verilator::Model;
use crate::{Error, Source};

macro_rules! bundle {
    ($name:ident { $($signal:ident),* }) => {
        pub(super) struct $name { $(pub(super) $signal: usize),* }

        impl $name {
            pub(super) fn of(source: &Source, bundle: &str) -> Result<Self, Error> {
                Ok(Self { $($signal: source.signal(bundle, stringify!($signal))?),* })
            }
        }
    };
}

bundle!(WritePorts {
    aw_id,
    aw_addr,
    aw_len,
    aw_size,
    aw_burst,
    aw_valid,
    aw_ready,
    w_data,
    w_strb,
    w_last,
    w_valid,
    w_ready,
    b_id,
    b_resp,
    b_valid,
    b_ready
});
bundle!(ReadPorts {
    ar_id,
    ar_addr,
    ar_len,
    ar_size,
    ar_burst,
    ar_valid,
    ar_ready,
    r_id,
    r_data,
    r_resp,
    r_last,
    r_valid,
    r_ready
});

/// A burst on its way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Burst {
    pub(super) id: u64,
    pub(super) address: u64,
    pub(super) words: u64,
    /// Cycle before which it is not answered.
    pub(super) due: u64,
    /// Cycle in which its address was offered.
    pub(super) offered: u64,
}

/// What an address channel offers before an edge.
pub(super) struct Address {
    pub(super) payload: [u64; 5],
}

impl Address {
    /// None where nothing is offered.
    pub(super) fn offered(model: &mut Model, valid: bool, ports: [usize; 5]) -> Result<Option<Self>, Error> {
        if !valid {
            return Ok(None);
        }
        let mut payload = [0; 5];
        for (value, port) in payload.iter_mut().zip(ports) {
            *value = model.peek(port)?;
        }
        Ok(Some(Self { payload }))
    }

    pub(super) fn words(&self) -> Vec<u32> {
        self.payload.iter().map(|value| *value as u32).collect()
    }

    /// The burst, if it is one that the standard and our memory allow.
    pub(super) fn burst(&self, model: &Model, port: &str, bytes: u64) -> Result<Burst, Error> {
        let [id, address, len, size, burst] = self.payload;
        let words = len + 1;
        let rules = [
            (burst == 1, "the burst is not of growing addresses"),
            (1 << size == bytes, "the size is not that of a whole word"),
            (address % bytes == 0, "the address is inside of a word"),
            (address / 4096 == (address + words * bytes - 1) / 4096, "the burst crosses a 4 KiB boundary"),
        ];
        match rules.iter().find(|(holds, _)| !holds) {
            Some((_, rule)) => {
                Err(rule_broken(model, port, &format!("{rule}: address {address:#x}, {words} words")))
            }
            None => Ok(Burst { id, address, words, due: 0, offered: 0 }),
        }
    }
}
