//! Every reconstruction method of this project, with all its settings, behind one interface.
//!
//! | what | module | gives |
//! |---|---|---|
//! | identity | [`method`] | what a method is, as data: family, network, format, stride, layers |
//! | registry | [`spec`] | methods with their settings, by name, and how each prepares for a camera, a depth and a noise |
//! | | [`settings`] | the settings, as values that rows' hashes are taken of |
//! | | [`nets`] | trained networks in every format that they have |
//! | | [`by_noise`], [`nets_by_noise`] | several networks as one method, chosen by the noise |
//! | families | [`deconvolution`] | demosaicing and deconvolution of each colour, kernels known or found |
//! | | [`pursuit`] | OMP and FISTA in the dictionary as the camera shows it |
//! | | [`untrained`] | the paper's network before training, ISTA cut off |
//! | | [`board`] | a network on a design: its golden picture, and its cycles as time |
//! | | [`external`] | anybody's program, run on every frame |
//! | parts | [`dictionary`] | sharp atoms for pursuits, learned from photographs |
//! | | [`patchwork`] | frames as windows and patches |
//!
//! To add a method: a [`Family`](method::Family), a [`MethodSpec`](spec::MethodSpec) that holds its settings, a name in `spec`, and what it
//! prepares there.
//!
//! ```
//! use edof_study::methods::dictionary::Dictionary;
//! use edof_study::methods::spec::MethodSpec;
//! use std::sync::Arc;
//! let dictionary = Arc::new(Dictionary::load(None)?);
//! let methods = MethodSpec::named("wiener", &[], &dictionary)?;
//! assert_eq!(methods[0].method().to_string(), "wiener");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod board;
pub mod by_noise;
pub mod deconvolution;
pub mod dictionary;
pub mod external;
pub mod method;
pub mod nets;
pub mod nets_by_noise;
pub mod patchwork;
pub mod pursuit;
pub mod settings;
pub mod spec;
pub mod untrained;
