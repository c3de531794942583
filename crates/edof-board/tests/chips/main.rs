//! The chips as their makers describe them. Set-ups here are the fact sheets' own, step by step.

mod bus;
mod first_light;
mod first_tables;
mod receiver;
mod setup;
mod transmitter;

/// Models judge set-ups, so they must not be able to copy a mistake from one.
#[test]
fn models_name_nothing_outside_of_themselves() {
    let mut folders = vec![std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/chip_models")];
    let mut files = 0;
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            files += 1;
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            for line in code {
                let others = line.replace("crate::chip_models::", "");
                let is_own = !others.contains("crate::") && !others.contains("edof_");
                assert!(is_own, "{}: {line}", path.display());
            }
        }
    }
    assert!(files > 10, "{files}");
}
