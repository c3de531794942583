//! The bit-exact fixed-point pipeline: raw frame in, the board's picture out.
