//! A drag of the gizmo: what is done to the stand-in is done to the selection, as one gesture.

use super::super::edits::scene_entity;
use super::super::extent::{extent_of, world_from_parent};
use super::super::history::Gesture;
use super::super::pick;
use super::bodies::{Body, Change};
use super::gizmo::{StandIn, active_grip, movable, wanted_place};
use super::grips::{self, Grip};
use super::keyed;
use super::snap::{Mover, landing_at};
use super::typed::{TypedDrag, typed_place};
use super::{Tool, Tools};
use crate::scene::SceneId;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res};
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::{
    TransformGizmoAxis, TransformGizmoSettings, TransformGizmoState, axis_direction,
    effective_space, gizmo_rotation,
};
use bevy::input::ButtonInput;
use bevy::input::keyboard::KeyCode;
use bevy::math::Vec3;
use bevy::transform::components::{GlobalTransform, Transform};

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
struct Drag {
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

/// What was done to the stand-in is done to the selection: all of a drag is one gesture.
pub(super) fn carry(world: &mut World) {
    if keyed::holds(world) {
        return;
    }
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
    carry_to(world, &drag, &now);
    if !active {
        finish(world);
    }
}

fn carry_to(world: &mut World, drag: &Drag, now: &Transform) {
    if *now != drag.carried {
        apply(world, drag, now);
        if let Some(drag) = &mut world.resource_mut::<GizmoDrag>().0 {
            drag.carried = *now;
        }
    }
}

/// What was done stays, as one step.
pub(super) fn finish(world: &mut World) {
    world.resource_mut::<GizmoDrag>().0 = None;
    world.resource_mut::<TypedDrag>().clear();
    world.resource_mut::<Gesture>().end();
}

/// Takes hold of the selection by keys alone, or, where they hold it already, along another axis and from where it was.
/// `false` where nothing is selected that can be moved.
pub(super) fn hold_by_keys(world: &mut World, axis: TransformGizmoAxis) -> bool {
    let mut drag = match world.resource_mut::<GizmoDrag>().0.take() {
        Some(drag) => {
            put_back(world, &drag);
            drag
        }
        None => match wanted_place(world) {
            Some(start) => begin(world, start, None),
            None => return false,
        },
    };
    let own = match axis {
        TransformGizmoAxis::X => Vec3::X,
        TransformGizmoAxis::Y => Vec3::Y,
        TransformGizmoAxis::Z | TransformGizmoAxis::View => Vec3::Z,
    };
    drag.handle = Some((axis, drag.start.rotation * own));
    drag.carried = drag.start;
    world.resource_mut::<GizmoDrag>().0 = Some(drag);
    true
}

/// What keys hold goes where the number says that is typed. Without one it is as it was; one that cannot be read, as in
/// the middle of its unit, moves nothing. Returns whether it can be read.
pub(super) fn follow_number(world: &mut World) -> bool {
    let Some(drag) = world.resource::<GizmoDrag>().0.clone() else {
        return false;
    };
    let typed = world.resource::<TypedDrag>();
    let place = drag
        .handle
        .and_then(|(axis, direction)| typed_place(typed, drag.tool, axis, &drag.start, direction));
    match place {
        Some(place) => carry_to(world, &drag, &place),
        None if typed.is_empty() => {
            put_back(world, &drag);
            if let Some(drag) = &mut world.resource_mut::<GizmoDrag>().0 {
                drag.carried = drag.start;
            }
        }
        None => {}
    }
    place.is_some()
}

/// The drag is of a scene that is not open any more: what it holds is not put back.
pub(super) fn forget_drag(world: &mut World) {
    if world.resource_mut::<GizmoDrag>().0.take().is_some() {
        finish(world);
    }
}

/// Arrows stand where the selection is, not where the pointer is already: Bevy moves the stand-in after the selection was
/// moved, and without a look at what was typed or snapped to. After the drag they stand where the stand-in does, which keys
/// alone do not move.
pub(super) fn show_carried(
    drag: Res<GizmoDrag>,
    mut stand_ins: Query<(&Transform, &mut GlobalTransform), With<StandIn>>,
) {
    for (own, mut place) in &mut stand_ins {
        let shown = drag.0.as_ref().map_or(*own, |drag| drag.carried);
        place.set_if_neq(shown.into());
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
fn begin(world: &mut World, start: Transform, handle: Option<(TransformGizmoAxis, Vec3)>) -> Drag {
    world.resource_mut::<TypedDrag>().clear();
    let tools = world.resource::<Tools>().clone();
    let verb = tools.tool.verb();
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
fn apply(world: &mut World, drag: &Drag, now: &Transform) {
    let start = &drag.start;
    let keys = world.resource::<ButtonInput<KeyCode>>();
    // Some keyboards have their digits with Shift.
    let asks = !keyed::holds(world) && keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
    let evenly = asks || world.resource::<Tools>().scale_linked;
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
    if let Some(mut transform) = world.get_mut::<Transform>(entity) {
        transform.set_if_neq(wanted);
    }
}

/// Puts everything back as it was before the drag. `false` where there is none.
pub(in super::super) fn cancel(world: &mut World) -> bool {
    let Some(drag) = world.resource_mut::<GizmoDrag>().0.take() else {
        return false;
    };
    put_back(world, &drag);
    let mut state = world.resource_mut::<TransformGizmoState>();
    state.active = false;
    state.axis = None;
    state.entity = None;
    finish(world);
    true
}

fn put_back(world: &mut World, drag: &Drag) {
    match &drag.moved {
        Moved::Grip(grip, place, None) => grips::put(world, *grip, *place),
        Moved::Grip(grip, _, Some(velocity)) => grips::set_velocity(world, *grip, *velocity),
        Moved::Bodies(bodies) => {
            for (id, body) in bodies {
                set_transform(world, *id, body.own);
            }
        }
    }
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
