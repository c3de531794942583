//! From a scene to the raw frame that a sensor behind a coded lens would give.
