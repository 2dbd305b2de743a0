//! One budget for all that a scene holds: what is allowed one by one is refused together, before it is made.

use super::{refused_with, says};
use crate::files::app::{app, write};
use bevy::prelude::World;
use glassbox::io::{
    Budget, FileError, Limits, LoadProblems, OpenOptions, SceneSource, check_film, import, open,
};
use glassbox::scene::{MeshSource, SceneId, Shape};
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

fn within(megabytes: u64) -> OpenOptions {
    OpenOptions {
        limits: Limits {
            memory: Budget::of(megabytes << 20),
            ..Limits::default()
        },
        ..OpenOptions::default()
    }
}

fn opens(file: &Path, options: OpenOptions) -> Result<(), FileError> {
    open(app().world_mut(), &SceneSource::named(file), options).map(|_| ())
}

/// Refused with so much memory, and opened with so much.
fn needs_between(file: &Path, too_little: u64, enough: u64) {
    says(&refused_with(file, within(too_little)), &["--memory", "MB"]);
    if let Err(error) = opens(file, within(enough)) {
        panic!("{enough} MB are not enough: {error}");
    }
}

fn scene(folder: &Path, entities: &str) -> std::path::PathBuf {
    let text =
        format!("(resources: {{\"glassbox::io::FileVersion\": (1)}}, entities: {{{entities}}})");
    write(folder, "a.scn.ron", text)
}

#[test]
fn pictures_that_are_allowed_one_by_one_are_refused_together() {
    let folder = tempfile::tempdir().unwrap();
    let mut mtl = String::new();
    let mut obj = String::from("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for i in 0..5 {
        let picture = image::RgbImage::from_pixel(1000, 1000, image::Rgb([i as u8; 3]));
        picture
            .save(folder.path().join(format!("{i}.png")))
            .unwrap();
        writeln!(mtl, "newmtl m{i}\nmap_Kd {i}.png").unwrap();
        writeln!(obj, "usemtl m{i}\nf 1 2 3").unwrap();
    }
    write(folder.path(), "a.mtl", mtl);
    let file = write(folder.path(), "a.obj", obj);
    says(
        &refused_with(&file, within(40)),
        &["3.png", "11 MB", "--memory"],
    );
    needs_between(&file, 50, 70);
}

/// As many triangles, each with a material of its own, that say all the same.
fn obj_of_materials(folder: &Path, count: usize, says: &str) -> PathBuf {
    let mut mtl = String::new();
    let mut obj = String::from("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    for i in 0..count {
        writeln!(mtl, "newmtl m{i}\n{says}").unwrap();
        writeln!(obj, "usemtl m{i}\nf 1 2 3").unwrap();
    }
    write(folder, "a.mtl", mtl);
    write(folder, "a.obj", obj)
}

/// The same with metalness and roughness in the one picture, `a.png`.
fn gltf_of_materials(folder: &Path, count: usize) -> PathBuf {
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bytes = corners.as_flattened().iter().flat_map(|n| n.to_le_bytes());
    write(folder, "a.bin", bytes.collect::<Vec<u8>>());
    let of_each = |each: &dyn Fn(usize) -> serde_json::Value| (0..count).map(each).collect();
    let textures: Vec<_> = of_each(&|_| json!({ "source": 0 }));
    let materials: Vec<_> = of_each(
        &|i| json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": i } } }),
    );
    let primitives: Vec<_> =
        of_each(&|i| json!({ "attributes": { "POSITION": 0 }, "material": i }));
    let document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": "a.bin", "byteLength": 36 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [1, 1, 0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": primitives }],
        "images": [{ "uri": "a.png" }],
        "textures": textures,
        "materials": materials,
    });
    write(folder, "a.gltf", document.to_string())
}

/// Pixels that are normals on the whole, not all of them opaque: 12 MB of them.
fn megapixel(file: &Path) {
    let picture = image::RgbaImage::from_pixel(1000, 1000, image::Rgba([128, 128, 255, 200]));
    picture.save(file).unwrap();
}

#[test]
fn a_picture_that_many_materials_share_counts_once_however_often_it_is_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    megapixel(&folder.path().join("a.png"));
    let obj = obj_of_materials(folder.path(), 60, "map_d a.png\nmap_Bump a.png");
    // Its alpha, and its normals.
    needs_between(&obj, 20, 30);
    let gltf = gltf_of_materials(folder.path(), 60);
    needs_between(&gltf, 10, 20);
}

#[test]
fn a_picture_that_does_not_fit_is_not_taken_for_one_that_says_nothing() {
    let folder = tempfile::tempdir().unwrap();
    megapixel(&folder.path().join("a.png"));
    for says_of in ["map_Bump a.png", "map_d a.png"] {
        let obj = obj_of_materials(folder.path(), 1, says_of);
        let error = refused_with(&obj, within(10));
        says(&error, &["a.png", "11 MB", "--memory"]);
    }
    let gltf = gltf_of_materials(folder.path(), 1);
    says(&refused_with(&gltf, within(10)), &["a.png", "--memory"]);
}

#[test]
fn what_a_gltf_can_do_without_is_not_left_out_for_want_of_memory() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.bin", vec![0; 36]);
    write(folder.path(), "normals.bin", vec![0; 4 << 20]);
    let document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "uri": "a.bin", "byteLength": 36 },
            { "uri": "normals.bin", "byteLength": 4 << 20 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }, { "buffer": 1, "byteLength": 36 }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [0, 0, 0], "max": [0, 0, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 } }] }],
    });
    let file = write(folder.path(), "a.gltf", document.to_string());
    needs_between(&file, 3, 6);
}

#[test]
fn shapes_are_counted_by_their_numbers_before_the_first_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let mut entities = String::new();
    for i in 1..=40 {
        // 19 million triangles each: 264 GB.
        write!(
            entities,
            "{i}: (components: {{\"glassbox::scene::MeshSource\": \
             Shape(Sphere(radius: {i}.0, segments: 4400, rings: 2160))}}),"
        )
        .unwrap();
    }
    let file = scene(folder.path(), &entities);
    for options in [
        within(4000),
        OpenOptions {
            tolerant: true,
            ..within(4000)
        },
    ] {
        says(
            &refused_with(&file, options),
            &["a.scn.ron", "GB", "--memory"],
        );
    }
}

#[test]
fn an_obj_is_counted_while_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut grid = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    grid.push_str(&"f 1 2 3\n".repeat(100_000));
    let file = write(folder.path(), "grid.obj", grid);
    needs_between(&file, 20, 60);
    // A polygon of many corners is as many triangles.
    let corners = "1 2 3 ".repeat(30_000);
    let file = write(
        folder.path(),
        "fan.obj",
        format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf {corners}\n"),
    );
    says(&refused_with(&file, within(20)), &["fan.obj:4", "--memory"]);
    // And many small objects are as many meshes.
    let mut groups = String::new();
    for i in 0..10_000 {
        writeln!(groups, "g {i}\nv {i} 0 0\nv {i} 1 0\nv {i} 0 1\nf -3 -2 -1").unwrap();
    }
    let file = write(folder.path(), "groups.obj", groups);
    needs_between(&file, 30, 100);
}

#[test]
fn materials_of_a_few_letters_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let materials: String = (0..40_000).map(|i| format!("newmtl {i}\n")).collect();
    write(folder.path(), "a.mtl", materials);
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl 1\nf 1 2 3\n";
    let file = write(folder.path(), "a.obj", text);
    needs_between(&file, 30, 100);
    let materials = "{},".repeat(40_000);
    let json = format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \"materials\": [{}]}}",
        materials.trim_end_matches(',')
    );
    let file = write(folder.path(), "a.gltf", json);
    says(&refused_with(&file, within(30)), &["a.gltf", "--memory"]);
}

#[test]
fn a_gltf_is_counted_by_its_accessors_and_again_for_each_mesh_that_reads_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.bin", vec![0; 12 * 30_000]);
    let primitive = "{\"attributes\": {\"POSITION\": 0}},".repeat(20);
    let json = format!(
        "{{\"asset\": {{\"version\": \"2.0\"}}, \
           \"buffers\": [{{\"uri\": \"a.bin\", \"byteLength\": 360000}}], \
           \"bufferViews\": [{{\"buffer\": 0, \"byteLength\": 360000}}], \
           \"accessors\": [{{\"bufferView\": 0, \"componentType\": 5126, \"count\": 30000, \
             \"type\": \"VEC3\", \"min\": [0,0,0], \"max\": [0,0,0]}}], \
           \"nodes\": [{{\"mesh\": 0}}], \"meshes\": [{{\"primitives\": [{}]}}]}}",
        primitive.trim_end_matches(',')
    );
    let file = write(folder.path(), "a.gltf", json);
    needs_between(&file, 20, 120);
}

#[test]
fn an_import_counts_what_is_open_already_and_leaves_it_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut grid = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    grid.push_str(&"f 1 2 3\n".repeat(100_000));
    let file = write(folder.path(), "grid.obj", grid);
    let mut app = app();
    let world = app.world_mut();
    open(world, &SceneSource::named(&file), within(50)).unwrap();
    let count = |world: &mut World| world.query::<&SceneId>().iter(world).count();
    let before = count(world);
    let error = import(world, &file, || SceneId(99)).unwrap_err();
    says(&error, &["grid.obj", "--memory"]);
    assert_eq!(count(world), before);
    // A picture has to fit beside it too.
    let says_so = check_film(world, Path::new("a.png"), [1000, 1000].into()).unwrap_err();
    says(&says_so, &["a.png", "--memory"]);
    assert!(check_film(world, Path::new("a.png"), [100, 100].into()).is_ok());
}

#[test]
fn a_shape_that_is_made_too_large_while_it_is_edited_is_a_load_problem_and_the_old_one_stays() {
    let mut app = app();
    let source = SceneSource::named("triangle");
    open(app.world_mut(), &source, within(100)).unwrap();
    let sphere = |segments| {
        MeshSource::Shape(Shape::Sphere {
            radius: 1.0,
            segments,
            rings: 1000,
        })
    };
    let id = SceneId(77);
    let entity = app.world_mut().spawn((id, sphere(8))).id();
    app.update();
    let mesh = |app: &bevy::app::App| {
        let mesh = app.world().get::<bevy::mesh::Mesh3d>(entity);
        mesh.map(|mesh| mesh.0.id())
    };
    let before = mesh(&app);
    assert!(before.is_some());
    *app.world_mut().get_mut::<MeshSource>(entity).unwrap() = sphere(1000);
    app.update();
    assert_eq!(mesh(&app), before);
    let problems = &app.world().resource::<LoadProblems>().problems;
    let text = problems
        .iter()
        .map(|p| p.error.to_string())
        .collect::<String>();
    assert!(text.contains("--memory"), "{text}");
}
