//! What egui tells of its controls reaches the platform's screen readers, and what those ask for reaches egui.
//!
//! Bevy's window speaks to the platform, but only of entities of Bevy's own; egui lists its controls, but speaks to nobody.

use bevy::a11y::{
    AccessibilityRequested, AccessibilitySystems, ActionRequest, ManageAccessibilityUpdates,
};
use bevy::app::{App, Plugin, PostUpdate, PreUpdate};
use bevy::ecs::entity::Entity;
use bevy::ecs::message::{MessageReader, MessageWriter};
use bevy::ecs::query::With;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::schedule::common_conditions::resource_exists;
use bevy::ecs::system::{NonSendMarker, Query, Res, ResMut};
use bevy::window::PrimaryWindow;
use bevy::winit::accessibility::ACCESS_KIT_ADAPTERS;
use bevy_egui::input::EguiInputEvent;
use bevy_egui::{
    EguiContext, EguiInputSet, EguiOutput, EguiPostUpdateSet, PrimaryEguiContext, egui,
};

/// Tells screen readers of the panels.
pub(super) struct ScreenReaderPlugin;

impl Plugin for ScreenReaderPlugin {
    fn build(&self, app: &mut App) {
        // An app without a window has no platform to tell.
        let may_be_asked = resource_exists::<AccessibilityRequested>;
        app.add_systems(
            PreUpdate,
            (begin_to_list, hear)
                .run_if(may_be_asked)
                .in_set(EguiInputSet::ReadBevyMessages),
        )
        .add_systems(
            PostUpdate,
            tell.run_if(may_be_asked)
                .after(EguiPostUpdateSet::ProcessOutput)
                .before(AccessibilitySystems::Update),
        );
    }
}

/// Only once somebody asked: all controls are listed in every frame.
fn begin_to_list(
    requested: Res<AccessibilityRequested>,
    mut contexts: Query<&mut EguiContext, With<PrimaryEguiContext>>,
) {
    if requested.get() {
        for mut context in &mut contexts {
            context.get_mut().enable_accesskit();
        }
    }
}

fn tell(
    mut by_bevy: ResMut<ManageAccessibilityUpdates>,
    outputs: Query<&EguiOutput, With<PrimaryEguiContext>>,
    windows: Query<Entity, With<PrimaryWindow>>,
    _on_the_main_thread: NonSendMarker,
) {
    let Ok(window) = windows.single() else {
        return;
    };
    let updates = outputs
        .iter()
        .filter_map(|output| output.platform_output.accesskit_update.as_ref());
    for update in updates {
        // Two that each name the root would contradict each other.
        by_bevy.set(false);
        ACCESS_KIT_ADAPTERS.with_borrow_mut(|adapters| {
            if let Some(adapter) = adapters.get_mut(&window) {
                adapter.update_if_active(|| update.clone());
            }
        });
    }
}

/// A press, a new value or the focus, as a screen reader asks for it.
fn hear(
    mut requests: MessageReader<ActionRequest>,
    contexts: Query<Entity, With<PrimaryEguiContext>>,
    mut events: MessageWriter<EguiInputEvent>,
) {
    for request in requests.read() {
        events.write_batch(contexts.iter().map(|context| EguiInputEvent {
            context,
            event: egui::Event::AccessKitActionRequest(request.0.clone()),
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::app::App;
    use bevy::ecs::message::Messages;
    use bevy_egui::egui::accesskit::{Action, ActionRequest as Request, Role, TreeId};

    /// An app with a window that no platform knows, and an egui context with one button.
    fn app_with_button() -> (App, Entity) {
        let mut app = App::new();
        app.init_resource::<AccessibilityRequested>()
            .init_resource::<ManageAccessibilityUpdates>()
            .add_message::<ActionRequest>()
            .add_message::<EguiInputEvent>()
            .add_plugins(ScreenReaderPlugin);
        app.world_mut().spawn(PrimaryWindow);
        let context = (
            EguiContext::default(),
            PrimaryEguiContext,
            EguiOutput::default(),
        );
        let context = app.world_mut().spawn(context).id();
        (app, context)
    }

    /// A frame with this said to egui; whether the button was pressed.
    fn frame(app: &mut App, context: Entity) -> bool {
        app.world_mut().run_schedule(PreUpdate);
        let mut heard = app.world_mut().resource_mut::<Messages<EguiInputEvent>>();
        let events = heard.drain().map(|heard| heard.event).collect();
        let egui = app
            .world_mut()
            .get_mut::<EguiContext>(context)
            .unwrap()
            .get_mut()
            .clone();
        let mut pressed = false;
        let input = egui::RawInput {
            events,
            ..egui::RawInput::default()
        };
        let output = egui.run_ui(input, |ui| pressed = ui.button("Trace").clicked());
        let mut told = app.world_mut().get_mut::<EguiOutput>(context).unwrap();
        told.platform_output = output.platform_output;
        app.world_mut().run_schedule(PostUpdate);
        pressed
    }

    #[test]
    fn controls_are_listed_once_a_screen_reader_asks_and_do_what_it_asks_for() {
        let (mut app, context) = app_with_button();
        let list = |app: &App| {
            let output = app.world().get::<EguiOutput>(context).unwrap();
            output.platform_output.accesskit_update.clone()
        };
        assert!(!frame(&mut app, context));
        assert!(list(&app).is_none(), "nobody asked");
        assert!(app.world().resource::<ManageAccessibilityUpdates>().get());
        app.world().resource::<AccessibilityRequested>().set(true);
        assert!(!frame(&mut app, context));
        let update = list(&app).expect("the controls are listed");
        let is_button = |node: &egui::accesskit::Node| node.role() == Role::Button;
        let (button, node) = update
            .nodes
            .iter()
            .find(|(_, node)| is_button(node))
            .unwrap();
        assert_eq!(node.label(), Some("Trace"));
        assert!(!app.world().resource::<ManageAccessibilityUpdates>().get());
        app.world_mut().write_message(ActionRequest(Request {
            action: Action::Click,
            target_tree: TreeId::ROOT,
            target_node: *button,
            data: None,
        }));
        assert!(frame(&mut app, context), "the button is pressed");
        assert!(!frame(&mut app, context), "once");
    }
}
