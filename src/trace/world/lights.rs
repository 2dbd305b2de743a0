//! Lights as points: each kind gives, for a shading point and two random numbers, a direction,
//! a distance and what arrives from there.
//!
//! | kind | arrives (Physical), before the surface's cosine |
//! |---|---|
//! | point | `I · cone / d²`, W/m² |
//! | directional | `E`, W/m²; of a disc of directions as [`SunDisc`] has it |
//! | segment | `I'(x) / (p(x) d²)` for a point x of it |
//! | parallelogram | `L(x) · cos θ / (p(x) d²)` for a point x of it, θ at the emitter |
//! | dome | `L(ω) / p(ω)` for a direction ω; it is no light of these arrays, but the environment ([`Dome`](crate::trace::Dome)) |
//!
//! p is the density with which the point is chosen: one over length or area where all points are alike, else what
//! `segment_warp`, `parallelogram_warp` and `dome` take for the surface that sees it.
//!
//! With Classic lighting the colour itself arrives, whatever the distance and the angle, and points are chosen evenly;
//! a parallelogram shines to both sides then, as in simple Phong ray tracers, and there is no dome.
//!
//! A light may move while the shutter is open. Few do, so their velocities stand apart, and the kinds
//! know nothing of them: a light that moves by `velocity · t` is, seen from x, what the same light
//! standing still is, seen from `x - velocity · t` ([`Lights::in_rest_frame`]).

use super::spot_cone::SpotCone;
use super::sun_disc::SunDisc;
use crate::scene::Lighting;
use glam::Vec3;

/// The lights of a world, one array per kind, each sorted by id.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
#[expect(missing_docs, reason = "the names say it all")]
pub struct Lights {
    pub points: Vec<PointLight>,
    pub directionals: Vec<DirectionalLight>,
    pub segments: Vec<SegmentLight>,
    pub parallelograms: Vec<ParallelogramLight>,
    /// Those of them that move, whatever their kind; directional lights do not.
    pub moving: Vec<MovingLight>,
}

/// How a light moves while the shutter is open.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct MovingLight {
    /// The entity's `SceneId`.
    pub id: u64,
    /// World-space way from time 0 to time 1: at time t the light stands `velocity · t` farther.
    pub velocity: Vec3,
    /// Samples of a pixel that it asks for.
    pub samples: u32,
}

/// A point that shines in all directions, or within a cone.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PointLight {
    /// The entity's `SceneId`.
    pub id: u64,
    /// Where it stands.
    pub position: Vec3,
    /// Linear RGB, W/sr.
    pub color: Vec3,
    /// Limits it to a cone.
    pub cone: Option<SpotCone>,
}

/// Light from infinitely far.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct DirectionalLight {
    /// The entity's `SceneId`.
    pub id: u64,
    /// Unit vector towards the middle of the source.
    pub to_light: Vec3,
    /// Linear RGB, W/m² on a facing surface.
    pub color: Vec3,
    /// The directions in which the source is seen; `None` where it has no extent.
    pub disc: Option<SunDisc>,
    /// Shadow rays at the first hit.
    pub samples: u32,
}

/// A glowing line.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SegmentLight {
    /// The entity's `SceneId`.
    pub id: u64,
    /// Both ends in world space, each rounded to f32 there.
    pub ends: [Vec3; 2],
    /// Linear RGB at the ends, W/(sr·m).
    pub colors: [Vec3; 2],
    /// Shadow rays at the first hit.
    pub samples: u32,
}

/// A glowing parallelogram.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ParallelogramLight {
    /// The entity's `SceneId`.
    pub id: u64,
    /// One corner in world space, rounded to f32 there; the edges are not.
    pub corner: Vec3,
    /// The two edges that leave it.
    pub edges: [Vec3; 2],
    /// Linear RGB at `corner`, `corner + edges[0]`, `corner + edges[1]` and opposite, W/(sr·m²).
    pub colors: [Vec3; 4],
    /// Whether the side that `edges[0] × edges[1]` points away from shines too.
    pub two_sided: bool,
    /// Whether camera and mirror rays see it.
    pub visible: bool,
    /// Shadow rays at the first hit.
    pub samples: u32,
}

/// One point of a light as a shading point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightPoint {
    /// Unit vector from the shading point.
    pub direction: Vec3,
    /// From the shading point; infinite for directional lights and the dome.
    pub distance: f32,
    /// What arrives if nothing is in the way, before the surface's cosine.
    pub arriving: Vec3,
    /// Where on the light, in [0, 1]²; a segment uses the first number, of a dome it is the place in its map.
    pub place: [f32; 2],
    /// How likely that place is, as a multiple of what it is where points are chosen evenly over the light.
    pub density: f32,
}

/// The middle of a light, in the numbers that choose its points.
pub(in crate::trace) const MIDDLE: [f32; 2] = [0.5, 0.5];

/// Below this squared distance (in m²) a light is at the point: `1/d²` stays finite in f32.
const LEAST_SQUARED_DISTANCE: f32 = 1e-30;

/// Direction and length of the way to a light; `None` where there is none to go.
///
/// A light's own corner or end comes first when the way is summed up, `(corner - from) + edge`: far from the origin a
/// sum of positions loses the digits that their difference has.
pub(in crate::trace) fn towards(offset: Vec3) -> Option<(Vec3, f32)> {
    let squared = offset.length_squared();
    if !is_near_or_far(squared) {
        let length = squared.sqrt();
        return Some((offset * (1.0 / length), length));
    }
    // Squares of tiny and huge offsets leave f32's range.
    let scale = offset.abs().max_element();
    if !(scale > 0.0 && scale < f32::INFINITY) {
        return None;
    }
    let length = (offset / scale).length();
    Some(((offset / scale) / length, length * scale))
}

/// Whether squares of an offset with that squared length may have left f32's range.
#[inline(always)]
pub(in crate::trace) fn is_near_or_far(squared: f32) -> bool {
    !(1e-20..1e30).contains(&squared)
}

#[inline(always)]
pub(in crate::trace) fn inverse_square(distance: f32) -> f32 {
    1.0 / (distance * distance).max(LEAST_SQUARED_DISTANCE)
}

impl Lights {
    /// How the light with this `SceneId` moves; zero where it stands still.
    pub fn velocity(&self, id: u64) -> Vec3 {
        let found = self.moving.binary_search_by_key(&id, |light| light.id);
        found.map_or(Vec3::ZERO, |index| self.moving[index].velocity)
    }

    /// Where a point of the world lies at `time` in the frame that moves with a light: there the light
    /// stands where its array says.
    #[inline(always)]
    pub fn in_rest_frame(&self, id: u64, point: Vec3, time: f32) -> Vec3 {
        if self.moving.is_empty() {
            return point;
        }
        point - self.velocity(id) * time
    }
}

impl PointLight {
    /// The light as `from` sees it; `None` where nothing can arrive.
    pub fn point(&self, from: Vec3, lighting: Lighting) -> Option<LightPoint> {
        let (direction, distance) = towards(self.position - from)?;
        let cone = self.cone.map_or(1.0, |cone| cone.fall_off(-direction));
        (cone > 0.0).then(|| LightPoint {
            direction,
            distance,
            arriving: match lighting {
                Lighting::Physical => self.color * (cone * inverse_square(distance)),
                Lighting::Classic => self.color * cone,
            },
            place: MIDDLE,
            density: 1.0,
        })
    }
}

impl DirectionalLight {
    /// The middle of the source: all of its light, where it has no extent.
    pub fn middle(&self) -> LightPoint {
        LightPoint {
            direction: self.to_light,
            distance: f32::INFINITY,
            arriving: self.color,
            place: MIDDLE,
            density: 1.0,
        }
    }

    /// The direction that the numbers `u` in [0, 1)² choose within the source's disc.
    pub fn point(&self, u: [f32; 2], lighting: Lighting) -> LightPoint {
        let Some(disc) = &self.disc else {
            return self.middle();
        };
        let (direction, counts) = disc.direction(self.to_light, u, lighting);
        LightPoint {
            direction,
            distance: f32::INFINITY,
            arriving: self.color * counts,
            place: u,
            density: 1.0,
        }
    }

    /// The solid angle under which the source is seen, in sr; 0 where it has no extent.
    pub fn solid_angle(&self) -> f32 {
        self.disc.as_ref().map_or(0.0, SunDisc::solid_angle)
    }
}

impl SegmentLight {
    /// The way from a place to the point at fraction `u`.
    #[inline(always)]
    pub(in crate::trace) fn offset(&self, from: Vec3, u: f32) -> Vec3 {
        (self.ends[0] - from) + u * (self.ends[1] - self.ends[0])
    }

    /// Linear RGB at fraction `u`.
    #[inline(always)]
    pub(in crate::trace) fn color(&self, u: f32) -> Vec3 {
        self.colors[0].lerp(self.colors[1], u)
    }

    /// The point at fraction `u` of the segment, as `from` sees it.
    pub fn point(&self, from: Vec3, u: f32, lighting: Lighting) -> Option<LightPoint> {
        let (direction, distance) = towards(self.offset(from, u))?;
        let color = self.color(u);
        let length = (self.ends[1] - self.ends[0]).length();
        Some(LightPoint {
            direction,
            distance,
            arriving: match lighting {
                Lighting::Physical => color * (length * inverse_square(distance)),
                Lighting::Classic => color,
            },
            place: [u, MIDDLE[1]],
            density: 1.0,
        })
    }
}

impl ParallelogramLight {
    /// `edges[0] × edges[1]`: along the front's normal, its length the area.
    pub fn area_normal(&self) -> Vec3 {
        self.edges[0].cross(self.edges[1])
    }

    /// The way from a place to the point at (u, v).
    #[inline(always)]
    pub(in crate::trace) fn offset(&self, from: Vec3, [u, v]: [f32; 2]) -> Vec3 {
        (self.corner - from) + u * self.edges[0] + v * self.edges[1]
    }

    /// Linear RGB at the place (u, v) in [0, 1]².
    #[inline(always)]
    pub fn color(&self, u: f32, v: f32) -> Vec3 {
        let near = self.colors[0].lerp(self.colors[1], u);
        let far = self.colors[2].lerp(self.colors[3], u);
        near.lerp(far, v)
    }

    /// The point at `u` in [0, 1)², as `from` sees it; `None` from behind a one-sided light.
    pub fn point(&self, from: Vec3, u: [f32; 2], lighting: Lighting) -> Option<LightPoint> {
        let (direction, distance) = towards(self.offset(from, u))?;
        let color = self.color(u[0], u[1]);
        if lighting == Lighting::Classic {
            return Some(LightPoint {
                direction,
                distance,
                arriving: color,
                place: u,
                density: 1.0,
            });
        }
        // Cosine times area in one: the normal's length is the area.
        let facing = -direction.dot(self.area_normal());
        let facing = if self.two_sided { facing.abs() } else { facing };
        (facing > 0.0).then(|| LightPoint {
            direction,
            distance,
            arriving: color * (facing * inverse_square(distance)),
            place: u,
            density: 1.0,
        })
    }

    /// Where a ray meets the light's shining side: distance along the ray and radiance.
    pub fn meet(&self, origin: Vec3, direction: Vec3) -> Option<(f32, Vec3)> {
        let normal = self.area_normal();
        let slope = direction.dot(normal);
        if slope == 0.0 || (slope > 0.0 && !self.two_sided) {
            return None;
        }
        let to_corner = self.corner - origin;
        let t = to_corner.dot(normal) / slope;
        // Half of all rays go the other way.
        if t.is_nan() || t <= 0.0 {
            return None;
        }
        let at = t * direction - to_corner;
        let area_squared = normal.length_squared();
        let u = at.cross(self.edges[1]).dot(normal) / area_squared;
        let v = self.edges[0].cross(at).dot(normal) / area_squared;
        let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
        inside.then(|| (t, self.color(u, v)))
    }
}

/// How many shadow rays a light of `samples` asks for at a first hit: `samples`, or that many per
/// unit of `size` (m, m² or sr), always 1–1000.
pub fn sample_count(samples: u32, size: f32, scale_by_size: bool) -> u32 {
    if scale_by_size {
        (samples as f32 * size).ceil().clamp(1.0, 1000.0) as u32
    } else {
        samples.clamp(1, 1000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> ParallelogramLight {
        ParallelogramLight {
            id: 1,
            corner: Vec3::new(-1.0, 2.0, -1.0),
            edges: [Vec3::X * 2.0, Vec3::Z * 2.0],
            colors: [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE],
            two_sided: false,
            visible: true,
            samples: 1,
        }
    }

    #[test]
    fn samples_are_as_many_as_asked_for_or_that_many_a_unit_of_size_rounded_up() {
        for (samples, size, whole, scaled) in [
            (4, 4.0, 4, 16),
            (4, 0.25, 4, 1),
            (4, 0.26, 4, 2),
            (1, 0.0, 1, 1),
            (0, 3.0, 1, 1),
            (1000, 2.0, 1000, 1000),
            (u32::MAX, 1e-9, 1000, 5),
            (1, f32::INFINITY, 1, 1000),
        ] {
            let counts = [false, true].map(|by_size| sample_count(samples, size, by_size));
            assert_eq!(counts, [whole, scaled], "{samples} of {size}");
        }
    }

    #[test]
    fn a_point_light_follows_the_inverse_square_and_a_classic_one_does_not() {
        let light = PointLight {
            id: 1,
            position: Vec3::Y * 2.0,
            color: Vec3::new(4.0, 8.0, 12.0),
            cone: None,
        };
        let physical = light.point(Vec3::ZERO, Lighting::Physical).unwrap();
        assert_eq!(physical.arriving, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!((physical.direction, physical.distance), (Vec3::Y, 2.0));
        let classic = light.point(Vec3::ZERO, Lighting::Classic).unwrap();
        assert_eq!(classic.arriving, light.color);
    }

    #[test]
    fn a_light_on_the_point_or_next_to_it_gives_nothing_that_is_not_finite() {
        let light = |offset: f32| PointLight {
            id: 1,
            position: Vec3::ONE + Vec3::X * offset,
            color: Vec3::ONE,
            cone: None,
        };
        assert!(light(0.0).point(Vec3::ONE, Lighting::Physical).is_none());
        for exponent in 1..40 {
            let light = PointLight {
                position: Vec3::X * 10f32.powi(-exponent),
                ..light(0.0)
            };
            let point = light.point(Vec3::ZERO, Lighting::Physical);
            assert!(point.is_none_or(|p| p.arriving.is_finite() && p.direction.is_finite()));
        }
    }

    #[test]
    fn colours_are_bilinear_between_the_corners_in_their_documented_order() {
        let light = square();
        assert_eq!(light.color(0.0, 0.0), Vec3::X);
        assert_eq!(light.color(1.0, 0.0), Vec3::Y);
        assert_eq!(light.color(0.0, 1.0), Vec3::Z);
        assert_eq!(light.color(1.0, 1.0), Vec3::ONE);
        assert_eq!(light.color(0.5, 0.5), Vec3::splat(0.5));
    }

    #[test]
    fn a_one_sided_light_is_neither_seen_nor_felt_from_behind() {
        // X × Z points down: the front is below.
        let light = square();
        let below = light.meet(Vec3::new(0.0, 0.0, 0.0), Vec3::Y);
        assert_eq!(below.map(|(t, _)| t), Some(2.0));
        assert!(light.meet(Vec3::Y * 4.0, Vec3::NEG_Y).is_none());
        assert!(light.meet(Vec3::new(1.5, 0.0, 0.0), Vec3::Y).is_none());
        assert!(
            light
                .point(Vec3::Y * 4.0, [0.5; 2], Lighting::Physical)
                .is_none()
        );
        assert!(
            light
                .point(Vec3::ZERO, [0.5; 2], Lighting::Physical)
                .is_some()
        );
    }
}
