//! Keys as egui hears of them, each with the modifiers that were held when it was pressed.
//!
//! The bridge to egui looks at the modifiers once a frame: where Ctrl was let go in the same frame in which A was pressed,
//! as it is where frames take long, it types an "a" in place of choosing all.

use bevy::app::{App, Plugin, PreUpdate};
use bevy::ecs::entity::Entity;
use bevy::ecs::message::{MessageReader, MessageWriter};
use bevy::ecs::query::{Added, With};
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Local, Query, Res, ResMut};
use bevy::input::keyboard::{Key, KeyboardFocusLost, KeyboardInput};
use bevy_egui::helpers::{bevy_to_egui_key, bevy_to_egui_physical_key};
use bevy_egui::input::{EguiInputEvent, ModifierKeysState, WindowToEguiContextMap};
use bevy_egui::{EguiClipboard, EguiContextSettings, EguiInputSet, PrimaryEguiContext, egui};

/// Tells the panels of keys, in place of the bridge.
pub(super) struct KeyboardPlugin;

impl Plugin for KeyboardPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PreUpdate,
            (
                take_over.in_set(EguiInputSet::InitReading),
                tell_keys.in_set(EguiInputSet::ReadBevyMessages),
            ),
        );
    }
}

/// The bridge tells the panels of keys no more; an app's other contexts keep it.
fn take_over(
    mut contexts: Query<
        &mut EguiContextSettings,
        (With<PrimaryEguiContext>, Added<EguiContextSettings>),
    >,
) {
    for mut settings in &mut contexts {
        let systems = &mut settings.input_system_settings;
        systems.run_write_keyboard_input_messages_system = false;
    }
}

fn tell_keys(
    mut keys: MessageReader<KeyboardInput>,
    mut lost: MessageReader<KeyboardFocusLost>,
    mut held: Local<ModifierKeysState>,
    windows: Res<WindowToEguiContextMap>,
    contexts: Query<Entity, With<PrimaryEguiContext>>,
    mut clipboard: Option<ResMut<EguiClipboard>>,
    mut events: MessageWriter<EguiInputEvent>,
) {
    // Who leaves the window lets go of its keys elsewhere.
    if lost.read().count() > 0 {
        *held = ModifierKeysState::default();
    }
    for key in keys.read() {
        hold(&mut held, key);
        let told = events_of(key, &held, || clipboard.as_mut()?.get_text());
        let of_window =
            |context: &Entity| windows.context_to_window.get(context) == Some(&key.window);
        for context in contexts.iter().filter(of_window) {
            events.write_batch(
                told.iter()
                    .cloned()
                    .map(|event| EguiInputEvent { context, event }),
            );
        }
    }
}

fn hold(held: &mut ModifierKeysState, key: &KeyboardInput) {
    let pressed = key.state.is_pressed();
    match key.logical_key {
        Key::Shift => held.shift = pressed,
        Key::Control => held.ctrl = pressed,
        Key::Alt => held.alt = pressed,
        Key::Super | Key::Meta => held.win = pressed,
        _ => {}
    }
}

/// What egui is told of a key, as the bridge would: the text that it types, itself, and what it does to the clipboard.
fn events_of(
    key: &KeyboardInput,
    held: &ModifierKeysState,
    pasted: impl FnOnce() -> Option<String>,
) -> Vec<egui::Event> {
    let pressed = key.state.is_pressed();
    let mut events = Vec::new();
    if pressed && held.text_input_is_allowed() {
        let text = match &key.logical_key {
            Key::Character(text) if !text.contains(char::is_control) => Some(text.to_string()),
            Key::Space => Some(" ".to_owned()),
            _ => None,
        };
        events.extend(text.map(egui::Event::Text));
    }
    let physical_key = bevy_to_egui_physical_key(&key.key_code);
    // Layouts without Latin letters have shortcuts by the key's place.
    let Some(named) = bevy_to_egui_key(&key.logical_key).or(physical_key) else {
        return events;
    };
    let modifiers = held.to_egui_modifiers();
    events.push(egui::Event::Key {
        key: named,
        physical_key,
        pressed,
        repeat: false,
        modifiers,
    });
    if pressed && modifiers.command {
        events.extend(match named {
            egui::Key::C => Some(egui::Event::Copy),
            egui::Key::X => Some(egui::Event::Cut),
            egui::Key::V => pasted().map(egui::Event::Text),
            _ => None,
        });
    }
    events
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::message::Messages;
    use bevy::input::ButtonState;
    use bevy::input::keyboard::KeyCode;
    use bevy_egui::EguiContext;

    /// What the panels are told in a frame in which these keys go down and up.
    fn told(
        app: &mut App,
        window: Entity,
        keys: &[(KeyCode, Key, ButtonState)],
    ) -> Vec<egui::Event> {
        for (key_code, logical_key, state) in keys {
            app.world_mut().write_message(KeyboardInput {
                key_code: *key_code,
                logical_key: logical_key.clone(),
                state: *state,
                text: None,
                repeat: false,
                window,
            });
        }
        app.world_mut().run_schedule(PreUpdate);
        let mut told = app.world_mut().resource_mut::<Messages<EguiInputEvent>>();
        told.drain().map(|told| told.event).collect()
    }

    fn app_with_panels() -> (App, [Entity; 2]) {
        let mut app = App::new();
        app.init_resource::<WindowToEguiContextMap>()
            .add_message::<KeyboardInput>()
            .add_message::<KeyboardFocusLost>()
            .add_message::<EguiInputEvent>()
            .add_plugins(KeyboardPlugin);
        let panels = (
            EguiContext::default(),
            EguiContextSettings::default(),
            PrimaryEguiContext,
        );
        let panels = app.world_mut().spawn(panels).id();
        let [own, other] = [(), ()].map(|()| app.world_mut().spawn_empty().id());
        let mut windows = app.world_mut().resource_mut::<WindowToEguiContextMap>();
        windows.context_to_window.insert(panels, own);
        (app, [own, other])
    }

    #[test]
    fn a_key_has_the_modifiers_that_were_held_when_it_was_pressed_however_long_the_frame_was() {
        use ButtonState::{Pressed, Released};
        let (mut app, [own, other]) = app_with_panels();
        let a = || Key::Character("a".into());
        let choose_all = [
            (KeyCode::ControlLeft, Key::Control, Pressed),
            (KeyCode::KeyA, a(), Pressed),
            (KeyCode::KeyA, a(), Released),
            (KeyCode::ControlLeft, Key::Control, Released),
        ];
        let is_pressed = |event: &egui::Event, ctrl: bool| {
            matches!(event, egui::Event::Key { key: egui::Key::A, pressed: true, modifiers, .. }
                if modifiers.command == ctrl)
        };
        let events = told(&mut app, own, &choose_all);
        assert!(
            events.iter().any(|event| is_pressed(event, true)),
            "{events:?}"
        );
        let types = |event: &egui::Event| matches!(event, egui::Event::Text(_));
        assert!(!events.iter().any(types), "{events:?}");
        let events = told(&mut app, own, &[(KeyCode::KeyA, a(), Pressed)]);
        assert!(
            events.contains(&egui::Event::Text("a".into())),
            "{events:?}"
        );
        assert!(
            events.iter().any(|event| is_pressed(event, false)),
            "{events:?}"
        );
        // Keys of another window are not the panels'.
        assert_eq!(told(&mut app, other, &choose_all), []);
        let mut settings = app.world_mut().query::<&EguiContextSettings>();
        let settings = settings.single(app.world()).unwrap();
        let systems = &settings.input_system_settings;
        assert!(!systems.run_write_keyboard_input_messages_system);
    }

    #[test]
    fn what_is_pressed_when_the_window_is_left_is_let_go() {
        let (mut app, [own, _]) = app_with_panels();
        let control = (KeyCode::ControlLeft, Key::Control, ButtonState::Pressed);
        told(&mut app, own, &[control]);
        app.world_mut().write_message(KeyboardFocusLost);
        let b = (
            KeyCode::KeyB,
            Key::Character("b".into()),
            ButtonState::Pressed,
        );
        let events = told(&mut app, own, &[b]);
        assert!(
            events.contains(&egui::Event::Text("b".into())),
            "{events:?}"
        );
    }
}
