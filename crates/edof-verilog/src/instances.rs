//! The instances of a module, and the loops of them.

use crate::arrays::{Array, Pin, array_name, count_name};
use crate::expression::Expression;
use crate::kind::{Kind, pins_of, split_number};
use crate::sheet::{Constant, Instance, LeafParameter, Of, Turns, Written};
use crate::single::plain;
use crate::types::Type;
use crate::value::{Value, of_type};
use crate::write::Writer;

impl Writer<'_> {
    /// An instance, or a loop of them by its first.
    pub fn part(&mut self, n: usize) -> Written {
        match self.arrays.iter().find(|array| array.parts[0] == n) {
            Some(array) => self.array(array),
            None => self.instance(n),
        }
    }

    fn instance(&mut self, n: usize) -> Written {
        let part = &self.scope.parts[n];
        let name = self.printer.names.take(&plain(&self.tree.parts[part.index].key, self.single));
        let Some(kind) = &self.kinds[part.index] else { unreachable!("a register is no instance") };
        let pins = pins_of(part, kind);
        let pins = pins.into_iter().map(|(port, id)| {
            let value = self.printer.value(&Expression::signal(self.scope, id), "");
            format!(".{port}({value})")
        });
        let pins = pins.collect();
        let (of, parameters, values) = parameters(kind, None);
        Written {
            instance: Instance { of, name, parameters, pins, turns: None },
            values,
            count: None,
            of: part.index,
        }
    }

    /// A loop of instances.
    fn array(&mut self, array: &Array) -> Written {
        let part = &self.scope.parts[array.parts[0]];
        let Some(kind) = &self.kinds[part.index] else { unreachable!("a register is no instance") };
        let count = count_name(array);
        let label = self.printer.names.take(&array.key);
        let singular = array.key.strip_suffix('s').filter(|word| !word.is_empty()).unwrap_or("i");
        let variable = self.printer.names.take(if singular == "element" { "i" } else { singular });
        let name = self.printer.names.take("element");
        let (number, digits) = (self.printer.names.take("NUMBER"), self.printer.names.take("DIGITS"));
        let mut inside = vec![];
        let pins: Vec<String> = pins_of(part, kind)
            .into_iter()
            .zip(&array.pins)
            .map(|((port, id), pin)| {
                let value = match pin {
                    Pin::Same(value) => self.printer.value(value, ""),
                    Pin::Number(bits) => {
                        let line = format!("localparam {}{number} = {variable};", of_type(Type::bits(*bits)));
                        if !inside.contains(&line) {
                            inside.push(line);
                        }
                        number.clone()
                    }
                    Pin::Neighbour { from, next, .. } => {
                        let first = array.signals(self.scope, self.kinds, 0);
                        let name = array_name(self.signal_name(first[*from])).to_string();
                        format!("{name}[{variable}{}]", if *next { " + 1" } else { "" })
                    }
                    Pin::Output { next } => {
                        let name = array_name(self.signal_name(id));
                        format!("{name}[{variable}{}]", if *next == Some(false) { " + 1" } else { "" })
                    }
                };
                format!(".{port}({value})")
            })
            .collect();
        let last = &self.scope.parts[array.parts[array.parts.len() - 1]];
        let last = self.kinds[last.index].as_ref().map(|last| (last, digits.as_str()));
        let (of, parameters, values) = parameters(kind, last);
        if parameters.iter().any(|parameter| parameter.numbered.is_some()) {
            let value = format!("\"00\" + 256 * ({variable} / 10) + {variable} % 10");
            inside.push(format!("localparam [15:0] {digits} = {value};"));
        }
        let turns = Some(Turns { variable, count: count.clone(), label, inside });
        Written {
            instance: Instance { of, name, parameters, pins, turns },
            values,
            count: Some((
                Constant { name: count, of_type: String::new(), comment: String::new(), formula: None },
                Value::number(array.parts.len()),
            )),
            of: part.index,
        }
    }
}

/// A leaf's parameters and their values; for an array `last` is its last part, which shows what is numbered, and the name of the digits.
fn parameters(kind: &Kind, last: Option<(&Kind, &str)>) -> (Of, Vec<LeafParameter>, Vec<Value>) {
    let leaf = match kind {
        Kind::Module { occurrence, .. } => return (Of::Module(occurrence.class), vec![], vec![]),
        Kind::Leaf(leaf, _) => leaf,
    };
    let other = |n: usize| match last {
        Some((Kind::Leaf(last, _), digits)) => Some((&last.parameters[n].1, digits)),
        _ => None,
    };
    let of = |(n, (name, text)): (usize, &(String, String))| {
        let numbered = other(n).filter(|(other, _)| *other != text).and_then(|(_, digits)| {
            let (before, after) = split_number(text)?;
            Some((before, digits, after))
        });
        match numbered {
            Some((before, digits, after)) => (
                LeafParameter {
                    name: name.clone(),
                    numbered: Some(format!(", {digits}, \"{after}")),
                    formula: None,
                },
                Value::plain(format!("{before}\"")),
            ),
            None => (
                LeafParameter { name: name.clone(), numbered: None, formula: None },
                Value::plain(text.clone()),
            ),
        }
    };
    let (parameters, values) = leaf.parameters.iter().enumerate().map(of).unzip();
    (Of::Leaf(leaf.module.clone()), parameters, values)
}
