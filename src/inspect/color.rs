//! The colours of gizmos.

use crate::film::views::viridis;
use bevy::color::{LinearRgba, Srgba};
use glam::Vec3;

/// Visited nodes.
pub(super) const WHITE: LinearRgba = LinearRgba::rgb(1.0, 1.0, 1.0);
/// Nodes that were hit but pruned, and misses.
pub(super) const RED: LinearRgba = LinearRgba::rgb(1.0, 0.02, 0.02);
/// What a light does not reach; rays that carry nothing.
pub(super) const DARK: LinearRgba = LinearRgba::rgb(0.03, 0.03, 0.04);
/// A shadow ray up to its blocker.
pub(super) const BLOCKED: LinearRgba = LinearRgba::rgb(0.45, 0.12, 0.02);
/// Outlines of triangles that were hit.
pub(super) const YELLOW: LinearRgba = LinearRgba::rgb(1.0, 0.85, 0.0);
/// Shading normals.
pub(super) const GREEN: LinearRgba = LinearRgba::rgb(0.05, 0.9, 0.15);
/// Normals of triangles.
pub(super) const BLUE: LinearRgba = LinearRgba::rgb(0.1, 0.35, 1.0);
/// Normals at vertices.
pub(super) const VERTEX: LinearRgba = LinearRgba::rgb(0.112, 0.584, 0.122);
/// Normals that stand between vertices.
pub(super) const BETWEEN: LinearRgba = LinearRgba::rgb(0.05, 0.25, 0.3);
/// Lenses and cameras.
pub(super) const CYAN: LinearRgba = LinearRgba::rgb(0.05, 0.8, 0.9);
/// Motion.
pub(super) const ORANGE: LinearRgba = LinearRgba::rgb(1.0, 0.4, 0.02);
/// Split planes across x, y and z.
pub(super) const AXES: [LinearRgba; 3] = [
    LinearRgba::rgb(1.0, 0.1, 0.1),
    LinearRgba::rgb(0.1, 1.0, 0.1),
    LinearRgba::rgb(0.15, 0.3, 1.0),
];
/// Inner nodes where only leaves have a colour.
pub(super) const GREY: LinearRgba = LinearRgba::rgb(0.25, 0.25, 0.25);

/// Lines begin here on the palette: before a dark picture nobody sees what is darker.
const DARKEST: f32 = 0.3;

/// Below this the largest channel counts as nothing.
const NOTHING: f32 = 1e-4;

/// Radiance as a line's colour: times 2^`exposure`, and where that is brighter than a screen, scaled
/// down with its hue kept. What carries nothing is dark, but not invisible.
pub(super) fn of_radiance(radiance: Vec3, exposure: f32) -> LinearRgba {
    let exposed = radiance * exposure.exp2();
    let largest = exposed.max_element();
    if !(largest > NOTHING && largest.is_finite()) {
        return DARK;
    }
    let shown = (exposed / largest.max(1.0)).max(Vec3::ZERO);
    LinearRgba::rgb(shown.x, shown.y, shown.z)
}

/// A place in [0, 1] on the heatmaps' palette, without the darkest part of that.
pub(super) fn of_scale(place: f32) -> LinearRgba {
    let [r, g, b] = viridis(DARKEST + (1.0 - DARKEST) * place);
    Srgba::rgb(r, g, b).into()
}

/// The same colour, covering less.
pub(super) fn faint(color: LinearRgba, alpha: f32) -> LinearRgba {
    LinearRgba { alpha, ..color }
}
