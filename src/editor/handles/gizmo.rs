//! Bevy's gizmo on a stand-in for the selection, and the selection after it.

use super::super::edits::{roots_of, scene_entity};
use super::super::extent::{extent_of, own_extent, world_from_entity, world_from_parent};
use super::super::history::Gesture;
use super::super::navigation::{Eye, LookThrough};
use super::super::pick;
use super::super::pointer::PointerUse;
use super::super::selection::Selection;
use super::super::viewport::Viewport;
use super::bodies::{Body, Change};
use super::grips::{self, Grip};
use super::snap::{Mover, landing_at};
use super::typed::{TypedDrag, typed_place};
use super::{ActiveGrip, Tool, Tools};
use crate::scene::SceneId;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, Res, ResMut};
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::{
    TransformGizmoAxis, TransformGizmoFocus, TransformGizmoMode, TransformGizmoSettings,
    TransformGizmoSpace, TransformGizmoState, axis_direction, effective_space, gizmo_rotation,
};
use bevy::input::ButtonInput;
use bevy::input::keyboard::KeyCode;
use bevy::math::{Quat, Vec3};
use bevy::transform::components::{GlobalTransform, Transform};

/// Length of an arrow in logical pixels.
const ARROW: f32 = 90.0;
/// How near to an arrow or ring the pointer has to be, in logical pixels.
const REACH: f32 = 12.0;

/// Marks the entity that the gizmo moves instead of the scene's.
#[derive(Component)]
pub(super) struct StandIn;

/// The drag that is going on.
#[derive(Resource, Default)]
pub(super) struct GizmoDrag(Option<Drag>);

impl GizmoDrag {
    /// What is being done.
    pub fn tool(&self) -> Option<Tool> {
        self.0.as_ref().map(|drag| drag.tool)
    }
}

#[derive(Clone)]
pub(super) struct Drag {
    start: Transform,
    /// The handle, and where it points to in the world.
    handle: Option<(TransformGizmoAxis, Vec3)>,
    /// The stand-in's transform that was carried over last.
    carried: Transform,
    tool: Tool,
    moved: Moved,
    mover: Mover,
}

/// What is moved.
#[derive(Clone)]
enum Moved {
    Bodies(Vec<(SceneId, Body)>),
    /// Where it was, and how fast what it is the motion of.
    Grip(Grip, Vec3, Option<Vec3>),
}

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
fn movable(world: &World) -> Vec<(SceneId, Entity)> {
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
    if world.resource::<GizmoDrag>().0.is_some() || world.resource::<TransformGizmoState>().active {
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

fn active_grip(world: &World, tools: &Tools) -> Option<Grip> {
    world
        .resource::<ActiveGrip>()
        .0
        .filter(|_| tools.tool == Tool::Move)
}

/// What was done to the stand-in is done to the selection: all of a drag is one gesture.
pub(super) fn carry(world: &mut World) {
    let active = world.resource::<TransformGizmoState>().active;
    let drag = world.resource::<GizmoDrag>().0.clone();
    let drag = match (active, drag) {
        (false, None) => return,
        (true, None) => {
            let start = world.resource::<TransformGizmoState>().start_transform;
            let handle = handle(world, &start);
            let drag = begin(world, start, handle);
            world.resource_mut::<GizmoDrag>().0 = Some(drag.clone());
            drag
        }
        (_, Some(drag)) => drag,
    };
    let mut stand_ins = world.query_filtered::<&Transform, With<StandIn>>();
    let pointed = stand_ins.single(world).copied().unwrap_or(drag.carried);
    let typed = drag.handle.and_then(|(axis, direction)| {
        let typed = world.resource::<TypedDrag>();
        typed_place(typed, drag.tool, axis, &drag.start, direction)
    });
    let now = typed.or_else(|| snapped(world, &drag)).unwrap_or(pointed);
    if now != drag.carried {
        apply(world, &drag, &now);
        if let Some(drag) = &mut world.resource_mut::<GizmoDrag>().0 {
            drag.carried = now;
        }
    }
    if !active {
        world.resource_mut::<GizmoDrag>().0 = None;
        world.resource_mut::<TypedDrag>().clear();
        world.resource_mut::<Gesture>().end();
    }
}

/// Arrows stand where the selection is, not where the pointer is already: Bevy moves the stand-in after the selection was
/// moved, and without a look at what was typed or snapped to.
pub(super) fn show_carried(
    drag: Res<GizmoDrag>,
    mut stand_ins: Query<&mut GlobalTransform, With<StandIn>>,
) {
    let Some(drag) = &drag.0 else {
        return;
    };
    for mut place in &mut stand_ins {
        place.set_if_neq(drag.carried.into());
    }
}

/// Where other objects put the stand-in: anywhere, or along the arrow that is dragged.
fn snapped(world: &mut World, drag: &Drag) -> Option<Transform> {
    let (axis, direction) = drag.handle.filter(|_| drag.tool == Tool::Move)?;
    let by = landing_at(world, &drag.mover)? - drag.start.translation;
    let by = match axis {
        TransformGizmoAxis::View => by,
        _ => by.dot(direction) * direction,
    };
    Some(drag.start.with_translation(drag.start.translation + by))
}

/// The handle that is dragged, and its direction in the world.
fn handle(world: &mut World, start: &Transform) -> Option<(TransformGizmoAxis, Vec3)> {
    let (_, eye) = pick::camera(world)?;
    let axis = world.resource::<TransformGizmoState>().axis?;
    let space = effective_space(world.resource::<TransformGizmoSettings>());
    let rotation = gizmo_rotation(&GlobalTransform::from(*start), space);
    Some((axis, axis_direction(axis, rotation, &eye).normalize()))
}

/// Takes hold of the selection by a handle: the axis, and where it points to in the world.
pub(super) fn begin(
    world: &mut World,
    start: Transform,
    handle: Option<(TransformGizmoAxis, Vec3)>,
) -> Drag {
    world.resource_mut::<TypedDrag>().clear();
    let tools = world.resource::<Tools>().clone();
    let verb = match tools.tool {
        Tool::Move => "Move",
        Tool::Turn => "Turn",
        Tool::Scale => "Scale",
    };
    let grip = active_grip(world, &tools);
    let (moved, mover, name) = match grip.and_then(|grip| Some((grip, grips::place(world, grip)?)))
    {
        Some((grip, place)) => {
            let name = grips::step_name(world, grip);
            let moved = Moved::Grip(grip, place, grips::velocity_of(world, grip));
            (moved, grips::mover(world, grip), name)
        }
        None => {
            let entities = movable(world);
            let name = match entities.as_slice() {
                [(_, entity)] => match world.get::<Name>(*entity) {
                    Some(name) => format!("{verb} {name}"),
                    None => verb.to_owned(),
                },
                several => format!("{verb} {} objects", several.len()),
            };
            let ids: Vec<SceneId> = entities.iter().map(|(id, _)| *id).collect();
            let room = extent_of(world, &ids).map(|room| room.moved(-start.translation));
            let mover = Mover {
                entities: entities.iter().map(|(_, entity)| *entity).collect(),
                room,
            };
            let bodies = entities.into_iter().filter_map(|(id, entity)| {
                let body = Body {
                    own: *world.get::<Transform>(entity)?,
                    world_from_parent: world_from_parent(world, entity),
                };
                Some((id, body))
            });
            (Moved::Bodies(bodies.collect()), mover, name)
        }
    };
    world.resource_mut::<Gesture>().begin(name);
    Drag {
        start,
        handle,
        carried: start,
        tool: tools.tool,
        moved,
        mover,
    }
}

/// Does to what is dragged what is done to the stand-in that comes to be there.
pub(super) fn apply(world: &mut World, drag: &Drag, now: &Transform) {
    let start = &drag.start;
    let keys = world.resource::<ButtonInput<KeyCode>>();
    let evenly = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight])
        || world.resource::<Tools>().scale_linked;
    let change = match drag.tool {
        Tool::Move => Change::Move(now.translation - start.translation),
        Tool::Turn => Change::Turn((now.rotation * start.rotation.inverse()).normalize()),
        Tool::Scale => Change::Scale {
            rotation: start.rotation,
            factor: scale_factor(now.scale / start.scale, evenly),
        },
    };
    match &drag.moved {
        Moved::Grip(grip, place, _) => {
            if let Change::Move(by) = change {
                grips::put(world, *grip, *place + by);
            }
        }
        Moved::Bodies(bodies) => {
            for (id, body) in bodies {
                if let Some(own) = body.changed(change, start.translation) {
                    set_transform(world, *id, own);
                }
            }
        }
    }
}

/// Along one axis as it was dragged, or, evenly, along all of them.
fn scale_factor(dragged: Vec3, evenly: bool) -> Vec3 {
    if !evenly {
        return dragged;
    }
    let furthest = dragged.to_array().into_iter().max_by(|a, b| {
        let change = |x: f32| x.max(f32::MIN_POSITIVE).ln().abs();
        change(*a).total_cmp(&change(*b))
    });
    Vec3::splat(furthest.unwrap_or(1.0))
}

fn set_transform(world: &mut World, id: SceneId, wanted: Transform) {
    let Some(entity) = scene_entity(world, id) else {
        return;
    };
    if let Some(mut transform) = world.get_mut::<Transform>(entity)
        && *transform != wanted
    {
        *transform = wanted;
    }
}

/// Puts everything back as it was before the drag. `false` where there is none.
pub(in super::super) fn cancel(world: &mut World) -> bool {
    let Some(drag) = world.resource_mut::<GizmoDrag>().0.take() else {
        return false;
    };
    match drag.moved {
        Moved::Grip(grip, place, None) => grips::put(world, grip, place),
        Moved::Grip(grip, _, Some(velocity)) => grips::set_velocity(world, grip, velocity),
        Moved::Bodies(bodies) => {
            for (id, body) in bodies {
                set_transform(world, id, body.own);
            }
        }
    }
    let mut state = world.resource_mut::<TransformGizmoState>();
    state.active = false;
    state.axis = None;
    state.entity = None;
    world.resource_mut::<TypedDrag>().clear();
    world.resource_mut::<Gesture>().end();
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_stand_where_the_selection_was_carried_to_until_the_drag_ends() {
        use bevy::ecs::system::RunSystemOnce;
        let mut world = World::new();
        let pointed = Transform::from_xyz(3.0, 0.0, 0.0);
        let carried = Transform::from_xyz(2.0, 0.0, 0.0);
        let drag = |carried| Drag {
            start: Transform::IDENTITY,
            handle: None,
            carried,
            tool: Tool::Move,
            moved: Moved::Bodies(Vec::new()),
            mover: Mover {
                entities: Vec::new(),
                room: None,
            },
        };
        world.insert_resource(GizmoDrag(Some(drag(carried))));
        let place = GlobalTransform::from(pointed);
        let stand_in = world.spawn((StandIn, pointed, place)).id();
        let shown = |world: &mut World| {
            world.run_system_once(show_carried).unwrap();
            *world.get::<GlobalTransform>(stand_in).unwrap()
        };
        assert_eq!(shown(&mut world), carried.into());
        world.resource_mut::<GizmoDrag>().0 = Some(drag(pointed));
        assert_eq!(shown(&mut world), pointed.into());
        world.insert_resource(GizmoDrag(None));
        assert_eq!(shown(&mut world), pointed.into());
    }

    #[test]
    fn scaling_evenly_follows_the_axis_that_was_dragged() {
        let dragged = Vec3::new(1.0, 0.5, 1.0);
        assert_eq!(scale_factor(dragged, false), dragged);
        assert_eq!(scale_factor(dragged, true), Vec3::splat(0.5));
        assert_eq!(
            scale_factor(Vec3::new(1.0, 1.0, 3.0), true),
            Vec3::splat(3.0)
        );
    }
}
