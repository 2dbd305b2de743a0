//! Which rows of the list are to be seen: what is folded away or not searched for is left out, and
//! shared materials stand in a folder of their own, below the rest, each a folder of the objects that have it.

use super::outline::{Item, Kind, Outline, Shown};
use crate::scene::SceneId;
use bevy::platform::collections::HashSet;
use std::sync::Arc;

/// A row of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    /// A place in [`Outline::items`].
    Item(usize),
    /// The folder of so many materials.
    Materials(usize),
    /// An object once more, below the material that it has: by their places.
    User {
        /// The object.
        object: usize,
        /// The material.
        material: usize,
    },
}

impl Row {
    /// Its place in [`Outline::items`], where it is the one row of an item.
    pub fn item(self) -> Option<usize> {
        match self {
            Self::Item(at) => Some(at),
            Self::Materials(_) | Self::User { .. } => None,
        }
    }
}

/// What is searched for.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Filter {
    /// A part of a name or of a kind; nothing for all.
    pub text: String,
    pub shown: Shown,
}

impl Filter {
    /// Whether it leaves nothing out.
    pub fn is_off(&self) -> bool {
        self.text.trim().is_empty() && self.shown == Shown::All
    }
}

/// Whether it stands in the folder of materials: one that is part of an object's group stays there.
pub(super) fn is_in_folder(item: &Item) -> bool {
    item.kind == Kind::Material && item.depth == 0
}

impl Outline {
    /// What is to be seen of the list: nothing below a folded entity; while something is searched
    /// for, what fits and the ancestors of that.
    fn rows(&self, folded: &HashSet<SceneId>, folder_folded: bool, filter: &Filter) -> Vec<Row> {
        let mut rows = self.rows_of(folded, filter, false);
        let materials = self.rows_of(folded, filter, true);
        let top = materials.iter().filter_map(|row| row.item());
        let count = top.filter(|&at| self.items[at].depth == 0).count();
        if count > 0 {
            rows.push(Row::Materials(count));
            if !folder_folded || !filter.is_off() {
                rows.extend(materials);
            }
        }
        rows
    }

    /// The rows in the folder of materials, or all others.
    fn rows_of(&self, folded: &HashSet<SceneId>, filter: &Filter, in_folder: bool) -> Vec<Row> {
        let mut rows = Vec::with_capacity(if in_folder { 0 } else { self.items.len() });
        let mut at = 0;
        let needle = filter.text.trim().to_lowercase();
        let mut ancestors: Vec<usize> = Vec::new();
        let mut shown = 0;
        while let Some(item) = self.items.get(at) {
            if item.depth == 0 && is_in_folder(item) != in_folder {
                at = item.end;
                continue;
            }
            if filter.is_off() {
                rows.push(Row::Item(at));
                let is_turned = folded.contains(&item.id);
                // A material is closed until it is opened: those that have it are rows already.
                let is_material = in_folder && item.depth == 0;
                let is_open = is_turned == is_material;
                if is_material && is_open {
                    rows.extend(self.users(item).iter().map(|&object| Row::User {
                        object,
                        material: at,
                    }));
                }
                at = if is_open { at + 1 } else { item.end };
                continue;
            }
            ancestors.truncate(item.depth as usize);
            ancestors.push(at);
            let fits = item.lower_name.contains(&needle) || item.kind.name().contains(&needle);
            if fits && filter.shown.has(item.kind) {
                // Those of them that an earlier match has not shown yet.
                let new = ancestors.iter().filter(|&&place| place >= shown);
                rows.extend(new.map(|&place| Row::Item(place)));
                shown = at + 1;
            }
            at += 1;
        }
        rows
    }
}

/// Entities whose descendants the list does not show; shared materials whose objects it does.
#[derive(Default)]
pub(super) struct Folded {
    ids: HashSet<SceneId>,
    /// The folder of materials is.
    folder: bool,
    /// Another number for other entities.
    version: u64,
}

impl Folded {
    /// Whether what is below it is not shown.
    pub fn contains(&self, item: &Item) -> bool {
        self.ids.contains(&item.id) != is_in_folder(item)
    }

    /// Whether nothing was folded or opened.
    #[cfg(test)]
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Whether the materials are not shown.
    pub fn folder(&self) -> bool {
        self.folder
    }

    /// Folds it where it is not, and the other way round.
    pub fn toggle(&mut self, id: SceneId) {
        if !self.ids.remove(&id) {
            self.ids.insert(id);
        }
        self.version += 1;
    }

    /// Folds the materials away where they are shown, and the other way round.
    pub fn toggle_folder(&mut self) {
        self.folder = !self.folder;
        self.version += 1;
    }

    /// Everything is shown again.
    pub fn clear(&mut self) {
        self.ids.clear();
        self.folder = false;
        self.version += 1;
    }

    /// Shows all that an item is below.
    pub fn reveal(&mut self, outline: &Outline, at: usize) {
        let mut above = Some(at);
        while let Some(at) = above {
            if is_in_folder(&outline.items[at]) && self.folder {
                self.toggle_folder();
            }
            above = outline.parent(at);
            if let Some(item) = above.map(|at| &outline.items[at])
                && self.contains(item)
            {
                self.toggle(item.id);
            }
        }
    }
}

/// [`Outline::rows`], found again only where the list, what is folded or the search is another.
#[derive(Default)]
pub(super) struct Rows {
    /// Of the list and of what is folded.
    versions: Option<(u64, u64)>,
    filter: Filter,
    rows: Arc<Vec<Row>>,
}

impl Rows {
    /// The rows as they are now.
    pub fn of(&mut self, outline: &Outline, folded: &Folded, filter: &Filter) -> Arc<Vec<Row>> {
        let versions = (outline.versions, folded.version);
        if self.versions != Some(versions) || self.filter != *filter {
            self.rows = Arc::new(outline.rows(&folded.ids, folded.folder, filter));
            self.versions = Some(versions);
            self.filter = filter.clone();
        }
        self.rows.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::super::outline::tests::{spawn, village};
    use super::*;
    use crate::scene::{Phong, UsesMaterial};

    fn names<'a>(outline: &'a Outline, rows: &[Row]) -> Vec<&'a str> {
        rows.iter()
            .map(|row| {
                row.item()
                    .map_or("(materials)", |at| &outline.items[at].name)
            })
            .collect()
    }

    fn text(text: &str) -> Filter {
        Filter {
            text: text.into(),
            shown: Shown::All,
        }
    }

    #[test]
    fn a_folded_entity_hides_what_is_below_it_only() {
        let app = village();
        let outline = app.world().resource::<Outline>();
        let rows = outline.rows(
            &HashSet::from_iter([SceneId(11), SceneId(20)]),
            false,
            &text(""),
        );
        assert_eq!(names(outline, &rows), ["House", "Roof", "Door", "Garden"]);
    }

    #[test]
    fn a_search_shows_what_contains_it_with_its_ancestors_folded_or_not() {
        let app = village();
        let outline = app.world().resource::<Outline>();
        let folded = HashSet::from_iter([SceneId(10)]);
        let found = |search| names(outline, &outline.rows(&folded, false, &text(search)));
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
        let first = rows.of(outline, &folded, &text(""));
        assert_eq!(first.len(), 6);
        assert!(Arc::ptr_eq(&first, &rows.of(outline, &folded, &text(""))));
        assert_eq!(rows.of(outline, &folded, &text("door")).len(), 2);
        folded.toggle(SceneId(10));
        assert_eq!(rows.of(outline, &folded, &text("")).len(), 3);
        folded.clear();
        assert_eq!(rows.of(outline, &folded, &text("")).len(), 6);
        spawn(app.world_mut(), 30, "Well", None);
        app.update();
        let outline = app.world().resource::<Outline>();
        assert_eq!(rows.of(outline, &folded, &text("")).len(), 7);
    }

    #[test]
    fn shared_materials_stand_in_a_folder_below_the_rest_that_folds() {
        let mut app = village();
        let world = app.world_mut();
        for (id, name) in [(5, "Brick"), (6, "Slate")] {
            let entity = spawn(world, id, name, None);
            world.entity_mut(entity).insert(Phong::default());
        }
        app.update();
        let outline = app.world().resource::<Outline>();
        let rows = |folder_folded, filter: &Filter| {
            names(
                outline,
                &outline.rows(&HashSet::default(), folder_folded, filter),
            )
        };
        let all = rows(false, &text(""));
        assert_eq!(all[6..], ["(materials)", "Brick", "Slate"]);
        assert_eq!(rows(true, &text("")).len(), 7);
        assert_eq!(rows(true, &text("slate")), ["(materials)", "Slate"]);
        let shown = Shown::Groups;
        let groups = Filter {
            shown,
            ..Filter::default()
        };
        assert_eq!(rows(false, &groups).len(), 6);
        let both = Filter {
            shown,
            ..text("tile")
        };
        assert_eq!(rows(false, &both), ["House", "Roof", "Tile"]);
    }

    #[test]
    fn a_material_that_is_opened_shows_the_objects_that_have_it_until_that_changes() {
        let mut app = village();
        let world = app.world_mut();
        let brick = spawn(world, 5, "Brick", None);
        world.entity_mut(brick).insert(Phong::default());
        let find = |world: &bevy::ecs::world::World, id| {
            world
                .resource::<Outline>()
                .find(SceneId(id))
                .unwrap()
                .entity
        };
        for id in [11, 13] {
            let entity = find(world, id);
            world.entity_mut(entity).insert(UsesMaterial(brick));
        }
        app.update();
        let mut folded = Folded::default();
        let mut rows = Rows::default();
        let mut users = |app: &bevy::app::App, folded: &Folded| {
            let outline = app.world().resource::<Outline>();
            let rows = rows.of(outline, folded, &text(""));
            let users = rows.iter().filter_map(|row| match row {
                Row::User { object, .. } => Some(outline.items[*object].name.clone()),
                _ => None,
            });
            users.collect::<Vec<String>>()
        };
        assert_eq!(users(&app, &folded), [""; 0], "closed at first");
        folded.toggle(SceneId(5));
        assert_eq!(users(&app, &folded), ["Roof", "Door"]);
        let roof = find(app.world(), 11);
        app.world_mut().entity_mut(roof).remove::<UsesMaterial>();
        app.update();
        assert_eq!(users(&app, &folded), ["Door"]);
    }

    #[test]
    fn what_is_revealed_is_shown_with_all_that_it_is_below() {
        let app = village();
        let outline = app.world().resource::<Outline>();
        let mut folded = Folded::default();
        for id in [10, 11, 20] {
            folded.toggle(SceneId(id));
        }
        folded.reveal(outline, outline.place(SceneId(12)).unwrap());
        let is_folded = |id| folded.contains(outline.find(SceneId(id)).unwrap());
        assert!(!is_folded(10) && !is_folded(11));
        assert!(is_folded(20));
    }
}
