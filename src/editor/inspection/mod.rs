//! What the tracer did, over the scene and in numbers: the lines of the room `inspect`, the debug
//! ray with the list of its rays, and one ray's way through the trees, step by step.
//!
//! | module | does |
//! |---|---|
//! | [`debug_ray`] | a pixel, traced again with every ray written down |
//! | [`draw`], [`drawn_set`] | each system's lines as one set of retained gizmos |
//! | [`lit`] | what is selected, in front of them |
//! | [`hover`] | which line is under the pointer |
//! | [`list`] | the rays as a table: sorted, filtered, folded |
//! | [`names`] | learns what objects, lights and materials are called |
//! | [`json`] | all of it as text |
//! | [`questions`] | three ready-made choices of what is drawn |
//! | [`choice`] | which ray and which node are meant, and what keys do to them |
//!
//! Here are the facts and what is drawn in the view; the panels that show them are in `panels/rays`.

pub(super) mod choice;
pub(super) mod debug_ray;
mod draw;
mod drawn_set;
pub(super) mod hover;
pub(super) mod json;
pub(super) mod list;
pub(super) mod lit;
mod names;
mod questions;

pub(super) use choice::{Inspected, shoot_middle, shoot_pixel};
pub(super) use debug_ray::{DebugRay, Which};
pub(super) use draw::Drawings;
pub(super) use drawn_set::{DrawnSet, Source};
pub(super) use hover::Hovered;
pub(super) use questions::{preset_settings, show_preset};

use super::command::AddCommands;
use super::document::SceneOpened;
use super::schedule::EditorUpdate;
use super::viewport::traced_render;
use crate::inspect::{InspectSettings, Names};
use crate::sync::SyncSystems;
use crate::trace::Camera;
use crate::view::{TracedRender, TracedView, traced_camera};
use bevy::app::{App, Plugin, PostUpdate};
use bevy::camera::{self, Projection};
use bevy::ecs::observer::On;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy::prelude::IntoScheduleConfigs;
use bevy::transform::components::GlobalTransform;

/// The part that needs no window: the debug ray, the choice, the stepper.
pub(super) struct RaysPlugin;

impl Plugin for RaysPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<InspectSettings>()
            .init_resource::<super::notice::Notices>()
            .init_resource::<DebugRay>()
            .init_resource::<Inspected>()
            .init_resource::<Names>()
            .add_observer(forget_scene)
            .add_observer(choice::let_go)
            .add_commands(choice::commands())
            .add_commands(debug_ray::commands())
            .add_commands(questions::commands())
            .add_systems(
                PostUpdate,
                (
                    names::learn,
                    debug_ray::trace_again,
                    choice::follow,
                    choice::play,
                )
                    .chain()
                    .after(SyncSystems),
            );
    }
}

/// The pixel and the entities that were picked are of another scene.
fn forget_scene(
    _: On<SceneOpened>,
    mut ray: ResMut<DebugRay>,
    mut inspect: ResMut<InspectSettings>,
) {
    ray.clear();
    inspect.boxes.object = 0;
    inspect.normals.object = 0;
    inspect.pattern.light = 0;
}

/// All of it, in a window.
pub(super) struct InspectionPlugin;

impl Plugin for InspectionPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(RaysPlugin)
            .init_resource::<Drawings>()
            .init_resource::<Hovered>()
            .add_systems(
                EditorUpdate,
                hover::find_hovered.after(super::pointer::use_pointer),
            )
            .add_systems(
                PostUpdate,
                (draw::draw_inspection, lit::draw_lit)
                    .chain()
                    .after(choice::play),
            );
    }
}

/// What the view's camera consists of.
pub(super) type Seen = (
    &'static TracedRender,
    &'static TracedView,
    &'static camera::Camera,
    &'static GlobalTransform,
    &'static Projection,
);

/// From where lines are looked at, and the picture's size in pixels: as the view traces it, and where
/// it traces nothing, as Bevy's camera shows it.
pub(super) fn seen_from(
    render: &TracedRender,
    view: &TracedView,
    camera: &camera::Camera,
    place: &GlobalTransform,
    projection: &Projection,
) -> Option<(Camera, UVec2)> {
    if let Some((_, camera, settings)) = render.subject() {
        return Some((camera.clone(), settings.size));
    }
    let size = camera.physical_viewport_size()? / view.pixel_size.max(1);
    let camera = traced_camera(place, projection, None)?;
    (size.min_element() > 0).then_some((camera, size))
}

/// The camera and the size of the picture that the view traces; `None` while it traces none.
pub(super) fn view_of(world: &World) -> Option<(Camera, UVec2)> {
    let (_, camera, settings) = traced_render(world)?.subject()?;
    Some((camera.clone(), settings.size))
}

#[cfg(test)]
mod tests;
