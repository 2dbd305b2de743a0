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
    /// Something failed: it stays until it is closed.
    pub is_fault: bool,
    since: Instant,
}

/// The messages that are shown, oldest first.
#[derive(Resource, Default)]
pub struct Notices(Vec<Notice>);

impl Notices {
    /// Says that something was done.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), false);
    }

    /// Says that something failed, and why.
    pub fn fault(&mut self, text: impl Into<String>) {
        self.push(text.into(), true);
    }

    fn push(&mut self, text: String, is_fault: bool) {
        self.0.retain(|notice| notice.text != text);
        self.0.push(Notice {
            text,
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
            .retain(|notice| notice.is_fault || notice.since.elapsed() < STAY);
        &self.0
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
