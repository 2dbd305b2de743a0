//! Writing a file so that the old one stays until the new one is complete.

use super::error::{FileError, Problem};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes a file through `write` under another name in the same folder, and then renames it.
/// Where anything fails nothing is left behind, and a file that was there stays as it was.
pub(crate) fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let temporary = temporary_beside(path)?;
    let result = (|| {
        let mut writer = BufWriter::new(File::create_new(&temporary)?);
        write(&mut writer)?;
        writer.flush()?;
        writer.get_ref().sync_all()?;
        drop(writer);
        fs::rename(&temporary, path)
    })();
    result.map_err(|error| {
        // The first error is the one to report; that the rest could not be tidied up adds nothing.
        let _ = fs::remove_file(&temporary);
        FileError::writing(path, &error)
    })
}

/// Checks that a file can be written, before the work whose result it shall hold is done.
pub fn check_writable(path: &Path) -> Result<(), FileError> {
    let temporary = temporary_beside(path)?;
    File::create_new(&temporary)
        .and_then(|_| fs::remove_file(&temporary))
        .map_err(|error| FileError::writing(path, &error))
}

fn temporary_beside(path: &Path) -> Result<PathBuf, FileError> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let Some(name) = path.file_name() else {
        return Err(FileError::new(path, Problem::IsAFolder));
    };
    if path.is_dir() {
        return Err(FileError::new(path, Problem::IsAFolder));
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(FileError::new(path, Problem::NoFolder));
    }
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(format!(
        ".{}-{}.part",
        std::process::id(),
        COUNTER.fetch_add(1, Ordering::Relaxed)
    ));
    Ok(folder.join(temporary))
}
