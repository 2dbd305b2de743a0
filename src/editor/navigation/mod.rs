//! Moving the view: around a pivot, sideways, nearer, flying; along the axes; through the scene's
//! cameras.
//!
//! The view is an [`Eye`]. While it looks through a camera of the scene, that camera's place and
//! projection are followed. Moving the view then leaves the camera, or, where it is locked to the
//! view, moves it.

mod commands;
mod drag;
mod eye;
mod framing;
mod lens;
mod place;
mod through;

pub(super) use commands::look_through;
pub(super) use drag::{ViewDrag, begin_drag, drag, end_gesture, wheel};
pub use eye::Eye;
pub(super) use framing::frame_points;
pub(super) use lens::{field_of_view, set_field_of_view, widen};

use super::command::AddCommands;
use super::document::SceneOpened;
use super::edits::{AddAt, ModelAdded};
use super::extent::{scene_extent, solid_extent};
use super::schedule::{Dispatch, EditorUpdate};
use super::viewport::Viewport;
use crate::scene::{Projection as SceneProjection, SceneCamera, SceneId};
use bevy::app::{App, Plugin, PostUpdate};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::observer::On;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::prelude::IntoScheduleConfigs;
use bevy::transform::TransformSystems;
use bevy::transform::components::Transform;
use bevy_egui::EguiPostUpdateSet;
use through::move_camera;

/// Frames after which a scene's places and sizes are known: one to resolve its meshes, one to place
/// them, one to measure them.
const SETTLE: u32 = 3;

/// Moves the view.
pub(super) struct NavigationPlugin;

impl Plugin for NavigationPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Eye>()
            .init_resource::<Eye>()
            .init_resource::<LookThrough>()
            .init_resource::<drag::FlySpeed>()
            .init_resource::<framing::Framings>()
            .add_observer(start)
            .add_observer(show_model)
            .add_commands(commands::commands())
            .add_systems(
                EditorUpdate,
                (
                    framing::unframe,
                    drag::fly,
                    through::see_through,
                    settle,
                    settle_model,
                    aim_additions,
                )
                    .chain()
                    .after(Dispatch),
            )
            .add_systems(
                PostUpdate,
                // The panels' pass draws over the view as it will be seen.
                place::place_view
                    .before(EguiPostUpdateSet::EndPass)
                    .before(TransformSystems::Propagate)
                    .before(bevy::camera::CameraUpdateSystems),
            );
    }
}

/// Which of the scene's cameras the view looks through.
#[derive(Resource, Clone, Debug, Default)]
pub struct LookThrough {
    /// `None`: freely.
    pub camera: Option<SceneId>,
    /// Moving the view moves the camera, instead of leaving it.
    pub locked: bool,
    /// What the view has taken over last.
    seen: Option<(SceneId, Transform, SceneProjection)>,
    /// Metres from an orthographic camera that is looked through to the end of the scene; 0 with others.
    reach: f32,
    /// A drag of the locked camera is under way.
    drags: bool,
    /// Frames until the scene that was opened last has its places and sizes.
    settles: u32,
    /// Frames until a model that was imported has them, and is framed.
    frames_model: u32,
}

/// For a scene that was just opened: looks through its first camera, or at all of it where it has
/// none.
fn start(
    _: On<SceneOpened>,
    cameras: Query<&SceneId, With<SceneCamera>>,
    mut through: ResMut<LookThrough>,
    mut eye: ResMut<Eye>,
) {
    let cameras = cameras.iter().filter(|id| !id.is_unassigned());
    *through = LookThrough {
        camera: cameras.min().copied(),
        locked: through.locked,
        settles: SETTLE,
        ..LookThrough::default()
    };
    *eye = Eye::default();
}

/// Once the scene that was opened has its places and sizes, the pivot goes into its middle. That of a scene with nothing
/// in it is the origin, where people begin: what is added goes there.
fn settle(world: &mut World) {
    let settles = world.resource::<LookThrough>().settles;
    if settles == 0 {
        return;
    }
    world.resource_mut::<LookThrough>().settles = settles - 1;
    if settles > 1 {
        return;
    }
    if scene_extent(world).is_none() {
        return;
    }
    if world.resource::<LookThrough>().camera.is_none() {
        framing::frame(world, true);
        return;
    }
    let (middle, radius) = match solid_extent(world) {
        Some(extent) => (extent.centre(), extent.radius()),
        None => (Vec3::ZERO, 0.0),
    };
    let mut eye = world.resource_mut::<Eye>();
    let forward = eye.forward();
    let ahead = (middle - eye.position()).dot(forward);
    if ahead > 1e-3 * radius && !eye.orthographic {
        let ahead = ahead.min(eye::DISTANCE[1]);
        eye.pivot = eye.position() + forward * ahead;
        eye.distance = ahead;
    }
}

/// A model that was imported is to be seen: where it stands somewhere else, and where the view is inside of it.
fn show_model(added: On<ModelAdded>, eye: Res<Eye>, mut through: ResMut<LookThrough>) {
    if !added.is_fitted || added.extent.contains(eye.position()) {
        through.frames_model = SETTLE;
    }
}

fn settle_model(world: &mut World) {
    let frames = world.resource::<LookThrough>().frames_model;
    if frames == 0 {
        return;
    }
    world.resource_mut::<LookThrough>().frames_model = frames - 1;
    if frames == 1 {
        framing::frame(world, false);
    }
}

fn aspect(world: &World) -> f32 {
    let size = world.resource::<Viewport>().rect.size();
    if size.min_element() > 0.0 {
        size.x / size.y
    } else {
        1.0
    }
}

/// Changes the view as a hand does: a locked camera comes along, another one is left.
pub(super) fn move_view(world: &mut World, change: impl FnOnce(&mut Eye)) {
    let through = world.resource::<LookThrough>().clone();
    let mut eye = world.resource_mut::<Eye>();
    let before = eye.clone();
    change(&mut eye);
    if *eye == before {
        return;
    }
    let eye = eye.clone();
    match through.camera {
        Some(id) if through.locked => move_camera(world, id, &eye),
        Some(_) => world.resource_mut::<LookThrough>().camera = None,
        None => {}
    }
}

/// What is added appears where the view looks, about a quarter as high as the view, at a place of few digits.
fn aim_additions(eye: Res<Eye>, mut at: ResMut<AddAt>) {
    let size = round_size(0.25 * eye.height());
    at.set_if_neq(AddAt {
        place: round_place(eye.pivot, size),
        size,
        view: eye.transform().rotation,
    });
}

/// The nearest of …, 0.1, 0.2, 0.5, 1, 2, 5, … that is not larger.
fn round_size(size: f32) -> f32 {
    let decade = 10_f32.powf(size.max(1e-6).log10().floor());
    let steps = [5.0, 2.0, 1.0].map(|step| step * decade);
    steps
        .into_iter()
        .find(|step| *step <= size * 1.000_1)
        .unwrap_or(decade)
}

/// The nearest place in steps of a hundredth of a size. Far away floats are farther apart than those.
fn round_place(place: Vec3, size: f32) -> Vec3 {
    let per_step = f64::from(100.0 / size);
    let round = |x: f32| ((f64::from(x) * per_step).round() / per_step) as f32;
    Vec3::from_array(place.to_array().map(round))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_added_has_a_place_of_few_digits() {
        let near = round_place(Vec3::new(1.040_17, 0.752_7, -1.8e-8), 0.2);
        assert_eq!(near.abs(), Vec3::new(1.04, 0.752, 0.0));
        let far = Vec3::new(1.3e9, -7.7e11, 0.0);
        assert_eq!(round_place(far, 0.5), far);
    }

    #[test]
    fn in_a_new_scene_things_are_added_in_its_middle_at_their_own_size() {
        let mut app = crate::editor::headless_editor();
        app.init_resource::<Eye>()
            .init_resource::<LookThrough>()
            .init_resource::<framing::Framings>()
            .init_resource::<Viewport>()
            .add_observer(start)
            .add_systems(
                EditorUpdate,
                (through::see_through, settle, aim_additions)
                    .chain()
                    .after(Dispatch),
            );
        crate::io::open_new(app.world_mut());
        crate::editor::document::adopt(app.world_mut(), "new", None);
        for _ in 0..=SETTLE {
            app.update();
        }
        let at = *app.world().resource::<AddAt>();
        assert_eq!(at.size, 1.0);
        let above_the_cube = Vec3::new(0.0, 0.9, 0.0);
        assert!(at.place.distance(above_the_cube) < 0.3, "{at:?}");
    }

    #[test]
    fn what_is_added_has_a_round_size() {
        for (size, round) in [
            (0.0123, 0.01),
            (0.3, 0.2),
            (0.99, 0.5),
            (1.0, 1.0),
            (7.0, 5.0),
        ] {
            let found = round_size(size);
            assert!((found - round).abs() < 1e-4 * round, "{size} gives {found}");
        }
    }
}
