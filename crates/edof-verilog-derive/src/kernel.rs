//! A kernel whose statements know where they stand.

use proc_macro2::{Delimiter, Group, Span, TokenStream, TokenTree};
use quote::{quote, quote_spanned};

/// First word of a mark; `edof-verilog` reads marks back.
const MARK: &str = "@";

/// The kernel with a mark before each statement: the line where it stands and the comment above it. None where there is no body.
///
/// A mark is an `assert!(true, …)`, which rust-hdl keeps in its syntax tree as a comment, and which does nothing when it runs.
pub fn tokens(item: TokenStream) -> Option<TokenStream> {
    let mut head: Vec<TokenTree> = item.into_iter().collect();
    let body = match head.pop()? {
        TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => group,
        _ => return None,
    };
    let text = Text::of(&body);
    let statements = statements(body.stream());
    let marked = statements.iter().map(|statement| {
        let mark = text.mark(statement[0].span());
        let statement: TokenStream = statement.iter().cloned().collect();
        quote! {
            assert!(true, #mark);
            #statement
        }
    });
    let marked = quote_spanned!(body.span()=> { #(#marked)* });
    let head: TokenStream = head.into_iter().collect();
    Some(quote! {
        #[hdl_gen]
        #[allow(clippy::assertions_on_constants)]
        #head #marked
    })
}

/// The statements of a block: what ends in a semicolon, and `if`, `match` and `for` with their blocks.
fn statements(body: TokenStream) -> Vec<Vec<TokenTree>> {
    let mut statements = vec![];
    let mut statement: Vec<TokenTree> = vec![];
    let mut tokens = body.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let is_end = match &token {
            TokenTree::Punct(punct) => punct.as_char() == ';',
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => {
                let goes_on = tokens.peek().is_some_and(|next| is_word(next, &["else"]));
                statement.first().is_some_and(|first| is_word(first, &["if", "match", "for"])) && !goes_on
            }
            _ => false,
        };
        statement.push(token);
        if is_end {
            statements.push(std::mem::take(&mut statement));
        }
    }
    statements.extend(Some(statement).filter(|rest| !rest.is_empty()));
    statements
}

fn is_word(token: &TokenTree, words: &[&str]) -> bool {
    matches!(token, TokenTree::Ident(word) if words.iter().any(|wanted| word == wanted))
}

/// The kernel's text, line by line.
struct Text {
    first: usize,
    lines: Vec<String>,
}

impl Text {
    fn of(body: &Group) -> Self {
        let text = body.span().source_text().unwrap_or_default();
        Self { first: line(body.span()), lines: text.lines().map(String::from).collect() }
    }

    /// `@ src/uart.rs:143 What the step reads.`: the comment right above the statement.
    fn mark(&self, statement: Span) -> String {
        let at = line(statement);
        let above = &self.lines[..at.saturating_sub(self.first).min(self.lines.len())];
        let indent = " ".repeat(statement.unwrap().start().column() - 1);
        let mut comment: Vec<&str> = above.iter().rev().map_while(|line| comment_of(line, &indent)).collect();
        comment.reverse();
        // Quotes and braces mean something in a format string.
        let comment = comment.join(" ").replace(['"', '{', '}', '\\'], "'");
        format!("{MARK} {}:{at} {comment}", statement.unwrap().file()).trim_end().to_string()
    }
}

/// What a comment says that is indented so.
fn comment_of<'l>(line: &'l str, indent: &str) -> Option<&'l str> {
    Some(line.strip_prefix(indent)?.strip_prefix("//")?.trim())
}

fn line(span: Span) -> usize {
    span.unwrap().start().line()
}
