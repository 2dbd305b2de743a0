//! Where a node stands below the one above it.

use super::json::Json;
use bevy::math::{DMat3, DQuat, DVec3, Mat3, Mat4, Quat, Vec3};
use bevy::transform::components::Transform;

/// Where a node stands. Any linear map is a scaling between two turns, and a `Transform` has one turn: where an axis of
/// the node is not at right angles to another, its content stands in a second entity below the first.
pub(super) struct Placement {
    pub transform: Transform,
    /// The place of the second below the first: a turn.
    pub within: Option<Transform>,
}

/// The place that a node's matrix says, or else its translation, rotation and scale.
pub(super) fn placement_of(node: Json, note: &impl Fn(&str, &'static str)) -> Placement {
    let placement = match node.numbers::<16>("matrix") {
        None => Placement {
            transform: transform_of(node, note),
            within: None,
        },
        Some(matrix) => {
            let matrix = Mat4::from_cols_array(&matrix);
            if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
                let what = "a matrix whose last row is not 0, 0, 0, 1, of";
                note(what, "that row is left out");
            }
            placement_of_matrix(matrix)
        }
    };
    if placement.transform.is_finite() {
        return placement;
    }
    note(
        "a transform that cannot be undone, of",
        "it has no size here",
    );
    Placement {
        transform: Transform::from_scale(Vec3::ZERO),
        within: None,
    }
}

/// How far the square of a rotation's length is from 1 where it was rounded, to bytes at worst.
const ROUNDED: f32 = 0.03;

fn transform_of(node: Json, note: &impl Fn(&str, &'static str)) -> Transform {
    Transform {
        translation: node.numbers("translation").unwrap_or([0.0; 3]).into(),
        rotation: node.numbers("rotation").map_or(Quat::IDENTITY, |turn| {
            if (Quat::from_array(turn).length_squared() - 1.0).abs() > ROUNDED && turn != [0.0; 4] {
                note("a rotation that is not of length 1, of", "made so");
            }
            turn_of(turn, note)
        }),
        scale: node.numbers("scale").unwrap_or([1.0; 3]).into(),
    }
}

/// The turn that a file's four numbers mean. One whose length is 1 but for the rounding of its numbers keeps them: what
/// is written and read again stands where it stood, to the last bit.
pub(super) fn turn_of(numbers: [f32; 4], note: &impl Fn(&str, &'static str)) -> Quat {
    /// Of the square of the length. Numbers of six digits are off by as much.
    const DIGITS: f32 = 2e-6;
    let turn = Quat::from_array(numbers);
    if (turn.length_squared() - 1.0).abs() <= DIGITS {
        return turn;
    }
    if numbers == [0.0; 4] {
        note("a rotation of zeros, of", "not turned");
        return Quat::IDENTITY;
    }
    // The squares of floats have a place among doubles, however small or large.
    let exact = DQuat::from_array(numbers.map(f64::from));
    exact.normalize().as_quat()
}

fn placement_of_matrix(matrix: Mat4) -> Placement {
    let linear = Mat3::from_mat4(matrix);
    let translation = matrix.w_axis.truncate();
    let mut transform = Transform::from_matrix(matrix);
    if transform.rotation.is_finite() {
        transform.rotation = transform.rotation.normalize();
    }
    let largest = linear.to_cols_array().into_iter();
    let largest = largest.fold(0.0, |a: f32, b| a.max(b.abs()));
    // Between the rounding of a decomposition and what could be seen.
    let tolerance = 1e-4 * largest;
    let said = Mat3::from_quat(transform.rotation) * Mat3::from_diagonal(transform.scale);
    if said.abs_diff_eq(linear, tolerance) {
        let within = None;
        return Placement { transform, within };
    }
    let (outer, scale, inner) = scaled_between_turns(linear.as_dmat3());
    let turn = |matrix: DMat3| Quat::from_mat3(&matrix.as_mat3()).normalize();
    Placement {
        transform: Transform {
            translation,
            rotation: turn(outer),
            scale: scale.as_vec3(),
        },
        within: Some(Transform::from_rotation(turn(inner))),
    }
}

/// The singular value decomposition of a matrix as a turn, a scaling and a turn, whose product it is. Turns that
/// Hestenes found (1958): two columns at a time are turned until they are at right angles.
fn scaled_between_turns(matrix: DMat3) -> (DMat3, DVec3, DMat3) {
    let mut columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let mut turns = [DVec3::X, DVec3::Y, DVec3::Z];
    // Each sweep squares what is left; five are enough for any matrix of doubles, and ten for what rounding adds.
    for _ in 0..10 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let (a, b) = (columns[p], columns[q]);
            let (long, short, between) = (a.length_squared(), b.length_squared(), a.dot(b));
            if between.abs() <= f64::EPSILON * (long * short).sqrt() {
                continue;
            }
            let ratio = (short - long) / (2.0 * between);
            let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
            let cosine = tangent.hypot(1.0).recip();
            let sine = tangent * cosine;
            for pair in [&mut columns, &mut turns] {
                let (a, b) = (pair[p], pair[q]);
                pair[p] = cosine * a - sine * b;
                pair[q] = sine * a + cosine * b;
            }
        }
    }
    let lengths = columns.map(DVec3::length);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| lengths[b].total_cmp(&lengths[a]));
    let [longest, middle, shortest] = order;
    // What is so much shorter is rounding, and has no direction: any at right angles to the longest does.
    let is_flat = lengths[middle] <= 1e-12 * lengths[longest];
    let first = columns[longest].try_normalize().unwrap_or(DVec3::X);
    let second = match is_flat {
        true => first.any_orthonormal_vector(),
        false => columns[middle].normalize(),
    };
    let mut axes = [DVec3::ZERO; 3];
    axes[longest] = first;
    axes[middle] = second;
    axes[shortest] = axes[(shortest + 1) % 3].cross(axes[(shortest + 2) % 3]);
    let outer = DMat3::from_cols(axes[0], axes[1], axes[2]);
    let mut scale = DVec3::from_array(lengths);
    // Below 0 where the matrix mirrors: a turn does not.
    scale[shortest] = columns[shortest].dot(axes[shortest]);
    let inner = DMat3::from_cols(turns[0], turns[1], turns[2]).transpose();
    (outer, scale, inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(Placement { transform, within }: Placement) -> Mat3 {
        let outer = transform.to_matrix();
        let inner = within.unwrap_or_default().to_matrix();
        Mat3::from_mat4(outer * inner)
    }

    #[test]
    fn every_matrix_is_the_product_of_the_places_that_it_becomes() {
        let turned = Mat3::from_rotation_x(0.4) * Mat3::from_rotation_z(1.1);
        let columns = Mat3::from_cols_array_2d;
        let sheared = columns(&[[1.0, 0.0, 0.0], [0.7, 1.0, 0.0], [0.0, -0.3, 2.0]]);
        let flat = columns(&[[1.0, 0.5, 0.0], [0.5, 0.3, 0.0], [0.0; 3]]);
        let cases = [
            (Mat3::IDENTITY, false),
            (
                turned * Mat3::from_diagonal(Vec3::new(2.0, -3.0, 0.5)),
                false,
            ),
            (sheared, true),
            (turned * sheared, true),
            (sheared * turned * 1e-6, true),
            (
                sheared * Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1e4)) * turned,
                true,
            ),
            (turned * Mat3::from_diagonal(Vec3::new(1.0, 2.0, 0.0)), true),
            (flat * turned, true),
            (
                columns(&[[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [-1.0, -2.0, -3.0]]),
                true,
            ),
        ];
        for (index, (matrix, is_sheared)) in cases.into_iter().enumerate() {
            // What is far away is sheared, too.
            let place = Mat4::from_translation(Vec3::new(1e4, 0.0, -7.0)) * Mat4::from_mat3(matrix);
            let placement = placement_of_matrix(place);
            assert_eq!(placement.transform.translation, Vec3::new(1e4, 0.0, -7.0));
            assert_eq!(placement.within.is_some(), is_sheared, "case {index}");
            let found = product(placement);
            let largest = matrix
                .to_cols_array()
                .map(f32::abs)
                .into_iter()
                .fold(0.0, f32::max);
            let off = (found - matrix)
                .to_cols_array()
                .map(f32::abs)
                .into_iter()
                .fold(0.0, f32::max);
            assert!(
                off <= 2e-6 * largest,
                "case {index}: {off} of {largest}\n{found}\n{matrix}"
            );
        }
    }
}
