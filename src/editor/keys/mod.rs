//! Keys, as the window sends them.
//!
//! | module | does |
//! |---|---|
//! | `name` | what keys are called |
//! | `bindings` | which command each sends |
//! | `inbox` | the window's events, and the modifiers that are held by them |

mod bindings;
mod inbox;
mod name;

pub use bindings::Bindings;
pub(super) use inbox::{Inbox, Modifiers};
pub use name::Keys;
pub(super) use name::{letter_key, named_key};

use super::action::Action;
use super::command::CommandTable;
use super::embed::{Editing, Switched};
use super::handles::{note_command, type_axis_and_number, type_into_drag};
use super::notice::Notices;
use super::pointer::{self, PointerUse};
use super::preferences::Preferences;
use super::schedule::{Dispatch, EditorUpdate};
use super::viewport::Viewport;
use bevy::app::{App, Plugin};
use bevy::ecs::message::Messages;
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Res, ResMut};
use bevy::ecs::world::{Mut, World};
use bevy::input::keyboard::{Key, KeyCode, KeyboardInput};
use bevy::input::{ButtonInput, ButtonState};
use bevy::prelude::IntoScheduleConfigs;
use bevy::window::WindowEvent;
use std::str::FromStr;

/// The command that the next key is to be given to, by its id.
#[derive(Resource, Default)]
pub(super) struct Recording(pub Option<String>);

/// Turns keys into commands.
pub(super) struct KeysPlugin;

impl Plugin for KeysPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Recording>()
            .init_resource::<Keyboard>()
            .add_observer(take_over)
            .add_systems(
                EditorUpdate,
                (
                    press_keys.before(pointer::use_pointer).before(Dispatch),
                    name_conflicts,
                ),
            );
    }
}

/// Names keys that several commands want, as after the file of preferences was edited by hand.
fn name_conflicts(
    table: Res<CommandTable>,
    preferences: Option<Res<Preferences>>,
    mut notices: ResMut<Notices>,
    mut done: Local<bool>,
) {
    let Some(preferences) = preferences.filter(|_| !*done) else {
        return;
    };
    *done = true;
    for (keys, rows) in table.conflicts(&preferences.keys) {
        let names: Vec<&str> = rows.iter().map(|row| &*row.name).collect();
        notices.fault(format!(
            "{} is wanted by several commands and sends the first: {}. Help, Keys and mouse changes that.",
            keys.text(),
            names.join(", ")
        ));
    }
}

/// The keyboard's share.
#[derive(Resource, Default)]
struct Keyboard(Inbox);

/// No key was heard while the editor was off.
fn take_over(
    _: On<Switched>,
    messages: Res<Messages<WindowEvent>>,
    held: Option<Res<ButtonInput<KeyCode>>>,
    mut keyboard: ResMut<Keyboard>,
) {
    keyboard.0.skip(&messages, held.as_deref());
}

fn press_keys(world: &mut World) {
    let events = world
        .resource_scope(|world, mut keyboard: Mut<Keyboard>| keyboard.0.take(world.resource()));
    for event in events {
        let modifiers = &mut world.resource_mut::<Keyboard>().0.modifiers;
        modifiers.read(&event);
        let modifiers = *modifiers;
        let WindowEvent::KeyboardInput(input) = event else {
            continue;
        };
        if input.state != ButtonState::Pressed {
            continue;
        }
        if modifiers.alt {
            refuse_alt(world, input.key_code);
            continue;
        }
        let keys = Keys {
            ctrl: modifiers.ctrl,
            shift: modifiers.shift,
            key: meant_key(&input),
        };
        let types = |world: &mut World| {
            type_into_drag(world, &input) || type_axis_and_number(world, keys.key, &input)
        };
        if record(world, keys) || !keys.ctrl && types(world) {
            continue;
        }
        let viewport = world.resource::<Viewport>();
        // Nothing that is typed into reads them.
        let takes = match is_function_key(keys.key) {
            true => viewport.takes_function_keys,
            false => viewport.takes_keys,
        };
        let writes = matches!(input.logical_key, Key::Character(_) | Key::Space);
        // The list of entities has letters, and Escape, which gives them back.
        let for_list = writes && !keys.ctrl || keys.key == KeyCode::Escape;
        if !takes || for_list && !viewport.takes_letters {
            continue;
        }
        press(world, keys, input.repeat);
    }
}

fn is_function_key(key: KeyCode) -> bool {
    use KeyCode::{F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12};
    [F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12].contains(&key)
}

fn is_modifier(key: KeyCode) -> bool {
    use KeyCode::{
        AltLeft, AltRight, ControlLeft, ControlRight, ShiftLeft, ShiftRight, SuperLeft, SuperRight,
    };
    let modifiers = [
        ControlLeft,
        ControlRight,
        ShiftLeft,
        ShiftRight,
        AltLeft,
        AltRight,
        SuperLeft,
        SuperRight,
    ];
    modifiers.contains(&key)
}

/// No command is sent with Alt, which is the mouse's: who wants to give it to one is told so.
fn refuse_alt(world: &mut World, key: KeyCode) {
    if world.resource::<Recording>().0.is_some() && !is_modifier(key) {
        let text = "Keys send commands alone, with Ctrl or with Shift; Alt goes with the mouse.";
        world.resource_mut::<Notices>().tell(text);
    }
}

/// Gives the keys to the command that waits for them; `false` where none does.
fn record(world: &mut World, keys: Keys) -> bool {
    let Some(id) = world.resource::<Recording>().0.clone() else {
        return false;
    };
    if is_modifier(keys.key) {
        return true;
    }
    world.resource_mut::<Recording>().0 = None;
    if keys.key == KeyCode::Escape {
        return true;
    }
    if let Err(text) = Keys::from_str(&keys.text()) {
        world.resource_mut::<Notices>().tell(text);
        return true;
    }
    world.resource_scope(|world, table: Mut<CommandTable>| {
        let mut preferences = world.resource_mut::<Preferences>();
        let Some(command) = table.find(&id) else {
            return;
        };
        let had = table.of_keys(keys, &preferences.keys).cloned();
        preferences.keys.bind(&table, command, vec![keys]);
        if let Some(had) = had.filter(|had| had.id != command.id) {
            let text = format!(
                "{} sends {} now, and no more {}.",
                keys.text(),
                command.name,
                had.name
            );
            world.resource_mut::<Notices>().tell(text);
        }
    });
    true
}

fn press(world: &mut World, keys: Keys, repeats: bool) {
    if keys.key == KeyCode::Escape && pointer::cancel(world) {
        return;
    }
    // In the middle of a drag keys belong to it: they fly, or do nothing.
    if !matches!(world.resource::<PointerUse>(), PointerUse::Free) {
        return;
    }
    let table = world.resource::<CommandTable>();
    let bindings = &world.resource::<Preferences>().keys;
    let Some(command) = table.of_keys(keys, bindings) else {
        // Beside the panels of an app it may be the app's own.
        let is_asked = keys.ctrl && !is_modifier(keys.key) && !repeats;
        if is_asked && !world.contains_resource::<Editing>() {
            let text = format!("No command: {}. F1 lists all keys.", keys.text());
            let mut notices = world.resource_mut::<Notices>();
            notices.tell_in_place("No command", text);
        }
        return;
    };
    if !repeats || command.repeats {
        let id = command.id.clone();
        note_command(world, &id);
        world.write_message(Action::Run(id));
    }
}

/// The key by what is written on it, for letters: Ctrl+Z is where the Z is, whatever the layout.
/// All others by where they are.
fn meant_key(input: &KeyboardInput) -> KeyCode {
    let Key::Character(text) = &input.logical_key else {
        return input.key_code;
    };
    let mut letters = text.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => letter_key(letter).unwrap_or(input.key_code),
        _ => input.key_code,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::command::{AddCommands, Command};
    use crate::editor::pointer::Armed;
    use crate::editor::schedule;
    use crate::editor::viewport::RegionDrag;
    use bevy::ecs::entity::Entity;

    fn input(key_code: KeyCode, logical: &str) -> KeyboardInput {
        KeyboardInput {
            key_code,
            logical_key: Key::Character(logical.into()),
            state: ButtonState::Pressed,
            text: None,
            repeat: false,
            window: Entity::PLACEHOLDER,
        }
    }

    #[test]
    fn letters_are_meant_by_what_is_written_on_them() {
        // The key right of T says Z on a German keyboard.
        assert_eq!(meant_key(&input(KeyCode::KeyY, "z")), KeyCode::KeyZ);
        assert_eq!(meant_key(&input(KeyCode::KeyY, "Z")), KeyCode::KeyZ);
        // A Cyrillic one is meant by its place, and so is a digit with Shift.
        assert_eq!(meant_key(&input(KeyCode::KeyZ, "я")), KeyCode::KeyZ);
        assert_eq!(meant_key(&input(KeyCode::Digit1, "!")), KeyCode::Digit1);
    }

    #[test]
    fn keys_with_ctrl_that_send_nothing_say_so_and_those_with_alt_why_they_are_none() {
        let mut world = World::new();
        world.init_resource::<Notices>();
        world.init_resource::<Preferences>();
        world.init_resource::<PointerUse>();
        world.init_resource::<CommandTable>();
        world.init_resource::<Recording>();
        let told = |world: &mut World| {
            let mut notices = world.resource_mut::<Notices>();
            let told: Vec<String> = notices.shown().iter().map(|n| n.text.clone()).collect();
            notices.close_all();
            told
        };
        for (keys, repeats, expected) in [
            (
                "Ctrl+E",
                false,
                &["No command: Ctrl+E. F1 lists all keys."][..],
            ),
            ("Ctrl+E", true, &[]),
            ("E", false, &[]),
        ] {
            press(&mut world, keys.parse().unwrap(), repeats);
            assert_eq!(told(&mut world), expected, "{keys}");
        }
        let ctrl = Keys {
            ctrl: true,
            shift: false,
            key: KeyCode::ControlLeft,
        };
        press(&mut world, ctrl, false);
        refuse_alt(&mut world, KeyCode::KeyA);
        assert_eq!(told(&mut world), [""; 0]);
        world.insert_resource(Recording(Some("edit.undo".into())));
        refuse_alt(&mut world, KeyCode::AltLeft);
        refuse_alt(&mut world, KeyCode::KeyA);
        assert_eq!(told(&mut world).len(), 1);
        // In an app of its own such keys may be the app's.
        world.insert_resource(Editing(true));
        press(&mut world, "Ctrl+E".parse().unwrap(), false);
        assert_eq!(told(&mut world), [""; 0]);
    }

    #[test]
    fn escape_ends_what_waits_for_the_pointer_and_only_then_is_a_command() {
        let mut world = World::new();
        world.init_resource::<Notices>();
        world.init_resource::<Preferences>();
        world.init_resource::<PointerUse>();
        world.init_resource::<Messages<Action>>();
        world.insert_resource(Armed::Aim);
        world.insert_resource(RegionDrag {
            is_armed: true,
            start: None,
        });
        let mut table = CommandTable::default();
        table.add(Command::new("none", "Select nothing", "", |_| {}).keys(&["Escape"]));
        world.insert_resource(table);
        for asked in [0, 0, 1] {
            press(&mut world, "Escape".parse().unwrap(), false);
            let mut actions = world.resource_mut::<Messages<Action>>();
            assert_eq!(actions.drain().count(), asked);
        }
        assert!(!world.resource::<RegionDrag>().is_armed);
        assert_eq!(*world.resource::<Armed>(), Armed::No);
    }

    #[test]
    fn keys_that_came_while_the_editor_was_off_are_nothing_to_it_but_those_that_are_held() {
        let mut app = App::new();
        app.add_message::<WindowEvent>()
            .insert_resource(Editing(true))
            .init_resource::<ButtonInput<KeyCode>>()
            .init_resource::<CommandTable>()
            .init_resource::<Notices>()
            .init_resource::<PointerUse>()
            .init_resource::<Preferences>()
            .init_resource::<Viewport>()
            .add_message::<Action>()
            .add_commands([Command::new("delete", "Delete", "", |_| {}).keys(&["Delete"])]);
        schedule::add_to(&mut app);
        app.add_plugins(KeysPlugin);
        let key = |app: &mut App, code: KeyCode, state: ButtonState| {
            let mut held = app.world_mut().resource_mut::<ButtonInput<KeyCode>>();
            match state {
                ButtonState::Pressed => held.press(code),
                ButtonState::Released => held.release(code),
            }
            let event = KeyboardInput {
                state,
                ..input(code, "")
            };
            app.world_mut()
                .write_message(WindowEvent::KeyboardInput(event));
        };
        let switch = |app: &mut App, on: bool| {
            app.insert_resource(Editing(on));
            app.update();
            let modifiers = app.world().resource::<Keyboard>().0.modifiers;
            let mut actions = app.world_mut().resource_mut::<Messages<Action>>();
            (modifiers.ctrl, actions.drain().count())
        };
        let [pressed, released] = [ButtonState::Pressed, ButtonState::Released];
        key(&mut app, KeyCode::ControlLeft, pressed);
        assert_eq!(switch(&mut app, true), (true, 0));
        // Ctrl+Delete is the app's key that switches: Delete alone would be a command.
        key(&mut app, KeyCode::Delete, pressed);
        switch(&mut app, false);
        key(&mut app, KeyCode::ControlLeft, released);
        switch(&mut app, false);
        assert_eq!(switch(&mut app, true), (false, 0), "Ctrl was let go");
        switch(&mut app, false);
        key(&mut app, KeyCode::ControlLeft, pressed);
        switch(&mut app, false);
        switch(&mut app, false);
        key(&mut app, KeyCode::Delete, pressed);
        assert_eq!(switch(&mut app, true), (true, 0), "Ctrl is held");
        key(&mut app, KeyCode::ControlLeft, released);
        assert_eq!(switch(&mut app, true), (false, 0));
    }
}
