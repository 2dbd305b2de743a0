//! Tangents that a file gives: from its attribute to the light that a normal map catches, and back into files.

use super::app::write;
use super::gltf::base64;
use bevy::app::App;
use bevy::asset::Assets;
use bevy::math::{UVec2, Vec3, Vec4};
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use glassbox::app::headless_app;
use glassbox::film::render;
use glassbox::io::{OpenOptions, SceneSource, open, save};
use glassbox::scene::RenderSettings;
use glassbox::sync::{Traced, TracedCameras};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// What the normals' picture holds everywhere.
const TEXEL: [u8; 3] = [204, 179, 230];

/// The sun's irradiance on what faces it.
const SUN: f32 = 2.0;

/// glTF counts light as it is seen, radiometry as power.
const LUMENS_PER_WATT: f32 = 683.0;

/// A white square that faces z, whose picture stands upright on it, with a normal map, a camera straight above it, a
/// sun that comes from between x and z, and one tangent.
fn square(folder: &Path, tangent: Vec4, change: impl FnOnce(&mut Value)) -> PathBuf {
    let picture = image::RgbImage::from_pixel(2, 2, image::Rgb(TEXEL));
    picture.save(folder.join("n.png")).unwrap();
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let mut floats: Vec<f32> = Vec::new();
    for [u, v] in corners {
        floats.extend([2.0 * u - 1.0, 1.0 - 2.0 * v, 0.0]);
    }
    floats.extend([0.0, 0.0, 1.0].repeat(4));
    floats.extend(corners.as_flattened());
    floats.extend(tangent.to_array().repeat(4));
    let mut bytes: Vec<u8> = floats
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    bytes.extend([0_u8, 1, 2, 0, 2, 3]);
    let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
    let (s, c) = (std::f32::consts::FRAC_PI_4 / 2.0).sin_cos();
    let mut document = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "directional", "intensity": SUN * LUMENS_PER_WATT }] } },
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.1, "znear": 0.1 } }],
        "nodes": [
            { "mesh": 0 },
            { "camera": 0, "translation": [0.0, 0.0, 5.0] },
            { "rotation": [0.0, s, 0.0, c], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        ],
        "scenes": [{ "nodes": [0, 1, 2] }],
        "images": [{ "uri": "n.png" }],
        "textures": [{ "source": 0 }],
        "materials": [{ "normalTexture": { "index": 0 },
            "pbrMetallicRoughness": { "metallicFactor": 0.0 } }],
        "meshes": [{ "primitives": [{ "material": 0, "indices": 4, "attributes":
            { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "TANGENT": 3 } }] }],
        "buffers": [{ "byteLength": bytes.len(), "uri": uri }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 96, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 128, "byteLength": 64 },
            { "buffer": 0, "byteOffset": 192, "byteLength": 6 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [-1.0, -1.0, 0.0], "max": [1.0, 1.0, 0.0] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC4" },
            { "bufferView": 4, "componentType": 5121, "count": 6, "type": "SCALAR" },
        ],
    });
    change(&mut document);
    write(folder, "a.gltf", document.to_string())
}

fn opened(file: &Path) -> (App, Vec<String>) {
    let mut app = headless_app();
    let source = SceneSource::File(file.to_path_buf());
    let opened = open(app.world_mut(), &source, OpenOptions::default());
    let opened = opened.unwrap_or_else(|error| panic!("{error}"));
    app.update();
    (app, opened.notes.lines())
}

/// What comes from the middle of the square, the same in all colours.
fn radiance(app: &App) -> f32 {
    let traced = app.world().resource::<Traced>();
    let camera = &app.world().resource::<TracedCameras>().0[0].camera;
    let settings = RenderSettings {
        size: UVec2::splat(2),
        spp: 1,
        ..RenderSettings::default()
    };
    render(&traced.world, camera, &settings, &|_, _| {})
        .picture
        .pixels[0]
        .x
}

fn tangents(app: &mut App) -> Vec<[f32; 4]> {
    let world = app.world_mut();
    let mut meshes = world.query::<&Mesh3d>();
    let handle = meshes.single(world).unwrap().0.clone();
    let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
    match mesh.attribute(Mesh::ATTRIBUTE_TANGENT) {
        Some(VertexAttributeValues::Float32x4(values)) => values.clone(),
        _ => Vec::new(),
    }
}

/// A unit vector in the square's plane, with a sign.
fn along(turn: f32, side: f32) -> Vec4 {
    Vec3::new(turn.cos(), turn.sin(), 0.0).extend(side)
}

/// kd/π times the sun's irradiance on the normal that the texel says around a tangent.
fn expected(tangent: Vec4) -> f32 {
    let local = TEXEL.map(|value| 2.0 * f32::from(value) / 255.0 - 1.0);
    let local = Vec3::from(local).normalize();
    let right = tangent.truncate();
    let up = tangent.w * Vec3::Z.cross(right);
    let normal = local.x * right + local.y * up + local.z * Vec3::Z;
    let to_sun = Vec3::new(1.0, 0.0, 1.0).normalize();
    normal.dot(to_sun).max(0.0) * SUN / std::f32::consts::PI
}

#[test]
fn a_normal_map_catches_light_as_the_file_s_tangents_say() {
    let folder = tempfile::tempdir().unwrap();
    for (turn, side) in [(0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (1.0, -1.0), (2.0, 1.0)] {
        let tangent = along(turn, side);
        let file = square(folder.path(), tangent, |_| {});
        let (app, notes) = opened(&file);
        assert!(
            !notes.iter().any(|note| note.contains("TANGENT")),
            "{notes:?}"
        );
        let (found, expected) = (radiance(&app), expected(tangent));
        // Of f32, through a dozen operations.
        assert!(
            (found - expected).abs() < 1e-5,
            "turned by {turn}, {side}: {found}, not {expected}"
        );
    }
}

#[test]
fn tangents_come_back_from_a_glb_and_an_obj_says_that_it_has_none() {
    let folder = tempfile::tempdir().unwrap();
    let tangent = along(1.0, -1.0);
    let (mut app, _) = opened(&square(folder.path(), tangent, |_| {}));
    let glb = folder.path().join("b.glb");
    let notes = save(app.world_mut(), &glb).unwrap().lines();
    assert!(
        !notes.iter().any(|note| note.contains("tangent")),
        "{notes:?}"
    );
    let (mut back, _) = opened(&glb);
    assert_eq!(tangents(&mut back), [tangent.to_array(); 4]);
    assert_eq!(radiance(&back), radiance(&app));
    let notes = save(app.world_mut(), &folder.path().join("b.obj")).unwrap();
    let notes = notes.lines();
    let told = notes.iter().any(|note| note.contains("the tangents of"));
    assert!(told, "{notes:?}");
}

#[test]
fn tangents_without_normals_are_left_out_as_the_standard_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = square(folder.path(), along(1.0, 1.0), |document| {
        let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
        attributes.as_object_mut().unwrap().remove("NORMAL");
    });
    let (app, notes) = opened(&file);
    let told = notes
        .iter()
        .any(|note| note.contains("tangents without normals"));
    assert!(told, "{notes:?}");
    let (found, expected) = (radiance(&app), expected(along(0.0, 1.0)));
    assert!((found - expected).abs() < 1e-5, "{found}, not {expected}");
}

#[test]
fn tangents_move_with_morph_targets_and_turn_with_joints_and_keep_their_sign() {
    let folder = tempfile::tempdir().unwrap();
    let tangent = along(0.0, -1.0);
    // By the normals, which point along z.
    let file = square(folder.path(), tangent, |document| {
        document["meshes"][0]["primitives"][0]["targets"] = json!([{ "TANGENT": 1 }]);
        document["meshes"][0]["weights"] = json!([0.5]);
    });
    let (mut app, notes) = opened(&file);
    assert_eq!(tangents(&mut app), [[1.0, 0.0, 0.5, -1.0]; 4], "{notes:?}");

    let file = square(folder.path(), tangent, |document| {
        let bytes = [[0_u8; 16], *[255, 0, 0, 0].repeat(4).as_array().unwrap()].concat();
        let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
        let list = |document: &mut Value, key: &str, value: Value| {
            document[key].as_array_mut().unwrap().push(value);
        };
        list(document, "buffers", json!({ "byteLength": 32, "uri": uri }));
        for (view, normalized) in [(5, false), (6, true)] {
            list(
                document,
                "bufferViews",
                json!({ "buffer": 1, "byteOffset": 16 * (view - 5), "byteLength": 16 }),
            );
            list(
                document,
                "accessors",
                json!({ "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4",
                    "normalized": normalized }),
            );
        }
        let attributes = &mut document["meshes"][0]["primitives"][0]["attributes"];
        attributes["JOINTS_0"] = json!(5);
        attributes["WEIGHTS_0"] = json!(6);
        document["nodes"][0]["skin"] = json!(0);
        // A quarter turn around z.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        list(
            document,
            "nodes",
            json!({ "rotation": [0.0, 0.0, half, half] }),
        );
        list(&mut document["scenes"][0], "nodes", json!(3));
        document["skins"] = json!([{ "joints": [3] }]);
    });
    let (mut app, notes) = opened(&file);
    for found in tangents(&mut app) {
        let off = Vec4::from(found) - Vec4::new(0.0, 1.0, 0.0, -1.0);
        assert!(off.abs().max_element() < 1e-6, "{found:?}: {notes:?}");
    }
    assert_eq!(tangents(&mut app).len(), 4);
}
