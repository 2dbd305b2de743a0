//! Moving the view: around a pivot, sideways, nearer, flying; along the axes; through the scene's
//! cameras.
//!
//! The view is an [`Eye`]. While it looks through a camera of the scene, that camera's place and
//! projection are followed. Moving the view then leaves the camera, or, where it is locked to the
//! view, moves it.

mod eye;
mod lens;
mod obey;

pub use eye::Eye;
pub(super) use lens::{field_of_view, set_field_of_view, widen};

use super::edits::{self, AddAt};
use super::extent::{scene_extent, world_from_entity, world_from_parent};
use super::history::Gesture;
use super::pointer::PointerUse;
use super::schedule::EditorUpdate;
use super::viewport::{EditorCamera, Viewport};
use crate::scene::{Projection as SceneProjection, SceneCamera, SceneId};
use crate::view::TracedView;
use bevy::app::{App, Plugin, PostUpdate};
use bevy::camera::{
    Camera, OrthographicProjection, PerspectiveProjection, Projection, ScalingMode,
};
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Res, ResMut, Single};
use bevy::ecs::world::World;
use bevy::input::ButtonInput;
use bevy::input::keyboard::KeyCode;
use bevy::math::{Vec2, Vec3};
use bevy::prelude::IntoScheduleConfigs;
use bevy::time::Time;
use bevy::transform::TransformSystems;
use bevy::transform::components::Transform;
use bevy::window::{PrimaryWindow, Window};

/// How much nearer one notch of the wheel goes.
const NOTCH: f32 = 0.85;
/// Frames after which a scene's places and sizes are known: one to resolve its meshes, one to place
/// them, one to measure them.
const SETTLE: u32 = 3;
/// How much faster Shift flies.
const FAST: f32 = 4.0;
/// How far the pointer moves over the view before what is rendered first follows it, as a part of
/// the view's size.
const FOCUS_STEP: f32 = 0.02;

/// Moves the view.
pub(super) struct NavigationPlugin;

impl Plugin for NavigationPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Eye>()
            .init_resource::<Eye>()
            .init_resource::<LookThrough>()
            .init_resource::<FlySpeed>()
            .add_systems(
                EditorUpdate,
                (obey::obey, fly, see_through, settle, aim_additions)
                    .chain()
                    .after(super::pointer::use_pointer),
            )
            .add_systems(
                PostUpdate,
                place_view
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
    /// A drag of the locked camera is under way.
    drags: bool,
    /// Frames until the scene that was opened last has its places and sizes.
    settles: u32,
}

/// How fast flying is, as a factor: the wheel changes it while flying.
#[derive(Resource)]
pub(super) struct FlySpeed(f32);

impl Default for FlySpeed {
    fn default() -> Self {
        Self(1.0)
    }
}

/// For a scene that was just opened: looks through its first camera, or at all of it where it has
/// none. Does nothing in an app that has no view.
pub fn start(world: &mut World) {
    if !world.contains_resource::<Eye>() {
        return;
    }
    let mut cameras = world.query_filtered::<&SceneId, With<SceneCamera>>();
    let cameras = cameras.iter(world).filter(|id| !id.is_unassigned());
    let first = cameras.min().copied();
    *world.resource_mut::<LookThrough>() = LookThrough {
        camera: first,
        locked: world.resource::<LookThrough>().locked,
        settles: SETTLE,
        ..LookThrough::default()
    };
    *world.resource_mut::<Eye>() = Eye::default();
}

/// Once the scene that was opened has its places and sizes, the pivot goes into its middle.
fn settle(world: &mut World) {
    let settles = world.resource::<LookThrough>().settles;
    if settles == 0 {
        return;
    }
    world.resource_mut::<LookThrough>().settles = settles - 1;
    if settles > 1 {
        return;
    }
    let Some(extent) = scene_extent(world) else {
        return;
    };
    if world.resource::<LookThrough>().camera.is_none() {
        obey::frame(world, true);
        return;
    }
    let mut eye = world.resource_mut::<Eye>();
    let forward = eye.forward();
    let ahead = (extent.centre() - eye.position()).dot(forward);
    if ahead > 1e-3 * extent.radius() && !eye.orthographic {
        eye.pivot = eye.position() + forward * ahead;
        eye.distance = ahead;
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

/// Puts a camera of the scene where the eye is.
fn move_camera(world: &mut World, id: SceneId, eye: &Eye) {
    let Some(entity) = edits::scene_entity(world, id) else {
        return;
    };
    let parent = world_from_parent(world, entity);
    let placed = eye.transform();
    let (_, parent_rotation, _) = parent.to_scale_rotation_translation();
    let translation = parent
        .affine()
        .inverse()
        .transform_point3(placed.translation);
    let rotation = (parent_rotation.inverse() * placed.rotation).normalize();
    if !(translation.is_finite() && rotation.is_finite()) {
        return;
    }
    if let Some(mut transform) = world.get_mut::<Transform>(entity) {
        let wanted = Transform {
            translation,
            rotation,
            scale: transform.scale,
        };
        if *transform != wanted {
            *transform = wanted;
        }
    }
    let projection = scene_projection(eye);
    if let Some(mut camera) = world.get_mut::<SceneCamera>(entity)
        && !same_projection(&camera.projection, &projection)
    {
        camera.projection = projection;
    }
}

fn scene_projection(eye: &Eye) -> SceneProjection {
    if eye.orthographic {
        SceneProjection::Orthographic {
            height: eye.height(),
        }
    } else {
        SceneProjection::Perspective { fov_y: eye.fov_y }
    }
}

/// The same but for rounding.
fn same_projection(a: &SceneProjection, b: &SceneProjection) -> bool {
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-5 * a.abs().max(b.abs());
    match (a, b) {
        (SceneProjection::Perspective { fov_y: a }, SceneProjection::Perspective { fov_y: b }) => {
            near(*a, *b)
        }
        (
            SceneProjection::Orthographic { height: a },
            SceneProjection::Orthographic { height: b },
        ) => near(*a, *b),
        _ => false,
    }
}

/// What is done with the view when it is dragged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ViewDrag {
    /// Around the pivot.
    Orbit,
    /// Sideways.
    Pan,
    /// Nearer and further.
    Dolly,
    /// Looking around; keys fly.
    Fly,
}

/// A drag of the view begins.
pub(super) fn begin_drag(world: &mut World) {
    begin_gesture(world);
    // The view turns around what is in its middle.
    let ahead = {
        let eye = world.resource::<Eye>();
        (eye.position(), eye.forward(), eye.orthographic)
    };
    let free = world.resource::<LookThrough>().camera.is_none();
    if let (true, (from, forward, false)) = (free, ahead)
        && let Some(hit) = super::pick::along(world, from, forward)
    {
        let distance = (hit - from).dot(forward);
        let mut eye = world.resource_mut::<Eye>();
        if distance > 1e-3 * eye.distance && distance < 1e3 * eye.distance {
            eye.pivot = from + forward * distance;
            eye.distance = distance;
        }
    }
}

/// A locked camera's drag is one step.
fn begin_gesture(world: &mut World) {
    let through = world.resource::<LookThrough>();
    let (Some(id), false) = (through.camera.filter(|_| through.locked), through.drags) else {
        return;
    };
    if world.resource::<Gesture>().active() {
        return;
    }
    let name = edits::name_of(world, id);
    world
        .resource_mut::<Gesture>()
        .begin(format!("Move {name}"));
    world.resource_mut::<LookThrough>().drags = true;
}

fn end_gesture(world: &mut World) {
    if world.resource::<LookThrough>().drags {
        world.resource_mut::<LookThrough>().drags = false;
        world.resource_mut::<Gesture>().end();
    }
}

/// The pointer went on by `delta`, in logical pixels.
pub(super) fn drag(world: &mut World, kind: ViewDrag, delta: Vec2) {
    let height = world.resource::<Viewport>().rect.height().max(1.0);
    let delta = delta / height;
    move_view(world, |eye| match kind {
        ViewDrag::Orbit => eye.orbit(delta),
        ViewDrag::Pan => eye.pan(delta),
        ViewDrag::Dolly => {
            let pivot = eye.pivot;
            eye.zoom((2.0 * delta.y).exp(), pivot);
        }
        ViewDrag::Fly => eye.look(delta),
    });
}

/// The drag is over.
pub(super) fn end_drag(world: &mut World) {
    end_gesture(world);
}

/// The wheel was turned by so many notches over this place of the window.
pub(super) fn wheel(world: &mut World, at: Vec2, notches: f32) {
    if matches!(
        world.resource::<PointerUse>(),
        PointerUse::View(ViewDrag::Fly)
    ) {
        let mut speed = world.resource_mut::<FlySpeed>();
        speed.0 = (speed.0 * NOTCH.powf(-notches)).clamp(0.01, 100.0);
        return;
    }
    let place = world.resource::<Viewport>().place(at);
    let ndc = Vec2::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y);
    let aspect = aspect(world);
    let hit = super::pick::at(world, at).map(|picked| picked.point);
    let dragging = world.resource::<LookThrough>().drags;
    begin_gesture(world);
    move_view(world, |eye| {
        let toward = hit.unwrap_or_else(|| eye.on_pivot_plane(ndc, aspect));
        eye.zoom(NOTCH.powf(notches), toward);
    });
    if !dragging {
        end_gesture(world);
    }
}

/// Flies while the right button is held.
fn fly(world: &mut World) {
    if !matches!(
        world.resource::<PointerUse>(),
        PointerUse::View(ViewDrag::Fly)
    ) {
        return;
    }
    let keys = world.resource::<ButtonInput<KeyCode>>();
    let pressed = |key| f32::from(u8::from(keys.pressed(key)));
    let direction = Vec3::new(
        pressed(KeyCode::KeyD) - pressed(KeyCode::KeyA),
        pressed(KeyCode::KeyE) - pressed(KeyCode::KeyQ),
        pressed(KeyCode::KeyS) - pressed(KeyCode::KeyW),
    );
    if direction == Vec3::ZERO {
        return;
    }
    let fast = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    let seconds = world.resource::<Time>().delta_secs().min(0.1);
    let factor = world.resource::<FlySpeed>().0 * if fast { FAST } else { 1.0 };
    move_view(world, |eye| {
        let step = direction.normalize() * eye.distance * factor * seconds;
        eye.fly(step);
    });
}

/// Follows the camera that is looked through.
fn see_through(world: &mut World) {
    let Some(id) = world.resource::<LookThrough>().camera else {
        return;
    };
    let found = edits::scene_entity(world, id).and_then(|entity| {
        let projection = world.get::<SceneCamera>(entity)?.projection;
        let (_, rotation, translation) =
            world_from_entity(world, entity)?.to_scale_rotation_translation();
        let finite = rotation.is_finite() && translation.is_finite();
        finite.then(|| {
            let place = Transform::from_translation(translation).with_rotation(rotation);
            (id, place, projection)
        })
    });
    let Some(seen) = found else {
        world.resource_mut::<LookThrough>().camera = None;
        return;
    };
    if world.resource::<LookThrough>().seen.as_ref() == Some(&seen) {
        return;
    }
    let (_, place, projection) = seen;
    let before = world.resource::<Eye>().clone();
    // The pivot stays as far ahead as it was, or where the last one was passed.
    let ahead = (before.pivot - place.translation).dot(place.rotation * Vec3::NEG_Z);
    let distance = if ahead > 1e-3 { ahead } else { before.distance };
    let mut eye = Eye::from_transform(&place, distance);
    eye.fov_y = before.fov_y;
    match projection {
        SceneProjection::Perspective { fov_y } => eye.fov_y = fov_y,
        SceneProjection::Orthographic { height } => {
            // The height that it has is that of the pivot's plane.
            eye.orthographic = true;
            eye.distance = 0.5 * height / (0.5 * eye.fov_y).tan();
            eye.pivot = place.translation + eye.forward() * eye.distance;
        }
    }
    *world.resource_mut::<Eye>() = eye;
    world.resource_mut::<LookThrough>().seen = Some(seen);
}

/// What is added appears where the view looks, about a quarter as high as the view.
fn aim_additions(eye: Res<Eye>, mut at: ResMut<AddAt>) {
    let wanted = AddAt {
        place: eye.pivot,
        size: round_size(0.25 * eye.height()),
    };
    if *at != wanted {
        *at = wanted;
    }
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

/// Gives the camera of the window the place and projection of the eye.
fn place_view(
    eye: Res<Eye>,
    through: Res<LookThrough>,
    viewport: Res<Viewport>,
    window: Single<&Window, With<PrimaryWindow>>,
    camera: Single<(&mut Transform, &mut Projection, &mut TracedView, &Camera), With<EditorCamera>>,
) {
    let (mut transform, mut projection, mut view, camera) = camera.into_inner();
    let exact = through.camera.and(through.seen.as_ref());
    let wanted = exact.map_or_else(|| eye.transform(), |(_, place, _)| *place);
    if *transform != wanted {
        *transform = wanted;
    }
    set_projection(&mut projection, &eye, camera);
    if view.optics_of != through.camera {
        view.optics_of = through.camera;
    }
    let pointer = window.cursor_position().filter(|_| viewport.hovered);
    let focus = pointer.map_or(Vec2::splat(0.5), |at| viewport.place(at));
    if (focus - view.focus).abs().max_element() > FOCUS_STEP {
        view.focus = focus;
    }
}

fn set_projection(projection: &mut bevy::prelude::Mut<Projection>, eye: &Eye, camera: &Camera) {
    if eye.orthographic {
        let height = eye.height();
        let far = eye.distance + 2.0 * eye.back + 1.0;
        let same = matches!(&**projection, Projection::Orthographic(p)
            if p.far == far && matches!(p.scaling_mode,
                ScalingMode::FixedVertical { viewport_height } if viewport_height == height));
        if same {
            return;
        }
        let mut orthographic = OrthographicProjection {
            near: 0.0,
            far,
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: height,
            },
            ..OrthographicProjection::default_3d()
        };
        if let Some(size) = camera.logical_viewport_size() {
            bevy::camera::CameraProjection::update(&mut orthographic, size.x, size.y);
        }
        **projection = Projection::Orthographic(orthographic);
        return;
    }
    // As near as the pivot allows: depth has to last for what is far.
    let near = (0.01 * eye.distance).clamp(1e-4, 0.1);
    let same = matches!(&**projection, Projection::Perspective(p)
        if p.fov == eye.fov_y && p.near == near);
    if !same {
        let mut perspective = PerspectiveProjection {
            fov: eye.fov_y,
            near,
            ..PerspectiveProjection::default()
        };
        if let Some(size) = camera.logical_viewport_size() {
            bevy::camera::CameraProjection::update(&mut perspective, size.x, size.y);
        }
        **projection = Projection::Perspective(perspective);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
