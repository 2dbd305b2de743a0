//! S1–S4, S8, S9: the debug rays, at points and in colours worked out by hand.

use super::{RED, Scene, WHITE, expect, is_color, is_near, segment};
use crate::analytic::{object, quad, world};
use glam::{Vec2, Vec3};
use glassbox::inspect::{InspectSettings, LineSet, MissColor, RaySettings, System};
use glassbox::scene::{Lighting, PhongMap};
use glassbox::trace::{
    Camera, DOME, Environment, Lights, Map, Material, Mesh, Object, ParallelogramLight, PointLight,
    Samples, SegmentLight, Texels, Texture,
};
use std::f32::consts::PI;
use std::sync::Arc;

/// 4 m × 4 m around the origin, facing up.
pub(super) fn floor() -> [Vec3; 6] {
    quad(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0)
}

/// The same at another height.
pub(super) fn screen(height: f32) -> [Vec3; 6] {
    floor().map(|corner| corner + Vec3::Y * height)
}

pub(super) fn matt(diffuse: Vec3) -> Material {
    Material {
        diffuse,
        ..Material::default()
    }
}

pub(super) fn lamp(position: Vec3, color: Vec3) -> PointLight {
    PointLight {
        id: 100,
        position,
        color,
        cone: None,
    }
}

/// At (0, 1, 1), looking at the origin: its ray meets the floor there, along (0, -1, -1).
pub(super) fn camera() -> Camera {
    Camera::looking_at(Vec3::new(0.0, 1.0, 1.0), Vec3::ZERO, Vec3::Y, 0.5)
}

pub(super) const EYE: Vec3 = Vec3::new(0.0, 1.0, 1.0);

pub(super) fn rays(scene: &Scene) -> LineSet {
    scene.lines(System::Rays, &InspectSettings::default())
}

#[test]
fn s1_the_camera_ray_has_the_colour_of_what_it_hits_shaded_or_not() {
    let mut world = world(
        vec![object(1, &floor(), 0)],
        vec![matt(Vec3::new(0.5, 0.25, 0.1))],
    );
    world.lights = Arc::new(Lights {
        points: vec![lamp(Vec3::Y * 2.0, Vec3::splat(4.0 * PI))],
        ..Lights::default()
    });
    let mut scene = Scene::of(world, camera());
    // kd/π · I/d² · cos = kd/π · 4π/4 · 1.
    expect(&rays(&scene), EYE, Vec3::ZERO, [0.5, 0.25, 0.1]);
    let set = rays(&scene);
    expect(&set, Vec3::ZERO, Vec3::Y * 2.0, WHITE);
    scene.settings.features.shading = false;
    scene.world.lights = Arc::default();
    expect(&rays(&scene), EYE, Vec3::ZERO, [0.5, 0.25, 0.1]);
}

#[test]
fn s2_each_bounce_has_the_colour_that_it_carries_and_a_miss_is_red_or_the_backgrounds() {
    let mirror = Material {
        specular: Vec3::splat(0.5),
        mirror: Vec3::splat(0.5),
        shininess: 1e6,
        ..matt(Vec3::ZERO)
    };
    let shining = Material {
        emission: Vec3::new(0.2, 0.4, 0.6),
        ..matt(Vec3::ZERO)
    };
    // The mirrored ray goes up along (0, 1, -1) and meets the wall at z = -2 where y = 2.
    let wall = quad(Vec3::new(-3.0, 0.0, -2.0), Vec3::X * 6.0, Vec3::Y * 6.0);
    let materials = vec![mirror, shining];
    let both = world(
        vec![object(1, &floor(), 0), object(2, &wall, 1)],
        materials.clone(),
    );
    let set = rays(&Scene::of(both, camera()));
    expect(&set, EYE, Vec3::ZERO, [0.1, 0.2, 0.3]);
    expect(&set, Vec3::ZERO, Vec3::new(0.0, 2.0, -2.0), [0.2, 0.4, 0.6]);

    let mut alone = world(vec![object(1, &floor(), 0)], materials);
    alone.environment = Environment {
        background: Vec3::new(0.3, 0.6, 0.9),
        ..Environment::default()
    };
    let scene = Scene::of(alone, camera());
    let leaves = |set: &LineSet| {
        let found = set
            .segments
            .iter()
            .find(|s| is_near(s.ends[0], Vec3::ZERO))
            .copied();
        let found = found.expect("a ray that leaves the mirror");
        let way = (found.ends[1] - found.ends[0]).normalize();
        assert!(is_near(way, Vec3::new(0.0, 0.5, -0.5).normalize()), "{way}");
        found.colors[0]
    };
    assert!(is_color(leaves(&rays(&scene)), [0.3, 0.6, 0.9]));
    let red = InspectSettings {
        rays: RaySettings {
            misses: MissColor::Red,
            ..RaySettings::default()
        },
        ..InspectSettings::default()
    };
    assert!(is_color(leaves(&scene.lines(System::Rays, &red)), RED));
}

#[test]
fn s3_a_shadow_ray_ends_at_its_occluder_and_the_rest_of_it_is_dark() {
    let mut world = world(
        vec![object(1, &floor(), 0), object(2, &screen(1.5), 0)],
        vec![matt(Vec3::ONE)],
    );
    world.lights = Arc::new(Lights {
        points: vec![lamp(Vec3::Y * 2.0, Vec3::ONE)],
        ..Lights::default()
    });
    let scene = Scene::of(world, camera());
    let set = rays(&scene);
    let above = Vec3::Y * 1.5;
    assert!(segment(&set, Vec3::ZERO, above).colors[0].red > 0.3);
    expect(&set, above, Vec3::Y * 2.0, [0.03, 0.03, 0.04]);
    assert!(set.points.iter().any(|dot| is_near(dot.at, above)));
    // Switched off it is gone.
    let mut inspect = InspectSettings::default();
    inspect.rays.shadow = false;
    assert_eq!(scene.lines(System::Rays, &inspect).segments.len(), 1);
}

/// One metre square at y = 2, facing down, a colour at each corner.
fn area_light(samples: u32) -> ParallelogramLight {
    ParallelogramLight {
        id: 100,
        corner: Vec3::new(-0.5, 2.0, -0.5),
        edges: [Vec3::X, Vec3::Z],
        colors: [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE],
        two_sided: false,
        visible: false,
        samples,
    }
}

#[test]
fn s4_every_light_sample_has_its_ray_and_area_lights_show_their_gradients() {
    let mut world = world(vec![object(1, &floor(), 0)], vec![matt(Vec3::ONE)]);
    let segment_light = SegmentLight {
        id: 101,
        ends: [Vec3::new(-1.0, 1.5, 0.0), Vec3::new(1.0, 1.5, 0.0)],
        colors: [Vec3::X, Vec3::Z],
        samples: 3,
    };
    world.lights = Arc::new(Lights {
        segments: vec![segment_light],
        parallelograms: vec![area_light(16)],
        ..Lights::default()
    });
    let mut scene = Scene::of(world, camera());
    let ends_at = |scene: &Scene, height: f32| {
        let set = rays(scene);
        let from_origin = set
            .segments
            .iter()
            .filter(|s| is_near(s.ends[0], Vec3::ZERO));
        from_origin
            .map(|s| s.ends[1])
            .filter(|end| (end.y - height).abs() < 1e-3)
            .collect::<Vec<Vec3>>()
    };
    for lighting in [Lighting::Physical, Lighting::Classic] {
        scene.settings.lighting = lighting;
        let (square, line) = (ends_at(&scene, 2.0), ends_at(&scene, 1.5));
        assert_eq!((square.len(), line.len()), (16, 3), "{lighting:?}");
        assert!(square.iter().all(|p| p.x.abs() <= 0.5 && p.z.abs() <= 0.5));
        assert!(line.iter().all(|p| p.x.abs() <= 1.0 && p.z.abs() < 1e-3));
        let mut cells: Vec<i32> = square
            .iter()
            .map(|p| ((p.x + 0.5) * 4.0) as i32 * 4 + ((p.z + 0.5) * 4.0) as i32)
            .collect();
        cells.sort_unstable();
        cells.dedup();
        // Chosen evenly there is one in each of the sixteen cells; else brighter cells have more.
        let is_even = cells.len() == 16;
        assert_eq!(
            is_even,
            lighting == Lighting::Classic,
            "{lighting:?}: {cells:?}"
        );
    }

    let lights = scene.lines(System::Lights, &InspectSettings::default());
    let color_at = |place: Vec3| {
        let mut ends = lights
            .segments
            .iter()
            .flat_map(|s| s.ends.into_iter().zip(s.colors));
        let found = ends.find(|(end, _)| is_near(*end, place));
        found.unwrap_or_else(|| panic!("nothing ends at {place}")).1
    };
    for (corner, color) in [
        (Vec3::new(-0.5, 2.0, -0.5), [1.0, 0.0, 0.0]),
        (Vec3::new(0.5, 2.0, -0.5), [0.0, 1.0, 0.0]),
        (Vec3::new(-0.5, 2.0, 0.5), [0.0, 0.0, 1.0]),
        (Vec3::new(0.5, 2.0, 0.5), WHITE),
        // Bilinear: half way along the first edge.
        (Vec3::new(0.0, 2.0, -0.5), [0.5, 0.5, 0.0]),
        (Vec3::new(-1.0, 1.5, 0.0), [1.0, 0.0, 0.0]),
        (Vec3::new(1.0, 1.5, 0.0), [0.0, 0.0, 1.0]),
    ] {
        let found = color_at(corner);
        assert!(is_color(found, color), "at {corner}: {found:?}");
    }
}

#[test]
fn a_dome_is_drawn_as_directions_that_point_in_from_where_it_is_bright() {
    let mut world = world(vec![object(1, &floor(), 0)], vec![matt(Vec3::ONE)]);
    // A sun of one texel at 45° above -Z.
    let texels = (0..64 * 32).map(|i| match (i % 64, i / 64) {
        (32, 8) => [900.0, 0.0, 0.0],
        _ => [0.0, 0.0, 1.0],
    });
    let map = Texture::new(64, 32, Texels::Linear32(texels.collect())).unwrap();
    world.environment = Environment {
        map: Some(Arc::new(map)),
        intensity: 1.0,
        lights: true,
        samples: 16,
        ..Environment::default()
    };
    let scene = Scene::of(world, camera());
    let lights = scene.lines(System::Lights, &InspectSettings::default());
    assert!(lights.notes.is_empty(), "{:?}", lights.notes);
    assert_eq!(lights.segments.len(), 128);
    let (around, across) = (PI / 64.0, PI * 8.5 / 32.0);
    let sun = Vec3::new(
        across.sin() * around.sin(),
        across.cos(),
        -across.sin() * around.cos(),
    );
    let mut to_sun = 0;
    for segment in &lights.segments {
        let [outer, inner] = segment.ends;
        let direction = outer.normalize();
        // The scene's middle is the origin.
        assert!((outer - inner).normalize().dot(direction) > 0.999);
        if direction.dot(sun) > 0.97 {
            to_sun += 1;
            // Within half of a texel.
            assert!(segment.colors[0].red > 0.0 || direction.dot(sun) < 0.999);
        }
    }
    // Its light is half of all, and so are its directions.
    assert!((56..=80).contains(&to_sun), "{to_sun} of 128");
    let to_light = rays(&scene);
    let far = to_light.segments.iter().filter(|s| s.ends[1].y > 2.0);
    assert!(far.count() >= 8, "{:?}", to_light.segments);
    scene.probe(Samples::All).rays.iter().for_each(|ray| {
        let is_of_dome = ray.light.is_none_or(|light| light.id == DOME);
        assert!(is_of_dome, "{ray:?}");
    });
}

#[test]
fn s8_the_camera_ray_takes_the_texels_colour() {
    let (instance, plain) = object(1, &floor(), 0);
    // u along x and v along z; 2 × 2 texels of one metre each way.
    let uvs = floor().map(|p| Vec2::new((p.x + 2.0) / 4.0, (p.z + 2.0) / 4.0));
    let mesh = Arc::new(Mesh {
        uvs: uvs.to_vec(),
        ..Mesh::of(plain.mesh.tree.clone())
    });
    let texels = vec![
        [0.9, 0.1, 0.1],
        [0.1, 0.8, 0.1],
        [0.1, 0.1, 0.7],
        [0.6, 0.6, 0.1],
    ];
    let material = Material {
        diffuse: Vec3::ONE,
        maps: vec![Map::new(PhongMap::Diffuse, 0)],
        ..Material::default()
    };
    let mut world = world(vec![(instance, Object { mesh, ..plain })], vec![material]);
    let texture = Texture::new(2, 2, Texels::Linear32(texels)).unwrap();
    world.textures = Arc::new(vec![Arc::new(texture)]);
    // The middle of the upper right texel: u = 3/4, v = 1/4.
    let at = Vec3::new(1.0, 0.0, -1.0);
    let camera = Camera::looking_at(at + EYE, at, Vec3::Y, 0.5);
    let mut scene = Scene::of(world, camera);
    scene.settings.features.shading = false;
    expect(&rays(&scene), at + EYE, at, [0.1, 0.8, 0.1]);
}

#[test]
fn s9_a_ray_that_misses_takes_the_maps_colour() {
    let mut world = world(vec![object(1, &floor(), 0)], vec![Material::default()]);
    let map = Texture::new(1, 1, Texels::Linear32(vec![[0.2, 0.5, 0.8]])).unwrap();
    world.environment = Environment {
        map: Some(Arc::new(map)),
        intensity: 1.0,
        ..Environment::default()
    };
    let camera = Camera::looking_at(EYE, EYE + Vec3::Y, Vec3::Z, 0.5);
    let set = rays(&Scene::of(world, camera));
    assert_eq!(set.segments.len(), 1);
    let found = set.segments[0];
    assert!(is_near(found.ends[0], EYE) && is_color(found.colors[1], [0.2, 0.5, 0.8]));
    assert!(is_near((found.ends[1] - EYE).normalize(), Vec3::Y));
}
