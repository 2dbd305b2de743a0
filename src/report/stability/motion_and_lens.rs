//! Cases of the camera, and of settings that cannot be.

use super::scenes::{central_radiance, flat, quad, world};
use super::{Effort, Outcome};
use crate::film::render;
use crate::report::table::digits;
use crate::scene::{RenderSettings, range_problems};
use crate::trace::{Camera, Environment, Material, Optics, World};
use glam::{UVec2, Vec2, Vec3};

/// A dark square of edge 1, its left edge at `left`, moving by `velocity`, before a background of 1.
fn square(left: f32, velocity: Vec3) -> World {
    let corners = quad(Vec3::new(left, -0.5, 0.0), Vec3::X, Vec3::Y);
    let (instance, mut object) = flat(1, &corners, 0);
    object.motion_samples = u32::from(velocity != Vec3::ZERO);
    let dark = Material {
        diffuse: Vec3::ZERO,
        ..Material::default()
    };
    let moving = instance.moving(velocity).expect("a finite velocity");
    let mut world = world(vec![(moving, object)], vec![dark]);
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    world
}

fn camera_at(x: f32) -> Camera {
    Camera::looking_at(Vec3::new(x, 0.0, 3.0), Vec3::new(x, 0.0, 0.0), Vec3::Y, 0.6)
}

pub(super) fn motion(_: &Effort) -> Outcome {
    // At speed 4 it stands over x while x - 1 < 4t < x: a trapezoid in x.
    let scene = square(0.0, Vec3::X * 4.0);
    let (mut worst, mut samples) = (0.0_f32, 0);
    for spp in [16_u32, 64, 256] {
        let settings = RenderSettings {
            spp,
            ..RenderSettings::default()
        };
        for i in 0..60 {
            let x = -0.4 + 0.1 * i as f32 + 0.013;
            let bright = central_radiance(&scene, &camera_at(x), &settings).0.x;
            let (enters, leaves) = ((x - 1.0) / 4.0, x / 4.0);
            let covered = leaves.clamp(0.0, 1.0) - enters.clamp(0.0, 1.0);
            worst = worst.max((1.0 - bright - covered).abs() * spp as f32);
            samples += spp as usize;
        }
    }
    let settings = RenderSettings {
        size: UVec2::splat(40),
        spp: 4,
        ..RenderSettings::default()
    };
    let mut differ = 0;
    for time in [0.0_f32, 0.25, 1.0] {
        let mut camera = camera_at(0.7);
        camera.optics.shutter = [time, time];
        let moving = render(&scene, &camera, &settings, &|_, _| {}).picture;
        // 4 · time is exact, so the still square stands at the very same place.
        let still = render(
            &square(4.0 * time, Vec3::ZERO),
            &camera_at(0.7),
            &settings,
            &|_, _| {},
        );
        let pixels = moving.pixels.iter().zip(&still.picture.pixels);
        differ += pixels.filter(|(a, b)| a != b).count();
    }
    Outcome::new(
        samples,
        format!(
            "coverage off by at most {}/spp; closed shutter: {differ} pixels differ",
            digits(f64::from(worst), 2)
        ),
    )
    .require(
        worst <= 2.0 + 1e-3,
        format!("coverage is off by {worst}/spp"),
    )
    .require(
        differ == 0,
        format!("{differ} pixels differ with a closed shutter"),
    )
}

pub(super) fn lens(_: &Effort) -> Outcome {
    let size = UVec2::new(640, 480);
    let with = |aperture_radius, focus_distance| Camera {
        optics: Optics {
            aperture_radius,
            focus_distance,
            ..Optics::default()
        },
        ..Camera::looking_at(
            Vec3::new(1.0, 2.0, 3.0),
            Vec3::new(0.0, 1.0, -4.0),
            Vec3::Y,
            0.9,
        )
    };
    let (pinhole, closed, far) = (with(0.0, 1.0), with(0.0, 5.0), with(0.2, f32::INFINITY));
    let (mut differ, mut bent, mut rays) = (0, 0, 0);
    for i in 0..100_u32 {
        let place = Vec2::new((i * 37 % 640) as f32 + 0.3, (i * 91 % 480) as f32 + 0.7);
        for lens in [[0.0, 0.0], [0.9, 0.1], [0.4, 0.99], [0.5, 0.5]] {
            let (a, b) = (
                pinhole.ray(place, size, [0.3, 0.9], 0.0),
                closed.ray(place, size, lens, 0.0),
            );
            differ += usize::from(a != b);
            bent += usize::from(far.ray(place, size, lens, 0.0).direction != a.direction);
            rays += 1;
        }
    }
    Outcome::new(
        rays,
        format!("aperture 0: {differ} rays differ; focus at infinity: {bent} not parallel"),
    )
    .require(
        differ == 0,
        format!("{differ} rays of an aperture of 0 differ"),
    )
    .require(bent == 0, format!("{bent} rays are not parallel"))
}

/// A setting, how it is set, and whether 0, 1 and 2^31 work.
type Change = (&'static str, fn(&mut RenderSettings, u32), [bool; 3]);

pub(super) fn limits(_: &Effort) -> Outcome {
    let with = |change: fn(&mut RenderSettings, u32), value: u32| {
        let mut settings = RenderSettings {
            size: UVec2::splat(8),
            spp: 1,
            ..RenderSettings::default()
        };
        change(&mut settings, value);
        settings
    };
    let changes: [Change; 3] = [
        ("spp", |s, value| s.spp = value, [false, true, false]),
        (
            "max_depth",
            |s, value| s.max_depth = value,
            [true, true, false],
        ),
        (
            "size",
            |s, value| s.size = UVec2::new(value, 2),
            [false, true, false],
        ),
    ];
    let mut outcome = Outcome::new(0, "");
    let mut errors = Vec::new();
    for (name, change, works) in changes {
        for (value, works) in [0, 1, 1 << 31].into_iter().zip(works) {
            let settings = with(change, value);
            let problems = range_problems(&settings);
            outcome.counted += 1;
            if problems.is_empty() != works {
                outcome
                    .faults
                    .push(format!("{name} = {value}: {problems:?}"));
            } else if works {
                let picture = render(
                    &square(0.0, Vec3::ZERO),
                    &camera_at(0.3),
                    &settings,
                    &|_, _| {},
                );
                let fine = picture.picture.pixels.iter().all(|pixel| pixel.is_finite());
                outcome = outcome.require(fine, format!("{name} = {value} gives no picture"));
            } else {
                errors.extend(problems.first().map(ToString::to_string));
            }
        }
    }
    outcome.figures = format!(
        "{} refused, {} rendered: “{}”",
        errors.len(),
        outcome.counted as usize - errors.len(),
        errors.join("”, “")
    );
    outcome
}
