//! `#[is(…)]`: a constant, or a leaf's parameter, that follows from constants of its block.

use proc_macro2::TokenStream;
use quote::quote;
use syn::parse::{Parse, ParseStream};
use syn::{BinOp, Block, Expr, ExprLit, Field, Ident, Lit, LitInt, Stmt, Token};

/// The formula of a field's `#[is(…)]`.
pub struct Formula {
    /// The leaf's parameter; none where the field is a constant.
    pub parameter: Option<Ident>,
    pub value: Expr,
}

impl Parse for Formula {
    fn parse(input: ParseStream) -> syn::Result<Self> {
        let is_parameter = input.peek(syn::Ident) && input.peek2(Token![=]) && !input.peek2(Token![==]);
        let parameter = if is_parameter {
            let name = input.parse()?;
            input.parse::<Token![=]>()?;
            Some(name)
        } else {
            None
        };
        Ok(Self { parameter, value: input.parse()? })
    }
}

/// The formulas of a field.
pub fn of(field: &Field) -> syn::Result<Vec<Formula>> {
    field
        .attrs
        .iter()
        .filter(|attribute| attribute.path().is_ident("is"))
        .map(|one| one.parse_args())
        .collect()
}

impl Formula {
    /// The formula as Verilog says it, each constant in braces.
    pub fn verilog(&self) -> syn::Result<String> {
        let text = verilog(&self.value)?;
        let is_choice = matches!(self.value, Expr::If(_));
        Ok(if is_choice { text[1..text.len() - 1].into() } else { text })
    }

    /// The value as Rust computes it, of whole numbers that are called as the constants are.
    pub fn rust(&self) -> syn::Result<TokenStream> {
        rust(&self.value)
    }

    /// The constants that it names.
    pub fn names(&self) -> syn::Result<Vec<Ident>> {
        let mut names = vec![];
        collect(&self.value, &mut names)?;
        Ok(names)
    }
}

fn refuse<T>(what: &Expr) -> syn::Result<T> {
    let expected =
        "numbers, constants, `+ - * / %`, and `if` whose condition compares two of these are expected";
    Err(syn::Error::new_spanned(what, expected))
}

/// Verilog computes both sides of a comparison in as many bits as these have, so nothing is computed there.
fn is_atom(side: &Expr) -> bool {
    matches!(side, Expr::Lit(_) | Expr::Path(_))
}

fn verilog(value: &Expr) -> syn::Result<String> {
    Ok(match value {
        Expr::Lit(ExprLit { lit: Lit::Int(number), .. }) => number.to_string(),
        Expr::Path(name) => format!("{{{}}}", name.path.require_ident()?),
        Expr::Paren(inner) => format!("({})", verilog(&inner.expr)?),
        Expr::Binary(of) => {
            let Some((sign, _)) = sign(&of.op, is_atom(&of.left) && is_atom(&of.right)) else {
                return refuse(value);
            };
            format!("{} {sign} {}", verilog(&of.left)?, verilog(&of.right)?)
        }
        Expr::If(choice) => {
            let Some((then, otherwise)) = sides(choice) else { return refuse(value) };
            format!("({} ? {} : {})", verilog(&choice.cond)?, verilog(then)?, verilog(otherwise)?)
        }
        other => return refuse(other),
    })
}

fn rust(value: &Expr) -> syn::Result<TokenStream> {
    Ok(match value {
        Expr::Lit(ExprLit { lit: Lit::Int(number), .. }) => {
            let number = LitInt::new(&format!("{}u64", number.base10_digits()), number.span());
            quote!(#number)
        }
        Expr::Path(name) => quote!(#name),
        Expr::Paren(inner) => rust(&inner.expr)?,
        Expr::Binary(of) => {
            let Some((_, call)) = sign(&of.op, true) else { return refuse(value) };
            let (left, right) = (rust(&of.left)?, rust(&of.right)?);
            quote!(::edof_verilog::formula::#call(#left, #right))
        }
        Expr::If(choice) => {
            let Some((then, otherwise)) = sides(choice) else { return refuse(value) };
            let (test, then, otherwise) = (rust(&choice.cond)?, rust(then)?, rust(otherwise)?);
            quote!(if #test != 0 { #then } else { #otherwise })
        }
        other => return refuse(other),
    })
}

fn collect(value: &Expr, names: &mut Vec<Ident>) -> syn::Result<()> {
    match value {
        Expr::Path(name) => {
            let name = name.path.require_ident()?.clone();
            if !names.contains(&name) {
                names.push(name);
            }
        }
        Expr::Paren(inner) => collect(&inner.expr, names)?,
        Expr::Binary(of) => {
            collect(&of.left, names)?;
            collect(&of.right, names)?;
        }
        Expr::If(choice) => {
            let Some((then, otherwise)) = sides(choice) else { return refuse(value) };
            [&choice.cond, then, otherwise].into_iter().try_for_each(|part| collect(part, names))?;
        }
        _ => {}
    }
    Ok(())
}

/// The sign in Verilog, and the function that computes it in Rust.
fn sign(op: &BinOp, of_atoms: bool) -> Option<(&'static str, TokenStream)> {
    Some(match op {
        BinOp::Add(_) => ("+", quote!(add)),
        BinOp::Sub(_) => ("-", quote!(subtract)),
        BinOp::Mul(_) => ("*", quote!(multiply)),
        BinOp::Div(_) => ("/", quote!(divide)),
        BinOp::Rem(_) => ("%", quote!(remainder)),
        BinOp::Gt(_) if of_atoms => (">", quote!(is_more)),
        BinOp::Eq(_) if of_atoms => ("==", quote!(is_equal)),
        _ => return None,
    })
}

/// The two values of an `if`.
fn sides(choice: &syn::ExprIf) -> Option<(&Expr, &Expr)> {
    let (_, otherwise) = choice.else_branch.as_ref()?;
    let otherwise = match &**otherwise {
        Expr::Block(block) => only(&block.block)?,
        _ => otherwise,
    };
    Some((only(&choice.then_branch)?, otherwise))
}

/// The value of a block that is nothing else.
fn only(block: &Block) -> Option<&Expr> {
    match &block.stmts[..] {
        [Stmt::Expr(value, None)] => Some(value),
        _ => None,
    }
}
