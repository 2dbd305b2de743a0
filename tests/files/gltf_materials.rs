//! What a glTF's materials become.

use super::gltf::{document, plain};
use super::models::objects;
use bevy::color::LinearRgba;
use bevy::image::Image;
use bevy::mesh::{Mesh, Mesh3d, VertexAttributeValues};
use bevy::prelude::Assets;
use glassbox::scene::*;
use serde_json::{Value, json};

#[test]
fn texture_coordinates_take_the_transform_of_the_base_colors_picture() {
    let (mut app, _) = document(plain(), |d| {
        let transform = json!({ "offset": [0.25, 0.0], "scale": [2.0, 4.0] });
        d["images"] = json!([{ "uri": "a%20b.png" }]);
        d["textures"] = json!([{ "source": 0 }]);
        d["extensionsUsed"] = json!(["KHR_texture_transform"]);
        d["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": {
            "index": 0, "extensions": { "KHR_texture_transform": transform },
        } } }]);
        d["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    let world = app.world_mut();
    let handle = world
        .query::<&Mesh3d>()
        .iter(world)
        .next()
        .unwrap()
        .0
        .clone();
    let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
    let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute(Mesh::ATTRIBUTE_UV_0) else {
        panic!("no texture coordinates");
    };
    // Half of 65,535 is truncated to 32,767.
    let half = 32_767.0 / 65_535.0;
    assert_eq!(uvs[3], [2.25, 4.0 * half]);
    let maps = world
        .query::<&PhongMaps>()
        .iter(world)
        .next()
        .cloned()
        .unwrap();
    let images = world.resource::<Assets<Image>>();
    assert!(
        maps.diffuse
            .is_some_and(|handle| images.get(&handle).is_some())
    );
}

#[test]
fn metal_and_roughness_become_phong_by_the_rule() {
    let material = |metal: f32, rough: f32| {
        let (mut app, _) = document(plain(), |d| {
            d["materials"] = json!([{ "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 1.0, 0.5],
                "metallicFactor": metal, "roughnessFactor": rough,
            } }]);
            d["meshes"][0]["primitives"][0]["material"] = json!(0);
        });
        objects(app.world_mut())[0].1.clone()
    };
    let base = LinearRgba::rgb(0.5, 0.25, 1.0);
    let mirror = material(1.0, 0.0);
    assert_eq!((mirror.diffuse, mirror.specular), (LinearRgba::BLACK, base));
    assert_eq!(mirror.mirror, base);
    assert_eq!(mirror.shininess, 10_000.0);
    assert_eq!(
        mirror.opacity, 1.0,
        "alpha counts only where it is asked for"
    );
    let chalk = material(0.0, 1.0);
    assert_eq!((chalk.diffuse, chalk.specular), (base, LinearRgba::BLACK));
    assert_eq!(chalk.shininess, 1.0);
    let plastic = material(0.0, 0.5);
    assert!(
        (plastic.specular.red - 0.01).abs() < 1e-6,
        "{:?}",
        plastic.specular
    );
    assert!(
        (plastic.shininess - 30.0).abs() < 1e-4,
        "{}",
        plastic.shininess
    );
}

#[test]
fn materials_of_extensions_become_phong() {
    let material = |material: Value| {
        let (mut app, notes) = document(plain(), |d| {
            d["materials"] = json!([material]);
            d["meshes"][0]["primitives"][0]["material"] = json!(0);
        });
        (objects(app.world_mut())[0].1.clone(), notes)
    };
    let color = json!({ "baseColorFactor": [0.5, 0.25, 0.0, 0.6], "metallicFactor": 0.0 });
    let (unlit, _) = material(json!({
        "pbrMetallicRoughness": color, "extensions": { "KHR_materials_unlit": {} },
    }));
    assert_eq!(unlit.emission, LinearRgba::rgb(0.5, 0.25, 0.0));
    assert_eq!(
        (unlit.diffuse, unlit.specular, unlit.mirror),
        (LinearRgba::BLACK, LinearRgba::BLACK, LinearRgba::BLACK)
    );
    for (mode, cutoff, opacity, alpha) in [
        ("OPAQUE", 0.9, 1.0, Alpha::Opaque),
        ("MASK", 0.5, 0.6, Alpha::Mask { cutoff: 0.5 }),
        ("MASK", 0.7, 0.6, Alpha::Mask { cutoff: 0.7 }),
        ("BLEND", 0.9, 0.6, Alpha::Blend),
    ] {
        let (phong, _) = material(json!({
            "pbrMetallicRoughness": color, "alphaMode": mode, "alphaCutoff": cutoff,
        }));
        let found = (phong.opacity, phong.alpha);
        assert_eq!(found, (opacity, alpha), "{mode} at {cutoff}");
    }
    let glass = json!({ "KHR_materials_transmission": { "transmissionFactor": 0.75 } });
    let (glass, notes) = material(json!({ "extensions": glass }));
    assert_eq!(glass.opacity, 0.25);
    assert!(
        notes.iter().any(|note| note.contains("transmission")),
        "{notes:?}"
    );
    let glossy = json!({ "diffuseFactor": [0.1, 0.2, 0.3, 1.0], "specularFactor": [0.5, 0.4, 0.3],
        "glossinessFactor": 1.0 });
    let (glossy, _) = material(json!({
        "extensions": { "KHR_materials_pbrSpecularGlossiness": glossy },
    }));
    assert_eq!(glossy.diffuse, LinearRgba::rgb(0.1, 0.2, 0.3));
    assert_eq!(glossy.specular, LinearRgba::rgb(0.5, 0.4, 0.3));
    let (glowing, notes) = material(json!({
        "emissiveFactor": [1.0, 1.0, 1.0], "emissiveTexture": { "index": 0 },
    }));
    assert_eq!(
        glowing.emission,
        LinearRgba::BLACK,
        "a factor without its picture"
    );
    assert!(
        notes.iter().any(|note| note.contains("no picture there")),
        "{notes:?}"
    );
    let (mut app, _) = document(plain(), |_| {});
    let none = objects(app.world_mut())[0].1.clone();
    assert_eq!(none.diffuse, LinearRgba::WHITE, "without a material");
}
