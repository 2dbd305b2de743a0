//! The commands of the view.

use super::drag::{begin_gesture, end_gesture};
use super::eye::FARTHEST_BACK;
use super::framing::frame;
use super::{Eye, LookThrough, move_camera, move_view};
use crate::editor::action::{Addition, Axis};
use crate::editor::command::{Command, Over, State, commands};
use crate::editor::edits::{self, AddAt};
use crate::editor::extent::scene_extent;
use crate::editor::history::History;
use crate::editor::notice::Notices;
use crate::editor::selection::Selection;
use crate::editor::viewport::{EditorCamera, Show, Viewport, traced_view, traced_view_mut};
use crate::scene::{SceneCamera, SceneId};
use crate::view::TracedRender;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::math::Vec3;

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "view.raster" "Raster view" ["1"] "Bevy's renderer: quick, and an approximation"
            => |world| show(world, Show::Raster); menu("View", 0); button("show", "Raster"); state(|world| shows(world, Show::Raster)),
        "view.traced" "Traced view" ["2"] "The ray tracer's picture"
            => |world| show(world, Show::Traced); menu("View", 0); button("show", "Traced"); state(|world| shows(world, Show::Traced)),
        "view.split" "Split view" ["3"] "Raster on the left, traced on the right; drag the line between"
            => |world| show(world, Show::Split); menu("View", 0); button("show", "Split"); state(|world| shows(world, Show::Split)),
        "view.pause" "Pause or go on" ["P"] "The traced view stands still, and keeps what it has"
            => toggle_pause; menu("View", 1); button("traced", "⏸"); state(is_paused),
        "view.restart" "Restart" ["Ctrl+R"] "Renders the traced view from its first sample again"
            => restart; menu("View", 1); button("traced", "⟲"),
        "view.frame-selected" "Frame selected" ["F", "Num Decimal"] "Moves the view so that the selection fills it; the whole scene where nothing is selected"
            => |world| frame(world, false); menu("View", 2); over(&[Over::Entity]),
        "view.frame-all" "Frame all" ["Home"] "Moves the view so that the whole scene fills it"
            => |world| frame(world, true); menu("View", 2); over(&[Over::Nothing]),
        "view.projection" "Perspective or orthographic" ["5", "Num 5"] "Orthographic: far things keep their size"
            => toggle_projection; menu("View", 2),
        "view.front" "Front view" ["Num 1"] "Looks along -Z, without perspective"
            => |world| look_along(world, Axis::Front); menu("View/Look along", 2),
        "view.back" "Back view" ["Ctrl+Num 1"] "Looks along +Z, without perspective"
            => |world| look_along(world, Axis::Back); menu("View/Look along", 2),
        "view.right" "Right view" ["Num 3"] "Looks along -X, without perspective"
            => |world| look_along(world, Axis::Right); menu("View/Look along", 2),
        "view.left" "Left view" ["Ctrl+Num 3"] "Looks along +X, without perspective"
            => |world| look_along(world, Axis::Left); menu("View/Look along", 2),
        "view.top" "Top view" ["Num 7"] "Looks down, without perspective"
            => |world| look_along(world, Axis::Top); menu("View/Look along", 2),
        "view.bottom" "Bottom view" ["Ctrl+Num 7"] "Looks up, without perspective"
            => |world| look_along(world, Axis::Bottom); menu("View/Look along", 2),
        "view.camera" "Look through the camera" ["0", "Num 0"] "Through the selected camera, or the first one; again: freely. Moving the view leaves the camera"
            => toggle_camera; menu("View", 3); state(has_a_camera),
        "view.lock" "Lock the camera to the view" ["Ctrl+Shift+L"] "Moving the view moves the camera that it looks through"
            => toggle_lock; menu("View", 3); state(|world| State::switch(world.resource::<LookThrough>().locked)),
        "view.keep" "Keep this view as a camera" ["Ctrl+B"] "Adds a camera entity where the view stands"
            => add_bookmark; menu("View", 3); over(&[Over::Nothing]),
    }
}

fn show(world: &mut World, show: Show) {
    world.resource_mut::<Viewport>().show = show;
}

fn shows(world: &World, show: Show) -> State {
    State::switch(world.resource::<Viewport>().show == show)
}

fn toggle_pause(world: &mut World) {
    if let Some(mut view) = traced_view_mut(world) {
        view.paused = !view.paused;
    }
}

fn is_paused(world: &World) -> State {
    State::switch(traced_view(world).is_some_and(|view| view.paused))
}

fn restart(world: &mut World) {
    let mut renders = world.query_filtered::<&mut TracedRender, With<EditorCamera>>();
    for mut render in renders.iter_mut(world) {
        render.restart();
    }
}

fn toggle_projection(world: &mut World) {
    begin_gesture(world);
    let back = back(world);
    move_view(world, |eye| {
        eye.orthographic = !eye.orthographic;
        eye.back = back;
    });
    end_gesture(world);
}

fn has_a_camera(world: &World) -> State {
    let cameras = world.try_query_filtered::<(), With<SceneCamera>>();
    let any = cameras.is_some_and(|mut cameras| cameras.iter(world).next().is_some());
    let is_through = world.resource::<LookThrough>().camera.is_some();
    State {
        on: Some(is_through),
        ..State::when(
            any,
            "The scene has no camera; Ctrl+B adds one where the view stands.",
        )
    }
}

fn toggle_lock(world: &mut World) {
    let mut through = world.resource_mut::<LookThrough>();
    through.locked = !through.locked;
    let text = if through.locked {
        "Moving the view moves the camera that it looks through."
    } else {
        "Moving the view leaves the camera that it looks through."
    };
    world.resource_mut::<Notices>().tell(text);
}

/// How far an orthographic view has to stand back to have all of the scene before it.
pub(super) fn back(world: &mut World) -> f32 {
    let pivot = world.resource::<Eye>().pivot;
    farthest(world, pivot)
}

/// Metres from a point to what of the scene is farthest, at the most.
pub(super) fn farthest(world: &mut World, from: Vec3) -> f32 {
    let farthest = scene_extent(world).map_or(0.0, |extent| {
        extent.radius() + extent.centre().distance(from)
    });
    farthest.min(FARTHEST_BACK)
}

fn look_along(world: &mut World, axis: Axis) {
    let back = back(world);
    // Leaves a camera even where it is locked: an axis view is for looking, not for taking pictures.
    world.resource_mut::<LookThrough>().camera = None;
    let mut eye = world.resource_mut::<Eye>();
    eye.look_along(axis);
    eye.back = back;
}

/// Looks through this camera; `None`: freely again. An editor without a view looks at nothing.
pub(in crate::editor) fn look_through(world: &mut World, camera: Option<SceneId>) {
    let Some(mut through) = world.get_resource_mut::<LookThrough>() else {
        return;
    };
    through.camera = camera;
    through.seen = None;
    if camera.is_none() {
        let mut eye = world.resource_mut::<Eye>();
        eye.roll = 0.0;
    }
}

/// Through the selected camera, or the first one; freely where it was looked through already.
fn toggle_camera(world: &mut World) {
    let mut cameras = world.query_filtered::<&SceneId, With<SceneCamera>>();
    let cameras: Vec<SceneId> = cameras.iter(world).copied().collect();
    let selected = world.resource::<Selection>().ids().iter().rev();
    let chosen = selected
        .copied()
        .find(|id| cameras.contains(id))
        .or_else(|| cameras.iter().min().copied());
    let now = world.resource::<LookThrough>().camera;
    look_through(world, chosen.filter(|_| now != chosen));
}

fn add_bookmark(world: &mut World) {
    let eye = world.resource::<Eye>().clone();
    let Some(id) = edits::add(world, &Addition::Camera, AddAt::default()) else {
        return;
    };
    move_camera(world, id, &eye);
    edits::select(world, vec![id]);
    world.resource_mut::<History>().name_next("Keep this view");
    look_through(world, Some(id));
}
