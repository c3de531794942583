//! Training of the float network: data, recipe, optimiser, checkpoints. Forward pass and gradient are in `edof_network::float`.
//!
//! | step | module | gives |
//! |---|---|---|
//! | photos | [`dataset`] | blurred photographs in several looks ([`augment`]), and random windows with their sharp patches |
//! | | [`noise`] | light and noise of each window, from random numbers ([`edof_numerics::random`]) |
//! | | [`holdout`] | the part of each photograph that training keeps away from |
//! | start | [`initial`] | a first network: random analysis, or ISTA's matrices from a dictionary |
//! | coordinates | [`precondition`] | whitened windows, so that training is well conditioned |
//! | batch | [`edof_network::float::pass`] | forward pass and gradient |
//! | weights | [`weighting`], [`budget`] | weight of a window's error, and cost of a non-zero |
//! | step | [`adam`] | new weights |
//! | | [`structure`] | what weights keep to, so that a circuit could multiply less |
//! | lens | [`joint`] | a lens that moves along its network's gradient |
//! | before | [`length`] | what a short run loses |
//! | run | [`recipe`], [`train`], [`threads`] | schedule, [`validation`], checkpoints ([`checkpoint`]), resume |

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod adam;
pub mod augment;
pub mod budget;
pub mod checkpoint;
pub mod dataset;
mod encoding;
pub mod holdout;
pub mod initial;
pub mod joint;
pub mod length;
pub mod noise;
pub mod precondition;
pub mod recipe;
pub mod structure;
pub mod threads;
pub mod train;
pub mod validation;
pub mod weighting;
