//! What a model file cannot say of a scene is told when it is written.

use super::app::app;
use bevy::asset::Assets;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::name::Name;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::prelude::World;
use bevy::transform::components::Transform;
use glassbox::io::save;
use glassbox::scene::*;

/// A scene with something of everything that not every format has.
fn scene(world: &mut World) {
    let parent = world.spawn((SceneId(1), Transform::default())).id();
    let cube = MeshSource::Shape(Shape::Cuboid { size: Vec3::ONE });
    world.spawn((
        SceneId(2),
        Name::new("cube"),
        ChildOf(parent),
        cube,
        Motion::default(),
    ));
    for id in 3..6 {
        world.spawn((SceneId(id), SegmentLamp::default()));
    }
    let soft = DirectionalLamp {
        angular_diameter: 1.0,
        ..DirectionalLamp::default()
    };
    world.spawn((SceneId(6), Name::new("sky"), soft));
    world.spawn((SceneId(7), SceneCamera::default(), Lens::default()));
    world.resource_mut::<Environment>().intensity = 2.0;
    world.resource_mut::<RenderSettings>().output.exposure = 1.0;
}

#[test]
fn each_kind_of_thing_that_a_format_cannot_say_is_one_note_with_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let both = [
        ("segment lights; left out (3 times)", 3),
        ("motions; left out", 1),
        ("lenses; left out", 1),
        ("the render settings; left out", 1),
    ];
    let of_obj = [
        ("the environment; left out", 1),
        ("point and directional lights; left out", 1),
        ("cameras; left out", 1),
        ("objects below others; written where they stand", 1),
    ];
    let of_glb = [("an angular diameter of the light `sky`; left out", 1)];
    for (name, own) in [
        ("a.obj", &of_obj[..]),
        ("a.glb", &of_glb),
        ("a.scn.ron", &[]),
    ] {
        let mut app = app();
        scene(app.world_mut());
        app.update();
        let file = folder.path().join(name);
        let notes = save(app.world_mut(), &file).unwrap();
        let expected: Vec<_> = match name {
            "a.scn.ron" => Vec::new(),
            _ => both.iter().chain(own).collect(),
        };
        for (text, count) in &expected {
            let line = format!("{}: {text}", file.display());
            let is_it = |note: &&_| ToString::to_string(*note).starts_with(&line);
            let said: Vec<_> = notes.iter().filter(is_it).collect();
            assert_eq!(said.len(), 1, "{line} in {:#?}", notes.lines());
            assert_eq!(said[0].count, *count, "{line}");
        }
        assert_eq!(notes.len(), expected.len(), "{:#?}", notes.lines());
    }
}

#[test]
fn vertex_colours_come_back_from_what_was_exported() {
    let folder = tempfile::tempdir().unwrap();
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\no leaf\nf 1 2 3\n";
    let file = super::app::write(folder.path(), "a.obj", text);
    let colors = |file: &std::path::Path| {
        let (mut app, _) = super::app::opened(file);
        let world = app.world_mut();
        let mut meshes = world.query::<&Mesh3d>();
        let handle = meshes.single(world).unwrap().0.clone();
        let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
        let colors = format!("{:?}", mesh.attribute(Mesh::ATTRIBUTE_COLOR).unwrap());
        (app, colors)
    };
    let (mut app, before) = colors(&file);
    for name in ["b.obj", "b.glb"] {
        let file = folder.path().join(name);
        let notes = save(app.world_mut(), &file).unwrap().lines();
        let is_it = |line: &String| line.contains("colours");
        assert!(!notes.iter().any(is_it), "{name}: {notes:?}");
        assert_eq!(colors(&file).1, before, "{name}");
    }
}

#[test]
fn the_colours_of_what_glows_are_noted_as_they_are_seen_here_alone() {
    let folder = tempfile::tempdir().unwrap();
    let text =
        "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nusemtl a\no leaf\nf 1 2 3\n";
    let file = super::app::write(folder.path(), "a.obj", text);
    for (diffuse, glow, times) in [
        ("0 0 0", "1 1 1", 1),
        ("0.5 0 0", "1 1 1", 0),
        ("0 0 0", "0 0 0", 0),
    ] {
        let material = format!("newmtl a\nKd {diffuse}\nKe {glow}\n");
        super::app::write(folder.path(), "a.mtl", material);
        let (mut app, _) = super::app::opened(&file);
        for name in ["b.obj", "b.glb"] {
            let notes = save(app.world_mut(), &folder.path().join(name))
                .unwrap()
                .lines();
            let is_it =
                |line: &&String| line.contains("which other programs do not show, of `leaf`");
            let said = notes.iter().filter(is_it).count();
            assert_eq!(said, times, "{name}, Kd {diffuse}, Ke {glow}: {notes:?}");
        }
    }
}
