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
    /// The same, found without a search: a list asks for each of its rows.
    known: HashSet<SceneId>,
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
        self.known.contains(&id)
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
        self.known.clear();
        self.ids.reverse();
        self.ids.retain(|&id| self.known.insert(id));
        self.ids.reverse();
    }

    /// Selects these too, the last as the active one.
    pub fn add(&mut self, ids: impl IntoIterator<Item = SceneId>) {
        let before = std::mem::take(&mut self.ids);
        self.set(before.into_iter().chain(ids));
    }

    /// Selects it where it is not, and the other way round.
    pub fn toggle(&mut self, id: SceneId) {
        if self.known.insert(id) {
            self.ids.push(id);
        } else {
            self.retain(|other| other != id);
        }
    }

    /// Keeps those that pass.
    pub fn retain(&mut self, keep: impl Fn(SceneId) -> bool) {
        self.ids.retain(|&id| keep(id));
        self.known.retain(|&id| keep(id));
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
        selection.add([SceneId(2)]);
        assert_eq!(selection.active(), Some(SceneId(2)));
        selection.toggle(SceneId(2));
        selection.toggle(SceneId(3));
        assert_eq!(selection.ids(), [1, 3].map(SceneId));
        let contained = [1, 2, 3].map(|id| selection.contains(SceneId(id)));
        assert_eq!(contained, [true, false, true]);
        selection.retain(|id| id != SceneId(1));
        assert!(!selection.contains(SceneId(1)));
        selection.add([4, 3].map(SceneId));
        assert_eq!(selection.ids(), [4, 3].map(SceneId));
    }
}
