//! A scene as plain values, taken from the world component by component, to compare and to build
//! another world from. It knows nothing of the history's own mirror.

use bevy::app::App;
use bevy::camera::visibility::Visibility;
use bevy::ecs::name::Name;
use bevy::prelude::{ChildOf, Children, Entity, Mesh3d, Transform, World};
use glassbox::editor::headless_editor;
use glassbox::scene::{
    DirectionalLamp, Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp,
    RenderSettings, SceneCamera, SceneId, SegmentLamp, UsesMaterial,
};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::digest;
use std::collections::{BTreeMap, BTreeSet, HashMap};

macro_rules! scene_copy {
    ($($field:ident: $component:ty),* $(,)?) => {
        /// One entity; others by their numbers.
        #[derive(Clone, Debug, PartialEq, Default)]
        pub struct EntityCopy {
            $(pub $field: Option<$component>,)*
            pub parent: Option<u64>,
            pub children: BTreeSet<u64>,
            /// 0 where it is gone.
            pub material: Option<u64>,
            pub has_mesh: bool,
        }

        impl EntityCopy {
            fn of(world: &World, entity: Entity) -> Self {
                let id = |entity: Entity| world.get::<SceneId>(entity).map_or(0, |id| id.0);
                Self {
                    $($field: world.get::<$component>(entity).cloned(),)*
                    parent: world.get::<ChildOf>(entity).map(|parent| id(parent.0)),
                    children: world
                        .get::<Children>(entity)
                        .map(|children| children.iter().map(|child| id(*child)).collect())
                        .unwrap_or_default(),
                    material: world.get::<UsesMaterial>(entity).map(|uses| id(uses.0)),
                    has_mesh: world.get::<Mesh3d>(entity).is_some(),
                }
            }

            fn spawn(&self, world: &mut World, entity: Entity, id: u64) {
                $(if let Some(value) = &self.$field {
                    world.entity_mut(entity).insert(value.clone());
                })*
                world.entity_mut(entity).insert(SceneId(id));
                // Some come with others that they require.
                $(if self.$field.is_none() {
                    world.entity_mut(entity).remove::<$component>();
                })*
            }
        }
    };
}

scene_copy! {
    name: Name,
    transform: Transform,
    visibility: Visibility,
    mesh: MeshSource,
    phong: Phong,
    point_lamp: PointLamp,
    directional_lamp: DirectionalLamp,
    segment_lamp: SegmentLamp,
    parallelogram_lamp: ParallelogramLamp,
    camera: SceneCamera,
    lens: Lens,
    motion: Motion,
}

/// The scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCopy {
    pub entities: BTreeMap<u64, EntityCopy>,
    pub settings: RenderSettings,
    pub environment: Environment,
}

impl SceneCopy {
    pub fn of(app: &mut App) -> Self {
        let world = app.world_mut();
        let mut all = world.query::<(Entity, &SceneId)>();
        let all: Vec<(Entity, u64)> = all.iter(world).map(|(e, id)| (e, id.0)).collect();
        let count = all.len();
        let entities: BTreeMap<u64, EntityCopy> = all
            .into_iter()
            .map(|(entity, id)| (id, EntityCopy::of(world, entity)))
            .collect();
        assert_eq!(entities.len(), count, "two entities have the same number");
        Self {
            entities,
            settings: world.resource::<RenderSettings>().clone(),
            environment: world.resource::<Environment>().clone(),
        }
    }

    /// Another app with the same scene, spawned at once.
    pub fn spawn(&self) -> App {
        let mut app = headless_editor();
        let world = app.world_mut();
        world.insert_resource(self.settings.clone());
        world.insert_resource(self.environment.clone());
        let entities: HashMap<u64, Entity> = self
            .entities
            .keys()
            .map(|&id| (id, world.spawn_empty().id()))
            .collect();
        for (id, copy) in &self.entities {
            let entity = entities[id];
            copy.spawn(world, entity, *id);
            if let Some(parent) = copy.parent {
                world.entity_mut(entity).insert(ChildOf(entities[&parent]));
            }
            if let Some(material) = copy.material {
                let material = entities.get(&material).copied();
                let material = material.unwrap_or(Entity::PLACEHOLDER);
                world.entity_mut(entity).insert(UsesMaterial(material));
            }
        }
        app.update();
        app
    }

    /// Fails where the other scene is another, and names what is.
    pub fn assert_same(&self, other: &Self, when: &str) {
        for id in self.entities.keys().chain(other.entities.keys()) {
            let (a, b) = (self.entities.get(id), other.entities.get(id));
            assert_eq!(a, b, "entity {id}, {when}");
        }
        assert_eq!(self.settings, other.settings, "{when}");
        assert_eq!(self.environment, other.environment, "{when}");
    }
}

/// What rays read of an app's scene, all of it, and from where: the same text for the same picture.
pub fn traced(app: &App) -> Vec<String> {
    let traced = app.world().resource::<Traced>();
    let settings = app.world().resource::<RenderSettings>();
    let cameras = &app.world().resource::<TracedCameras>().0;
    let mut lines: Vec<String> = cameras
        .iter()
        .map(|camera| {
            let digest = digest(&traced.world, &camera.camera, settings);
            format!("{} {:?} {digest}", camera.name, camera.id)
        })
        .collect();
    // A scene may have no camera.
    let fixed = glassbox::trace::Camera::looking_at(
        bevy::math::Vec3::Z,
        bevy::math::Vec3::ZERO,
        bevy::math::Vec3::Y,
        1.0,
    );
    lines.push(digest(&traced.world, &fixed, settings).to_string());
    lines.extend(traced.problems.iter().map(ToString::to_string));
    lines
}
