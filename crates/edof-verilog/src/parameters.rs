//! Which values of a module are the same wherever it stands, and which are its parameters.
//!
//! A slot that has one value in the whole circuit is printed where it stands. One that differs is a parameter, and a parameter of what
//! instantiates the module too if it differs from one of those to the next. Parameters of one name that always agree are one. What follows from
//! others is never a parameter.

use crate::interface::{Interface, Origin, Parameter, Slot};
use crate::kind::Occurrence;
use crate::names::Names;
use crate::sheet::{Of, Sheet};
use crate::value::Value;

/// The interface of each module; `sheets` in the order in which modules are made of each other, `top` the whole circuit.
pub(crate) fn settle(sheets: &[Sheet], names: &mut [Names], top: &Occurrence) -> Vec<Interface> {
    let mut places: Vec<Vec<&Occurrence>> = vec![vec![]; sheets.len()];
    collect(top, &mut places);
    let mut interfaces = vec![];
    for (class, sheet) in sheets.iter().enumerate() {
        let settled =
            Settling { sheet, places: &places[class], known: &interfaces }.interface(&mut names[class]);
        interfaces.push(settled);
    }
    interfaces
}

fn collect<'o>(occurrence: &'o Occurrence, places: &mut [Vec<&'o Occurrence>]) {
    places[occurrence.class].push(occurrence);
    occurrence.parts.iter().flatten().for_each(|part| collect(part, places));
}

struct Settling<'a> {
    sheet: &'a Sheet,
    places: &'a [&'a Occurrence],
    known: &'a [Interface],
}

/// Values that always agree, and every use of them.
struct Group<'a> {
    base: &'a str,
    comment: &'a str,
    column: Vec<&'a Value>,
    uses: Vec<Origin>,
}

impl<'a> Settling<'a> {
    fn interface(&self, names: &mut Names) -> Interface {
        let groups = self.groups();
        let mut interface =
            Interface { passed: vec![vec![]; self.sheet.instances.len()], ..Interface::default() };
        let fixed = |value: &Value| Slot { text: value.text.clone(), is_parameter: false };
        let derived = |formula: &str| Slot { text: formula.into(), is_parameter: false };
        let slots = self.sheet.formulas().enumerate();
        interface.slots = slots
            .map(|(slot, formula)| formula.map_or_else(|| fixed(self.value(0, Origin::Slot(slot))), derived))
            .collect();
        let mut given: Vec<(Origin, String)> = vec![];
        for group in groups.iter().filter(|group| group.column.iter().any(|value| *value != group.column[0]))
        {
            let name = self.name(group, &groups, names);
            given.extend(group.uses.iter().map(|origin| (*origin, name.clone())));
            interface.parameters.push(Parameter {
                name,
                comment: group.comment.into(),
                start: group.column[0].clone(),
                origin: group.uses[0],
            });
        }
        let of = |origin: Origin| given.iter().find(|(of, _)| *of == origin).map(|(_, name)| name.clone());
        for (slot, stands) in interface.slots.iter_mut().enumerate() {
            if let Some(text) = of(Origin::Slot(slot)) {
                *stands = Slot { text, is_parameter: true };
            }
        }
        for (number, passed) in interface.passed.iter_mut().enumerate() {
            for (n, parameter) in self.parameters(number).iter().enumerate() {
                let origin = Origin::Instance(number, n);
                let text = of(origin).unwrap_or_else(|| self.value(0, origin).text.clone());
                passed.push((parameter.name.clone(), text));
            }
        }
        interface
    }

    /// Parameters of an instance of ours.
    fn parameters(&self, instance: usize) -> &'a [Parameter] {
        match self.sheet.instances[instance].of {
            Of::Module(class) => &self.known[class].parameters,
            Of::Leaf(_) => &[],
        }
    }

    /// All uses of values: those of one name that agree in every place are one group. A constant of the module is its own.
    fn groups(&self) -> Vec<Group<'a>> {
        let constants =
            self.sheet.constants.iter().map(|constant| (constant.name.as_str(), constant.comment.as_str()));
        let leaves = self.sheet.instances.iter().flat_map(|instance| &instance.parameters);
        let slots = constants.chain(leaves.map(|parameter| (parameter.name.as_str(), "")));
        let slots = slots.enumerate().zip(self.sheet.formulas()).filter(|(_, formula)| formula.is_none());
        let slots = slots.map(|((slot, said), _)| (Origin::Slot(slot), said));
        let instances = (0..self.sheet.instances.len()).flat_map(|number| {
            let parameters = self.parameters(number).iter().enumerate();
            parameters.map(move |(n, p)| (Origin::Instance(number, n), (p.name.as_str(), p.comment.as_str())))
        });
        let mut groups: Vec<Group> = vec![];
        for (origin, (base, comment)) in slots.chain(instances) {
            let column: Vec<&Value> = (0..self.places.len()).map(|place| self.value(place, origin)).collect();
            match groups.iter_mut().find(|group| group.base == base && group.column == column) {
                Some(group) => group.uses.push(origin),
                None => groups.push(Group { base, comment, column, uses: vec![origin] }),
            }
        }
        groups
    }

    fn value(&self, place: usize, origin: Origin) -> &'a Value {
        value(self.known, self.places[place], origin)
    }

    /// The name of a parameter: as below, with the instance's before it where several differ.
    fn name(&self, group: &Group, groups: &[Group], names: &mut Names) -> String {
        if matches!(group.uses[0], Origin::Slot(slot) if slot < self.sheet.constants.len()) {
            return group.base.into();
        }
        let is_only = groups.iter().filter(|other| other.base == group.base).count() == 1;
        let instance = &self.sheet.instances[self.instance(group.uses[0])].name.to_uppercase();
        names.take(&if is_only { group.base.into() } else { format!("{instance}_{}", group.base) })
    }

    /// The instance that a use belongs to.
    fn instance(&self, origin: Origin) -> usize {
        match origin {
            Origin::Instance(number, _) => number,
            Origin::Slot(slot) => {
                let mut left = slot.saturating_sub(self.sheet.constants.len());
                let owns = |instance: &&crate::sheet::Instance| {
                    let here = instance.parameters.len();
                    let found = left < here;
                    left = left.saturating_sub(here);
                    found
                };
                let instances = &self.sheet.instances;
                instances
                    .iter()
                    .find(owns)
                    .and_then(|one| instances.iter().position(|i| std::ptr::eq(i, one)))
                    .unwrap_or(0)
            }
        }
    }
}

/// The value that a module's use has in one place.
fn value<'a>(known: &'a [Interface], place: &'a Occurrence, origin: Origin) -> &'a Value {
    match origin {
        Origin::Slot(slot) => &place.values[slot],
        Origin::Instance(number, parameter) => {
            let part = place.parts[number].as_ref().expect("only modules of ours have parameters");
            value(known, part, known[part.class].parameters[parameter].origin)
        }
    }
}
