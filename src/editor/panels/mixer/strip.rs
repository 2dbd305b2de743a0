//! The row of a light: its picture, its share, and what is set for it.

use super::super::fields::{color_ui, number, number_row, row};
use super::super::number_field::set_owner;
use super::super::says::Says;
use super::super::temperature::OF_LIGHTS;
use super::super::thumbnail::thumbnail_ui;
use super::mix::{LightRow, Mixer};
use super::sketches::Sketch;
use super::{Shares, share_text};
use crate::editor::action::Action;
use crate::scene::Quantity;
use crate::trace::Gains;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Button, Color32, RichText, Sense, Ui, WidgetInfo, WidgetType, vec2};

/// Points of a light's picture.
const PICTURE: egui::Vec2 = vec2(96.0, 54.0);
const GAIN: Quantity = Quantity::within(0.0, Gains::MOST as f64, "×")
    .shown(0.01, 100.0)
    .logarithmic()
    .step(0.02);

/// A button that is on or off, and what programs that read the screen aloud call it; true where it was clicked.
pub(super) fn toggle(ui: &mut Ui, text: &str, is_on: bool, says: &str) -> bool {
    let response = ui.add(Button::selectable(is_on, text).frame_when_inactive(true));
    response.widget_info(|| WidgetInfo::selected(WidgetType::Button, true, is_on, says));
    response.says(says).clicked()
}

fn picture_ui(ui: &mut Ui, sketch: Option<&Sketch>, is_silent: bool, says: &str) {
    let (place, response) = ui.allocate_exact_size(PICTURE, Sense::hover());
    let tint = match is_silent {
        true => Color32::from_gray(70),
        false => Color32::WHITE,
    };
    thumbnail_ui(ui, place, sketch.map(|sketch| &sketch.texture), tint);
    response.says(says);
}

/// What shines by itself.
pub(super) fn own_ui(ui: &mut Ui, mixer: &Mixer, shares: &Shares) {
    ui.horizontal(|ui| {
        let says =
            "What shines by itself: glowing surfaces and the background, and their mirror pictures";
        picture_ui(ui, mixer.sketches.own(), false, says);
        ui.label("No light").says(says);
        ui.weak(share_text(shares.own))
            .says("Its share of the image's brightness");
    });
}

/// A light.
pub(super) fn light_ui(
    ui: &mut Ui,
    world: &mut World,
    mixer: &mut Mixer,
    light: &LightRow,
    shares: &Shares,
) {
    let name = &light.name;
    let before = mixer.strip(light.id);
    let mut strip = before.clone();
    set_owner(ui.ctx(), ("light mixer", light.id));
    ui.horizontal_top(|ui| {
        let sketch = mixer.sketches.of(light.id);
        let others = sketch.map_or(0, |sketch| sketch.ids.len().saturating_sub(1));
        let says = match others {
            0 => format!("What {name} adds to the picture, as it is set here"),
            others => format!(
                "What {name} and {others} other lights add together: there are too many for a picture each. What is set for one of them traces their light again; then it has a picture of its own"
            ),
        };
        picture_ui(ui, sketch, mixer.is_silent(light.id), &says);
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.horizontal(|ui| {
                let solo = format!("Solo {name}: without the lights that are not");
                strip.is_solo ^= toggle(ui, "S", strip.is_solo, &solo);
                let mute = format!("Mute {name}: without it");
                strip.is_muted ^= toggle(ui, "M", strip.is_muted, &mute);
                let text = match others {
                    0 => share_text(shares.of_light(light.id)),
                    others => format!("shares with {others}"),
                };
                ui.weak(if light.is_shown { text } else { "hidden".into() })
                    .says(match others {
                        0 => "Its share of the image's brightness, of some pixels of it",
                        _ => &says,
                    });
                let label = Button::new(RichText::new(name).strong())
                    .frame(false)
                    .truncate();
                if ui.add(label).says("Selects the light").clicked() {
                    world.write_message(Action::Select(vec![light.id]));
                }
            });
            let says = format!("Multiplies the light of {name}; 1 is as the scene has it");
            number_row(ui, "Gain", &says, &mut strip.gain, GAIN);
            let says = format!("Multiplies the light of {name}, channel by channel");
            row(ui, "Colour", &says, |ui| {
                color_ui(ui, &format!("Colour of {name}: white is as the scene has it"), &mut strip.color, false);
                let says = format!(
                    "Temperature of {name}: its light becomes that of a body so hot; it says what the light itself is said to have"
                );
                let mut kelvin = strip.kelvin_of(light);
                if number(ui, &says, &mut kelvin, OF_LIGHTS) {
                    strip.set_kelvin(light, kelvin);
                }
            });
        });
    });
    if strip != before {
        mixer.set(light.id, strip);
    }
}
