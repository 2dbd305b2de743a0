use bevy::ecs::{component::Component, reflect::ReflectComponent};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use serde::{Deserialize, Serialize};

/// A number that stays with an entity of the scene through saving, reopening and undo.
///
/// The tracer sorts everything by it and resolves equal distances with it, so that a picture does
/// not depend on the order in which entities were spawned. Zero means "not assigned yet": the room
/// `sync` gives such an entity the next free number before it is traced for the first time.
#[derive(
    Component,
    Reflect,
    Serialize,
    Deserialize,
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct SceneId(pub u64);

impl SceneId {
    /// True until a number was assigned.
    pub fn is_unassigned(self) -> bool {
        self.0 == 0
    }
}

/// On an entity with a mesh or a light that is no part of the scene, such as a handle of an editor:
/// it gets no [`SceneId`], so it is not traced, listed or saved.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct NotTraced;
