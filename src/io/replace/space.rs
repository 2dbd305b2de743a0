//! Whether there is room for a file, where the system tells.

use super::super::budget::Size;
use super::super::error::{FileError, Problem};
use super::super::identity::folder_of;
use std::path::Path;

/// Refuses to write so many bytes where the disk has fewer left. The file that may stand there stays until the new one
/// is complete, so its bytes are not free.
pub(crate) fn check_space(path: &Path, bytes: u64) -> Result<(), FileError> {
    match free_bytes(path) {
        Some(free) if free < bytes => Err(FileError::new(
            path,
            Problem::NoSpace {
                needs: Size(bytes),
                free: Size(free),
            },
        )),
        _ => Ok(()),
    }
}

/// What this user may still write where a file is to be; `None` where the system does not tell, or for a device.
#[cfg(unix)]
pub(crate) fn free_bytes(path: &Path) -> Option<u64> {
    use std::os::unix::fs::FileTypeExt;
    let kind = std::fs::metadata(path).map(|metadata| metadata.file_type());
    if kind.is_ok_and(|kind| kind.is_char_device() || kind.is_block_device() || kind.is_fifo()) {
        return None;
    }
    let place = path.canonicalize();
    let place = place.as_deref().unwrap_or(path);
    let disk = rustix::fs::statvfs(folder_of(place)).ok()?;
    // Some disks over a network count nothing.
    (disk.f_blocks > 0).then(|| disk.f_bavail.saturating_mul(disk.f_frsize))
}

#[cfg(not(unix))]
pub(crate) fn free_bytes(_: &Path) -> Option<u64> {
    None
}
