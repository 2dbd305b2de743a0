//! The scene's entities as a list in the order of the hierarchy, made again only when it changed:
//! a panel that asked every entity in every frame would slow a large scene.

use crate::scene::{
    DirectionalLamp, MeshSource, ParallelogramLamp, Phong, PointLamp, SceneCamera, SceneId,
    SegmentLamp,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Added, Changed, Has, Or, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, ResMut};
use bevy::mesh::Mesh3d;
use bevy::platform::collections::{HashMap, HashSet};
use std::sync::Arc;

/// What an entity is, by its components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Object,
    Material,
    PointLamp,
    DirectionalLamp,
    SegmentLamp,
    ParallelogramLamp,
    Camera,
    Group,
}

impl Kind {
    /// A character of egui's own fonts.
    pub fn glyph(self) -> &'static str {
        match self {
            Self::Object => "■",
            Self::Material => "🎨",
            Self::PointLamp => "💡",
            Self::DirectionalLamp => "☀",
            Self::SegmentLamp => "╱",
            Self::ParallelogramLamp => "▱",
            Self::Camera => "🎥",
            Self::Group => "🗀",
        }
    }

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::Material => "shared material",
            Self::PointLamp => "point light",
            Self::DirectionalLamp => "directional light",
            Self::SegmentLamp => "segment light",
            Self::ParallelogramLamp => "parallelogram light",
            Self::Camera => "camera",
            Self::Group => "group",
        }
    }
}

/// One entity in the list.
#[derive(Clone, Debug)]
pub(super) struct Item {
    pub id: SceneId,
    pub entity: Entity,
    pub kind: Kind,
    pub name: String,
    /// For searching.
    pub lower_name: String,
    /// 0 at the root.
    pub depth: u32,
    /// Where in the list its descendants end.
    pub end: usize,
    /// Hidden itself.
    pub hidden: bool,
    /// Hidden itself or by an ancestor.
    pub unseen: bool,
}

/// The scene's entities, children after their parents, siblings by their numbers.
#[derive(Resource, Default)]
pub(super) struct Outline {
    pub items: Vec<Item>,
    places: HashMap<SceneId, usize>,
    /// How often it was made: a test's proof that it is not made in every frame.
    pub versions: u64,
}

impl Outline {
    /// The entity of that number.
    pub fn find(&self, id: SceneId) -> Option<&Item> {
        self.items.get(*self.places.get(&id)?)
    }

    /// What is to be seen of the list: nothing below a folded entity; while something is searched
    /// for, what contains it and the ancestors of that. Places in [`Self::items`].
    pub fn rows(&self, folded: &HashSet<SceneId>, search: &str) -> Vec<usize> {
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

type OfKind = Or<(
    Added<Mesh3d>,
    Added<MeshSource>,
    Added<Phong>,
    Added<PointLamp>,
    Added<DirectionalLamp>,
    Added<SegmentLamp>,
    Added<ParallelogramLamp>,
    Added<SceneCamera>,
)>;

type Shown = Or<(
    Changed<SceneId>,
    Changed<Name>,
    Changed<ChildOf>,
    Changed<Visibility>,
    OfKind,
)>;

type Parts<'a> = (
    Entity,
    &'a SceneId,
    Option<&'a Name>,
    Option<&'a ChildOf>,
    Option<&'a Visibility>,
    (
        Has<Mesh3d>,
        Has<MeshSource>,
        Has<Phong>,
        Has<PointLamp>,
        Has<DirectionalLamp>,
        Has<SegmentLamp>,
        Has<ParallelogramLamp>,
        Has<SceneCamera>,
    ),
);

/// Components whose absence shows.
type Gone<'w, 's> = (
    RemovedComponents<'w, 's, SceneId>,
    RemovedComponents<'w, 's, Name>,
    RemovedComponents<'w, 's, ChildOf>,
    RemovedComponents<'w, 's, MeshSource>,
    RemovedComponents<'w, 's, Phong>,
    RemovedComponents<'w, 's, SceneCamera>,
);

/// Makes the list again where anything that it shows changed.
pub(super) fn outline_scene(
    changed: Query<(), (With<SceneId>, Shown)>,
    mut gone: Gone,
    all: Query<Parts>,
    mut outline: ResMut<Outline>,
) {
    // All of them are read, so that none is heard of again in the next frame.
    let removed = gone.0.read().count()
        + gone.1.read().count()
        + gone.2.read().count()
        + gone.3.read().count()
        + gone.4.read().count()
        + gone.5.read().count();
    if changed.is_empty() && removed == 0 && outline.versions > 0 {
        return;
    }
    let mut found: Vec<(Item, Option<Entity>)> = all
        .iter()
        .filter(|parts| !parts.1.is_unassigned())
        .map(|(entity, id, name, parent, visibility, has)| {
            let kind = kind_of(has);
            let name = name.map_or_else(
                || format!("{} {}", kind.name(), id.0),
                |name| name.as_str().to_owned(),
            );
            let hidden = visibility == Some(&Visibility::Hidden);
            let item = Item {
                id: *id,
                entity,
                kind,
                lower_name: name.to_lowercase(),
                name,
                depth: 0,
                end: 0,
                hidden,
                unseen: hidden,
            };
            (item, parent.map(ChildOf::parent))
        })
        .collect();
    found.sort_unstable_by_key(|(item, _)| item.id);
    outline.items = in_tree_order(found);
    let places = outline.items.iter().enumerate();
    outline.places = places.map(|(at, item)| (item.id, at)).collect();
    outline.versions += 1;
}

fn kind_of(has: (bool, bool, bool, bool, bool, bool, bool, bool)) -> Kind {
    let (mesh, source, phong, point, directional, segment, parallelogram, camera) = has;
    match () {
        () if mesh || source => Kind::Object,
        () if point => Kind::PointLamp,
        () if directional => Kind::DirectionalLamp,
        () if segment => Kind::SegmentLamp,
        () if parallelogram => Kind::ParallelogramLamp,
        () if camera => Kind::Camera,
        () if phong => Kind::Material,
        () => Kind::Group,
    }
}

/// Sorted by number in, children after their parents out. A parent that is no entity of the scene
/// counts as none.
fn in_tree_order(found: Vec<(Item, Option<Entity>)>) -> Vec<Item> {
    let places: HashMap<Entity, usize> = found
        .iter()
        .enumerate()
        .map(|(at, (item, _))| (item.entity, at))
        .collect();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); found.len()];
    let mut waiting: Vec<(usize, u32, bool)> = Vec::new();
    for (at, (_, parent)) in found.iter().enumerate() {
        match parent.and_then(|parent| places.get(&parent)) {
            Some(&parent) => children[parent].push(at),
            None => waiting.push((at, 0, false)),
        }
    }
    waiting.reverse();
    let mut items: Vec<Item> = Vec::with_capacity(found.len());
    let mut found: Vec<Option<Item>> = found.into_iter().map(|(item, _)| Some(item)).collect();
    let mut open: Vec<usize> = Vec::new();
    while let Some((at, depth, hidden)) = waiting.pop() {
        let Some(mut item) = found[at].take() else {
            continue;
        };
        while open.len() > depth as usize {
            let closed = open.pop().unwrap_or_default();
            items[closed].end = items.len();
        }
        item.depth = depth;
        item.unseen |= hidden;
        let below = children[at].iter().rev();
        waiting.extend(below.map(|&child| (child, depth + 1, item.unseen)));
        open.push(items.len());
        items.push(item);
    }
    let end = items.len();
    for closed in open {
        items[closed].end = end;
    }
    items
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::app::{App, Update};
    use bevy::ecs::world::World;

    fn app() -> App {
        let mut app = App::new();
        app.init_resource::<Outline>()
            .add_systems(Update, outline_scene);
        app
    }

    fn spawn(world: &mut World, id: u64, name: &'static str, parent: Option<Entity>) -> Entity {
        let entity = world.spawn((SceneId(id), Name::new(name))).id();
        if let Some(parent) = parent {
            world.entity_mut(entity).insert(ChildOf(parent));
        }
        entity
    }

    fn names<'a>(outline: &'a Outline, rows: &[usize]) -> Vec<&'a str> {
        rows.iter()
            .map(|&at| outline.items[at].name.as_str())
            .collect()
    }

    /// House { Roof { Tile }, Door }, Garden { Tree }.
    fn village() -> App {
        let mut app = app();
        let world = app.world_mut();
        let garden = spawn(world, 20, "Garden", None);
        let house = spawn(world, 10, "House", None);
        spawn(world, 21, "Tree", Some(garden));
        spawn(world, 13, "Door", Some(house));
        let roof = spawn(world, 11, "Roof", Some(house));
        spawn(world, 12, "Tile", Some(roof));
        app.update();
        app
    }

    #[test]
    fn children_come_after_their_parents_and_siblings_by_number() {
        let app = village();
        let outline = app.world().resource::<Outline>();
        let rows = outline.rows(&HashSet::new(), "");
        assert_eq!(
            names(outline, &rows),
            ["House", "Roof", "Tile", "Door", "Garden", "Tree"]
        );
        let depths: Vec<u32> = outline.items.iter().map(|item| item.depth).collect();
        assert_eq!(depths, [0, 1, 2, 1, 0, 1]);
        let ends: Vec<usize> = outline.items.iter().map(|item| item.end).collect();
        assert_eq!(ends, [4, 3, 3, 4, 6, 6]);
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

    #[test]
    fn it_is_made_again_when_something_it_shows_changed_and_only_then() {
        let mut app = village();
        let versions = |app: &App| app.world().resource::<Outline>().versions;
        for _ in 0..3 {
            app.update();
        }
        assert_eq!(versions(&app), 1);
        let tree = app.world().resource::<Outline>().find(SceneId(21)).unwrap();
        let tree = tree.entity;
        app.world_mut().entity_mut(tree).insert(Visibility::Hidden);
        app.update();
        assert_eq!(versions(&app), 2);
        let outline = app.world().resource::<Outline>();
        assert!(outline.find(SceneId(21)).unwrap().hidden);
        app.world_mut().despawn(tree);
        app.update();
        app.update();
        assert_eq!(versions(&app), 3);
        let outline = app.world().resource::<Outline>();
        assert!(outline.find(SceneId(21)).is_none());
    }

    #[test]
    fn what_is_below_a_hidden_entity_is_unseen_too() {
        let mut app = village();
        let house = app.world().resource::<Outline>().find(SceneId(10)).unwrap();
        let house = house.entity;
        app.world_mut().entity_mut(house).insert(Visibility::Hidden);
        app.update();
        let outline = app.world().resource::<Outline>();
        let unseen: Vec<&str> = outline
            .items
            .iter()
            .filter(|item| item.unseen)
            .map(|item| item.name.as_str())
            .collect();
        assert_eq!(unseen, ["House", "Roof", "Tile", "Door"]);
    }
}
