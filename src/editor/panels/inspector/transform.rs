//! Where an entity stands. Turns are shown as angles, which stay as they were entered: a rotation
//! has many triples of angles, and a field that jumps to another one cannot be typed into.

use super::super::fields::{property_ui, row, section};
use super::super::says::Says;
use super::super::several::Several;
use super::super::state::Panels;
use crate::scene::{Property, Quantity};
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::{EulerRot, Quat, Vec3};
use bevy::reflect::{Reflect, Typed};
use bevy::transform::components::Transform;
use bevy_egui::egui::Ui;
use std::f64::consts::PI;

/// Angles that can be entered, in radians: a thousand turns either way.
const TURNS: f64 = 2000.0 * PI;

/// The angles that were entered last, and for which rotation they stand.
#[derive(Default)]
pub(in super::super) struct Turns {
    known: Option<(Entity, Quat, Vec3)>,
}

impl Turns {
    /// Degrees about x, y and z of an entity with this rotation.
    fn of(&self, entity: Entity, rotation: Quat) -> Vec3 {
        match self.known {
            Some((of, for_rotation, degrees)) if of == entity && for_rotation == rotation => {
                degrees
            }
            _ => degrees(rotation),
        }
    }
}

/// About the vertical first, then x, then z: a camera's pan, tilt and roll.
fn degrees(rotation: Quat) -> Vec3 {
    let (y, x, z) = rotation.to_euler(EulerRot::YXZ);
    // -0 is no angle that anyone entered.
    Vec3::new(x, y, z).map(|angle| angle.to_degrees() + 0.0)
}

fn rotation(degrees: Vec3) -> Quat {
    let [x, y, z] = degrees.to_array().map(f32::to_radians);
    Quat::from_euler(EulerRot::YXZ, y, x, z)
}

pub(super) fn transform_ui(
    ui: &mut Ui,
    world: &mut World,
    entities: &[Entity],
    panels: &mut Panels,
) {
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
        turn_ui(ui, &mut several, entities[0], &mut panels.turns);
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

/// Angles that are entered, degrees shown.
#[derive(Reflect)]
struct Angles {
    radians: Vec3,
}

fn turn_ui(ui: &mut Ui, several: &mut Several<Transform>, active: Entity, turns: &mut Turns) {
    let before = several.first().rotation;
    let entered = turns.of(active, before);
    let mut differs = false;
    several.field(
        |transform| &mut transform.rotation,
        |_, mixed| {
            differs = mixed;
            false
        },
    );
    let Some(mut property) = Property::of(Angles::type_info(), "radians") else {
        return;
    };
    property.label = "Turn".into();
    property.says = "About x, y and z: first about the vertical y, then x, then z".into();
    property.quantity = Some(Quantity::within(-TURNS, TURNS, "°").step(0.01));
    let mut angles = Angles {
        radians: entered.map(f32::to_radians),
    };
    let Some(changed) = property_ui(ui, &mut angles, &property, &|_| differs) else {
        return;
    };
    let Some(axis) = ["radians.x", "radians.y", "radians.z"]
        .iter()
        .position(|axis| *axis == changed)
    else {
        return;
    };
    let mut value = entered;
    value[axis] = angles.radians[axis].to_degrees();
    several.change(|transform| {
        let mut all = match transform.rotation == before {
            true => value,
            false => degrees(transform.rotation),
        };
        all[axis] = value[axis];
        transform.rotation = rotation(all);
    });
    turns.known = Some((active, several.first().rotation, value));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_that_were_entered_stay_and_others_come_from_the_rotation() {
        let entity = Entity::from_raw_u32(7).unwrap();
        // Looking straight up: every split of the turn between y and z is the same rotation.
        let entered = Vec3::new(90.0, 30.0, 0.0);
        let turned = rotation(entered);
        let turns = Turns {
            known: Some((entity, turned, entered)),
        };
        assert_eq!(turns.of(entity, turned), entered);
        let other = rotation(Vec3::new(10.0, -20.0, 30.0));
        let found = turns.of(entity, other);
        assert!(
            found.distance(Vec3::new(10.0, -20.0, 30.0)) < 1e-3,
            "{found}"
        );
    }

    #[test]
    fn a_positive_turn_about_y_turns_what_looks_ahead_to_the_left() {
        let ahead = rotation(Vec3::new(0.0, 90.0, 0.0)) * Vec3::NEG_Z;
        assert!(ahead.distance(Vec3::NEG_X) < 1e-6, "{ahead}");
    }
}
