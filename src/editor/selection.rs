//! Which entities of the scene are meant.

use crate::scene::SceneId;
use bevy::ecs::event::Event;
use bevy::ecs::resource::Resource;
use std::collections::HashSet;

/// Nothing is to be selected, chosen or in front any more.
#[derive(Event, Clone, Copy, Debug)]
pub(super) struct Escaped;

/// The selected entities, by their numbers: these outlive undo, which makes entities anew.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct Selection {
    ids: Vec<SceneId>,
}

impl Selection {
    /// In the order in which they were selected; the last is the active one.
    pub fn ids(&self) -> &[SceneId] {
        &self.ids
    }

    /// The one whose properties the inspector shows.
    pub fn active(&self) -> Option<SceneId> {
        self.ids.last().copied()
    }

    /// Whether it is selected.
    pub fn contains(&self, id: SceneId) -> bool {
        self.ids.contains(&id)
    }

    /// Nothing is selected.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Selects these and nothing else.
    pub fn set(&mut self, ids: impl IntoIterator<Item = SceneId>) {
        self.ids.clear();
        self.ids.extend(ids);
        // Of those named twice the last counts.
        let mut seen = HashSet::new();
        self.ids.reverse();
        self.ids.retain(|&id| seen.insert(id));
        self.ids.reverse();
    }

    /// Selects it too, as the active one.
    pub fn add(&mut self, id: SceneId) {
        self.ids.retain(|&other| other != id);
        self.ids.push(id);
    }

    /// Selects it where it is not, and the other way round.
    pub fn toggle(&mut self, id: SceneId) {
        if self.contains(id) {
            self.ids.retain(|&other| other != id);
        } else {
            self.ids.push(id);
        }
    }

    /// Keeps those that pass.
    pub fn retain(&mut self, keep: impl Fn(SceneId) -> bool) {
        self.ids.retain(|&id| keep(id));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_selected_last_is_active_and_nothing_is_selected_twice() {
        let mut selection = Selection::default();
        selection.set([1, 2, 1].map(SceneId));
        assert_eq!(selection.ids(), [2, 1].map(SceneId));
        selection.add(SceneId(2));
        assert_eq!(selection.active(), Some(SceneId(2)));
        selection.toggle(SceneId(2));
        selection.toggle(SceneId(3));
        assert_eq!(selection.ids(), [1, 3].map(SceneId));
    }
}
