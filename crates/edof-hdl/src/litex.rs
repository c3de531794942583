//! LiteX around the core, as text: a target for the KC705, its simulation, and the host's script for the DRAM.

use crate::benches::{self, RecordedVideo};
use crate::kc705;
use edof_device::board::{self, BAUD, BURST_WORDS};
use edof_device::design::{Design, DesignError};

/// The files of `litex/`. Numbers between `@` follow from the design and from the recorded frames.
const FILES: [(&str, &str); 8] = [
    ("litex/README.md", include_str!("../../../project/litex/README.md")),
    ("litex/requirements.txt", include_str!("../../../project/litex/requirements.txt")),
    ("litex/edof_soc.py", include_str!("../../../project/litex/edof_soc.py")),
    ("litex/kc705.py", include_str!("../../../project/litex/kc705.py")),
    ("litex/dram.py", include_str!("../../../project/litex/dram.py")),
    ("litex/sim.py", include_str!("../../../project/litex/sim.py")),
    ("litex/bench.sv", include_str!("../../../project/litex/bench.sv")),
    ("litex/line.cpp", include_str!("../../../project/litex/line.cpp")),
];

/// The LiteX target of a design: files beside those of [`kc705::project`], which they read.
///
/// # Errors
/// [`DesignError`] as of [`board::clocks`].
pub fn files(design: &Design, recorded: &RecordedVideo) -> Result<Vec<(String, String)>, DesignError> {
    let clocks = board::clocks(design)?;
    let file = |(path, text): (&str, &str)| {
        let text = kc705::with_clocks(&benches::with_numbers(text, recorded), clocks)
            .replace("@baud@", &BAUD.to_string())
            .replace("@burst_words@", &BURST_WORDS.to_string());
        (path.to_owned(), text)
    };
    Ok(FILES.map(file).into())
}
