//! The light mixer: every light with its own picture, its share of the image, solo, mute, gain, colour and temperature. All
//! of it multiplies what was traced: the scene stays as it is until the mix is baked into it. It is a window over the
//! picture, since a panel beside it would make the picture another one.
//!
//! | module | has |
//! |---|---|
//! | [`mix`] | what is set, what it makes of the lights, and baking it |
//! | [`sketches`] | the lights' own pictures |
//! | [`strip`] | the row of a light |
//! | [`groups`] | which lights stand together, by their names |
//! | [`commands`] | its rows in the table of commands |

mod commands;
mod groups;
mod mix;
mod sketches;
mod strip;

#[cfg(test)]
mod tests;

use super::says::Says;
use super::temperature::luminance;
use crate::editor::action::Action;
use crate::editor::document::SceneOpened;
use crate::editor::preferences::Preferences;
use crate::editor::viewport::traced_render;
use crate::scene::{RenderSettings, SceneId};
use crate::view::TracedRender;
use bevy::ecs::observer::On;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::{Mut, World};
use bevy_egui::egui::{self, Button, RichText, ScrollArea, Ui, UiBuilder, pos2, vec2};
use groups::{Row, rows_of};
use mix::{LightRow, lights};

pub(super) use commands::commands;
pub(super) use mix::{Mixer, apply};

/// Of the picture's height, what the rows take at most.
const PART: f32 = 0.6;

/// Points that the rows are wide at first.
const WIDTH: f32 = 420.0;
/// Points of the window's frame, and between it and the picture's edge.
const BESIDE: f32 = 28.0;

/// The mix of another scene says nothing about this one.
pub(super) fn forget_scene(_: On<SceneOpened>, mixer: Option<ResMut<Mixer>>) {
    if let Some(mut mixer) = mixer {
        mixer.forget_scene();
    }
}

/// The window, where it is open.
pub(super) fn mixer_ui(context: &egui::Context, free: egui::Rect, world: &mut World) {
    if !world.resource::<Mixer>().is_open {
        return;
    }
    world.resource_scope(|world, mut mixer: Mut<Mixer>| {
        let mut is_open = true;
        let most = (free.size() - vec2(20.0, 60.0)).max(vec2(300.0, 160.0));
        // As high as its rows, and where they are many most of the picture stays to be seen.
        let rows = (PART * free.height()).clamp(100.0, most.y - 60.0);
        let width = WIDTH.min(most.x);
        // On the right, where there is room: the legend of lines and the comparison of pictures begin on the left.
        let left = (free.max.x - width - BESIDE).max(free.min.x + 12.0);
        egui::Window::new("Light mixer")
            .id(egui::Id::new("light mixer"))
            .open(&mut is_open)
            .collapsible(true)
            .default_width(width)
            .default_pos(pos2(left, free.min.y + 12.0))
            .min_width(300.0)
            .max_width(most.x)
            .resizable([true, false])
            .constrain_to(free)
            .show(context, |ui| {
                super::contained_in_width(ui, |ui| inner_ui(ui, rows, world, &mut mixer));
            });
        mixer.is_open = is_open;
    });
}

/// `most` is the height that the rows take at most: the others are scrolled to.
fn inner_ui(ui: &mut Ui, most: f32, world: &mut World, mixer: &mut Mixer) {
    let lights = lights(world);
    update_sketches(ui.ctx(), world, mixer, &lights);
    let render = traced_render(world).and_then(TracedRender::render);
    let film = render.map(|render| render.memory());
    let is_apart = film.is_some_and(|film| film.planes > 0);
    if !is_apart {
        let why = match (film, world.resource::<Preferences>().lights_apart) {
            (None, _) => "The view shows no traced picture.",
            (Some(_), false) => {
                "Lights are not kept apart (Render, Film): there are no pictures of single lights, and what is set here renders the picture again."
            }
            (Some(_), true) => {
                "The picture is too large to keep lights apart: there are no pictures of single lights, and what is set here renders it again."
            }
        };
        let color = ui.visuals().warn_fg_color;
        ui.add(egui::Label::new(RichText::new(why).color(color)).wrap());
    }
    if lights.is_empty() {
        ui.weak("The scene has no lights.");
    } else {
        rows_ui(ui, most, world, mixer, &lights);
    }
    ui.separator();
    foot_ui(ui, world, mixer);
}

fn rows_ui(ui: &mut Ui, most: f32, world: &mut World, mixer: &mut Mixer, lights: &[LightRow]) {
    let shares = Shares::of(mixer);
    let rows = rows_of(lights, &mixer.folded);
    let heights: f32 = rows.iter().map(Row::height).sum();
    ScrollArea::vertical()
        .id_salt("rows of the light mixer")
        .auto_shrink([false, true])
        .max_height(most)
        .show_viewport(ui, |ui, seen| {
            let (width, corner) = (ui.available_width(), ui.max_rect().min);
            ui.set_height(heights);
            let mut top = 0.0;
            for row in &rows {
                let height = row.height();
                let is_seen = top < seen.max.y && top + height > seen.min.y;
                let size = vec2(width, height);
                let place = egui::Rect::from_min_size(corner + vec2(0.0, top), size);
                top += height;
                if !is_seen {
                    continue;
                }
                let inner = UiBuilder::new().max_rect(place).id_salt(row.key());
                ui.scope_builder(inner, |ui| match row {
                    Row::Own => strip::own_ui(ui, mixer, &shares),
                    Row::Group { name, lights } => {
                        group_ui(ui, mixer, name, lights, &shares);
                    }
                    Row::Light(light) => strip::light_ui(ui, world, mixer, light, &shares),
                });
            }
        });
}

fn update_sketches(
    context: &egui::Context,
    world: &mut World,
    mixer: &mut Mixer,
    lights: &[LightRow],
) {
    let Some(render) = traced_render(world).and_then(TracedRender::render) else {
        return;
    };
    let output = world.resource::<RenderSettings>().output;
    let factors: Vec<_> = lights
        .iter()
        .map(|light| (light.id.0, mixer.strip(light.id).factor()))
        .collect();
    let factors = || factors.into_iter().collect();
    mixer.sketches.update(context, render, &output, factors);
}

/// What parts of the image are whose.
struct Shares {
    own: Option<f32>,
    lights: Vec<(SceneId, f32)>,
}

impl Shares {
    fn of(mixer: &Mixer) -> Self {
        let sketches = mixer.sketches.all();
        let of_one = sketches.iter().map(|sketch| match sketch.ids[..] {
            [id] => luminance(mixer.factor(id) * sketch.mean),
            _ => luminance(sketch.mean),
        });
        let brightness: Vec<f32> = of_one.collect();
        let whole: f32 = brightness.iter().sum();
        let mut shares = Self {
            own: None,
            lights: Vec::new(),
        };
        if !(whole > 0.0 && whole.is_finite()) {
            return shares;
        }
        for (sketch, brightness) in sketches.iter().zip(brightness) {
            match sketch.ids[..] {
                [] => shares.own = Some(brightness / whole),
                [id] => shares.lights.push((id, brightness / whole)),
                _ => {}
            }
        }
        shares
    }

    fn of_light(&self, id: SceneId) -> Option<f32> {
        let mut all = self.lights.iter();
        all.find(|(other, _)| *other == id).map(|(_, share)| *share)
    }
}

fn share_text(share: Option<f32>) -> String {
    share.map_or_else(|| "–".into(), |share| format!("{:.1} %", 100.0 * share))
}

/// The heading of lights whose names begin alike.
fn group_ui(ui: &mut Ui, mixer: &mut Mixer, name: &str, lights: &[SceneId], shares: &Shares) {
    ui.horizontal(|ui| {
        let is_folded = mixer.folded.contains(name);
        let arrow = if is_folded { "⏵" } else { "⏷" };
        let text = RichText::new(format!("{arrow} {name} ({})", lights.len())).strong();
        let says = format!("Lights whose names begin with {name}; a click folds them");
        if ui.add(Button::new(text).frame(false)).says(&says).clicked() {
            match is_folded {
                true => mixer.folded.remove(name),
                false => mixer.folded.insert(name.to_owned()),
            };
        }
        let known: Vec<f32> = (lights.iter())
            .filter_map(|id| shares.of_light(*id))
            .collect();
        let share = (known.len() == lights.len()).then(|| known.iter().sum());
        ui.weak(share_text(share))
            .says("Their share of the image's brightness");
        let all_of = |is: fn(&mix::Strip) -> bool| lights.iter().all(|id| is(&mixer.strip(*id)));
        let [is_solo, is_muted] = [
            all_of(|strip| strip.is_solo),
            all_of(|strip| strip.is_muted),
        ];
        let solo = strip::toggle(ui, "S", is_solo, &format!("Solo all of {name}"));
        let mute = strip::toggle(ui, "M", is_muted, &format!("Mute all of {name}"));
        if solo || mute {
            for &id in lights {
                let mut strip = mixer.strip(id);
                strip.is_solo = if solo { !is_solo } else { strip.is_solo };
                strip.is_muted = if mute { !is_muted } else { strip.is_muted };
                mixer.set(id, strip);
            }
        }
    });
}

fn foot_ui(ui: &mut Ui, world: &mut World, mixer: &Mixer) {
    ui.horizontal(|ui| {
        for (id, text) in [
            ("lights.bake", "Bake into the lights"),
            ("lights.reset-mix", "Reset"),
        ] {
            let button = ui.add_enabled(!mixer.is_neutral(), Button::new(text));
            let says = crate::editor::command::tooltip(world, id);
            if button.says(&says).clicked() {
                world.write_message(Action::run(id));
            }
        }
        if mixer.is_neutral() {
            ui.weak("As the scene has it");
        }
    });
}
