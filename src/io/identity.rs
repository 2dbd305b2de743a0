//! Which file a path leads to, whatever links lie on the way, and whether a command would overwrite what it
//! reads.

use super::error::{FileError, Problem};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// Links in a row that are followed; Linux follows as many.
const MOST_LINKS: usize = 40;

/// What tells files apart.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
enum Identity {
    /// A file that is there: its device and its number on it.
    Node(u64, u64),
    /// One that is not, or on a system without such numbers: where it lies, or would.
    Place(PathBuf),
}

impl Identity {
    fn of(path: &Path) -> Self {
        if let Some((device, number)) = fs::metadata(path).ok().as_ref().and_then(node) {
            return Self::Node(device, number);
        }
        let place = path.canonicalize().unwrap_or_else(|_| {
            let place = behind_links(path).unwrap_or_else(|_| path.to_path_buf());
            match (folder_of(&place).canonicalize(), place.file_name()) {
                (Ok(folder), Some(name)) => folder.join(name),
                _ => std::path::absolute(&place).unwrap_or(place),
            }
        });
        Self::Place(place)
    }
}

/// Device and number of a file, where the system has them.
#[cfg(unix)]
pub(super) fn node(metadata: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
pub(super) fn node(_: &Metadata) -> Option<(u64, u64)> {
    None
}

/// The folder that a path's last part lies in.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Where symbolic links lead from here, whether there is a file or not.
pub(super) fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&place) {
            Ok(to) => place = folder_of(&place).join(to),
            Err(_) => return Ok(place),
        }
    }
    Err(io::Error::other("too many symbolic links lead on from it"))
}

/// Whether two paths lead to the same file, also through links of either kind.
#[cfg(feature = "editor")]
pub(super) fn same_file(a: &Path, b: &Path) -> bool {
    Identity::of(a) == Identity::of(b)
}

/// Refuses outputs of which one is a file that is read, or of which two are the same file, before anything is
/// written. Files count, not names: links are followed.
pub fn check_outputs<'a, 'b>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: impl IntoIterator<Item = &'b Path>,
) -> Result<(), FileError> {
    let inputs: HashMap<Identity, &Path> = inputs
        .into_iter()
        .map(|input| (Identity::of(input), input))
        .collect();
    let mut written: HashMap<Identity, &Path> = HashMap::new();
    for output in outputs {
        let identity = Identity::of(output);
        if let Some(input) = inputs.get(&identity) {
            let input = input.display().to_string();
            return Err(FileError::new(output, Problem::IsRead { input }));
        }
        match written.entry(identity) {
            Entry::Occupied(other) => {
                let other = other.get().display().to_string();
                return Err(FileError::new(output, Problem::WrittenTwice { other }));
            }
            Entry::Vacant(free) => {
                free.insert(output);
            }
        }
    }
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_file_is_known_by_any_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("a"), "").unwrap();
        fs::write(at("b"), "").unwrap();
        fs::create_dir(at("c")).unwrap();
        fs::hard_link(at("a"), at("hard")).unwrap();
        symlink("a", at("soft")).unwrap();
        symlink(folder.path(), at("c/up")).unwrap();
        symlink("new", at("dangling")).unwrap();
        let check = |output: &str, input: &str| {
            let (output, input) = (at(output), at(input));
            check_outputs([&*output], [&*input])
        };
        for (output, input) in [
            ("a", "a"),
            ("./c/../a", "a"),
            ("hard", "a"),
            ("soft", "hard"),
            ("c/up/a", "soft"),
            ("dangling", "new"),
            ("c/up/new", "dangling"),
        ] {
            let error = check(output, input).unwrap_err();
            assert!(
                matches!(error.problem, Problem::IsRead { .. }),
                "{output} over {input}: {error}"
            );
        }
        for (output, input) in [
            ("b", "a"),
            ("new", "a"),
            ("dangling", "a"),
            ("c/new", "new"),
        ] {
            check(output, input).unwrap_or_else(|error| panic!("{output} over {input}: {error}"));
        }
        let (a, hard) = (at("a"), at("hard"));
        let error = check_outputs([&*a, &*hard], []).unwrap_err();
        assert!(
            matches!(error.problem, Problem::WrittenTwice { .. }),
            "{error}"
        );
    }

    #[test]
    fn links_in_a_circle_lead_nowhere() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        symlink(&a, &b).unwrap();
        symlink(&b, &a).unwrap();
        assert!(behind_links(&a).is_err());
    }
}
