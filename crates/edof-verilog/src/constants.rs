//! The constants of a module: values, formulas and the states of enums.

use crate::describe::{Description, Formula};
use crate::scope::Role;
use crate::sheet::{Constant, Constants};
use crate::source::index;
use crate::text::{Use, literal};
use crate::types::Type;
use crate::value::{Value, of_type, pattern};
use crate::write::Writer;

/// Bits of a whole number in Verilog.
pub(crate) const INTEGER: usize = 32;

/// The formula of a constant, if it gives its value, and the numbers in it.
pub(crate) fn formula<'d>(
    description: &'d Description,
    key: &str,
    digits: &str,
) -> Option<(&'static str, &'d [(&'static str, i128)])> {
    let Formula { text, given, .. } = description.formulas.iter().find(|formula| formula.field == key)?;
    let names: Vec<(String, i128)> = given.iter().map(|(name, value)| ((*name).into(), *value)).collect();
    let is_right = index(text, &names) == i128::from_str_radix(digits, 16).ok();
    is_right.then_some((*text, given.as_slice()))
}

impl Writer<'_> {
    /// The constants that the text names.
    pub fn constants(&mut self) -> Constants {
        let mut all = Constants::default();
        let mut given: Vec<(&'static str, i128)> = vec![];
        for (&id, &of) in &self.printer.constants {
            let signal = &self.scope.signals[id];
            let Role::Constant(digits) = &signal.role else { continue };
            let name = self.signal_name(id).split('[').next().unwrap_or_default().to_string();
            let comment = self.said(id);
            if let Some((formula, known)) = formula(self.description, &signal.key, digits) {
                given.extend(known.iter().filter(|one| !given.contains(one)).collect::<Vec<_>>());
                all.derived
                    .push((Constant { name, of_type: of_type(Type::bits(INTEGER)), comment }, formula));
                continue;
            }
            let field = signal.key.split('$').next().unwrap_or_default();
            let as_read =
                Type { signed: signal.ty.signed || self.description.signed.contains(&field), ..signal.ty };
            let value = Value { of_type: of_type(signal.ty), text: pattern(as_read, digits, of) };
            all.constants.push(Constant { name, of_type: value.of_type.clone(), comment });
            all.values.push(value);
        }
        for (name, value) in given {
            self.printer.names.reserve(name);
            let (name, of_type, comment) = (name.into(), String::new(), String::new());
            all.constants.push(Constant { name, of_type, comment });
            all.values.push(Value::grouped(value));
        }
        all
    }

    /// Declarations of states, those of an enum on one line.
    pub fn states(&self) -> Vec<String> {
        let mut enums: Vec<(&str, String)> = vec![];
        for (name, state) in self.printer.states.values() {
            let ty = Type::bits(state.bits);
            let value = format!("{name} = {}", literal(ty, state.value as i128, Use::Count));
            match enums.last_mut().filter(|(of, _)| *of == state.label.0) {
                Some((_, line)) => *line += &format!(", {value}"),
                None => enums.push((&state.label.0, format!("localparam {}{value}", of_type(ty)))),
            }
        }
        enums.into_iter().map(|(_, line)| line + ";").collect()
    }
}
