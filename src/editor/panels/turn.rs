//! A rotation as three angles, which stay as they were entered: a rotation has many triples of angles, and a field that
//! jumps to another one cannot be typed into.

use super::fields::property_ui;
use crate::scene::{Property, Quantity};
use bevy::math::{EulerRot, Quat, Vec3};
use bevy::reflect::{Reflect, Typed};
use bevy_egui::egui::{Id, Ui};
use std::f64::consts::PI;

/// Angles that can be entered, in radians: a thousand turns either way.
const TURNS: f64 = 2000.0 * PI;

/// Steps of a degree in which the angles of a rotation are known: its f32 numbers leave some 1e-5° of no meaning, which would
/// be shown as a turn of 4.5e-7.
const STEPS: f32 = 1e4;

/// The angles that were entered last, in degrees about x, y and z, and for which rotation they stand.
#[derive(Clone, Copy)]
struct Entered {
    rotation: Quat,
    degrees: Vec3,
}

impl Entered {
    /// The angles of a rotation.
    fn of(known: Option<Self>, rotation: Quat) -> Vec3 {
        match known {
            Some(known) if known.rotation == rotation => known.degrees,
            _ => degrees(rotation),
        }
    }
}

/// Angles that are entered, degrees shown.
#[derive(Reflect)]
struct Angles {
    radians: Vec3,
}

/// The row of a rotation. Returns which angle was entered, and its degrees.
pub(super) fn turn_ui(
    ui: &mut Ui,
    label: &str,
    says: &str,
    rotation: &mut Quat,
    mixed: bool,
) -> Option<(usize, f32)> {
    let id = Id::new(("angles that were entered", label));
    let entered = Entered::of(ui.data(|data| data.get_temp(id)), *rotation);
    let mut property = Property::of(Angles::type_info(), "radians")?;
    property.label = label.to_owned();
    property.says = says.to_owned();
    property.quantity = Some(Quantity::within(-TURNS, TURNS, "°").step(0.01));
    let mut angles = Angles {
        radians: entered.map(f32::to_radians),
    };
    let changed = property_ui(ui, &mut angles, &property, &|_| mixed)?;
    let axes = ["radians.x", "radians.y", "radians.z"];
    let axis = axes.iter().position(|axis| *axis == changed)?;
    let mut value = entered;
    value[axis] = angles.radians[axis].to_degrees();
    *rotation = rotated(value);
    let entered = Entered {
        rotation: *rotation,
        degrees: value,
    };
    ui.data_mut(|data| data.insert_temp(id, entered));
    Some((axis, value[axis]))
}

/// A rotation with another angle about one axis.
pub(super) fn with_angle(rotation: Quat, axis: usize, to: f32) -> Quat {
    let mut all = degrees(rotation);
    all[axis] = to;
    rotated(all)
}

/// About the vertical first, then x, then z: a camera's pan, tilt and roll.
fn degrees(rotation: Quat) -> Vec3 {
    let (y, x, z) = rotation.to_euler(EulerRot::YXZ);
    // -0 is no angle that anyone entered.
    Vec3::new(x, y, z).map(|angle| (angle.to_degrees() * STEPS).round() / STEPS + 0.0)
}

fn rotated(degrees: Vec3) -> Quat {
    let [x, y, z] = degrees.to_array().map(f32::to_radians);
    Quat::from_euler(EulerRot::YXZ, y, x, z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::transform::components::Transform;

    #[test]
    fn angles_that_were_entered_stay_and_others_come_from_the_rotation() {
        // Looking straight up: every split of the turn between y and z is the same rotation.
        let degrees = Vec3::new(90.0, 30.0, 0.0);
        let rotation = rotated(degrees);
        let known = Some(Entered { rotation, degrees });
        assert_eq!(Entered::of(known, rotation), degrees);
        let other = Vec3::new(10.0, -20.0, 30.0);
        let found = Entered::of(known, rotated(other));
        assert!(found.distance(other) < 1e-3, "{found}");
    }

    #[test]
    fn what_rounding_left_of_a_rotation_is_no_angle() {
        for i in 0..40 {
            let from = Vec3::new(0.1 * i as f32 - 2.0, 0.85, 2.04);
            let camera = Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y);
            let found = degrees(camera.rotation);
            assert_eq!(found.z, 0.0, "the roll of a camera at {from}");
            let off = (rotated(found) * Vec3::Z).distance(camera.rotation * Vec3::Z);
            assert!(off < 1e-5, "{off}");
        }
    }

    #[test]
    fn a_positive_turn_about_y_turns_what_looks_ahead_to_the_left() {
        let ahead = rotated(Vec3::new(0.0, 90.0, 0.0)) * Vec3::NEG_Z;
        assert!(ahead.distance(Vec3::NEG_X) < 1e-6, "{ahead}");
    }
}
