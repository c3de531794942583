//! Experiments: what is measured, on what, and what the rows say together.
//!
//! | what | module | gives |
//! |---|---|---|
//! | parts | [`methods`] | every reconstruction method behind one interface |
//! | | [`metrics`] | what a reconstruction is worth, and what it costs |
//! | | [`report`] | plots, tables, CSV and HTML pages |
//! | | [`stability`] | hard cases and their acceptance limits |
//! | shared | [`experiment`] | what all experiments share: missing rows, shards, progress, an end before the end |
//! | | [`journal`] | rows in a file, shared out among machines, put together again |
//! | | [`key`] | the text that keys of rows are hashes of |
//! | | [`study_report`] | what a file of rows says, whatever study it is of |
//! | | [`made`] | what a page states of its making |
//! | input | [`setup`] | cameras and the methods behind each |
//! | | [`trial`] | a photograph at a depth behind a camera, and what a reconstruction of it is worth |
//! | run | [`kodak`] | every method on every photograph, depth and noise level |
//! | | [`single_depth`] | speed against error: rows in a file, resumed where they end |
//! | | [`multi_depth`] | scenes at four depths through several lenses, the paper's columns |
//! | | [`knobs`] | what can be left out: a curve for each knob |
//! | | [`known_blurs`] | blind deconvolution of synthetic blurs |
//! | | [`aperture`] | a coded lens against smaller apertures of its clear lens, in equal light |
//! | | [`lens_networks`] | masks against clear lenses, blind, with the depth known, and with several exposures, each with networks of its own |
//! | | [`bound`] | what no lens passes, and how near to it a lens comes |
//! | | [`codes`] | codes that programs can read, by lens, depth and light |
//! | | [`tolerances`] | errors of a lens that cost 0.1 dB |
//! | | [`design`] | foldings of networks that fit the board, and their front |
//! | | [`labels`] | parcels at four depths, whose labels carry codes and text |
//! | | [`demo`] | one scene at four depths through several lenses |
//! | | [`lens`] | MTF, contrast through focus, a sheet of PSFs |
//! | | [`live`] | a picture before a lens that is moved while somebody looks |
//! | tell | [`summary`] | averages, worst depths, what fixed point and 4:2:2 cost |
//! | | [`tables`] | the same with standard errors, for a terminal, as Markdown, as a report and in LaTeX (`Study::to_latex`) |
//! | | [`speed`] | what rows of one depth say together, and what the paper says |
//! | | [`pictures`] | pictures of a scene of several depths, judged depth by depth |
//! | | [`demo_report`] | the demo's verdict and its report |

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

pub mod aperture;
pub mod bound;
pub mod codes;
pub mod demo;
pub mod demo_report;
pub mod design;
pub mod experiment;
pub mod journal;
pub mod key;
pub mod knobs;
pub mod known_blurs;
pub mod kodak;
pub mod labels;
mod latex;
pub mod lens;
pub mod lens_networks;
pub mod live;
pub mod made;
pub mod methods;
pub mod metrics;
pub mod multi_depth;
mod opening;
pub mod pictures;
pub mod report;
pub mod setup;
pub mod single_depth;
pub mod speed;
pub mod stability;
pub mod study_report;
pub mod summary;
pub mod tables;
pub mod tolerances;
pub mod trial;
mod verdict;
