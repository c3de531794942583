//! What a reconstruction is worth: metrics, experiments, plots and reports.
//!
//! | what | module | gives |
//! |---|---|---|
//! | input | [`photos`] | the test or training photographs of a folder |
//! | | [`method`] | what a method is, as data |
//! | | [`nets`] | trained nets as methods behind their cameras |
//! | | [`dictionary`] | sharp atoms for pursuits, learned from photographs |
//! | | [`spec`] | methods with their settings, and how each prepares for a case |
//! | | [`settings`] | the settings, as values that rows' hashes are taken of |
//! | | [`pursuit`] | OMP and FISTA in the dictionary as the camera shows it |
//! | | [`untrained`] | the paper's network before training, ISTA cut off |
//! | | [`deconvolution`] | demosaicing and deconvolution of each colour |
//! | | [`patchwork`] | frames as windows and patches |
//! | | [`board`] | a network on a design: its golden picture, and its cycles as time |
//! | run | [`kodak`] | every method on every photograph, depth and noise level |
//! | | [`single_depth`] | speed against error: rows in a file, gone on with where they end |
//! | | [`cpu_time`] | what a run costs whatever else the machine does |
//! | | [`memory`] | the memory that the process holds, and the most that a run held |
//! | | [`timing`] | least, median and most of a method's runs |
//! | | [`number`] | numbers of rows that JSON has no form for |
//! | | [`made`] | what a page states of its making |
//! | | [`told`] | what a file of rows says, whatever study it is of |
//! | | [`speed`] | what those rows say together, and what the paper says |
//! | | [`multi_depth`] | scenes at four depths through several lenses, the paper's columns |
//! | | [`knobs`] | what can be left out: a curve for each knob |
//! | | [`design`] | foldings of networks that fit the board, and their front |
//! | | [`known_blurs`] | blind deconvolution of drawn blurs |
//! | | [`journal`] | rows in a file, shared out among machines, put together again |
//! | | [`summary`] | averages, worst depths, what fixed point and 4:2:2 cost |
//! | | [`paired`] | differences of two methods with their standard errors |
//! | | [`tables`] | the same for a terminal, as Markdown and as a report |
//! | | [`pictures`] | pictures of a scene of several depths, judged depth by depth |
//! | | [`demo`] | one scene at four depths through several lenses |
//! | | [`demo_report`] | its verdict and its report |
//! | compare | [`metrics`] | PSNR and SSIM with the conventions of every number of this project |
//! | sharpness | [`mtf50`] | MTF and MTF50 of a slanted edge |
//! | optics | [`lens`] | MTF, contrast through focus, a sheet of PSFs |
//! | draw | [`plot`] | line and scatter plots as SVG |
//! | show | [`picture`] | frames as PNG bytes, sheets, kernels |
//! | | [`csv`] | rows for spreadsheets |
//! | report | [`report`] | one HTML file with everything inside |
//!
//! ```
//! use edof_image::ColourFrame;
//! use edof_study::metrics::Quality;
//!
//! let truth = ColourFrame::zeros(32, 32);
//! let mut estimate = truth.clone();
//! estimate.planes += 0.01;
//! let quality = Quality::of(&truth, &estimate, 2)?;
//! assert!((quality.psnr_db - 40.0).abs() < 1e-4);
//! # Ok::<(), edof_study::metrics::MetricError>(())
//! ```

pub mod board;
pub mod cpu_time;
pub mod csv;
pub mod deconvolution;
pub mod demo;
pub mod demo_report;
pub mod design;
pub mod dictionary;
pub mod journal;
pub mod knobs;
pub mod known_blurs;
pub mod kodak;
pub mod lens;
pub mod made;
pub mod memory;
pub mod method;
pub mod metrics;
pub mod mtf50;
pub mod multi_depth;
pub mod nets;
pub mod number;
pub mod paired;
pub mod patchwork;
pub mod photos;
pub mod picture;
pub mod pictures;
pub mod plot;
pub mod pursuit;
pub mod report;
pub mod settings;
pub mod single_depth;
pub mod spec;
pub mod speed;
pub mod summary;
pub mod tables;
pub mod timing;
pub mod told;
pub mod untrained;
