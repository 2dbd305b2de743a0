//! Where renderers break: the cases that need a picture. Those of rays and trees alone stand in
//! `src/bvh/tests`.

use crate::analytic::{Numbers, central_radiance, object, quad, world};
use glam::{Quat, UVec2, Vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Builder, Levels};
use glassbox::film::render;
use glassbox::scene::{PixelSampling, RenderSettings};
use glassbox::trace::{
    Camera, Environment, Lights, Material, ParallelogramLight, PointLight, World,
};
use std::sync::Arc;

fn point_light(position: Vec3) -> Lights {
    Lights {
        points: vec![PointLight {
            id: 99,
            position,
            color: Vec3::ONE,
            cone: None,
        }],
        ..Lights::default()
    }
}

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

#[test]
fn a_light_a_hundredth_of_a_degree_above_a_plane_leaves_no_dark_pixel() {
    let mut numbers = Numbers(18);
    for (turn, at) in [
        (Quat::IDENTITY, Vec3::ZERO),
        (Quat::from_axis_angle(numbers.direction(), 1.1), Vec3::ZERO),
        (
            Quat::from_axis_angle(numbers.direction(), 2.3),
            Vec3::new(300.0, -70.0, 1000.0),
        ),
    ] {
        let mut plane = world(
            vec![object(1, &tessellated_plane(32, 0.25, turn, at), 0)],
            vec![Material::default()],
        );
        // 20 m away, so that it stands 0.01° above every place in view by less than a factor of 2.
        let height = 20.0 * 0.01_f32.to_radians().tan();
        let up = turn * Vec3::Y;
        plane.lights = Arc::new(point_light(at + turn * (Vec3::X * 20.0) + up * height));
        let camera = Camera::looking_at(at + up * 4.0, at, turn * Vec3::Z, 0.8);
        let settings = RenderSettings {
            size: UVec2::splat(128),
            spp: 1,
            ..RenderSettings::default()
        };
        let picture = render(&plane, &camera, &settings, &|_, _| {}).picture;
        let dark = picture.pixels.iter().filter(|p| p.x <= 0.0).count();
        // Far from the origin the plane's own corners are off by more than the light's height.
        let rough = at.length() * f32::EPSILON / 0.25 > 0.1 * 0.01_f32.to_radians();
        if !rough {
            assert_eq!(dark, 0, "{dark} dark pixels, turned by {turn}, at {at}");
        }
    }
}

#[test]
fn no_light_leaks_under_an_object_that_stands_a_ten_thousandth_of_the_scene_above_the_floor() {
    // A slab 2 m wide, 2·10⁻⁴ m above the floor of a scene of 2 m, lit from straight above.
    let gap = 2e-4;
    for shift in [Vec3::ZERO, Vec3::new(10.0, 5.0, -7.0)] {
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
            vec![object(1, &floor, 0), object(2, &slab, 0)],
            vec![Material::default()],
        );
        scene.lights = Arc::new(point_light(Vec3::new(0.1, 3.0, 0.2) + shift));
        let settings = RenderSettings {
            spp: 1,
            ..RenderSettings::default()
        };
        let mut numbers = Numbers(19);
        for _ in 0..2000 {
            // From within the gap onto the floor: nothing of the light may be there.
            let at = Vec3::new(numbers.between(-0.9, 0.9), 0.0, numbers.between(-0.9, 0.9)) + shift;
            let eye = at + Vec3::new(0.5 * gap, 0.5 * gap, 0.1 * gap);
            let camera = Camera::looking_at(eye, at, Vec3::Z, 0.1);
            let value = central_radiance(&scene, &camera, &settings).0;
            assert_eq!(value, Vec3::ZERO, "light under the slab at {at}");
        }
    }
}

#[test]
fn a_light_on_a_surface_or_next_to_it_gives_finite_values_everywhere() {
    for exponent in [1, 3, 6, 9, 12, 20, 30, 38, 45] {
        let above = 10f32.powi(-exponent);
        let floor = quad(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0);
        let mut scene = world(vec![object(1, &floor, 0)], vec![Material::default()]);
        scene.lights = Arc::new(point_light(Vec3::new(0.3, above, 0.1)));
        let camera = Camera::looking_at(
            Vec3::new(0.3, 1.0, 0.1),
            Vec3::new(0.3, 0.0, 0.1),
            Vec3::Z,
            0.5,
        );
        let settings = RenderSettings {
            size: UVec2::splat(33),
            spp: 4,
            ..RenderSettings::default()
        };
        for pixel in [PixelSampling::Center, PixelSampling::Area] {
            let settings = RenderSettings {
                pixel,
                ..settings.clone()
            };
            let picture = render(&scene, &camera, &settings, &|_, _| {}).picture;
            assert!(
                picture.pixels.iter().all(|p| p.is_finite()),
                "10^-{exponent}, {pixel:?}"
            );
        }
    }
}

#[test]
fn two_coplanar_surfaces_give_one_picture_whatever_the_threads_and_the_tree() {
    let corners = tessellated_plane(
        6,
        0.7,
        Quat::from_rotation_x(0.4),
        Vec3::new(0.1, 0.2, -0.3),
    );
    let colored = |color| Material {
        diffuse: color,
        ..Material::default()
    };
    let mut scene = world(
        vec![
            object(1, &corners, 0),
            object(2, &corners, 1),
            object(3, &corners, 2),
        ],
        vec![colored(Vec3::X), colored(Vec3::Y), colored(Vec3::Z)],
    );
    scene.lights = Arc::new(point_light(Vec3::new(1.0, 3.0, 2.0)));
    let camera = Camera::looking_at(Vec3::new(0.5, 3.0, 2.0), Vec3::ZERO, Vec3::Y, 0.9);
    let settings = RenderSettings {
        size: UVec2::new(70, 50),
        spp: 4,
        ..RenderSettings::default()
    };
    let picture = |scene: &World, threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| render(scene, &camera, &settings, &|_, _| {}).picture)
    };
    let expected = picture(&scene, 1);
    let lit = expected.pixels.iter().filter(|p| p.x > 0.0).count();
    assert!(lit > 500, "only {lit} lit pixels");
    assert!(
        expected.pixels.iter().all(|p| p.y == 0.0 && p.z == 0.0),
        "the first of the three surfaces wins"
    );
    for threads in [2, 7] {
        assert_eq!(picture(&scene, threads), expected, "{threads} threads");
    }
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
            assert_eq!(picture(&scene, 2), expected, "{builder:?}, {levels:?}");
        }
    }
}

#[test]
fn a_light_in_front_of_in_or_behind_a_surface_is_never_hidden_by_itself() {
    // A ceiling with a light in its very plane, as emissive panels are modelled: full light below.
    let ceiling = quad(Vec3::new(-3.0, 2.0, -3.0), Vec3::X * 6.0, Vec3::Z * 6.0);
    let floor = quad(Vec3::new(-3.0, 0.0, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0);
    let light = |y| Lights {
        parallelograms: vec![ParallelogramLight {
            id: 9,
            corner: Vec3::new(-0.5, y, -0.5),
            edges: [Vec3::X, Vec3::Z],
            colors: [Vec3::ONE; 4],
            two_sided: false,
            visible: true,
            samples: 1,
        }],
        ..Lights::default()
    };
    let settings = RenderSettings {
        spp: 64,
        ..RenderSettings::default()
    };
    let camera = Camera::looking_at(
        Vec3::new(0.2, 0.5, 0.3),
        Vec3::new(1.1, 0.0, 0.4),
        Vec3::Z,
        0.1,
    );
    let radiance = |objects, y| {
        let mut scene = world(objects, vec![Material::default()]);
        scene.lights = Arc::new(light(y));
        central_radiance(&scene.with_needs(), &camera, &settings)
    };
    let open = radiance(vec![object(1, &floor, 0)], 2.0).0;
    let closed = radiance(vec![object(1, &floor, 0), object(2, &ceiling, 0)], 2.0).0;
    assert_eq!(open, closed, "a light in the ceiling's plane");
    assert!(open.x > 0.01);
    // And it is seen: the coplanar light wins against the ceiling.
    let mut scene = world(vec![object(2, &ceiling, 0)], vec![Material::default()]);
    scene.lights = Arc::new(light(2.0));
    let up = Camera::looking_at(
        Vec3::new(0.2, 0.0, 0.1),
        Vec3::new(0.21, 2.0, 0.12),
        Vec3::Z,
        0.1,
    );
    let seen = central_radiance(&scene.with_needs(), &up, &settings).0;
    assert_eq!(seen, Vec3::ONE);
}

#[test]
fn an_empty_world_shows_its_background() {
    let scene = World {
        environment: Environment {
            background: Vec3::new(0.25, 0.5, 1.0),
            ..Environment::default()
        },
        ..World::default()
    };
    let settings = RenderSettings {
        size: UVec2::new(5, 3),
        spp: 2,
        ..RenderSettings::default()
    };
    let camera = Camera::looking_at(Vec3::ZERO, Vec3::X, Vec3::Y, 1.0);
    let picture = render(&scene, &camera, &settings, &|_, _| {}).picture;
    assert!(
        picture
            .pixels
            .iter()
            .all(|p| *p == Vec3::new(0.25, 0.5, 1.0))
    );
}
