//! The blocks at the pins of the board, cycle by cycle: the receiver's bus and the transmitter's.
//!
//! What lies between them has no need of a model of its own: [`crate::windows`], [`crate::overlap_add`] and [`crate::display`] say what
//! comes out, and streams may come at any time.

pub mod camera_in;
pub mod figures;
pub mod grey;
pub mod grey_join;
pub mod greys;
pub mod pattern;
pub mod sync_codes;
pub mod tmds;
pub mod video_in;
pub mod video_out;

pub use camera_in::CameraIn;
pub use grey_join::GreyJoin;
pub use sync_codes::SyncCodes;
pub use tmds::Tmds;
pub use video_in::VideoIn;
pub use video_out::VideoOut;

/// A 4:2:2 bus with separate syncs in one cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pins {
    /// Horizontal sync.
    pub hs: bool,
    /// Vertical sync.
    pub vs: bool,
    /// A pixel lies on the bus.
    pub de: bool,
    /// Codes of the pixel: Y low, C high.
    pub data: u16,
}
