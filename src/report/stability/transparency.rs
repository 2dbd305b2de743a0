//! Cases of layers and mirrors.

use super::scenes::{central_radiance, flat, once, placed, quad, world};
use super::{Effort, Outcome};
use crate::bvh::hard_cases::meshes::soup;
use crate::bvh::{Counters, Hit, MultiHit, Ray};
use crate::film::render;
use crate::report::table::digits;
use crate::scene::{Alpha, RenderSettings};
use crate::trace::{Camera, Environment, Lights, Material, ParallelogramLight, World};
use glam::{Affine3A, Quat, UVec2, Vec3};
use std::sync::Arc;

fn pane(opacity: f32) -> Material {
    Material {
        diffuse: Vec3::ONE,
        opacity,
        ..Material::default()
    }
}

/// A square across the line of sight.
fn square(z: f32) -> [Vec3; 6] {
    quad(Vec3::new(-1.0, -1.0, z), Vec3::X * 2.0, Vec3::Y * 2.0)
}

fn before_one(mut world: World) -> World {
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    world
}

pub(super) fn shared_edge(effort: &Effort) -> Outcome {
    let scene = before_one(world(vec![flat(1, &square(0.0), 0)], vec![pane(0.5)]));
    let places = (effort.rays / 1000).clamp(19, 5_000);
    let mut wrong = 0;
    for i in 0..places {
        // The diagonal of the square passes under the central ray.
        let x = -0.95 + 1.9 * i as f32 / places as f32;
        let camera = Camera::looking_at(Vec3::new(x, x, 3.0), Vec3::new(x, x, 0.0), Vec3::Y, 0.1);
        let (value, counts) = central_radiance(&scene, &camera, &once());
        wrong += usize::from((value.x, counts.transmission) != (0.5, 1));
    }
    Outcome::new(
        places,
        format!("{wrong} rays cross another number of layers than 1"),
    )
    .require(
        wrong == 0,
        format!("{wrong} rays cross another number of layers"),
    )
}

pub(super) fn layers(_: &Effort) -> Outcome {
    let opacities: Vec<f32> = (0..64).map(|i| 0.002 + 0.0005 * i as f32).collect();
    let objects = (0..64u32).map(|i| flat(u64::from(i) + 1, &square(i as f32 * 1e-3), i));
    let materials = opacities.iter().map(|&opacity| pane(opacity)).collect();
    let scene = before_one(world(objects.collect(), materials));
    let from = Vec3::new(0.1, 0.2, 5.0);
    let camera = Camera::looking_at(from, Vec3::new(0.1, 0.2, 0.0), Vec3::Y, 0.1);
    let (value, counts) = central_radiance(&scene, &camera, &once());
    let expected: f64 = opacities.iter().map(|&d| 1.0 - f64::from(d)).product();
    let error = (f64::from(value.x) / expected - 1.0).abs();
    Outcome::new(
        64,
        format!(
            "{} layers crossed, relative error {}",
            counts.transmission,
            digits(error, 2)
        ),
    )
    .require(error < 1e-5, format!("relative error {error:e}"))
    .require(
        counts.transmission == 64,
        format!("{} layers", counts.transmission),
    )
}

pub(super) fn mirrors(_: &Effort) -> Outcome {
    // The camera sits between two mirrors that also emit: after k bounces each adds ks^k · ke.
    let wall = |y| quad(Vec3::new(-9.0, y, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
    let material = Material {
        diffuse: Vec3::ZERO,
        specular: Vec3::splat(0.9),
        mirror: Vec3::splat(0.9),
        // So narrow a highlight that none is seen: only what the mirror shows counts.
        shininess: 1e6,
        emission: Vec3::ONE,
        ..Material::default()
    };
    let scene = world(
        vec![flat(1, &wall(0.0), 0), flat(2, &wall(1.0), 0)],
        vec![material],
    );
    let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO, Vec3::X, 0.1);
    let (mut worst, mut bounces, mut wrong) = (0.0_f64, 0, 0);
    for max_depth in 0..=50 {
        let settings = RenderSettings {
            max_depth,
            ..once()
        };
        let (value, counts) = central_radiance(&scene, &camera, &settings);
        let expected = (1.0 - 0.9_f64.powi(max_depth as i32 + 1)) / (1.0 - 0.9);
        worst = worst.max((f64::from(value.x) / expected - 1.0).abs());
        wrong += usize::from(counts.mirror != u64::from(max_depth));
        bounces += counts.mirror as usize;
    }
    Outcome::new(
        bounces,
        format!(
            "depths 0 to 50: relative error at most {}",
            digits(worst, 2)
        ),
    )
    .require(worst < 1e-5, format!("relative error {worst:e}"))
    .require(
        wrong == 0,
        format!("{wrong} depths with another number of bounces"),
    )
}

/// What rays through sheets visit, nodes and triangles, and how many sheets they cross.
struct Visits {
    /// Of a ray straight on, crossing by crossing.
    straight: u64,
    crossed: u32,
    /// Of a ray to a light, which asks once how much of it passes.
    to_light: u64,
    /// How much that is, where a sheet takes nothing of red, a thousandth of green and half of blue.
    passing: Vec3,
}

/// How sheets of 2 m lie on the way of a ray along z.
#[derive(Clone, Copy)]
enum Lie {
    /// Across it, 1 cm apart.
    Across,
    /// Slanted, on 1 m: the boxes around all of them overlap.
    Slanted,
    /// On 1 m, each turned another way.
    Turned,
    /// All in one place.
    Together,
}

impl Lie {
    fn sheet(self, i: u32, count: u32) -> [Vec3; 6] {
        let on_1_m = i as f32 / count as f32;
        let (turn, z) = match self {
            Self::Across => ([0.0; 2], 0.01 * i as f32),
            Self::Slanted => ([0.8, 0.7], on_1_m),
            Self::Turned => ([(1.1 * i as f32).sin(), (1.7 * i as f32).cos()], on_1_m),
            Self::Together => ([0.0; 2], 0.0),
        };
        let turn = Quat::from_rotation_x(turn[0]) * Quat::from_rotation_y(turn[1]);
        square(0.0).map(|p| turn * p + z * Vec3::Z)
    }
}

/// Through `count` sheets: of one mesh, or an object each.
fn visits(count: u32, lie: Lie, one_mesh: bool) -> Visits {
    let triangles = |corners: [Vec3; 6]| {
        let [a, b, c, d, e, f] = corners;
        [[a, b, c], [d, e, f]]
    };
    let objects = if one_mesh {
        let all = (0..count).flat_map(|i| triangles(lie.sheet(i, count)));
        vec![placed(1, soup(all), Vec::new(), &Affine3A::IDENTITY, 0)]
    } else {
        (0..count)
            .map(|i| flat(u64::from(i) + 1, &lie.sheet(i, count), 0))
            .collect()
    };
    let scene = world(objects, vec![pane(0.5)]);
    let ray = Ray::new(Vec3::new(0.1, 0.13, -1.0), Vec3::new(0.0001, 0.0002, 1.0));
    let (mut cost, mut crossed) = (Counters::default(), 0);
    let mut crossing = MultiHit::default();
    let mut next = scene.aggregate.closest_hit_with(&ray, &mut cost);
    while let Some(hit) = next {
        crossed += 1;
        next = crossing.next_crossing(&scene.aggregate, &ray, &hit, &mut cost);
    }
    let visits = |cost: Counters| cost.nodes + cost.triangles;
    let mut of_light = Counters::default();
    let through = |_: &Hit| Vec3::new(1.0, 0.999, 0.5);
    let passing = (scene.aggregate).transmittance_with(&ray, through, &mut of_light);
    Visits {
        straight: visits(cost),
        crossed,
        to_light: visits(of_light),
        passing,
    }
}

pub(super) fn sheets(_: &Effort) -> Outcome {
    let counts = [400, 800, 5_000, 10_000];
    let (mut straight, mut to_light, mut wrong, mut crossed) = (Vec::new(), 0.0_f64, 0, 0);
    for (name, lie) in [
        ("across the ray", Lie::Across),
        ("slanted", Lie::Slanted),
        ("each turned another way", Lie::Turned),
        ("in one place", Lie::Together),
    ] {
        let mut most = 0.0_f64;
        for one_mesh in [true, false] {
            // Where boxes overlap, thousands cost what their pairs do, over 512.
            let counts = match lie {
                Lie::Across => &counts[..],
                _ => &counts[..2],
            };
            let all: Vec<Visits> = counts
                .iter()
                .map(|&count| visits(count, lie, one_mesh))
                .collect();
            for (visits, &count) in all.iter().zip(counts) {
                let exact = [
                    1.0,
                    f64::from(0.999_f32).powi(count as i32),
                    0.5_f64.powi(count as i32),
                ];
                let bound = f64::from(count) * f64::from(f32::EPSILON) / 2.0;
                let is_exact = (0..3).all(|i| {
                    let off = (f64::from(visits.passing[i]) - exact[i]).abs();
                    off <= bound * exact[i] + f64::from(f32::MIN_POSITIVE)
                });
                wrong += usize::from(!is_exact || visits.crossed != count);
                crossed += count as usize;
            }
            let more = |of: fn(&Visits) -> u64, few: &Visits, many: &Visits| {
                of(many) as f64 / of(few) as f64
            };
            most = most.max(more(|v| v.straight, &all[0], &all[1]));
            for pair in all.chunks_exact(2) {
                to_light = to_light.max(more(|v| v.to_light, &pair[0], &pair[1]));
            }
        }
        straight.push((name, most));
    }
    let figures: Vec<String> = (straight.iter())
        .map(|(name, most)| format!("{name} {}", digits(*most, 3)))
        .collect();
    let outcome = Outcome::new(
        crossed,
        format!(
            "visits through 800 sheets against 400 at most, {}; of a ray to a light, and through 10000 against 5000, {}",
            figures.join(", "),
            digits(to_light, 3)
        ),
    )
    .require(to_light <= 2.2, format!("{to_light} times the visits to a light"))
    .require(wrong == 0, format!("{wrong} numbers of sheets are not crossed once each"));
    (straight.iter()).fold(outcome, |outcome, (name, most)| {
        outcome.require(*most <= 2.2, format!("{name}: {most} times the visits"))
    })
}

/// What is not there: faded away, or cut out.
fn nothing() -> [Material; 3] {
    let cut = |opacity, cutoff| Material {
        alpha: Alpha::Mask { cutoff },
        ..pane(opacity)
    };
    [pane(0.0), cut(0.4, 0.5), cut(1.0, 1.5)]
}

/// A floor under a lamp, and sheets before the camera and below the lamp, or none.
fn behind_nothing(sheets: Option<Material>) -> World {
    let floor = quad(Vec3::new(-4.0, 0.0, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0);
    let block = quad(Vec3::new(-0.5, 0.5, -0.5), Vec3::Z, Vec3::X);
    let mut objects = vec![flat(1, &floor, 0), flat(2, &block, 1)];
    let mut materials = Vec::new();
    if let Some(material) = sheets {
        let sheet = |y| quad(Vec3::new(-9.0, y, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
        objects.push(flat(3, &[sheet(2.5), sheet(1.25)].concat(), 2));
        materials.push(material);
    }
    let mirror = Material {
        specular: Vec3::splat(0.5),
        mirror: Vec3::splat(0.5),
        ..Material::default()
    };
    // There is glass in both, so that both are traced in the same way.
    materials.splice(0..0, [mirror, pane(0.7)]);
    let mut scene = world(objects, materials);
    scene.lights = Arc::new(Lights {
        parallelograms: vec![ParallelogramLight {
            id: 9,
            corner: Vec3::new(-0.5, 2.0, -0.5),
            edges: [Vec3::X, Vec3::Z],
            colors: [Vec3::splat(4.0); 4],
            two_sided: false,
            visible: true,
            samples: 4,
        }],
        ..Lights::default()
    });
    scene.with_needs()
}

pub(super) fn invisible(effort: &Effort) -> Outcome {
    let edge = if effort.rays > 1_000_000 { 256 } else { 48 };
    let (mut wrong, mut pixels) = (0, 0);
    for translucency in [false, true] {
        let mut settings = RenderSettings {
            size: UVec2::splat(edge),
            spp: 4,
            ..RenderSettings::default()
        };
        settings.features.translucency = translucency;
        settings.features.glossy = translucency;
        let camera = Camera::looking_at(Vec3::new(2.0, 4.0, 3.0), Vec3::ZERO, Vec3::Y, 0.7);
        let picture =
            |sheets| render(&behind_nothing(sheets), &camera, &settings, &|_, _| {}).picture;
        let without = picture(None);
        for sheets in nothing() {
            let with = picture(Some(sheets));
            pixels += with.pixels.len();
            let pairs = without.pixels.iter().zip(&with.pixels);
            wrong += pairs.filter(|(a, b)| a != b).count();
        }
    }
    Outcome::new(
        pixels,
        format!("{wrong} pixels differ from those without it"),
    )
    .require(wrong == 0, format!("{wrong} pixels differ"))
}
