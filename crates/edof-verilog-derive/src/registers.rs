//! The registers of a circuit: connected, held and reset by what their fields say.

use crate::fields::{Circuit, Registers};
use proc_macro2::TokenStream;
use quote::quote;
use syn::{Expr, Lit};

/// What runs before the kernel and after it, as kernels of their own.
pub fn tokens(circuit: &Circuit) -> TokenStream {
    let Some(Registers { clock, reset }) = &circuit.registers else { return quote!() };
    let (name, (generics, arguments, clause)) = (circuit.name, circuit.generics.split_for_impl());
    let registers: Vec<_> = circuit.registers().map(|field| field.name).collect();
    let resets = circuit.registers().filter_map(|field| Some((field.name, field.reset.as_ref()?)));
    let resets = resets.map(|(name, value)| {
        let value = value_of(value);
        quote!(self.#name.d.next = #value;)
    });
    let at = clock.span().unwrap();
    let mark = format!("@ {}:{}", at.file(), at.start().line());
    let reset = reset.as_ref().map(|reset| {
        quote! {
            assert!(true, #mark);
            if self.#reset.val() {
                #(#resets)*
            }
        }
    });
    quote! {
        const _: () = {
            use ::rust_hdl::prelude::*;

            impl #generics ::edof_verilog::describe::Holds for #name #arguments #clause {
                #[hdl_gen]
                fn update(&mut self) {
                    dff_setup!(self, #clock, #(#registers),*);
                }
            }

            impl #generics ::edof_verilog::describe::Resets for #name #arguments #clause {
                #[hdl_gen]
                #[allow(clippy::assertions_on_constants)]
                fn update(&mut self) {
                    #reset
                }
            }
        };
    }
}

/// `0` of rust-hdl's type, the value of a constant, or any other expression as it is.
fn value_of(value: &Expr) -> TokenStream {
    match value {
        Expr::Lit(literal) if matches!(literal.lit, Lit::Int(_)) => quote!(#value.into()),
        Expr::Path(path) if path.path.get_ident().is_some() => quote!(self.#value.val()),
        _ => quote!(#value),
    }
}
