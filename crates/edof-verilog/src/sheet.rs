//! A module as text, but for its name and the values that it is given.

use std::fmt::Write;

use crate::interface::Interface;

/// No line that could be several is longer.
pub(crate) const WIDTH: usize = 100;

/// What equal modules share. Two blocks with equal sheets are one module; where their values differ it has parameters.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Sheet {
    /// The name that the module should have.
    pub name: String,
    /// The comment above it.
    pub header: String,
    /// Declarations of the ports, and comments.
    pub ports: Vec<(String, String)>,
    /// Slots that the text names: constants, then how often loops turn.
    pub constants: Vec<Constant>,
    /// States of enums.
    pub states: Vec<String>,
    pub signals: Vec<String>,
    pub between: Vec<String>,
    pub instances: Vec<Instance>,
    /// Paragraphs: runs of assignments, blocks.
    pub logic: Vec<Vec<String>>,
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

    /// The module's text. `module` names other modules.
    pub fn text(&self, name: &str, interface: &Interface, module: &dyn Fn(usize) -> String) -> String {
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
        let paragraphs = [constants, self.signals.clone(), self.between.clone()].into_iter();
        for lines in paragraphs.chain(written).chain(self.logic.iter().cloned()).filter(|l| !l.is_empty()) {
            text.push('\n');
            for line in lines {
                let indent = if line.is_empty() { "" } else { "    " };
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{indent}{line}");
            }
        }
        text + "endmodule\n\n`default_nettype wire\n"
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

/// Whether a paragraph is instances that take a line of pins at most.
fn is_short(lines: &[String]) -> bool {
    lines.chunks(3).all(|three| three.len() == 3 && three[0].ends_with('(') && three[2] == ");")
}

/// Lines in a bracket: commas between, comments behind.
fn list(lines: &[(String, String)]) -> String {
    let last = lines.len().saturating_sub(1);
    let with_comma = |(i, (line, comment)): (usize, &(String, String))| {
        (format!("{line}{}", if i == last { "" } else { "," }), comment.clone())
    };
    let lines: Vec<_> = lines.iter().enumerate().map(with_comma).collect();
    commented(&lines).iter().map(|line| format!("    {line}\n")).collect()
}

/// Lines with their comments below one another.
fn commented(lines: &[(String, String)]) -> Vec<String> {
    let width = lines.iter().map(|(line, _)| line.len()).max().unwrap_or(0);
    let line = |(line, comment): &(String, String)| match comment.is_empty() {
        true => line.clone(),
        false => format!("{line:width$} // {comment}"),
    };
    lines.iter().map(line).collect()
}

fn instance_lines(module: &str, parameters: &[String], instance: &str, pins: &[String]) -> Vec<String> {
    let list = |items: &[String]| {
        let last = items.len().saturating_sub(1);
        let line = |(i, item): (usize, &String)| format!("    {item}{}", if i == last { "" } else { "," });
        items.iter().enumerate().map(line).collect::<Vec<_>>()
    };
    let given = match parameters.join(", ") {
        none if none.is_empty() => String::new(),
        all => format!("#({all}) "),
    };
    let (head, all) = (format!("{module} {given}{instance} ("), pins.join(", "));
    let fits = |line: &str| line.len() + 8 <= WIDTH;
    let mut lines = vec![];
    if fits(&head) {
        lines.push(head);
        if fits(&all) {
            lines.extend([format!("    {all}"), ");".into()]);
            return lines;
        }
    } else {
        lines.push(format!("{module} #("));
        lines.extend(list(parameters));
        lines.push(format!(") {instance} ("));
    }
    lines.extend(list(pins));
    lines.push(");".into());
    lines
}
