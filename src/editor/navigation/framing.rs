//! Showing all of something; and the view comes back when the step before that is undone.

use super::commands::back;
use super::drag::{begin_gesture, end_gesture};
use super::{Eye, LookThrough, aspect, move_view};
use crate::editor::extent::{Extent, extent_of, scene_extent};
use crate::editor::history::History;
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Res, ResMut};
use bevy::ecs::world::World;
use bevy::math::Vec3;

/// More are not remembered: nobody undoes so far to see an old view.
const MOST: usize = 32;

/// The views that framing has left, oldest first.
#[derive(Resource, Default)]
pub(super) struct Framings(Vec<Framing>);

struct Framing {
    /// The history's state. Positions fall, too, when the oldest steps are forgotten.
    state: u64,
    before: (Eye, Option<SceneId>),
    after: Eye,
}

/// Shows all of the scene, or of what is selected.
pub(super) fn frame(world: &mut World, all: bool) {
    let selected = world.resource::<Selection>().ids().to_vec();
    let extent = if all || selected.is_empty() {
        scene_extent(world)
    } else {
        extent_of(world, &selected)
    };
    if let Some(extent) = extent {
        show(world, extent);
    }
}

/// Shows all of some points of the world: a box of a tree, for example.
pub(in crate::editor) fn frame_points(world: &mut World, points: impl IntoIterator<Item = Vec3>) {
    if let Some(extent) = Extent::of_points(points) {
        show(world, extent);
    }
}

fn show(world: &mut World, extent: Extent) {
    let scene = scene_extent(world).map_or(1.0, |scene| scene.radius());
    // What has no size, a light for example, is shown with what is around it.
    let radius = match extent.radius() {
        radius if radius > 1e-3 * scene => radius,
        _ => (0.1 * scene).max(1e-3),
    };
    let aspect = aspect(world);
    let back = back(world);
    let before = world.resource::<Eye>().clone();
    let through = world.resource::<LookThrough>().camera;
    begin_gesture(world);
    move_view(world, |eye| {
        eye.back = back;
        eye.frame(extent.centre(), radius, aspect);
    });
    end_gesture(world);
    let after = world.resource::<Eye>().clone();
    let state = world.get_resource::<History>().map_or(0, History::state);
    let mut framings = world.resource_mut::<Framings>();
    if framings.0.len() == MOST {
        framings.0.remove(0);
    }
    framings.0.push(Framing {
        state,
        before: (before, through),
        after,
    });
}

/// Where a step is undone after which the view was framed, it is as it was before, unless it was moved since.
pub(super) fn unframe(
    history: Res<History>,
    mut framings: ResMut<Framings>,
    mut eye: ResMut<Eye>,
    mut through: ResMut<LookThrough>,
) {
    if !history.is_changed() {
        return;
    }
    while let Some(framing) = framings.0.pop_if(|last| last.state > history.state()) {
        if *eye == framing.after && !through.locked {
            (*eye, through.camera) = framing.before;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::editor::history::{reset, undo};
    use crate::editor::viewport::Viewport;
    use crate::scene::PointLamp;
    use bevy::app::App;
    use bevy::ecs::system::RunSystemOnce;
    use bevy::transform::components::Transform;

    #[test]
    fn a_view_that_was_framed_after_a_step_comes_back_when_the_step_is_undone() {
        let mut app = headless_editor();
        app.init_resource::<Eye>()
            .init_resource::<LookThrough>()
            .init_resource::<Framings>()
            .init_resource::<Viewport>();
        let world = app.world_mut();
        let lamp = world.spawn((SceneId(1), PointLamp::default())).id();
        app.update();
        let world = app.world_mut();
        reset(world);
        let before = world.resource::<Eye>().clone();
        for (place, moved) in [(3e38, false), (5.0, true)] {
            let world = app.world_mut();
            world.get_mut::<Transform>(lamp).unwrap().translation = Vec3::splat(place);
            app.update();
            app.update();
            let world = app.world_mut();
            frame(world, true);
            let framed = world.resource::<Eye>().clone();
            assert_ne!(framed, before);
            assert!(framed.position().is_finite(), "{framed:?}");
            if moved {
                world.resource_mut::<Eye>().yaw += 1.0;
            }
            let left = world.resource::<Eye>().clone();
            assert!(undo(world).is_some());
            world.run_system_once(unframe).unwrap();
            let now = world.resource::<Eye>();
            assert_eq!(*now, if moved { left } else { before.clone() }, "{place}");
        }
    }

    #[test]
    fn a_framed_view_stays_where_the_oldest_steps_are_forgotten() {
        let mut app = headless_editor();
        app.init_resource::<Eye>()
            .init_resource::<LookThrough>()
            .init_resource::<Framings>()
            .init_resource::<Viewport>();
        let lamp = app.world_mut().spawn((SceneId(1), PointLamp::default()));
        let lamp = lamp.id();
        app.update();
        reset(app.world_mut());
        let step = |app: &mut App, x: f32| {
            let world = app.world_mut();
            world.get_mut::<Transform>(lamp).unwrap().translation.x = x;
            app.update();
            let world = app.world_mut();
            world.run_system_once(unframe).unwrap();
            world.resource::<History>().position()
        };
        assert_eq!(step(&mut app, 5.0), 1);
        assert_eq!(step(&mut app, 6.0), 2);
        frame(app.world_mut(), true);
        let framed = app.world().resource::<Eye>().clone();
        // One that takes more memory than all may.
        let mut history = app.world_mut().resource_mut::<History>();
        history.name_next("n".repeat(100 << 20));
        assert_eq!(step(&mut app, 7.0), 1, "the others are forgotten");
        assert_eq!(*app.world().resource::<Eye>(), framed);
        let world = app.world_mut();
        assert!(undo(world).is_some());
        world.run_system_once(unframe).unwrap();
        assert_eq!(*world.resource::<Eye>(), framed);
    }
}
