//! What the struct says: its fields, their documentation, and which of them start by themselves.

use crate::formula::{self, Formula};
use syn::{
    Attribute, Data, DeriveInput, Expr, ExprLit, Field, Fields, Generics, Ident, Lit, Meta, Type, Visibility,
};

/// Types that have a start value wherever they stand. Ports, the public fields, always have one: signals, or bundles of signals.
const SIGNALS: [&str; 2] = ["Signal", "DFF"];

/// A struct that is to be a circuit.
pub struct Circuit<'a> {
    pub name: &'a Ident,
    pub generics: &'a Generics,
    pub doc: String,
    pub fields: Vec<Part<'a>>,
    /// The field that says which of several roles a block of this type has.
    pub role: Option<Ident>,
    /// What clocks and resets the registers, where the kernel does not.
    pub registers: Option<Registers>,
}

/// `#[circuit(registers(clock, reset))]`: the clock of the registers, and what resets them.
pub struct Registers {
    pub clock: Ident,
    pub reset: Option<Ident>,
}

/// One of its fields.
pub struct Part<'a> {
    pub name: &'a Ident,
    pub ty: &'a Type,
    pub doc: String,
    /// Rust data rather than hardware: its name starts with `_`.
    pub is_data: bool,
    pub start: Start,
    /// The value after a reset, where the field says one.
    pub reset: Option<Expr>,
    /// The field with the names of the elements, for an array that has them.
    pub names: Option<Ident>,
    /// A constant that is printed as its value.
    pub is_literal: bool,
    /// A constant of unsigned type that is two's complement.
    pub is_signed: bool,
    /// What it, or its parameters, follow from.
    pub formulas: Vec<Formula>,
}

/// How a field gets its first value.
pub enum Start {
    /// By its `Default`.
    Itself,
    /// Each element of an array by its `Default`, whatever the array's length.
    Elements,
    /// The constructor sets it.
    Given,
    /// It follows from other constants.
    Derived,
}

impl<'a> Circuit<'a> {
    pub fn read(input: &'a DeriveInput) -> syn::Result<Self> {
        let refuse = || syn::Error::new_spanned(&input.ident, "a circuit is a struct with named fields");
        let Data::Struct(data) = &input.data else { return Err(refuse()) };
        let Fields::Named(named) = &data.fields else { return Err(refuse()) };
        let said = Said::of(&input.attrs)?;
        let part = |field: &'a Field| {
            let name = field.ident.as_ref().ok_or_else(refuse)?;
            let is_data = name.to_string().starts_with('_');
            let is_list = last_name(&field.ty).is_some_and(|name| name == "Vec");
            let is_port = !is_data && !is_list && matches!(field.vis, Visibility::Public(_));
            let formulas = formula::of(field)?;
            let is_constant = last_name(&field.ty).is_some_and(|name| name == "Constant");
            if let Some(wrong) = formulas.iter().find(|one| one.parameter.is_none() != is_constant) {
                let wanted = "`#[is(value)]` is for a Constant, `#[is(PARAMETER = value)]` for a leaf";
                return Err(syn::Error::new_spanned(&wrong.value, wanted));
            }
            let start = match is_constant && !formulas.is_empty() {
                true => Start::Derived,
                false => said.start(is_port, &field.ty),
            };
            let reset = reset_of(field, said.registers.as_ref())?;
            let names = attribute(field, "names").map(Attribute::parse_args).transpose()?;
            let is_literal = attribute(field, "literal").is_some();
            let is_signed = attribute(field, "signed").is_some();
            let doc = documentation(&field.attrs);
            Ok(Part {
                name,
                ty: &field.ty,
                doc,
                is_data,
                start,
                reset,
                names,
                is_literal,
                is_signed,
                formulas,
            })
        };
        let fields = named.named.iter().map(part).collect::<syn::Result<_>>()?;
        let doc = documentation(&input.attrs);
        if doc.is_empty() {
            let missing = "a circuit needs documentation: it becomes the header of its Verilog";
            return Err(syn::Error::new_spanned(&input.ident, missing));
        }
        let Said { role, registers, .. } = said;
        Ok(Self { name: &input.ident, generics: &input.generics, doc, fields, role, registers })
    }

    /// The fields that are registers.
    pub fn registers(&self) -> impl Iterator<Item = &Part<'a>> {
        self.fields.iter().filter(|field| is_register(field.ty))
    }

    /// The fields that are hardware.
    pub fn hardware(&self) -> impl Iterator<Item = &Part<'a>> {
        self.fields.iter().filter(|field| !field.is_data)
    }
}

fn is_register(ty: &Type) -> bool {
    last_name(ty).is_some_and(|name| name == "DFF" || name == "DFFWithInit")
}

/// The field's attribute of this name.
fn attribute<'f>(field: &'f Field, name: &str) -> Option<&'f Attribute> {
    field.attrs.iter().find(|attribute| attribute.path().is_ident(name))
}

/// The value of a field's `#[reset(value)]`.
fn reset_of(field: &Field, registers: Option<&Registers>) -> syn::Result<Option<Expr>> {
    let Some(attribute) = attribute(field, "reset") else { return Ok(None) };
    if !is_register(&field.ty) || registers.is_none_or(|registers| registers.reset.is_none()) {
        let missing = "`reset` is for registers of a struct with `#[circuit(registers(clock, reset))]`";
        return Err(syn::Error::new_spanned(attribute, missing));
    }
    attribute.parse_args().map(Some)
}

/// `#[circuit(default)]`, `#[circuit(default(A, B))]`, `#[circuit(role(_field))]`, `#[circuit(registers(clock, reset))]`.
#[derive(Default)]
struct Said {
    all: bool,
    types: Vec<Ident>,
    role: Option<Ident>,
    registers: Option<Registers>,
}

impl Said {
    fn of(attributes: &[Attribute]) -> syn::Result<Self> {
        let mut said = Self::default();
        for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("circuit")) {
            attribute.parse_nested_meta(|meta| {
                let in_brackets = meta.input.peek(syn::token::Paren);
                if meta.path.is_ident("registers") && in_brackets {
                    let mut names = vec![];
                    meta.parse_nested_meta(|field| {
                        names.push(field.path.require_ident()?.clone());
                        Ok(())
                    })?;
                    let mut names = names.into_iter();
                    let clock = names.next().ok_or_else(|| meta.error("the clock is missing"))?;
                    said.registers = Some(Registers { clock, reset: names.next() });
                    return Ok(());
                }
                match (meta.path.is_ident("default"), meta.path.is_ident("role"), in_brackets) {
                    (true, _, false) => said.all = true,
                    (true, _, true) => meta.parse_nested_meta(|ty| {
                        said.types.push(ty.path.require_ident()?.clone());
                        Ok(())
                    })?,
                    (_, true, true) => meta.parse_nested_meta(|field| {
                        said.role = Some(field.path.require_ident()?.clone());
                        Ok(())
                    })?,
                    _ => return Err(meta.error("`default`, `default(Type, …)`, `role(field)` or `registers(clock, reset)` is expected")),
                }
                Ok(())
            })?;
        }
        Ok(said)
    }

    fn start(&self, is_port: bool, ty: &Type) -> Start {
        let starts = |ty: &Type| {
            let name = last_name(ty);
            is_port
                || self.all
                || name.is_some_and(|name| SIGNALS.iter().any(|s| name == s) || self.types.contains(name))
        };
        match plain(ty) {
            Type::Array(array) if starts(&array.elem) => Start::Elements,
            ty if starts(ty) => Start::Itself,
            _ => Start::Given,
        }
    }
}

/// The type without the invisible brackets that `macro_rules!` puts around it.
fn plain(ty: &Type) -> &Type {
    match ty {
        Type::Group(group) => plain(&group.elem),
        Type::Paren(paren) => plain(&paren.elem),
        _ => ty,
    }
}

/// `DFF` of `widgets::DFF<Bits<8>>`.
fn last_name(ty: &Type) -> Option<&Ident> {
    match plain(ty) {
        Type::Path(path) => path.path.segments.last().map(|segment| &segment.ident),
        _ => None,
    }
}

/// The text of doc comments, a line each.
fn documentation(attributes: &[Attribute]) -> String {
    let line = |attribute: &Attribute| match &attribute.meta {
        Meta::NameValue(meta) if meta.path.is_ident("doc") => match &meta.value {
            Expr::Lit(ExprLit { lit: Lit::Str(text), .. }) => Some(text.value()),
            _ => None,
        },
        _ => None,
    };
    let lines: Vec<String> = attributes.iter().filter_map(line).collect();
    let trimmed: Vec<&str> = lines.iter().flat_map(|text| text.split('\n')).map(str::trim).collect();
    trimmed.join("\n").trim().to_string()
}
