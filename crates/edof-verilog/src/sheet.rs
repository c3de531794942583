//! A module as text, without its name and its parameters.

use std::fmt::Write;

use crate::interface::Interface;
use crate::layout::{WIDTH, commented as wrapped, lay_out};

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
    /// Paragraphs: runs of assignments, blocks.
    pub logic: Vec<Vec<String>>,
    pub instances: Vec<Instance>,
    /// Paragraphs after the instances: blocks of registers.
    pub clocked: Vec<Vec<String>>,
}

/// A constant that the text names.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Constant {
    pub name: String,
    /// `[11:0] `.
    pub of_type: String,
    pub comment: String,
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
    /// How many slots the sheet has: constants, then parameters of leaves.
    pub fn slots(&self) -> usize {
        self.constants.len() + self.instances.iter().map(|instance| instance.parameters.len()).sum::<usize>()
    }

    /// The module's text, and the Rust line behind each of its lines. `module` names other modules.
    pub fn text(
        &self,
        name: &str,
        interface: &Interface,
        module: &dyn Fn(usize) -> String,
    ) -> (String, Vec<Option<usize>>) {
        let mut text = self.header.clone() + &format!("`default_nettype none\n\nmodule {name} ");
        if !interface.parameters.is_empty() {
            let lines: Vec<(String, String)> = (interface.parameters.iter())
                .map(|parameter| (parameter.declaration(), parameter.comment.clone()))
                .collect();
            text += &format!("#(\n{}) ", list(&lines));
        }
        text += &format!("(\n{});\n", list(&self.ports));
        let fixed = self.constants.iter().zip(&interface.slots).filter(|(_, slot)| !slot.is_parameter);
        let constants: Vec<(String, String)> = fixed
            .map(|(constant, slot)| {
                let Constant { name, of_type, comment } = constant;
                (format!("localparam {of_type}{name} = {};", slot.text), comment.clone())
            })
            .collect();
        let mut constants = commented(&constants);
        constants.extend(self.states.iter().cloned());
        let instances = self.instances.iter().enumerate();
        let mut written: Vec<Vec<String>> = vec![];
        for lines in instances.map(|(n, instance)| self.instance(n, instance, interface, module)) {
            match written.last_mut() {
                Some(last) if is_short(&lines) && is_short(last) => last.extend(lines),
                _ => written.push(lines),
            }
        }
        let paragraphs = [constants, self.signals.clone()].into_iter().chain(self.logic.iter().cloned());
        let all = paragraphs.chain(written).chain(self.clocked.iter().cloned());
        for lines in all.filter(|lines| !lines.is_empty()) {
            text.push('\n');
            for line in lines {
                let indent = if line.is_empty() { "" } else { "    " };
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{indent}{line}");
            }
        }
        lay_out(&(text + "endmodule\n\n`default_nettype wire\n"))
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

/// Whether a paragraph is instances that take a line each.
fn is_short(lines: &[String]) -> bool {
    lines.iter().all(|line| line.ends_with(");"))
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
    let width = lines.iter().map(|(line, _)| line.len()).max().unwrap_or(0);
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
