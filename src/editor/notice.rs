//! What the editor has to say to the person in front of it, apart from the scene.

use bevy::ecs::resource::Resource;
use std::time::{Duration, Instant};

/// How long a message without a fault stays.
const STAY: Duration = Duration::from_secs(6);

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
    /// Whether it waits until somebody has read it.
    fn stays(&self) -> bool {
        self.is_fault || !self.lines.is_empty()
    }
}

/// The messages that are shown, oldest first.
#[derive(Resource, Default)]
pub struct Notices(Vec<Notice>);

impl Notices {
    /// Says that something was done.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), false, Vec::new());
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
        self.0.retain(|notice| notice.text != text);
        self.0.push(Notice {
            text,
            lines,
            shows_all: false,
            is_fault,
            since: Instant::now(),
        });
    }

    /// Nothing was said, or all of it was closed.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// What is to be shown now.
    pub fn shown(&mut self) -> &[Notice] {
        self.0
            .retain(|notice| notice.stays() || notice.since.elapsed() < STAY);
        &self.0
    }

    /// Shows all lines of one, by its place in what is shown.
    pub fn show_all(&mut self, index: usize) {
        if let Some(notice) = self.0.get_mut(index) {
            notice.shows_all = true;
        }
    }

    /// Takes all away.
    pub fn close_all(&mut self) {
        self.0.clear();
    }

    /// Takes one away, by its place in what is shown.
    pub fn close(&mut self, index: usize) {
        if index < self.0.len() {
            self.0.remove(index);
        }
    }
}
