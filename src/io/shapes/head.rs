//! A head: sections through an idealised face, stacked from crown to neck, with features on them.

use super::grid;
use super::surface::Surface;
use bevy::math::DVec3;
use std::f64::consts::TAU;

/// A horizontal section: its height, the silhouette's z in front and behind, half its width.
type Section = [f64; 4];

/// From the crown's pole to the middle of the neck's flat end. Closest together where the face has
/// the most to show; 22 rings put one row on each.
const SECTIONS: [Section; 23] = [
    [1.00, -0.08, -0.08, 0.00],
    [0.975, 0.16, -0.34, 0.22],
    [0.90, 0.37, -0.53, 0.37],
    [0.77, 0.52, -0.66, 0.47],
    [0.61, 0.61, -0.735, 0.525],
    [0.46, 0.655, -0.76, 0.545],
    [0.36, 0.665, -0.76, 0.545],
    [0.29, 0.66, -0.755, 0.54],
    [0.22, 0.65, -0.745, 0.535],
    [0.14, 0.65, -0.725, 0.53],
    [0.06, 0.655, -0.70, 0.525],
    [-0.02, 0.66, -0.67, 0.515],
    [-0.09, 0.66, -0.64, 0.50],
    [-0.17, 0.65, -0.60, 0.485],
    [-0.225, 0.65, -0.57, 0.47],
    [-0.27, 0.645, -0.55, 0.455],
    [-0.33, 0.635, -0.525, 0.435],
    [-0.42, 0.605, -0.49, 0.39],
    [-0.53, 0.58, -0.455, 0.335],
    [-0.62, 0.50, -0.435, 0.285],
    [-0.70, 0.20, -0.43, 0.27],
    [-1.00, 0.17, -0.48, 0.30],
    [-1.00, -0.15, -0.15, 0.00],
];

/// A hill or hollow of the face: its height along z, its middle (|x|, y), its reach (x, y).
struct Feature(f64, [f64; 2], [f64; 2]);

const FEATURES: [Feature; 12] = [
    // brow, eye hollow, eyeball
    Feature(0.065, [0.17, 0.335], [0.17, 0.055]),
    Feature(-0.12, [0.20, 0.20], [0.10, 0.085]),
    Feature(0.05, [0.20, 0.20], [0.05, 0.05]),
    // bridge, tip and wings of the nose
    Feature(0.10, [0.0, 0.16], [0.06, 0.11]),
    Feature(0.20, [0.0, 0.0], [0.07, 0.09]),
    Feature(0.06, [0.085, -0.03], [0.05, 0.05]),
    // cheekbone, cheek
    Feature(0.05, [0.33, 0.04], [0.11, 0.09]),
    Feature(-0.04, [0.30, -0.22], [0.10, 0.13]),
    // below the nose, upper lip, lower lip
    Feature(-0.02, [0.0, -0.15], [0.05, 0.04]),
    Feature(0.045, [0.0, -0.215], [0.13, 0.045]),
    Feature(0.04, [0.0, -0.325], [0.11, 0.04]),
    // chin
    Feature(0.07, [0.0, -0.53], [0.13, 0.08]),
];

/// How far columns are drawn towards the face: 0 spaces them evenly, 1 would join them there.
const CROWDING: f64 = 0.45;

pub(super) fn head(segments: u32, rings: u32) -> Surface {
    let mut surface = grid::ball(segments, rings, |column, row| {
        let section = match row {
            0 => SECTIONS[0],
            _ if row == rings => SECTIONS[SECTIONS.len() - 1],
            _ => section_at(f64::from(row) / f64::from(rings)),
        };
        let turn = TAU * (f64::from(column) / f64::from(segments) - 0.5);
        (place(section, turn - CROWDING * turn.sin()), DVec3::Y)
    });
    surface.smooth_normals();
    surface
}

/// A point of the surface; angle 0 is the middle of the face, +Z.
fn place([y, front, back, half_width]: Section, angle: f64) -> DVec3 {
    if half_width == 0.0 {
        return DVec3::new(0.0, y, front);
    }
    let (sin, cos) = angle.sin_cos();
    let widest = (front * 0.35 + back * 0.65).min(front);
    let reach = if cos > 0.0 {
        front - widest
    } else {
        widest - back
    };
    let mut x = half_width * sin;
    let mut z = widest + reach * cos;
    if cos > 0.0 {
        let bell = |d: f64, reach: f64| (-(d / reach).powi(2)).exp();
        let relief: f64 = FEATURES
            .iter()
            .map(|Feature(height, at, reach)| {
                height * bell(x.abs() - at[0], reach[0]) * bell(y - at[1], reach[1])
            })
            .sum();
        z += relief;
    }
    x += ear(angle, y).copysign(x);
    z -= ear(angle, y) * 0.5;
    DVec3::new(x, y, z)
}

/// How far the ear stands out.
fn ear(angle: f64, y: f64) -> f64 {
    let behind = (angle.abs() - 98_f64.to_radians()) / 0.2;
    let above = (y - 0.12) / 0.16;
    0.13 * (-behind.powi(2) - above.powi(4)).exp()
}

/// The section at a fraction of the way from crown to neck, by Catmull and Rom's spline.
fn section_at(fraction: f64) -> Section {
    let last = SECTIONS.len() - 1;
    let at = fraction * last as f64;
    let left = (at.floor() as usize).min(last - 1);
    let t = at - left as f64;
    let [a, b, c, d] = [
        SECTIONS[left.saturating_sub(1)],
        SECTIONS[left],
        SECTIONS[left + 1],
        SECTIONS[(left + 2).min(last)],
    ];
    let mut section = [0.0; 4];
    for k in 0..4 {
        let (incoming, outgoing) = ((c[k] - a[k]) / 2.0, (d[k] - b[k]) / 2.0);
        let rise = c[k] - b[k];
        let bend = 3.0 * rise - 2.0 * incoming - outgoing;
        let twist = incoming + outgoing - 2.0 * rise;
        section[k] = b[k] + t * (incoming + t * (bend + t * twist));
    }
    section
}
