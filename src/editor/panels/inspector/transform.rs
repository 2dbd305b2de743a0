//! Where an entity stands.

use super::super::fields::{row, section};
use super::super::says::Says;
use super::super::several::Several;
use super::super::turn::{turn_ui, with_angle};
use crate::scene::{Property, Quantity};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::reflect::Typed;
use bevy::transform::components::Transform;
use bevy_egui::egui::Ui;

pub(super) fn transform_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(mut several) = Several::<Transform>::of(world, entities) else {
        return;
    };
    section(ui, "Place", true, |ui| {
        visible_ui(ui, world, entities);
        place_ui(
            ui,
            &mut several,
            "translation",
            "Position",
            "Metres, in its parent's space",
            Quantity::COORDINATE,
        );
        rotation_ui(ui, &mut several);
        place_ui(
            ui,
            &mut several,
            "scale",
            "Scale",
            "Size along its own axes; 1 is as it was made, negative mirrors",
            Quantity::COORDINATE.unit(""),
        );
    });
    several.write(world);
}

/// A part of Bevy's own component, of which our schema says nothing: setting one number leaves the others of several
/// entities.
fn place_ui(
    ui: &mut Ui,
    several: &mut Several<Transform>,
    path: &str,
    label: &str,
    says: &str,
    quantity: Quantity,
) {
    if let Some(mut property) = Property::of(Transform::type_info(), path) {
        property.label = label.to_owned();
        property.says = says.to_owned();
        property.quantity = Some(quantity);
        several.property(ui, &property);
    }
}

fn rotation_ui(ui: &mut Ui, several: &mut Several<Transform>) {
    let before = several.first().rotation;
    let differs = several.any(|transform| transform.rotation != before);
    let says = "About x, y and z: first about the vertical y, then x, then z";
    let mut rotation = before;
    if let Some((axis, degrees)) = turn_ui(ui, "Turn", says, &mut rotation, differs) {
        several.change(|transform| {
            transform.rotation = match transform.rotation == before {
                true => rotation,
                false => with_angle(transform.rotation, axis, degrees),
            };
        });
    }
}

fn visible_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let Some(mut several) = Several::<Visibility>::of(world, entities) else {
        return;
    };
    let says = "What is hidden is not traced, nor is what is below it in the list";
    row(ui, "Visible", says, |ui| {
        several.field(
            |visibility| visibility,
            |visibility, mixed| {
                let mut visible = *visibility != Visibility::Hidden;
                let text = if mixed { "mixed" } else { "" };
                let changed = ui.checkbox(&mut visible, text).says(says).changed();
                if changed {
                    *visibility = match visible {
                        true => Visibility::Inherited,
                        false => Visibility::Hidden,
                    };
                }
                changed
            },
        );
    });
    several.write(world);
}
