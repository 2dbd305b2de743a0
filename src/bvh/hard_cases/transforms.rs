//! Transforms of every kind.

use std::f32::consts::TAU;

use glam::{Affine3A, Mat3, Quat, Vec3};

use super::random::Random;

/// A transform of any kind: turned, scaled unevenly from 1e-4 to 1e4 overall, mirrored, sheared, moved.
pub(crate) fn any_transform(random: &mut Random) -> Affine3A {
    let turn =
        |random: &mut Random| Quat::from_axis_angle(random.direction(), random.between(0.0, TAU));
    let size = 10f32.powf(random.between(-4.0, 4.0));
    let mut uneven = Vec3::ONE;
    if random.unit() < 0.5 {
        uneven = Vec3::new(
            random.between(0.1, 3.0),
            random.between(0.1, 3.0),
            random.between(0.1, 3.0),
        );
    }
    if random.unit() < 0.5 {
        uneven.x = -uneven.x;
    }
    let shear = if random.unit() < 0.5 {
        Mat3::from_cols(
            Vec3::X,
            Vec3::new(random.between(-2.0, 2.0), 1.0, 0.0),
            Vec3::new(random.between(-2.0, 2.0), random.between(-2.0, 2.0), 1.0),
        )
    } else {
        Mat3::IDENTITY
    };
    let linear = Mat3::from_quat(turn(random))
        * shear
        * Mat3::from_diagonal(uneven * size)
        * Mat3::from_quat(turn(random));
    Affine3A::from_mat3_translation(linear, random.cube() * size * random.of(&[0.0, 1.0, 10.0]))
}
