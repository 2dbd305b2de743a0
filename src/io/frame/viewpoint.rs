//! Where to look from, so that much of what there is can be seen at once.
//!
//! From each of some dozen directions the triangles are drawn into a small picture with a depth for each pixel. What
//! counts is how much of it is covered, by fronts more than by backs: a plate is seen from its front, a room from where
//! it is open, and not its walls from behind. Where views are alike, the one half from the side and above wins that
//! people draw things from.

use super::surface::Surface;
use crate::scene::Projection;
use bevy::math::Vec3;
use bevy::transform::components::Transform;
use rayon::prelude::*;
use std::f32::consts::FRAC_PI_3;

/// Room around what is shown, as a factor of its distance.
const MARGIN: f32 = 1.06;
/// Pixels on a side of the pictures that decide.
const SIDE: usize = 96;
/// Degrees above the horizon from which is looked.
const ELEVATIONS: [f32; 3] = [20.0, 40.0, -30.0];
/// Degrees to the right of the front.
const AZIMUTHS: [f32; 12] = [
    0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0, 210.0, 240.0, 270.0, 300.0, 330.0,
];
/// Pixels that are looked at in one of them: what covers more lies in some hundred layers.
const MOST_PIXELS: usize = 1 << 22;
/// What a pixel with the back of a triangle counts, beside 1 for a front.
const BACK: f32 = 0.5;
/// A surface that is seen at less than this cosine counts as if it were seen at it.
const LEAST_COSINE: f32 = 0.1;
/// By how much the usual view may show less and be taken all the same; less so the further a view is from it.
const HABIT: f32 = 0.25;
/// What a view from below counts, beside 1: things stand on something.
const BELOW: f32 = 0.8;
/// From the middle of what is shown to the usual camera: from the front, a little from the right, above.
const USUAL: Vec3 = Vec3::new(0.47, 0.34, 0.814);

/// A camera with the default field of view that has everything in its picture.
pub(super) fn framing(surface: &Surface) -> Transform {
    let fov_y = match Projection::default() {
        Projection::Perspective { fov_y } => fov_y,
        Projection::Orthographic { .. } => FRAC_PI_3,
    };
    let tangent = (0.5 * fov_y).tan();
    let (centre, radius) = surface.sphere();
    let eye = |towards: Vec3| {
        // No nearer than where nothing is in front of the camera, however thin it is seen from there.
        let distance = surface
            .distance(centre, towards, tangent)
            .max(1e-3 * radius);
        let position = Transform::from_translation(centre + towards * distance * MARGIN);
        position.looking_at(centre, Vec3::Y)
    };
    if surface.triangles.is_empty() {
        return eye(USUAL.normalize());
    }
    let views = ELEVATIONS.iter().flat_map(|elevation| {
        let (up, level) = elevation.to_radians().sin_cos();
        AZIMUTHS.iter().map(move |azimuth| {
            let (x, z) = azimuth.to_radians().sin_cos();
            Vec3::new(level * x, up, level * z)
        })
    });
    let views: Vec<Vec3> = views.collect();
    let mut scores = Vec::new();
    let score = |&towards: &Vec3| {
        let habit = 1.0 + HABIT * towards.dot(USUAL);
        let below = if towards.y < 0.0 { BELOW } else { 1.0 };
        shown(surface, &eye(towards), tangent) * habit * below
    };
    views.par_iter().map(score).collect_into_vec(&mut scores);
    let best = (0..views.len()).max_by(|&a, &b| scores[a].total_cmp(&scores[b]).then(b.cmp(&a)));
    eye(best.map_or(USUAL.normalize(), |best| views[best]))
}

/// Whether all there is lies behind a camera or on one side of its picture, were that twice as wide as high: then nothing
/// is seen for sure.
pub(super) fn looks_past(surface: &Surface, eye: &Transform, projection: Projection) -> bool {
    const ASPECT: f32 = 2.0;
    let view_from_world = eye.compute_affine().inverse();
    let mut are_all_beyond = [!surface.points.is_empty(); 5];
    for &point in &surface.points {
        let p = view_from_world.transform_point3(point);
        let high = match projection {
            Projection::Perspective { fov_y } => (0.5 * fov_y).tan() * -p.z,
            Projection::Orthographic { height } => 0.5 * height,
        };
        let wide = ASPECT * high;
        let is_beyond = [p.z >= 0.0, p.x > wide, -p.x > wide, p.y > high, -p.y > high];
        for (are_all, is) in are_all_beyond.iter_mut().zip(is_beyond) {
            *are_all &= is;
        }
    }
    are_all_beyond.contains(&true)
}

/// How much a camera sees of everything: the geometric mean of the surface that it sees and of that as its picture has it,
/// in pixels at a distance of 1. By the first alone a plate would be seen as well from its edge, and by the second a box
/// from its front, of which the sides are seen too from beside it.
fn shown(surface: &Surface, eye: &Transform, tangent: f32) -> f32 {
    let view_from_world = eye.compute_affine().inverse();
    // 1 / distance of the nearest so far, and what it counts.
    let mut pixels = vec![(0.0_f32, 0.0_f32); SIDE * SIDE];
    let mut left = MOST_PIXELS;
    for triangle in &surface.triangles {
        let corners = triangle.map(|corner| view_from_world.transform_point3(corner));
        let half = 0.5 * SIDE as f32;
        let [a, b, c] = corners.map(|p| {
            let scale = half / (tangent * -p.z);
            // Pixels from the left and the bottom, and 1 / distance, which is linear in them.
            Vec3::new(half + p.x * scale, half + p.y * scale, 1.0 / -p.z)
        });
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if !area.is_finite() {
            continue;
        }
        let side = if area > 0.0 { 1.0 } else { BACK };
        let [p, q, r] = corners;
        let normal = (q - p).cross(r - p).normalize_or_zero();
        let cosine = normal.dot((p + q + r).normalize_or_zero()).abs();
        let counts = side / cosine.max(LEAST_COSINE).sqrt();
        let mut draw = |x: usize, y: usize, nearness: f32| {
            let pixel = &mut pixels[y * SIDE + x];
            if nearness > pixel.0 {
                *pixel = (nearness, counts);
            }
        };
        let least = a.min(b).min(c).max(Vec3::ZERO);
        let most = a.max(b).max(c).min(Vec3::splat(SIDE as f32 - 0.5));
        // Beside the picture: of numbers so large or so close that rounding moves them out of it.
        if (most - least).truncate().min_element() < 0.0 {
            continue;
        }
        // One that is smaller than a pixel covers that one.
        if (most - least).truncate().max_element() < 1.0 {
            let middle = (a + b + c) / 3.0;
            let [x, y] = [middle.x, middle.y].map(|at| (at as usize).min(SIDE - 1));
            draw(x, y, middle.z);
            continue;
        }
        let [width, height] = [0, 1].map(|i| most[i] as usize + 1 - least[i] as usize);
        left = left.saturating_sub(width * height);
        if left == 0 {
            break;
        }
        for y in least.y as usize..=most.y as usize {
            for x in least.x as usize..=most.x as usize {
                let p = Vec3::new(x as f32 + 0.5, y as f32 + 0.5, 0.0);
                let weight = |from: Vec3, to: Vec3| {
                    (to - from).truncate().perp_dot((p - from).truncate()) / area
                };
                let [u, v, w] = [weight(b, c), weight(c, a), weight(a, b)];
                if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                    draw(x, y, u * a.z + v * b.z + w * c.z);
                }
            }
        }
    }
    let seen = pixels.iter().filter(|(nearness, _)| *nearness > 0.0);
    let area = seen.map(|&(nearness, counts)| f64::from(counts) / f64::from(nearness).powi(2));
    area.sum::<f64>() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(triangles: &[[[f32; 3]; 3]]) -> Surface {
        let triangles: Vec<[Vec3; 3]> = triangles.iter().map(|t| t.map(Vec3::from)).collect();
        Surface {
            points: triangles.iter().flatten().copied().collect(),
            triangles,
        }
    }

    #[test]
    fn what_lies_beside_the_picture_is_not_seen_at_its_edge() {
        for beside in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
            let at = |x: f32, y: f32| (10.0 * beside + Vec3::new(x, y, -1.0)).to_array();
            for size in [0.01, 1.0] {
                let triangle = [at(0.0, 0.0), at(size, 0.0), at(0.0, size)];
                let seen = shown(&surface(&[triangle]), &Transform::IDENTITY, 1.0);
                assert_eq!(seen, 0.0, "{beside}, {size} m");
            }
        }
    }

    /// A square of two triangles around `normal`, `right` of it to the right as seen from the front.
    fn square(normal: Vec3, right: Vec3, middle: Vec3) -> [[[f32; 3]; 3]; 2] {
        let up = normal.cross(right);
        let at = |x: f32, y: f32| (middle + x * right + y * up).to_array();
        let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn a_plate_is_seen_from_its_front_wherever_that_is() {
        for normal in [Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y] {
            let right = normal.any_orthonormal_vector();
            let eye = framing(&surface(&square(normal, right, Vec3::new(5.0, 0.0, 0.0))));
            let forward = eye.forward();
            let facing = -forward.dot(normal);
            assert!(
                facing > 0.45,
                "{normal}: looked at along {forward:?}, at a cosine of {facing}"
            );
        }
    }

    #[test]
    fn three_faces_of_a_box_are_seen() {
        for size in [
            Vec3::ONE,
            Vec3::new(1.0, 2.0, 1.0),
            Vec3::new(3.0, 1.0, 2.0),
            Vec3::new(1.0, 1.0, 5.0),
            Vec3::new(1e-3, 1e-3, 2e-3),
        ] {
            let walls = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
            let wall = |wall: Vec3| square(wall, wall.any_orthonormal_vector(), wall);
            let scaled =
                |triangle: [[f32; 3]; 3]| triangle.map(|p| (Vec3::from(p) * size).to_array());
            let triangles: Vec<_> = walls.into_iter().flat_map(wall).map(scaled).collect();
            let forward = framing(&surface(&triangles)).forward();
            let least = forward.abs().min_element();
            assert!(least > 0.2, "{size}: along {forward:?}");
        }
    }

    #[test]
    fn a_room_is_seen_from_its_open_side() {
        for open in [Vec3::Z, -Vec3::X, -Vec3::Z] {
            let walls = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
            let walls = walls.iter().filter(|&&wall| wall != open);
            // Its walls face inwards.
            let wall = |&wall: &Vec3| square(-wall, wall.any_orthonormal_vector(), wall);
            let eye = framing(&surface(&walls.flat_map(wall).collect::<Vec<_>>()));
            let towards = -eye.forward().dot(open);
            assert!(
                towards > 0.8,
                "open to {open}, seen at a cosine of {towards}"
            );
        }
    }

    #[test]
    fn everything_is_in_the_picture_and_the_picture_is_used() {
        let long = [[[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [100.0, 1.0, 0.1]]];
        let flat = square(Vec3::Y, Vec3::X, Vec3::new(1e5, 0.0, 0.0));
        for triangles in [&long[..], &flat[..]] {
            let surface = surface(triangles);
            let eye = framing(&surface);
            let view = eye.compute_affine().inverse();
            let tangent = (0.5 * 50_f32.to_radians()).tan();
            let corners = surface.triangles.iter().flatten();
            let across = corners.map(|&corner| {
                let p = view.transform_point3(corner);
                assert!(p.z < 0.0, "{corner} is behind the camera");
                (p.x.abs().max(p.y.abs()) / -p.z) / tangent
            });
            let most = across.fold(0.0, f32::max);
            assert!(
                (0.6..1.0).contains(&most),
                "reaches to {most} of the picture's edge"
            );
        }
    }
}
