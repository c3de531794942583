//! How the circuit is made.

use crate::fields::{Circuit, Start};
use proc_macro2::{Span, TokenStream};
use quote::{format_ident, quote};
use syn::Ident;

pub fn tokens(circuit: &Circuit) -> TokenStream {
    made(circuit).unwrap_or_else(syn::Error::into_compile_error)
}

/// The whole numbers that constants follow from, and those that they are.
fn derived(circuit: &Circuit, all: &Ident) -> syn::Result<TokenStream> {
    let derived = || circuit.fields.iter().filter(|field| matches!(field.start, Start::Derived));
    let mut known: Vec<Ident> = vec![];
    let mut lines = quote!();
    for field in derived() {
        let formula = &field.formulas[0];
        for name in formula.names()?.into_iter().filter(|name| !derived().any(|field| field.name == name)) {
            if !known.contains(&name) {
                lines.extend(quote!(let #name = ::edof_verilog::formula::whole(&#all.#name);));
                known.push(name);
            }
        }
        let (name, value) = (field.name, formula.rust()?);
        lines.extend(quote!(let #name = #value;));
    }
    Ok(lines)
}

fn made(circuit: &Circuit) -> syn::Result<TokenStream> {
    // A field may have the same name.
    let all = Ident::new("parts", Span::mixed_site());
    let (name, (generics, arguments, clause)) = (circuit.name, circuit.generics.split_for_impl());
    let start: Vec<_> = circuit
        .fields
        .iter()
        .map(|field| {
            let name = field.name;
            match field.start {
                Start::Derived => quote!(#name: ::edof_verilog::formula::constant(#name)),
                Start::Itself => quote!(#name: ::core::default::Default::default()),
                Start::Elements => quote! {
                    #name: ::core::array::from_fn(|_| ::core::default::Default::default())
                },
                Start::Given => quote!(#name: #all.#name),
            }
        })
        .collect();
    let given: Vec<_> = circuit.fields.iter().filter(|field| matches!(field.start, Start::Given)).collect();
    if given.is_empty() {
        return Ok(quote! {
            impl #generics ::core::default::Default for #name #arguments #clause {
                fn default() -> Self {
                    Self { #(#start),* }
                }
            }
        });
    }
    let parts = format_ident!("{name}Parts");
    let (names, types) = (given.iter().map(|field| field.name), given.iter().map(|field| field.ty));
    let declared = &circuit.generics;
    let derived = derived(circuit, &all)?;
    Ok(quote! {
        /// The fields that do not start by themselves.
        struct #parts #declared #clause {
            #(#names: #types),*
        }

        impl #generics #name #arguments #clause {
            /// The circuit of these parts, its signals and registers at their start.
            fn from_parts(#all: #parts #arguments) -> Self {
                #derived
                Self { #(#start),* }
            }
        }
    })
}
