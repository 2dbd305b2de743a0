//! Cases of lights that fill an angle, the widest and the narrowest.

use super::scenes::{central_radiance, flat, quad, world};
use super::{Effort, Outcome};
use crate::bvh::hard_cases::random::Random;
use crate::report::table::digits;
use crate::scene::{Lighting, RenderSettings};
use crate::trace::{Camera, DirectionalLight, Lights, Material, PointLight, SpotCone, SunDisc};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// What a floor of kd = 0.8 sends up under a sun of 1 W/m² that stands so many degrees from its normal, as a
/// multiple of kd/π.
fn sun_on_floor(diameter: f32, tilt: f32, spp: u32) -> f64 {
    let floor = quad(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    let mut scene = world(vec![flat(1, &floor, 0)], vec![Material::default()]);
    let (sine, cosine) = tilt.to_radians().sin_cos();
    scene.lights = Arc::new(Lights {
        directionals: vec![DirectionalLight {
            id: 9,
            to_light: Vec3::new(0.6 * sine, cosine, 0.8 * sine),
            color: Vec3::ONE,
            disc: SunDisc::of_diameter(diameter.to_radians()),
            samples: 1,
        }],
        ..Lights::default()
    });
    let camera = Camera::looking_at(Vec3::new(0.3, 1.0, 0.2), Vec3::ZERO, Vec3::Z, 0.5);
    let settings = RenderSettings {
        spp,
        ..RenderSettings::default()
    };
    let radiance = central_radiance(&scene, &camera, &settings).0.x;
    f64::from(radiance) * PI / 0.8
}

pub(super) fn suns(_: &Effort) -> Outcome {
    // Integrands without a jump: 4,096 points integrate them to some 1e-4.
    let spp = 4096;
    let (mut worst, mut tilted, mut count) = (0.0_f64, 0.0_f64, 0);
    for diameter in [0.0_f32, 1e-4, 0.53, 10.0, 45.0, 90.0, 135.0, 160.0, 180.0] {
        worst = worst.max((sun_on_floor(diameter, 0.0, spp) - 1.0).abs());
        // All of the disc above the horizon: the cosine of its middle, since the radiance is symmetric about that.
        let tilt = 0.9 * (90.0 - 0.5 * diameter);
        let expected = f64::from(tilt).to_radians().cos();
        tilted = tilted.max((sun_on_floor(diameter, tilt, spp) / expected - 1.0).abs());
        count += 2;
    }
    // Half of the sky on a slope: (1 + cos) / 2 of it is above.
    for tilt in [30.0_f32, 60.0, 90.0] {
        let expected = 0.5 * (1.0 + f64::from(tilt).to_radians().cos());
        tilted = tilted.max((sun_on_floor(180.0, tilt, spp) / expected - 1.0).abs());
        count += 1;
    }
    Outcome::new(
        count * spp as usize,
        format!(
            "off by at most {} facing, {} on slopes",
            digits(worst, 2),
            digits(tilted, 2)
        ),
    )
    .require(
        worst < 1e-3,
        format!("a facing floor is off by {worst:.2e}"),
    )
    .require(tilted < 3e-3, format!("a slope is off by {tilted:.2e}"))
}

/// The area that a spot with a hard edge lights of the plane y = 0, which it meets at the origin from 3 m away, over
/// the area of the ellipse in which the plane cuts the cone. Angles in degrees, `tilt` between the axis and the plane's
/// normal; `n` × `n` places are asked, one in each cell of a grid around the ellipse.
fn lit_area(half_angle: f32, tilt: f32, n: usize, random: &mut Random) -> f64 {
    let (sine, cosine) = tilt.to_radians().sin_cos();
    let way = random.between(0.0, std::f32::consts::TAU);
    let along = Vec3::new(way.cos(), 0.0, way.sin());
    let position = 3.0 * (cosine * Vec3::Y - sine * along);
    let angle = half_angle.to_radians();
    let light = PointLight {
        id: 9,
        position,
        color: Vec3::ONE,
        cone: Some(SpotCone::new(-position.normalize(), angle, angle)),
    };
    // With D = cos² α - sin² β: half axes h sin α cos α / D along the tilt, h sin α / √D across.
    let (alpha, beta) = (f64::from(angle), f64::from(tilt).to_radians());
    let height = f64::from(position.y);
    let d = alpha.cos().powi(2) - beta.sin().powi(2);
    let half = [alpha.cos() / d, 1.0 / d.sqrt()].map(|part| height * alpha.sin() * part);
    // Its middle: between the two ends along the tilt.
    let middle = height * (beta.sin() * beta.cos() / d - beta.tan());
    let (along, across) = (along.as_dvec3(), along.cross(Vec3::Y).as_dvec3());
    let mut lit = 0;
    for i in 0..n * n {
        let cell = [i % n, i / n].map(|i| (i as f64 + f64::from(random.unit())) / n as f64);
        // Twice as wide as the ellipse, so that what is lit beside it counts.
        let [x, y] = [0, 1].map(|axis| 2.0 * half[axis] * (2.0 * cell[axis] - 1.0));
        let at: DVec3 = along * (middle + x) + across * y;
        let reaches = light.point(at.as_vec3(), Lighting::Physical).is_some();
        lit += usize::from(reaches);
    }
    let box_area = 16.0 * half[0] * half[1];
    lit as f64 / (n * n) as f64 * box_area / (PI * half[0] * half[1])
}

pub(super) fn spots(effort: &Effort) -> Outcome {
    let mut random = Random::new(effort.seed + 43);
    let n = effort.rays.isqrt().clamp(300, 1000);
    let (mut worst, mut count, mut figures) = (0.0_f64, 0, Vec::new());
    // Half of the angle that it is wide.
    for half_angle in [0.005_f32, 0.05, 0.5, 2.5, 20.0, 40.0] {
        let mut off = 0.0_f64;
        for tilt in [0.0, 17.0, 43.0] {
            let area = lit_area(half_angle, tilt, n, &mut random);
            off = off.max((area - 1.0).abs());
            count += n * n;
        }
        worst = worst.max(off);
        figures.push(format!(
            "{}°: {}",
            digits(2.0 * f64::from(half_angle), 2),
            digits(off, 2)
        ));
    }
    Outcome::new(
        count,
        format!("lit area off by at most {}", figures.join(", ")),
    )
    .require(worst < 0.01, format!("a lit area is off by {worst:.2e}"))
}
