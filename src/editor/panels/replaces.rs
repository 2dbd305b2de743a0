//! Whether what is to be written replaces a file.

use super::asked::Asked;
use bevy_egui::egui::Context;
use std::path::{Path, PathBuf};

/// What is known of the file that a path leads to.
#[derive(Default)]
pub(super) struct Replaces {
    is_there: Asked<PathBuf, bool>,
    /// Written from here, or meant to be replaced.
    own: Option<PathBuf>,
}

impl Replaces {
    /// Whether the file is there, as far as is known by now, and was not written from here.
    pub fn look(&mut self, context: &Context, file: &Path) -> bool {
        let is_there = self.is_there.look(context, file.to_path_buf(), is_file);
        is_there == Some(&true) && self.own.as_deref() != Some(file)
    }

    /// Whether the file that was looked at may be written by who was `told` that it replaces another, or that it does not.
    /// What was told may be old: where a file is there after all, it is told from now on.
    pub fn allows(&mut self, told: bool) -> bool {
        let file = self.is_there.about();
        let is_safe = told || self.own.as_ref() == file || !file.is_some_and(|file| file.is_file());
        if !is_safe {
            self.is_there.tell(true);
        }
        is_safe
    }

    /// It is written now.
    pub fn note_written(&mut self) {
        self.own = self.is_there.about().cloned();
    }
}

fn is_file(file: PathBuf) -> bool {
    file.is_file()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_file_of_others_is_replaced_only_by_who_was_told_so() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.md");
        let mut replaces = Replaces::default();
        let known = |replaces: &mut Replaces, file: &Path| {
            replaces.is_there.wait(file.to_path_buf(), is_file);
            replaces.look(&Context::default(), file)
        };
        assert!(!known(&mut replaces, &file));
        assert!(replaces.allows(false), "there is none");
        // One that has come since.
        fs::write(&file, "theirs").unwrap();
        assert!(!replaces.allows(false));
        assert!(replaces.look(&Context::default(), &file), "it is told now");
        assert!(replaces.allows(true));
        replaces.note_written();
        assert!(!known(&mut replaces, &file), "it is our own");
        assert!(replaces.allows(false));
        let other = folder.path().join("b.md");
        fs::write(&other, "theirs").unwrap();
        assert!(known(&mut replaces, &other));
    }
}
