//! Beside an app's own systems: only what the editor does is a step.
//!
//! An app moves its things every frame. What changed while the editor did not work is taken over
//! into the mirror without a step, so that undo does not take the app's own doings back.

use super::mirror::changed_entities;
use super::{Gesture, History, commit};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::entity::{Entity, EntityHashSet};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{Mut, World};

/// Where this is, only changes that are made within [`within`] become steps.
#[derive(Resource, Default)]
pub(in crate::editor) struct OnlyWithin {
    /// What the gesture that is under way has changed.
    held: EntityHashSet,
}

impl OnlyWithin {
    /// What a gesture that has ended changed.
    pub(super) fn take(world: &mut World) -> Vec<Entity> {
        let only = world.get_resource_mut::<Self>();
        only.map_or_else(Vec::new, |mut only| only.held.drain().collect())
    }
}

/// Lets the editor work.
pub(in crate::editor) fn within<R>(world: &mut World, work: impl FnOnce(&mut World) -> R) -> R {
    if !world.contains_resource::<OnlyWithin>() {
        return work(world);
    }
    take_over(world);
    let result = work(world);
    if world.resource::<Gesture>().active() {
        let changed = changed_entities(world);
        world.resource_mut::<OnlyWithin>().held.extend(changed);
    } else {
        commit(world);
    }
    result
}

/// What the app has changed since the editor worked last is no step.
fn take_over(world: &mut World) {
    if !world.resource::<History>().started {
        return;
    }
    let mut changed = changed_entities(world);
    let held = &world.resource::<OnlyWithin>().held;
    // What is being dragged is the editor's until it is let go.
    changed.retain(|entity| !held.contains(entity));
    let drags = world.resource::<Gesture>().active();
    world.resource_scope(|world, mut history: Mut<History>| {
        let history = history.bypass_change_detection();
        history.mirror.update_these(world, &changed);
        if !drags {
            history.mirror.update_resources(world);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::super::{HistoryPlugin, undo};
    use super::*;
    use crate::app::headless_app_with;
    use crate::scene::{PointLamp, SceneId};
    use bevy::app::App;
    use bevy::math::Vec3;
    use bevy::transform::components::Transform;

    fn app() -> (App, [Entity; 2]) {
        let mut app = headless_app_with(HistoryPlugin);
        app.init_resource::<OnlyWithin>();
        let lamps = [1, 2].map(|id| {
            let lamp = (SceneId(id), PointLamp::default(), Transform::default());
            app.world_mut().spawn(lamp).id()
        });
        app.update();
        app.update();
        (app, lamps)
    }

    fn shift(world: &mut World, entity: Entity, by: Vec3) {
        world.get_mut::<Transform>(entity).unwrap().translation += by;
    }

    fn place(app: &App, entity: Entity) -> Vec3 {
        app.world().get::<Transform>(entity).unwrap().translation
    }

    #[test]
    fn what_the_app_does_is_no_step_and_survives_undo() {
        let (mut app, [ours, theirs]) = app();
        shift(app.world_mut(), theirs, Vec3::X);
        app.update();
        assert_eq!(app.world().resource::<History>().steps().count(), 0);
        within(app.world_mut(), |world| shift(world, ours, Vec3::Y));
        shift(app.world_mut(), theirs, Vec3::X);
        app.update();
        assert_eq!(app.world().resource::<History>().steps().count(), 1);
        assert!(within(app.world_mut(), undo).is_some());
        assert_eq!(place(&app, ours), Vec3::ZERO);
        assert_eq!(place(&app, theirs), 2.0 * Vec3::X);
        assert_eq!(within(app.world_mut(), undo), None, "there was one step");
    }

    #[test]
    fn a_drag_of_several_frames_is_one_step_while_the_app_goes_on() {
        let (mut app, [ours, theirs]) = app();
        app.world_mut().resource_mut::<Gesture>().begin("Drag");
        for _ in 0..3 {
            within(app.world_mut(), |world| shift(world, ours, Vec3::Y));
            shift(app.world_mut(), theirs, Vec3::X);
            app.update();
        }
        within(app.world_mut(), |world| {
            world.resource_mut::<Gesture>().end();
        });
        let steps: Vec<String> = app
            .world()
            .resource::<History>()
            .steps()
            .map(str::to_owned)
            .collect();
        assert_eq!(steps, ["Drag"]);
        within(app.world_mut(), undo);
        assert_eq!(place(&app, ours), Vec3::ZERO);
        assert_eq!(place(&app, theirs), 3.0 * Vec3::X);
    }
}
