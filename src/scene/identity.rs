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

    /// The next number after this one that can be given. After the largest, which a file may say, that is whatever is
    /// free from 1 on; multiples of 2^32 are given to none, as scene files cannot name them.
    pub(crate) fn next_free(self, is_taken: impl Fn(Self) -> bool) -> Self {
        let mut number = self.0;
        loop {
            number = number.wrapping_add(1);
            let id = Self(number);
            if number.trailing_zeros() < 32 && !is_taken(id) {
                return id;
            }
        }
    }
}

/// On an entity with a mesh or a light that is no part of the scene, such as a handle of an editor:
/// it gets no [`SceneId`], so it is not traced, listed or saved.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct NotTraced;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_number_is_free_and_one_that_scene_files_can_name() {
        let taken = [1, 2, 8, (1 << 32) + 1].map(SceneId);
        let next = |after| SceneId(after).next_free(|id| taken.contains(&id)).0;
        let last = u64::from(u32::MAX);
        let found = [0, 7, 9, last, u64::MAX, u64::MAX - (1 << 32)].map(next);
        let after_multiple = u64::MAX - (1 << 32) + 2;
        assert_eq!(found, [3, 9, 10, last + 3, 3, after_multiple]);
    }
}
