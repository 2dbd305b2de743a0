//! The scene's entities as a list in the order of the hierarchy, made again only when it changed:
//! a panel that asked every entity in every frame would slow a large scene.

use crate::scene::{
    DirectionalLamp, MeshSource, ParallelogramLamp, Phong, PointLamp, SceneCamera, SceneId,
    SegmentLamp, UsesMaterial,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::lifecycle::Remove;
use bevy::ecs::name::Name;
use bevy::ecs::observer::On;
use bevy::ecs::query::{Added, Allow, Changed, Has, Or, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, ResMut};
use bevy::mesh::Mesh3d;
use bevy::platform::collections::HashMap;

/// What an entity is, by its components.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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

/// Kinds that the list shows alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Shown {
    #[default]
    All,
    Objects,
    Lights,
    Cameras,
    Materials,
    Groups,
}

impl Shown {
    /// Whether it shows such an entity.
    pub fn has(self, kind: Kind) -> bool {
        match self {
            Self::All => true,
            Self::Objects => kind == Kind::Object,
            Self::Lights => matches!(
                kind,
                Kind::PointLamp
                    | Kind::DirectionalLamp
                    | Kind::SegmentLamp
                    | Kind::ParallelogramLamp
            ),
            Self::Cameras => kind == Kind::Camera,
            Self::Materials => kind == Kind::Material,
            Self::Groups => kind == Kind::Group,
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
    /// Where in the list its parent is.
    parent: Option<usize>,
    /// Where in the list its descendants end.
    pub end: usize,
    /// It is shown or hidden: a material is neither.
    pub can_hide: bool,
    /// Hidden itself.
    pub hidden: bool,
    /// Hidden itself or by an ancestor.
    pub unseen: bool,
    /// The shared material that it has.
    pub material: Option<Entity>,
}

/// The scene's entities, children after their parents, siblings by their numbers.
#[derive(Resource, Default)]
pub(super) struct Outline {
    pub items: Vec<Item>,
    places: HashMap<SceneId, usize>,
    /// By shared material: the objects that have it.
    users: HashMap<Entity, Vec<usize>>,
    /// How often it was made: a test's proof that it is not made in every frame.
    pub versions: u64,
    /// Something that it shows is gone.
    is_stale: bool,
}

impl Outline {
    /// Where in the list the entity of that number is.
    pub fn place(&self, id: SceneId) -> Option<usize> {
        self.places.get(&id).copied()
    }

    /// Where the objects are that have a shared material.
    pub fn users(&self, material: &Item) -> &[usize] {
        self.users_of(material.entity)
    }

    /// The same by the material's entity.
    pub fn users_of(&self, material: Entity) -> &[usize] {
        self.users.get(&material).map_or(&[], Vec::as_slice)
    }

    /// Where the parent of an item is.
    pub fn parent(&self, at: usize) -> Option<usize> {
        self.items[at].parent
    }

    /// The entity of that number.
    pub fn find(&self, id: SceneId) -> Option<&Item> {
        self.items.get(self.place(id)?)
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

type ShowsChange = Or<(
    Changed<SceneId>,
    Changed<Name>,
    Changed<ChildOf>,
    Changed<Visibility>,
    Changed<UsesMaterial>,
    OfKind,
)>;

type Parts<'a> = (
    Entity,
    &'a SceneId,
    Option<&'a Name>,
    Option<&'a ChildOf>,
    Option<&'a Visibility>,
    Option<&'a UsesMaterial>,
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
type Shows = (
    (SceneId, Name, ChildOf, Visibility, UsesMaterial, Disabled),
    (Mesh3d, MeshSource, Phong, SceneCamera),
    (PointLamp, DirectionalLamp, SegmentLamp, ParallelogramLamp),
);

/// Something is gone that the list shows.
pub(super) fn note_gone(
    gone: On<Remove, Shows>,
    scene: Query<(), (With<SceneId>, Allow<Disabled>)>,
    mut outline: ResMut<Outline>,
) {
    if scene.contains(gone.entity) {
        outline.is_stale = true;
    }
}

/// Makes the list again where anything that it shows changed.
pub(super) fn outline_scene(
    changed: Query<(), (With<SceneId>, ShowsChange)>,
    disabled: Query<(), (With<SceneId>, Added<Disabled>)>,
    all: Query<Parts>,
    mut outline: ResMut<Outline>,
) {
    let is_same = changed.is_empty() && disabled.is_empty() && !outline.is_stale;
    if is_same && outline.versions > 0 {
        return;
    }
    outline.is_stale = false;
    let mut found: Vec<(Item, Option<Entity>)> = all
        .iter()
        .filter(|parts| !parts.1.is_unassigned())
        .map(|(entity, id, name, parent, visibility, material, has)| {
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
                parent: None,
                end: 0,
                can_hide: visibility.is_some(),
                hidden,
                unseen: hidden,
                material: material.map(|material| material.0),
            };
            (item, parent.map(ChildOf::parent))
        })
        .collect();
    found.sort_unstable_by_key(|(item, _)| item.id);
    outline.items = in_tree_order(found);
    let places = outline.items.iter().enumerate();
    outline.places = places.map(|(at, item)| (item.id, at)).collect();
    let mut users: HashMap<Entity, Vec<usize>> = HashMap::default();
    for (at, item) in outline.items.iter().enumerate() {
        if let Some(material) = item.material {
            users.entry(material).or_default().push(at);
        }
    }
    outline.users = users;
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
        item.parent = open.last().copied();
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
pub(super) mod tests {
    use super::*;
    use bevy::app::{App, Update};
    use bevy::ecs::world::World;

    fn app() -> App {
        let mut app = App::new();
        app.init_resource::<Outline>()
            .add_observer(note_gone)
            .add_systems(Update, outline_scene);
        app
    }

    pub fn spawn(world: &mut World, id: u64, name: &'static str, parent: Option<Entity>) -> Entity {
        let entity = world.spawn((SceneId(id), Name::new(name))).id();
        if let Some(parent) = parent {
            world.entity_mut(entity).insert(ChildOf(parent));
        }
        entity
    }

    /// House { Roof { Tile }, Door }, Garden { Tree }.
    pub fn village() -> App {
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
        let names: Vec<&str> = outline
            .items
            .iter()
            .map(|item| item.name.as_str())
            .collect();
        assert_eq!(names, ["House", "Roof", "Tile", "Door", "Garden", "Tree"]);
        let depths: Vec<u32> = outline.items.iter().map(|item| item.depth).collect();
        assert_eq!(depths, [0, 1, 2, 1, 0, 1]);
        let ends: Vec<usize> = outline.items.iter().map(|item| item.end).collect();
        assert_eq!(ends, [4, 3, 3, 4, 6, 6]);
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
    fn what_is_a_light_no_more_is_shown_as_what_it_is_and_others_go_unnoticed() {
        let mut app = village();
        let tree = app.world().resource::<Outline>().find(SceneId(21)).unwrap();
        let tree = tree.entity;
        let kind = |app: &mut App| {
            app.update();
            let outline = app.world().resource::<Outline>();
            (outline.find(SceneId(21)).unwrap().kind, outline.versions)
        };
        let mut world = app.world_mut().entity_mut(tree);
        world.insert(PointLamp::default());
        assert_eq!(kind(&mut app), (Kind::PointLamp, 2));
        app.world_mut().entity_mut(tree).remove::<PointLamp>();
        assert_eq!(kind(&mut app), (Kind::Group, 3));
        let other = app.world_mut().spawn(Name::new("of the app alone")).id();
        app.world_mut().despawn(other);
        assert_eq!(kind(&mut app), (Kind::Group, 3));
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
