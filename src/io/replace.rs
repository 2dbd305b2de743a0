//! Writing a file so that the old one stays until the new one is complete.

use super::error::{FileError, Problem};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// How old what a killed process left must be before it is removed: a file that is younger may be one
/// whose writer is just about to lock it.
const LEFT_FOR: Duration = Duration::from_secs(10);

/// Writes a file through `write` under another name in the same folder, and then renames it.
/// Where anything fails nothing is left behind, and a file that was there stays as it was.
///
/// A process that is killed leaves what it had written so far; the next one that writes the same file
/// removes that. It knows by a lock that the system takes away from who is gone.
pub(crate) fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let temporary = temporary_beside(path)?;
    remove_leftovers(path);
    let result = (|| {
        let file = File::create_new(&temporary)?;
        // Where files cannot be locked they are written all the same; leftovers stay there.
        let _ = file.try_lock();
        let mut writer = BufWriter::new(file);
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
    let folder = folder_of(path);
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

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Removes what others have left that were killed while they wrote this file. What cannot be looked
/// at or removed stays: that is no reason not to write.
fn remove_leftovers(path: &Path) {
    let (Some(name), Ok(entries)) = (path.file_name(), fs::read_dir(folder_of(path))) else {
        return;
    };
    for entry in entries.flatten() {
        // Not what a link points to, and no pipe that would wait for someone to write.
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && is_temporary_of(name, &entry.file_name()) && is_abandoned(&entry.path()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether `name` is one that [`temporary_beside`] gives to `of`.
fn is_temporary_of(of: &OsStr, name: &OsStr) -> bool {
    let middle = (|| {
        let name = name.as_encoded_bytes().strip_prefix(b".")?;
        let name = name.strip_prefix(of.as_encoded_bytes())?;
        name.strip_prefix(b".")?.strip_suffix(b".part")
    })();
    let is_number = |part: &[u8]| !part.is_empty() && part.iter().all(u8::is_ascii_digit);
    middle.is_some_and(|middle| {
        let mut parts = middle.splitn(2, |&byte| byte == b'-');
        parts.next().is_some_and(is_number) && parts.next().is_some_and(is_number)
    })
}

fn is_abandoned(path: &Path) -> bool {
    let Ok(file) = File::options().write(true).open(path) else {
        return false;
    };
    let age = (file.metadata()).and_then(|data| data.modified().map(|time| time.elapsed()));
    let is_old = matches!(age, Ok(Ok(age)) if age >= LEFT_FOR);
    is_old && file.try_lock().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    fn write(path: &Path, text: &str) {
        replace_file(path, |writer| writer.write_all(text.as_bytes())).unwrap();
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().flatten();
        let mut names: Vec<String> = entries
            .map(|entry| entry.file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// A file as someone has left it a minute ago.
    fn left(path: &Path) -> File {
        let file = File::create_new(path).unwrap();
        let minute_ago = SystemTime::now() - Duration::from_secs(60);
        file.set_modified(minute_ago).unwrap();
        file
    }

    #[test]
    fn what_a_killed_process_left_goes_with_the_next_write_of_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let path = folder.join("a.png");
        left(&folder.join(".a.png.4711-0.part"));
        left(&folder.join(".a.png.4712-13.part"));
        write(&path, "new");
        assert_eq!(names(folder), ["a.png"]);
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    fn what_is_being_written_or_belongs_to_another_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let writing = left(&folder.join(".a.png.4711-0.part"));
        writing.lock().unwrap();
        // Just begun, and not locked yet.
        File::create_new(folder.join(".a.png.4711-1.part")).unwrap();
        let others = [
            ".b.png.1-1.part",
            ".a.png.1.part",
            ".a.png.x-1.part",
            ".a.png.1-.part",
            "a.png.1-1.part",
            ".aapng.1-1.part",
            ".a.png.1-1.parts",
        ];
        for other in others {
            left(&folder.join(other));
        }
        let before = names(folder);
        write(&folder.join("a.png"), "new");
        let mut after = names(folder);
        after.retain(|name| name != "a.png");
        assert_eq!(after, before);
        drop(writing);
        write(&folder.join("a.png"), "newer");
        assert!(!names(folder).contains(&".a.png.4711-0.part".into()));
    }

    #[test]
    fn a_file_is_locked_while_it_is_written_so_that_no_other_process_removes_it() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        replace_file(&folder.join("a.png"), |writer| {
            writer.write_all(b"half")?;
            writer.flush()?;
            let part = folder.join(&names(folder)[0]);
            writer
                .get_ref()
                .set_modified(SystemTime::now() - Duration::from_secs(60))?;
            assert!(!is_abandoned(&part), "{} is free", part.display());
            Ok(())
        })
        .unwrap();
        assert_eq!(names(folder), ["a.png"]);
    }
}
