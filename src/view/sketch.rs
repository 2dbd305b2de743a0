//! The lines of one entity's symbol.

use super::lines::Line;
use crate::scene::{
    DirectionalLamp, ParallelogramLamp, PointLamp, Projection, SceneCamera, SegmentLamp,
};
use bevy::camera::primitives::Aabb;
use bevy::color::{ColorToComponents, LinearRgba};
use bevy::math::{Affine3A, Vec3, Vec3A};
use std::f32::consts::TAU;

/// The colours of symbols, linear RGB with opacity.
pub(super) mod colors {
    use bevy::color::LinearRgba;

    pub const CAMERA: LinearRgba = LinearRgba::new(0.25, 0.45, 0.9, 0.9);
    pub const SELECTED: LinearRgba = LinearRgba::new(1.0, 0.35, 0.03, 1.0);
    pub const ACTIVE: LinearRgba = LinearRgba::new(1.0, 0.62, 0.12, 1.0);
}

/// Sides of circles.
const SIDES: u32 = 32;
/// Pieces of a line that is as long as a light, so that its colours are seen.
const PIECES: u32 = 8;

/// Collects the lines of one entity.
#[derive(Default)]
pub(super) struct Sketch {
    pub lines: Vec<Line>,
    /// Replaces the colours of what is selected.
    pub tint: Option<LinearRgba>,
    /// Metres: the radius of a light without an extent.
    pub size: f32,
}

/// As bright as colours get without losing their hue, so that a strong light's symbol is not white.
fn shown(color: LinearRgba) -> LinearRgba {
    let most = color.red.max(color.green).max(color.blue).max(1e-6);
    LinearRgba::new(color.red / most, color.green / most, color.blue / most, 1.0)
}

impl Sketch {
    fn line(&mut self, from: Vec3, to: Vec3, color: LinearRgba) {
        let color = self.tint.unwrap_or(color);
        self.lines.push(Line::new(from, to, color));
    }

    fn gradient(&mut self, ends: [Vec3; 2], colors: [LinearRgba; 2]) {
        // What carries a gradient keeps it: it is what one looks for.
        self.lines.push(Line { ends, colors });
    }

    fn circle(&mut self, center: Vec3, [x, y]: [Vec3; 2], color: LinearRgba) {
        let at = |i: u32| {
            let (sin, cos) = (i as f32 / SIDES as f32 * TAU).sin_cos();
            center + x * cos + y * sin
        };
        for i in 0..SIDES {
            self.line(at(i), at(i + 1), color);
        }
    }

    pub fn point(&mut self, place: &Affine3A, lamp: &PointLamp) {
        let color = shown(lamp.color);
        let center = Vec3::from(place.translation);
        for [x, y] in [[Vec3::X, Vec3::Y], [Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X]] {
            self.circle(center, [x * self.size, y * self.size], color);
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for side in [axis, -axis] {
                self.line(
                    center + side * 1.4 * self.size,
                    center + side * 2.2 * self.size,
                    color,
                );
            }
        }
        let Some(cone) = lamp.cone else {
            return;
        };
        let axes = unit_axes(place);
        let length = 8.0 * self.size;
        for angle in [cone.inner, cone.outer] {
            let (sin, cos) = angle.sin_cos();
            let middle = center - axes[2] * (length * cos);
            let rim = [axes[0], axes[1]].map(|axis| axis * (length * sin));
            self.circle(middle, rim, color);
            for side in [rim[0], -rim[0], rim[1], -rim[1]] {
                self.line(center, middle + side, color);
            }
        }
    }

    pub fn directional(&mut self, place: &Affine3A, lamp: &DirectionalLamp) {
        let color = shown(lamp.color);
        let center = Vec3::from(place.translation);
        let [x, y, z] = unit_axes(place);
        self.circle(center, [x * 2.0 * self.size, y * 2.0 * self.size], color);
        for start in [Vec3::ZERO, x, -x, y, -y] {
            let from = center + start * (1.2 * self.size);
            let tip = from - z * (8.0 * self.size);
            self.line(from, tip, color);
            for side in [x, -x] {
                self.line(tip, tip + (z * 1.2 + side * 0.5) * self.size, color);
            }
        }
    }

    pub fn segment(&mut self, place: &Affine3A, lamp: &SegmentLamp) {
        let ends = lamp.ends.map(|end| place.transform_point3(end));
        let colors = lamp.colors.map(shown);
        self.gradient(ends, colors);
        let (x, y) = (ends[1] - ends[0])
            .normalize_or(Vec3::X)
            .any_orthonormal_pair();
        for (end, color) in ends.into_iter().zip(colors) {
            self.circle(end, [x, y].map(|axis| axis * 0.5 * self.size), color);
        }
    }

    pub fn parallelogram(&mut self, place: &Affine3A, lamp: &ParallelogramLamp) {
        let corner = place.transform_point3(lamp.corner);
        let edges = lamp.edges.map(|edge| place.transform_vector3(edge));
        let colors = lamp.colors.map(shown);
        let at = |u: f32, v: f32| corner + edges[0] * u + edges[1] * v;
        let color = |u: f32, v: f32| {
            let low = mix(colors[0], colors[1], u);
            let high = mix(colors[2], colors[3], u);
            mix(low, high, v)
        };
        for i in 0..PIECES {
            let [a, b] = [i, i + 1].map(|i| i as f32 / PIECES as f32);
            for side in [0.0, 1.0] {
                self.gradient([at(a, side), at(b, side)], [color(a, side), color(b, side)]);
                self.gradient([at(side, a), at(side, b)], [color(side, a), color(side, b)]);
            }
        }
        // Where it shines.
        let normal = edges[0].cross(edges[1]).normalize_or_zero();
        let length = 0.25 * edges[0].length().min(edges[1].length());
        let middle = at(0.5, 0.5);
        let shade = color(0.5, 0.5);
        self.line(middle, middle + normal * length, shade);
        if lamp.two_sided {
            self.line(middle, middle - normal * length, shade);
        }
        if self.tint.is_some() {
            for i in 0..4 {
                let corners = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
                let out = normal * 0.002;
                self.line(corners[i] + out, corners[(i + 1) % 4] + out, shade);
            }
        }
    }

    pub fn camera(&mut self, place: &Affine3A, camera: &SceneCamera) {
        let center = Vec3::from(place.translation);
        let [x, y, z] = unit_axes(place);
        let (near, half) = match camera.projection {
            Projection::Perspective { fov_y } => (0.0, 3.0 * self.size * (0.5 * fov_y).tan()),
            Projection::Orthographic { height } => (1.0, 0.5 * height),
        };
        let aspect = 4.0 / 3.0;
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let across = corners.map(|[u, v]: [f32; 2]| x * (u * half * aspect) + y * (v * half));
        let ahead = center - z * 3.0 * self.size;
        for i in 0..4 {
            let next = across[(i + 1) % 4];
            self.line(ahead + across[i], ahead + next, colors::CAMERA);
            self.line(center + across[i] * near, ahead + across[i], colors::CAMERA);
        }
        // A roof says which way is up.
        let top = ahead + y * (1.6 * half);
        self.line(ahead + across[2], top, colors::CAMERA);
        self.line(ahead + across[3], top, colors::CAMERA);
    }

    pub fn bounds(&mut self, place: &Affine3A, aabb: &Aabb, color: LinearRgba) {
        let corner = |i: u32| {
            let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let local = aabb.center + aabb.half_extents * Vec3A::new(side(0), side(1), side(2));
            place.transform_point3(local.into())
        };
        for i in 0..8 {
            for bit in 0..3 {
                if i >> bit & 1 == 0 {
                    self.line(corner(i), corner(i | 1 << bit), color);
                }
            }
        }
    }

    pub fn axes(&mut self, place: &Affine3A, color: LinearRgba) {
        let center = Vec3::from(place.translation);
        for axis in unit_axes(place) {
            self.line(
                center - axis * 2.0 * self.size,
                center + axis * 2.0 * self.size,
                color,
            );
        }
    }
}

fn mix(a: LinearRgba, b: LinearRgba, t: f32) -> LinearRgba {
    LinearRgba::from_vec4(a.to_vec4().lerp(b.to_vec4(), t))
}

fn unit_axes(place: &Affine3A) -> [Vec3; 3] {
    let m = place.matrix3;
    [
        (m.x_axis, Vec3::X),
        (m.y_axis, Vec3::Y),
        (m.z_axis, Vec3::Z),
    ]
    .map(|(axis, instead)| Vec3::from(axis).try_normalize().unwrap_or(instead))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lights_gradient_is_drawn_in_its_colours() {
        let lamp = SegmentLamp {
            ends: [Vec3::ZERO, Vec3::X],
            colors: [
                LinearRgba::rgb(4.0, 0.0, 0.0),
                LinearRgba::rgb(0.0, 0.5, 0.0),
            ],
            ..SegmentLamp::default()
        };
        let mut sketch = Sketch::default();
        sketch.segment(&Affine3A::from_translation(Vec3::Y), &lamp);
        let line = sketch.lines[0];
        assert_eq!(line.ends, [Vec3::Y, Vec3::ONE - Vec3::Z]);
        let [from, to] = line.colors.map(|color| color.to_vec3());
        assert_eq!((from, to), (Vec3::X, Vec3::Y));
    }

    #[test]
    fn bounds_have_twelve_edges_of_the_right_lengths() {
        let mut sketch = Sketch::default();
        let aabb = Aabb::from_min_max(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0));
        let place = Affine3A::from_scale(Vec3::splat(2.0));
        sketch.bounds(&place, &aabb, LinearRgba::WHITE);
        let mut lengths: Vec<_> = sketch
            .lines
            .iter()
            .map(|line| line.ends[0].distance(line.ends[1]).round() as u32)
            .collect();
        lengths.sort_unstable();
        assert_eq!(lengths, [2, 2, 2, 2, 4, 4, 4, 4, 6, 6, 6, 6]);
    }
}
