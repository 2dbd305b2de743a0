//! glTF as other programs write it.

use super::app::{opened, triangles, write};
use super::models::objects;
use bevy::color::LinearRgba;
use bevy::ecs::name::Name;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use bevy::prelude::{App, Assets, Entity, GlobalTransform, World};
use glassbox::scene::*;
use serde_json::{Value, json};

/// Five vertices of a strip, texture coordinates, and indices of two triangles.
pub(super) const POSITIONS: [[f32; 3]; 5] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 2.0, 0.0],
];

pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let mut bits = 0_u32;
        for i in 0..3 {
            bits = bits << 8 | u32::from(chunk.get(i).copied().unwrap_or(0));
        }
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    text
}

/// A mesh of the five vertices whose primitive is `primitive`, under one node, after a change.
pub(super) fn document(primitive: Value, change: impl FnOnce(&mut Value)) -> (App, Vec<String>) {
    let mut bytes: Vec<u8> = POSITIONS
        .iter()
        .flatten()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    // Normalised 16-bit texture coordinates: (0, 0), (1, 0), … as the positions' x and half of y.
    for [x, y, _] in POSITIONS {
        bytes.extend(((x * 65_535.0) as u16).to_le_bytes());
        bytes.extend(((0.5 * y * 65_535.0) as u16).to_le_bytes());
    }
    bytes.extend([0_u8, 1, 2, 2, 1, 3]);
    let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
    let mut document = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "name": "node", "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
        "meshes": [{ "primitives": [primitive] }],
        "buffers": [{ "byteLength": bytes.len(), "uri": uri }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 60 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 20 },
            { "buffer": 0, "byteOffset": 80, "byteLength": 6 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3",
              "min": [0.0, 0.0, 0.0], "max": [1.0, 2.0, 0.0] },
            { "bufferView": 1, "componentType": 5123, "normalized": true, "count": 5, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR" },
        ],
    });
    change(&mut document);
    let folder = tempfile::tempdir().unwrap();
    glassbox::io::write_picture(&folder.path().join("a b.png"), 1, 1, &[[0.5; 3]]).unwrap();
    let file = write(folder.path(), "a.gltf", document.to_string());
    let (app, opened) = opened(&file);
    (app, opened.notes.lines())
}

pub(super) fn plain() -> Value {
    json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2 })
}

pub(super) fn corners(app: &mut App) -> Vec<[Vec3; 3]> {
    let all = objects(app.world_mut());
    all[0].2.iter().map(|t| t.map(Vec3::from)).collect()
}

fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(c - a)
}

#[test]
fn strips_and_fans_become_triangles_that_face_the_same_way() {
    let (mut app, _) = document(plain(), |_| {});
    assert_eq!(corners(&mut app).len(), 2);
    for (mode, count) in [(5, 3), (6, 3)] {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "mode": mode });
        let (mut app, _) = document(primitive, |_| {});
        let corners = corners(&mut app);
        assert_eq!(corners.len(), count, "mode {mode}");
        if mode == 5 {
            let facing = corners.iter().filter(|&&triangle| normal(triangle).z > 0.0);
            assert_eq!(facing.count(), 3, "{corners:?}");
        }
    }
}

#[test]
fn corners_that_make_no_whole_triangle_are_told() {
    let (mut app, notes) = document(plain(), |d| d["accessors"][2]["count"] = json!(5));
    assert_eq!(corners(&mut app).len(), 1);
    assert!(
        notes.iter().any(|note| note.contains("too few for a last")),
        "{notes:#?}"
    );
}

#[test]
fn a_sparse_accessor_replaces_what_it_names() {
    let (mut app, _) = document(plain(), |d| {
        // Vertex 2 becomes vertex 0's values; the index is the third byte of the indices.
        d["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": 2, "byteOffset": 2, "componentType": 5121 },
            "values": { "bufferView": 0, "byteOffset": 48 },
        });
    });
    let first = corners(&mut app)[0];
    assert_eq!(first[2], Vec3::from(POSITIONS[4]));
}

#[test]
fn lights_are_measured_in_watts_and_cameras_look_the_same_way() {
    let (mut app, notes) = document(plain(), |d| {
        d["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        d["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
            { "type": "point", "intensity": 1366.0, "color": [1.0, 0.5, 0.0] },
            { "type": "directional", "intensity": 683.0 },
        ] } });
        d["cameras"] = json!([
            { "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } },
            { "type": "orthographic", "orthographic": { "xmag": 1.0, "ymag": 3.0, "znear": 0.0, "zfar": 9.0 } },
        ]);
        d["nodes"] = json!([
            { "mesh": 0, "children": [1, 2], "camera": 0, "translation": [1.0, 2.0, 3.0] },
            { "camera": 1, "extensions": { "KHR_lights_punctual": { "light": 0 } } },
            { "matrix": [0.0, 2.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 5.0, 0.0, 0.0, 1.0],
              "extensions": { "KHR_lights_punctual": { "light": 1 } } },
        ]);
    });
    // The camera stands in the plane of all there is.
    let [told] = &notes[..] else {
        panic!("a camera and lights are there: {notes:?}");
    };
    assert!(told.contains("looks past everything"), "{told}");
    let world = app.world_mut();
    let point = world
        .query::<&PointLamp>()
        .iter(world)
        .next()
        .cloned()
        .unwrap();
    assert_eq!(
        (point.intensity, point.color),
        (2.0, LinearRgba::rgb(1.0, 0.5, 0.0))
    );
    let sun = world
        .query::<&DirectionalLamp>()
        .iter(world)
        .next()
        .cloned()
        .unwrap();
    assert_eq!(sun.intensity, 1.0);
    let mut cameras = world.query::<&SceneCamera>();
    let mut heights: Vec<_> = cameras.iter(world).map(|c| c.projection).collect();
    heights.sort_by_key(|projection| matches!(projection, Projection::Orthographic { .. }));
    let expected = [
        Projection::Perspective { fov_y: 0.5 },
        Projection::Orthographic { height: 6.0 },
    ];
    assert_eq!(heights, expected);
    let sun = place(world, "node 2");
    let back = sun.transform_point3(Vec3::X);
    assert!(back.abs_diff_eq(Vec3::new(6.0, 4.0, 3.0), 1e-5), "{back}");
    let object = world.query_filtered::<Entity, bevy::prelude::With<Mesh3d>>();
    let object = { object }.iter(world).next().unwrap();
    assert_eq!(triangles(world, object).len(), 2);
}

/// From an entity's space to the world's, by its ancestors' transforms.
pub(super) fn place(world: &mut World, name: &str) -> bevy::math::Affine3A {
    use bevy::ecs::hierarchy::ChildOf;
    use bevy::transform::components::Transform;
    let mut query = world.query::<(Entity, &Name)>();
    let mut at = query
        .iter(world)
        .find(|(_, other)| other.as_str() == name)
        .unwrap()
        .0;
    let mut place = GlobalTransform::IDENTITY.affine();
    loop {
        let local = world.get::<Transform>(at).copied().unwrap_or_default();
        place = local.compute_affine() * place;
        match world.get::<ChildOf>(at) {
            Some(child) => at = child.0,
            None => return place,
        }
    }
}

#[test]
fn what_was_not_read_is_told_by_its_name_and_what_was_is_not() {
    let (_, notes) = document(plain(), |_| {});
    let told = |notes: &[String]| {
        let told = notes.iter().filter(|note| !note.contains("added"));
        told.cloned().collect::<Vec<String>>()
    };
    assert!(told(&notes).is_empty(), "{notes:?}");
    let (_, notes) = document(plain(), |d| {
        d["animations"] =
            json!([{ "channels": [{ "sampler": 0, "target": { "path": "rotation" } }] }]);
        d["extensionsUsed"] = json!(["KHR_materials_iridescence", "ABC_of_tomorrow"]);
        d["materials"] = json!([{
            "extensions": { "KHR_materials_iridescence": {} },
        }]);
        d["meshes"][0]["primitives"][0]["material"] = json!(0);
        d["meshes"][0]["primitives"][0]["attributes"]["_HEAT"] = json!(0);
    });
    let told = told(&notes);
    for (place, what) in [
        ("animations", "`animations`"),
        (
            "materials[0].extensions.KHR_materials_iridescence",
            "left out",
        ),
        ("attributes._HEAT", "`_HEAT`"),
        ("extensionsUsed", "`ABC_of_tomorrow`"),
    ] {
        let is_told = |note: &&String| note.contains(place) && note.contains(what);
        assert_eq!(told.iter().filter(is_told).count(), 1, "{place}: {told:#?}");
    }
    assert_eq!(told.len(), 4, "{told:#?}");
}

#[test]
fn a_document_opens_without_bounds_with_a_byte_order_mark_and_with_counts_as_floats() {
    let (mut app, _) = document(plain(), |d| {
        for key in ["min", "max"] {
            d["accessors"][0].as_object_mut().unwrap().remove(key);
        }
        d["accessors"][0]["count"] = json!(5.0);
    });
    assert_eq!(corners(&mut app).len(), 2);
    let folder = tempfile::tempdir().unwrap();
    let text = "\u{feff}{\"asset\":{\"version\":\"2.0\"},\"meshes\":[]}";
    let file = write(folder.path(), "a.gltf", text);
    let mut app = super::app::app();
    let source = glassbox::io::SceneSource::File(file);
    let result = glassbox::io::open(app.world_mut(), &source, Default::default());
    let error = result.unwrap_err().to_string();
    assert!(error.contains("no triangles"), "{error}");
}

#[test]
fn data_and_paths_are_found_as_programs_write_them() {
    let whole = POSITIONS[..3]
        .iter()
        .flatten()
        .flat_map(|v: &f32| v.to_le_bytes());
    let whole: Vec<u8> = whole.collect();
    let text = base64(&whole);
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a b.bin", &whole);
    for uri in [
        format!("DATA:application/octet-stream;BASE64,{text}"),
        format!("data:;base64,\n{text}\n"),
        format!("data:a/b;charset=utf-8;base64,{}", text.replace('=', "%3D")),
        "a%20b.bin".to_owned(),
        "a%20b.bin?version=2".to_owned(),
        "a b.bin".to_owned(),
        "file:///home/someone/a%20b.bin".to_owned(),
    ] {
        let document = json!({
            "asset": { "version": "2.0" },
            "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "buffers": [{ "byteLength": whole.len(), "uri": uri }],
            "bufferViews": [{ "buffer": 0, "byteLength": whole.len() }],
            "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        });
        // Some programs end a text with a zero.
        let file = write(folder.path(), "a.gltf", format!("{document}\0"));
        let (mut app, _) = opened(&file);
        assert_eq!(objects(app.world_mut())[0].2.len(), 1, "{uri}");
    }
}

#[test]
fn integers_that_can_only_be_fractions_are_fractions_and_colours_stay_between_0_and_1() {
    let primitive =
        json!({ "attributes": { "POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 3 }, "indices": 2 });
    let bytes = [[255_u8, 51, 0, 255]; 5].concat();
    let floats = |color: [f32; 4]| -> Vec<u8> {
        let all = [color; 5].into_iter().flatten();
        all.flat_map(f32::to_le_bytes).collect()
    };
    for (bytes, kind, expected, what) in [
        (bytes, 5121, [1.0, 0.2, 0.0, 1.0], "not `normalized`"),
        (
            floats([255.0, 51.0, 0.0, 1.0]),
            5126,
            [1.0, 0.2, 0.0, 1.0],
            "above 1",
        ),
        (
            floats([f32::NAN, -1.0, 1.5, 0.5]),
            5126,
            [0.0, 0.0, 1.0, 0.5],
            "outside 0 to 1",
        ),
    ] {
        let (mut app, notes) = document(primitive.clone(), |d| {
            let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
            let buffers = d["buffers"].as_array_mut().unwrap();
            buffers.push(json!({ "byteLength": bytes.len(), "uri": uri }));
            let views = d["bufferViews"].as_array_mut().unwrap();
            views.push(json!({ "buffer": 1, "byteLength": bytes.len() }));
            d["accessors"][1]["normalized"] = json!(false);
            let accessors = d["accessors"].as_array_mut().unwrap();
            accessors.push(
                json!({ "bufferView": 3, "componentType": kind, "count": 5, "type": "VEC4" }),
            );
        });
        assert!(notes.iter().any(|note| note.contains(what)), "{notes:#?}");
        let world = app.world_mut();
        let handle = world.query::<&Mesh3d>().single(world).unwrap().0.clone();
        let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
        let Some(VertexAttributeValues::Float32x4(colors)) = mesh.attribute(Mesh::ATTRIBUTE_COLOR)
        else {
            panic!("no colours");
        };
        let off = colors[0].iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f32::max) < 1e-6, "{colors:?}");
        let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0)
        else {
            panic!("no texture coordinates");
        };
        assert_eq!(uvs[1], [1.0, 0.0]);
    }
}

#[test]
fn a_sparse_value_that_has_no_place_is_left_out() {
    let (mut app, notes) = document(plain(), |d| {
        // The indices are 3, which is a vertex, and, behind it, 255, which is none.
        let uri = format!("data:application/octet-stream;base64,{}", base64(&[3, 255]));
        let buffers = d["buffers"].as_array_mut().unwrap();
        buffers.push(json!({ "byteLength": 2, "uri": uri }));
        let views = d["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 1, "byteLength": 2 }));
        d["accessors"][0]["sparse"] = json!({
            "count": 2,
            "indices": { "bufferView": 3, "componentType": 5121 },
            "values": { "bufferView": 0, "byteOffset": 36 },
        });
    });
    assert!(
        notes
            .iter()
            .any(|note| note.contains("accessors[0].sparse")),
        "{notes:#?}"
    );
    assert_eq!(corners(&mut app).len(), 2);
}
