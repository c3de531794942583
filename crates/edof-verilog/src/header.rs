//! The comment above a module.

use std::collections::BTreeSet;

use crate::names::snake_case;
use crate::scope::{Role, SignalId};
use crate::write::Writer;

impl Writer<'_> {
    /// The block's documentation, which outputs follow which inputs, and the Rust file.
    pub fn header(&self) -> String {
        let line = |line: &str| format!("// {line}").trim_end().to_string() + "\n";
        let text = reflowed(&without_links(self.description.header));
        let text: String = text.iter().map(|text| line(text)).collect();
        let follows: String = self.follows().iter().map(|text| line(text)).collect();
        let source = format!("// From {} ({}).\n", self.source, self.description.name);
        let space = if follows.is_empty() { "" } else { "//\n" };
        format!("{text}{space}{follows}{source}")
    }

    /// Which outputs follow which inputs within the cycle; nothing where none does.
    fn follows(&self) -> Vec<String> {
        let name = |id: &SignalId| self.signal_name(*id).to_string();
        let mut groups: Vec<(BTreeSet<SignalId>, Vec<String>)> = vec![];
        for output in self.ports.iter().filter(|id| self.scope.signals[**id].role == Role::Output) {
            let from = self.paths.iter().filter(|(_, to)| to == output).map(|(from, _)| *from);
            let from: BTreeSet<SignalId> = from.filter(|id| self.ports.contains(id)).collect();
            match groups.iter_mut().find(|(inputs, _)| *inputs == from) {
                Some((_, outputs)) => outputs.push(name(output)),
                None => groups.push((from, vec![name(output)])),
            }
        }
        let line = |(from, outputs): &(BTreeSet<SignalId>, Vec<String>)| {
            let from: Vec<String> = from.iter().map(name).collect();
            format!("Within the cycle: {} -> {}", from.join(", "), outputs.join(", "))
        };
        groups.iter().filter(|(from, _)| !from.is_empty()).map(line).collect()
    }
}

/// A header whose links to other blocks (`` [`AxiGuard`] ``) are the names of their modules (`axi_guard`).
fn without_links(header: &str) -> String {
    let mut parts = header.split("[`");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| match part.split_once("`]") {
        Some((name, rest)) => text + &snake_case(name) + rest,
        None => text + "[`" + part,
    })
}

/// A header's paragraphs, a line each, with an empty line between them. Items of lists keep their lines.
fn reflowed(header: &str) -> Vec<String> {
    let mut lines: Vec<String> = vec![];
    for line in header.trim().lines().map(str::trim) {
        let is_own = line.is_empty() || line.starts_with(['-', '*', '|']);
        match lines.last_mut().filter(|last| !is_own && !last.is_empty()) {
            Some(last) => *last += &format!(" {line}"),
            None => lines.push(line.into()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_to_blocks_become_names_of_modules() {
        assert_eq!(
            without_links("At its port: an [`AxiGuard`], a [`Ram`]."),
            "At its port: an axi_guard, a ram."
        );
        assert_eq!(without_links("`x`, [`cut and [0]"), "`x`, [`cut and [0]");
    }
}
