//! Cases of light and shadow.

use super::scenes::{central_radiance, flat, object, once, point_light, quad, world};
use super::{Effort, Outcome};
use crate::bvh::hard_cases::meshes::sphere;
use crate::bvh::hard_cases::random::Random;
use crate::bvh::{Aggregate, BuildOptions, Builder, Levels};
use crate::film::{Picture, Progressive, render};
use crate::report::table::digits;
use crate::scene::{PixelSampling, RenderSettings};
use crate::trace::{
    Camera, DirectionalLight, FirstHit, Lights, Material, ParallelogramLight, PointLight,
    SegmentLight, SpotCone, World, central_hits,
};
use glam::{Quat, UVec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// A plane of `n` × `n` quads of edge `size`, turned and moved.
fn tessellated_plane(n: i32, size: f32, turn: Quat, at: Vec3) -> Vec<Vec3> {
    (0..n * n)
        .flat_map(|i| {
            let (x, z) = ((i % n - n / 2) as f32 * size, (i / n - n / 2) as f32 * size);
            quad(Vec3::new(x, 0.0, z), Vec3::Z * size, Vec3::X * size)
        })
        .map(|p| turn * p + at)
        .collect()
}

/// A plane under a light that is 20 m away and stands 0.01° above every place in view, by less than a factor of 2.
pub(super) fn grazed_plane(turn: Quat, at: Vec3) -> (World, Camera) {
    let plane = tessellated_plane(32, 0.25, turn, at);
    let mut scene = world(vec![flat(1, &plane, 0)], vec![Material::default()]);
    let height = 20.0 * 0.01_f32.to_radians().tan();
    let up = turn * Vec3::Y;
    scene.lights = point_light(at + turn * (Vec3::X * 20.0) + up * height);
    (
        scene,
        Camera::looking_at(at + up * 4.0, at, turn * Vec3::Z, 0.8),
    )
}

pub(super) fn acne(effort: &Effort) -> Outcome {
    let mut random = Random::new(effort.seed + 18);
    let settings = RenderSettings {
        size: UVec2::splat(256),
        ..once()
    };
    let places = [
        (Quat::IDENTITY, Vec3::ZERO),
        (Quat::from_axis_angle(random.direction(), 1.1), Vec3::ZERO),
        (Quat::from_axis_angle(random.direction(), 2.3), Vec3::ZERO),
        (
            Quat::from_axis_angle(random.direction(), 0.4),
            Vec3::new(0.5, -0.25, 1.0),
        ),
    ];
    let (mut dark, mut pixels) = (0, 0);
    for (turn, at) in places {
        let (scene, camera) = grazed_plane(turn, at);
        let picture = render(&scene, &camera, &settings, &|_, _| {}).picture;
        dark += picture.pixels.iter().filter(|p| p.x <= 0.0).count();
        pixels += picture.pixels.len();
    }
    Outcome::new(pixels, format!("{dark} dark pixels of {pixels}"))
        .require(dark == 0, format!("{dark} dark pixels"))
}

/// A slab 2 m wide, 2·10⁻⁴ m above the floor of a scene of 2 m, lit from straight above.
pub(super) fn slab_over_floor(gap: f32, shift: Vec3) -> World {
    let floor = quad(
        Vec3::new(-2.0, 0.0, -2.0) + shift,
        Vec3::Z * 4.0,
        Vec3::X * 4.0,
    );
    let slab = quad(
        Vec3::new(-1.0, gap, -1.0) + shift,
        Vec3::Z * 2.0,
        Vec3::X * 2.0,
    );
    let mut scene = world(
        vec![flat(1, &floor, 0), flat(2, &slab, 0)],
        vec![Material::default()],
    );
    scene.lights = point_light(Vec3::new(0.1, 3.0, 0.2) + shift);
    scene
}

pub(super) fn contact(effort: &Effort) -> Outcome {
    let gap = 2e-4;
    let probes = (effort.rays / 100).clamp(100, 20_000);
    let mut random = Random::new(effort.seed + 19);
    let mut lit = 0;
    let shifts = [Vec3::ZERO, Vec3::new(10.0, 5.0, -7.0)];
    for shift in shifts {
        let scene = slab_over_floor(gap, shift);
        for _ in 0..probes {
            // From within the gap onto the floor: nothing of the light may be there.
            let at = Vec3::new(random.between(-0.9, 0.9), 0.0, random.between(-0.9, 0.9)) + shift;
            let eye = at + Vec3::new(0.5 * gap, 0.5 * gap, 0.1 * gap);
            let camera = Camera::looking_at(eye, at, Vec3::Z, 0.1);
            lit += usize::from(central_radiance(&scene, &camera, &once()).0 != Vec3::ZERO);
        }
    }
    Outcome::new(
        shifts.len() * probes,
        format!("{lit} lit places under the slab"),
    )
    .require(lit == 0, format!("{lit} lit places"))
}

/// A lamp of each kind that has a place: there, along these two directions.
fn lamps_at(at: Vec3, [a, b]: [Vec3; 2]) -> [Arc<Lights>; 4] {
    let spot = PointLight {
        id: 9,
        position: at,
        color: Vec3::ONE,
        cone: Some(SpotCone::new(-at.normalize_or(b), 0.5, 1.5)),
    };
    let segment = SegmentLight {
        id: 9,
        ends: [at - 0.05 * a, at + 0.05 * a],
        colors: [Vec3::ONE; 2],
        samples: 1,
    };
    let panel = ParallelogramLight {
        id: 9,
        corner: at - 0.05 * (a + b),
        edges: [0.1 * a, 0.1 * b],
        colors: [Vec3::ONE; 4],
        two_sided: true,
        visible: false,
        samples: 1,
    };
    [
        point_light(at),
        Arc::new(Lights {
            points: vec![spot],
            ..Lights::default()
        }),
        Arc::new(Lights {
            segments: vec![segment],
            ..Lights::default()
        }),
        Arc::new(Lights {
            parallelograms: vec![panel],
            ..Lights::default()
        }),
    ]
}

pub(super) fn in_the_plane(effort: &Effort) -> Outcome {
    let mut random = Random::new(effort.seed + 20);
    let (mut lit, mut odd) = (0, 0);
    let probes = (effort.rays / 1000).clamp(50, 2_000);
    for i in 0..probes {
        let n = [Vec3::X, Vec3::Y, Vec3::Z][i % 3];
        let (a, b) = n.any_orthonormal_pair();
        let patch = quad(-0.01 * a - 0.01 * b, 0.02 * a, 0.02 * b);
        let mut scene = world(vec![flat(1, &patch, 0)], vec![Material::default()]);
        let around = random.between(0.0, TAU);
        let at = random.between(0.1, 5.0) * (around.cos() * a + around.sin() * b);
        let camera = Camera::looking_at(0.005 * n + 0.001 * a, 0.001 * a, b, 0.5);
        for lights in lamps_at(at, [a, b]) {
            scene.lights = lights;
            let scene = scene.clone().with_needs();
            let value = central_radiance(&scene, &camera, &once()).0;
            lit += usize::from(value != Vec3::ZERO);
            odd += usize::from(!value.is_finite());
        }
    }
    Outcome::new(
        4 * probes,
        format!("{lit} values other than 0, {odd} not finite"),
    )
    .require(lit == 0, format!("{lit} values other than 0"))
}

pub(super) fn on_the_light(_: &Effort) -> Outcome {
    let mut odd = 0;
    let (mut pixels, mut brightest) = (0, 0.0_f32);
    let floor = quad(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
    let eye = Vec3::new(0.3, 1.0, 0.1);
    let camera = Camera::looking_at(eye, Vec3::new(0.3, 0.0, 0.1), Vec3::Z, 0.5);
    let heights = [1, 3, 6, 9, 12, 20, 30, 38, 45].map(|exponent| 10f32.powi(-exponent));
    for above in heights.into_iter().chain([0.0]) {
        for lights in lamps_at(Vec3::new(0.3, above, 0.1), [Vec3::X, Vec3::Z]) {
            let mut scene = world(vec![flat(1, &floor, 0)], vec![Material::default()]);
            scene.lights = lights;
            let scene = scene.with_needs();
            for pixel in [PixelSampling::Center, PixelSampling::Area] {
                let settings = RenderSettings {
                    size: UVec2::splat(33),
                    spp: 4,
                    pixel,
                    ..RenderSettings::default()
                };
                let picture = render(&scene, &camera, &settings, &|_, _| {}).picture;
                odd += picture.pixels.iter().filter(|p| !p.is_finite()).count();
                brightest = (picture.pixels.iter()).fold(brightest, |most, p| most.max(p.x));
                pixels += picture.pixels.len();
            }
        }
    }
    Outcome::new(
        pixels,
        format!(
            "{odd} pixels not finite, the brightest {}",
            digits(f64::from(brightest), 2)
        ),
    )
    .require(odd == 0, format!("{odd} pixels are not finite"))
}

pub(super) fn coplanar(_: &Effort) -> Outcome {
    let corners = tessellated_plane(
        6,
        0.7,
        Quat::from_rotation_x(0.4),
        Vec3::new(0.1, 0.2, -0.3),
    );
    let colored = |diffuse| Material {
        diffuse,
        ..Material::default()
    };
    let objects = (0..3)
        .map(|i| flat(u64::from(i) + 1, &corners, i))
        .collect();
    let mut scene = world(objects, [Vec3::X, Vec3::Y, Vec3::Z].map(colored).to_vec());
    scene.lights = point_light(Vec3::new(1.0, 3.0, 2.0));
    let camera = Camera::looking_at(Vec3::new(0.5, 3.0, 2.0), Vec3::ZERO, Vec3::Y, 0.9);
    let settings = RenderSettings {
        size: UVec2::new(70, 50),
        spp: 4,
        ..RenderSettings::default()
    };
    let picture = |scene: &World, threads: usize| -> Option<Picture> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .ok()?;
        Some(pool.install(|| render(scene, &camera, &settings, &|_, _| {}).picture))
    };
    // Tiles come from the other end.
    let backwards = || -> Option<Picture> {
        let render = Progressive::start(scene.clone(), camera.clone(), settings.clone()).ok()?;
        render.set_focus(settings.size.as_vec2());
        render.wait();
        Some(render.snapshot().picture)
    };
    let expected = picture(&scene, 1);
    let mut pictures = vec![picture(&scene, 2), picture(&scene, 7), backwards()];
    let instances = scene.aggregate.instances().to_vec();
    for builder in [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc] {
        for levels in [Levels::One, Levels::Two] {
            let options = BuildOptions {
                builder,
                levels,
                ..BuildOptions::default()
            };
            let aggregate = Arc::new(Aggregate::build(instances.clone(), &options));
            let scene = World {
                aggregate,
                ..scene.clone()
            };
            pictures.push(picture(&scene, 2));
        }
    }
    let is_known = expected.is_some();
    let differ = pictures.iter().filter(|other| **other != expected).count();
    let pixels = expected.map_or_else(Vec::new, |picture| picture.pixels);
    let first = pixels.iter().all(|p| p.y == 0.0 && p.z == 0.0);
    let lit = pixels.iter().filter(|p| p.x > 0.0).count();
    Outcome::new(
        pixels.len() * (1 + pictures.len()),
        format!(
            "{differ} of {} pictures differ; the first surface wins everywhere: {first}",
            pictures.len()
        ),
    )
    .require(is_known, "threads could not be started")
    .require(differ == 0, format!("{differ} pictures differ"))
    .require(first && lit > 500, "another surface than the first is seen")
}

/// A sphere of few triangles with the normals of a true one, lit from the side, seen from above the terminator.
pub(super) fn coarse_sphere() -> (World, Camera, Vec3) {
    let mesh = sphere(2);
    let corners: Vec<Vec3> = (0..mesh.len() as u32)
        .flat_map(|i| mesh.corners(i))
        .collect();
    let normals = corners.clone();
    let white = Material {
        diffuse: Vec3::ONE,
        ..Material::default()
    };
    let mut scene = world(vec![object(1, &corners, normals, 0)], vec![white]);
    let to_light = Vec3::new(1.0, 0.25, 0.35).normalize();
    scene.lights = Arc::new(Lights {
        directionals: vec![DirectionalLight {
            id: 9,
            to_light,
            color: Vec3::splat(PI),
            disc: None,
            samples: 1,
        }],
        ..Lights::default()
    });
    let camera = Camera::looking_at(Vec3::new(-0.6, 0.8, 3.2), Vec3::ZERO, Vec3::Y, 0.7);
    (scene, camera, to_light)
}

pub(super) fn terminator(_: &Effort) -> Outcome {
    let (scene, camera, to_light) = coarse_sphere();
    let settings = RenderSettings {
        size: UVec2::splat(256),
        pixel: PixelSampling::Center,
        ..once()
    };
    let picture = render(&scene, &camera, &settings, &|_, _| {}).picture;
    let pixels = (0..256 * 256).map(|i| UVec2::new(i % 256, i / 256));
    let pixels: Vec<UVec2> = pixels.collect();
    let mut hits = vec![FirstHit::MISS; pixels.len()];
    central_hits(&scene, &camera, &settings, &pixels, &mut hits);
    // The light is such that a white surface which faces it has the value 1.
    let (mut band, mut seen, mut worst) = (0, 0, 0.0_f32);
    for (hit, value) in hits
        .iter()
        .zip(&picture.pixels)
        .filter(|(hit, _)| hit.object.is_some())
    {
        let loss = hit.normal.dot(to_light).max(0.0) - value.x;
        seen += 1;
        band += usize::from(loss > 1e-3);
        worst = worst.max(loss);
    }
    // The largest angle between a triangle's normal and the smooth ones on it: at its corners.
    let triangles = scene.objects[0].mesh.tree.triangles();
    let angles = (0..triangles.len() as u32).flat_map(|i| {
        let [a, b, c] = triangles.corners(i);
        let n = (b - a).cross(c - a).normalize();
        [a, b, c].map(|corner| corner.normalize().dot(n).clamp(-1.0, 1.0).acos())
    });
    let bound = angles.fold(0.0_f32, f32::max).min(FRAC_PI_2).sin();
    Outcome::new(
        seen,
        format!(
            "128 triangles: {} % of the pixels lose light, at most {}; bound {}",
            digits(100.0 * band as f64 / seen.max(1) as f64, 2),
            digits(f64::from(worst), 3),
            digits(f64::from(bound), 3)
        ),
    )
    .require(
        worst <= bound + 1e-3,
        format!("{worst} is lost, more than {bound}"),
    )
    .require(seen > 5_000, "the sphere is hardly seen")
}

pub(super) fn own_light(_: &Effort) -> Outcome {
    // A ceiling with a light in its very plane, as emissive panels are modelled: full light below.
    let ceiling = quad(Vec3::new(-3.0, 2.0, -3.0), Vec3::X * 6.0, Vec3::Z * 6.0);
    let floor = quad(Vec3::new(-3.0, 0.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0);
    let light = || {
        Arc::new(Lights {
            parallelograms: vec![ParallelogramLight {
                id: 9,
                corner: Vec3::new(-0.5, 2.0, -0.5),
                edges: [Vec3::X, Vec3::Z],
                colors: [Vec3::ONE; 4],
                two_sided: false,
                visible: true,
                samples: 1,
            }],
            ..Lights::default()
        })
    };
    let settings = RenderSettings {
        spp: 64,
        ..RenderSettings::default()
    };
    let radiance = |objects, camera: &Camera| {
        let mut scene = world(objects, vec![Material::default()]);
        scene.lights = light();
        central_radiance(&scene.with_needs(), camera, &settings).0
    };
    let mut dimmer = 0;
    let mut darkest = f32::INFINITY;
    let places = 40;
    for i in 0..places {
        let at = Vec3::new(-2.0 + 0.1 * i as f32, 0.0, 0.4);
        let camera = Camera::looking_at(Vec3::new(0.2, 0.5, 0.3), at, Vec3::Z, 0.1);
        let open = radiance(vec![flat(1, &floor, 0)], &camera);
        let closed = radiance(vec![flat(1, &floor, 0), flat(2, &ceiling, 0)], &camera);
        dimmer += usize::from(open != closed);
        darkest = darkest.min(open.x);
    }
    // And it is seen: the coplanar light wins against the ceiling.
    let eye = Vec3::new(0.2, 0.0, 0.1);
    let up = Camera::looking_at(eye, Vec3::new(0.21, 2.0, 0.12), Vec3::Z, 0.1);
    let seen = radiance(vec![flat(2, &ceiling, 0)], &up) == Vec3::ONE;
    Outcome::new(
        places * 64,
        format!("{dimmer} of {places} places dimmer; the light itself is seen: {seen}"),
    )
    .require(dimmer == 0, format!("{dimmer} places are dimmer"))
    .require(seen && darkest > 0.001, "the light is not seen")
}

#[cfg(test)]
mod tests;
