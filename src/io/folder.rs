//! Paths in scene files: relative to the file's folder, `/` between their parts, and inside it.

use super::error::{FileError, Problem};
use super::file_name::{decoded, encoded};
use std::path::{Component, Path, PathBuf};

/// The folder that the paths of a scene start from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folder {
    /// Empty for the working folder.
    pub path: PathBuf,
    /// Whether paths may leave it.
    pub allow_outside: bool,
}

impl Folder {
    /// The folder that a file lies in.
    pub fn of(file: &Path, allow_outside: bool) -> Self {
        Self {
            path: file.parent().map(Path::to_path_buf).unwrap_or_default(),
            allow_outside,
        }
    }

    /// The file that a path in a scene means. Where it leaves the folder, through `..`, as an
    /// absolute path or over a symbolic link, that is an error unless it was allowed.
    pub fn resolve(&self, path: &str) -> Result<PathBuf, FileError> {
        let full = self.file_of(path);
        if self.allow_outside {
            return Ok(full);
        }
        let outside = || FileError::new(path, Problem::Outside);
        if !stays_inside(path) {
            return Err(outside());
        }
        // A symbolic link can lead outside although no part of the path says so.
        let root = if self.path.as_os_str().is_empty() {
            Path::new(".")
        } else {
            &self.path
        };
        if let (Ok(real), Ok(root)) = (full.canonicalize(), root.canonicalize())
            && !real.starts_with(root)
        {
            return Err(outside());
        }
        Ok(full)
    }

    /// The file that a path in a scene means, wherever that lies.
    pub(crate) fn file_of(&self, path: &str) -> PathBuf {
        let full = self.path.join(path);
        match decoded(path) {
            Some(decoded) if !full.exists() => self.path.join(decoded),
            _ => full,
        }
    }

    /// How a file is named from this folder, with `/` between the parts and `..` where it must be; what a
    /// scene could not say is escaped.
    pub fn name_of(&self, file: &Path) -> String {
        let absolute = |path: &Path| {
            let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
            normal(&path)
        };
        let here = absolute(if self.path.as_os_str().is_empty() {
            Path::new(".")
        } else {
            &self.path
        });
        let there = absolute(file);
        let shared = here
            .components()
            .zip(there.components())
            .take_while(|(a, b)| a == b)
            .count();
        let up = here.components().skip(shared).map(|_| "..".to_owned());
        let down = there
            .components()
            .skip(shared)
            .map(|part| encoded(part.as_os_str()));
        up.chain(down).collect::<Vec<_>>().join("/")
    }
}

/// Whether a relative path never climbs above where it starts. Backslashes and drive letters are
/// refused on every system, so that a scene means the same everywhere.
pub(crate) fn stays_inside(path: &str) -> bool {
    let drive = path.as_bytes().get(1) == Some(&b':');
    if path.contains('\\') || drive || path.contains('\0') {
        return false;
    }
    let mut depth = 0_i64;
    for part in Path::new(path).components() {
        match part {
            Component::Normal(_) => depth += 1,
            Component::CurDir => {}
            Component::ParentDir => depth -= 1,
            Component::RootDir | Component::Prefix(_) => return false,
        }
        if depth < 0 {
            return false;
        }
    }
    true
}

/// The path without `.` and `..`, where that is possible without looking at the disk.
fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            _ => out.push(part),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_that_climbs_out_is_refused_and_one_that_comes_back_is_not() {
        for bad in ["../a", "a/../../b", "/etc/passwd", "..\\a", "c:/a", "a\0b"] {
            assert!(!stays_inside(bad), "{bad} was taken as inside");
        }
        for good in ["a", "a/b", "./a", "a/../b"] {
            assert!(stays_inside(good), "{good} was taken as outside");
        }
    }

    #[test]
    fn a_name_that_a_scene_could_not_say_comes_back_and_one_with_escapes_of_its_own_too() {
        let folder = tempfile::tempdir().unwrap();
        let folder = Folder {
            path: folder.path().into(),
            allow_outside: false,
        };
        for name in ["a\\b.png", "c:d.png", "e%20f.png", "g%5Ch.png"] {
            let file = folder.path.join(name);
            std::fs::write(&file, "").unwrap();
            assert_eq!(folder.resolve(&folder.name_of(&file)).unwrap(), file);
        }
        // As a person writes it.
        let file = folder.resolve("e%20f.png").unwrap();
        assert_eq!(file, folder.path.join("e%20f.png"));
    }

    #[test]
    fn a_file_is_named_from_another_folder() {
        let folder = Folder {
            path: "/a/b".into(),
            allow_outside: false,
        };
        assert_eq!(folder.name_of(Path::new("/a/b/c/d.obj")), "c/d.obj");
        assert_eq!(folder.name_of(Path::new("/a/x/d.obj")), "../x/d.obj");
    }
}
