//! Below the list: what the rays add up to, and what the counters count.

use super::super::says::Says;
use crate::editor::inspection::DebugRay;
use crate::editor::inspection::debug_ray::Shot;
use crate::editor::viewport::traced_render;
use crate::film::Sum;
use crate::inspect::{Statement, left_out_text};
use crate::scene::{Output, RenderSettings};
use crate::trace::{self, RayTree};
use bevy::ecs::world::World;
use bevy_egui::egui::{RichText, Ui};
use std::sync::Arc;

/// What the numbers of nodes, boxes and triangles are.
const COUNTERS: &str = "Counters are those of the walk that traces pictures, ray by ray, through the wide form of the trees.";

pub(super) fn foot_ui(ui: &mut Ui, world: &mut World, rays: &RayTree) {
    let film = film_of(world);
    let addition = world.resource::<DebugRay>().addition();
    let of_rays = addition.says_of_rays(rays);
    let of_film = addition.says_of_film(rays, film);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        statement_ui(ui, &of_rays, ";", "What each ray adds by itself, summed in the order in which the tracer added it, against the sample's value");
        statement_ui(ui, &of_film, ".", "The samples' values against what the film of this picture added for the pixel, as exact sums");
        if rays.left_out > 0 {
            let text = left_out_text(rays.left_out);
            let color = ui.visuals().warn_fg_color;
            ui.label(RichText::new(text).small().color(color));
        }
        ui.label(RichText::new(COUNTERS).small().weak())
            .says("Where many rays of a picture go the same way, it walks the same trees with all of them together, which counts otherwise");
    });
}

fn statement_ui(ui: &mut Ui, statement: &Statement, end: &str, says: &str) {
    let color = match statement.is_fault {
        true => ui.visuals().error_fg_color,
        false => ui.visuals().text_color(),
    };
    let text = format!("{}{end}", statement.text);
    ui.label(RichText::new(text).small().color(color))
        .says(says);
}

/// What the film of the view has of the picked pixel, where it is the film of the same picture.
fn film_of(world: &mut World) -> Option<(Sum, u32)> {
    let ray = world.resource::<DebugRay>();
    let shot = ray.shot()?.clone();
    let (of, settings) = ray.traced_with()?;
    let (of, settings) = (of.clone(), settings.clone());
    let render = traced_render(world)?;
    let (own, camera, rendered) = render.subject()?;
    if !is_same_picture((own, camera, rendered), (&of, &shot, &settings)) {
        return None;
    }
    render.render()?.pixel_sum(shot.pixel)
}

fn is_same_picture(
    (own, camera, rendered): (&Arc<trace::World>, &trace::Camera, &RenderSettings),
    (of, shot, settings): (&Arc<trace::World>, &Shot, &RenderSettings),
) -> bool {
    let plain = |settings: &RenderSettings| RenderSettings {
        // Only developing depends on it.
        output: Output::default(),
        ..settings.clone()
    };
    Arc::ptr_eq(own, of) && *camera == shot.camera && plain(rendered) == plain(settings)
}
