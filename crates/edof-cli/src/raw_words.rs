//! Values of options on the words of raw files, which several commands take.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use edof_io::packing::ByteOrder;
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
