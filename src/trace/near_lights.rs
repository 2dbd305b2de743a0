//! By how much the light of lamps close by differs from what it has to be: what an error estimate needs
//! that looks at samples alone.
//!
//! A point chosen evenly on a large lamp close by misses the part that gives nearly all of the light: at height h below
//! the middle of a lamp of area A the squared relative error of one such sample is about A/(3πh²),
//! ∫ (h²/(ρ²+h²)²)² over the lamp against the square of the mean; along a segment of length l it is 3πl/(32h). Points are
//! not chosen so (`parallelogram_warp`, `segment_warp`), and little of that is left. But what arrives where nothing is in the way
//! is known in closed form: a polygon's by Lambert's formula (Baum, Rushmeier and Winget 1989, "Improving
//! radiosity solutions through the use of analytically determined form factors", eq. 6), a segment's by
//! integrating n·r/|r|³ along it. So where a lamp is close, the tracer tells by how much its points'
//! light differs from that times the part of them that nothing hides, and the mean of this over a pixel's
//! samples is the pixel's error itself. It is right where what hides the lamp does not depend on the point
//! chosen, and exact where nothing hides it. A lamp's colour counts as it is at its closest point.
//!
//! The value of a sample does not depend on any of this.

use super::direct::Shadow;
use super::{Lights, ParallelogramLight, SegmentLight, Surface};
use crate::scene::{Lighting, RenderSettings};
use glam::{DVec3, Vec3};
use std::f32::consts::FRAC_1_PI;
use std::ops::Range;

/// A lamp is close where the squared relative error of one point is seven or ten: a parallelogram of more area
/// than this times the squared distance (farther away, samples tell their error well enough themselves),
const NEAR_AREA: f32 = 64.0;
/// and a segment of more length than this times the distance.
const NEAR_LENGTH: f32 = 35.0;

/// A ball outside of which a lamp is not close.
#[derive(Clone, Copy, Debug)]
struct Reach {
    center: Vec3,
    squared_radius: f32,
}

/// Light points of one lamp that is close to the point that they shine on.
#[derive(Clone, Copy, Debug)]
struct Near {
    /// Into the batch.
    sample: u32,
    /// The shadow rays of those points that can add something.
    shadows: [u32; 2],
    /// How many points were chosen.
    points: u32,
    /// What each adds on average where nothing hides the lamp.
    expected: Vec3,
}

/// Lamps close to what a batch hits, and what they did not add or added too much.
#[derive(Clone, Debug, Default)]
pub(super) struct NearLights {
    segments: Vec<Reach>,
    parallelograms: Vec<Reach>,
    found: Vec<Near>,
    deviations: Vec<(u32, Vec3)>,
}

impl NearLights {
    /// Forgets the batch before, and gets ready for another.
    pub fn begin(&mut self, lights: &Lights, settings: &RenderSettings) {
        self.deviations.clear();
        self.segments.clear();
        self.parallelograms.clear();
        if settings.lighting == Lighting::Classic || !settings.features.soft_shadows {
            return;
        }
        let (segments, parallelograms) = (&lights.segments, &lights.parallelograms);
        self.segments.extend(segments.iter().map(|light| {
            let along = light.ends[1] - light.ends[0];
            let length = along.length();
            Reach::new(
                light.ends[0] + 0.5 * along,
                (0.5 + 1.0 / NEAR_LENGTH) * length,
            )
        }));
        self.parallelograms
            .extend(parallelograms.iter().map(|light| {
                let [a, b] = light.edges;
                let half = 0.5 * (a + b).length().max((a - b).length());
                let near = (light.area_normal().length() / NEAR_AREA).sqrt();
                Reach::new(light.corner + 0.5 * (a + b), half + near)
            }));
    }

    /// What the points of a segment light have to add on average to a surface at `at`, seen from the light as it
    /// stands at time 0, where it is close.
    pub fn segment(
        &self,
        i: usize,
        light: &SegmentLight,
        surface: &Surface,
        at: Vec3,
    ) -> Option<Vec3> {
        self.segments.get(i)?.holds(at).then_some(())?;
        let along = light.ends[1] - light.ends[0];
        let nearest = ((at - light.ends[0]).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let distance = (light.ends[0] + nearest * along).distance(at);
        if along.length() < NEAR_LENGTH * distance {
            return None;
        }
        let ends = light.ends.map(|end| end.as_dvec3() - at.as_dvec3());
        let irradiance = segment_irradiance(ends, surface.normal.as_dvec3());
        expected(
            surface,
            light.colors[0].lerp(light.colors[1], nearest),
            irradiance,
        )
    }

    /// The same for a parallelogram light.
    pub fn parallelogram(
        &self,
        i: usize,
        light: &ParallelogramLight,
        surface: &Surface,
        at: Vec3,
    ) -> Option<Vec3> {
        self.parallelograms.get(i)?.holds(at).then_some(())?;
        let (offset, normal) = (at - light.corner, light.area_normal());
        let area = normal.length();
        if offset.dot(normal) <= 0.0 && !light.two_sided {
            return None;
        }
        let [a, b] = light.edges;
        let u = (offset.cross(b).dot(normal) / (area * area)).clamp(0.0, 1.0);
        let v = (a.cross(offset).dot(normal) / (area * area)).clamp(0.0, 1.0);
        let distance_squared = (u * a + v * b).distance_squared(offset);
        if area < NEAR_AREA * distance_squared {
            return None;
        }
        let corners = [Vec3::ZERO, a, a + b, b].map(|c| (c - offset).as_dvec3());
        let irradiance = parallelogram_irradiance(corners, surface.normal.as_dvec3());
        expected(surface, light.color(u, v), irradiance)
    }

    /// For a sample of the batch, `points` points were chosen on a close lamp, which have to add this much
    /// together; these are the shadow rays to them.
    pub fn found(&mut self, sample: u32, points: u32, expected: Vec3, shadows: Range<usize>) {
        self.found.push(Near {
            sample,
            shadows: [shadows.start as u32, shadows.end as u32],
            points,
            expected: expected / points as f32,
        });
    }

    /// Once it is known which shadow rays arrive: what the close lamps' points added, less what they have
    /// to add on average. What arrives through something transparent counts as if nothing were there.
    pub fn compare(&mut self, shadows: &[Shadow], occluded: &[bool]) {
        for near in self.found.drain(..) {
            let [first, end] = near.shadows.map(|at| at as usize);
            // A point that cannot add anything has no shadow ray.
            let mut seen = near.points - (end - first) as u32;
            let mut added = Vec3::ZERO;
            for (shadow, occluded) in shadows[first..end].iter().zip(&occluded[first..end]) {
                if !occluded {
                    added += shadow.value;
                    seen += 1;
                }
            }
            let deviation = added - near.expected * seen as f32;
            self.deviations.push((near.sample, deviation));
        }
    }

    /// Of which samples of the batch a close lamp's light differs by how much from what it has to be on
    /// average; a sample may be named several times.
    pub fn deviations(&self) -> &[(u32, Vec3)] {
        &self.deviations
    }
}

impl Reach {
    fn new(center: Vec3, radius: f32) -> Self {
        Self {
            center,
            squared_radius: radius * radius,
        }
    }

    fn holds(&self, at: Vec3) -> bool {
        self.center.distance_squared(at) < self.squared_radius
    }
}

/// What leaves towards the viewer of an irradiance by a light of that colour; `None` where it is nothing, and
/// where there is a highlight, whose light is not known in closed form.
fn expected(surface: &Surface, color: Vec3, irradiance: f64) -> Option<Vec3> {
    let part = FRAC_1_PI * irradiance as f32;
    let value = color * surface.diffuse * part;
    let is_matt = surface.specular == Vec3::ZERO;
    (is_matt && part > 0.0 && value.is_finite()).then_some(value)
}

/// Irradiance of a surface with this unit normal by a segment of intensity 1 W/(sr·m), its ends given
/// from the surface's point.
fn segment_irradiance(ends: [DVec3; 2], normal: DVec3) -> f64 {
    let [height, other] = ends.map(|end| end.dot(normal));
    let mut ends = ends;
    // The part above the surface.
    for (i, (own, others)) in [(height, other), (other, height)].into_iter().enumerate() {
        if own <= 0.0 {
            if others <= 0.0 {
                return 0.0;
            }
            ends[i] = ends[i].lerp(ends[1 - i], own / (own - others));
        }
    }
    let Some(along) = (ends[1] - ends[0]).try_normalize() else {
        return 0.0;
    };
    let foot = ends[0] - ends[0].dot(along) * along;
    let squared = foot.length_squared().max(f64::MIN_POSITIVE);
    let of = |end: DVec3| {
        let length = end.length().max(f64::MIN_POSITIVE);
        (foot * (end.dot(along) / squared) - along).dot(normal) / length
    };
    of(ends[1]) - of(ends[0])
}

/// Irradiance of a surface with this unit normal by a parallelogram of radiance 1, its corners given in
/// order from the surface's point: half the sum over the edges of the angle under which each is seen times
/// the cosine of its plane's normal, of the part above the surface.
fn parallelogram_irradiance(corners: [DVec3; 4], normal: DVec3) -> f64 {
    // A plane cuts a corner off at most: five corners are left.
    let (mut above, mut count) = ([DVec3::ZERO; 8], 0);
    let mut push = |corner| {
        above[count] = corner;
        count += 1;
    };
    for i in 0..4 {
        let (from, to) = (corners[i], corners[(i + 1) % 4]);
        let (height, next) = (from.dot(normal), to.dot(normal));
        if height >= 0.0 {
            push(from);
        }
        if (height < 0.0) != (next < 0.0) {
            push(from.lerp(to, height / (height - next)));
        }
    }
    let edges = (0..count).map(|i| (above[i], above[(i + 1) % count]));
    let sum: f64 = edges
        .map(|(from, to)| {
            let across = from.cross(to);
            let sine = across.length();
            let angle = sine.atan2(from.dot(to));
            if sine > 0.0 {
                angle * across.dot(normal) / sine
            } else {
                0.0
            }
        })
        .sum();
    0.5 * sum.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn irradiances_are_those_of_a_fine_sum_over_the_lamp_wherever_it_stands() {
        let normal = DVec3::new(0.2, 0.9, -0.3).normalize();
        let (a, b) = (DVec3::new(0.7, 0.1, 0.2), DVec3::new(-0.1, 0.4, 0.6));
        for corner in [
            DVec3::new(-0.3, 0.3, -0.2),
            DVec3::new(0.4, 0.05, 0.1),
            DVec3::new(-0.4, -0.2, 0.3),
            DVec3::new(0.3, -2.0, 0.3),
        ] {
            let corners = [corner, corner + a, corner + a + b, corner + b];
            let n = 1000;
            let (mut area, mut line) = (0.0, 0.0);
            for i in 0..n {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                let r = corner + u * a;
                line += r.dot(normal).max(0.0) / r.length().powi(3) * a.length() / f64::from(n);
                for j in 0..n {
                    let r = corner + u * a + (f64::from(j) + 0.5) / f64::from(n) * b;
                    let facing = r.dot(a.cross(b)).abs();
                    area += r.dot(normal).max(0.0) * facing / r.length().powi(4) / f64::from(n * n);
                }
            }
            let exact = parallelogram_irradiance(corners, normal);
            assert!(
                (exact - area).abs() < 1e-3 * area.max(1e-6),
                "{exact}, summed {area}"
            );
            let exact = segment_irradiance([corner, corner + a], normal);
            assert!(
                (exact - line).abs() < 1e-3 * line.max(1e-6),
                "{exact}, summed {line}"
            );
        }
    }

    #[test]
    fn a_lamp_that_fills_the_sky_gives_pi_and_a_long_segment_twice_its_intensity_by_the_height() {
        let corner = |x, z| DVec3::new(x, 1e-3, z);
        let square = [
            corner(-5.0, -5.0),
            corner(5.0, -5.0),
            corner(5.0, 5.0),
            corner(-5.0, 5.0),
        ];
        let sky = parallelogram_irradiance(square, DVec3::Y);
        assert!((sky / PI - 1.0).abs() < 1e-5, "{sky}");
        let long = segment_irradiance([corner(-9.0, 0.0), corner(9.0, 0.0)], DVec3::Y);
        assert!((long / 2e3 - 1.0).abs() < 1e-5, "{long}");
    }
}
