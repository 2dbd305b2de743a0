//! Who moves while the shutter is open, and how fast in the world.
//!
//! A [`Motion`]'s velocity is in the space of its entity's parent, and whatever hangs below an entity
//! moves with it:
//!
//! `velocity(e) = velocity(parent of e) + L(parent of e) · Motion(e).velocity`
//!
//! with L the linear part of the parent's `GlobalTransform`; without a parent it is the identity. So an
//! entity has the sum over itself and its ancestors, those along which Bevy carries transforms.

use super::reading::Switched;
use super::traced::Draft;
use crate::scene::{Motion, RenderSettings};
use bevy::ecs::change_detection::{DetectChanges, Ref};
use bevy::ecs::entity::{Entity, EntityHashMap};
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::query::{Changed, Or, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Query, Res, ResMut};
use bevy::math::Vec3;
use bevy::transform::components::GlobalTransform;

/// How an entity moves, with what its ancestors add.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldMotion {
    /// Metres per unit of shutter time, in world space. As the components give it: it may be NaN.
    pub velocity: Vec3,
    /// Samples of a pixel that it asks for: the largest number of all that add to it.
    pub samples: u32,
}

/// The motions of all that moves; of nothing where the settings switch motion off.
#[derive(Resource, Default)]
pub struct WorldMotions {
    moving: EntityHashMap<WorldMotion>,
    /// Who moves otherwise than in the frame before.
    others: Vec<Entity>,
}

impl WorldMotions {
    /// How an entity moves; `None` where it stands still.
    pub fn of(&self, entity: Entity) -> Option<WorldMotion> {
        self.moving.get(&entity).copied()
    }

    /// How many move.
    #[cfg(test)]
    pub(super) fn kept(&self) -> usize {
        self.moving.len()
    }

    /// Who moves otherwise than in the frame before, or moves no more.
    pub(super) fn others(&self) -> &[Entity] {
        &self.others
    }

    /// True where this frame found others than the one before.
    pub(super) fn changed(&self) -> bool {
        !self.others.is_empty()
    }
}

type Edited = Or<(Changed<Motion>, Changed<ChildOf>)>;

type Chain<'w, 's> = Query<
    'w,
    's,
    (
        Option<&'static Motion>,
        Option<&'static ChildOf>,
        Ref<'static, GlobalTransform>,
    ),
>;

/// What moves by itself, or may be carried along.
type Carried = Or<(With<Motion>, With<ChildOf>)>;

/// Adds up the motions again where one changed, appeared or went, and where what is above one, or the
/// space that it is in, became another.
pub(super) fn sync_motions(
    edited: Query<(), Edited>,
    mut no_motion: RemovedComponents<Motion>,
    mut no_parent: RemovedComponents<ChildOf>,
    mut no_transform: RemovedComponents<GlobalTransform>,
    mut switched: Switched,
    movers: Query<Option<&ChildOf>, With<Motion>>,
    below: Query<Entity, Carried>,
    chain: Chain,
    settings: Res<RenderSettings>,
    draft: Res<Draft>,
    mut was_on: Local<bool>,
    mut motions: ResMut<WorldMotions>,
) {
    // Not `||`: every reader has to be emptied.
    let gone = no_motion.read().count() + no_parent.read().count() + no_transform.read().count();
    let on = settings.features.motion && !movers.is_empty();
    let toggled = std::mem::replace(&mut *was_on, on) != on;
    let switched = switched.any() || draft.anew;
    motions.others.clear();
    // Most scenes stand still: whose child somebody becomes matters to none of them.
    if !on && !toggled {
        return;
    }
    let other_space = |parent: &ChildOf| {
        let parent = chain.get(parent.parent());
        parent.is_ok_and(|(.., transform)| transform.is_changed())
    };
    let stale = toggled
        || switched
        || gone > 0
        || !edited.is_empty()
        || movers.iter().flatten().any(other_space);
    if !stale {
        return;
    }
    let mut found = EntityHashMap::default();
    if on {
        let mut path = Vec::new();
        for entity in &below {
            add_up(entity, &chain, &mut path, &mut found);
        }
        found.retain(|_, motion| motion.velocity != Vec3::ZERO);
    }
    let motions = &mut *motions;
    let before = std::mem::replace(&mut motions.moving, found);
    let all = before.keys().chain(motions.moving.keys());
    // NaN is no other than NaN: what cannot be traced is said once.
    let bits = |motion: Option<&WorldMotion>| {
        motion.map(|motion| (motion.velocity.to_array().map(f32::to_bits), motion.samples))
    };
    let others = all.filter(|entity| {
        let [old, new] = [&before, &motions.moving].map(|motions| bits(motions.get(*entity)));
        old != new
    });
    motions.others.extend(others);
}

/// Finds an entity's motion and that of all above it, each of them once however many hang below it.
fn add_up(
    entity: Entity,
    chain: &Chain,
    path: &mut Vec<Entity>,
    found: &mut EntityHashMap<WorldMotion>,
) {
    let mut next = Some(entity);
    let mut sum = WorldMotion::default();
    while let Some(entity) = next {
        if let Some(known) = found.get(&entity) {
            sum = *known;
            break;
        }
        let Ok((_, parent, _)) = chain.get(entity) else {
            break;
        };
        // Until its own is known, so that parents in a circle come to an end.
        found.insert(entity, WorldMotion::default());
        path.push(entity);
        next = parent.map(ChildOf::parent);
    }
    for entity in path.drain(..).rev() {
        if let Ok((Some(motion), parent, _)) = chain.get(entity) {
            let space = parent.and_then(|parent| chain.get(parent.parent()).ok());
            sum.velocity += match space {
                Some((.., space)) => space.affine().transform_vector3(motion.velocity),
                None => motion.velocity,
            };
            sum.samples = sum.samples.max(motion.samples);
        }
        found.insert(entity, sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::app::{App, Update};

    #[test]
    fn parents_in_a_circle_come_to_an_end() {
        // Bevy's own systems are left out: they may not come to theirs.
        let mut app = App::new();
        app.init_resource::<WorldMotions>()
            .init_resource::<Draft>()
            .init_resource::<RenderSettings>()
            .add_systems(Update, sync_motions);
        let [a, b, c] = [Vec3::X, Vec3::Y, Vec3::Z].map(|velocity| {
            let motion = Motion {
                velocity,
                samples: 1,
            };
            let parts = (motion, GlobalTransform::IDENTITY);
            app.world_mut().spawn(parts).id()
        });
        for (child, parent) in [(a, b), (b, c), (c, a)] {
            app.world_mut().entity_mut(child).insert(ChildOf(parent));
        }
        app.update();
        let motions = app.world().resource::<WorldMotions>();
        assert!([a, b, c].iter().all(|entity| motions.of(*entity).is_some()));
    }
}
