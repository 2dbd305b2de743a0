//! What becomes of a parallelogram one of whose corners is dragged. It stays in its plane.

use bevy::math::{Mat2, Vec2, Vec3};

/// A corner, and the two edges that leave it.
pub(super) type Surface = (Vec3, [Vec3; 2]);

/// The least part of its length that a drag leaves of a side: one of no length has no direction.
const LEAST: f32 = 0.01;

/// What stays while a corner is dragged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shaping {
    /// The sides' directions and the opposite corner: a rectangle stays one.
    Sides,
    /// Their ratio as well.
    Ratio,
    /// The sides' directions and the middle.
    Middle,
    /// Their ratio as well.
    MiddleRatio,
    /// The opposite corner alone: those beside the dragged one go half as far.
    Shear,
}

/// The surface with corner `index` at `to`, or as near as `how` allows. The corners are that at
/// `corner`, `corner + edges[0]`, `corner + edges[1]`, and the one opposite.
pub(super) fn shaped(surface: Surface, index: usize, to: Vec3, how: Shaping) -> Surface {
    let (corner, [along, across]) = surface;
    let (u, v) = ((index & 1) as f32, (index >> 1) as f32);
    let from = corner + u * along + v * across;
    let Some(by) = in_edges(to - from, along, across) else {
        // Of no area: there is no plane to stay in.
        return sheared(surface, (u, v), to - from);
    };
    if how == Shaping::Shear {
        return sheared(surface, (u, v), by.x * along + by.y * across);
    }
    // From what stays to the corner, in edges.
    let middle = matches!(how, Shaping::Middle | Shaping::MiddleRatio);
    let reach = Vec2::new(2.0 * u - 1.0, 2.0 * v - 1.0) * if middle { 0.5 } else { 1.0 };
    let mut factor = (reach + by) / reach;
    if matches!(how, Shaping::Ratio | Shaping::MiddleRatio) {
        let diagonal = reach.x * along + reach.y * across;
        let now = diagonal + by.x * along + by.y * across;
        factor = Vec2::splat(now.dot(diagonal) / diagonal.length_squared());
    }
    let factor = factor.max(Vec2::splat(LEAST));
    if !factor.is_finite() {
        return surface;
    }
    let stays = from - reach.x * along - reach.y * across;
    let edges = [factor.x * along, factor.y * across];
    let to_stay = match middle {
        true => Vec2::splat(0.5),
        false => Vec2::new(1.0 - u, 1.0 - v),
    };
    let corner = stays - to_stay.x * edges[0] - to_stay.y * edges[1];
    (corner, edges)
}

/// How many of each edge a vector is, but for what stands upright on both. `None` where the edges
/// have no area.
fn in_edges(vector: Vec3, along: Vec3, across: Vec3) -> Option<Vec2> {
    let gram = Mat2::from_cols_array(&[
        along.dot(along),
        along.dot(across),
        along.dot(across),
        across.dot(across),
    ]);
    let parts = gram.inverse() * Vec2::new(vector.dot(along), vector.dot(across));
    (gram.determinant() > 0.0 && parts.is_finite()).then_some(parts)
}

fn sheared((corner, [along, across]): Surface, (u, v): (f32, f32), by: Vec3) -> Surface {
    // How far the corner at (0, 0) and the ends of its edges go.
    let part = |x: f32, y: f32| 1.0 - 0.5 * ((x - u).abs() + (y - v).abs());
    let first = part(0.0, 0.0);
    let edges = [
        along + (part(1.0, 0.0) - first) * by,
        across + (part(0.0, 1.0) - first) * by,
    ];
    (corner + first * by, edges)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners((corner, [along, across]): Surface) -> [Vec3; 4] {
        [
            corner,
            corner + along,
            corner + across,
            corner + along + across,
        ]
    }

    /// 2 m by 1 m, tilted.
    fn rectangle() -> Surface {
        let turn = bevy::math::Quat::from_rotation_x(0.6);
        let edges = [turn * Vec3::X * 2.0, turn * Vec3::Z];
        (Vec3::new(1.0, 2.0, 3.0), edges)
    }

    #[test]
    fn a_dragged_corner_leaves_a_rectangle_in_its_plane_and_the_opposite_corner_where_it_is() {
        let before = rectangle();
        let normal = before.1[0].cross(before.1[1]).normalize();
        for index in 0..4 {
            let to = corners(before)[index] + Vec3::new(0.3, -0.2, 0.25);
            let after = shaped(before, index, to, Shaping::Sides);
            let [along, across] = after.1;
            let off = along.dot(across) / (along.length() * across.length());
            assert!(off.abs() < 1e-6, "corner {index}: cosine {off}");
            let [was, is] = [before, after].map(corners);
            let moved = is[3 - index].distance(was[3 - index]);
            assert!(
                moved < 1e-5,
                "corner {index}: the opposite one went {moved} m"
            );
            let height = (is[index] - was[0]).dot(normal);
            assert!(
                height.abs() < 1e-5,
                "corner {index}: {height} m above the plane"
            );
            let miss = (to - is[index]).reject_from(normal).length();
            assert!(miss < 1e-5, "corner {index}: {miss} m beside the pointer");
        }
    }

    #[test]
    fn shift_keeps_the_ratio_and_ctrl_the_middle() {
        let before = rectangle();
        let middle = |surface: Surface| corners(surface).iter().sum::<Vec3>() * 0.25;
        for (how, ratio, centred) in [
            (Shaping::Ratio, true, false),
            (Shaping::Middle, false, true),
            (Shaping::MiddleRatio, true, true),
        ] {
            for index in 0..4 {
                let to = corners(before)[index] + Vec3::new(0.4, 0.1, -0.2);
                let after = shaped(before, index, to, how);
                let now = after.1[0].length() / after.1[1].length();
                assert_eq!((now - 2.0).abs() < 1e-4, ratio, "{how:?} {index}: {now}");
                let moved = middle(after).distance(middle(before));
                assert_eq!(moved < 1e-4, centred, "{how:?} {index}: {moved} m");
            }
        }
    }

    #[test]
    fn alt_shears_the_dragged_corner_goes_along_and_those_beside_it_half_as_far() {
        let before = rectangle();
        let by = 0.3 * before.1[0] - 0.6 * before.1[1];
        for index in 0..4 {
            let [was, is] = {
                let to = corners(before)[index] + by;
                [before, shaped(before, index, to, Shaping::Shear)].map(corners)
            };
            for other in 0..4 {
                let part = match index ^ other {
                    0 => 1.0,
                    3 => 0.0,
                    _ => 0.5,
                };
                let went = is[other] - was[other];
                let miss = (went - part * by).length();
                assert!(
                    miss < 1e-5,
                    "corner {index} moved, corner {other} went {went}"
                );
            }
        }
    }

    #[test]
    fn a_corner_that_is_dragged_over_the_opposite_one_leaves_a_surface_that_faces_the_same_way() {
        let before = rectangle();
        let normal = |(_, [a, b]): Surface| a.cross(b);
        for how in [Shaping::Sides, Shaping::Ratio, Shaping::Middle] {
            let to = corners(before)[3] - 3.0 * (before.1[0] + before.1[1]);
            let after = shaped(before, 3, to, how);
            let cosine = normal(after).dot(normal(before));
            assert!(cosine > 0.0 && after.0.is_finite(), "{how:?}: {cosine}");
        }
        let flat = (Vec3::ZERO, [Vec3::X, Vec3::ZERO]);
        let after = shaped(flat, 3, Vec3::ONE, Shaping::Sides);
        assert!(after.1[1].length() > 0.0, "one of no area gets one");
    }
}
