//! Closed grids: a ball with two poles, and a ring.
//!
//! Columns run around the axis towards the right as seen from outside, rows run down. The last
//! column is the first one again, with the other end of the texture.

use super::surface::Surface;
use bevy::math::{DVec2, DVec3};

/// A grid with a pole at either end: row 0 is the upper one, row `rings` the lower one.
///
/// `vertex(column, row)` gives place and normal for `column < segments`, and for a pole the same
/// place whatever the column. Makes `2 · segments · (rings - 1)` triangles.
pub(super) fn ball(
    segments: u32,
    rings: u32,
    mut vertex: impl FnMut(u32, u32) -> (DVec3, DVec3),
) -> Surface {
    let mut surface = Surface::default();
    for row in 0..=rings {
        let is_pole = row == 0 || row == rings;
        let columns = if is_pole { segments } else { segments + 1 };
        for column in 0..columns {
            let (position, normal) = vertex(column % segments, row);
            let middle = if is_pole { 0.5 } else { 0.0 };
            let u = (f64::from(column) + middle) / f64::from(segments);
            let v = f64::from(row) / f64::from(rings);
            surface.vertex(position, normal, DVec2::new(u, v));
        }
    }
    let first_of = |row: u32| match row {
        0 => 0,
        _ => segments + (row - 1) * (segments + 1),
    };
    for row in 0..rings {
        for column in 0..segments {
            let above = first_of(row) + column;
            let below = first_of(row + 1) + column;
            // A quad that touches a pole has no edge there, and is one triangle.
            if row == 0 {
                surface.triangle([above, below, below + 1]);
            } else if row + 1 == rings {
                surface.triangle([above, below, above + 1]);
            } else {
                surface.triangle([above, below, below + 1]);
                surface.triangle([above, below + 1, above + 1]);
            }
        }
    }
    surface
}

/// A grid that closes both ways. `vertex(column, row)` gives place and normal for
/// `column < segments`, `row < sides`. Makes `2 · segments · sides` triangles.
pub(super) fn ring(
    segments: u32,
    sides: u32,
    mut vertex: impl FnMut(u32, u32) -> (DVec3, DVec3),
) -> Surface {
    let mut surface = Surface::default();
    for row in 0..=sides {
        for column in 0..=segments {
            let (position, normal) = vertex(column % segments, row % sides);
            let u = f64::from(column) / f64::from(segments);
            let v = f64::from(row) / f64::from(sides);
            surface.vertex(position, normal, DVec2::new(u, v));
        }
    }
    for row in 0..sides {
        for column in 0..segments {
            let above = row * (segments + 1) + column;
            let below = above + segments + 1;
            surface.triangle([above, below, below + 1]);
            surface.triangle([above, below + 1, above + 1]);
        }
    }
    surface
}
