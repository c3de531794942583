//! All tests of the whole program, in one program of their own: what they share is compiled and linked once.

mod architecture;
mod bad_input;
mod board;
mod board_data;
mod contradictions;
mod developing;
mod documents;
mod external;
mod first_steps;
mod happy;
mod hardware;
mod kept;
mod optics;
mod overwriting;
mod playout;
mod provenance;
mod saturations;
mod sizes;
mod stopping;
mod support;
mod tone;
mod too_big;
mod tools;
mod words_of_failure;
mod workspace;
mod wrong_files;
