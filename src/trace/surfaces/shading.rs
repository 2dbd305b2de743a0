//! Phong's model: what of a light's arriving radiance leaves towards the viewer.
//!
//! Physical: `n·l · (kd/π + ks·(s+2)/(2π)·max(r·v,0)^s)`, Phong's lobe normalised to keep energy
//! (Lafortune, Willems 1994, "Using the modified Phong reflectance model", eq. 7).
//! Classic: `kd·max(n·l,0) + ks·max(r·v,0)^s`, as simple Phong ray tracers have it.

use super::surface::Surface;
use crate::scene::Lighting;
use crate::trace::LightPoint;
use crate::trace::math::polynomials::power;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// Radiance towards the viewer from one light point that nothing hides.
///
/// Zero in all channels where the light stands behind the surface: no shadow ray is needed then.
pub fn reflected(surface: &Surface, light: &LightPoint, lighting: Lighting) -> Vec3 {
    let l = light.direction;
    match lighting {
        Lighting::Physical if surface.specular == Vec3::ZERO => lambert(
            surface.diffuse,
            surface.normal,
            surface.geometric_normal,
            l,
            light.arriving,
        ),
        Lighting::Physical => phong(&Reflector::of(surface), l, light.arriving),
        Lighting::Classic => {
            let mut value = surface.diffuse * surface.normal.dot(l).max(0.0);
            if surface.specular != Vec3::ZERO {
                value += surface.specular * lobe(&Reflector::of(surface), l);
            }
            light.arriving * value
        }
    }
}

/// The same of a matt surface, Physical. Without a branch.
#[inline(always)]
pub(in crate::trace) fn lambert(
    diffuse: Vec3,
    normal: Vec3,
    geometric_normal: Vec3,
    l: Vec3,
    arriving: Vec3,
) -> Vec3 {
    let cosine = normal.dot(l);
    let value = arriving * (diffuse * FRAC_1_PI) * cosine;
    if faces(geometric_normal, cosine, l) {
        value
    } else {
        Vec3::ZERO
    }
}

/// Whether a surface sees a light: a smooth normal may face one that the triangle itself turns its back to.
#[inline(always)]
fn faces(geometric_normal: Vec3, cosine: f32, l: Vec3) -> bool {
    let is_behind = (cosine <= 0.0) | (geometric_normal.dot(l) <= 0.0);
    !is_behind
}

/// How a surface reflects: names as in [`Surface`].
pub(in crate::trace) struct Reflector {
    pub diffuse: Vec3,
    pub specular: Vec3,
    pub shininess: f32,
    pub normal: Vec3,
    pub geometric_normal: Vec3,
    pub to_viewer: Vec3,
}

impl Reflector {
    #[inline(always)]
    fn of(surface: &Surface) -> Self {
        Self {
            diffuse: surface.diffuse,
            specular: surface.specular,
            shininess: surface.shininess,
            normal: surface.normal,
            geometric_normal: surface.geometric_normal,
            to_viewer: surface.to_viewer,
        }
    }
}

/// The same of a surface with a highlight, Physical. Without a branch.
#[inline(always)]
pub(in crate::trace) fn phong(reflector: &Reflector, l: Vec3, arriving: Vec3) -> Vec3 {
    let s = reflector.shininess;
    let cosine = reflector.normal.dot(l);
    let highlight = reflector.specular * ((s + 2.0) / (2.0 * PI) * lobe(reflector, l));
    let value = arriving * (reflector.diffuse * FRAC_1_PI + highlight) * cosine;
    if faces(reflector.geometric_normal, cosine, l) {
        value
    } else {
        Vec3::ZERO
    }
}

/// `n·l` and `r·v`, as [`reflected`] takes them for a light along the unit vector `l`.
pub fn cosines(surface: &Surface, l: Vec3) -> [f32; 2] {
    cosines_of(surface.normal, surface.to_viewer, l)
}

#[inline(always)]
fn cosines_of(normal: Vec3, to_viewer: Vec3, l: Vec3) -> [f32; 2] {
    let n_dot_l = normal.dot(l);
    let r = 2.0 * n_dot_l * normal - l;
    [n_dot_l, r.dot(to_viewer)]
}

/// `max(r·v, 0)^s`.
#[inline(always)]
fn lobe(reflector: &Reflector, l: Vec3) -> f32 {
    let [_, r_dot_v] = cosines_of(reflector.normal, reflector.to_viewer, l);
    // Rounding leaves it above 1, by so little that only an exponent of millions shows it.
    power(r_dot_v.clamp(0.0, 1.0), reflector.shininess)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(specular: f32, shininess: f32, to_viewer: Vec3) -> Surface {
        Surface {
            diffuse: Vec3::splat(0.5),
            specular: Vec3::splat(specular),
            shininess,
            ..Surface::flat(Vec3::ZERO, Vec3::Y, to_viewer)
        }
    }

    fn light(direction: Vec3) -> LightPoint {
        LightPoint {
            direction,
            distance: 1.0,
            arriving: Vec3::ONE,
            place: [0.5; 2],
            density: 1.0,
        }
    }

    #[test]
    fn the_lobe_is_at_most_one_whatever_its_exponent() {
        for i in 0..1000 {
            let angle = i as f32 * 1e-3;
            let (sine, cosine) = angle.sin_cos();
            let [l, v] = [1.0, -1.0].map(|side| Vec3::new(side * sine, cosine, 0.0).normalize());
            for shininess in [1.0, 1e4, 1e8, f32::MAX] {
                let lobe = lobe(&Reflector::of(&surface(1.0, shininess, v)), l);
                assert!((0.0..=1.0).contains(&lobe), "{angle}, {shininess}: {lobe}");
            }
        }
    }

    #[test]
    fn a_matt_surface_reflects_kd_over_pi_times_the_cosine() {
        let l = Vec3::new(0.6, 0.8, 0.0);
        let value = reflected(&surface(0.0, 1.0, Vec3::Y), &light(l), Lighting::Physical);
        assert!((value.x - 0.5 * 0.8 / PI).abs() < 1e-7, "{value}");
        let classic = reflected(&surface(0.0, 1.0, Vec3::Y), &light(l), Lighting::Classic);
        assert!((classic.x - 0.5 * 0.8).abs() < 1e-7, "{classic}");
    }

    #[test]
    fn light_from_below_reflects_nothing() {
        let l = Vec3::new(0.6, -0.8, 0.0);
        assert_eq!(
            reflected(&surface(0.9, 5.0, Vec3::Y), &light(l), Lighting::Physical),
            Vec3::ZERO
        );
    }

    #[test]
    fn the_lobe_never_reflects_more_than_arrives() {
        // A viewer straight above a uniform hemisphere of lights: ∫ ks (s+2)/(2π) cos^s θ cos θ dω = ks.
        for shininess in [1.0_f32, 10.0, 200.0] {
            let n = 20_000;
            let mut sum = 0.0_f64;
            for i in 0..n {
                let cosine = (i as f32 + 0.5) / n as f32;
                let l = Vec3::new((1.0 - cosine * cosine).sqrt(), cosine, 0.0);
                let with = reflected(
                    &surface(1.0, shininess, Vec3::Y),
                    &light(l),
                    Lighting::Physical,
                );
                let without = reflected(
                    &surface(0.0, shininess, Vec3::Y),
                    &light(l),
                    Lighting::Physical,
                );
                sum += f64::from((with - without).x) * 2.0 * std::f64::consts::PI / f64::from(n);
            }
            assert!((sum - 1.0).abs() < 2e-3, "s = {shininess}: {sum}");
        }
    }
}
