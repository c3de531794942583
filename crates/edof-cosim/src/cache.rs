//! Products that take seconds to make, kept under a name that changes with everything that went into them.

use crate::error::{Error, at};
use crate::work;
use edof_core::storage::atomic::WorkFolder;
use sha2::{Digest, Sha256};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// SHA-256 of the parts, in hexadecimal. Lengths go in too, so that no two lists of parts are taken for one another.
pub fn key<'a>(parts: impl IntoIterator<Item = &'a str>) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// `edof/KIND` in `$XDG_CACHE_HOME`, or else in `~/.cache`; none where the system says neither.
#[must_use]
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
    _work: Option<WorkFolder>,
}

/// The product of that name: from the cache, or made in a fresh directory, where `make` leaves it under the same name. A cache that
/// cannot be written is none.
///
/// Of several threads or processes that want the same thing, one makes it and the others wait.
pub fn obtain(
    cache: Option<&Path>,
    name: &str,
    make: impl FnOnce(&Path) -> Result<(), Error>,
) -> Result<Product, Error> {
    let kept = cache.map(|cache| cache.join(name));
    if let Some(path) = kept.as_ref().filter(|path| path.is_file()) {
        return Ok(Product { path: path.clone(), _work: None });
    }
    let Some((path, _lock)) = kept.and_then(|path| lock(&path).map(|lock| (path, lock))) else {
        let folder = work::folder()?;
        make(folder.path())?;
        return Ok(Product { path: folder.path().join(name), _work: Some(folder) });
    };
    if !path.is_file() {
        let folder = work::folder()?;
        make(folder.path())?;
        let own = folder.path().join(name);
        if install(&own, &path).is_err() {
            return Ok(Product { path: own, _work: Some(folder) });
        }
    }
    Ok(Product { path, _work: None })
}

/// Waits until nobody else makes this product. None where nothing can be kept, as in a home that cannot be written.
fn lock(path: &Path) -> Option<File> {
    fs::create_dir_all(path.parent()?).ok()?;
    let lock = File::create(path.with_added_extension("lock")).ok()?;
    lock.lock().ok()?;
    Some(lock)
}

/// Copies, then renames, so that nobody ever sees half a file.
fn install(from: &Path, to: &Path) -> Result<(), Error> {
    let half = to.with_extension("half");
    fs::copy(from, &half).and_then(|_| fs::rename(&half, to)).map_err(|e| {
        let _ = fs::remove_file(&half);
        at(to)(e)
    })
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
    fn a_cache_that_cannot_be_written_is_done_without() {
        let make = |work: &Path| fs::write(work.join("x"), "product").map_err(at(work));
        let product = obtain(Some(Path::new("/proc/no/such/place")), "x", make).unwrap();
        assert_eq!(fs::read_to_string(&product.path).unwrap(), "product");
    }

    #[test]
    fn a_cache_without_room_for_the_product_is_done_without() {
        let cache = tempfile::tempdir().unwrap();
        // Nothing can be copied there, as on a disk that is full.
        fs::create_dir(cache.path().join("x.half")).unwrap();
        let make = |work: &Path| fs::write(work.join("x"), "product").map_err(at(work));
        let product = obtain(Some(cache.path()), "x", make).unwrap();
        assert_eq!(fs::read_to_string(&product.path).unwrap(), "product");
        assert!(!cache.path().join("x").exists());
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
