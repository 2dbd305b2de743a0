//! Above the list: which pixel, which of its samples, which kinds of rays, and the search.

use super::super::fields::number_within;
use super::super::says::Says;
use crate::editor::command::{find, shortcut};
use crate::editor::inspection::choice::shoot_pixel;
use crate::editor::inspection::json::json;
use crate::editor::inspection::{DebugRay, Inspected, Which};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::inspect::{InspectSettings, RaySettings};
use crate::scene::Quantity;
use crate::scene::schema::quantity_of;
use bevy::ecs::world::World;
use bevy::math::UVec2;
use bevy_egui::egui::{Align, Button, Layout, TextEdit, Ui};

/// What the fields hold.
#[derive(Default)]
pub(super) struct Head {
    pixel: [u32; 2],
    /// The shot that they were filled from.
    of: u64,
    /// Samples of the pixel, while they are not known those of the one before.
    samples: Option<u64>,
}

/// Points of a number, and of one with a short slider.
const NUMBER: f32 = 44.0;
const SLIDER: f32 = 130.0;
/// More columns or rows than any picture has.
const MOST: u32 = 99_999;

pub(super) fn head_ui(ui: &mut Ui, world: &mut World, head: &mut Head) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        pixel_ui(ui, world, head);
        samples_ui(ui, world, head);
        ui.separator();
        kinds_ui(ui, world);
        ui.separator();
        let mut inspected = world.resource_mut::<Inspected>();
        let field = TextEdit::singleline(&mut inspected.arrangement.text)
            .hint_text("Filter")
            .desired_width(90.0);
        ui.add(field)
            .says("Lists only rays of which kind, end, objects or light contain this");
        let clear = ui.add_enabled(
            !inspected.arrangement.text.is_empty(),
            Button::new("✖").small(),
        );
        if clear.says("Lists all rays again").clicked() {
            inspected.arrangement.text.clear();
        }
        ui.separator();
        copy_ui(ui, world);
        place_ui(ui, world);
    });
}

fn pixel_ui(ui: &mut Ui, world: &mut World, head: &mut Head) {
    let ray = world.resource::<DebugRay>();
    if head.of != ray.shots() {
        head.of = ray.shots();
        if let Some(shot) = ray.shot() {
            head.pixel = shot.pixel.to_array();
        }
    }
    let size = ray.shot().map(|shot| shot.size);
    ui.label("Pixel").says(
        "The pixel whose rays these are: R or a click with Alt in the picture, or its column and row here",
    );
    let mut entered = false;
    for (i, says) in [
        "Column, from the left, 0 being the first",
        "Row, from the top, 0 being the first",
    ]
    .into_iter()
    .enumerate()
    {
        let pixels = Quantity::within(0.0, MOST.into(), "").step(0.25);
        let says = match size {
            Some(size) => format!("{says}; the picture has {}", size.to_array()[i]),
            None => says.to_owned(),
        };
        entered |= number_within(ui, &says, &mut head.pixel[i], pixels, NUMBER);
    }
    if entered {
        shoot_pixel(world, UVec2::from_array(head.pixel));
    }
}

fn samples_ui(ui: &mut Ui, world: &mut World, head: &mut Head) {
    let mut ray = world.resource_mut::<DebugRay>();
    // Nobody knows it from the moment a pixel is picked until it is traced.
    let known = ray.sample_count();
    head.samples = known.or(head.samples);
    let count = head.samples;
    let before = ray.which;
    let mut which = before;
    ui.label("sample")
        .says("Which of the pixel's samples are traced");
    ui.selectable_value(&mut which, Which::First, "first")
        .says("Sample 0 alone");
    let one = matches!(which, Which::Number(_));
    if ui
        .selectable_label(one, "one")
        .says("A single one, by its number")
        .clicked()
        && !one
    {
        which = Which::Number(0);
    }
    if let Which::Number(number) = &mut which {
        let last = count.map_or(*number, |count| count.saturating_sub(1));
        let samples = Quantity::slider(0.0, last.max(1) as f64, "");
        let says = match count {
            Some(count) => format!("Which sample, from 0; the pixel has {count}"),
            None => "Which sample, from 0".to_owned(),
        };
        // No pixel has more samples than that.
        let mut entered = u32::try_from(*number).unwrap_or(u32::MAX);
        if number_within(ui, &says, &mut entered, samples, SLIDER) {
            *number = entered.into();
        }
        if known.is_some() {
            *number = (*number).min(last);
        }
    }
    let all = match count {
        Some(count) => format!("all {count}"),
        None => "all".into(),
    };
    ui.selectable_value(&mut which, Which::All, all)
        .says("Every sample that a render takes of the pixel");
    if which != before {
        ray.which = which;
    }
}

/// The switches of the tab Debug: what is listed is what is drawn.
fn kinds_ui(ui: &mut Ui, world: &mut World) {
    let before = world.resource::<InspectSettings>();
    let mut rays = before.rays.clone();
    let is_drawn = before.on && before.rays.on;
    let mut draw = is_drawn;
    ui.toggle_value(&mut draw, "draw")
        .says("Draws the rays over the picture");
    let alone = ui.input(|input| input.modifiers.shift);
    let mut only = None;
    let kinds = [
        ("camera", "Rays from the camera"),
        ("mirror", "Reflections, sharp and blurred"),
        ("through", "Through transparent and translucent surfaces"),
        ("shadow", "To lights without extent"),
        ("light", "To points of lights with an extent"),
    ];
    let switches = switches_of(&mut rays);
    for (i, ((name, says), on)) in kinds.into_iter().zip(switches).enumerate() {
        let says = format!("{says}: listed and drawn. With Shift: these alone");
        if ui.toggle_value(on, name).says(&says).clicked() && alone {
            only = Some(i);
        }
    }
    if let Some(only) = only {
        for (i, on) in switches_of(&mut rays).into_iter().enumerate() {
            *on = i == only;
        }
    }
    ui.label("bounces ≤")
        .says("No ray behind more surfaces than this is listed or drawn");
    let says = "No ray behind more surfaces than this is listed or drawn";
    let bounces = quantity_of::<InspectSettings>("rays.max_depth");
    number_within(ui, says, &mut rays.max_depth, bounces, SLIDER);
    if rays != before.rays || draw != is_drawn {
        let mut settings = world.resource_mut::<InspectSettings>();
        settings.rays = rays;
        if draw != is_drawn {
            settings.rays.on = draw;
            // The master switch would keep it dark.
            settings.on |= draw;
        }
    }
}

/// Which kinds are listed and drawn.
fn switches_of(rays: &mut RaySettings) -> [&mut bool; 5] {
    [
        &mut rays.camera,
        &mut rays.mirror,
        &mut rays.transmission,
        &mut rays.shadow,
        &mut rays.light_samples,
    ]
}

fn copy_ui(ui: &mut Ui, world: &mut World) {
    let has = world.resource::<DebugRay>().rays().is_some();
    let button = ui.add_enabled(has, Button::new("Copy as JSON"));
    let says = "Copies all that is known of the pixel, as `glassbox inspect --json` writes it: samples, rays, lights, drawn lines, steps";
    if !button.says(says).clicked() {
        return;
    }
    match json(world) {
        Ok(text) => {
            let size = super::super::status::memory_text(text.len() as u64);
            world
                .resource_mut::<Notices>()
                .tell(format!("The rays are copied as JSON: {size}"));
            ui.ctx().copy_text(text);
        }
        Err(problem) => world.resource_mut::<Notices>().fault(problem),
    }
}

/// Where the inspector stands, and closing it.
fn place_ui(ui: &mut Ui, world: &mut World) {
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let close = ui.small_button("✖");
        let keys = find(world, "rays.inspector").and_then(|row| shortcut(world, &row));
        let keys = keys.map_or_else(String::new, |keys| format!(" ({keys})"));
        let says = format!("Closes the ray inspector{keys}");
        if close.says(&says).clicked() {
            world.resource_mut::<Preferences>().show_rays = false;
        }
        let floats = world.resource::<Preferences>().rays_float;
        let (name, says) = match floats {
            true => ("Dock", "Puts it below the picture"),
            false => (
                "Float",
                "Makes it a window over the picture, which keeps its size",
            ),
        };
        if ui.small_button(name).says(says).clicked() {
            world.resource_mut::<Preferences>().rays_float = !floats;
        }
    });
}
