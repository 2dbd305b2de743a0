//! What the actions of the view do.

use super::drag::{begin_gesture, end_gesture};
use super::framing::frame;
use super::{Eye, LookThrough, move_camera, move_view};
use crate::editor::action::{Action, Addition, Axis};
use crate::editor::edits::{self, AddAt};
use crate::editor::extent::scene_extent;
use crate::editor::history::History;
use crate::editor::notice::Notices;
use crate::editor::selection::Selection;
use crate::editor::viewport::{EditorCamera, Show, Viewport};
use crate::scene::{SceneCamera, SceneId};
use crate::view::{TracedRender, TracedView};
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::query::With;
use bevy::ecs::system::Local;
use bevy::ecs::world::World;

/// Does what was asked for of the view.
pub(super) fn obey(world: &mut World, mut cursor: Local<MessageCursor<Action>>) {
    let messages = world.resource::<Messages<Action>>();
    let actions: Vec<Action> = cursor.read(messages).cloned().collect();
    for action in actions {
        match action {
            Action::FrameSelected => frame(world, false),
            Action::FrameAll => frame(world, true),
            Action::LookAlong(axis) => look_along(world, axis),
            Action::ToggleProjection => {
                begin_gesture(world);
                let back = back(world);
                move_view(world, |eye| {
                    eye.orthographic = !eye.orthographic;
                    eye.back = back;
                });
                end_gesture(world);
            }
            Action::LookThrough(camera) => look_through(world, camera),
            Action::ToggleCamera => toggle_camera(world),
            Action::ToggleLock => {
                let mut through = world.resource_mut::<LookThrough>();
                through.locked = !through.locked;
                let text = if through.locked {
                    "Moving the view moves the camera that it looks through."
                } else {
                    "Moving the view leaves the camera that it looks through."
                };
                world.resource_mut::<Notices>().tell(text);
            }
            Action::AddBookmark => add_bookmark(world),
            Action::ShowRaster => show(world, Show::Raster),
            Action::ShowTraced => show(world, Show::Traced),
            Action::ShowSplit => show(world, Show::Split),
            Action::TogglePause => {
                let mut views = world.query_filtered::<&mut TracedView, With<EditorCamera>>();
                for mut view in views.iter_mut(world) {
                    view.paused = !view.paused;
                }
            }
            Action::Restart => {
                let mut renders = world.query_filtered::<&mut TracedRender, With<EditorCamera>>();
                for mut render in renders.iter_mut(world) {
                    render.restart();
                }
            }
            _ => {}
        }
    }
}

fn show(world: &mut World, show: Show) {
    world.resource_mut::<Viewport>().show = show;
}

/// How far an orthographic view has to stand back to have all of the scene before it.
pub(super) fn back(world: &mut World) -> f32 {
    let pivot = world.resource::<Eye>().pivot;
    scene_extent(world).map_or(0.0, |extent| {
        extent.radius() + extent.centre().distance(pivot)
    })
}

fn look_along(world: &mut World, axis: Axis) {
    let back = back(world);
    // Leaves a camera even where it is locked: an axis view is for looking, not for taking pictures.
    world.resource_mut::<LookThrough>().camera = None;
    let mut eye = world.resource_mut::<Eye>();
    eye.look_along(axis);
    eye.back = back;
}

fn look_through(world: &mut World, camera: Option<SceneId>) {
    let mut through = world.resource_mut::<LookThrough>();
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
    let Some(chosen) = chosen else {
        let text = "The scene has no camera; Ctrl+B adds one where the view stands.";
        world.resource_mut::<Notices>().tell(text);
        return;
    };
    let now = world.resource::<LookThrough>().camera;
    look_through(world, (now != Some(chosen)).then_some(chosen));
}

fn add_bookmark(world: &mut World) {
    let eye = world.resource::<Eye>().clone();
    let Some(id) = edits::add(world, &Addition::Camera, AddAt::default()) else {
        return;
    };
    move_camera(world, id, &eye);
    world.resource_mut::<History>().name_next("Keep this view");
    look_through(world, Some(id));
}
