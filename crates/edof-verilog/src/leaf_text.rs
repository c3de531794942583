//! What a leaf's own Verilog says: its ports, what parts it has, and which outputs follow which inputs within a cycle.
//!
//! The reader knows ANSI module headers, `assign`, wires with a value, clocked blocks, instances. Where it cannot tell what follows what (an
//! `always @*`, an instance of a module whose text is missing) it takes every output to follow every input.

use std::collections::{BTreeMap, BTreeSet};

use crate::Direction;

/// The head of a leaf, and what of it is combinational.
#[derive(Debug)]
pub(crate) struct LeafText {
    pub module: String,
    /// Parameters, each with the tokens of its default.
    pub parameters: Vec<(String, Vec<String>)>,
    pub ports: Vec<LeafPort>,
    /// Modules that it instantiates.
    pub parts: BTreeSet<String>,
    /// From an input to an output that may follow it within the cycle.
    pub paths: Vec<(String, String)>,
}

/// A port of a leaf.
#[derive(Debug)]
pub(crate) struct LeafPort {
    pub name: String,
    pub direction: Direction,
    /// Tokens of the range's upper and lower end; none for one bit.
    range: Option<(Vec<String>, Vec<String>)>,
}

/// Words that are no names.
const WORDS: [&str; 30] = [
    "always",
    "assign",
    "begin",
    "case",
    "default",
    "else",
    "end",
    "endcase",
    "endgenerate",
    "endmodule",
    "for",
    "function",
    "generate",
    "genvar",
    "if",
    "initial",
    "input",
    "integer",
    "localparam",
    "module",
    "negedge",
    "output",
    "parameter",
    "posedge",
    "reg",
    "signed",
    "wire",
    "or",
    "unsigned",
    "endfunction",
];

impl LeafText {
    /// Reads the first module of a text; those that follow are what it may instantiate.
    ///
    /// # Errors
    /// What is not understood.
    pub fn read(text: &str) -> Result<Self, String> {
        let tokens = tokens(text);
        let first = tokens.iter().position(|token| token == "module").ok_or("it has no module")?;
        Self::at(&tokens, first, 0)
    }

    /// The module that starts at a token, `depth` instances below the first.
    fn at(tokens: &[String], start: usize, depth: usize) -> Result<Self, String> {
        let mut at = start + 1;
        let module = tokens.get(at).cloned().ok_or("its module has no name")?;
        at += 1;
        let mut parameters = vec![];
        if tokens.get(at).is_some_and(|token| token == "#") {
            let end = closing(tokens, at + 1)?;
            for item in split(&tokens[at + 2..end], ",") {
                let equals = item.iter().position(|t| t == "=").ok_or("a parameter has no default")?;
                let name = item[..equals].last().cloned().ok_or("a parameter has no name")?;
                parameters.push((name, item[equals + 1..].to_vec()));
            }
            at = end + 1;
        }
        let end = closing(tokens, at)?;
        let ports = split(&tokens[at + 1..end], ",").map(LeafPort::read).collect::<Result<Vec<_>, _>>()?;
        let mut body = Body { text: tokens, depth, edges: BTreeMap::new(), parts: BTreeSet::new() };
        body.read(&tokens[end + 1..])?;
        let paths = body.paths(&ports);
        Ok(Self { module, parameters, ports, parts: body.parts, paths })
    }

    /// The width of a port where these parameters are set.
    pub fn bits(&self, port: &LeafPort, set: &[(String, String)]) -> Option<usize> {
        let Some((high, low)) = &port.range else { return Some(1) };
        let value = |tokens: &[String]| Numbers { leaf: self, set, tokens, at: 0, depth: 0 }.whole();
        usize::try_from(value(high)? - value(low)? + 1).ok().filter(|bits| *bits > 0)
    }
}

impl LeafPort {
    fn read(item: &[String]) -> Result<Self, String> {
        let direction = match item.first().map(String::as_str) {
            Some("input") => Direction::Input,
            Some("output") => Direction::Output,
            _ => return Err(format!("`{}` is no port with its direction", item.join(" "))),
        };
        let name = item.last().cloned().ok_or("a port has no name")?;
        let range = match item.iter().position(|token| token == "[") {
            Some(open) => {
                let inside: Vec<&[String]> = split(&item[open + 1..item.len() - 2], ":").collect();
                let [high, low] = inside[..] else {
                    return Err(format!("the range of `{name}` is not understood"));
                };
                Some((high.to_vec(), low.to_vec()))
            }
            None => None,
        };
        Ok(Self { name, direction, range })
    }
}

/// Names, numbers, text and signs, without comments, attributes and directives.
fn tokens(text: &str) -> Vec<String> {
    let mut tokens = vec![];
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") || (first == '`' && !rest.starts_with("`EDOF")) {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if rest.starts_with("(*") && !rest.starts_with("(*)") {
            rest.find("*)").map_or(rest.len(), |end| end + 2)
        } else if first == '"' {
            let length = rest[1..].find('"').map_or(rest.len(), |end| end + 2);
            tokens.push(rest[..length].to_string());
            length
        } else if first.is_ascii_alphanumeric() || "_$`'".contains(first) {
            let ends = |c: char| !c.is_ascii_alphanumeric() && !"_$`'".contains(c);
            let length = rest.find(ends).unwrap_or(rest.len());
            tokens.push(rest[..length].to_string());
            length
        } else {
            let two =
                rest.get(..2).filter(|two| ["<=", ">=", "==", "!=", "&&", "||", "<<", ">>"].contains(two));
            let token = two.unwrap_or(&rest[..first.len_utf8()]);
            if !first.is_whitespace() {
                tokens.push(token.to_string());
            }
            token.len()
        };
        rest = &rest[length..];
    }
    tokens
}

/// Where the bracket that stands at `open` closes.
fn closing(tokens: &[String], open: usize) -> Result<usize, String> {
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return Ok(at);
        }
    }
    Err("a bracket does not close".into())
}

/// The items between separators outside of brackets.
fn split<'t>(tokens: &'t [String], separator: &'static str) -> impl Iterator<Item = &'t [String]> {
    let mut depth = 0_usize;
    tokens
        .split(move |token| {
            match token.as_str() {
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0 && token == separator
        })
        .filter(|item| !item.is_empty())
}

/// The names among tokens.
fn names(tokens: &[String]) -> BTreeSet<&str> {
    let is_name = |token: &&str| {
        token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && !WORDS.contains(token)
    };
    tokens.iter().map(String::as_str).filter(is_name).collect()
}

/// Instances within instances that are followed; modules may instantiate each other without end.
const MAX_DEPTH: usize = 16;

/// What follows what in a body.
struct Body<'t> {
    /// Tokens of all modules of the text.
    text: &'t [String],
    depth: usize,
    edges: BTreeMap<String, BTreeSet<String>>,
    parts: BTreeSet<String>,
}

impl Body<'_> {
    fn read(&mut self, tokens: &[String]) -> Result<(), String> {
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            at = match token.as_str() {
                "endmodule" => return Ok(()),
                "always" => {
                    let is_star = tokens.get(at + 2).is_some_and(|next| next == "*");
                    let start = if is_star { at + 3 } else { closing(tokens, at + 2)? + 1 };
                    let end = statement(tokens, start)?;
                    if !tokens[at..start].iter().any(|token| token == "posedge") {
                        self.all(&tokens[start..end]);
                    }
                    end
                }
                "initial" => statement(tokens, at + 1)?,
                "if" | "for" => closing(tokens, at + 1)? + 1,
                "assign" | "wire" | "reg" | "localparam" | "genvar" | "integer" => {
                    let end = semicolon(tokens, at)?;
                    self.value(&tokens[at..end]);
                    end + 1
                }
                word if names(&tokens[at..=at]).contains(word) && is_instance(tokens, at) => {
                    self.parts.insert(word.into());
                    let end = semicolon(tokens, at)?;
                    self.instance(word, &tokens[at + 1..end])?;
                    end + 1
                }
                _ => at + 1,
            };
        }
        Err("it has no endmodule".into())
    }

    /// What an instance's outputs follow: by its own text, if that is there.
    fn instance(&mut self, module: &str, tokens: &[String]) -> Result<(), String> {
        let starts = self.text.windows(2).position(|two| two[0] == "module" && two[1] == module);
        let Some(start) = starts.filter(|_| self.depth < MAX_DEPTH) else {
            self.all(tokens);
            return Ok(());
        };
        let name = if tokens.first().is_some_and(|token| token == "#") { closing(tokens, 1)? + 1 } else { 0 };
        let close = closing(tokens, name + 1)?;
        let pins: Vec<(&str, BTreeSet<&str>)> = split(&tokens[name + 2..close], ",")
            .filter_map(|pin| Some((pin.get(1)?.as_str(), names(pin.get(2..)?))))
            .collect();
        let at = |port: &str| -> Vec<&str> {
            let is_it = |(pin, _): &&(&str, BTreeSet<&str>)| *pin == port;
            pins.iter().filter(is_it).flat_map(|(_, names)| names.iter().copied()).collect()
        };
        let leaf =
            LeafText::at(self.text, start, self.depth + 1).map_err(|why| format!("{module}: {why}"))?;
        for (from, to) in &leaf.paths {
            for from in at(from) {
                self.edges.entry(from.into()).or_default().extend(at(to).into_iter().map(String::from));
            }
        }
        Ok(())
    }

    /// What stands left of `=` follows what stands right of it.
    fn value(&mut self, tokens: &[String]) {
        let Some(equals) = tokens.iter().position(|token| token == "=") else { return };
        let (left, right) = tokens.split_at(equals);
        for from in names(right) {
            self.edges.entry(from.into()).or_default().extend(names(left).into_iter().map(String::from));
        }
    }

    /// Each may follow each.
    fn all(&mut self, tokens: &[String]) {
        for from in names(tokens) {
            self.edges.entry(from.into()).or_default().extend(names(tokens).into_iter().map(String::from));
        }
    }

    fn paths(&self, ports: &[LeafPort]) -> Vec<(String, String)> {
        let of =
            |direction| ports.iter().filter(move |port| port.direction == direction).map(|port| &port.name);
        let mut paths = vec![];
        for input in of(Direction::Input) {
            let (mut seen, mut open) = (BTreeSet::new(), vec![input.as_str()]);
            while let Some(name) = open.pop() {
                if seen.insert(name) {
                    open.extend(self.edges.get(name).into_iter().flatten().map(String::as_str));
                }
            }
            let reached = of(Direction::Output).filter(|output| seen.contains(output.as_str()));
            paths.extend(reached.map(|output| (input.clone(), output.clone())));
        }
        paths
    }
}

/// `edof_macc macc_a (` or `edof_macc #(`.
fn is_instance(tokens: &[String], at: usize) -> bool {
    let next = |n: usize| tokens.get(at + n).map(String::as_str);
    next(1) == Some("#") || (next(2) == Some("(") && names(&tokens[at + 1..at + 2]).len() == 1)
}

fn semicolon(tokens: &[String], from: usize) -> Result<usize, String> {
    let at = tokens[from..].iter().position(|token| token == ";").ok_or("a `;` is missing")?;
    Ok(from + at)
}

/// The end of the statement that starts at `from`.
fn statement(tokens: &[String], from: usize) -> Result<usize, String> {
    match tokens.get(from).map(String::as_str) {
        Some("begin") => {
            let mut depth = 0_usize;
            for (at, token) in tokens.iter().enumerate().skip(from) {
                match token.as_str() {
                    "begin" | "case" => depth += 1,
                    "end" | "endcase" => depth -= 1,
                    _ => {}
                }
                if depth == 0 {
                    return Ok(at + 1);
                }
            }
            Err("a `begin` has no `end`".into())
        }
        Some("if" | "for") => {
            let end = statement(tokens, closing(tokens, from + 1)? + 1)?;
            if tokens.get(end).is_some_and(|token| token == "else") {
                statement(tokens, end + 1)
            } else {
                Ok(end)
            }
        }
        _ => Ok(semicolon(tokens, from)? + 1),
    }
}

/// Whole-number arithmetic of parameters.
struct Numbers<'a> {
    leaf: &'a LeafText,
    set: &'a [(String, String)],
    tokens: &'a [String],
    at: usize,
    depth: usize,
}

impl Numbers<'_> {
    fn whole(mut self) -> Option<i64> {
        let value = self.sum()?;
        (self.at == self.tokens.len()).then_some(value)
    }

    fn next(&mut self, wanted: &[&str]) -> Option<String> {
        let token = self.tokens.get(self.at).filter(|token| wanted.contains(&token.as_str()))?;
        self.at += 1;
        Some(token.clone())
    }

    fn sum(&mut self) -> Option<i64> {
        let mut value = self.product()?;
        while let Some(sign) = self.next(&["+", "-"]) {
            let other = self.product()?;
            value = if sign == "+" { value.checked_add(other)? } else { value.checked_sub(other)? };
        }
        Some(value)
    }

    fn product(&mut self) -> Option<i64> {
        let mut value = self.number()?;
        while let Some(sign) = self.next(&["*", "/"]) {
            let other = self.number()?;
            value = if sign == "*" { value.checked_mul(other)? } else { value.checked_div(other)? };
        }
        Some(value)
    }

    fn number(&mut self) -> Option<i64> {
        if self.next(&["("]).is_some() {
            let value = self.sum()?;
            self.next(&[")"])?;
            return Some(value);
        }
        let token = self.tokens.get(self.at)?;
        self.at += 1;
        if let Ok(number) = token.parse() {
            return Some(number);
        }
        if let Some((_, text)) = self.set.iter().find(|(name, _)| name == token) {
            return text.parse().ok();
        }
        let (_, default) = self.leaf.parameters.iter().find(|(name, _)| name == token)?;
        // A parameter may be made of others, but not of itself.
        let deeper =
            Numbers { leaf: self.leaf, set: self.set, tokens: default, at: 0, depth: self.depth + 1 };
        if self.depth > self.leaf.parameters.len() { None } else { deeper.whole() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAF: &str = "
        // A comment with module words.
        `default_nettype none
        module edof_thing #(
            parameter WIDTH = 4,
            parameter DOUBLE = 2 * WIDTH
        ) (
            input  wire              clock_i,
            input  wire [WIDTH-1:0]  now_i,
            input  wire              at_once_i,
            output wire [DOUBLE-1:0] later_o,
            output wire              through_o
        );
            (* keep *) reg [DOUBLE-1:0] q;
            wire inner = at_once_i && (now_i <= 4'd3);
            always @(posedge clock_i) if (inner) q <= {2{now_i}}; else begin q <= q; end
            edof_part #(.A(1)) part (.x_i(inner), .y_o(through_o));
            assign later_o = q;
        endmodule";

    #[test]
    fn a_head_is_read() {
        let leaf = LeafText::read(LEAF).unwrap();
        assert_eq!(leaf.module, "edof_thing");
        let set = [("WIDTH".to_string(), "6".to_string())];
        let ports: Vec<_> = leaf
            .ports
            .iter()
            .map(|port| (port.name.as_str(), port.direction, leaf.bits(port, &set)))
            .collect();
        let (input, output) = (Direction::Input, Direction::Output);
        let wanted = [
            ("clock_i", input, Some(1)),
            ("now_i", input, Some(6)),
            ("at_once_i", input, Some(1)),
            ("later_o", output, Some(12)),
            ("through_o", output, Some(1)),
        ];
        assert_eq!(ports, wanted);
    }

    #[test]
    fn what_is_not_registered_follows_within_the_cycle() {
        let leaf = LeafText::read(LEAF).unwrap();
        let paths: Vec<_> = leaf.paths.iter().map(|(from, to)| (from.as_str(), to.as_str())).collect();
        assert_eq!(paths, [("now_i", "through_o"), ("at_once_i", "through_o")]);
        assert!(leaf.parts.contains("edof_part"));
    }

    #[test]
    fn an_instance_is_followed_through_its_own_text() {
        let text = |part: &str| {
            format!(
                "module top (input wire a_i, input wire b_i, output wire y_o); part p (.x_i(a_i), .n_i(b_i), .y_o(y_o)); endmodule {part}"
            )
        };
        let paths = |text: &str| LeafText::read(text).unwrap().paths.len();
        assert_eq!(paths(&text("")), 2, "without its text every input is followed");
        let part =
            "module part (input wire x_i, input wire n_i, output wire y_o); assign y_o = x_i; endmodule";
        assert_eq!(paths(&text(part)), 1);
        let endless = "module part (input wire x_i, input wire n_i, output wire y_o); part q (.x_i(x_i), .n_i(n_i), .y_o(y_o)); endmodule";
        assert_eq!(paths(&text(endless)), 2);
    }

    #[test]
    fn what_is_no_leaf_is_rejected() {
        assert_eq!(LeafText::read("wire x;").unwrap_err(), "it has no module");
        assert_eq!(
            LeafText::read("module a (input wire x; endmodule").unwrap_err(),
            "a bracket does not close"
        );
        assert_eq!(LeafText::read("module a (input wire x);").unwrap_err(), "it has no endmodule");
    }
}
