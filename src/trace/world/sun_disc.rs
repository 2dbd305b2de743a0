//! The disc of directions that a light from infinitely far fills: a cap of the sphere, its radiance constant.
//!
//! A surface that faces its middle gets `E = L · π sin² θ`, θ the half-angle; so `L = E / (π sin² θ)`, up to θ = π/2.
//!
//! # Which direction
//! One at the angle φ to the middle is chosen with the density `(cos φ + k) / (2π S)` per solid angle, where
//! `S = sin² θ / 2 + k (1 - cos θ)`. With k = 0 that is a uniform point of a flat disc of radius sin θ, lifted onto the
//! sphere (Malley's method: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., A.5.3): a matt surface that
//! faces the light gets the same from every sample. On other surfaces a sample counts 1/cos φ, which has no bound near
//! 90°; there k keeps it finite.

use crate::scene::Lighting;
use crate::trace::math::disc::concentric;
use glam::Vec3;
use std::f32::consts::TAU;

/// `cos φ + k` is nowhere less: no sample of a disc counts more than 10 times the mean. At 1/8 only discs of more than
/// 165° need a k at all; at 180° the samples of a surface that faces the light then differ by 15 % (1 σ).
const LEAST_DENSITY: f32 = 0.125;

/// A disc of directions about a light's middle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SunDisc {
    /// Sine of the half-angle, in (0, 1].
    pub sin_half_angle: f32,
    /// Cosine of the half-angle, in [0, 1].
    pub cos_half_angle: f32,
}

impl SunDisc {
    /// A disc of that angular diameter in radians, at most π; `None` where it is 0, which is no disc.
    pub fn of_diameter(diameter: f32) -> Option<Self> {
        let (sine, cosine) = (0.5 * diameter).sin_cos();
        (diameter > 0.0).then_some(Self {
            sin_half_angle: sine,
            // π in f32 is a little more than π.
            cos_half_angle: cosine.max(0.0),
        })
    }

    /// The solid angle of the disc, in sr: 2π at most.
    pub fn solid_angle(&self) -> f32 {
        TAU * self.sin_half_angle * self.sin_half_angle / (1.0 + self.cos_half_angle)
    }

    /// The direction, a unit vector, that the numbers `u` in [0, 1)² choose about the unit vector `middle`, and what
    /// a sample in it counts, as a multiple of E: radiance over density. Classic takes uniform points of the flat
    /// disc, each for 1.
    pub(in crate::trace) fn direction(
        &self,
        middle: Vec3,
        u: [f32; 2],
        lighting: Lighting,
    ) -> (Vec3, f32) {
        self.frame(middle, lighting).direction(u)
    }

    /// What all its directions share.
    #[inline(always)]
    pub(in crate::trace) fn frame(&self, middle: Vec3, lighting: Lighting) -> SunFrame {
        let (sine, cosine) = (self.sin_half_angle, self.cos_half_angle);
        let (k, is_even) = match lighting {
            Lighting::Physical => ((LEAST_DENSITY - cosine).max(0.0), false),
            Lighting::Classic => (0.0, true),
        };
        let (x, y) = middle.any_orthonormal_pair();
        SunFrame {
            axes: [x, y, middle],
            k,
            twice_s: sine * sine + 2.0 * k * (1.0 - cosine),
            radiance: 1.0 + 2.0 * k / (1.0 + cosine),
            is_even,
        }
    }
}

/// A disc about its middle.
pub(in crate::trace) struct SunFrame {
    /// The last one to the middle.
    axes: [Vec3; 3],
    k: f32,
    twice_s: f32,
    radiance: f32,
    /// Whether all samples count the same.
    is_even: bool,
}

impl SunFrame {
    /// As [`SunDisc::direction`] says. Without a branch.
    #[inline(always)]
    pub fn direction(&self, u: [f32; 2]) -> (Vec3, f32) {
        let Self {
            axes: [x, y, middle],
            k,
            twice_s,
            ..
        } = *self;
        // The share v of the disc's density lies within the angle whose versine s solves
        // s (1 + k) - s²/2 = v S.
        let p = concentric(u);
        let v = p.length_squared();
        let root = ((1.0 + k) * (1.0 + k) - v * twice_s).max(0.0).sqrt();
        let divisor = 1.0 + k + root;
        let versine = v * twice_s / divisor;
        // sin φ per unit of |p|; with k = 0 it is sin θ.
        let lateral = (twice_s * (2.0 - versine) / divisor).sqrt();
        let height = 1.0 - versine;
        let direction = height * middle + lateral * (p.x * x + p.y * y);
        let counts = self.radiance / (height + k);
        (direction, if self.is_even { 1.0 } else { counts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    /// The mean over the disc of what a sample counts, times `f` of its direction.
    fn mean(disc: &SunDisc, middle: Vec3, lighting: Lighting, f: impl Fn(Vec3) -> f32) -> f64 {
        let n = 1024;
        let values = (0..n * n).map(|i| {
            let u = [i % n, i / n].map(|i| (i as f32 + 0.5) / n as f32);
            let (direction, counts) = disc.direction(middle, u, lighting);
            assert!((direction.length() - 1.0).abs() < 1e-6, "{direction}");
            f64::from(counts * f(direction))
        });
        values.sum::<f64>() / f64::from(n * n)
    }

    #[test]
    fn a_facing_surface_gets_all_of_it_whatever_the_diameter() {
        let middle = Vec3::new(0.36, 0.48, 0.8);
        for degrees in [1e-6_f32, 0.53, 10.0, 90.0, 160.0, 165.0, 175.0, 180.0] {
            let disc = SunDisc::of_diameter(degrees.to_radians()).unwrap();
            let found = mean(&disc, middle, Lighting::Physical, |d| d.dot(middle));
            // The grid's own error where the density turns at the rim: (1/1024)^1.5.
            assert!((found - 1.0).abs() < 1e-4, "{degrees}°: {found}");
        }
    }

    #[test]
    fn the_radiance_is_the_same_everywhere_on_the_disc() {
        // What comes from within a smaller angle φ is its share of the projected solid angle.
        for degrees in [60.0_f32, 150.0, 175.0, 180.0] {
            let disc = SunDisc::of_diameter(degrees.to_radians()).unwrap();
            for share in [0.2_f32, 0.5, 0.8] {
                let limit = (share * 0.5 * degrees.to_radians()).cos();
                let within = |d: Vec3| if d.z > limit { d.z } else { 0.0 };
                let found = mean(&disc, Vec3::Z, Lighting::Physical, within);
                let sines = [1.0 - limit * limit, disc.sin_half_angle.powi(2)];
                let expected = f64::from(sines[0] / sines[1]);
                // Cells of the grid that the limit crosses: a few thousandths.
                assert!(
                    (found - expected).abs() < 4e-3,
                    "{degrees}°, {share}: {found} instead of {expected}"
                );
            }
        }
    }

    #[test]
    fn the_whole_sky_gives_a_wall_half_and_no_sample_more_than_ten_times_the_mean() {
        let disc = SunDisc::of_diameter(PI).unwrap();
        let wall = mean(&disc, Vec3::Z, Lighting::Physical, |d| d.x.max(0.0));
        assert!((wall - 0.5).abs() < 1e-3, "{wall}");
        for degrees in 1..=180_u16 {
            let disc = SunDisc::of_diameter(f32::from(degrees).to_radians()).unwrap();
            for u in [[0.0, 0.0], [0.0, 0.5], [0.999_999_9, 0.5], [0.5, 0.5]] {
                let (_, counts) = disc.direction(Vec3::Y, u, Lighting::Physical);
                assert!(counts > 0.0 && counts <= 10.001, "{degrees}°: {counts}");
            }
        }
    }

    #[test]
    fn a_solid_angle_is_that_of_its_cap() {
        let of = |degrees: f32| SunDisc::of_diameter(degrees.to_radians()).unwrap();
        assert!((of(180.0).solid_angle() - TAU).abs() < 1e-6);
        assert!((of(120.0).solid_angle() - PI).abs() < 1e-6);
        // The sun's: π (θ/2)².
        let sun = of(0.53);
        let expected = PI * (0.265_f32.to_radians()).powi(2);
        assert!((sun.solid_angle() / expected - 1.0).abs() < 1e-5);
        assert!(SunDisc::of_diameter(0.0).is_none());
    }
}
