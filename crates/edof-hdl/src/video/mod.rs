//! The video side of the board, in the order in which data passes (shared design, "Blocks").
//!
//! | block | does |
//! |---|---|
//! | [`camera_in`] | the bus of a camera, as that of a receiver |
//! | [`video_in`] | the 4:2:2 bus of a receiver: raw pixels, and whether they are the frames that the design is for |
//! | [`grey_join`] | raw frames of the grey pixels that a PC's graphics card sends |
//! | [`window_reorder`] | raw lines in block RAM, windows out, mirrored at the borders |
//! | [`patch_pairs`] | patches as F gives them, pairs of pixels out |
//! | [`overlap_add`] | the sum of overlapping patches; nothing at stride 8 |
//! | [`raster_reorder`] | patches in block RAM, lines out |
//! | [`lines`] | the three above: patches in, lines out |
//! | [`display`] | words to the codes on the wire |
//! | [`table_reader`] | its tables, read back |
//! | [`video_out`] | the timing of a screen |
//! | [`sink_rgb`] | red, green and blue of 4:2:2, as a screen makes them |
//! | [`border`] | where the screen is that the picture lies on |
//! | [`tmds_encoder`] | the code of a colour's channel on a DVI cable |
//! | [`dvi`] | the three above, to the pins of a DVI cable |
//! | [`stream_core`] | from raw pixels to codes, the calculator within |
//!
//! A pair of pixels is what 4:2:2 hangs together: two luma words and the Cb and Cr that both share. All streams are valid/ready; a
//! transfer happens in a cycle in which both are high, and valid never falls without one. Pipelines do not stall: they take in only
//! while the [`queue`] at their end has room. Reset is held for 48 cycles or more, in which they run dry.
//!
//! Leaves, each in `rtl/` and here as its model: [`ddr_out`], [`memory`], [`queue`], [`scale`], [`table`].

pub mod border;
pub mod camera_in;
pub mod ddr_out;
pub mod display;
pub mod dvi;
pub mod grey_join;
pub mod lines;
pub mod memory;
pub mod overlap_add;
pub mod patch_pairs;
pub mod queue;
pub mod raster_reorder;
pub mod scale;
pub mod sink_rgb;
pub mod stream_core;
pub mod table;
pub mod table_reader;
pub mod tmds_encoder;
pub mod video_in;
pub mod video_out;
pub mod window_reorder;

use rust_hdl::prelude::Bits;

/// A row of a deep memory; each memory uses as many bits as it has rows.
pub type Place = Bits<16>;
/// A row or column of a frame; in two's complement where it may lie outside.
pub type Coordinate = Bits<13>;
/// A factor of a DSP48E1, in two's complement.
pub type Factor = Bits<18>;
/// A sum of a DSP48E1, in two's complement.
pub type Wide = Bits<48>;
