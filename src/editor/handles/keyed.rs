//! Moving, turning and scaling by keys alone: the tool's key, an axis, a number, Enter. W X 10cm Enter moves by ten
//! centimetres along x. It is a drag that the number leads: what is typed shows at once, and Escape puts everything back.

use super::drag::{cancel, finish, follow_number, forget_drag, hold_by_keys};
use super::typed::{TypedDrag, label};
use super::{Tool, Tools};
use crate::editor::document::SceneOpened;
use crate::editor::notice::Notices;
use crate::editor::pointer::PointerUse;
use crate::editor::viewport::Viewport;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::Commands;
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::TransformGizmoAxis as Axis;
use bevy::input::keyboard::{Key, KeyCode, KeyboardInput};

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

/// Whether keys hold the selection: the pointer moves nothing then.
pub(super) fn holds(world: &World) -> bool {
    matches!(
        world.get_resource::<KeyedDrag>(),
        Some(KeyedDrag::Number(..))
    )
}

/// A command was sent by its key.
pub(in super::super) fn note_command(world: &mut World, id: &str) {
    forget_keyed(world);
    let tool = match id {
        "tool.move" => Tool::Move,
        "tool.turn" => Tool::Turn,
        "tool.scale" => Tool::Scale,
        _ => return,
    };
    if let Some(mut keyed) = world.get_resource_mut::<KeyedDrag>() {
        keyed.set_if_neq(KeyedDrag::Axis(tool));
    }
}

/// A button was pressed, or another command given: what was begun by keys is not meant any more.
pub(in super::super) fn forget_keyed(world: &mut World) {
    if holds(world) {
        cancel(world);
    }
    if let Some(mut keyed) = world.get_resource_mut::<KeyedDrag>() {
        keyed.set_if_neq(KeyedDrag::No);
    }
}

/// Nothing of another scene is held.
pub(super) fn forget_scene(_: On<SceneOpened>, mut commands: Commands) {
    commands.queue(|world: &mut World| {
        if holds(world) {
            world.insert_resource(KeyedDrag::No);
            forget_drag(world);
        }
    });
}

/// Where a dialog or a field has taken the keys, no Enter would come.
pub(super) fn forget_unheard(world: &mut World) {
    if holds(world) && !is_heard(world) {
        forget_keyed(world);
    }
}

fn is_heard(world: &World) -> bool {
    let viewport = world.resource::<Viewport>();
    viewport.takes_keys && viewport.takes_letters
}

/// Takes a key that is pressed after a tool's; `false` where it is not for it.
pub(in super::super) fn type_axis_and_number(
    world: &mut World,
    key: KeyCode,
    input: &KeyboardInput,
) -> bool {
    let keyed = world.get_resource::<KeyedDrag>().copied();
    let is_free = matches!(world.resource::<PointerUse>(), PointerUse::Free);
    let axis = match key {
        KeyCode::KeyX => Some(Axis::X),
        KeyCode::KeyY => Some(Axis::Y),
        KeyCode::KeyZ => Some(Axis::Z),
        _ => None,
    };
    match keyed {
        None | Some(KeyedDrag::No) => return false,
        Some(_) if !is_heard(world) || !is_free => {
            forget_keyed(world);
            return false;
        }
        Some(KeyedDrag::Axis(tool)) => {
            return axis.is_some_and(|axis| begin_number(world, tool, axis));
        }
        Some(KeyedDrag::Number(tool, _)) => match (key, axis, &input.logical_key) {
            (KeyCode::Enter | KeyCode::NumpadEnter, ..) => enter(world, tool),
            (KeyCode::Escape, ..) => forget_keyed(world),
            (KeyCode::Backspace, ..) => {
                world.resource_mut::<TypedDrag>().pop();
                follow_number(world);
            }
            (_, Some(axis), _) => {
                begin_number(world, tool, axis);
            }
            (_, _, Key::Character(letters)) => {
                world.resource_mut::<TypedDrag>().push(letters);
                follow_number(world);
            }
            _ => {}
        },
    }
    true
}

/// `false` where there is nothing to move.
fn begin_number(world: &mut World, tool: Tool, axis: Axis) -> bool {
    // Of the tool whose key was pressed: its command may be still to come.
    world.resource_mut::<Tools>().tool = tool;
    if !hold_by_keys(world, axis) {
        return false;
    }
    world.insert_resource(KeyedDrag::Number(tool, axis));
    let asks = format!("{} (Enter; Esc: not)", label(tool, Some(axis)));
    world.resource_mut::<TypedDrag>().ask(asks);
    true
}

/// What was typed stays, in one step; what cannot be read waits, to be mended.
fn enter(world: &mut World, tool: Tool) {
    if !follow_number(world) {
        let text = world.resource::<TypedDrag>().not_read(tool);
        world.resource_mut::<Notices>().tell(text);
        return;
    }
    world.insert_resource(KeyedDrag::No);
    finish(world);
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
    use bevy::gizmos::transform_gizmo::TransformGizmoState;
    use bevy::input::ButtonInput;
    use bevy::input::ButtonState;
    use bevy::math::Vec3;
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
            .init_resource::<TransformGizmoState>()
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

    fn place(world: &World, lamp: Entity) -> Vec3 {
        world.get::<Transform>(lamp).unwrap().translation
    }

    fn type_text(world: &mut World, text: &str) {
        for letter in text.chars() {
            assert!(
                key(world, KeyCode::Digit1, &letter.to_string()),
                "no shortcut hears {letter}"
            );
        }
    }

    #[test]
    fn what_is_typed_shows_at_once_and_what_cannot_be_read_leaves_it_where_it_is() {
        let (mut app, lamp) = app_with_lamp();
        let mut shown = Vec::new();
        note_command(app.world_mut(), "tool.move");
        key(app.world_mut(), KeyCode::KeyX, "x");
        for letter in ["-", "2", "0", "c", "m"] {
            type_text(app.world_mut(), letter);
            app.update();
            shown.push(place(app.world(), lamp).x);
        }
        assert_eq!(shown, [0.0, -2.0, -20.0, -20.0, -0.2]);
        assert_eq!(app.world().resource::<History>().position(), 0);
        let world = app.world_mut();
        key(world, KeyCode::KeyY, "y");
        assert_eq!(place(world, lamp), Vec3::ZERO, "another axis begins anew");
        type_text(world, "3");
        assert_eq!(place(world, lamp), 3.0 * Vec3::Y);
        key(world, KeyCode::Backspace, "");
        assert_eq!(place(world, lamp), Vec3::ZERO, "no number, no way");
        type_text(world, "1/2");
        key(world, KeyCode::Enter, "");
        app.update();
        assert_eq!(place(app.world(), lamp), 0.5 * Vec3::Y);
        assert_eq!(app.world().resource::<History>().position(), 1);
    }

    #[test]
    fn escape_a_click_another_command_and_a_dialog_put_everything_back_without_a_step() {
        type Way = fn(&mut World);
        let ways: [(&str, Way); 4] = [
            ("escape", |world| {
                key(world, KeyCode::Escape, "");
            }),
            ("a click", forget_keyed),
            ("a command", |world| note_command(world, "edit.undo")),
            ("a dialog", |world| {
                world.resource_mut::<Viewport>().takes_keys = false;
                forget_unheard(world);
            }),
        ];
        for tool in ["tool.move", "tool.turn", "tool.scale"] {
            for (what, end) in ways {
                let (mut app, lamp) = app_with_lamp();
                let start = Transform::from_xyz(0.1, 0.7, 0.3)
                    .with_rotation(bevy::math::Quat::from_rotation_x(0.3));
                app.world_mut().entity_mut(lamp).insert(start);
                app.update();
                crate::editor::history::reset(app.world_mut());
                let world = app.world_mut();
                note_command(world, tool);
                key(world, KeyCode::KeyZ, "z");
                type_text(world, "7");
                let now = *world.get::<Transform>(lamp).unwrap();
                assert_ne!(now, start, "{tool} shows");
                app.update();
                end(app.world_mut());
                app.update();
                let world = app.world();
                assert_eq!(world.get::<Transform>(lamp), Some(&start), "{tool}, {what}");
                assert_eq!(world.resource::<History>().steps().count(), 0, "{what}");
                assert_eq!(*world.resource::<KeyedDrag>(), KeyedDrag::No);
                assert_eq!(world.resource::<TypedDrag>().shown(), None);
            }
        }
    }

    #[test]
    fn nothing_of_a_scene_that_is_closed_is_put_into_the_next() {
        let (mut app, lamp) = app_with_lamp();
        app.add_observer(forget_scene);
        let world = app.world_mut();
        note_command(world, "tool.move");
        key(world, KeyCode::KeyX, "x");
        type_text(world, "7");
        crate::editor::document::adopt(world, "next", None);
        world.flush();
        assert_eq!(place(world, lamp).x, 7.0, "as the next scene has it");
        assert_eq!(*world.resource::<KeyedDrag>(), KeyedDrag::No);
        assert!(!world.resource::<crate::editor::history::Gesture>().active());
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
        type_text(world, "10cm");
        assert!(key(world, KeyCode::Enter, ""));
        assert!((place(world, lamp) - Vec3::new(0.1, 0.0, 0.0)).length() < 1e-6);
        assert_eq!(*world.resource::<KeyedDrag>(), KeyedDrag::No);
        app.update();
        let world = app.world_mut();
        assert_eq!(world.resource::<History>().position(), 1);
        undo(world);
        assert_eq!(place(world, lamp), Vec3::ZERO);
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
