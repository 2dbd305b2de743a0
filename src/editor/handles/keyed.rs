//! Moving, turning and scaling by keys alone: the tool's key, an axis, a number, Enter. W X 10cm Enter moves by ten
//! centimetres along x.

use super::drag::{apply, begin};
use super::gizmo::wanted_place;
use super::typed::{TypedDrag, label, typed_place};
use super::{Tool, Tools};
use crate::editor::history::Gesture;
use crate::editor::notice::Notices;
use crate::editor::pointer::PointerUse;
use crate::editor::viewport::Viewport;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::TransformGizmoAxis as Axis;
use bevy::input::keyboard::{Key, KeyCode, KeyboardInput};
use bevy::math::Vec3;

/// What a key has begun.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub(in super::super) enum KeyedDrag {
    #[default]
    No,
    /// A tool was chosen: the next key may be an axis.
    Axis(Tool),
    /// The number for it is typed.
    Number(Tool, Axis),
}

/// A command was sent by its key.
pub(in super::super) fn note_command(world: &mut World, id: &str) {
    let tool = match id {
        "tool.move" => Some(Tool::Move),
        "tool.turn" => Some(Tool::Turn),
        "tool.scale" => Some(Tool::Scale),
        _ => None,
    };
    let next = tool.map_or(KeyedDrag::No, KeyedDrag::Axis);
    if let Some(mut keyed) = world.get_resource_mut::<KeyedDrag>() {
        keyed.set_if_neq(next);
    }
}

/// A button was pressed: what was begun by keys is not meant any more.
pub(in super::super) fn forget_keyed(world: &mut World) {
    if world
        .get_resource::<KeyedDrag>()
        .is_some_and(|keyed| *keyed != KeyedDrag::No)
    {
        end(world);
    }
}

fn end(world: &mut World) {
    world.insert_resource(KeyedDrag::No);
    world.resource_mut::<TypedDrag>().clear();
}

/// Takes a key that is pressed after a tool's; `false` where it is not for it.
pub(in super::super) fn type_axis_and_number(
    world: &mut World,
    key: KeyCode,
    input: &KeyboardInput,
) -> bool {
    let keyed = world.get_resource::<KeyedDrag>().copied();
    let viewport = world.resource::<Viewport>();
    let is_heard = viewport.takes_keys && viewport.takes_letters;
    let is_free = matches!(world.resource::<PointerUse>(), PointerUse::Free);
    let axis = match key {
        KeyCode::KeyX => Some(Axis::X),
        KeyCode::KeyY => Some(Axis::Y),
        KeyCode::KeyZ => Some(Axis::Z),
        _ => None,
    };
    match keyed {
        None | Some(KeyedDrag::No) => return false,
        Some(_) if !is_heard || !is_free => {
            end(world);
            return false;
        }
        Some(KeyedDrag::Axis(tool)) => {
            let Some(axis) = axis.filter(|_| wanted_place(world).is_some()) else {
                return false;
            };
            begin_number(world, tool, axis);
        }
        Some(KeyedDrag::Number(tool, along)) => match (key, axis, &input.logical_key) {
            (KeyCode::Enter | KeyCode::NumpadEnter, ..) => enter(world, tool, along),
            (KeyCode::Escape, ..) => end(world),
            (KeyCode::Backspace, ..) => world.resource_mut::<TypedDrag>().pop(),
            (_, Some(axis), _) => begin_number(world, tool, axis),
            (_, _, Key::Character(letters)) => world.resource_mut::<TypedDrag>().push(letters),
            _ => {}
        },
    }
    true
}

fn begin_number(world: &mut World, tool: Tool, axis: Axis) {
    world.insert_resource(KeyedDrag::Number(tool, axis));
    let asks = format!("{} (Enter; Esc: not)", label(tool, Some(axis)));
    world.resource_mut::<TypedDrag>().ask(asks);
}

/// What was typed is done, in one step; what cannot be read stays, to be mended.
fn enter(world: &mut World, tool: Tool, axis: Axis) {
    let Some(start) = wanted_place(world) else {
        return end(world);
    };
    let direction = start.rotation
        * match axis {
            Axis::X => Vec3::X,
            Axis::Y => Vec3::Y,
            Axis::Z | Axis::View => Vec3::Z,
        };
    let typed = world.resource::<TypedDrag>();
    let Some(place) = typed_place(typed, tool, axis, &start, direction) else {
        let text = typed.not_read(tool);
        world.resource_mut::<Notices>().tell(text);
        return;
    };
    // Of the tool whose key was pressed, whatever was chosen since.
    world.resource_mut::<Tools>().tool = tool;
    let drag = begin(world, start, Some((axis, direction)));
    apply(world, &drag, &place);
    world.resource_mut::<Gesture>().end();
    end(world);
}

#[cfg(test)]
mod tests {
    use super::super::{ActiveGrip, drag::GizmoDrag};
    use super::*;
    use crate::editor::headless_editor;
    use crate::editor::history::{History, undo};
    use crate::editor::navigation::LookThrough;
    use crate::editor::selection::Selection;
    use crate::scene::{PointLamp, SceneId};
    use bevy::app::App;
    use bevy::ecs::entity::Entity;
    use bevy::input::ButtonInput;
    use bevy::input::ButtonState;
    use bevy::transform::components::Transform;

    fn key(world: &mut World, key_code: KeyCode, text: &str) -> bool {
        let logical_key = match text {
            "" => Key::Enter,
            text => Key::Character(text.into()),
        };
        let input = KeyboardInput {
            key_code,
            logical_key,
            state: ButtonState::Pressed,
            text: None,
            repeat: false,
            window: Entity::PLACEHOLDER,
        };
        type_axis_and_number(world, key_code, &input)
    }

    fn app_with_lamp() -> (App, Entity) {
        let mut app = headless_editor();
        app.init_resource::<KeyedDrag>()
            .init_resource::<TypedDrag>()
            .init_resource::<GizmoDrag>()
            .init_resource::<ActiveGrip>()
            .init_resource::<Tools>()
            .init_resource::<PointerUse>()
            .init_resource::<Viewport>()
            .init_resource::<LookThrough>()
            .init_resource::<ButtonInput<KeyCode>>();
        let lamp = (SceneId(1), PointLamp::default(), Transform::default());
        let lamp = app.world_mut().spawn(lamp).id();
        app.update();
        crate::editor::history::reset(app.world_mut());
        app.world_mut()
            .resource_mut::<Selection>()
            .set([SceneId(1)]);
        (app, lamp)
    }

    #[test]
    fn a_tools_key_an_axis_a_number_and_enter_are_one_step_and_x_deletes_nothing() {
        let (mut app, lamp) = app_with_lamp();
        let world = app.world_mut();
        assert!(
            !key(world, KeyCode::KeyX, "x"),
            "without a tool X is another command"
        );
        note_command(world, "tool.move");
        assert!(key(world, KeyCode::KeyY, "y"));
        assert!(key(world, KeyCode::KeyX, "x"), "another axis");
        for letter in ["1", "0", "c", "m"] {
            assert!(
                key(world, KeyCode::Digit1, letter),
                "no shortcut hears {letter}"
            );
        }
        let place = |world: &World| world.get::<Transform>(lamp).unwrap().translation;
        assert_eq!(place(world), Vec3::ZERO, "nothing is done before Enter");
        assert!(key(world, KeyCode::Enter, ""));
        assert!((place(world) - Vec3::new(0.1, 0.0, 0.0)).length() < 1e-6);
        assert_eq!(*world.resource::<KeyedDrag>(), KeyedDrag::No);
        app.update();
        let world = app.world_mut();
        assert_eq!(world.resource::<History>().position(), 1);
        undo(world);
        assert_eq!(place(world), Vec3::ZERO);
    }

    #[test]
    fn what_cannot_be_read_does_nothing_and_waits_and_a_click_or_escape_ends_it() {
        let (mut app, lamp) = app_with_lamp();
        let world = app.world_mut();
        note_command(world, "tool.turn");
        key(world, KeyCode::KeyZ, "z");
        key(world, KeyCode::KeyQ, "q");
        key(world, KeyCode::Enter, "");
        assert_eq!(world.get::<Transform>(lamp), Some(&Transform::default()));
        assert_eq!(
            *world.resource::<KeyedDrag>(),
            KeyedDrag::Number(Tool::Turn, Axis::Z)
        );
        key(world, KeyCode::Backspace, "");
        key(world, KeyCode::Digit9, "9");
        key(world, KeyCode::Enter, "");
        let angle = world
            .get::<Transform>(lamp)
            .unwrap()
            .rotation
            .to_scaled_axis()
            .z;
        assert!((angle.to_degrees() - 9.0).abs() < 1e-3, "{angle}");
        note_command(world, "tool.move");
        key(world, KeyCode::KeyX, "x");
        assert!(key(world, KeyCode::Escape, ""));
        assert_eq!(*world.resource::<KeyedDrag>(), KeyedDrag::No);
        note_command(world, "tool.move");
        forget_keyed(world);
        assert!(!key(world, KeyCode::KeyX, "x"), "X deletes again");
        note_command(world, "tool.move");
        note_command(world, "view.frame-all");
        assert!(!key(world, KeyCode::KeyX, "x"));
    }
}
