//! Materials through files of models and back.

use super::app::{app, opened, write};
use super::models::objects;
use bevy::color::LinearRgba;
use bevy::ecs::name::Name;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use bevy::prelude::{App, Assets};
use bevy::transform::components::Transform;
use glassbox::io::save;
use glassbox::scene::*;

#[test]
fn an_obj_says_whether_a_material_mirrors_and_has_one_colour_for_it() {
    let color = LinearRgba::rgb(0.25, 0.5, 0.75);
    let other = LinearRgba::rgb(0.5, 0.5, 0.5);
    let none = LinearRgba::BLACK;
    for (written, read, noted) in [
        ((none, none), (none, none), ""),
        ((color, none), (color, none), ""),
        ((color, color), (color, color), ""),
        (
            (none, color),
            (color, color),
            "it has a highlight of the mirror's colour",
        ),
        (
            (color, other),
            (color, color),
            "its mirror has that of its highlight",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut first = app();
        first.world_mut().spawn((
            SceneId(1),
            Transform::default(),
            MeshSource::Shape(Shape::Cuboid { size: Vec3::ONE }),
            Phong {
                specular: written.0,
                mirror: written.1,
                ..Phong::default()
            },
        ));
        first.update();
        let file = folder.path().join("a.obj");
        let notes = save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
        let told = notes.lines();
        let is_told = match noted {
            "" => told.is_empty(),
            noted => told.len() == 1 && told[0].contains(noted),
        };
        assert!(is_told, "{written:?}: {told:?}");
        let (mut second, _) = opened(&file);
        let phong = &objects(second.world_mut())[0].1;
        assert_eq!((phong.specular, phong.mirror), read, "{written:?}");
    }
}

#[test]
fn an_obj_says_of_which_reflection_its_one_picture_is() {
    let white = LinearRgba::WHITE;
    let map = |path: &str| Some(TextureSource::new(path));
    for (specular, specular_map, mirror_map, read, noted) in [
        // What is black has no use for a picture.
        (
            LinearRgba::BLACK,
            map("builtin:uv"),
            None,
            None,
            "highlight of the mirror's",
        ),
        (
            LinearRgba::BLACK,
            None,
            map("builtin:uv"),
            map("a-texture0.png"),
            "highlight of the mirror's",
        ),
        (
            white,
            map("builtin:uv"),
            None,
            map("a-texture0.png"),
            "one picture",
        ),
        (white, None, map("builtin:uv"), None, "one picture"),
        (
            white,
            map("builtin:uv"),
            map("builtin:uv"),
            map("a-texture0.png"),
            "named so",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut first = app();
        let phong = Phong {
            specular,
            mirror: white,
            specular_map,
            mirror_map,
            ..Phong::default()
        };
        first.world_mut().spawn((
            SceneId(1),
            Transform::default(),
            MeshSource::default(),
            phong.clone(),
        ));
        first.update();
        let file = folder.path().join("a.obj");
        let notes = save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
        let told = notes.lines();
        assert!(told[0].contains(noted), "{phong:?}: {told:?}");
        let (mut second, _) = opened(&file);
        let found = &objects(second.world_mut())[0].1;
        let maps = (found.specular_map.clone(), found.mirror_map.clone());
        assert_eq!(maps, (read.clone(), read), "{phong:?}");
    }
}

#[test]
fn a_glb_keeps_cutoffs_samplers_normals_glow_and_the_colours_of_vertices() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = app();
    let source = |path: &str| TextureSource {
        wrap_u: Wrap::Mirror,
        wrap_v: Wrap::Clamp,
        filter: MapFilter::Linear,
        ..TextureSource::new(path)
    };
    let phong = Phong {
        diffuse: LinearRgba::rgb(0.25, 0.5, 1.0),
        specular: LinearRgba::rgb(0.5, 0.25, 0.125),
        mirror: LinearRgba::rgb(0.125, 0.25, 0.5),
        emission: LinearRgba::rgb(4.0, 2.0, 1.0),
        alpha: Alpha::Mask { cutoff: 0.375 },
        normal_scale: 0.75,
        diffuse_map: Some(source("builtin:checker")),
        emission_map: Some(TextureSource::new("builtin:uv")),
        normal_map: Some(TextureSource::new("builtin:uv")),
        specular_map: Some(TextureSource::new("builtin:uv")),
        ..Phong::default()
    };
    first.world_mut().spawn((
        SceneId(1),
        Name::new("box"),
        Transform::default(),
        MeshSource::Shape(Shape::Cuboid { size: Vec3::ONE }),
        phong.clone(),
    ));
    first.update();
    // An app of ours paints its vertices.
    let painted = |app: &mut App| {
        let world = app.world_mut();
        let mut objects = world.query::<&Mesh3d>();
        objects.iter(world).next().unwrap().0.clone()
    };
    let handle = painted(&mut first);
    let mut meshes = first.world_mut().resource_mut::<Assets<Mesh>>();
    let mut mesh = meshes.get_mut(&handle).unwrap();
    let count = mesh.count_vertices();
    let colors: Vec<[f32; 4]> = (0..count)
        .map(|i| [0.5, i as f32 / count as f32, 1.0, 0.75])
        .collect();
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors.clone());
    drop(mesh);
    let file = folder.path().join("a.glb");
    let notes = save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    let notes = notes.lines();
    assert!(
        notes.len() == 1 && notes[0].contains("the specular map of the material `box`; left out"),
        "{notes:?}"
    );
    let (mut second, opened) = opened(&file);
    let told = opened.notes.lines();
    assert!(
        told.iter()
            .all(|line| line.contains("was added") || line.contains("were added")),
        "{told:?}"
    );
    let found = objects(second.world_mut())[0].1.clone();
    // Pictures are numbered as they are met.
    let expected = Phong {
        diffuse_map: Some(source("a.glb#texture0")),
        emission_map: Some(TextureSource::new("a.glb#texture1")),
        normal_map: Some(TextureSource::new("a.glb#texture2")),
        opacity_map: Some(source("a.glb#texture0.alpha")),
        specular_map: None,
        ..phong
    };
    assert_eq!(found, expected);
    let handle = painted(&mut second);
    let meshes = second.world().resource::<Assets<Mesh>>();
    let read = meshes
        .get(&handle)
        .unwrap()
        .attribute(Mesh::ATTRIBUTE_COLOR);
    let Some(VertexAttributeValues::Float32x4(read)) = read else {
        panic!("no colours");
    };
    assert_eq!(*read, colors);
}

#[test]
fn an_obj_keeps_its_pictures_their_clamping_and_the_colours_of_vertices() {
    let folder = tempfile::tempdir().unwrap();
    glassbox::io::write_picture(&folder.path().join("a.png"), 2, 1, &[[0.5; 3], [1.0; 3]]).unwrap();
    let mtl = "newmtl m\nKd 1 0.5 0.25\nKs 0.1 0.2 0.3\nNs 20\nillum 3\nKe 1 2 3\nmap_Kd -clamp on a.png\n\
               map_Ks a.png\nmap_Ke a.png\nnorm -bm 0.5 a.png\n";
    write(folder.path(), "m.mtl", mtl);
    let obj = "mtllib m.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0 0 0 0.25\nvt 0 0\nvt 1 0\nvt 0 1\n\
               usemtl m\nf 1/1 2/2 3/3\n";
    let (mut first, _) = opened(&write(folder.path(), "m.obj", obj));
    let before = objects(first.world_mut());
    let file = folder.path().join("again.obj");
    save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    let (mut second, _) = opened(&file);
    let after = objects(second.world_mut());
    assert_eq!(after[0].1, before[0].1);
    let colors = |app: &mut App| {
        let world = app.world_mut();
        let mut meshes = world.query::<&Mesh3d>();
        let handle = meshes.iter(world).next().unwrap().0.clone();
        let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
        match mesh.attribute(Mesh::ATTRIBUTE_COLOR) {
            Some(VertexAttributeValues::Float32x4(colors)) => colors.clone(),
            other => panic!("{other:?}"),
        }
    };
    for (before, after) in colors(&mut first).iter().zip(colors(&mut second)) {
        // Encoded for the file and decoded again.
        let off = (0..4).map(|i| (before[i] - after[i]).abs());
        assert!(off.fold(0.0, f32::max) < 1e-6, "{before:?}, {after:?}");
    }
}

#[test]
fn a_picture_under_black_does_not_shine_through_an_obj() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = app();
    let object = |id, red| {
        (
            SceneId(id),
            Name::new(format!("{id}")),
            Transform::default(),
            MeshSource::default(),
            Phong {
                diffuse: LinearRgba::rgb(red, 0.0, 0.0),
                diffuse_map: Some(TextureSource::new("builtin:uv")),
                ..Phong::default()
            },
        )
    };
    first.world_mut().spawn(object(1, 0.0));
    first.world_mut().spawn(object(2, 0.5));
    first.update();
    let file = folder.path().join("a.obj");
    let notes = save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    let notes = notes.lines();
    let is_told = |line: &&String| line.contains("black colour hides") && line.contains("`1`;");
    assert_eq!(notes.iter().filter(is_told).count(), 1, "{notes:?}");
    let (mut second, _) = opened(&file);
    let read = objects(second.world_mut());
    let of = |i: usize| (read[i].1.diffuse.red, read[i].1.diffuse_map.is_some());
    assert_eq!([of(0), of(1)], [(0.0, false), (0.5, true)]);
}
