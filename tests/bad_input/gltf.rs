use super::{opens_and_says, refused, refused_with, says};
use crate::files::app::{opened, write};
use glassbox::io::OpenOptions;
use serde_json::{Value, json};
use std::path::PathBuf;
use tempfile::TempDir;

/// One triangle: 36 bytes of positions, then 6 of indices, as a document.
fn triangle() -> Value {
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

fn bytes(corners: [u16; 3]) -> Vec<u8> {
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
fn changed(change: impl FnOnce(&mut Value)) -> (TempDir, PathBuf) {
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
fn another_version_of_gltf() {
    let (_folder, file) = changed(|d| d["asset"]["version"] = json!("1.0"));
    says(&refused(&file), &["a.gltf", "glTF 1.0"]);
    // That version had objects where there are lists now.
    let (_folder, file) = changed(|d| {
        d["asset"] = json!({});
        d["meshes"] = json!({ "lid": {} });
    });
    says(&refused(&file), &["a.gltf", "glTF 1.0"]);
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
fn version_2_without_a_point_is_2() {
    let (_folder, file) = changed(|d| d["asset"]["version"] = json!("2"));
    let (mut app, _) = opened(&file);
    assert_eq!(crate::files::models::objects(app.world_mut()).len(), 1);
}

#[test]
fn numbers_that_json_does_not_have_are_none() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.bin", bytes([0, 1, 2]));
    let text = triangle().to_string();
    for (number, name) in [
        ("NaN", "a.gltf"),
        ("-Infinity", "b.gltf"),
        ("1e400", "c.gltf"),
    ] {
        let text = text.replace(r#""max":[1.0,"#, &format!(r#""max":[{number},"#));
        assert!(text.contains(number));
        let file = write(folder.path(), name, text);
        assert_eq!(opens_and_says(&file, &[name, "JSON does not have"]), 1);
    }
}

#[test]
fn names_in_an_old_encoding_do_not_cost_the_document() {
    let (folder, _) = changed(|_| {});
    let text = triangle().to_string();
    let text = text.replace(r#""nodes":[{"#, r#""nodes":[{"name":"caf_","#);
    let mut text = text.into_bytes();
    for byte in text.iter_mut().filter(|byte| **byte == b'_') {
        *byte = 0xe9;
    }
    let file = write(folder.path(), "b.gltf", text);
    let (mut app, opened) = opened(&file);
    let said = opened.notes.lines();
    assert!(
        said.iter().any(|line| line.contains("no UTF-8")),
        "{said:?}"
    );
    let world = app.world_mut();
    let mut names = world.query::<&bevy::ecs::name::Name>();
    let found = names.iter(world).any(|name| name.as_str() == "caf\u{e9}");
    assert!(found, "no entity has the name");
}

#[test]
fn text_in_utf_16_is_called_so() {
    let folder = tempfile::tempdir().unwrap();
    let text = triangle().to_string();
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let file = write(folder.path(), "a.gltf", [&[0xff, 0xfe], &wide[..]].concat());
    says(&refused(&file), &["a.gltf", "UTF-16"]);
}

#[test]
fn a_document_that_is_not_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = write(folder.path(), "a.gltf", "{\n  \"asset\": ]\n}");
    says(&refused(&file), &["a.gltf:2:"]);
    let file = write(folder.path(), "b.gltf", "{ \"asset\": {");
    says(&refused(&file), &["b.gltf", "ends too early"]);
}

#[test]
fn a_glb_that_ends_too_early() {
    let folder = tempfile::tempdir().unwrap();
    let (_keep, file) = changed(|_| {});
    let (mut app, _) = opened(&file);
    let glb = folder.path().join("a.glb");
    glassbox::io::save(app.world_mut(), &glb).unwrap();
    let whole = std::fs::read(&glb).unwrap();
    for length in [3, 11, 19, 40, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&glb, &whole[..length]).unwrap();
        says(&refused(&glb), &["a.glb"]);
    }
}

#[test]
fn a_glb_whose_lengths_are_not_the_files_is_read_as_far_as_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = serde_json::to_vec(&triangle()).unwrap();
    let uri = br#","uri":"a.bin""#;
    let at = text.windows(uri.len()).position(|part| part == uri);
    let at = at.expect("the buffer's file");
    text.splice(at..at + uri.len(), []);
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut blob = bytes([0, 1, 2]);
    blob.resize(44, 0);
    let glb = |total: i64, blob_size: usize, tail: &[u8]| {
        let whole = 28 + text.len() + blob.len() + tail.len();
        let total = (whole as i64 + total) as u32;
        let mut out = [*b"glTF", 2_u32.to_le_bytes(), total.to_le_bytes()].concat();
        out.extend((text.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(&text);
        out.extend((blob_size as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&blob);
        out.extend(tail);
        write(folder.path(), "a.glb", out)
    };
    let whole = glb(0, 44, &[]);
    let (_, opened) = opened(&whole);
    let told = opened.notes.lines();
    assert!(told.iter().all(|note| note.contains("added")), "{told:?}");
    let past_the_json = -8 - blob.len() as i64;
    for (total, blob_size, tail) in [
        (4, 44, &[][..]),
        (i64::from(u32::MAX >> 1), 44, &[]),
        (past_the_json, 44, &[]),
        (-4, 44, &[]),
        (0, 48, &[]),
        (0, 44, &[0, 0]),
    ] {
        let file = glb(total, blob_size, tail);
        let note = ["a.glb", "lengths of its parts", "what is there is read"];
        assert_eq!(
            opens_and_says(&file, &note),
            1,
            "{total} {blob_size} {tail:?}"
        );
    }
}

#[test]
fn a_glb_that_says_it_is_shorter_than_its_header() {
    let folder = tempfile::tempdir().unwrap();
    for length in [0_u32, 11] {
        let header = [*b"glTF", 2_u32.to_le_bytes(), length.to_le_bytes()].concat();
        let glb = write(folder.path(), "a.glb", [header, vec![0; 28]].concat());
        says(&refused(&glb), &["a.glb", &format!("{length} bytes long")]);
    }
}

#[test]
fn a_glb_with_any_byte_of_its_head_changed_does_not_panic() {
    let folder = tempfile::tempdir().unwrap();
    let (_keep, file) = changed(|_| {});
    let (mut source, _) = opened(&file);
    let glb = folder.path().join("a.glb");
    glassbox::io::save(source.world_mut(), &glb).unwrap();
    let whole = std::fs::read(&glb).unwrap();
    let mut app = crate::files::app::app();
    let mut refused = 0;
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x15;
        std::fs::write(&glb, &damaged).unwrap();
        let source = glassbox::io::SceneSource::File(glb.clone());
        let result = glassbox::io::open(app.world_mut(), &source, OpenOptions::default());
        refused += usize::from(result.is_err());
    }
    // The header at least, and what positions need; most else is left out with a note.
    assert!(refused > 20, "{refused} of {} were refused", whole.len());
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
