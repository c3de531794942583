//! The README says of every fault what to do instead.

#[test]
fn every_fault_has_its_line_in_the_readme() {
    let [source, page] = [include_str!("../src/error.rs"), include_str!("../README.md")];
    let faults = source.split("pub enum Fault {").nth(1).unwrap().split("\n}").next().unwrap();
    let names: Vec<&str> = (faults.lines())
        .filter_map(|line| line.strip_prefix("    "))
        .filter(|line| line.starts_with(|c: char| c.is_ascii_uppercase()))
        .map(|line| line.split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap())
        .collect();
    assert!(names.len() > 20, "{names:?}");
    for name in names {
        assert!(page.contains(&format!("| `{name}` |")), "README.md has no line for {name}");
    }
}
