//! How wide a ray is: a cone around it, as wide as its pixel (Akenine-Möller, Nilsson, Andersson,
//! Barré-Brisebois, Toth, Karras 2019, "Texture Level of Detail Strategies for Real-Time Ray
//! Tracing", Ray Tracing Gems, ch. 20).

use crate::scene::Projection;
use crate::trace::Camera;
use glam::{UVec2, Vec2, Vec3};

/// A cone around a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cone {
    /// Width in metres where the ray starts.
    pub width: f32,
    /// By how much it grows per metre.
    pub spread: f32,
}

impl Cone {
    /// The cone of a pixel, for any of its rays.
    pub fn of_pixel(camera: &Camera, size: UVec2) -> Self {
        let of_row = 2.0 * camera.half_height() / size.y as f32;
        match camera.projection {
            Projection::Perspective { .. } => Self {
                width: 0.0,
                spread: of_row,
            },
            Projection::Orthographic { .. } => Self {
                width: of_row,
                spread: 0.0,
            },
        }
    }

    /// Width at `distance` metres.
    pub fn width_at(self, distance: f32) -> f32 {
        self.width + self.spread * distance
    }

    /// The cone that a flat mirror at `distance` sends on, widened by `scatter` per metre.
    pub fn reflected(self, distance: f32, scatter: f32) -> Self {
        Self {
            width: self.width_at(distance),
            spread: self.spread + scatter,
        }
    }
}

/// Edge of the square, in texture coordinates, that a cone of `width` covers on a triangle which it
/// meets with `cosine` to the normal: the width's share of the triangle's own scale. `edges` leave its first corner:
/// edges, because corners far from the origin have lost the digits that tell one from the other.
pub(super) fn texture_footprint(edges: [Vec3; 2], uvs: [Vec2; 3], width: f32, cosine: f32) -> f32 {
    let area = edges[0].cross(edges[1]).length();
    let uv_area = (uvs[1] - uvs[0]).perp_dot(uvs[2] - uvs[0]).abs();
    let scale = (uv_area / area).sqrt();
    // Half way between the footprint's short and long edge (width and width/cosine).
    let footprint = width * scale / cosine.abs().max(1e-3).sqrt();
    if footprint.is_finite() {
        footprint
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixels_cone_is_as_wide_as_the_pixel() {
        let camera = Camera::looking_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.8);
        let size = UVec2::new(300, 200);
        let cone = Cone::of_pixel(&camera, size);
        // At distance 5 the picture is 2 · 5 · tan(0.4) high.
        let expected = 10.0 * 0.4_f32.tan() / 200.0;
        assert!((cone.width_at(5.0) - expected).abs() < 1e-6);
        let after = cone.reflected(2.0, 0.0);
        assert!((after.width_at(3.0) - expected).abs() < 1e-6);
    }

    #[test]
    fn a_texture_that_covers_four_metres_is_seen_through_a_quarter_of_the_width() {
        let edges = [Vec3::X * 4.0, Vec3::Z * 4.0];
        let uvs = [Vec2::ZERO, Vec2::X, Vec2::Y];
        assert_eq!(texture_footprint(edges, uvs, 0.5, 1.0), 0.125);
        assert_eq!(texture_footprint(edges, [Vec2::ZERO; 3], 0.5, 1.0), 0.0);
        assert_eq!(texture_footprint([Vec3::ZERO; 2], uvs, 0.5, 0.0), 0.0);
    }
}
