//! What the built-in scenes hold.

use super::*;
use crate::io::shapes;
use crate::scene::{
    DirectionalLamp, Environment, MeshSource, ParallelogramLamp, Phong, PhongMap, PointLamp,
    RenderSettings, SceneCamera, SceneId, SegmentLamp, Shape, TextureSource,
};
use bevy::ecs::entity::Entity;
use bevy::ecs::name::Name;
use bevy::ecs::query::With;
use bevy::math::Vec3;
use bevy::transform::components::Transform;
use std::collections::HashSet;

fn spawned(scene: &BuiltinScene) -> World {
    let mut world = World::new();
    (scene.spawn)(&mut world);
    world
}

fn count<C: bevy::ecs::component::Component>(world: &mut World) -> usize {
    world
        .query_filtered::<Entity, With<C>>()
        .iter(world)
        .count()
}

#[test]
fn scenes_have_the_listed_triangles_objects_and_lights() {
    // Name, triangles, objects, [point, directional, segment, parallelogram] lights, cameras.
    let listed = [
        ("triangle", 1, 1, [1, 0, 0, 0], 1),
        ("cube-segment-light", 14, 2, [0, 0, 1, 0], 1),
        ("textured-cube", 14, 2, [0, 1, 0, 1], 1),
        ("cornell-box", 36, 8, [1, 0, 0, 0], 1),
        ("cornell-box-parallelogram-light", 34, 7, [0, 0, 0, 1], 1),
        ("head", 1_008, 1, [3, 0, 0, 0], 1),
        ("teapot", 16_258, 2, [0, 1, 0, 1], 1),
        ("knot", 87_042, 2, [0, 1, 0, 1], 1),
        ("spheres", 96_770, 9, [0, 1, 0, 1], 1),
        ("marbles", 23_810, 7, [0, 1, 0, 1], 1),
        ("showcase", 87_694, 8, [1, 1, 1, 1], 2),
    ];
    assert_eq!(SCENES.len(), listed.len());
    for (scene, (name, triangles, objects, lights, cameras)) in SCENES.iter().zip(listed) {
        assert_eq!(scene.name, name);
        let mut world = spawned(scene);
        let mut total = 0;
        for mesh in world.query::<&MeshSource>().iter(&world) {
            let MeshSource::Shape(shape) = mesh else {
                panic!("{name} needs a file");
            };
            total += shapes::triangle_count(shape).unwrap();
        }
        assert_eq!(total, triangles, "triangles of {name}");
        assert_eq!(
            count::<MeshSource>(&mut world),
            objects,
            "objects of {name}"
        );
        let found = [
            count::<PointLamp>(&mut world),
            count::<DirectionalLamp>(&mut world),
            count::<SegmentLamp>(&mut world),
            count::<ParallelogramLamp>(&mut world),
        ];
        assert_eq!(found, lights, "lights of {name}");
        assert_eq!(
            count::<SceneCamera>(&mut world),
            cameras,
            "cameras of {name}"
        );
    }
}

#[test]
fn entities_are_named_and_numbered_from_one_without_gaps() {
    for scene in SCENES {
        let mut world = spawned(scene);
        let mut ids = Vec::new();
        let mut names = HashSet::new();
        for (id, name) in world.query::<(&SceneId, &Name)>().iter(&world) {
            ids.push(id.0);
            assert!(
                names.insert(name.to_string()),
                "{}: two are called {name}",
                scene.name
            );
        }
        ids.sort_unstable();
        let expected: Vec<u64> = (1..=count::<SceneId>(&mut world) as u64).collect();
        assert_eq!(ids, expected, "{}", scene.name);
    }
}

#[test]
fn every_mesh_and_picture_can_be_made_and_every_place_is_finite() {
    for scene in SCENES {
        let mut world = spawned(scene);
        for mesh in world.query::<&MeshSource>().iter(&world) {
            let MeshSource::Shape(shape) = mesh else {
                panic!("{} needs a file", scene.name);
            };
            shapes::mesh(shape).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        }
        let mut sources: Vec<TextureSource> = Vec::new();
        for phong in world.query::<&Phong>().iter(&world) {
            sources.extend(
                PhongMap::ALL
                    .iter()
                    .filter_map(|map| map.source(phong).cloned()),
            );
        }
        sources.extend(world.resource::<Environment>().map.clone());
        for source in sources {
            shapes::texture(&source.path).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        }
        for (name, transform) in world.query::<(&Name, &Transform)>().iter(&world) {
            let matrix = transform.to_matrix();
            assert!(
                matrix.is_finite(),
                "{}: {name} stands at {matrix}",
                scene.name
            );
        }
    }
}

#[test]
fn the_walls_of_cornells_box_face_its_middle_and_its_light_faces_down() {
    let mut world = spawned(find("cornell-box-parallelogram-light").unwrap());
    let middle = Vec3::new(0.0, 0.274, 0.0);
    for (name, mesh) in world.query::<(&Name, &MeshSource)>().iter(&world) {
        if let MeshSource::Shape(Shape::Quadrilateral {
            corners: [a, b, c, d],
        }) = *mesh
        {
            let normal = (c - a).cross(d - b);
            let inwards = normal.normalize().dot((middle - a).normalize());
            assert!(inwards > 0.3, "{name} faces {normal}, {inwards:.2} inwards");
        }
    }
    let lamp = world.query::<&ParallelogramLamp>().single(&world).unwrap();
    let area = lamp.edges[0].cross(lamp.edges[1]);
    let published = Vec3::NEG_Y * 0.130 * 0.105;
    assert!((area - published).length() < 1e-6, "{area}");
}

#[test]
fn settings_are_within_their_ranges() {
    for scene in SCENES {
        let world = spawned(scene);
        let settings = world.resource::<RenderSettings>();
        assert!(settings.size.min_element() >= 1 && settings.size.max_element() <= 4096);
        assert!(
            (1..=256).contains(&settings.spp),
            "{}: {} spp",
            scene.name,
            settings.spp
        );
    }
}

#[test]
fn scenes_are_found_by_their_names_alone() {
    for scene in SCENES {
        assert!(find(scene.name).is_some_and(|found| found.name == scene.name));
    }
    assert!(find(DEFAULT).is_some());
    assert!(find("cornell").is_none());
}

#[test]
fn a_new_scene_shows_a_lit_cube_on_a_floor_and_its_shadow() {
    let mut app = crate::app::headless_app();
    crate::io::open_new(app.world_mut());
    app.update();
    let world = app.world_mut();
    let mut names: Vec<String> = world
        .query::<&Name>()
        .iter(world)
        .map(ToString::to_string)
        .collect();
    names.sort();
    assert_eq!(names, ["Camera", "Cube", "Floor", "Lamp"]);
    let traced = world.resource::<crate::sync::Traced>();
    let cameras = world.resource::<crate::sync::TracedCameras>();
    let mut settings = world.resource::<RenderSettings>().clone();
    settings.size = bevy::math::UVec2::splat(48);
    let camera = &cameras.0[0].camera;
    let picture = crate::film::render(&traced.world, camera, &settings, &|_, _| {}).picture;
    let lightness = |pixel: &Vec3| pixel.element_sum() / 3.0;
    let part = |is: fn(f32) -> bool| {
        let pixels = picture.pixels.iter().map(lightness);
        pixels.filter(|&lightness| is(lightness)).count() as f32 / picture.pixels.len() as f32
    };
    let lit = part(|lightness| lightness > 0.2);
    assert!(lit > 0.15, "{lit} of it is lit");
    let black = part(|lightness| lightness < 0.01);
    assert!(black < 0.01, "{black} of it is black");
    let dark = part(|lightness| lightness < 0.11);
    assert!(dark > 0.02, "{dark} of it is in the shadow");
    let white = part(|lightness| lightness > 1.0);
    assert!(white < 0.1, "{white} of it is washed out");
}
