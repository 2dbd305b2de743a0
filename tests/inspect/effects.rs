//! S7, S11 and the pattern inset: what is drawn beside rays and trees.

use super::{Scene, expect, is_near, segment};
use crate::analytic::{object, quad, world};
use glam::{UVec2, Vec3};
use glassbox::inspect::{
    Dimension, InspectSettings, MOST_POINTS, NormalSettings, PatternSettings, System, pattern,
};
use glassbox::scene::{PixelSampling, Projection};
use glassbox::trace::{
    Camera, Lights, Material, Mesh, MovingLight, Object, ParallelogramLight, PointLight,
    SegmentLight,
};
use std::sync::Arc;

#[test]
fn s7_normals_stand_on_the_vertices_and_between_them() {
    let corners = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let (instance, plain) = object(1, &corners, 0);
    let mesh = Arc::new(Mesh {
        normals: vec![Vec3::Y * 3.0; 6],
        ..Mesh::of(plain.mesh.tree.clone())
    });
    let world = world(
        vec![(instance, Object { mesh, ..plain })],
        vec![Material::default()],
    );
    // From above, 3 m for 300 pixels: 20 pixels are 0.2 m.
    let mut scene = Scene::of(
        world,
        Camera {
            projection: Projection::Orthographic { height: 3.0 },
            ..Camera::looking_at(Vec3::Y * 5.0, Vec3::ZERO, Vec3::NEG_Z, 0.5)
        },
    );
    scene.settings.size = UVec2::splat(300);
    for (between, count) in [(0, 4), (1, 9), (2, 25)] {
        let inspect = InspectSettings {
            normals: NormalSettings {
                on: true,
                between,
                length: 20.0,
                ..NormalSettings::default()
            },
            ..InspectSettings::default()
        };
        let set = scene.lines(System::Normals, &inspect);
        // Corners that both triangles share are drawn once.
        assert_eq!(set.segments.len(), count, "level {between}");
        let corner = Vec3::new(1.0, 0.0, -1.0);
        segment(&set, corner, corner + 0.2 * Vec3::Y);
        if between > 0 {
            let middle = Vec3::new(1.0, 0.0, 0.0);
            segment(&set, middle, middle + 0.2 * Vec3::Y);
        }
    }
}

#[test]
fn normals_too_dense_for_the_screen_are_thinned_and_it_says_so() {
    let mut scene = Scene::open("knot", UVec2::new(200, 150));
    scene.settings.spp = 1;
    let inspect = InspectSettings {
        normals: NormalSettings {
            on: true,
            ..NormalSettings::default()
        },
        ..InspectSettings::default()
    };
    let set = scene.lines(System::Normals, &inspect);
    let thinned = set.thinned.expect("87 thousand triangles do not fit");
    assert_eq!(thinned.drawn, set.segments.len());
    // A square of 6 pixels each.
    assert!(
        thinned.drawn <= 34 * 26 && thinned.drawn > 100,
        "{thinned:?}"
    );
    // The picture shows all of the knot: each of its vertices counts once.
    let vertices = scene
        .world
        .objects
        .iter()
        .map(|object| object.mesh.normals.len());
    let vertices: usize = vertices.sum();
    assert!(
        thinned.of <= vertices && thinned.of > vertices / 2,
        "{thinned:?} of {vertices}"
    );
}

#[test]
fn of_normals_that_are_all_drawn_none_is_said_to_be_left_out() {
    let corners = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let (instance, plain) = object(1, &corners, 0);
    let mesh = Arc::new(Mesh {
        normals: vec![Vec3::Y; 6],
        ..Mesh::of(plain.mesh.tree.clone())
    });
    let world = world(
        vec![(instance, Object { mesh, ..plain })],
        vec![Material::default()],
    );
    for (height, between, drawn) in [(3.0, 0, 4), (3.0, 2, 25), (1.2, 2, 9)] {
        // From above: the lowest picture has the places around the middle alone.
        let mut scene = Scene::of(
            world.clone(),
            Camera {
                projection: Projection::Orthographic { height },
                ..Camera::looking_at(Vec3::Y * 5.0, Vec3::ZERO, Vec3::NEG_Z, 0.5)
            },
        );
        scene.settings.size = UVec2::splat(300);
        let mut inspect = InspectSettings::default();
        inspect.normals.between = between;
        let set = scene.lines(System::Normals, &inspect);
        assert_eq!((set.segments.len(), set.thinned), (drawn, None), "{height}");
        inspect.max_lines = 3;
        let thinned = scene.lines(System::Normals, &inspect).thinned.unwrap();
        assert_eq!((thinned.drawn, thinned.of), (3, drawn), "{height}");
    }
}

#[test]
fn whatever_is_drawn_keeps_to_the_most_lines_and_says_what_is_left_out() {
    let (objects, materials) = (1..=40)
        .map(|id| {
            let corners = quad(Vec3::X * id as f32, Vec3::Z, Vec3::X);
            let (instance, still) = object(id, &corners, 0);
            (instance.moving(Vec3::Y).unwrap(), still)
        })
        .fold(
            (
                Vec::new(),
                vec![Material {
                    mirror: Vec3::splat(0.5),
                    specular: Vec3::splat(0.5),
                    shininess: 10.0,
                    ..Material::default()
                }],
            ),
            |(mut objects, materials), object| {
                objects.push(object);
                (objects, materials)
            },
        );
    let mut world = world(objects, materials);
    world.lights = Arc::new(Lights {
        points: (1..=40)
            .map(|i| PointLight {
                id: 100 + i,
                position: Vec3::new(i as f32, 3.0, 0.0),
                color: Vec3::ONE,
                cone: None,
            })
            .collect(),
        ..Lights::default()
    });
    let mut camera = Camera::looking_at(
        Vec3::new(5.5, 4.0, 4.0),
        Vec3::new(5.5, 0.0, 0.5),
        Vec3::Y,
        0.8,
    );
    camera.optics.aperture_radius = 0.1;
    let mut scene = Scene::of(world, camera);
    scene.settings.spp = 4;
    scene.settings.features.glossy = true;
    for system in System::ALL {
        let mut inspect = InspectSettings::default();
        inspect.boxes.to_level = 40;
        inspect.boxes.triangles = true;
        inspect.boxes.split_planes = true;
        inspect.rays.visited = true;
        inspect.rays.hit_triangles = true;
        inspect.rays.hit_normals = true;
        let all = scene.lines(system, &inspect);
        assert_eq!(all.thinned, None, "{system:?}");
        if system == System::Normals {
            continue;
        }
        assert!(
            all.segments.len() > 30,
            "{system:?} has {}",
            all.segments.len()
        );
        for most in [1, 7, 20, 30] {
            inspect.max_lines = most;
            let set = scene.lines(system, &inspect);
            let drawn = set.segments.len();
            assert!(drawn <= most as usize, "{system:?} draws {drawn} of {most}");
            assert!(set.points.len() <= most as usize, "{system:?}");
            let thinned = set.thinned.unwrap_or_else(|| panic!("{system:?}, {most}"));
            assert!(thinned.drawn < thinned.of, "{system:?}: {thinned:?}");
        }
    }
}

#[test]
fn s11_motion_is_a_segment_from_where_the_shutter_opens_to_where_it_closes() {
    let corners = quad(Vec3::new(-0.5, 0.0, -0.5), Vec3::Z, Vec3::X);
    let (instance, still) = object(7, &corners, 0);
    let instance = instance.moving(Vec3::new(2.0, 0.0, 0.0)).unwrap();
    let mut camera = Camera::looking_at(Vec3::new(0.0, 5.0, 5.0), Vec3::ZERO, Vec3::Y, 0.8);
    camera.optics.shutter = [0.25, 0.75];
    camera.optics.velocity = Vec3::Y * 4.0;
    let scene = Scene::of(
        world(vec![(instance, still)], vec![Material::default()]),
        camera,
    );
    let set = scene.lines(System::Motion, &InspectSettings::default());
    let orange = [1.0, 0.4, 0.02];
    // 2 m/s for half of the time, from x = 0.5 to x = 1.5; the camera rises from y = 6 to y = 8.
    expect(&set, Vec3::X * 0.5, Vec3::X * 1.5, orange);
    expect(
        &set,
        Vec3::new(0.0, 6.0, 5.0),
        Vec3::new(0.0, 8.0, 5.0),
        orange,
    );
    // Ghosts: the edge at z = -0.5, when the shutter opens and when it closes.
    segment(&set, Vec3::new(0.0, 0.0, -0.5), Vec3::new(1.0, 0.0, -0.5));
    segment(&set, Vec3::new(1.0, 0.0, -0.5), Vec3::new(2.0, 0.0, -0.5));
}

#[test]
fn s11_lights_that_move_are_drawn_where_the_shutter_opens_and_closes() {
    let corners = quad(Vec3::new(-0.5, 0.0, -0.5), Vec3::Z, Vec3::X);
    let mut camera = Camera::looking_at(Vec3::new(0.0, 5.0, 5.0), Vec3::ZERO, Vec3::Y, 0.8);
    camera.optics.shutter = [0.25, 0.75];
    let mut world = world(vec![object(7, &corners, 0)], vec![Material::default()]);
    let moving = |id| MovingLight {
        id,
        velocity: Vec3::X * 2.0,
        samples: 1,
    };
    let point = |id, position| PointLight {
        id,
        position,
        color: Vec3::ONE,
        cone: None,
    };
    world.lights = Arc::new(Lights {
        points: vec![point(1, Vec3::Y), point(2, Vec3::Y * 9.0)],
        segments: vec![SegmentLight {
            id: 3,
            ends: [Vec3::Y * 2.0, Vec3::Y * 3.0],
            colors: [Vec3::ONE; 2],
            samples: 1,
        }],
        parallelograms: vec![ParallelogramLight {
            id: 4,
            corner: Vec3::Y * 4.0,
            edges: [Vec3::X, Vec3::Z],
            colors: [Vec3::ONE; 4],
            two_sided: false,
            visible: false,
            samples: 1,
        }],
        moving: [1, 3, 4].map(moving).into(),
        ..Lights::default()
    });
    let set = Scene::of(world, camera).lines(System::Motion, &InspectSettings::default());
    let orange = [1.0, 0.4, 0.02];
    // 2 m/s for half of the time: from 0.5 m on its way to 1.5 m.
    let way = [Vec3::X * 0.5, Vec3::X * 1.5];
    for middle in [Vec3::Y, Vec3::Y * 2.5, Vec3::new(0.5, 4.0, 0.5)] {
        expect(&set, middle + way[0], middle + way[1], orange);
    }
    for there in way {
        assert!(
            set.points
                .iter()
                .any(|dot| is_near(dot.at, Vec3::Y + there))
        );
        segment(&set, Vec3::Y * 2.0 + there, Vec3::Y * 3.0 + there);
        let corner = Vec3::Y * 4.0 + there;
        segment(&set, corner, corner + Vec3::X);
        segment(&set, corner + Vec3::X, corner + Vec3::X + Vec3::Z);
    }
    // Three ways, two ghosts of a segment and two of a parallelogram; the other point stands still.
    assert_eq!((set.segments.len(), set.points.len()), (3 + 2 + 8, 2));
}

#[test]
fn the_pattern_of_a_pixel_is_where_its_rays_are() {
    let mut scene = Scene::open("triangle", UVec2::new(8, 6));
    scene.settings.pixel = PixelSampling::Area;
    let pixel = UVec2::new(5, 2);
    let choice = PatternSettings::default();
    let found = pattern(
        &scene.world,
        &scene.settings,
        &choice,
        pixel,
        16,
        MOST_POINTS,
    );
    let rays = glassbox::trace::probe(
        &scene.world,
        &scene.camera,
        &scene.settings,
        pixel,
        &glassbox::trace::Samples::All,
    )
    .unwrap();
    let starts: Vec<_> = rays
        .rays
        .iter()
        .filter(|ray| ray.parent.is_none())
        .collect();
    for (point, ray) in found.points.iter().zip(starts) {
        let place = pixel.as_vec2() + *point;
        let expected = scene.camera.ray(place, scene.settings.size, [0.5; 2], 0.0);
        assert!(is_near(ray.direction, expected.direction), "{point}");
    }
}

#[test]
fn any_two_numbers_of_the_sequence_can_be_shown_and_each_pair_of_a_block_is_stratified() {
    let mut scene = Scene::open("cornell-box-parallelogram-light", UVec2::new(8, 8));
    scene.settings.features.glossy = true;
    let light = scene.world.lights.parallelograms[0].id;
    for (x, y) in [
        (Dimension::PixelX, Dimension::PixelY),
        (Dimension::LensU, Dimension::LensV),
        (Dimension::PixelX, Dimension::LensV),
        (Dimension::LightU, Dimension::LightV),
        (Dimension::GlossU, Dimension::GlossV),
    ] {
        let choice = PatternSettings {
            on: true,
            x,
            y,
            light,
        };
        let points = pattern(
            &scene.world,
            &scene.settings,
            &choice,
            UVec2::new(3, 4),
            256,
            MOST_POINTS,
        )
        .points;
        assert_eq!(points.len() % 256, 0, "{x:?} {y:?}");
        let mut columns = [0; 16];
        for point in &points[..256] {
            assert!(point.min_element() >= 0.0 && point.max_element() < 1.0);
            columns[(point.x * 16.0) as usize] += 1;
        }
        assert_eq!(columns, [16; 16], "{x:?} {y:?}");
    }
}
