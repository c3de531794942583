//! The constants of a module: values, formulas and the states of enums.

use crate::scope::Role;
use crate::sheet::{Constant, Constants};
use crate::source::index;
use crate::text::{Use, literal};
use crate::types::Type;
use crate::value::{Value, of_type, pattern};
use crate::write::Writer;

impl Writer<'_> {
    /// The constants that the text names.
    pub fn constants(&mut self) -> Constants {
        let mut all = Constants::default();
        let mut given: Vec<(&'static str, i128)> = vec![];
        for (&id, &of) in &self.printer.constants {
            let signal = &self.scope.signals[id];
            let Role::Constant(digits) = &signal.role else { continue };
            let name = self.signal_name(id).to_string();
            let field = signal.key.split('$').next().unwrap_or_default();
            let as_read =
                Type { signed: signal.ty.signed || self.description.signed.contains(&field), ..signal.ty };
            let value = Value { of_type: of_type(signal.ty), text: pattern(as_read, digits, of) };
            let constant = Constant { name, of_type: value.of_type.clone(), comment: self.said(id) };
            let Some((formula, known)) = self.formula(&signal.key, digits, &given) else {
                all.constants.push(constant);
                all.values.push(value);
                continue;
            };
            given.extend(known);
            all.derived.push((constant, formula));
        }
        for (name, value) in given {
            self.printer.names.reserve(name);
            all.constants.push(Constant {
                name: name.into(),
                of_type: String::new(),
                comment: String::new(),
            });
            all.values.push(Value::grouped(value));
        }
        all
    }

    /// The formula of a constant that gives its value, and the names in it that are not given yet.
    fn formula(
        &self,
        key: &str,
        digits: &str,
        given: &[(&'static str, i128)],
    ) -> Option<(&'static str, Vec<(&'static str, i128)>)> {
        let (_, formula, known) = self.description.formulas.iter().find(|(field, ..)| *field == key)?;
        let names: Vec<(String, i128)> = known.iter().map(|(name, value)| ((*name).into(), *value)).collect();
        let is_right = index(formula, &names) == i128::from_str_radix(digits, 16).ok();
        let is_free = |(name, value): &(&str, i128)| given.iter().all(|(n, v)| n != name || v == value);
        let new = known.iter().filter(|one| !given.contains(one)).copied().collect();
        (is_right && known.iter().all(is_free)).then_some((*formula, new))
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
