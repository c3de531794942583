//! States the git revision and the compiler that the program is built from.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the program is made of: where any of these differs from the last commit, its revision is that commit's, `-dirty` and a hash of
/// the difference, so that two programs of different sources never have the same.
const SOURCES: [&str; 8] =
    ["Cargo.toml", "Cargo.lock", "crates", "cameras", "designs", "rtl", "sim", "constraints"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?).join("../..").canonicalize()?;
    if let Some(revision) = revision(&root) {
        println!("cargo::rustc-env=EDOF_REVISION={revision}");
    }
    println!("cargo::rustc-env=EDOF_COMPILER={}", compiler()?);
    Ok(())
}

/// Version of the compiler, as it states it itself.
fn compiler() -> Result<String, Box<dyn std::error::Error>> {
    let output = Command::new(std::env::var("RUSTC")?).arg("--version").output()?;
    Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// The revision, where the sources lie in a git checkout of their own; none from a tarball or without git.
fn revision(root: &Path) -> Option<String> {
    if git(root, &["rev-parse", "--show-prefix"])?.is_empty() {
        // The reflog grows with every commit and checkout; sources that change make the program anew anyway.
        let watched =
            ["HEAD", "logs/HEAD"].iter().filter_map(|name| git(root, &["rev-parse", "--git-path", name]));
        for path in
            watched.map(|path| root.join(path)).chain(SOURCES.map(|s| root.join(s))).filter(|p| p.exists())
        {
            println!("cargo::rerun-if-changed={}", path.display());
        }
        let commit = git(root, &["rev-parse", "HEAD"])?;
        let present: Vec<&str> = SOURCES.into_iter().filter(|s| root.join(s).exists()).collect();
        let changes = git(root, &[&["status", "--porcelain", "--"], &present[..]].concat())?;
        if changes.is_empty() {
            return Some(commit);
        }
        return Some(format!("{commit}-dirty-{:016x}", difference(root, &present)?));
    }
    None
}

/// A hash of how the sources differ from the last commit: of what git states of its own files, and of the others' names and contents.
fn difference(root: &Path, sources: &[&str]) -> Option<u64> {
    let mut hash = DefaultHasher::new();
    git(root, &[&["diff", "HEAD", "--binary", "--"], sources].concat())?.hash(&mut hash);
    let others = git(root, &[&["ls-files", "--others", "--exclude-standard", "--"], sources].concat())?;
    for name in others.lines() {
        (name, std::fs::read(root.join(name)).ok()?).hash(&mut hash);
    }
    Some(hash.finish())
}

fn git(root: &Path, words: &[&str]) -> Option<String> {
    let output = Command::new("git").arg("-C").arg(root).args(words).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
