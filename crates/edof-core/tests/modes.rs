//! Modes, owners and links of result files. A umask belongs to the process, so each one is tried in a shell's child.

#![cfg(unix)]

use edof_core::storage::atomic;
use edof_core::storage::folder;
use std::fs::{self, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt, chown, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

const UMASKS: [u32; 4] = [0o022, 0o077, 0o000, 0o027];
const MODES: [u32; 6] = [0o600, 0o640, 0o644, 0o755, 0o400, 0o666];

fn mode(path: &Path) -> u32 {
    fs::symlink_metadata(path).unwrap().permissions().mode() & 0o7777
}

/// Runs one test of this program again, with a umask and a folder of its own.
fn under(umask: u32, test: &str) {
    let place = tempfile::tempdir().unwrap();
    let program = std::env::current_exe().unwrap();
    let run = Command::new("sh")
        .args(["-c", &format!("umask {umask:03o}; exec \"$0\" --ignored --exact {test}")])
        .arg(program)
        .env("EDOF_TEST_PLACE", place.path())
        .env("EDOF_TEST_UMASK", umask.to_string())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success() && text.contains("1 passed"), "umask {umask:03o}: {text}");
}

fn place() -> (PathBuf, u32) {
    let of = |name: &str| std::env::var(name).expect("run by a test of a umask");
    (of("EDOF_TEST_PLACE").into(), of("EDOF_TEST_UMASK").parse().unwrap())
}

#[test]
fn new_files_obey_the_umask_and_replaced_ones_keep_their_mode() {
    UMASKS.iter().for_each(|&umask| under(umask, "modes_under_one_umask"));
}

#[test]
#[ignore = "run by another test, once for each umask"]
fn modes_under_one_umask() {
    let (place, umask) = place();
    let at = |name: &str| place.join(name);
    atomic::write(&at("new"), b"new").unwrap();
    assert_eq!(mode(&at("new")), 0o666 & !umask);
    atomic::write(&at("folder/below/new"), b"new").unwrap();
    assert_eq!(mode(&at("folder/below")), 0o777 & !umask);
    for old in MODES {
        let file = at(&format!("{old:o}"));
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, Permissions::from_mode(old)).unwrap();
        atomic::write_with(&file, |file| {
            // While it is written, nobody else may read more of it than of the replaced file.
            let half = fs::read_dir(&place).unwrap().map(|entry| entry.unwrap().path());
            let half: Vec<PathBuf> =
                half.filter(|path| path.extension().is_some_and(|end| end == "partial")).collect();
            assert_eq!(half.len(), 1);
            assert_eq!(mode(&half[0]) & 0o077 & !old, 0, "{:o} while {old:o} is replaced", mode(&half[0]));
            file.write_all(b"new")
        })
        .unwrap();
        assert_eq!((mode(&file), fs::metadata(&file).unwrap().len()), (old, 3), "{old:o}");
    }
    // A folder of results: new files as any other, replaced ones as they were.
    let write = |text: &str| {
        let files = folder::Contents::from([("a".into(), text.to_owned()), ("in/b".into(), "b".to_owned())]);
        let manifest = folder::manifest(serde_json::json!({}), &files);
        folder::write(&at("out"), files, &manifest, false).unwrap();
    };
    write("first");
    for file in ["out/a", "out/in/b", "out/manifest.json"] {
        assert_eq!(mode(&at(file)), 0o666 & !umask, "{file}");
    }
    fs::set_permissions(at("out/a"), Permissions::from_mode(0o600)).unwrap();
    write("second");
    assert_eq!((mode(&at("out/a")), fs::read_to_string(at("out/a")).unwrap()), (0o600, "second".to_owned()));
}

#[test]
fn a_link_stays_and_the_file_that_it_leads_to_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::create_dir(at("elsewhere")).unwrap();
    fs::write(at("elsewhere/file"), "old").unwrap();
    fs::set_permissions(at("elsewhere/file"), Permissions::from_mode(0o600)).unwrap();
    // Relative links are seen from their own folder, wherever the program runs.
    symlink("file", at("elsewhere/second")).unwrap();
    symlink("elsewhere/second", at("link")).unwrap();
    atomic::check(&at("link")).unwrap();
    atomic::write(&at("link"), b"new").unwrap();
    assert_eq!(fs::read_to_string(at("elsewhere/file")).unwrap(), "new");
    assert_eq!(mode(&at("elsewhere/file")), 0o600);
    for link in ["link", "elsewhere/second"] {
        assert!(at(link).is_symlink(), "{link}");
    }
    // One that leads nowhere yet makes the file.
    symlink("not/yet", at("dangling")).unwrap();
    atomic::check(&at("dangling")).unwrap();
    atomic::write(&at("dangling"), b"made").unwrap();
    assert!(at("dangling").is_symlink());
    assert_eq!(fs::read_to_string(at("not/yet")).unwrap(), "made");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 4);
}

#[test]
fn links_in_a_circle_and_to_folders_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    symlink("b", at("a")).unwrap();
    symlink("a", at("b")).unwrap();
    let said = format!(
        "{}: cannot write: a symbolic link that leads in a circle; delete it, or name another file",
        at("a").display()
    );
    assert_eq!(atomic::check(&at("a")).unwrap_err().to_string(), said);
    assert_eq!(atomic::write(&at("a"), b"").unwrap_err().to_string(), said);
    fs::create_dir(at("folder")).unwrap();
    symlink("folder", at("to")).unwrap();
    assert!(atomic::check(&at("to")).is_err() && atomic::write(&at("to"), b"").is_err());
    assert!(at("to").is_symlink() && fs::read_dir(at("folder")).unwrap().next().is_none());
}

#[test]
#[ignore = "needs root: scripts/test.sh, where root runs it"]
fn owner_and_group_of_a_replaced_file_stay() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("file");
    fs::write(&file, "old").unwrap();
    chown(&file, Some(65_534), Some(12_345)).expect("only root gives files away");
    fs::set_permissions(&file, Permissions::from_mode(0o640)).unwrap();
    atomic::write(&file, b"new").unwrap();
    let now = fs::metadata(&file).unwrap();
    assert_eq!((now.uid(), now.gid(), mode(&file)), (65_534, 12_345, 0o640));
}
