use super::app::{app, opened, triangles, write};
use bevy::camera::visibility::Visibility;
use bevy::color::LinearRgba;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::name::Name;
use bevy::math::{Quat, Vec3};
use bevy::mesh::Mesh3d;
use bevy::prelude::{Entity, World};
use bevy::transform::components::Transform;
use glassbox::io::{SceneFiles, save};
use glassbox::scene::*;
use std::path::Path;

/// Name, material and triangles of an object.
type Object = (String, Phong, Vec<[[f32; 3]; 3]>);

/// Every object, sorted by name.
pub fn objects(world: &mut World) -> Vec<Object> {
    let mut query = world.query::<(Entity, &Name, Option<&UsesMaterial>, &Phong, &Mesh3d)>();
    let all: Vec<_> = query
        .iter(world)
        .map(|(e, name, shared, own, _)| (e, name.to_string(), shared.copied(), own.clone()))
        .collect();
    let mut objects: Vec<_> = all
        .into_iter()
        .map(|(entity, name, shared, own)| {
            let shared = shared.and_then(|UsesMaterial(m)| world.get::<Phong>(m).cloned());
            (name, shared.unwrap_or(own), triangles(world, entity))
        })
        .collect();
    objects.sort_by(|a, b| a.0.cmp(&b.0));
    objects
}

fn textured_model(folder: &Path) -> std::path::PathBuf {
    glassbox::io::write_picture(&folder.join("a.png"), 2, 1, &[[0.5; 3], [1.0; 3]]).unwrap();
    let mtl = "newmtl red\nKd 1 0.5 0.25\nKs 0.1 0.2 0.3\nNs 20\nd 0.75\nKe 1 2 3\nmap_Kd a.png\n\
               newmtl blue\nKd 0 0 1\n";
    write(folder, "box.mtl", mtl);
    let obj = "mtllib box.mtl\no first\n\
               v 0.1 0.2 0.3\nv 1.7 0 0\nv 1 1e-7 0\nv 0 1 3e8\nvt 0 0.5\nvt 1 0.25\nvn 0 0.6 0.8\n\
               usemtl red\nf 1/1/1 2/2/1 3/1/1 4/2/1\nusemtl blue\nf 1/1/1 2/1/1 4/1/1\n\
               o second\nusemtl red\nf 3/1/1 2/2/1 1/1/1\n";
    write(folder, "box.obj", obj)
}

#[test]
fn a_model_whose_name_says_another_kind_is_read_as_what_it_holds() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let (mut source, _) = opened(&write(folder.path(), "a.obj", obj));
    let glb = folder.path().join("a.glb");
    save(source.world_mut(), &glb).unwrap_or_else(|error| panic!("{error}"));
    let glb = std::fs::read(glb).unwrap();
    let gltf = br#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "nodes":[{"mesh":0}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:,"#;
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes = corners.iter().flat_map(|number| number.to_le_bytes());
    let escaped: String = bytes.map(|byte| format!("%{byte:02x}")).collect();
    let gltf = [&gltf[..], escaped.as_bytes(), b"\"}]}"].concat();
    let ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 1 0 0 0 1 0 3 0 1 2\n";
    let stl =
        b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid a\n";
    for (content, kind, names) in [
        (&glb[..], "glb", &["b.obj", "b.stl", "b.ply"][..]),
        (&gltf, "gltf", &["b.obj", "b.ply"]),
        (ply, "ply", &["b.obj", "b.stl", "b.gltf", "b.glb"]),
        (stl, "stl", &["b.obj", "b.ply", "b.gltf", "b.glb"]),
    ] {
        for name in names {
            let (mut app, opened) = opened(&write(folder.path(), name, content));
            assert_eq!(objects(app.world_mut())[0].2.len(), 1, "{kind} as {name}");
            let told = opened.notes.lines();
            let held = format!("the content of a .{kind}");
            let count = told.iter().filter(|note| note.contains(&held)).count();
            assert_eq!(count, 1, "{kind} as {name}: {told:?}");
        }
    }
}

#[test]
fn an_obj_that_goes_through_a_scene_file_and_back_keeps_its_objects() {
    let folder = tempfile::tempdir().unwrap();
    let (mut first, _) = opened(&textured_model(folder.path()));
    let before = objects(first.world_mut());
    assert_eq!(before.len(), 3);
    let scene = folder.path().join("scene.scn.ron");
    save(first.world_mut(), &scene).unwrap_or_else(|error| panic!("{error}"));
    let (mut second, _) = opened(&scene);
    assert_eq!(objects(second.world_mut()), before, "after the scene file");
    let again = folder.path().join("again.obj");
    let notes = save(second.world_mut(), &again).unwrap_or_else(|error| panic!("{error}"));
    assert!(
        notes.lines().iter().any(|note| note.contains("camera")),
        "{notes:?}"
    );
    let (mut third, _) = opened(&again);
    assert_eq!(objects(third.world_mut()), before, "after the second OBJ");
}

#[test]
fn a_scene_written_elsewhere_names_its_files_from_there() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    let (mut first, _) = opened(&textured_model(&inner));
    let before: Vec<_> = objects(first.world_mut())
        .into_iter()
        .map(|o| o.2)
        .collect();
    let scene = folder.path().join("scene.scn.ron");
    let notes = save(first.world_mut(), &scene).unwrap();
    assert!(notes.is_empty(), "{notes:?}");
    let (mut second, _) = opened(&scene);
    let after: Vec<_> = objects(second.world_mut())
        .into_iter()
        .map(|o| o.2)
        .collect();
    assert_eq!(after, before);
    let outside = tempfile::tempdir().unwrap();
    let notes = save(first.world_mut(), &outside.path().join("scene.scn.ron")).unwrap();
    assert!(
        notes
            .lines()
            .iter()
            .any(|note| note.contains("--allow-outside")),
        "{notes:?}"
    );
}

/// A hierarchy with everything that glTF can say.
fn hierarchy(world: &mut World) {
    let material = world
        .spawn((
            SceneId(1),
            Name::new("gold"),
            Phong {
                diffuse: LinearRgba::rgb(0.1, 0.2, 1.0 / 3.0),
                specular: LinearRgba::rgb(0.7, 0.6, 0.5),
                mirror: LinearRgba::rgb(0.2, 0.3, 0.25),
                shininess: 77.7,
                opacity: 0.3,
                emission: LinearRgba::rgb(5.0, 0.0, 0.1),
                diffuse_map: Some(TextureSource::new("builtin:checker")),
                ..Phong::default()
            },
        ))
        .id();
    let parent = world
        .spawn((
            SceneId(2),
            Name::new("parent"),
            Transform::from_xyz(1.0, 2.0, 3.0).with_rotation(Quat::from_rotation_x(0.3)),
            Visibility::default(),
        ))
        .id();
    for (id, shape) in [
        (3, Shape::Cuboid { size: Vec3::ONE }),
        (4, Shape::Teapot { divisions: 2 }),
    ] {
        world.spawn((
            SceneId(id),
            Name::new(format!("object {id}")),
            ChildOf(parent),
            UsesMaterial(material),
            Transform::from_scale(Vec3::splat(0.1 * id as f32)),
            MeshSource::Shape(shape),
        ));
    }
    let cone = Some(Cone {
        inner: 0.1,
        outer: 0.2,
    });
    world.spawn((
        SceneId(5),
        Name::new("spot"),
        PointLamp {
            intensity: 12.5,
            cone,
            ..Default::default()
        },
    ));
    world.spawn((
        SceneId(6),
        Name::new("sun"),
        DirectionalLamp {
            intensity: 3.0,
            ..Default::default()
        },
    ));
    world.spawn((
        SceneId(7),
        Name::new("eye"),
        SceneCamera::default(),
        Transform::from_xyz(0.0, 0.0, 5.0),
    ));
    world.spawn((SceneId(8), Name::new("area"), ParallelogramLamp::default()));
    world.spawn((
        SceneId(9),
        Name::new("ghost"),
        MeshSource::default(),
        Visibility::Hidden,
    ));
}

fn named(world: &mut World, name: &str) -> Entity {
    let mut query = world.query::<(Entity, &Name)>();
    let mut found = query
        .iter(world)
        .filter(|(_, other)| other.as_str() == name);
    found
        .next()
        .unwrap_or_else(|| panic!("nothing is called {name}"))
        .0
}

#[test]
fn a_glb_gives_back_the_same_triangles_places_materials_lights_and_cameras() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = app();
    hierarchy(first.world_mut());
    first.update();
    let file = folder.path().join("a.glb");
    let notes = save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    let said = |what: &str| notes.lines().iter().any(|note| note.contains(what));
    assert!(
        said("parallelogram lights; left out") && said("hidden objects; left out"),
        "{notes:?}"
    );
    let (mut second, opened) = opened(&file);
    // All there is lies above what the camera sees.
    let notes: Vec<_> = opened.notes.iter().map(|note| note.what.as_str()).collect();
    assert_eq!(notes, ["has a camera that looks past everything"]);
    let (a, b) = (first.world_mut(), second.world_mut());
    for name in ["object 3", "object 4"] {
        let (x, y) = (named(a, name), named(b, name));
        assert_eq!(triangles(a, x), triangles(b, y), "{name}");
        assert_eq!(a.get::<Transform>(x), b.get::<Transform>(y), "{name}");
        let parent = b.get::<ChildOf>(y).map(|child| child.0);
        assert_eq!(parent, Some(named(b, "parent")));
    }
    let (x, y) = (named(a, "parent"), named(b, "parent"));
    assert_eq!(a.get::<Transform>(x), b.get::<Transform>(y));
    let (x, y) = (named(a, "gold"), named(b, "gold"));
    let expected = Phong {
        diffuse_map: Some(TextureSource::new("a.glb#texture0")),
        // Its alpha channel stands for opacity because the material is blended.
        opacity_map: Some(TextureSource::new("a.glb#texture0.alpha")),
        ..a.get::<Phong>(x).cloned().unwrap()
    };
    assert_eq!(b.get::<Phong>(y), Some(&expected));
    let close = |x: f32, y: f32| (x - y).abs() <= 1e-6 * x;
    let spot = named(b, "spot");
    let spot = b.get::<PointLamp>(spot).cloned().unwrap_or_default();
    assert!(close(12.5, spot.intensity), "{}", spot.intensity);
    assert_eq!(
        spot.cone.map(|cone| [cone.inner, cone.outer]),
        Some([0.1, 0.2])
    );
    let sun = named(b, "sun");
    let sun = b.get::<DirectionalLamp>(sun).map(|lamp| lamp.intensity);
    assert!(sun.is_some_and(|sun| close(3.0, sun)), "{sun:?}");
    let eye = named(b, "eye");
    assert_eq!(b.get::<SceneCamera>(eye), Some(&SceneCamera::default()));
}

#[test]
fn an_obj_holds_the_places_of_objects_and_a_mirrored_one_still_faces_outwards() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = app();
    let parent = first
        .world_mut()
        .spawn((SceneId(1), Transform::from_xyz(10.0, 0.0, 0.0)))
        .id();
    first.world_mut().spawn((
        SceneId(2),
        Name::new("box"),
        ChildOf(parent),
        Transform::from_scale(Vec3::new(-1.0, 2.0, 1.0)),
        MeshSource::Shape(Shape::Cuboid { size: Vec3::ONE }),
    ));
    first.update();
    let file = folder.path().join("a.obj");
    save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    let (mut second, _) = opened(&file);
    let objects = objects(second.world_mut());
    let centre = Vec3::new(10.0, 0.0, 0.0);
    for triangle in &objects[0].2 {
        let [a, b, c] = triangle.map(Vec3::from);
        let normal = (b - a).cross(c - a);
        let outwards = normal.dot((a + b + c) / 3.0 - centre);
        assert!(outwards > 0.0, "{triangle:?} faces inwards: {outwards}");
    }
    let heights = objects[0].2.as_flattened().iter().map(|corner| corner[1]);
    assert_eq!(heights.fold(f32::MIN, f32::max), 1.0);
}

#[test]
fn a_generated_picture_goes_into_an_obj_as_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = app();
    hierarchy(first.world_mut());
    first.update();
    let file = folder.path().join("a.obj");
    let notes = save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    assert!(
        notes
            .lines()
            .iter()
            .any(|note| note.contains("a-texture0.png")),
        "{notes:?}"
    );
    let (mut second, _) = opened(&file);
    let objects = objects(second.world_mut());
    assert_eq!(objects.len(), 2);
    let map = objects[0]
        .1
        .diffuse_map
        .as_ref()
        .map(|map| map.path.as_str());
    assert_eq!(map, Some("a-texture0.png"));
    let files = second.world().resource::<SceneFiles>();
    assert_eq!(files.folder.path, folder.path());
}

#[test]
fn a_picture_that_an_obj_brings_along_replaces_none_that_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // One that the scene itself reads, and one that has nothing to do with it.
    for name in ["c-texture0.png", "c-texture1.png"] {
        glassbox::io::write_picture(&at(name), 2, 1, &[[0.5; 3], [1.0; 3]]).unwrap();
    }
    let kept = std::fs::read(at("c-texture0.png")).unwrap();
    write(
        folder.path(),
        "box.mtl",
        "newmtl one\nmap_Kd c-texture0.png\nnewmtl two\nKd 0 0 1\n",
    );
    let obj = "mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl one\nf 1 2 3\n\
               usemtl two\nf 3 2 1\n";
    let (mut app, _) = opened(&write(folder.path(), "box.obj", obj));
    let world = app.world_mut();
    let mut materials = world.query::<&mut Phong>();
    for mut phong in materials.iter_mut(world) {
        if phong.diffuse_map.is_none() {
            phong.diffuse_map = Some(TextureSource::new("builtin:uv"));
        }
    }
    app.update();
    let notes = save(app.world_mut(), &at("c.obj")).unwrap_or_else(|error| panic!("{error}"));
    for name in ["c-texture0.png", "c-texture1.png"] {
        assert_eq!(std::fs::read(at(name)).unwrap(), kept, "{name}");
    }
    let mtl = std::fs::read_to_string(at("c.mtl")).unwrap();
    for name in ["c-texture0.png", "c-texture2.png"] {
        assert!(mtl.contains(name), "{mtl}{notes:?}");
    }
    // Exporting again replaces what was exported before.
    save(app.world_mut(), &at("c.obj")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(std::fs::read(at("c-texture1.png")).unwrap(), kept);
    assert!(!at("c-texture3.png").exists());
}

#[test]
fn a_large_object_is_read_in_parts_and_is_one_mesh() {
    use std::fmt::Write;
    let folder = tempfile::tempdir().unwrap();
    // More faces than a part has: strips of a fan around the first vertex.
    let count = (1 << 20) + 1000;
    let mut text = String::from("o fan\nv 0 0 0\n");
    for i in 0..1001 {
        let _ = writeln!(text, "v 1 {i} 0");
    }
    for i in 0..count {
        let _ = writeln!(text, "f 1 {} {}", i % 1000 + 2, i % 1000 + 3);
    }
    let file = write(folder.path(), "a.obj", text);
    let (mut app, _) = opened(&file);
    let world = app.world_mut();
    let fan = named(world, "fan");
    let triangles = triangles(world, fan);
    assert_eq!(triangles.len(), count);
    for i in [0, 999, 1 << 20, count - 1] {
        let y = (i % 1000) as f32;
        assert_eq!(
            triangles[i],
            [[0.0; 3], [1.0, y, 0.0], [1.0, y + 1.0, 0.0]],
            "{i}"
        );
    }
}
