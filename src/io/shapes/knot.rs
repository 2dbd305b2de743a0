//! A torus knot with a rippled tube.

use super::grid;
use super::surface::Surface;
use bevy::math::DVec3;
use std::f64::consts::TAU;

/// The torus on which the knot lies: from its centre to the middle of its tube, and its tube.
const TORUS: [f64; 2] = [1.0, 0.4];
/// Strands around the tube and how often each winds around it along the whole knot, as in a rope:
/// whole numbers, so that they close.
const STRANDS: [f64; 2] = [5.0, 10.0];

pub(super) fn knot(
    [p, q]: [u32; 2],
    tube_radius: f64,
    displacement: f64,
    segments: u32,
    sides: u32,
) -> Surface {
    let [p, q] = [p, q].map(f64::from);
    let frames: Vec<[DVec3; 3]> = (0..segments)
        .map(|k| frame(p, q, TAU * f64::from(k) / f64::from(segments)))
        .collect();
    let mut surface = grid::ring(segments, sides, |column, row| {
        let [centre, out, side] = frames[column as usize];
        let along = f64::from(column) / f64::from(segments);
        let around = f64::from(row) / f64::from(sides);
        let [strands, windings] = STRANDS;
        let ripple = (TAU * strands * (around + windings * along)).cos();
        let radius = tube_radius * (1.0 + displacement * ripple);
        let angle = TAU * around;
        let direction = out * angle.cos() + side * angle.sin();
        (centre + direction * radius, direction)
    });
    surface.smooth_normals();
    surface
}

/// A point of the knot, and two unit vectors across it. The first is the torus' normal: it comes
/// back to itself after one turn, which a frame carried along the curve would not.
fn frame(p: f64, q: f64, angle: f64) -> [DVec3; 3] {
    let [major, minor] = TORUS;
    let (sin_p, cos_p) = (p * angle).sin_cos();
    let (sin_q, cos_q) = (q * angle).sin_cos();
    let outwards = DVec3::new(sin_p, 0.0, cos_p);
    let forwards = DVec3::new(cos_p, 0.0, -sin_p);
    let normal = outwards * cos_q + DVec3::Y * sin_q;
    let turn = outwards * -sin_q + DVec3::Y * cos_q;
    let centre = outwards * major + normal * minor;
    let tangent = forwards * (p * (major + minor * cos_q)) + turn * (q * minor);
    [centre, normal, tangent.cross(normal).normalize()]
}
