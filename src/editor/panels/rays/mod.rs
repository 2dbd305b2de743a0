//! The ray inspector: the debug ray's rays as a tree with their numbers, why the pixel has its value,
//! and one ray's way through the trees. Below the picture, or in a window over it.
//!
//! | module | draws |
//! |---|---|
//! | [`head`] | which pixel, which samples, which kinds; the search; JSON |
//! | [`table`] | the list of rays |
//! | [`why`] | where the value and its noise come from |
//! | [`detail`] | every number of the chosen ray |
//! | [`steps`] | its way through the trees |
//! | [`foot`] | what the rays add up to |

mod detail;
mod foot;
mod head;
mod steps;
mod table;
mod why;

#[cfg(test)]
mod tests;

use super::says::Says;
use crate::editor::inspection::choice::Side;
use crate::editor::inspection::{DebugRay, Inspected, shoot_middle};
use crate::editor::preferences::Preferences;
use crate::inspect::{InspectSettings, Names};
use crate::scene::RenderSettings;
use crate::trace::{RayKind, RayTree};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{Mut, World};
use bevy_egui::egui::{self, ScrollArea, Ui, vec2};

/// The least height of the panel, in points.
pub(super) const LEAST_HEIGHT: f32 = 150.0;
/// What is left for the picture above it at least.
const LEAST_PICTURE: f32 = 170.0;

/// What the ray inspector remembers between two frames.
#[derive(Resource, Default)]
pub(in crate::editor::panels) struct RaysPanel {
    /// The pixel in the fields.
    head: head::Head,
    why: why::Why,
    /// How many rows the list laid out in this frame.
    pub rows_drawn: usize,
}

/// As a panel below the picture; what it takes is remembered.
pub(super) fn panel_ui(ui: &mut Ui, world: &mut World, panel: &mut RaysPanel) {
    let preferences = world.resource::<Preferences>();
    if !preferences.show_rays || preferences.rays_float {
        return;
    }
    let height = preferences.rays_height;
    let most = (ui.available_height() - LEAST_PICTURE).max(LEAST_HEIGHT);
    let fill = ui.visuals().panel_fill;
    let shown = egui::Panel::bottom("rays")
        .resizable(true)
        .default_size(height)
        .size_range(LEAST_HEIGHT..=most)
        .frame(
            egui::Frame::new()
                .fill(fill)
                .inner_margin(egui::Margin::symmetric(6, 4)),
        )
        .show_inside(ui, |ui| {
            super::contained(ui, |ui| rays_ui(ui, world, panel));
        });
    // The height that a low window forces is not one that a person chose.
    let taken = shown.response.rect.height();
    if ui.ctx().egui_is_using_pointer() && (taken - height).abs() > 0.5 {
        world.resource_mut::<Preferences>().rays_height = taken;
    }
}

/// As a window over the picture.
pub(super) fn window_ui(
    context: &egui::Context,
    free: egui::Rect,
    world: &mut World,
    panel: &mut RaysPanel,
) {
    let preferences = world.resource::<Preferences>();
    if !preferences.show_rays || !preferences.rays_float {
        return;
    }
    let screen = context.content_rect().size();
    let size = vec2(
        (0.9 * screen.x).min(980.0),
        preferences.rays_height.min(0.6 * screen.y),
    );
    // Above the status line, over the picture's lower part.
    let bottom = context.content_rect().max.y;
    let corner = egui::pos2(free.min.x + 12.0, bottom - size.y - 80.0);
    egui::Window::new("Ray inspector")
        .id(egui::Id::new("rays in a window"))
        .collapsible(false)
        .default_size(size)
        .default_pos(corner)
        .min_size(vec2(420.0, LEAST_HEIGHT))
        .max_size(screen - vec2(20.0, 20.0))
        .resizable(true)
        .show(context, |ui| {
            super::contained(ui, |ui| rays_ui(ui, world, panel));
        });
}

fn rays_ui(ui: &mut Ui, world: &mut World, panel: &mut RaysPanel) {
    head::head_ui(ui, world, &mut panel.head);
    let ray = world.resource::<DebugRay>();
    let (rays, number) = (ray.rays().cloned(), ray.number());
    let says = ray.says();
    let busy = ray.is_busy();
    let is_picked = ray.shot().is_some();
    if let Some(says) = &says {
        let color = match rays {
            Some(_) => ui.visuals().warn_fg_color,
            None => ui.visuals().text_color(),
        };
        ui.add(egui::Label::new(egui::RichText::new(says).color(color)).wrap());
    }
    if busy {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label("All samples of the pixel are being traced");
        });
    }
    let Some(rays) = rays else {
        if !is_picked {
            none_picked_ui(ui, world);
        }
        return;
    };
    let fill = egui::Frame::new().inner_margin(egui::Margin::symmetric(0, 2));
    egui::Panel::bottom("foot of the rays")
        .frame(fill)
        .show_separator_line(true)
        .show_inside(ui, |ui| foot::foot_ui(ui, world, &rays));
    let width = (0.3 * ui.available_width()).clamp(230.0, 380.0);
    egui::Panel::right("side of the rays")
        .frame(egui::Frame::new().inner_margin(egui::Margin {
            left: 10,
            ..egui::Margin::ZERO
        }))
        .resizable(true)
        .default_size(width)
        .size_range(200.0..=(ui.available_width() - 200.0).max(200.0))
        .show_inside(ui, |ui| {
            super::contained(ui, |ui| side_ui(ui, world, &mut panel.why, &rays, number));
        });
    let kinds = world.resource::<InspectSettings>().rays.clone();
    let exposure = world.resource::<RenderSettings>().output.exposure;
    world.resource_scope(|world, mut inspected: Mut<Inspected>| {
        let names = world.resource::<Names>();
        let shown = table::Shown {
            rays: &rays,
            number,
            names,
            kinds: &kinds,
            exposure,
        };
        panel.rows_drawn = table::table_ui(ui, &shown, &mut inspected);
    });
}

/// Why, the chosen ray, or its steps.
fn side_ui(ui: &mut Ui, world: &mut World, why: &mut why::Why, rays: &RayTree, number: u64) {
    world.resource_scope(|world, mut inspected: Mut<Inspected>| {
        ui.horizontal(|ui| {
            for (side, name, says) in [
                (
                    Side::Why,
                    "Why",
                    "Why the pixel has its value: where the light and the noise come from",
                ),
                (Side::Ray, "Ray", "Every number of the chosen ray"),
                (
                    Side::Steps,
                    "Steps",
                    "The chosen ray's way through the trees, step by step",
                ),
            ] {
                ui.selectable_value(&mut inspected.side, side, name)
                    .says(says);
            }
        });
        let side = inspected.side;
        ScrollArea::vertical()
            .id_salt(("side of the rays", side as u8))
            .auto_shrink([false, false])
            .show(ui, |ui| match side {
                Side::Why => why::why_ui(ui, world.resource::<Names>(), why, (rays, number)),
                Side::Ray => detail::detail_ui(ui, world, &mut inspected, rays),
                Side::Steps => steps::steps_ui(ui, world, &mut inspected, rays),
            });
    });
}

/// What stands where a ray would, while none is chosen.
fn none_chosen_ui(ui: &mut Ui, inspected: &mut Inspected, rays: &RayTree) {
    let text = "No ray is chosen: click one in the list, or its line in the view.";
    ui.add(egui::Label::new(egui::RichText::new(text).weak()).wrap());
    let camera = rays.rays.iter().position(|ray| ray.kind == RayKind::Camera);
    let Some(first) = camera.and_then(|index| u32::try_from(index).ok()) else {
        return;
    };
    let choose = ui.button("Choose the camera's ray");
    if choose
        .says("The first ray of the list, with which the pixel begins")
        .clicked()
    {
        inspected.choose_ray(Some(first), true);
    }
}

/// What stands where the rays would, while no pixel was picked: a pixel to begin with.
fn none_picked_ui(ui: &mut Ui, world: &mut World) {
    let says = "Picks the pixel in the middle of the picture, and lists its rays";
    if ui.button("Trace the picture's middle").says(says).clicked() {
        shoot_middle(world);
    }
}
