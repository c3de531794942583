//! A module as text, without its name and its parameters.

use std::fmt::Write;

use crate::interface::Interface;
use crate::layout::{WIDTH, code, commented as wrapped, lay_out};
use crate::value::Value;

/// What equal modules share. Two blocks with equal sheets are one module; where their values differ it has parameters.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Sheet {
    /// The name that the module should have.
    pub name: String,
    /// The comment above it.
    pub header: String,
    /// Rust file of the module.
    pub source: String,
    /// Declarations of the ports, and comments.
    pub ports: Vec<(String, String)>,
    /// Slots that the text names: constants, then how often loops turn.
    pub constants: Vec<Constant>,
    /// States of enums.
    pub states: Vec<String>,
    pub signals: Vec<String>,
    /// Runs of assignments, blocks, instances.
    pub logic: Vec<Paragraph>,
    pub instances: Vec<Instance>,
    /// Paragraphs after the instances: blocks of registers.
    pub clocked: Vec<Vec<String>>,
}

/// A part of the text with an empty line above it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Paragraph {
    Lines(Vec<String>),
    /// An instance by its number, and the declarations above it.
    Instance {
        number: usize,
        above: Vec<String>,
    },
}

/// A constant that the text names.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Constant {
    pub name: String,
    /// `[11:0] `.
    pub of_type: String,
    pub comment: String,
    /// What it follows from; it is no parameter then.
    pub formula: Option<String>,
}

/// An instance and what belongs to it.
pub(crate) struct Written {
    pub instance: Instance,
    /// Values of the leaf's parameters.
    pub values: Vec<Value>,
    /// How often the loop turns.
    pub count: Option<(Constant, Value)>,
    /// Index of the tree's part.
    pub of: usize,
}

/// An instance, or a loop of them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Instance {
    pub of: Of,
    pub name: String,
    /// Parameters of a leaf; each is a slot.
    pub parameters: Vec<LeafParameter>,
    pub pins: Vec<String>,
    pub turns: Option<Turns>,
}

/// What an instance is one of.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Of {
    Module(usize),
    Leaf(String),
}

/// A parameter of a leaf.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct LeafParameter {
    pub name: String,
    /// Where the number of a loop's turn stands in a text: what follows the slot's value.
    pub numbered: Option<String>,
    /// What it follows from.
    pub formula: Option<String>,
}

/// A generate loop.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Turns {
    pub variable: String,
    /// Name of the constant that counts them.
    pub count: String,
    pub label: String,
    /// Declarations inside.
    pub inside: Vec<String>,
}

impl Sheet {
    /// What the values of slots follow from, in the order of the slots.
    pub fn formulas(&self) -> impl Iterator<Item = Option<&str>> {
        let constants = self.constants.iter().map(|constant| constant.formula.as_deref());
        let leaves = self.instances.iter().flat_map(|instance| &instance.parameters);
        constants.chain(leaves.map(|parameter| parameter.formula.as_deref()))
    }

    /// The module's text, and the Rust line behind each of its lines. `module` names other modules.
    pub fn text(
        &self,
        name: &str,
        interface: &Interface,
        module: &dyn Fn(usize) -> String,
    ) -> (String, Vec<Option<usize>>) {
        let mut text = self.header.clone() + &format!("`default_nettype none\nmodule {name} ");
        if !interface.parameters.is_empty() {
            let parameters = interface.parameters.iter();
            let lines = parameters.map(|parameter| (parameter.declaration(), parameter.comment.clone()));
            text += &format!("#(\n{}) ", list(&in_rows(lines)));
        }
        text += &format!("(\n{});\n", list(&self.ports));
        let mut constants = self.fixed(interface);
        constants.extend(self.states.iter().cloned());
        let written = self.written(interface, module);
        let paragraphs = [constants, self.signals.clone()].into_iter().chain(written);
        let all = paragraphs.chain(self.clocked.iter().cloned());
        for lines in all.filter(|lines| !lines.is_empty()) {
            text.push('\n');
            for line in lines {
                let indent = if line.is_empty() { "" } else { "    " };
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{indent}{line}");
            }
        }
        lay_out(&(text + "endmodule\n`default_nettype wire\n"))
    }

    /// The paragraphs of the logic: short instances stand in rows, and wires right above the instance that reads them.
    fn written(&self, interface: &Interface, module: &dyn Fn(usize) -> String) -> Vec<Vec<String>> {
        let mut written: Vec<Vec<String>> = vec![];
        // The instance that ends the last paragraph, and its lines.
        let mut before: Option<(&Of, usize)> = None;
        for paragraph in &self.logic {
            let (lines, of) = match paragraph {
                Paragraph::Lines(lines) => (lines.clone(), None),
                Paragraph::Instance { number, above } => {
                    let instance = &self.instances[*number];
                    let lines = self.instance(*number, instance, interface, module);
                    ([above.clone(), lines].concat(), Some(&instance.of))
                }
            };
            let now = of.map(|of| (of, lines.len()));
            let belongs = |last: &Vec<String>| match (before, now) {
                (Some(before), Some(now)) => is_row(before, now),
                (None, Some(_)) => feeds(last, &lines),
                _ => false,
            };
            match written.last_mut() {
                Some(last) if belongs(last) => last.extend(lines),
                _ => written.push(lines),
            }
            before = now;
        }
        written
    }

    /// Declarations of the constants that are no parameters. Those of one type that need no comment share a line, and what follows from others
    /// stands below them.
    fn fixed(&self, interface: &Interface) -> Vec<String> {
        let mut lines: Vec<(String, String)> = vec![];
        let mut shared = "";
        let fixed = self.constants.iter().zip(&interface.slots).filter(|(_, slot)| !slot.is_parameter);
        let (derived, mut given): (Vec<_>, Vec<_>) =
            fixed.partition(|(constant, _)| constant.formula.is_some());
        let types: Vec<String> = given.iter().map(|(constant, _)| constant.of_type.clone()).collect();
        let of_its_type = |constant: &Constant| types.iter().position(|of_type| *of_type == constant.of_type);
        given.sort_by_key(|(constant, _)| (!constant.comment.is_empty(), of_its_type(constant)));
        for (Constant { name, of_type, comment, .. }, slot) in given.into_iter().chain(derived) {
            let value = format!("{name} = {}", slot.text);
            match lines.last_mut() {
                Some((line, said)) if said.is_empty() && comment.is_empty() && shared == of_type => {
                    line.pop();
                    *line += &format!(", {value};");
                }
                _ => lines.push((format!("localparam {of_type}{value};"), comment.clone())),
            }
            shared = of_type;
        }
        commented(&lines)
    }

    fn instance(
        &self,
        number: usize,
        instance: &Instance,
        interface: &Interface,
        module: &dyn Fn(usize) -> String,
    ) -> Vec<String> {
        let before: usize = self.instances[..number].iter().map(|other| other.parameters.len()).sum();
        let slots = &interface.slots[self.constants.len() + before..];
        let leaf = instance.parameters.iter().zip(slots).map(|(parameter, slot)| match &parameter.numbered {
            Some(after) => format!(".{}({{{}{after}}})", parameter.name, slot.text),
            None => format!(".{}({})", parameter.name, slot.text),
        });
        let passed = interface.passed[number].iter().map(|(name, text)| format!(".{name}({text})"));
        let parameters: Vec<String> = leaf.chain(passed).collect();
        let of = match &instance.of {
            Of::Module(class) => module(*class),
            Of::Leaf(leaf) => leaf.clone(),
        };
        let lines = instance_lines(&of, &parameters, &instance.name, &instance.pins);
        let Some(turns) = &instance.turns else { return lines };
        let Turns { variable, count, label, inside } = turns;
        let head = [
            format!("genvar {variable};"),
            "generate".into(),
            format!(
                "    for ({variable} = 0; {variable} < {count}; {variable} = {variable} + 1) begin : {label}"
            ),
        ];
        let body = inside.iter().chain(&lines).map(|line| format!("        {line}"));
        let tail = ["    end".to_string(), "endgenerate".into()];
        head.into_iter().chain(body).chain(tail).collect()
    }
}

/// Lines of an instance, with the declarations above it, that stands in a row with others, and with others of its module.
const SHORT: usize = 3;
const SHORT_OF_MODULE: usize = 5;

/// Whether two instances that follow each other, with so many lines, stand in a row.
fn is_row(before: (&Of, usize), now: (&Of, usize)) -> bool {
    let longest = before.1.max(now.1);
    longest <= if before.0 == now.0 { SHORT_OF_MODULE } else { SHORT }
}

/// Whether the lines are few wires, all of which the instance reads.
fn feeds(lines: &[String], instance: &[String]) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let reads = |name: &str| instance.iter().any(|line| line.split(|c| !is_word(c)).any(|word| word == name));
    let is_read = |line: &String| match code(line).strip_prefix("wire ") {
        // Each name stands before its value.
        Some(rest) if rest.contains(" = ") => {
            let names = rest.split(" = ").map(|before| before.rsplit(' ').next().unwrap_or_default());
            let count = rest.matches(" = ").count();
            names.take(count).all(reads)
        }
        _ => line.starts_with("//"),
    };
    lines.len() <= SHORT && lines.iter().all(is_read)
}

/// Declarations without comments, as many as a line takes.
fn in_rows(declarations: impl Iterator<Item = (String, String)>) -> Vec<(String, String)> {
    let mut rows: Vec<(String, String)> = vec![];
    for (declaration, comment) in declarations {
        match rows.last_mut() {
            Some((row, said))
                if said.is_empty() && comment.is_empty() && row.len() + declaration.len() + 6 <= WIDTH =>
            {
                *row += &format!(", {declaration}");
            }
            _ => rows.push((declaration, comment)),
        }
    }
    rows
}

/// Lines in a bracket: commas between, comments behind. Empty lines part groups.
fn list(lines: &[(String, String)]) -> String {
    let last = lines.len().saturating_sub(1);
    let with_comma = |(i, (line, comment)): (usize, &(String, String))| {
        let comma = if i == last || line.is_empty() { "" } else { "," };
        (format!("{line}{comma}"), comment.clone())
    };
    let lines: Vec<_> = lines.iter().enumerate().map(with_comma).collect();
    commented(&lines).iter().map(|line| format!("    {line}\n")).collect()
}

/// Lines with their comments below one another; a comment that is too long stands above.
fn commented(lines: &[(String, String)]) -> Vec<String> {
    let said = lines.iter().filter(|(_, comment)| !comment.is_empty());
    let width = said.map(|(line, _)| line.len()).max().unwrap_or(0);
    let line = |(line, comment): &(String, String)| match comment.is_empty() {
        true => vec![line.clone()],
        false if width + comment.len() + 6 > WIDTH => {
            let mut lines = wrapped(&format!(" {comment}"), 2);
            lines.iter_mut().for_each(|line| *line = line.trim_start().into());
            lines.push(line.clone());
            lines
        }
        false => vec![format!("{line:width$} // {comment}")],
    };
    lines.iter().flat_map(line).collect()
}

fn instance_lines(module: &str, parameters: &[String], instance: &str, pins: &[String]) -> Vec<String> {
    let given = match parameters.join(", ") {
        none if none.is_empty() => String::new(),
        all => format!("#({all}) "),
    };
    let (head, all) = (format!("{module} {given}{instance} ("), pins.join(", "));
    let one = format!("{head}{all});");
    if one.len() + 2 <= WIDTH {
        return vec![one];
    }
    let below = format!("    {instance} ({all});");
    if !given.is_empty() && module.len() + given.len() + 2 <= WIDTH && below.len() <= WIDTH {
        return vec![format!("{module} {}", given.trim_end()), below];
    }
    let mut lines = vec![];
    if head.len() + 2 <= WIDTH {
        lines.push(head);
    } else {
        lines.push(format!("{module} #("));
        lines.extend(filled(parameters));
        lines.push(format!(") {instance} ("));
    }
    lines.extend(filled(pins));
    lines.push(");".into());
    lines
}

/// Items side by side, as many as a line takes.
fn filled(items: &[String]) -> Vec<String> {
    let mut lines: Vec<String> = vec![];
    let last = items.len().saturating_sub(1);
    for (n, item) in items.iter().enumerate() {
        let item = format!("{item}{}", if n == last { "" } else { "," });
        match lines.last_mut() {
            Some(line) if line.len() + item.len() < WIDTH - 6 => *line += &format!(" {item}"),
            _ => lines.push(format!("    {item}")),
        }
    }
    lines
}
