//! rust-hdl's walk over a circuit: what its own `derive(LogicBlock)` gives, and where-clauses kept.

use crate::fields::Circuit;
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

pub fn tokens(circuit: &Circuit) -> TokenStream {
    let (name, (generics, arguments, clause)) = (circuit.name, circuit.generics.split_for_impl());
    let fields: Vec<_> = circuit.hardware().map(|field| field.name).collect();
    let keys: Vec<_> = fields.iter().map(ToString::to_string).collect();
    let around = |step: &str| {
        let step = format_ident!("{step}");
        let of = |which: TokenStream| quote!(::edof_verilog::describe::#which::#step(self););
        match &circuit.registers {
            Some(_) => (of(quote!(Holds)), of(quote!(Resets))),
            None => (quote!(), quote!()),
        }
    };
    let ((connect_holds, connect_resets), (holds, resets)) = (around("connect"), around("update"));
    quote! {
        impl #generics ::rust_hdl::prelude::Block for #name #arguments #clause {
            fn connect_all(&mut self) {
                #connect_holds
                ::rust_hdl::prelude::Logic::connect(self);
                #connect_resets
                #(::rust_hdl::prelude::Block::connect_all(&mut self.#fields);)*
            }

            fn update_all(&mut self) {
                #holds
                ::rust_hdl::prelude::Logic::update(self);
                #resets
                #(::rust_hdl::prelude::Block::update_all(&mut self.#fields);)*
            }

            fn has_changed(&self) -> bool {
                false #(|| ::rust_hdl::prelude::Block::has_changed(&self.#fields))*
            }

            fn accept(&self, name: &str, probe: &mut dyn ::rust_hdl::prelude::Probe) {
                probe.visit_start_scope(name, self);
                #(::rust_hdl::prelude::Block::accept(&self.#fields, #keys, probe);)*
                probe.visit_end_scope(name, self);
            }
        }
    }
}
