//! Uniform points of a disc, or of the part of a disc on one side of a line.

use super::polynomials::sin_cos;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_4, PI};

/// The square [0, 1)² onto the unit disc, keeping areas and neighbourhoods (Shirley, Chiu 1997,
/// "A Low Distortion Map Between Disk and Square"). Without a branch.
#[inline(always)]
pub(in crate::trace) fn concentric(u: [f32; 2]) -> Vec2 {
    let p = [2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0];
    let is_wide = p[0].abs() > p[1].abs();
    let radius = if is_wide { p[0] } else { p[1] };
    let other = if is_wide { p[1] } else { p[0] };
    // From the nearer of the two axes; at the middle there is none.
    let angle = FRAC_PI_4 * (other / radius);
    let (sine, cosine) = sin_cos(if radius == 0.0 { 0.0 } else { angle });
    let (along, aside) = (radius * cosine, radius * sine);
    Vec2::new(
        if is_wide { along } else { aside },
        if is_wide { aside } else { along },
    )
}

/// `axis` moved by a uniform point of the disc of `radius` perpendicular to it, where the disc is
/// cut down to what lies on the side of `normal`; renormalised. `None` where nothing of it does.
///
/// Both vectors have unit length. No rejection: the two numbers are mapped onto what is left, so
/// their stratification is kept.
pub(in crate::trace) fn offset_direction(
    axis: Vec3,
    normal: Vec3,
    radius: f32,
    u: [f32; 2],
) -> Option<Vec3> {
    let height = axis.dot(normal);
    let lateral = normal - height * axis;
    let slope = lateral.length();
    // The side's border crosses the disc's plane as a line at distance `border` from its middle.
    let border = if slope > 1e-6 {
        -height / (slope * radius)
    } else if height > 0.0 {
        -1.0
    } else {
        1.0
    };
    if border >= 1.0 {
        return None;
    }
    let direction = if border <= -1.0 {
        let p = radius * concentric(u);
        let (x, y) = axis.any_orthonormal_pair();
        axis + p.x * x + p.y * y
    } else {
        let x = lateral / slope;
        let y = axis.cross(x);
        let p = radius * beyond(border, u);
        axis + p.x * x + p.y * y
    };
    // Rounding may leave a point of the border on the wrong side.
    let direction = direction.normalize();
    (direction.dot(normal) > 0.0).then_some(direction)
}

/// The square onto the points of the unit disc with x > `border`, |border| < 1, keeping areas.
fn beyond(border: f32, u: [f32; 2]) -> Vec2 {
    // Area right of x: A(x) = acos(x) − x·√(1 − x²). Solved for A(x) = (1 − u)·A(border); with
    // x = cos φ that is φ − sin φ·cos φ = target, monotone in φ, by bisected Newton steps.
    let area = |phi: f32| phi - phi.sin() * phi.cos();
    let (mut low, mut high) = (0.0, border.acos());
    let target = (1.0 - u[0]) * area(high);
    let mut phi = high * (1.0 - u[0]).cbrt();
    for _ in 0..16 {
        let error = area(phi) - target;
        if error > 0.0 {
            high = phi;
        } else {
            low = phi;
        }
        let step = phi - error / (2.0 * phi.sin().powi(2)).max(f32::MIN_POSITIVE);
        let next = if step > low && step < high {
            step
        } else {
            0.5 * (low + high)
        };
        if (next - phi).abs() <= f32::EPSILON * PI {
            break;
        }
        phi = next;
    }
    Vec2::new(phi.cos(), (2.0 * u[1] - 1.0) * phi.sin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    fn grid(n: usize) -> impl Iterator<Item = [f32; 2]> {
        (0..n * n).map(move |i| {
            [
                ((i % n) as f32 + 0.5) / n as f32,
                ((i / n) as f32 + 0.5) / n as f32,
            ]
        })
    }

    #[test]
    fn a_cut_disc_is_filled_evenly_and_only_on_its_side() {
        for border in [-0.9_f32, -0.3, 0.0, 0.4, 0.95] {
            let points: Vec<_> = grid(200).map(|u| beyond(border, u)).collect();
            assert!(
                points
                    .iter()
                    .all(|p| p.x >= border - 1e-5 && p.length() <= 1.0 + 1e-5)
            );
            // The centroid of a circular segment: 2/3 (1 − b²)^(3/2) / A(b).
            let area = border.acos() - border * (1.0 - border * border).sqrt();
            let expected = 2.0 / 3.0 * (1.0 - border * border).powf(1.5) / area;
            let mean = points.iter().sum::<Vec2>() / points.len() as f32;
            assert!(
                (mean.x - expected).abs() < 1e-3 && mean.y.abs() < 1e-3,
                "border {border}: mean {mean}, expected x {expected}"
            );
        }
    }

    #[test]
    fn every_direction_leaves_the_surface_and_none_is_nan() {
        for tilt in 0..=40 {
            // From pointing straight off the surface to pointing straight into it.
            let angle = tilt as f32 / 40.0 * PI;
            let axis = Vec3::new(angle.sin(), angle.cos(), 0.0);
            for radius in [1e-4, 0.1, 1.0] {
                for u in grid(16) {
                    if let Some(d) = offset_direction(axis, Vec3::Y, radius, u) {
                        assert!(d.is_finite() && d.y > 0.0, "{axis} {radius} {u:?}: {d}");
                    }
                }
            }
            let whole_disc_inside = angle.tan() > 1.0 || angle > FRAC_PI_2 + FRAC_PI_4 + 0.01;
            if angle > FRAC_PI_2 + FRAC_PI_4 + 0.01 && whole_disc_inside {
                assert!(offset_direction(axis, Vec3::Y, 1.0, [0.3, 0.6]).is_none());
            }
        }
    }
}
