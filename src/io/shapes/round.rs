//! Sphere, cylinder and torus.

use super::grid;
use super::surface::Surface;
use bevy::math::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The direction of a column: the texture's middle faces +Z, and u grows towards the right as seen
/// from outside.
fn around(column: u32, segments: u32) -> DVec3 {
    let angle = TAU * (f64::from(column) / f64::from(segments) - 0.5);
    DVec3::new(angle.sin(), 0.0, angle.cos())
}

pub(super) fn sphere(radius: f64, segments: u32, rings: u32) -> Surface {
    grid::ball(segments, rings, |column, row| {
        let direction = if row == 0 {
            DVec3::Y
        } else if row == rings {
            DVec3::NEG_Y
        } else {
            let angle = PI * f64::from(row) / f64::from(rings);
            around(column, segments) * angle.sin() + DVec3::Y * angle.cos()
        };
        (direction * radius, direction)
    })
}

pub(super) fn torus(major_radius: f64, minor_radius: f64, segments: u32, sides: u32) -> Surface {
    grid::ring(segments, sides, |column, row| {
        let outwards = around(column, segments);
        // Row 0 is the inner equator, so that the texture's seam hides there; rows run down outside.
        let angle = PI - TAU * f64::from(row) / f64::from(sides);
        let normal = outwards * angle.cos() + DVec3::Y * angle.sin();
        (outwards * major_radius + normal * minor_radius, normal)
    })
}

pub(super) fn cylinder(radius: f64, height: f64, segments: u32) -> Surface {
    let mut surface = Surface::default();
    let rim = |column: u32| around(column % segments, segments);
    let top = DVec3::Y * (height / 2.0);
    for column in 0..segments {
        let [left, right] = [column, column + 1].map(|column| {
            let (normal, u) = (rim(column), f64::from(column) / f64::from(segments));
            [(top, 0.0), (-top, 1.0)]
                .map(|(end, v)| surface.vertex(normal * radius + end, normal, DVec2::new(u, v)))
        });
        surface.triangle([left[0], left[1], right[1]]);
        surface.triangle([left[0], right[1], right[0]]);
    }
    for (end, up) in [(top, 1.0), (-top, -1.0)] {
        let normal = DVec3::Y * up;
        let centre = surface.vertex(end, normal, DVec2::splat(0.5));
        let first = centre + 1;
        for column in 0..segments {
            let direction = rim(column);
            let uv = DVec2::new(0.5 + direction.x / 2.0, 0.5 + up * direction.z / 2.0);
            surface.vertex(direction * radius + end, normal, uv);
        }
        for column in 0..segments {
            let (a, b) = (first + column, first + (column + 1) % segments);
            surface.triangle(if up > 0.0 {
                [centre, a, b]
            } else {
                [centre, b, a]
            });
        }
    }
    surface
}
