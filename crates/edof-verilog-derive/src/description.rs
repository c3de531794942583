//! What the circuit says of itself.

use crate::fields::Circuit;
use proc_macro2::TokenStream;
use quote::quote;

pub fn tokens(circuit: &Circuit) -> TokenStream {
    let (name, (generics, arguments, clause)) = (circuit.name, circuit.generics.split_for_impl());
    let (text, doc) = (name.to_string(), &circuit.doc);
    let fields: Vec<_> = circuit.hardware().map(|field| field.name).collect();
    let keys: Vec<_> = fields.iter().map(ToString::to_string).collect();
    let said = circuit.hardware().filter(|field| !field.doc.is_empty()).map(|field| {
        let (key, doc) = (field.name.to_string(), field.doc.replace('\n', " "));
        quote!((#key, #doc))
    });
    let role = match &circuit.role {
        Some(field) => quote!(::std::string::ToString::to_string(&self.#field)),
        None => sizes(circuit),
    };
    let around = circuit.registers.as_ref().map(|_| {
        quote! {
            found.around(
                ::edof_verilog::describe::Holds::hdl(self),
                ::edof_verilog::describe::Resets::hdl(self),
            );
        }
    });
    quote! {
        impl #generics ::edof_verilog::describe::Circuit for #name #arguments #clause {
            fn describe(&self, key: &str, found: &mut ::edof_verilog::describe::Descriptions) {
                let description = ::edof_verilog::describe::Description {
                    name: #text,
                    source: ::core::file!(),
                    header: #doc,
                    role: #role,
                    fields: &[#(#said),*],
                };
                found.block(key, description, |found| {
                    #around
                    #(::edof_verilog::describe::Circuit::describe(&self.#fields, #keys, found);)*
                });
            }
        }
    }
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
