//! The blocks at the pins: a small camera sends frames to the receiver, and a screen counts along with the transmitter. Both know only what the timing means.

mod grey_join;
mod video_in;
mod video_out;
