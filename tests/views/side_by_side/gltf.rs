//! Models that Bevy's `AssetServer` has brought in.

use super::{LEFT, Part, RIGHT, Stage, unlike};
use crate::files::{app::opened, gltf::base64};
use bevy::asset::LoadState;
use bevy::gltf::GltfAssetLabel;
use bevy::prelude::*;
use bevy::world_serialization::WorldAssetRoot;
use glassbox::app::headless_app;
use glassbox::film::render as render_world;
use glassbox::io::{OpenOptions, SceneSource, open};
use glassbox::prelude::*;
use serde_json::{Value, json};
use std::path::Path;
use std::time::Instant;

/// Upright squares of two metres and a fifth, each from its lower left corner on.
const CORNERS: [[f32; 3]; 4] = [
    [-1.1, -1.1, 0.0],
    [1.1, -1.1, 0.0],
    [1.1, 1.1, 0.0],
    [-1.1, 1.1, 0.0],
];

/// A glTF document whose arrays are put together one by one.
struct Model {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Model {
    /// With positions, normals, texture coordinates and indices: accessors 0 to 3.
    fn square() -> Self {
        let mut model = Self {
            bytes: Vec::new(),
            views: Vec::new(),
            accessors: Vec::new(),
        };
        model.floats("VEC3", &CORNERS.concat());
        model.floats("VEC3", &[[0.0, 0.0, 1.0]; 4].concat());
        model.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
        let indices = [0_u16, 1, 2, 0, 2, 3].map(u16::to_le_bytes).concat();
        model.array(5123, "SCALAR", 6, &indices);
        model.accessors[0]["min"] = json!(CORNERS[0]);
        model.accessors[0]["max"] = json!(CORNERS[2]);
        model
    }

    fn floats(&mut self, kind: &str, numbers: &[f32]) -> usize {
        let parts = match kind {
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.array(5126, kind, numbers.len() / parts, &bytes)
    }

    fn array(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        let view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend(bytes);
        self.views.push(view);
        let number = self.accessors.len();
        self.accessors.push(
            json!({ "bufferView": number, "componentType": component, "count": count, "type": kind }),
        );
        number
    }

    fn write(self, folder: &Path, name: &str, mut rest: Value) {
        let data = base64(&self.bytes);
        let uri = format!("data:application/octet-stream;base64,{data}");
        rest["asset"] = json!({ "version": "2.0" });
        rest["buffers"] = json!([{ "byteLength": self.bytes.len(), "uri": uri }]);
        rest["bufferViews"] = json!(self.views);
        rest["accessors"] = json!(self.accessors);
        rest["scene"] = json!(0);
        std::fs::write(folder.join(name), rest.to_string()).unwrap();
    }
}

fn primitive(material: u32, more: &[(&str, usize)]) -> Value {
    let mut attributes = json!({ "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 });
    for (name, accessor) in more {
        attributes[*name] = json!(accessor);
    }
    json!({ "attributes": attributes, "indices": 3, "material": material })
}

const MATTE: [f32; 2] = [0.0, 1.0];

/// A tinted picture, and one that is cut out.
fn textured(folder: &Path) {
    let mut halves = image::RgbaImage::new(2, 1);
    halves.put_pixel(0, 0, image::Rgba([255, 188, 255, 255]));
    halves.put_pixel(1, 0, image::Rgba([255, 188, 255, 40]));
    halves.save(folder.join("halves.png")).unwrap();
    let [metallic, rough] = MATTE;
    let surface = |tint: [f32; 4]| {
        json!({ "baseColorFactor": tint, "baseColorTexture": { "index": 0 },
            "metallicFactor": metallic, "roughnessFactor": rough })
    };
    Model::square().write(
        folder,
        "textured.gltf",
        json!({
            "images": [{ "uri": "halves.png" }],
            "samplers": [{ "magFilter": 9728, "minFilter": 9728 }],
            "textures": [{ "source": 0, "sampler": 0 }],
            "materials": [
                { "pbrMetallicRoughness": surface([0.9, 0.6, 0.1, 1.0]) },
                { "pbrMetallicRoughness": surface([0.2, 0.6, 0.9, 1.0]),
                  "alphaMode": "MASK", "alphaCutoff": 0.5 },
            ],
            "meshes": [{ "primitives": [primitive(0, &[])] }, { "primitives": [primitive(1, &[])] }],
            "nodes": [{ "mesh": 0, "translation": [-1.2, 0.0, -4.0] },
                { "mesh": 1, "translation": [1.2, 0.0, -4.0] }],
            "scenes": [{ "nodes": [0, 1] }],
        }),
    );
}

/// Vertex colours below turned and scaled parents, and something that shines by itself.
fn coloured(folder: &Path) {
    let mut model = Model::square();
    let colors = [
        [0.9, 0.1, 0.1, 1.0],
        [0.1, 0.9, 0.1, 1.0],
        [0.1, 0.9, 0.1, 1.0],
        [0.9, 0.1, 0.1, 1.0],
    ];
    let colors = model.floats("VEC4", &colors.concat());
    let [metallic, rough] = MATTE;
    model.write(
        folder,
        "coloured.gltf",
        json!({
            "extensionsUsed": ["KHR_materials_emissive_strength", "KHR_materials_unlit"],
            "materials": [
                { "pbrMetallicRoughness": { "metallicFactor": metallic, "roughnessFactor": rough } },
                { "pbrMetallicRoughness": { "baseColorFactor": [0.0, 0.0, 0.0, 1.0] },
                  "emissiveFactor": [0.1, 0.2, 0.4],
                  "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 2.0 } } },
            ],
            "meshes": [{ "primitives": [primitive(0, &[("COLOR_0", colors)])] },
                { "primitives": [primitive(1, &[])] }],
            "nodes": [
                { "children": [1, 2], "translation": [0.0, 0.0, -4.0] },
                // Upside down: green is at the left then.
                { "children": [3], "translation": [-1.2, 0.0, 0.0], "rotation": [0.0, 0.0, 1.0, 0.0],
                  "scale": [0.5, 0.5, 1.0] },
                { "mesh": 1, "translation": [1.2, 0.0, 0.0] },
                { "mesh": 0, "scale": [2.0, 2.0, 1.0] },
            ],
            "scenes": [{ "nodes": [0] }],
        }),
    );
}

/// One that hangs on a joint elsewhere, and one that a morph target moves.
fn bent(folder: &Path) {
    let mut model = Model::square();
    let joints = model.array(5121, "VEC4", 4, &[0; 16]);
    let weights = model.floats("VEC4", &[[1.0, 0.0, 0.0, 0.0]; 4].concat());
    let identity = Mat4::IDENTITY.to_cols_array();
    let bind_poses = model.floats("MAT4", &identity);
    let aside = model.floats("VEC3", &[[2.4, 0.0, 0.0]; 4].concat());
    let skinned = primitive(0, &[("JOINTS_0", joints), ("WEIGHTS_0", weights)]);
    let mut morphed = primitive(1, &[]);
    morphed["targets"] = json!([{ "POSITION": aside }]);
    let [metallic, rough] = MATTE;
    let surface = |color: [f32; 4]| {
        json!({ "pbrMetallicRoughness": { "baseColorFactor": color,
            "metallicFactor": metallic, "roughnessFactor": rough } })
    };
    model.write(
        folder,
        "bent.gltf",
        json!({
            "materials": [surface([0.8, 0.2, 0.1, 1.0]), surface([0.1, 0.3, 0.8, 1.0])],
            "meshes": [{ "primitives": [skinned] },
                { "primitives": [morphed], "weights": [0.5] }],
            "skins": [{ "joints": [1], "inverseBindMatrices": bind_poses }],
            "nodes": [
                { "mesh": 0, "skin": 0 },
                { "name": "bone", "translation": [-1.2, 0.0, -4.0] },
                { "mesh": 1, "translation": [0.0, 0.0, -4.0] },
            ],
            "scenes": [{ "nodes": [0, 1, 2] }],
        }),
    );
}

/// Until a model and all that it names are there.
fn load(stage: &mut Stage, name: &str) {
    let server = stage.world().resource::<AssetServer>().clone();
    let scene = server.load(GltfAssetLabel::Scene(0).from_asset(name.to_owned()));
    stage.put((WorldAssetRoot(scene.clone()), Transform::default()));
    let start = Instant::now();
    while !server.is_loaded_with_dependencies(&scene) {
        stage.game.app.update();
        let state = server.load_state(&scene);
        assert!(!matches!(state, LoadState::Failed(_)), "{name}: {state:?}");
        assert!(
            start.elapsed() < super::super::PATIENCE,
            "{name}: {state:?}"
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

/// The colours of all that is traced, in an order of their own.
fn diffuse(world: &mut World) -> Vec<[f32; 3]> {
    let mut objects = world.query_filtered::<(&Phong, Option<&UsesMaterial>), With<Mesh3d>>();
    let of = |(own, shared): (&Phong, Option<&UsesMaterial>)| {
        let shared = shared.and_then(|shared| world.get::<Phong>(shared.0));
        shared.unwrap_or(own).diffuse.to_f32_array()
    };
    let colors = objects.iter(world).map(of);
    let mut colors: Vec<[f32; 3]> = colors.map(|[r, g, b, _]| [r, g, b]).collect();
    colors.sort_by(|a, b| a.partial_cmp(b).expect("a colour is a number"));
    colors
}

/// What is traced of a model that our reader has brought in, as the stage's camera sees it and in the stage's light,
/// beside what is traced on the stage: how much of the picture is another.
fn other_to_our_reader(stage: &mut Stage, file: &Path) -> f32 {
    let mut ours = headless_app();
    let source = SceneSource::File(file.to_path_buf());
    open(ours.world_mut(), &source, OpenOptions::default()).expect("a model");
    // What our reader lights a model by that has no light.
    let mut lamps = (ours.world_mut()).query_filtered::<Entity, With<DirectionalLamp>>();
    let lamps: Vec<Entity> = lamps.iter(ours.world()).collect();
    for lamp in lamps {
        ours.world_mut().despawn(lamp);
    }
    let camera = stage.camera;
    let world = stage.world();
    let mut lamps = world.query::<(&DirectionalLamp, &Transform)>();
    for (lamp, place) in lamps.iter(world) {
        ours.world_mut().spawn((lamp.clone(), *place));
    }
    ours.insert_resource(world.resource::<Environment>().clone());
    ours.update();
    let ours = ours.world().resource::<Traced>().world.clone();
    let render = world.get::<TracedRender>(camera).expect("it is a view");
    let (theirs, camera, settings) = render.subject().expect("it has rendered");
    let picture = |world| render_world(world, camera, settings, &|_, _| {}).picture;
    let [theirs, ours] = [theirs, &ours].map(|world| picture(world));
    let pixels = theirs.pixels.iter().zip(&ours.pixels);
    // Edges may be rounded another way.
    let other = pixels.filter(|(a, b)| (**a - **b).abs().max_element() > 0.01);
    other.count() as f32 / theirs.pixels.len() as f32
}

#[test]
fn models_of_bevys_asset_server_look_as_bevy_draws_them_and_as_our_reader_reads_them() {
    let folder = tempfile::tempdir().unwrap();
    textured(folder.path());
    coloured(folder.path());
    bent(folder.path());
    let assets = AssetPlugin {
        file_path: folder.path().display().to_string(),
        ..default()
    };
    let Some(mut stage) = Stage::open(assets) else {
        return;
    };
    let quarters: [Part; 4] = [
        [0.1, 0.3, 0.22, 0.7],
        [0.28, 0.3, 0.4, 0.7],
        [0.6, 0.3, 0.72, 0.7],
        [0.78, 0.3, 0.9, 0.7],
    ];
    let mut faults = Vec::new();
    for name in ["textured.gltf", "coloured.gltf", "bent.gltf"] {
        load(&mut stage, name);
        let sun = DirectionalLight {
            illuminance: 3000.0,
            shadow_maps_enabled: true,
            ..default()
        };
        stage.put((sun, Transform::IDENTITY.looking_to(Vec3::NEG_Z, Vec3::Y)));
        let (shots, problems) = stage.both();
        let parts = quarters.iter().chain([&LEFT, &RIGHT]);
        let others = parts.filter_map(|&part| unlike(&shots, part, 1.05));
        faults.extend(others.map(|what| format!("{name}: {what}")));
        faults.extend(problems.iter().map(|problem| format!("{name}: {problem}")));
        let (mut ours, _) = opened(&folder.path().join(name));
        let (theirs, ours) = (diffuse(stage.world()), diffuse(ours.world_mut()));
        if theirs != ours {
            faults.push(format!("{name}: {theirs:?} by Bevy, {ours:?} by ours"));
        }
        let other = other_to_our_reader(&mut stage, &folder.path().join(name));
        if other > 0.01 {
            faults.push(format!(
                "{name}: {other} of the picture is another by our reader"
            ));
        }
        stage.clear();
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
