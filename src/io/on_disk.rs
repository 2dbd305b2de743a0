//! Whether another program has changed the open scene's file.

use serde::{Deserialize, Serialize};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// What a scene file said when it was read or written here last.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct OnDisk {
    file: PathBuf,
    /// Of its bytes: time stamps are the same where two writes are close, and differ where nothing was changed.
    digest: u64,
}

impl OnDisk {
    pub fn new(file: &Path, bytes: &[u8]) -> Self {
        Self {
            // The working folder is another one in the editor that recovers it.
            file: std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf()),
            digest: digest(bytes),
        }
    }

    pub fn file(&self) -> &Path {
        &self.file
    }
}

fn digest(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    hasher.finish()
}

/// Whether this file, which the open scene was read from or written to last, says something else by now. One that is
/// gone, or cannot be read, holds nothing that could be lost.
#[cfg(feature = "editor")]
pub(crate) fn has_changed(world: &bevy::prelude::World, file: &Path) -> bool {
    use super::identity::same_file;
    use super::sources::SceneFiles;
    let known = world.get_resource::<SceneFiles>();
    let Some(known) = known.and_then(|files| files.on_disk.as_ref()) else {
        return false;
    };
    if !file.is_file() || !same_file(&known.file, file) {
        return false;
    }
    let limits = super::Limits::default();
    match super::read_bytes(file, limits.file_bytes, &limits.memory) {
        Ok(bytes) => digest(&bytes) != known.digest,
        // Emptied, or longer than any scene.
        Err(_) => true,
    }
}
