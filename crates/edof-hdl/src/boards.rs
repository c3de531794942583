//! The circuits of each board: a board whose sources can be written has a line in `CIRCUITS`.

use crate::board::{EdofCore, Identity, Kc705Core, Pace, Tables, Ulx3sCore, kc705_core, ulx3s_core};
use crate::describe::Circuit;
use edof_device::board::{Board, KC705, ULX3S};
use edof_device::design::{Design, DesignError};
use edof_network::FixedNetwork;

/// Makes a circuit of a design, both sets of its weights, its identity and the tables of its display.
pub type Make = fn(&Design, [&FixedNetwork; 2], &Identity, &Tables) -> Result<Box<dyn Circuit>, DesignError>;

/// The circuits of a board.
pub struct Circuits {
    board: &'static Board,
    /// Everything between the clocks of the pins and the memory, as wide as the memory's port.
    pub core: Make,
    /// The core with what the board has around it.
    pub top: Make,
}

const CIRCUITS: [Circuits; 2] = [
    Circuits {
        board: &KC705,
        core: |design, sets, identity, tables| {
            let core = EdofCore::<{ kc705_core::W }, { kc705_core::S }>::new(design, sets, identity, tables)?;
            Ok(Box::new(core))
        },
        top: |design, sets, identity, tables| {
            Ok(Box::new(Kc705Core::new(design, sets, identity, tables, &Pace::of(&KC705))?))
        },
    },
    Circuits {
        board: &ULX3S,
        core: |design, sets, identity, tables| {
            let core = EdofCore::<{ ulx3s_core::W }, { ulx3s_core::S }>::new(design, sets, identity, tables)?;
            Ok(Box::new(core))
        },
        top: |design, sets, identity, tables| {
            Ok(Box::new(Ulx3sCore::new(design, sets, identity, tables, &Pace::of(&ULX3S))?))
        },
    },
];

/// Returns the circuits of a board.
///
/// # Errors
/// [`DesignError::Lacks`]: there are none.
pub fn circuits(board: &'static Board) -> Result<&'static Circuits, DesignError> {
    let what = "circuits around the calculator";
    let found = CIRCUITS.iter().find(|circuits| circuits.board == board);
    found.ok_or_else(|| DesignError::Lacks { board: board.name, what: what.into() })
}
