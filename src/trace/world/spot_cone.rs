//! Where a spot shines, and how it fades.
//!
//! Angles to the axis are compared by their versine, `1 - cos`. Of a unit vector d it is `|d - axis|² / 2`, which
//! keeps its digits however small the angle is; a cosine near 1 has none left in f32: below 0.01° there are three of
//! them.

use glam::Vec3;

/// Full strength within an angle of `axis`, none outside another one, a smoothstep of the cosine between.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SpotCone {
    /// Unit vector along which the spot shines.
    pub axis: Vec3,
    /// `1 - cos` of the half-angle within which it has its full strength.
    pub versine_inner: f32,
    /// `1 - cos` of the half-angle outside of which there is nothing, at least `versine_inner`.
    pub versine_outer: f32,
}

impl SpotCone {
    /// A cone about the unit vector `axis`, of half-angles in radians: 0 ≤ `inner` ≤ `outer` ≤ π/2.
    pub fn new(axis: Vec3, inner: f32, outer: f32) -> Self {
        let versine = |angle: f32| 2.0 * (0.5 * angle).sin().powi(2);
        Self {
            axis,
            versine_inner: versine(inner),
            versine_outer: versine(outer),
        }
    }

    /// In [0, 1]: the share of the light that leaves along the unit vector `leaving`.
    pub(super) fn fall_off(&self, leaving: Vec3) -> f32 {
        let versine = 0.5 * (leaving - self.axis).length_squared();
        if versine <= self.versine_inner {
            return 1.0;
        }
        let width = self.versine_outer - self.versine_inner;
        let x = ((self.versine_outer - versine) / width).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    #[test]
    fn a_spot_is_full_inside_none_outside_and_falls_without_a_step() {
        let cone = SpotCone::new(Vec3::NEG_Y, 0.3, 0.5);
        let at = |angle: f32| cone.fall_off(Vec3::new(angle.sin(), -angle.cos(), 0.0));
        assert_eq!((at(0.0), at(0.29), at(0.51), at(3.0)), (1.0, 1.0, 0.0, 0.0));
        let mut last = 1.0;
        for i in 0..=1000 {
            let value = at(0.25 + 0.3 * i as f32 / 1000.0);
            assert!(
                value <= last && last - value < 0.01,
                "step of {}",
                last - value
            );
            last = value;
        }
    }

    #[test]
    fn a_spot_fades_as_a_smoothstep_of_the_cosine_however_narrow_it_is() {
        for outer in [8.7e-5_f32, 1e-3, 0.05, 0.5, FRAC_PI_2] {
            let inner = 0.5 * outer;
            let cone = SpotCone::new(Vec3::NEG_Y, inner, outer);
            let mut worst = 0.0_f64;
            for i in 0..=100 {
                let angle = f64::from(outer) * (0.45 + 0.6 * f64::from(i) / 100.0);
                let leaving = glam::DVec3::new(angle.sin(), -angle.cos(), 0.0);
                // 1 - cos without cancellation, in f64.
                let versine = |angle: f64| 2.0 * (0.5 * angle).sin().powi(2);
                let [inner, outer] = [inner, outer].map(|angle| versine(f64::from(angle)));
                let x = ((outer - versine(angle)) / (outer - inner)).clamp(0.0, 1.0);
                let expected = x * x * (3.0 - 2.0 * x);
                let found = f64::from(cone.fall_off(leaving.as_vec3()));
                worst = worst.max((found - expected).abs());
            }
            // A smoothstep rises by at most 3/2 of what x does, x is good to ten roundings.
            assert!(worst < 2e-6, "half-angle {outer}: off by {worst:e}");
        }
    }

    #[test]
    fn a_cone_with_a_hard_edge_or_of_no_angle_gives_numbers() {
        for angle in [0.0, 1e-30, 0.3, FRAC_PI_2] {
            let cone = SpotCone::new(Vec3::X, angle, angle);
            for leaving in [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::new(0.6, 0.8, 0.0)] {
                let share = cone.fall_off(leaving);
                assert!(share == 0.0 || share == 1.0, "{angle}, {leaving}: {share}");
            }
            assert_eq!(cone.fall_off(Vec3::X), 1.0);
        }
    }
}
