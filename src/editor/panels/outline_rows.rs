//! Which rows of the list are to be seen: what is folded away or not searched for is left out.

use super::outline::Outline;
use crate::scene::SceneId;
use bevy::platform::collections::HashSet;
use std::sync::Arc;

impl Outline {
    /// What is to be seen of the list: nothing below a folded entity; while something is searched
    /// for, what contains it and the ancestors of that. Places in [`Self::items`].
    fn rows(&self, folded: &HashSet<SceneId>, search: &str) -> Vec<usize> {
        let needle = search.trim().to_lowercase();
        let mut rows = Vec::with_capacity(self.items.len());
        if needle.is_empty() {
            let mut at = 0;
            while let Some(item) = self.items.get(at) {
                rows.push(at);
                at = if folded.contains(&item.id) {
                    item.end
                } else {
                    at + 1
                };
            }
            return rows;
        }
        let mut ancestors: Vec<usize> = Vec::new();
        for (at, item) in self.items.iter().enumerate() {
            ancestors.truncate(item.depth as usize);
            ancestors.push(at);
            if item.lower_name.contains(&needle) || item.kind.name().contains(&needle) {
                // Those of them that an earlier match has not shown yet.
                let shown = rows.last().map_or(0, |&last: &usize| last + 1);
                rows.extend(ancestors.iter().copied().filter(|&place| place >= shown));
            }
        }
        rows
    }
}

/// Entities whose descendants the list does not show.
#[derive(Default)]
pub(super) struct Folded {
    ids: HashSet<SceneId>,
    /// Another number for other entities.
    version: u64,
}

impl Folded {
    /// Whether what is below it is not shown.
    pub fn contains(&self, id: SceneId) -> bool {
        self.ids.contains(&id)
    }

    /// Folds it where it is not, and the other way round.
    pub fn toggle(&mut self, id: SceneId) {
        if !self.ids.remove(&id) {
            self.ids.insert(id);
        }
        self.version += 1;
    }

    /// Everything is shown again.
    pub fn clear(&mut self) {
        self.ids.clear();
        self.version += 1;
    }
}

/// [`Outline::rows`], found again only where the list, what is folded or the search is another.
#[derive(Default)]
pub(super) struct Rows {
    /// Of the list and of what is folded.
    versions: Option<(u64, u64)>,
    search: String,
    rows: Arc<Vec<usize>>,
}

impl Rows {
    /// The rows as they are now.
    pub fn of(&mut self, outline: &Outline, folded: &Folded, search: &str) -> Arc<Vec<usize>> {
        let versions = (outline.versions, folded.version);
        if self.versions != Some(versions) || self.search != search {
            self.rows = Arc::new(outline.rows(&folded.ids, search));
            self.versions = Some(versions);
            search.clone_into(&mut self.search);
        }
        self.rows.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::super::outline::tests::{spawn, village};
    use super::*;

    fn names<'a>(outline: &'a Outline, rows: &[usize]) -> Vec<&'a str> {
        rows.iter()
            .map(|&at| outline.items[at].name.as_str())
            .collect()
    }

    #[test]
    fn a_folded_entity_hides_what_is_below_it_only() {
        let app = village();
        let outline = app.world().resource::<Outline>();
        let rows = outline.rows(&HashSet::from_iter([SceneId(11), SceneId(20)]), "");
        assert_eq!(names(outline, &rows), ["House", "Roof", "Door", "Garden"]);
    }

    #[test]
    fn a_search_shows_what_contains_it_with_its_ancestors_folded_or_not() {
        let app = village();
        let outline = app.world().resource::<Outline>();
        let folded = HashSet::from_iter([SceneId(10)]);
        let found = |search| names(outline, &outline.rows(&folded, search));
        assert_eq!(found(" tIL "), ["House", "Roof", "Tile"]);
        assert_eq!(
            found("o"),
            ["House", "Roof", "Tile", "Door", "Garden", "Tree"]
        );
        assert_eq!(found("door"), ["House", "Door"]);
        assert_eq!(found("chimney"), [""; 0]);
    }

    #[test]
    fn rows_are_found_again_for_another_list_search_or_fold_and_only_then() {
        let mut app = village();
        let (mut rows, mut folded) = (Rows::default(), Folded::default());
        let outline = app.world().resource::<Outline>();
        let first = rows.of(outline, &folded, "");
        assert_eq!(first.len(), 6);
        assert!(Arc::ptr_eq(&first, &rows.of(outline, &folded, "")));
        assert_eq!(rows.of(outline, &folded, "door").len(), 2);
        folded.toggle(SceneId(10));
        assert_eq!(rows.of(outline, &folded, "").len(), 3);
        folded.clear();
        assert_eq!(rows.of(outline, &folded, "").len(), 6);
        spawn(app.world_mut(), 30, "Well", None);
        app.update();
        let outline = app.world().resource::<Outline>();
        assert_eq!(rows.of(outline, &folded, "").len(), 7);
    }
}
