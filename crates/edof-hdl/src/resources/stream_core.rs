//! What the module `stream_core` takes around the calculator, from raw pixels to codes.

use super::scaled;
use crate::video::overlap_add::OverlapAdd;
use crate::video::raster_reorder::RasterReorder;
use crate::video::window_reorder::WindowReorder;
use edof_core::Stride;
use edof_core::display::{COLOUR_ADDRESS_BITS, COLOUR_ENTRY_BITS, LUMA_ENTRIES};
use edof_device::Design;
use edof_device::board::{Part, Resources};

/// Returns what `stream_core` has around its `chain`, by the names of the modules. Last come its own registers, `others`: counters for the host.
///
/// ```
/// let design = edof_device::Design::from_json(include_str!("../../../../designs/kc705.json"))?;
/// let memories = |name| {
///     let around = edof_hdl::resources::around_the_chain(&design).into_iter();
///     around.filter(|(module, _)| *module == name).map(|(_, used)| used.memories).sum::<usize>()
/// };
/// assert_eq!(["window_reorder", "lines", "display"].map(memories), [30, 32, 26]);
/// # Ok::<(), edof_device::design::DesignError>(())
/// ```
#[must_use]
pub fn around_the_chain(design: &Design) -> Vec<(&'static str, Resources)> {
    let part = &design.board.part;
    let modules = [
        ("window_reorder", windows(design)),
        ("lines", lines(design)),
        ("display", display(part)),
        ("table_reader", Resources::logic(191, 293)),
        ("frame_check", Resources::logic(121, 178)),
        ("others", Resources::logic(38, 67)),
    ];
    modules.map(|(name, used)| (name, scaled(part, used))).into()
}

/// Two memories, of even and of odd pixels; addresses and places in them are as wide as their rows need.
fn windows(design: &Design) -> Resources {
    let memory = &design.board.part.memory;
    let rows = memory.rows(WindowReorder::rows(design));
    let bits = rows.next_power_of_two().trailing_zeros() as usize;
    memory.blocks(15, rows) * 2 + Resources::logic(93 + 11 * bits / 2, 255 + 17 * bits / 2)
}

/// Patches to pairs of pixels, their sums where they overlap, and lines of them; luma and chroma have a memory each.
fn lines(design: &Design) -> Resources {
    let memory = &design.board.part.memory;
    let two = |width: usize, rows: usize| memory.blocks(width, memory.rows(rows)) * 2;
    let (pairs, raster) = (Resources::logic(190, 256), Resources::logic(89, 378));
    let lines = pairs + raster + two(32, RasterReorder::rows(design));
    if design.frame.stride == Stride::PATCH {
        return lines;
    }
    lines + Resources::logic(388, 756) + two(40, OverlapAdd::rows(design))
}

/// Tables of luma, and of red, green and blue; ten multipliers.
fn display(part: &Part) -> Resources {
    let table = |bits: u32, entries: usize| part.memory.blocks_of_two_ports(bits as usize, entries);
    let tables = table(8, LUMA_ENTRIES) + table(COLOUR_ENTRY_BITS, 1 << COLOUR_ADDRESS_BITS) * 3;
    Resources { multipliers: 10, ..tables } + Resources::logic(430, 1152)
}
