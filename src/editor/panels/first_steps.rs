//! The card of the first start: three things to try, each with one click.

use super::notices::is_over;
use super::says::Says;
use crate::editor::action::Action;
use crate::editor::command::{State, find, shortcut};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::scene::{AnyLamp, SceneId};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Align2, Button, Id, Rect, RichText, Ui, vec2};

/// Which of them were tried.
#[derive(Resource, Default)]
pub(super) struct FirstSteps([bool; 3]);

/// Points.
const WIDTH: f32 = 250.0;

/// Shows it again, or takes it away.
pub(super) fn toggle(world: &mut World) {
    let mut preferences = world.resource_mut::<Preferences>();
    preferences.hint_seen = !preferences.hint_seen;
    *world.resource_mut::<FirstSteps>() = FirstSteps::default();
}

pub(super) fn is_shown(world: &World) -> State {
    State::switch(!world.resource::<Preferences>().hint_seen)
}

/// Shows it until it was closed once; true where the pointer is over it.
pub(super) fn first_steps_ui(
    context: &egui::Context,
    free: Rect,
    world: &mut World,
    tried: &mut FirstSteps,
) -> bool {
    if world.resource::<Preferences>().hint_seen {
        return false;
    }
    // Below, where it hides neither the lamp nor what is said of lines.
    let beside = context.viewport_rect().max - free.max + vec2(12.0, 12.0);
    let mut seen = false;
    let area = egui::Area::new(Id::new("first steps"))
        .anchor(Align2::RIGHT_BOTTOM, -beside)
        .order(egui::Order::Middle)
        .show(context, |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(egui::Margin::same(10))
                .show(ui, |ui| {
                    ui.set_width(WIDTH.min(free.width() - 40.0));
                    seen = card_ui(ui, world, tried);
                });
        });
    if seen {
        world.resource_mut::<Preferences>().hint_seen = true;
    }
    is_over(context, area.response.rect)
}

/// Its content; true where it is to be shown no more.
fn card_ui(ui: &mut Ui, world: &mut World, tried: &mut FirstSteps) -> bool {
    let mut seen = false;
    ui.horizontal(|ui| {
        ui.label(RichText::new("First steps").strong());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let close = ui.small_button("Close");
            let says = "Does not show this again; Help, First steps does";
            seen = close.says(says).clicked();
        });
    });
    let steps: [Step; 3] = [
        (
            "Drag the lamp",
            "Selects the light and shows its arrows: drag one, and the picture follows",
            take_the_lamp,
        ),
        (
            "Ask a pixel why it is dark",
            "Then click a dark place of the picture: a sentence says what is in the light's way",
            |world| {
                world.write_message(Action::run("why.black"));
            },
        ),
        (
            "Look at the tree",
            "Draws the boxes that make rays fast, bright where they pay most",
            |world| {
                world.write_message(Action::run("lines.is-tree-good"));
            },
        ),
    ];
    for (i, (name, says, run)) in steps.into_iter().enumerate() {
        let mark = if tried.0[i] { "✔" } else { "➡" };
        let button = Button::new(format!("{mark}  {name}"));
        let button = button.min_size(vec2(ui.available_width(), 0.0));
        if ui.add(button).says(says).clicked() {
            tried.0[i] = true;
            run(world);
        }
    }
    let keys = |id| find(world, id).and_then(|row| shortcut(world, &row));
    let keys = ["help.palette", "help.keys"].map(|id| keys(id).unwrap_or_default());
    ui.weak(format!(
        "Middle drag turns the view, the wheel zooms. {}: all commands, {}: all keys.",
        keys[0], keys[1]
    ));
    seen
}

/// Its name, what it does, and doing it.
type Step = (&'static str, &'static str, fn(&mut World));

fn take_the_lamp(world: &mut World) {
    let mut lamps = world.query_filtered::<&SceneId, AnyLamp>();
    let Some(lamp) = lamps.iter(world).min().copied() else {
        let text = "This scene has no light: the menu Add has some.";
        world.resource_mut::<Notices>().tell(text);
        return;
    };
    world.write_message(Action::Select(vec![lamp]));
    world.write_message(Action::run("tool.move"));
    let text = "Drag one of the lamp's arrows: the picture follows.";
    world.resource_mut::<Notices>().tell(text);
}
