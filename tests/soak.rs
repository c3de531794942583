//! `scripts/soak.sh`: its table of results.

use crate::workspace::root;
use std::fs;
use std::process::Command;

#[test]
fn the_log_adds_up_the_words_of_a_revision() {
    let target = tempfile::tempdir().unwrap();
    let write = |revision: &str, part: &str, result: &str, words: &str| {
        let folder = target.path().join("soak").join(revision);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join(format!("{part}.result")), format!("{revision} 60 {result}\n")).unwrap();
        let log = format!("kc705: 2 patches\n{words} words compared in 59 s, none different\n");
        fs::write(folder.join(format!("{part}.log")), log).unwrap();
    };
    write("aaa", "words-1", "passed 10", "999");
    write("bbb", "words-1", "passed 20", "203520000");
    write("bbb", "words-2", "passed 30", "1000");
    write("bbb", "words-3", "FAILED 40", "5");
    let log = Command::new(root().join("scripts/soak.sh"))
        .arg("--log")
        .env("CARGO_TARGET_DIR", target.path())
        .output()
        .unwrap();
    let table = String::from_utf8(log.stdout).unwrap();
    for line in [
        "| `words-1` | bbb | 60 | passed, 203,520,000 words |",
        "| `words-2` | bbb | 60 | passed, 1,000 words |",
        "| `words-4` | – | – | not run |",
        "Words compared between circuit and model on bbb: 203,521,000.",
    ] {
        assert!(table.lines().any(|found| found == line), "{line}\n{table}");
    }
    assert!(!table.contains("on aaa"), "{table}");
}
