//! How the circuit is made.

use crate::fields::{Circuit, Start};
use proc_macro2::TokenStream;
use quote::{format_ident, quote};

pub fn tokens(circuit: &Circuit) -> TokenStream {
    let (name, (generics, arguments, clause)) = (circuit.name, circuit.generics.split_for_impl());
    let start = circuit.fields.iter().map(|field| {
        let name = field.name;
        match field.start {
            Start::Itself => quote!(#name: ::core::default::Default::default()),
            Start::Elements => quote! {
                #name: ::core::array::from_fn(|_| ::core::default::Default::default())
            },
            Start::Given => quote!(#name: parts.#name),
        }
    });
    let given: Vec<_> = circuit.fields.iter().filter(|field| matches!(field.start, Start::Given)).collect();
    if given.is_empty() {
        return quote! {
            impl #generics ::core::default::Default for #name #arguments #clause {
                fn default() -> Self {
                    Self { #(#start),* }
                }
            }
        };
    }
    let parts = format_ident!("{name}Parts");
    let (names, types) = (given.iter().map(|field| field.name), given.iter().map(|field| field.ty));
    let declared = &circuit.generics;
    quote! {
        /// The fields that do not start by themselves.
        struct #parts #declared #clause {
            #(#names: #types),*
        }

        impl #generics #name #arguments #clause {
            /// The circuit of these parts, its signals and registers at their start.
            fn from_parts(parts: #parts #arguments) -> Self {
                Self { #(#start),* }
            }
        }
    }
}
