//! Products that take seconds to make, kept under a name that changes with everything that went into them.

use crate::error::{Error, at};
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// SHA-256 of the parts, in hexadecimal. Lengths go in too, so that no two lists of parts are taken for one another.
pub fn key<'a>(parts: impl IntoIterator<Item = &'a str>) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// `edof/KIND` in `$XDG_CACHE_HOME`, or else in `~/.cache`.
pub fn of_user(kind: &str) -> Option<PathBuf> {
    let set = |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let base = set("XDG_CACHE_HOME").or_else(|| Some(set("HOME")?.join(".cache")));
    base.map(|base| base.join("edof").join(kind))
}

/// A product and, where nothing is kept, the directory that goes away with it.
#[derive(Debug)]
pub struct Product {
    /// The file.
    pub path: PathBuf,
    _work: Option<TempDir>,
}

/// The product of that name: from the cache, or made in a fresh directory, where `make` leaves it under the same name.
///
/// Of several threads or processes that want the same thing, one makes it and the others wait.
pub fn obtain(
    cache: Option<&Path>,
    name: &str,
    make: impl FnOnce(&Path) -> Result<(), Error>,
) -> Result<Product, Error> {
    let Some(cache) = cache else {
        let work = work_dir()?;
        make(work.path())?;
        return Ok(Product { path: work.path().join(name), _work: Some(work) });
    };
    fs::create_dir_all(cache).map_err(at(cache))?;
    let path = cache.join(name);
    if !path.is_file() {
        let lock = cache.join(format!("{name}.lock"));
        let lock_file = File::create(&lock).map_err(at(&lock))?;
        lock_file.lock().map_err(at(&lock))?;
        if !path.is_file() {
            let work = work_dir()?;
            make(work.path())?;
            install(&work.path().join(name), &path)?;
        }
    }
    Ok(Product { path, _work: None })
}

/// Not in the cache itself: make refuses paths with spaces.
fn work_dir() -> Result<TempDir, Error> {
    tempfile::Builder::new().prefix("edof-cosim-").tempdir().map_err(at(&std::env::temp_dir()))
}

/// Copies, then renames, so that nobody ever sees half a file.
fn install(from: &Path, to: &Path) -> Result<(), Error> {
    let half = to.with_extension("half");
    fs::copy(from, &half).map_err(at(from))?;
    fs::rename(&half, to).map_err(at(to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn the_key_tells_lists_of_parts_apart() {
        assert_eq!(key(["ab", "c"]), key(["ab", "c"]));
        assert_ne!(key(["ab", "c"]), key(["a", "bc"]));
        assert_eq!(key([]).len(), 64);
    }

    #[test]
    fn threads_that_want_the_same_make_it_once() {
        let cache = tempfile::tempdir().unwrap();
        let made = AtomicUsize::new(0);
        let make = |work: &Path| {
            made.fetch_add(1, Ordering::Relaxed);
            fs::write(work.join("x"), "product").map_err(at(work))
        };
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| obtain(Some(cache.path()), "x", make).unwrap());
            }
        });
        assert_eq!(made.into_inner(), 1);
        assert_eq!(fs::read_to_string(cache.path().join("x")).unwrap(), "product");
    }

    #[test]
    fn without_a_cache_the_product_goes_with_its_owner() {
        let product = obtain(None, "x", |work| fs::write(work.join("x"), "").map_err(at(work))).unwrap();
        let path = product.path.clone();
        assert!(path.is_file());
        drop(product);
        assert!(!path.exists());
    }
}
