//! Where an entity stands. Turns are shown as angles, which stay as they were entered: a rotation
//! has many triples of angles, and a field that jumps to another one cannot be typed into.

use super::super::fields::{Number, row, section, vector};
use super::super::says::Says;
use super::super::several::Several;
use super::super::state::Panels;
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::{EulerRot, Quat, Vec3};
use bevy::transform::components::Transform;
use bevy_egui::egui::Ui;

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
        axes_ui(
            ui,
            &mut several,
            "Position",
            "Metres, in its parent's space",
            Number::free(0.01, ""),
            |transform| &mut transform.translation,
        );
        turn_ui(ui, &mut several, entities[0], &mut panels.turns);
        axes_ui(
            ui,
            &mut several,
            "Scale",
            "Size along its own axes; 1 is as it was made, negative mirrors",
            Number::free(0.01, ""),
            |transform| &mut transform.scale,
        );
    });
    several.write(world);
}

/// Three numbers, each a property of its own: setting one leaves the others of several entities.
fn axes_ui(
    ui: &mut Ui,
    several: &mut Several<Transform>,
    label: &str,
    says: &str,
    number: Number,
    vector_of: impl Fn(&mut Transform) -> &mut Vec3,
) {
    let mut mixed = [false; 3];
    for (axis, mixed) in mixed.iter_mut().enumerate() {
        several.field(
            |transform| &mut vector_of(transform)[axis],
            |_, differs| {
                *mixed = differs;
                false
            },
        );
    }
    let mut value = *vector_of(&mut several.first().clone());
    let changed = vector(ui, label, says, &mut value, number, mixed);
    for axis in (0..3).filter(|&axis| changed[axis]) {
        several.change(|transform| vector_of(transform)[axis] = value[axis]);
    }
}

fn turn_ui(ui: &mut Ui, several: &mut Several<Transform>, active: Entity, turns: &mut Turns) {
    let before = several.first().rotation;
    let mut value = turns.of(active, before);
    let mut differs = false;
    several.field(
        |transform| &mut transform.rotation,
        |_, mixed| {
            differs = mixed;
            false
        },
    );
    let says = "Degrees about x, y and z: first about the vertical y, then x, then z";
    let number = Number::free(0.5, "°");
    let changed = vector(ui, "Turn", says, &mut value, number, [differs; 3]);
    if !changed.contains(&true) {
        return;
    }
    several.change(|transform| {
        let mut angles = if transform.rotation == before {
            value
        } else {
            degrees(transform.rotation)
        };
        for axis in (0..3).filter(|&axis| changed[axis]) {
            angles[axis] = value[axis];
        }
        transform.rotation = rotation(angles);
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
