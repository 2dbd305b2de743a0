//! A small matt patch with kd = 1 under one light: its radiance is E/π.

use super::*;
use glam::DVec3;
use glassbox::scene::Lighting;
use glassbox::trace::{DirectionalLight, Lights, ParallelogramLight, PointLight, SegmentLight};

/// A patch at the origin with normal `n`, seen from a little above it.
fn irradiance(n: Vec3, lights: Lights, spp: u32) -> f64 {
    let (a, b) = n.any_orthonormal_pair();
    let corners = quad(-0.01 * a - 0.01 * b, 0.02 * a, 0.02 * b);
    let material = Material {
        diffuse: Vec3::ONE,
        ..Material::default()
    };
    let mut world = world(vec![object(1, &corners, 0)], vec![material]);
    world.lights = Arc::new(lights);
    let camera = Camera::looking_at(0.005 * n + 0.001 * a, 0.001 * a, b, 0.5);
    let settings = RenderSettings {
        spp,
        ..RenderSettings::default()
    };
    let (radiance, _) = central_radiance(&world, &camera, &settings);
    f64::from(radiance.x) * std::f64::consts::PI
}

/// Where that camera's central ray meets the patch.
fn place(n: Vec3) -> DVec3 {
    (0.001 * n.any_orthonormal_pair().0).as_dvec3()
}

/// Lambert's formula for a polygon of constant radiance 1, clipped at the horizon (Lambert 1760;
/// Arvo 1995, "Applications of Irradiance Tensors", eq. 5).
fn polygon_irradiance(at: DVec3, n: DVec3, polygon: &[DVec3]) -> f64 {
    let mut clipped = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (hp, hq) = ((p - at).dot(n), (q - at).dot(n));
        if hp > 0.0 {
            clipped.push(p - at);
        }
        if hp * hq < 0.0 {
            clipped.push(p - at + (q - p) * (hp / (hp - hq)));
        }
    }
    let mut sum = 0.0;
    for (i, &p) in clipped.iter().enumerate() {
        let q = clipped[(i + 1) % clipped.len()];
        sum += p.angle_between(q) * p.cross(q).normalize_or_zero().dot(n);
    }
    (0.5 * sum).abs()
}

/// ∫ n·(a + x d)/|a + x d|³ dx over the part of x in [0, length] above the horizon; a, d from the
/// patch, d of unit length. The antiderivative of (A + B x)/(x² + 2 p x + q)^(3/2) is
/// (A (x + p) − B (p x + q)) / ((q − p²) √(x² + 2 p x + q)).
fn segment_irradiance(at: DVec3, n: DVec3, ends: [DVec3; 2]) -> f64 {
    let (a, length) = (ends[0] - at, (ends[1] - ends[0]).length());
    let d = (ends[1] - ends[0]) / length;
    let (constant, slope) = (a.dot(n), d.dot(n));
    let (mut from, mut to) = (0.0, length);
    if slope != 0.0 {
        let crossing = (-constant / slope).clamp(0.0, length);
        if slope > 0.0 {
            from = crossing
        } else {
            to = crossing
        }
    } else if constant <= 0.0 {
        return 0.0;
    }
    let (p, q) = (a.dot(d), a.length_squared());
    let antiderivative = |x: f64| {
        (constant * (x + p) - slope * (p * x + q))
            / ((q - p * p) * (x * x + 2.0 * p * x + q).sqrt())
    };
    (antiderivative(to) - antiderivative(from)).max(0.0)
}

#[test]
fn irradiance_under_a_parallelogram_light_is_lamberts_polygon_formula() {
    let mut numbers = Numbers(1);
    let (mut done, mut worst) = (0, 0.0_f64);
    while done < 100 {
        let n = numbers.direction();
        let corner = numbers.point(-3.0, 3.0);
        let edges = [numbers.point(-1.5, 1.5), numbers.point(-1.5, 1.5)];
        let light = ParallelogramLight {
            id: 7,
            corner,
            edges,
            colors: [Vec3::ONE; 4],
            two_sided: true,
            visible: false,
            samples: 1,
        };
        let at = place(n);
        let [a, b] = edges.map(Vec3::as_dvec3);
        let c = corner.as_dvec3();
        let expected = polygon_irradiance(at, n.as_dvec3(), &[c, c + a, c + a + b, c + b]);
        // Not in contact: nothing of the light nearer than its own size, so that the integrand is
        // one that 4,096 points can integrate; and something of it above the horizon.
        let size = edges[0].length().max(edges[1].length());
        let nearest = (0..=400)
            .map(|i| c + a * f64::from(i % 20 + i / 400) / 20.0 + b * f64::from(i / 20) / 20.0)
            .map(|p| (p - at).length())
            .fold(f64::INFINITY, f64::min);
        if nearest < f64::from(size) || expected < 1e-2 || size < 0.2 {
            continue;
        }
        let measured = irradiance(
            n,
            Lights {
                parallelograms: vec![light],
                ..Lights::default()
            },
            4096,
        );
        worst = worst.max((measured / expected - 1.0).abs());
        done += 1;
    }
    assert!(worst < 0.005, "worst relative error {worst:.5}");
}

#[test]
fn irradiance_under_a_segment_light_is_its_closed_form() {
    let mut numbers = Numbers(2);
    let (mut done, mut worst) = (0, 0.0_f64);
    while done < 100 {
        let n = numbers.direction();
        let ends = [numbers.point(-3.0, 3.0), numbers.point(-3.0, 3.0)];
        let at = place(n);
        let ends64 = ends.map(Vec3::as_dvec3);
        let expected = segment_irradiance(at, n.as_dvec3(), ends64);
        let along = ends64[1] - ends64[0];
        let nearest = (0..=100)
            .map(|i| (ends64[0] + along * f64::from(i) / 100.0 - at).length())
            .fold(f64::INFINITY, f64::min);
        if nearest < 0.3 * along.length() || expected < 1e-3 {
            continue;
        }
        let measured = irradiance(
            n,
            Lights {
                segments: vec![SegmentLight {
                    id: 7,
                    ends,
                    colors: [Vec3::ONE; 2],
                    samples: 1,
                }],
                ..Lights::default()
            },
            4096,
        );
        worst = worst.max((measured / expected - 1.0).abs());
        done += 1;
    }
    assert!(worst < 0.005, "worst relative error {worst:.5}");
}

#[test]
fn a_point_light_and_a_directional_one_give_their_irradiance_exactly() {
    let mut numbers = Numbers(3);
    let mut worst = 0.0_f64;
    for _ in 0..100 {
        let n = numbers.direction();
        let position = numbers.point(-3.0, 3.0);
        let offset = position.as_dvec3() - place(n);
        let expected = offset.dot(n.as_dvec3()) / offset.length().powi(3);
        if expected < 1e-3 {
            continue;
        }
        let point = PointLight {
            id: 1,
            position,
            color: Vec3::ONE,
            cone: None,
        };
        let measured = irradiance(
            n,
            Lights {
                points: vec![point],
                ..Lights::default()
            },
            1,
        );
        worst = worst.max((measured / expected - 1.0).abs());
        let to_light = position.normalize();
        let expected = to_light.as_dvec3().dot(n.as_dvec3());
        let measured = irradiance(
            n,
            Lights {
                directionals: vec![DirectionalLight {
                    id: 1,
                    to_light,
                    color: Vec3::ONE,
                    disc: None,
                    samples: 1,
                }],
                ..Lights::default()
            },
            1,
        );
        worst = worst.max((measured / expected - 1.0).abs());
    }
    // A dozen f32 operations on values that may be nearly at grazing angles.
    assert!(worst < 1e-4, "worst relative error {worst:e}");
}

#[test]
fn a_light_in_the_receivers_plane_gives_nothing() {
    for n in [Vec3::Y, Vec3::X] {
        let (a, _) = n.any_orthonormal_pair();
        let measured = irradiance(
            n,
            Lights {
                points: vec![PointLight {
                    id: 1,
                    position: 2.0 * a,
                    color: Vec3::ONE,
                    cone: None,
                }],
                ..Lights::default()
            },
            1,
        );
        assert_eq!(measured, 0.0);
    }
}

#[test]
fn classic_lighting_averages_lights_and_does_not_attenuate() {
    let n = Vec3::Y;
    let light = |id, y: f32| PointLight {
        id,
        position: Vec3::Y * y,
        color: Vec3::ONE,
        cone: None,
    };
    let corners = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let material = Material {
        diffuse: Vec3::splat(0.5),
        ..Material::default()
    };
    let mut world = world(vec![object(1, &corners, 0)], vec![material]);
    world.lights = Arc::new(Lights {
        points: vec![light(1, 3.0), light(2, 300.0)],
        ..Lights::default()
    });
    let camera = Camera::looking_at(n, Vec3::ZERO, Vec3::X, 0.5);
    let settings = RenderSettings {
        lighting: Lighting::Classic,
        spp: 1,
        ..RenderSettings::default()
    };
    let (radiance, counts) = central_radiance(&world, &camera, &settings);
    assert!((radiance.x - 0.5).abs() < 1e-6, "{radiance}");
    assert_eq!((counts.camera, counts.shadow), (1, 2));
}
