use super::{opens_and_says, refused, refused_with, says};
use crate::files::app::{opened, write};
use glassbox::io::OpenOptions;
use serde_json::{Value, json};
use std::path::PathBuf;
use tempfile::TempDir;

/// One triangle: 36 bytes of positions, then 6 of indices, as a document.
pub(super) fn triangle() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
              "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.0] },
            { "bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 6 },
        ],
        "buffers": [{ "byteLength": 42, "uri": "a.bin" }],
    })
}

pub(super) fn bytes(corners: [u16; 3]) -> Vec<u8> {
    let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let positions = positions.iter().flat_map(|v| v.to_le_bytes());
    positions
        .chain(corners.iter().flat_map(|v| v.to_le_bytes()))
        .collect()
}

fn folder_with(document: &Value) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.bin", bytes([0, 1, 2]));
    let file = write(folder.path(), "a.gltf", document.to_string());
    (folder, file)
}

/// The triangle after a change.
pub(super) fn changed(change: impl FnOnce(&mut Value)) -> (TempDir, PathBuf) {
    let mut document = triangle();
    change(&mut document);
    folder_with(&document)
}

#[test]
fn the_document_that_the_others_damage_opens() {
    let (_folder, file) = changed(|_| {});
    let (mut app, _) = opened(&file);
    let world = app.world_mut();
    let meshes = world.query::<&bevy::mesh::Mesh3d>().iter(world).count();
    assert_eq!(meshes, 1);
}

#[test]
fn a_missing_buffer() {
    let (folder, file) = changed(|_| {});
    std::fs::remove_file(folder.path().join("a.bin")).unwrap();
    says(
        &refused(&file),
        &[
            "a.gltf: Mesh0/Primitive0: buffer 0",
            "`a.bin` does not exist",
        ],
    );
}

#[test]
fn a_buffer_that_is_shorter_than_it_claims() {
    let (folder, file) = changed(|_| {});
    write(folder.path(), "a.bin", [0_u8; 41]);
    says(&refused(&file), &["a.gltf", "buffer 0", "41 of 42 bytes"]);
    let (_folder, file) = changed(|document| document["buffers"][0]["byteLength"] = json!(60));
    let note = ["a.gltf: buffer 0", "fewer bytes than it says"];
    assert_eq!(opens_and_says(&file, &note), 1, "all that is used is there");
}

#[test]
fn a_buffer_whose_data_is_not_in_base64() {
    let escaped: String = bytes([0, 1, 2])
        .iter()
        .map(|b| format!("%{b:02x}"))
        .collect();
    let uri = format!("data:application/octet-stream,{escaped}");
    let (_folder, file) = changed(|document| document["buffers"][0]["uri"] = json!(uri));
    let (mut app, opened) = opened(&file);
    assert_eq!(crate::files::models::objects(app.world_mut())[0].2.len(), 1);
    let told = opened.notes.lines();
    assert!(told.iter().all(|note| note.contains("added")), "{told:?}");
}

#[test]
fn points_are_left_out_with_one_note_and_not_one_more_for_what_they_hold() {
    let (_folder, file) = changed(|document| {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "mode": 0 });
        let primitives = &mut document["meshes"][0]["primitives"];
        primitives.as_array_mut().unwrap().push(primitive);
    });
    let (_, opened) = opened(&file);
    let mut told = opened.notes.lines();
    told.retain(|line| !line.contains("added"));
    assert_eq!(told.len(), 1, "{told:#?}");
    assert!(told[0].contains("points and lines"), "{told:#?}");
}

#[test]
fn a_primitive_of_a_mode_that_there_is_not_is_left_out() {
    let (_folder, file) = changed(|document| {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "mode": 7 });
        let primitives = &mut document["meshes"][0]["primitives"];
        primitives.as_array_mut().unwrap().push(primitive);
    });
    let note = ["Mesh0/Primitive1", "`mode` that glTF does not have"];
    assert_eq!(opens_and_says(&file, &note), 1);
}

#[test]
fn a_buffer_outside_the_folder() {
    let (folder, _) = changed(|_| {});
    let mut document = triangle();
    document["buffers"][0]["uri"] = json!("../%61.bin");
    let file = write(folder.path(), "inside/a.gltf", document.to_string());
    says(
        &refused(&file),
        &["a.gltf", "buffer 0", "../a.bin", "--allow-outside"],
    );
    let options = OpenOptions {
        allow_outside: true,
        ..OpenOptions::default()
    };
    let mut app = crate::files::app::app();
    let source = glassbox::io::SceneSource::File(file);
    glassbox::io::open(app.world_mut(), &source, options).unwrap_or_else(|e| panic!("{e}"));
}

/// The triangle with a material whose colour is this image.
fn pictured(image: Value) -> (TempDir, PathBuf) {
    changed(|d| {
        d["images"] = json!([image]);
        d["textures"] = json!([{ "source": 0 }]);
        d["materials"] =
            json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
        d["meshes"][0]["primitives"][0]["material"] = json!(0);
    })
}

#[test]
fn a_picture_outside_the_folder_missing_or_nowhere_leaves_the_material_without() {
    for (image, parts) in [
        (json!({ "uri": "/etc/a.png" }), ["image 0", "/etc/a.png"]),
        (
            json!({ "uri": "wood%20grain.png" }),
            ["image 0", "`wood grain.png` does not exist"],
        ),
        (json!({}), ["image 0", "neither a file nor data"]),
        (
            json!({ "uri": "data:image/png;base64,*" }),
            ["image 0", "cannot be decoded"],
        ),
        (
            json!({ "bufferView": 1 }),
            ["a.gltf#texture0", "which is not read"],
        ),
        (json!({ "bufferView": 7 }), ["image 0", "buffer view 7"]),
    ] {
        let (_folder, file) = pictured(image.clone());
        assert_eq!(opens_and_says(&file, &parts), 1, "{image}");
    }
}

#[test]
fn a_missing_picture_that_nothing_uses_is_not_missed() {
    let (_folder, file) = pictured(json!({ "uri": "gone.png" }));
    let document = std::fs::read_to_string(&file).unwrap();
    let mut document: Value = serde_json::from_str(&document).unwrap();
    document["meshes"][0]["primitives"][0]["material"] = json!(1);
    document["materials"]
        .as_array_mut()
        .unwrap()
        .push(json!({}));
    std::fs::write(&file, document.to_string()).unwrap();
    let (_, opened) = opened(&file);
    let lines = opened.notes.lines();
    assert!(
        !lines.iter().any(|line| line.contains("gone.png")),
        "{lines:?}"
    );
}

#[test]
fn an_accessor_that_claims_2_to_the_40_vertices() {
    let (_folder, file) = changed(|d| d["accessors"][0]["count"] = json!(1_u64 << 40));
    says(
        &refused(&file),
        &["a.gltf: Mesh0/Primitive0", "1099511627776", "limit"],
    );
}

#[test]
fn an_accessor_that_claims_more_than_its_bytes() {
    let (_folder, file) = changed(|d| d["accessors"][0]["count"] = json!(4));
    says(
        &refused(&file),
        &["a.gltf: Mesh0/Primitive0", "4 values", "36 bytes"],
    );
}

#[test]
fn an_accessor_with_no_bytes_that_claims_many() {
    let (_folder, file) = changed(|d| {
        let accessor = &mut d["accessors"][0];
        accessor.as_object_mut().unwrap().remove("bufferView");
        accessor["count"] = json!(1_u64 << 30);
        accessor["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": 1, "componentType": 5123 },
            "values": { "bufferView": 0 },
        });
    });
    says(
        &refused(&file),
        &["a.gltf: Mesh0/Primitive0", "no bytes stand behind"],
    );
}

#[test]
fn an_accessor_without_values() {
    let (_folder, file) = changed(|d| d["accessors"][0]["count"] = json!(0));
    says(&refused(&file), &["a.gltf"]);
}

#[test]
fn an_accessor_whose_stride_is_smaller_than_its_values() {
    let (_folder, file) = changed(|d| d["bufferViews"][0]["byteStride"] = json!(4));
    says(&refused(&file), &["a.gltf: Mesh0/Primitive0"]);
}

#[test]
fn an_accessor_of_the_wrong_type() {
    let (_folder, file) = changed(|d| {
        d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(1);
    });
    says(&refused(&file), &["a.gltf"]);
    let (_folder, file) = changed(|d| d["meshes"][0]["primitives"][0]["indices"] = json!(0));
    says(
        &refused(&file),
        &["a.gltf: Mesh0/Primitive0", "accessor 0", "does not fit"],
    );
}

#[test]
fn a_buffer_view_that_leaves_its_buffer() {
    let (_folder, file) = changed(|d| d["bufferViews"][0]["byteOffset"] = json!(u64::MAX / 2));
    says(
        &refused(&file),
        &["a.gltf: Mesh0/Primitive0", "buffer view 0"],
    );
}

#[test]
fn what_a_mesh_can_do_without_is_left_out_with_a_note() {
    // Of a wrong type, missing, of another length.
    for (key, accessor) in [("NORMAL", 1), ("TEXCOORD_0", 9), ("COLOR_0", 2)] {
        let (_folder, file) = changed(|d| {
            d["meshes"][0]["primitives"][0]["attributes"][key] = json!(accessor);
            let two = json!({ "bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3" });
            d["accessors"].as_array_mut().unwrap().push(two);
        });
        let parts = ["Mesh0/Primitive0", key, "left out"];
        assert_eq!(opens_and_says(&file, &parts), 1, "{key}");
    }
}

#[test]
fn an_index_that_names_no_vertex() {
    let (folder, file) = changed(|_| {});
    write(folder.path(), "a.bin", bytes([0, 1, 3]));
    says(
        &refused(&file),
        &["a.gltf: Mesh0/Primitive0", "vertex 3", "there are 3"],
    );
}

#[test]
fn a_vertex_that_is_not_a_number() {
    let (folder, file) = changed(|_| {});
    let mut bytes = bytes([0, 1, 2]);
    bytes[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    write(folder.path(), "a.bin", bytes);
    says(
        &refused(&file),
        &["a.gltf: Mesh0/Primitive0", "vertex", "not a finite number"],
    );
}

#[test]
fn an_index_of_the_document_that_names_nothing() {
    for (change, what, parts) in [
        (
            "meshes",
            json!([{ "primitives": [{ "attributes": { "POSITION": 9 } }] }]),
            "accessor 9",
        ),
        ("nodes", json!([{ "mesh": 7 }]), "no triangles"),
        ("scenes", json!([{ "nodes": [4] }]), "no triangles"),
    ] {
        let (_folder, file) = changed(|d| d[change] = what);
        says(&refused(&file), &["a.gltf", parts]);
    }
    let (_folder, file) = changed(|d| d["nodes"] = json!([{ "mesh": 0, "children": [5] }]));
    assert_eq!(opens_and_says(&file, &["node 5", "there is not"]), 1);
}

#[test]
fn lights_and_cameras_that_make_no_sense_are_left_out_with_a_note() {
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    let perspective = json!({ "yfov": 1.0, "znear": 0.1 });
    for (key, value, what) in [
        (
            "extensions",
            json!({ "KHR_lights_punctual": { "light": 3 } }),
            "a light",
        ),
        ("extensions", light.clone(), "a light"),
        ("camera", json!(0), "a camera"),
        ("camera", json!(9), "a camera"),
    ] {
        let (_folder, file) = changed(|d| {
            d["extensionsUsed"] = json!(["KHR_lights_punctual"]);
            let lights = json!([{ "type": "sun" }]);
            d["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
            d["cameras"] = json!([{ "type": "orthographic", "perspective": perspective }]);
            d["nodes"][0][key] = value;
        });
        assert_eq!(opens_and_says(&file, &["node 0", what, "left out"]), 1);
    }
}

#[test]
fn nodes_in_a_circle_are_shown_once() {
    let (_folder, file) = changed(|d| {
        d["nodes"] = json!([{ "children": [1] }, { "children": [0], "mesh": 0 }]);
    });
    let parts = ["node 0", "reached twice", "shown once"];
    assert_eq!(opens_and_says(&file, &parts), 1);
}

#[test]
fn nodes_nested_a_hundred_thousand_deep() {
    let (_folder, file) = changed(|d| {
        let mut nodes: Vec<Value> = (1..100_000).map(|i| json!({ "children": [i] })).collect();
        nodes.push(json!({ "mesh": 0 }));
        d["nodes"] = json!(nodes);
    });
    says(
        &refused(&file),
        &["a.gltf: node 256", "257 ancestors", "limit is 256"],
    );
}

#[test]
fn a_required_extension_that_is_not_supported() {
    let (_folder, file) = changed(|d| {
        d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
        d["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    });
    says(
        &refused(&file),
        &["a.gltf", "KHR_draco_mesh_compression", "not supported"],
    );
}

#[test]
fn a_required_extension_of_looks_alone_is_shown_without() {
    for name in ["KHR_techniques_webgl", "KHR_technique_webgl"] {
        let (_folder, file) = changed(|d| d["extensionsRequired"] = json!([name]));
        opens_and_says(&file, &[name, "shown without"]);
    }
}

#[test]
fn a_rotation_of_zeros_turns_nothing() {
    let (_folder, file) = changed(|d| d["nodes"][0]["rotation"] = json!([0, 0, 0, 0]));
    opens_and_says(&file, &["rotation of zeros", "not turned"]);
    let (mut app, _) = opened(&file);
    let triangle = crate::files::models::objects(app.world_mut())[0].2[0];
    assert_eq!(triangle[1], [1.0, 0.0, 0.0], "{triangle:?}");
}

#[test]
fn more_nodes_than_the_limit() {
    let (_folder, file) = changed(|d| {
        d["nodes"] = json!([{ "mesh": 0 }, {}, {}]);
    });
    let mut options = OpenOptions::default();
    options.limits.entities = 2;
    says(
        &refused_with(&file, options),
        &["a.gltf", "3 nodes", "limit is 2"],
    );
}
