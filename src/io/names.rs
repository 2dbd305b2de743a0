//! Files that another file names, found however the name is spelt: files travel between systems whose names have
//! other separators, no case, or other folders.

use super::error::FileError;
use super::folder::{Folder, stays_inside};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Where a named file is.
#[derive(Debug, PartialEq)]
pub(crate) struct Found {
    /// Its path from the folder, with `/` between the parts.
    pub path: String,
    /// Whether it is called otherwise than it was named, apart from `\` for `/`.
    pub is_guess: bool,
}

/// Why a named file was not found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Missing {
    /// There is none of that name.
    Nowhere,
    /// The name leads out of the folder, which was not allowed, and there is none of that name inside.
    Outside,
}

impl Missing {
    /// What a note says.
    pub fn what(self, kind: &str) -> String {
        match self {
            Self::Nowhere => format!("there is no {kind}"),
            Self::Outside => {
                format!("outside the folder, and so not opened without --allow-outside: the {kind}")
            }
        }
    }
}

/// Looks for files from one folder. A folder that has to be listed is listed once.
pub(crate) struct Names<'a> {
    folder: &'a Folder,
    listings: HashMap<PathBuf, Vec<String>>,
}

impl<'a> Names<'a> {
    pub fn new(folder: &'a Folder) -> Self {
        Self {
            folder,
            listings: HashMap::new(),
        }
    }

    /// The file that `name` means, seen from the part of the folder that `prefix` names, empty or with `/` at its end:
    /// the name as it is, with `/` for `\`, in whatever case, and then a file of that name in `prefix` itself.
    pub fn find(&mut self, prefix: &str, name: &str) -> Result<Found, Missing> {
        let mut missing = Missing::Nowhere;
        let slashes = name.replace('\\', "/");
        for name in [name, &slashes] {
            let path = joined(prefix, name);
            match self.folder.resolve(&path) {
                Ok(file) if file.is_file() => {
                    return Ok(Found {
                        path,
                        is_guess: false,
                    });
                }
                Ok(_) => {}
                Err(_) => missing = Missing::Outside,
            }
        }
        let last = slashes.rsplit('/').next().unwrap_or_default();
        for name in [slashes.as_str(), last] {
            if let Some(path) = self.in_any_case(&joined(prefix, name)) {
                return Ok(Found {
                    path,
                    is_guess: true,
                });
            }
        }
        Err(missing)
    }

    /// Where a path lies that was found.
    pub fn file(&self, path: &str) -> Result<PathBuf, FileError> {
        self.folder.resolve(path)
    }

    /// A file whose path differs in the case of letters alone.
    fn in_any_case(&mut self, path: &str) -> Option<String> {
        if !self.folder.allow_outside && !stays_inside(path) {
            return None;
        }
        let mut found = String::new();
        for part in path.split('/') {
            if !found.is_empty() {
                found.push('/');
            }
            let here = self.folder.path.join(&found);
            let is_step = matches!(part, "" | "." | "..");
            let name = match is_step || here.join(part).exists() {
                true => part.to_owned(),
                false => self.alike(here, part)?,
            };
            found.push_str(&name);
        }
        let file = self.folder.resolve(&found).ok()?;
        (file.is_file() && !path.is_empty()).then_some(found)
    }

    fn alike(&mut self, folder: PathBuf, name: &str) -> Option<String> {
        let wanted = name.to_lowercase();
        let listing = self.listings.entry(folder).or_insert_with_key(|folder| {
            let here = match folder.as_os_str().is_empty() {
                true => Path::new("."),
                false => folder,
            };
            let entries = std::fs::read_dir(here).into_iter().flatten().flatten();
            let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
            let mut names: Vec<String> = names.collect();
            // Which of several is taken shall not depend on the disk.
            names.sort();
            names
        });
        let alike = |other: &&String| other.to_lowercase() == wanted;
        listing.iter().find(alike).cloned()
    }
}

/// A path in the part of a folder that `prefix` names; an absolute one stays what it is.
fn joined(prefix: &str, name: &str) -> String {
    match name.starts_with('/') {
        true => name.to_owned(),
        false => format!("{prefix}{name}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder() -> (tempfile::TempDir, Folder) {
        let disk = tempfile::tempdir().unwrap();
        std::fs::create_dir(disk.path().join("Textures")).unwrap();
        for name in ["wall#2.png", "Textures/Wood Grain.PNG", "brick.png"] {
            std::fs::write(disk.path().join(name), "x").unwrap();
        }
        let folder = Folder {
            path: disk.path().to_path_buf(),
            allow_outside: false,
        };
        (disk, folder)
    }

    #[test]
    fn a_file_is_found_by_its_name_with_other_separators_in_other_case_and_by_its_last_part() {
        let (_disk, folder) = folder();
        let mut names = Names::new(&folder);
        for (name, path, is_guess) in [
            ("wall#2.png", "wall#2.png", false),
            ("Textures/Wood Grain.PNG", "Textures/Wood Grain.PNG", false),
            ("Textures\\Wood Grain.PNG", "Textures/Wood Grain.PNG", false),
            ("textures\\wood grain.png", "Textures/Wood Grain.PNG", true),
            ("./TEXTURES/../Brick.png", "./Textures/../brick.png", true),
            ("C:\\art\\brick.png", "brick.png", true),
            ("C:\\\\art\\\\Brick.png", "brick.png", true),
            ("/home/someone/brick.png", "brick.png", true),
            ("../brick.png", "brick.png", true),
        ] {
            let path = path.to_owned();
            assert_eq!(names.find("", name), Ok(Found { path, is_guess }), "{name}");
        }
        let inside = names.find("Textures/", "wood Grain.png").unwrap();
        assert_eq!(inside.path, "Textures/Wood Grain.PNG");
    }

    #[test]
    fn a_file_that_is_not_there_or_outside_is_not_found() {
        let (disk, folder) = folder();
        let inner = Folder {
            path: disk.path().join("Textures"),
            ..folder.clone()
        };
        let mut names = Names::new(&folder);
        assert_eq!(names.find("", "gone.png"), Err(Missing::Nowhere));
        assert_eq!(names.find("", ""), Err(Missing::Nowhere));
        assert_eq!(names.find("", "Textures"), Err(Missing::Nowhere));
        let mut names = Names::new(&inner);
        assert_eq!(names.find("", "../brick.png"), Err(Missing::Outside));
        assert_eq!(names.find("", "../BRICK.png"), Err(Missing::Outside));
    }
}
