//! Bevy's gizmo on a stand-in for the selection: where that stands, and when the gizmo has the pointer.

use super::super::edits::{roots_of, scene_entity};
use super::super::extent::{own_extent, world_from_entity};
use super::super::navigation::{Eye, LookThrough};
use super::super::pointer::PointerUse;
use super::super::selection::Selection;
use super::super::viewport::Viewport;
use super::drag::GizmoDrag;
use super::grips::{self, Grip};
use super::{ActiveGrip, Tool, Tools};
use crate::scene::SceneId;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::system::{Commands, Query, Res, ResMut};
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::{
    TransformGizmoFocus, TransformGizmoMode, TransformGizmoSettings, TransformGizmoSpace,
    TransformGizmoState,
};
use bevy::math::{Quat, Vec3};
use bevy::transform::components::Transform;

/// Length of an arrow in logical pixels.
const ARROW: f32 = 90.0;
/// How near to an arrow or ring the pointer has to be, in logical pixels.
const REACH: f32 = 12.0;

/// Marks the entity that the gizmo moves instead of the scene's.
#[derive(Component)]
pub(super) struct StandIn;

pub(super) fn spawn_stand_in(mut commands: Commands) {
    commands.spawn((StandIn, Transform::default()));
}

/// Whether the pointer may hover over and drag the gizmo.
pub(super) fn has_the_pointer(
    state: Res<TransformGizmoState>,
    pointer: Res<PointerUse>,
    viewport: Res<Viewport>,
) -> bool {
    state.active
        || matches!(*pointer, PointerUse::Gizmo)
        || matches!(*pointer, PointerUse::Free) && viewport.hovered
}

/// What the gizmo does not look at it does not hover over either.
pub(super) fn forget_hover(
    mut state: ResMut<TransformGizmoState>,
    pointer: Res<PointerUse>,
    viewport: Res<Viewport>,
) {
    let looks = matches!(*pointer, PointerUse::Gizmo)
        || matches!(*pointer, PointerUse::Free) && viewport.hovered;
    if !state.active && !looks && state.hovered_axis.is_some() {
        state.hovered_axis = None;
    }
}

/// Hands the tools' settings to the gizmo, which keeps its size on the screen.
pub(super) fn set_up(
    tools: Res<Tools>,
    eye: Res<Eye>,
    viewport: Res<Viewport>,
    stand_in: Query<&Transform, With<StandIn>>,
    mut settings: ResMut<TransformGizmoSettings>,
) {
    settings.mode = match tools.tool {
        Tool::Move => TransformGizmoMode::Translate,
        Tool::Turn => TransformGizmoMode::Rotate,
        Tool::Scale => TransformGizmoMode::Scale,
    };
    settings.space = if tools.local {
        TransformGizmoSpace::Local
    } else {
        TransformGizmoSpace::World
    };
    settings.snap_translate = tools.step();
    settings.snap_rotate = tools.snap.then_some(tools.turn_step);
    settings.snap_scale = tools.snap.then_some(tools.scale_step);
    settings.axis_hit_distance = REACH;
    settings.confine_cursor = false;
    // Its size is this factor times its distance from the camera.
    let part = ARROW / viewport.rect.height().max(1.0);
    let size_over_distance = if eye.orthographic {
        let distance = stand_in.single().map_or(eye.distance, |place| {
            place.translation.distance(eye.position())
        });
        eye.height() / distance.max(f32::MIN_POSITIVE)
    } else {
        2.0 * (0.5 * eye.fov_y).tan()
    };
    settings.screen_scale_factor = part * size_over_distance;
}

/// The selected entities that can be moved: those that stand somewhere, and whose parents are not
/// moved already.
pub(super) fn movable(world: &World) -> Vec<(SceneId, Entity)> {
    let through = world.resource::<LookThrough>().camera;
    roots_of(world, world.resource::<Selection>().ids())
        .into_iter()
        .filter(|id| through != Some(*id))
        .filter_map(|id| Some((id, scene_entity(world, id)?)))
        .filter(|(_, entity)| world.get::<Transform>(*entity).is_some())
        .collect()
}

/// What an entity turns around: where it stands, or its middle where it lies elsewhere, as a wall
/// does whose corners are given in the scene's space.
pub(super) fn pivot(world: &World, entity: Entity) -> Option<Vec3> {
    let place = world_from_entity(world, entity)?.translation();
    let Some(extent) = world.get_entity(entity).ok().and_then(own_extent) else {
        return Some(place);
    };
    let slack = Vec3::splat(0.05 * extent.radius());
    let inside = place.cmpge(extent.least - slack).all() && place.cmple(extent.most + slack).all();
    Some(if inside { place } else { extent.centre() })
}

/// The stand-in goes where the selection is.
pub(super) fn place_stand_in(world: &mut World) {
    if world.resource::<GizmoDrag>().tool().is_some()
        || world.resource::<TransformGizmoState>().active
    {
        return;
    }
    let wanted = wanted_place(world);
    let mut stand_ins = world.query_filtered::<Entity, With<StandIn>>();
    let Ok(stand_in) = stand_ins.single(world) else {
        return;
    };
    let mut stand_in = world.entity_mut(stand_in);
    match wanted {
        None => {
            if stand_in.contains::<TransformGizmoFocus>() {
                stand_in.remove::<TransformGizmoFocus>();
            }
        }
        Some(wanted) => {
            if stand_in.get::<Transform>() != Some(&wanted) {
                stand_in.insert(wanted);
            }
            if !stand_in.contains::<TransformGizmoFocus>() {
                stand_in.insert(TransformGizmoFocus);
            }
        }
    }
}

/// Where the stand-in for the selection belongs; `None` where nothing is selected that can be moved.
pub(super) fn wanted_place(world: &mut World) -> Option<Transform> {
    let tools = world.resource::<Tools>().clone();
    if let Some(grip) = active_grip(world, &tools) {
        return grips::place(world, grip).map(Transform::from_translation);
    }
    let entities = movable(world);
    let (_, active) = *entities.last()?;
    let place = if tools.around_middle {
        let places: Vec<Vec3> = entities
            .iter()
            .filter_map(|(_, entity)| pivot(world, *entity))
            .collect();
        places.iter().sum::<Vec3>() / places.len().max(1) as f32
    } else {
        pivot(world, active)?
    };
    // One object is scaled along its own axes: along others it would be sheared.
    let own_axes = tools.local || tools.tool == Tool::Scale && entities.len() == 1;
    let rotation = if own_axes {
        let (_, rotation, _) = world_from_entity(world, active)?.to_scale_rotation_translation();
        rotation
    } else {
        Quat::IDENTITY
    };
    let place = Transform::from_translation(place).with_rotation(rotation);
    place.is_finite().then_some(place)
}

pub(super) fn active_grip(world: &World, tools: &Tools) -> Option<Grip> {
    world
        .resource::<ActiveGrip>()
        .0
        .filter(|_| tools.tool == Tool::Move)
}
