//! The network that a command runs on a design.

use crate::designs;
use crate::error::Error;
use crate::ui::Ui;
use crate::weights;
use edof_device::Design;
use edof_network::FixedNetwork;

/// Returns the network of `--weights` if it fits the design that the user named `given`; without `--weights` the random one of `edof random-network --design`.
///
/// # Errors
/// A network that cannot be read, or that does not fit.
pub fn of_design(
    design: &Design,
    given: &str,
    weights: Option<&str>,
    seed: u64,
    ui: &Ui,
) -> Result<FixedNetwork, Error> {
    let Some(name) = weights else { return Ok(edof_device::random::for_design(design, seed)) };
    ui.used(weights::fixed_input(name)?);
    let network = weights::fixed(name)?;
    designs::fits_given(design, given, &network)?;
    Ok(network)
}
