//! What the disk is asked for while a panel is drawn.
//!
//! It is asked on a thread of its own: a folder of another machine may answer slowly, and no frame waits for it.

use crate::editor::background::{Background, Outcome};
use bevy_egui::egui::Context;
use std::time::{Duration, Instant};

/// How often it is asked again.
const AGAIN: Duration = Duration::from_secs(1);
/// How soon an answer is looked for.
const SOON: Duration = Duration::from_millis(30);

/// An answer about something, and about what.
pub(super) struct Asked<K, T> {
    about: Option<K>,
    answer: Option<T>,
    asking: Option<Background<T>>,
    when: Option<Instant>,
}

impl<K, T> Default for Asked<K, T> {
    fn default() -> Self {
        Self {
            about: None,
            answer: None,
            asking: None,
            when: None,
        }
    }
}

impl<K: Clone + PartialEq + Send + 'static, T: Send + 'static> Asked<K, T> {
    /// What is known by now; `None` until there was an answer. It is asked for where this is about something else than
    /// before, and now and then.
    pub fn look(&mut self, context: &Context, about: K, ask: fn(K) -> T) -> Option<&T> {
        if self.about.as_ref() != Some(&about) {
            *self = Self {
                about: Some(about.clone()),
                ..Self::default()
            };
        }
        if let Some(asking) = &self.asking {
            match asking.take() {
                Outcome::Pending => context.request_repaint_after(SOON),
                Outcome::Done(answer) => (self.answer, self.asking) = (Some(answer), None),
                Outcome::Lost => self.asking = None,
            }
        }
        let is_due = self.when.is_none_or(|when| when.elapsed() >= AGAIN);
        if self.asking.is_none() && is_due {
            self.asking = Background::start("ask", move |_| ask(about)).ok();
            self.when = Some(Instant::now());
            context.request_repaint_after(SOON);
        }
        self.answer.as_ref()
    }

    /// What this is about.
    pub fn about(&self) -> Option<&K> {
        self.about.as_ref()
    }

    /// Somebody knows better. An answer that is still to come is of before.
    pub fn tell(&mut self, answer: T) {
        (self.answer, self.asking) = (Some(answer), None);
    }

    /// One whose answer somebody sends.
    #[cfg(test)]
    pub fn sent(about: K) -> (std::sync::mpsc::Sender<T>, Self) {
        let (sender, asking) = Background::sent();
        let asked = Self {
            about: Some(about),
            asking: Some(asking),
            when: Some(Instant::now()),
            ..Self::default()
        };
        (sender, asked)
    }

    /// The next answer, and not the one before it.
    #[cfg(test)]
    pub fn wait(&mut self, about: K, ask: fn(K) -> T) -> &T {
        let context = Context::default();
        self.when = None;
        self.look(&context, about.clone(), ask);
        let start = Instant::now();
        while self.asking.is_some() {
            assert!(start.elapsed().as_secs() < 60, "no answer came");
            std::thread::sleep(Duration::from_millis(1));
            self.look(&context, about.clone(), ask);
        }
        self.answer.as_ref().expect("it was asked")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_of_what_is_asked_for_and_no_frame_waits_for_it() {
        fn slow(number: u64) -> u64 {
            std::thread::sleep(Duration::from_millis(number));
            2 * number
        }
        let context = Context::default();
        let mut asked = Asked::default();
        assert_eq!(asked.look(&context, 60_000, slow), None);
        assert_eq!(*asked.wait(3, slow), 6);
        assert_eq!(asked.look(&context, 3, slow), Some(&6));
        assert_eq!(asked.look(&context, 60_000, slow), None, "that is of 3");
    }
}
