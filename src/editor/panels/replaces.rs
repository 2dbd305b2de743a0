//! Whether what is to be written replaces a file.
//!
//! It is asked on a thread of its own: a folder of another machine may answer slowly, and no frame waits for it.

use crate::editor::background::{Background, Outcome};
use bevy_egui::egui::Context;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How often it is asked again.
const AGAIN: Duration = Duration::from_secs(1);
/// How soon an answer is looked for.
const SOON: Duration = Duration::from_millis(30);

/// What is known of the file that a path leads to.
#[derive(Default)]
pub(super) struct Replaces {
    file: PathBuf,
    is_there: bool,
    asking: Option<Background<bool>>,
    asked: Option<Instant>,
    /// Written from here, or meant to be replaced.
    own: Option<PathBuf>,
}

impl Replaces {
    /// Whether the file is there, as far as is known by now, and was not written from here.
    pub fn look(&mut self, context: &Context, file: &Path) -> bool {
        if self.file != file {
            *self = Self {
                file: file.to_path_buf(),
                own: self.own.take(),
                ..Self::default()
            };
        }
        if let Some(asking) = &self.asking {
            match asking.take() {
                Outcome::Pending => context.request_repaint_after(SOON),
                Outcome::Done(is_there) => (self.is_there, self.asking) = (is_there, None),
                Outcome::Lost => self.asking = None,
            }
        }
        let is_due = self.asked.is_none_or(|asked| asked.elapsed() >= AGAIN);
        if self.asking.is_none() && is_due && !file.as_os_str().is_empty() {
            let file = file.to_path_buf();
            self.asking = Background::start("file", move |_| file.is_file()).ok();
            self.asked = Some(Instant::now());
            context.request_repaint_after(SOON);
        }
        self.is_foreign()
    }

    /// Whether it may be written by who was `told` that it replaces a file, or that it does not. What was told may be old:
    /// where a file is there after all, it is told from now on.
    pub fn allows(&mut self, told: bool) -> bool {
        if !told && self.file.is_file() {
            // An answer that is still to come is of before.
            (self.is_there, self.asking) = (true, None);
        }
        told || !self.is_foreign()
    }

    /// It is written now.
    pub fn note_written(&mut self) {
        self.own = Some(self.file.clone());
    }

    fn is_foreign(&self) -> bool {
        self.is_there && self.own.as_ref() != Some(&self.file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// What is known once there was an answer.
    fn known(replaces: &mut Replaces, file: &Path) -> bool {
        let context = Context::default();
        replaces.look(&context, file);
        let start = Instant::now();
        while replaces.asking.is_some() {
            assert!(start.elapsed().as_secs() < 60, "no answer came");
            replaces.look(&context, file);
            std::thread::sleep(Duration::from_millis(1));
        }
        replaces.look(&context, file)
    }

    #[test]
    fn a_file_of_others_is_replaced_only_by_who_was_told_so() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.md");
        let mut replaces = Replaces::default();
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
