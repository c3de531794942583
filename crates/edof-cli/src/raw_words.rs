//! Values of options on the words of raw files, which several commands take.

use crate::error::Error;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use edof_io::packing::{ByteOrder, Packing};
use edof_io::raw::Alignment;

/// Reads `--align`.
pub fn alignment() -> impl TypedValueParser<Value = Alignment> {
    PossibleValuesParser::new(["top", "bottom"])
        .map(|word| if word == "top" { Alignment::Top } else { Alignment::Bottom })
}

/// Reads `--order`.
pub fn byte_order() -> impl TypedValueParser<Value = ByteOrder> {
    PossibleValuesParser::new(["little", "big"])
        .map(|word| if word == "big" { ByteOrder::Big } else { ByteOrder::Little })
}

/// Rejects an order of bytes that has no effect on a packing.
///
/// # Errors
/// The option, and what to do.
pub fn check_order(order: ByteOrder, packing: Packing) -> Result<(), Error> {
    if order == ByteOrder::default() || packing == Packing::Words {
        return Ok(());
    }
    Err(Error::message(format!(
        "--order big: has no effect on {}, which has no words; leave --order out, or use --packing words",
        packing.name()
    )))
}
