//! What the editor has to say to the person in front of it, apart from the scene.

use bevy::ecs::resource::Resource;
use std::time::{Duration, Instant};

/// How long a message without a fault stays.
const STAY: Duration = Duration::from_secs(6);
/// How many messages that matter are kept; the oldest goes then.
const MOST_KEPT: usize = 200;

/// One message.
#[derive(Clone, Debug)]
pub struct Notice {
    /// One line that says what happened, where, and what would help.
    pub text: String,
    /// What there is to say one by one, below the text. It stays until it is closed then.
    pub lines: Vec<String>,
    /// Whether all lines are shown, not the first few alone.
    pub shows_all: bool,
    /// Something failed: it stays until it is closed.
    pub is_fault: bool,
    since: Instant,
}

impl Notice {
    /// Whether it waits until somebody has read it, and is found again afterwards.
    fn matters(&self) -> bool {
        self.is_fault || !self.lines.is_empty()
    }
}

/// The messages that are shown, and those that can be read again, oldest first.
#[derive(Resource, Default)]
pub struct Notices {
    shown: Vec<Notice>,
    kept: Vec<Notice>,
}

impl Notices {
    /// Says that something was done.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), false, Vec::new());
    }

    /// Says that something was done, in place of what was said when the same was done before: `verb` or `verb: …`.
    pub fn tell_in_place(&mut self, verb: &str, text: impl Into<String>) {
        let is_same = |said: &str| {
            let rest = said.strip_prefix(verb);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
        };
        (self.shown).retain(|notice| notice.matters() || !is_same(&notice.text));
        self.tell(text);
    }

    /// Says what a file held or cannot hold: one message, however many lines. Nothing where there are none.
    pub fn notes(&mut self, file: &str, lines: Vec<String>) {
        let text = match lines.len() {
            0 => return,
            1 => format!("{file}: one note"),
            count => format!("{file}: {count} notes"),
        };
        self.push(text, false, lines);
    }

    /// Says that something failed, and why.
    pub fn fault(&mut self, text: impl Into<String>) {
        self.push(text.into(), true, Vec::new());
    }

    fn push(&mut self, text: String, is_fault: bool, lines: Vec<String>) {
        let notice = Notice {
            text,
            lines,
            shows_all: false,
            is_fault,
            since: Instant::now(),
        };
        if notice.matters() {
            self.kept.retain(|other| other.text != notice.text);
            let too_many = (self.kept.len() + 1).saturating_sub(MOST_KEPT);
            self.kept.drain(..too_many);
            self.kept.push(notice.clone());
        }
        self.shown.retain(|other| other.text != notice.text);
        self.shown.push(notice);
    }

    /// What failed and what files left out, closed or not.
    pub fn kept(&self) -> &[Notice] {
        &self.kept
    }

    /// Forgets what was kept.
    pub fn forget_kept(&mut self) {
        self.kept.clear();
    }

    /// Nothing was said, or all of it was closed.
    pub fn is_empty(&self) -> bool {
        self.shown.is_empty()
    }

    /// What is to be shown now.
    pub fn shown(&mut self) -> &[Notice] {
        self.shown
            .retain(|notice| notice.matters() || notice.since.elapsed() < STAY);
        &self.shown
    }

    /// Shows all lines of one, by its place in what is shown.
    pub fn show_all(&mut self, index: usize) {
        if let Some(notice) = self.shown.get_mut(index) {
            notice.shows_all = true;
        }
    }

    /// Takes away what was said of a file that is not open any more; it can be read again.
    pub fn close_notes(&mut self) {
        self.shown.retain(|notice| notice.lines.is_empty());
    }

    /// Takes all away.
    pub fn close_all(&mut self) {
        self.shown.clear();
    }

    /// Takes one away, by its place in what is shown.
    pub fn close(&mut self, index: usize) {
        if index < self.shown.len() {
            self.shown.remove(index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_undone_one_after_the_other_is_said_in_one_place() {
        let mut notices = Notices::default();
        notices.tell("Undone for good");
        for step in ["Undone: Add Ground", "Undone: Add Quad", "Undone"] {
            notices.tell_in_place("Undone", step);
            let texts: Vec<_> = notices.shown().iter().map(|one| &*one.text).collect();
            assert_eq!(texts, ["Undone for good", step]);
        }
    }

    #[test]
    fn notes_of_a_file_go_when_another_is_opened_and_can_be_read_again() {
        let mut notices = Notices::default();
        notices.notes("house.obj", vec!["has no camera".into()]);
        notices.fault("roof.png: cannot be read");
        notices.close_notes();
        let texts = |all: &[Notice]| all.iter().map(|one| one.text.clone()).collect::<Vec<_>>();
        assert_eq!(texts(notices.shown()), ["roof.png: cannot be read"]);
        assert_eq!(texts(notices.kept())[0], "house.obj: one note");
    }
}
