//! `#[derive(Circuit)]`: a rust-hdl block that says what it is, and is made without a word about its signals.
//!
//! | part | file | gives |
//! |---|---|---|
//! | read | `fields` | the fields, their documentation, which of them start by themselves |
//! | walk | `block` | rust-hdl's `Block` |
//! | say | `description` | `edof_verilog::describe::Circuit`: name, source, header, comments |
//! | clock | `registers` | what registers do before the kernel and after it |
//! | derive | `formula` | constants that follow from others |
//! | make | `make` | `from_parts`, or `Default` |
//! | mark | `kernel` | rust-hdl's `hdl_gen`, each statement with its line |

#![cfg_attr(not(test), warn(unused_crate_dependencies))]

mod block;
mod description;
mod fields;
mod formula;
mod kernel;
mod make;
mod registers;

use proc_macro::TokenStream;
use syn::{DeriveInput, parse_macro_input};

/// Makes a struct a circuit. Its documentation becomes the header of its Verilog module, that of its fields the comments of ports and
/// constants.
///
/// Ports (public fields: signals and bundles of signals), `Signal` and `DFF`, and arrays of them, start as their `Default`. Where that is true of all fields the
/// block gets `Default`. Otherwise it gets a private `fn from_parts(NameParts) -> Self`, and a private struct `NameParts` of the
/// fields that are left. `#[circuit(default)]` on the struct says that each field has a `Default`; `#[circuit(default(A, B))]`
/// that fields of the types `A` and `B` have one.
///
/// A module is called after the type. `#[circuit(role(_field))]` names a field whose text distinguishes blocks of one type, for instance the
/// stages of a chain; without it the const parameters of the type do.
/// `edof_verilog::describe` shows one.
///
/// `#[circuit(registers(clock))]` gives every field of the type `DFF` or `DFFWithInit` the clock of that field of the block, and holds its
/// value unless the kernel assigns another one, so that the kernel needs no `dff_setup!`. With `#[circuit(registers(clock, reset))]`
/// a field's `#[reset(value)]` is its value after a cycle of `reset`, whatever the kernel says. The value is a number, a constant of the
/// block or an expression: `#[reset(0)]`, `#[reset(false)]`, `#[reset(all_credits)]`, `#[reset(State::Idle)]`.
///
/// `#[names(_names)]` on an array says which data field has the names of its elements: element 8 of `at` is `at_status` in Verilog
/// if that is the ninth name, and of constants `addr` it is `ADDR_STATUS`. Constants with `#[literal]` are printed as their values,
/// those with `#[signed]` as two's complement.
///
/// `#[is(lanes / 2 - 1)]` on a `Constant` computes it from other constants of the block, so that `from_parts` does not ask for it. The Verilog
/// has the same formula in a `localparam`. `#[is(DEPTH = 2 * codes)]` on a part that is a leaf says what a parameter of the leaf follows from; the
/// backend rejects a leaf that has another value. A constant that formulas alone name is a whole number without a width.
#[proc_macro_derive(Circuit, attributes(circuit, is, reset, names, literal, signed))]
pub fn derive_circuit(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    fields::Circuit::read(&input)
        .map(|circuit| {
            let of = [block::tokens, description::tokens, registers::tokens, make::tokens];
            of.into_iter().map(|tokens| tokens(&circuit)).collect::<proc_macro2::TokenStream>()
        })
        .unwrap_or_else(syn::Error::into_compile_error)
        .into()
}

/// `#[hdl_gen]` whose statements know the line where they stand and the comment above them: both are in the Verilog and its source map.
///
/// The attribute is written on `fn update` of `impl Logic`, where rust-hdl's prelude is in scope.
#[proc_macro_attribute]
pub fn kernel(_arguments: TokenStream, item: TokenStream) -> TokenStream {
    let item = proc_macro2::TokenStream::from(item);
    let refuse = || syn::Error::new_spanned(&item, "a kernel is a function with a body").into_compile_error();
    kernel::tokens(item.clone()).unwrap_or_else(refuse).into()
}
