//! Files under temporary names: what they are called, and which of them nobody is writing any more.

use super::super::identity::folder_of;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};

/// How far from now the time must be of what a killed process left, before it is removed: a file that is
/// younger may be one whose writer is just about to lock it.
const LEFT_FOR: Duration = Duration::from_secs(10);

/// The longest name, in bytes, that a temporary one holds whole. Most systems take 255 and encrypting ones
/// 143, and a temporary name is up to 40 longer.
const LONGEST_NAME: usize = 100;

/// Another temporary name each time for a file that is called `name`.
pub(super) fn temporary_name(name: &OsStr) -> OsString {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let mut temporary = prefix(name);
    temporary.push(format!(
        "{}-{}.part",
        std::process::id(),
        COUNTER.fetch_add(1, Ordering::Relaxed)
    ));
    temporary
}

/// How all temporary names of a file begin.
fn prefix(name: &OsStr) -> OsString {
    let mut prefix = OsString::from(".");
    if name.len() <= LONGEST_NAME {
        prefix.push(name);
    } else {
        let mut hasher = DefaultHasher::new();
        name.as_encoded_bytes().hash(&mut hasher);
        prefix.push(format!("glassbox-{:016x}", hasher.finish()));
    }
    prefix.push(".");
    prefix
}

/// Removes what others have left that were killed while they wrote this file. What cannot be looked
/// at or removed stays: that is no reason not to write.
pub(super) fn remove_leftovers(path: &Path) {
    let (Some(name), Ok(entries)) = (path.file_name(), fs::read_dir(folder_of(path))) else {
        return;
    };
    let prefix = prefix(name);
    for entry in entries.flatten() {
        // Not what a link points to, and no pipe that would wait for someone to write.
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_file && is_temporary(&prefix, &entry.file_name()) && is_abandoned(&entry.path()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Whether `name` is one that [`temporary_name`] makes of this prefix.
fn is_temporary(prefix: &OsStr, name: &OsStr) -> bool {
    let name = name.as_encoded_bytes();
    let middle = name.strip_prefix(prefix.as_encoded_bytes());
    let middle = middle.and_then(|name| name.strip_suffix(b".part"));
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
    let written = file.metadata().and_then(|data| data.modified());
    // A clock that was put back leaves files of the future.
    let distance = written.map(|time| match SystemTime::now().duration_since(time) {
        Ok(age) => age,
        Err(ahead) => ahead.duration(),
    });
    distance.is_ok_and(|distance| distance >= LEFT_FOR) && file.try_lock().is_ok()
}

#[cfg(test)]
mod tests {
    use super::super::replace_file;
    use super::super::tests::{names, write};
    use super::*;
    use std::io::Write;

    /// A file as someone has left it so many seconds ago.
    fn left(path: &Path, seconds: i64) -> File {
        let file = File::create_new(path).unwrap();
        let (now, by) = (
            SystemTime::now(),
            Duration::from_secs(seconds.unsigned_abs()),
        );
        let then = if seconds < 0 { now + by } else { now - by };
        file.set_modified(then).unwrap();
        file
    }

    #[test]
    fn what_a_killed_process_left_goes_with_the_next_write_of_the_same_file() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let path = folder.join("a.png");
        left(&folder.join(".a.png.4711-0.part"), 60);
        left(&folder.join(".a.png.4712-13.part"), 60);
        write(&path, "new");
        assert_eq!(names(folder), ["a.png"]);
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }

    #[test]
    fn what_was_left_by_a_clock_that_ran_ahead_goes_too() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        left(&folder.join(".a.png.4711-0.part"), -86_400 * 365);
        write(&folder.join("a.png"), "new");
        assert_eq!(names(folder), ["a.png"]);
    }

    #[test]
    fn a_name_as_long_as_names_may_be_is_written_and_what_was_left_of_it_goes() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let name = format!("{}.png", "n".repeat(251));
        let path = folder.join(&name);
        left(&folder.join(temporary_name(OsStr::new(&name))), 60);
        write(&path, "new");
        assert_eq!(names(folder), [name]);
    }

    #[test]
    fn what_is_being_written_or_belongs_to_another_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let writing = left(&folder.join(".a.png.4711-0.part"), 60);
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
            left(&folder.join(other), 60);
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
            let file = File::options().write(true).open(&part)?;
            file.set_modified(SystemTime::now() - Duration::from_secs(60))?;
            assert!(!is_abandoned(&part), "{} is free", part.display());
            Ok(())
        })
        .unwrap();
        assert_eq!(names(folder), ["a.png"]);
    }
}
