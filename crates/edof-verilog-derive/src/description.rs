//! What the circuit says of itself.

use crate::fields::{Circuit, Part};
use crate::formula::Formula;
use proc_macro2::TokenStream;
use quote::quote;

pub fn tokens(circuit: &Circuit) -> TokenStream {
    described(circuit).unwrap_or_else(syn::Error::into_compile_error)
}

fn described(circuit: &Circuit) -> syn::Result<TokenStream> {
    let (name, (generics, arguments, clause)) = (circuit.name, circuit.generics.split_for_impl());
    let (text, doc) = (name.to_string(), &circuit.doc);
    let fields: Vec<_> = circuit.hardware().map(|field| field.name).collect();
    let keys: Vec<_> = fields.iter().map(ToString::to_string).collect();
    let said = circuit.hardware().filter(|field| !field.doc.is_empty()).map(|field| {
        let (key, doc) = (field.name.to_string(), field.doc.replace('\n', " "));
        quote!((#key, #doc))
    });
    let names = circuit.hardware().filter_map(|field| {
        let (key, names) = (field.name.to_string(), field.names.as_ref()?);
        Some(quote!((#key, self.#names.iter().map(::std::string::ToString::to_string).collect())))
    });
    let literals = circuit.hardware().filter(|field| field.is_literal).map(|field| field.name.to_string());
    let signed = circuit.hardware().filter(|field| field.is_signed).map(|field| field.name.to_string());
    let role = match &circuit.role {
        Some(field) => quote!(::std::string::ToString::to_string(&self.#field)),
        None => sizes(circuit),
    };
    let formulas = formulas(circuit)?;
    let around = circuit.registers.as_ref().map(|_| {
        quote! {
            found.around(
                ::edof_verilog::describe::Holds::hdl(self),
                ::edof_verilog::describe::Resets::hdl(self),
            );
        }
    });
    Ok(quote! {
        impl #generics ::edof_verilog::describe::Circuit for #name #arguments #clause {
            fn describe(&self, key: &str, found: &mut ::edof_verilog::describe::Descriptions) {
                let description = ::edof_verilog::describe::Description {
                    name: #text,
                    source: ::core::file!(),
                    header: #doc,
                    role: #role,
                    fields: &[#(#said),*],
                    names: ::std::vec![#(#names),*],
                    literals: &[#(#literals),*],
                    signed: &[#(#signed),*],
                    formulas: ::std::vec![#(#formulas),*],
                };
                found.block(key, description, |found| {
                    #around
                    #(::edof_verilog::describe::Circuit::describe(&self.#fields, #keys, found);)*
                });
            }
        }
    })
}

/// What constants and parameters of leaves follow from.
fn formulas(circuit: &Circuit) -> syn::Result<Vec<TokenStream>> {
    let all = circuit.hardware().flat_map(|field| field.formulas.iter().map(move |formula| (field, formula)));
    let one = |(field, formula): (&Part, &Formula)| {
        let (key, text, value) = (field.name.to_string(), formula.verilog()?, formula.rust()?);
        let parameter = formula.parameter.as_ref().map(ToString::to_string).unwrap_or_default();
        let names = formula.names()?;
        let keys = names.iter().map(ToString::to_string);
        Ok(quote! {
            ::edof_verilog::describe::Formula {
                field: #key,
                parameter: #parameter,
                text: #text,
                names: &[#(#keys),*],
                value: {
                    #(let #names = ::edof_verilog::formula::whole(&self.#names);)*
                    #value
                },
            }
        })
    };
    all.map(one).collect()
}

/// `w8_n3` of a type with the numbers `W` and `N`, which tell its modules apart.
fn sizes(circuit: &Circuit) -> TokenStream {
    let names: Vec<_> = circuit.generics.const_params().map(|parameter| &parameter.ident).collect();
    let text = names
        .iter()
        .map(|name| format!("{}{{}}", name.to_string().to_lowercase()))
        .collect::<Vec<_>>()
        .join("_");
    quote!(::std::format!(#text #(, #names)*))
}
