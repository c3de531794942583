//! The constants of a module, what they and the parameters of leaves follow from, and the states of enums.

use std::collections::{BTreeMap, BTreeSet};

use crate::describe::Formula;
use crate::error::{EmitError, Fault};
use crate::scope::{Role, Signal, SignalId};
use crate::sheet::{Constant, Written};
use crate::text::{Use, literal};
use crate::types::Type;
use crate::value::{Value, of_type, pattern};
use crate::write::Writer;

/// Bits of a whole number in Verilog.
pub(crate) const INTEGER: usize = 32;

impl Writer<'_> {
    /// Says what the parameters of a leaf follow from, where its field does. All that the text names is known then.
    pub fn derive(&mut self, written: &mut Written) -> Result<(), EmitError> {
        let part = &self.tree.parts[written.of];
        let field = part.key.split('$').next().unwrap_or_default();
        for (parameter, value) in written.instance.parameters.iter_mut().zip(&written.values) {
            let Some(formula) = self.description.formula(field, &parameter.name).cloned() else { continue };
            if formula.value.to_string() != value.text {
                let found = format!("{}({})", parameter.name, value.text);
                let fault = Fault::Formula { found, formula: formula.plain(), value: formula.value };
                return Err(EmitError::block(&part.path, fault));
            }
            parameter.formula = Some(self.formula(&formula)?);
            if self.is_narrow(&formula) {
                return Err(EmitError::block(&part.path, Fault::NarrowFormula(formula.plain())));
            }
        }
        Ok(())
    }

    /// The constants that the text and its formulas name, and their values. One that formulas alone name is a whole number.
    pub fn constants(&mut self) -> Result<(Vec<Constant>, Vec<Value>), EmitError> {
        let mut formulas: BTreeMap<SignalId, String> = BTreeMap::new();
        let mut open: Vec<SignalId> = self.printer.constants.keys().chain(&self.named).copied().collect();
        while let Some(id) = open.pop() {
            let key = &self.scope.signals[id].key;
            if let Some(formula) = self.description.formula(key, "").cloned()
                && !formulas.contains_key(&id)
            {
                let text = self.formula(&formula)?;
                formulas.insert(id, text);
                open.extend(&self.named);
            }
        }
        let all: BTreeSet<SignalId> = self.printer.constants.keys().chain(&self.named).copied().collect();
        let constants = all.into_iter().filter_map(|id| {
            let Role::Constant(digits) = &self.scope.signals[id].role else { return None };
            let formula = formulas.remove(&id);
            let value = self.constant(id, digits, formula.is_some());
            let (name, of_type, comment) = (self.constant_name(id), value.of_type.clone(), self.said(id));
            Some((Constant { name, of_type, comment, formula }, value))
        });
        Ok(constants.unzip())
    }

    /// The value of a constant, and the type that it is declared with.
    fn constant(&self, id: SignalId, digits: &str, is_derived: bool) -> Value {
        let signal = &self.scope.signals[id];
        let Some(of) = self.printer.constants.get(&id).copied() else { return Value::whole(digits) };
        let field = signal.key.split('$').next().unwrap_or_default();
        let signed = signal.ty.signed || self.description.signed.contains(&field);
        let declared = if is_derived { derived_type(signal.ty) } else { signal.ty };
        let text = pattern(Type { signed, ..signal.ty }, digits, of);
        Value { of_type: of_type(declared), text }
    }

    /// The name of a constant, without the bits of it that are read.
    fn constant_name(&self, id: SignalId) -> String {
        self.signal_name(id).split('[').next().unwrap_or_default().into()
    }

    /// A formula with the names that its constants have in the text, which therefore has them.
    fn formula(&mut self, formula: &Formula) -> Result<String, EmitError> {
        let mut text = formula.text.to_string();
        for key in formula.names {
            let is = |signal: &Signal| signal.key == *key && matches!(signal.role, Role::Constant(_));
            let id = self.scope.signals.iter().position(is);
            let id =
                id.ok_or_else(|| EmitError::field(&self.scope.path, key, Fault::Unknown((*key).into())))?;
            text = text.replace(&format!("{{{key}}}"), &self.constant_name(id));
            self.named.insert(id);
        }
        Ok(text)
    }

    /// Whether Verilog computes a formula in fewer bits than those of a whole number, where nothing else has as many.
    fn is_narrow(&self, formula: &Formula) -> bool {
        let has_number =
            (formula.plain().split(' ')).any(|word| word.trim_matches(['(', ')']).parse::<u64>().is_ok());
        let is_narrow = |key: &&str| {
            let id = self.scope.signals.iter().position(|signal| signal.key == **key);
            let is_read = id.is_some_and(|id| self.printer.constants.contains_key(&id));
            is_read && self.description.formula(key, "").is_none()
        };
        formula.names.len() > 1 && !has_number && formula.names.iter().all(is_narrow)
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

/// The type of a constant that follows from others: a whole number, of which as many bits are read as the constant has, or a bit.
fn derived_type(ty: Type) -> Type {
    if ty == Type::BIT { ty } else { Type::bits(INTEGER) }
}
