//! Where in the window a script means.

use super::super::extent::extent_of;
use super::super::handles::grips_of_selection;
use super::super::pick;
use super::super::preferences::Preferences;
use super::super::viewport::Viewport;
use super::step::{Along, Spot};
use crate::scene::SceneId;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::{
    TransformGizmoFocus, TransformGizmoMode, TransformGizmoSettings, effective_space,
    gizmo_rotation,
};
use bevy::math::{Vec2, Vec3};
use bevy::transform::components::GlobalTransform;
use bevy_egui::{EguiFullOutput, PrimaryEguiContext, egui};

/// The texts that egui drew last, and where, from the top down.
#[derive(Resource, Default)]
pub(super) struct Texts {
    shown: Vec<(String, egui::Rect)>,
    /// Logical pixels of the window in one of egui's points.
    zoom: f32,
}

impl Texts {
    /// Whether this text is to be seen.
    pub fn shows(&self, text: &str) -> bool {
        self.shown.iter().any(|(shown, _)| shown == text)
    }
}

/// Notes what egui has drawn.
pub(super) fn read_texts(
    mut texts: ResMut<Texts>,
    outputs: Query<&EguiFullOutput, With<PrimaryEguiContext>>,
    preferences: Res<Preferences>,
) {
    let Some(output) = outputs.iter().find_map(|output| output.0.as_ref()) else {
        return;
    };
    texts.zoom = preferences.zoom;
    texts.shown.clear();
    for shape in &output.shapes {
        collect(&shape.shape, shape.clip_rect, &mut texts.shown);
    }
    texts.shown.sort_by(|a, b| {
        (a.1.top(), a.1.left())
            .partial_cmp(&(b.1.top(), b.1.left()))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
}

fn collect(shape: &egui::Shape, clip: egui::Rect, texts: &mut Vec<(String, egui::Rect)>) {
    match shape {
        egui::Shape::Text(text) => {
            let area = text.visual_bounding_rect();
            // What is scrolled away is not there.
            if clip.contains(area.center()) {
                texts.push((text.galley.text().to_owned(), area));
            }
        }
        egui::Shape::Vec(shapes) => {
            for shape in shapes {
                collect(shape, clip, texts);
            }
        }
        _ => {}
    }
}

/// The entity of this name; of several the first.
pub(super) fn named(world: &mut World, name: &str) -> Result<SceneId, String> {
    let mut all = world.query::<(&SceneId, &Name)>();
    let found = all.iter(world).filter(|(_, other)| other.as_str() == name);
    found
        .map(|(id, _)| *id)
        .min()
        .ok_or_else(|| format!("there is no entity {name:?}"))
}

/// In logical pixels of the window; otherwise what stands in the way.
pub(super) fn place(world: &mut World, spot: &Spot) -> Result<Vec2, String> {
    match spot {
        Spot::Window(x, y) => Ok(Vec2::new(*x, *y)),
        Spot::View(u, v) => {
            let rect = world.resource::<Viewport>().rect;
            Ok(rect.min + Vec2::new(*u, *v) * rect.size())
        }
        Spot::On(name) => {
            let id = named(world, name)?;
            let extent = extent_of(world, &[id]).ok_or(format!("{name:?} stands nowhere"))?;
            seen(world, extent.centre(), name)
        }
        Spot::Grip(name, index) => {
            let id = named(world, name)?;
            let grips = grips_of_selection(world).into_iter();
            let (_, point) = grips
                .filter(|(grip, _)| grip.id == id)
                .nth(*index)
                .ok_or(format!("{name:?} is not selected, or has no point {index}"))?;
            seen(world, point, name)
        }
        Spot::Handle(along) => {
            let tip = handle(world, *along).ok_or("nothing with a gizmo is selected")?;
            seen(world, tip, "the handle")
        }
        Spot::Text(text) => text_at(world, text, 0),
        Spot::TextAt(text, index) => text_at(world, text, *index),
        Spot::By(from, dx, dy) => Ok(place(world, from)? + Vec2::new(*dx, *dy)),
    }
}

fn seen(world: &mut World, point: Vec3, name: &str) -> Result<Vec2, String> {
    pick::to_window(world, point).ok_or(format!("{name} is not in the view"))
}

fn text_at(world: &World, text: &str, index: usize) -> Result<Vec2, String> {
    let texts = world.resource::<Texts>();
    let mut found = texts.shown.iter().filter(|(shown, _)| shown == text);
    let (_, area) = found
        .nth(index)
        .ok_or_else(|| format!("no panel shows {text:?} ({} times more often)", index + 1))?;
    let middle = area.center();
    Ok(Vec2::new(middle.x, middle.y) * texts.zoom)
}

/// Near the tip of the gizmo's arrow or cube along an axis.
fn handle(world: &mut World, along: Along) -> Option<Vec3> {
    let (_, camera) = pick::camera(world)?;
    let mut focus = world.query_filtered::<&GlobalTransform, With<TransformGizmoFocus>>();
    let place = *focus.single(world).ok()?;
    let settings = world.resource::<TransformGizmoSettings>();
    let size = place.translation().distance(camera.translation()) * settings.screen_scale_factor;
    let rotation = gizmo_rotation(&place, effective_space(settings));
    let axis = match along {
        Along::X => Vec3::X,
        Along::Y => Vec3::Y,
        Along::Z => Vec3::Z,
    };
    // A ring is taken hold of beside where it crosses another one.
    let offset = match settings.mode {
        TransformGizmoMode::Rotate => {
            let (a, b) = (axis.any_orthonormal_pair(), settings.rotate_ring_radius);
            (a.0 + 0.5 * a.1).normalize() * b
        }
        _ => axis * 0.9 * settings.axis_length,
    };
    Some(place.translation() + rotation * (offset * size))
}
