//! Arrays of one element: its number says nothing, so names do without it.

use crate::collect::Tree;
use crate::scope::Scope;

/// The arrays of a block that have one element.
pub(crate) fn single_elements(tree: &Tree, scope: &Scope) -> Vec<String> {
    let keys = tree.parts.iter().map(|part| part.key.as_str());
    let keys: Vec<&str> = keys.chain(scope.signals.iter().map(|signal| signal.key.as_str())).collect();
    let first = keys.iter().filter_map(|key| key.strip_suffix("$0"));
    first.filter(|base| !keys.contains(&format!("{base}$1").as_str())).map(String::from).collect()
}

/// The key without the number of an array's only element.
pub(crate) fn plain<'k>(key: &'k str, single: &[String]) -> std::borrow::Cow<'k, str> {
    for base in single {
        if let Some(rest) = key.strip_prefix(base.as_str()).and_then(|rest| rest.strip_prefix("$0"))
            && (rest.is_empty() || rest.starts_with('$'))
        {
            return format!("{base}{rest}").into();
        }
    }
    key.into()
}
