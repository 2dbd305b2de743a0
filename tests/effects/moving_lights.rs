//! Lights that move while the shutter is open, against closed forms and against scenes that move instead.

use crate::analytic::{central_radiance, object, quad, world};
use glam::{UVec2, Vec3};
use glassbox::film::render;
use glassbox::scene::{Features, RenderSettings};
use glassbox::trace::{
    Camera, Lights, Material, MovingLight, ParallelogramLight, PointLight, Samples, SegmentLight,
    SpotCone, World, probe,
};
use std::f32::consts::PI;
use std::sync::Arc;

const LIGHT: u64 = 9;

/// A light of each kind, all of them with this number.
fn kinds() -> [(&'static str, Lights); 4] {
    let point = |cone| PointLight {
        id: LIGHT,
        position: Vec3::new(0.25, 1.0, -0.5),
        color: Vec3::new(3.0, 2.0, 1.0),
        cone,
    };
    let cone = SpotCone::new(Vec3::NEG_Y, 0.8, 1.0);
    let segment = SegmentLight {
        id: LIGHT,
        ends: [Vec3::new(-0.5, 1.0, 0.0), Vec3::new(0.5, 1.5, 0.0)],
        colors: [Vec3::X, Vec3::Y],
        samples: 1,
    };
    let parallelogram = ParallelogramLight {
        id: LIGHT,
        corner: Vec3::new(-0.5, 1.0, -0.5),
        edges: [Vec3::X, Vec3::Z],
        colors: [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE],
        two_sided: true,
        visible: true,
        samples: 2,
    };
    let none = Lights::default;
    [
        (
            "point",
            Lights {
                points: vec![point(None)],
                ..none()
            },
        ),
        (
            "spot",
            Lights {
                points: vec![point(Some(cone))],
                ..none()
            },
        ),
        (
            "segment",
            Lights {
                segments: vec![segment],
                ..none()
            },
        ),
        (
            "parallelogram",
            Lights {
                parallelograms: vec![parallelogram],
                ..none()
            },
        ),
    ]
}

fn moving(lights: &Lights, velocity: Vec3) -> Arc<Lights> {
    let moving = MovingLight {
        id: LIGHT,
        velocity,
        samples: 1,
    };
    Arc::new(Lights {
        moving: vec![moving],
        ..lights.clone()
    })
}

/// The same lights elsewhere.
fn moved(lights: &Lights, by: Vec3) -> Arc<Lights> {
    let mut lights = lights.clone();
    lights.points.iter_mut().for_each(|l| l.position += by);
    lights
        .segments
        .iter_mut()
        .for_each(|l| l.ends = l.ends.map(|end| end + by));
    lights
        .parallelograms
        .iter_mut()
        .for_each(|l| l.corner += by);
    Arc::new(lights)
}

/// A floor in y = 0 in which all is mirrored, and a plate above it that throws a shadow; both move by `velocity`.
fn floor(velocity: Vec3) -> World {
    let ground = quad(Vec3::new(-4.0, 0.0, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0);
    let shade = quad(Vec3::new(0.0, 0.4, -0.3), Vec3::Z * 0.5, Vec3::X * 0.5);
    let objects = [(1, ground), (2, shade)].map(|(id, corners)| {
        let (instance, mut object) = object(id, &corners, 0);
        object.motion_samples = u32::from(velocity != Vec3::ZERO);
        (instance.moving(velocity).unwrap(), object)
    });
    let polished = Material {
        diffuse: Vec3::ONE,
        specular: Vec3::splat(0.3),
        mirror: Vec3::splat(0.3),
        shininess: 20.0,
        ..Material::default()
    };
    world(objects.into(), vec![polished])
}

fn lit(mut world: World, lights: Arc<Lights>) -> World {
    world.lights = lights;
    world.with_needs()
}

fn above() -> Camera {
    Camera::looking_at(Vec3::new(0.0, 2.5, 3.0), Vec3::Y * 0.5, Vec3::Y, 0.9)
}

fn settings(spp: u32) -> RenderSettings {
    RenderSettings {
        size: UVec2::new(40, 30),
        spp,
        ..RenderSettings::default()
    }
}

/// How many of two worlds' pixels differ by more than rounding, and how many are lit at all.
fn differing(a: (&World, &Camera), b: (&World, &Camera), settings: &RenderSettings) -> [usize; 2] {
    let [a, b] = [a, b].map(|(world, camera)| render(world, camera, settings, &|_, _| {}).picture);
    let pairs = a.pixels.iter().zip(&b.pixels);
    let differ = pairs
        .filter(|(a, b)| (**a - **b).abs().max_element() > 1e-4 * a.abs().max_element().max(1e-3));
    let lit = b.pixels.iter().filter(|value| value.max_element() > 0.0);
    [differ.count(), lit.count()]
}

#[test]
fn with_a_closed_shutter_every_light_stands_where_it_is_then() {
    let velocity = Vec3::new(1.0, 0.25, -0.5);
    for (kind, lights) in kinds() {
        for time in [0.0_f32, 0.5, 1.0] {
            let mut camera = above();
            camera.optics.shutter = [time; 2];
            let there = lit(floor(Vec3::ZERO), moved(&lights, time * velocity));
            let moves = lit(floor(Vec3::ZERO), moving(&lights, velocity));
            let [differ, lit] = differing((&moves, &camera), (&there, &camera), &settings(4));
            // A shadow's or a light's edge may pass a sample by rounding: 1 of 4 in a pixel.
            assert!(
                differ <= 3 && lit > 200,
                "{kind} at {time}: {differ} pixels differ, {lit} are lit"
            );
        }
    }
}

#[test]
fn a_moving_light_lights_as_a_still_one_does_where_all_else_moves_the_other_way() {
    let velocity = Vec3::new(0.5, 0.25, -0.5);
    for (kind, lights) in kinds() {
        let moves = lit(floor(Vec3::ZERO), moving(&lights, velocity));
        let stands = lit(floor(-velocity), Arc::new(lights));
        let mut camera = above();
        camera.optics.velocity = -velocity;
        camera.optics.motion_samples = 1;
        let [differ, lit] = differing((&moves, &above()), (&stands, &camera), &settings(16));
        assert!(
            differ <= 6 && lit > 200,
            "{kind}: {differ} pixels differ, {lit} are lit"
        );
    }
}

#[test]
fn a_lamp_that_flies_past_gives_a_floor_the_mean_of_its_way() {
    // Over x, from height h, at speed v: E = I h / (h² + (x - v t)²)^(3/2), and the mean over t in [0, 1]
    // is (F(x) - F(x - v)) / (v h) with F(s) = s / sqrt(h² + s²).
    let (h, v) = (0.5, 4.0);
    let light = PointLight {
        id: LIGHT,
        position: Vec3::Y * h,
        color: Vec3::ONE,
        cone: None,
    };
    let lights = Lights {
        points: vec![light],
        ..Lights::default()
    };
    let ground = quad(Vec3::new(-9.0, 0.0, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
    let white = Material {
        diffuse: Vec3::ONE,
        ..Material::default()
    };
    let scene = lit(
        world(vec![object(1, &ground, 0)], vec![white]),
        moving(&lights, Vec3::X * v),
    );
    for i in 0..24 {
        let x = -1.0 + 0.25 * i as f32;
        let camera = Camera::looking_at(Vec3::new(x, 3.0, 0.0), Vec3::X * x, Vec3::Z, 0.1);
        let found = central_radiance(&scene, &camera, &settings(1024)).0.x;
        let way = |s: f32| s / (h * h + s * s).sqrt();
        let expected = (way(x) - way(x - v)) / (v * h) / PI;
        // One sample in each 1024th of the time: off by less than the function's way up and down again, 2 · its
        // peak of 1 / (h² π), over 1024.
        let bound = 2.0 / (h * h * PI) / 1024.0;
        assert!(
            (found - expected).abs() < bound,
            "x = {x}: {found} instead of {expected} ± {bound}"
        );
    }
}

#[test]
fn a_visible_light_that_crosses_the_view_covers_a_place_for_the_time_that_it_is_there() {
    let light = ParallelogramLight {
        id: LIGHT,
        corner: Vec3::new(0.0, -0.5, 0.0),
        edges: [Vec3::X, Vec3::Y],
        colors: [Vec3::ONE; 4],
        two_sided: true,
        visible: true,
        samples: 1,
    };
    let lights = Lights {
        parallelograms: vec![light],
        ..Lights::default()
    };
    let scene = lit(World::default(), moving(&lights, Vec3::X * 4.0));
    for spp in [16_u32, 64, 256] {
        let bound = 2.0 / spp as f32 + 1e-6;
        for i in 0..60 {
            let x = -0.4 + 0.1 * i as f32 + 0.013;
            // At speed 4 it stands over x while x - 1 < 4t < x: a trapezoid in x.
            let covered = (x / 4.0).clamp(0.0, 1.0) - ((x - 1.0) / 4.0).clamp(0.0, 1.0);
            let camera =
                Camera::looking_at(Vec3::new(x, 0.0, 3.0), Vec3::new(x, 0.0, 0.0), Vec3::Y, 0.6);
            let bright = central_radiance(&scene, &camera, &settings(spp)).0.y;
            let error = (bright - covered).abs();
            assert!(
                error <= bound,
                "x = {x}, {spp} samples: off by {error}, bound {bound}"
            );
        }
    }
}

#[test]
fn with_motion_off_every_light_stands_where_it_is_at_time_zero() {
    let settings = RenderSettings {
        features: Features {
            motion: false,
            ..Features::default()
        },
        ..settings(4)
    };
    for (kind, lights) in kinds() {
        let moves = lit(floor(Vec3::ZERO), moving(&lights, Vec3::ONE));
        let stands = lit(floor(Vec3::ZERO), Arc::new(lights));
        let picture = |world| render(world, &above(), &settings, &|_, _| {}).picture;
        assert_eq!(picture(&moves), picture(&stands), "{kind}");
    }
}

#[test]
fn a_probed_ray_ends_where_its_light_stands_at_the_ray_s_time() {
    let velocity = Vec3::new(1.0, 0.25, -0.5);
    for (kind, lights) in kinds() {
        let scene = lit(floor(Vec3::ZERO), moving(&lights, velocity));
        let tree = probe(
            &scene,
            &above(),
            &settings(8),
            UVec2::new(20, 20),
            &Samples::All,
        );
        let mut checked = 0;
        for ray in &tree.unwrap().rays {
            let Some(light) = ray.light.filter(|_| ray.end.is_traced()) else {
                continue;
            };
            let [u, v] = light.place;
            let place = match kind {
                "segment" => lights.segments[0].ends[0].lerp(lights.segments[0].ends[1], u),
                "parallelogram" => {
                    let light = &lights.parallelograms[0];
                    light.corner + u * light.edges[0] + v * light.edges[1]
                }
                _ => lights.points[0].position,
            };
            let expected = place + ray.time * velocity;
            let found = ray.at(1.0);
            assert!(
                (found - expected).length() < 1e-4,
                "{kind} at {}: {found} instead of {expected}",
                ray.time
            );
            checked += usize::from(ray.time > 0.1);
        }
        assert!(checked > 2, "{kind}: {checked} rays");
    }
}

#[test]
fn the_samples_that_a_moving_light_asks_for_are_taken() {
    for (kind, lights) in kinds() {
        let mut moves = Lights::clone(&moving(&lights, Vec3::X));
        moves.moving[0].samples = 12;
        let scene = lit(floor(Vec3::ZERO), Arc::new(moves));
        assert_eq!(scene.needs.motion_samples, 12, "{kind}");
        let still = lit(floor(Vec3::ZERO), Arc::new(lights));
        assert_eq!(still.needs.motion_samples, 0, "{kind}");
    }
}
