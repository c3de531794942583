//! Folders for what tools read and write.

use crate::error::{Error, at};
use edof_core::storage::atomic::{self, WorkFolder};

/// A fresh folder among the system's temporary ones. (Not in a user's own: make rejects paths with spaces.)
pub fn folder() -> Result<WorkFolder, Error> {
    let temporary = std::env::temp_dir();
    atomic::work_folder(&temporary).map_err(at(&temporary))
}
