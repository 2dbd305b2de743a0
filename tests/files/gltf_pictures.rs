//! What materials of glTF say with pictures.

use super::gltf::{document, plain};
use super::models::objects;
use bevy::color::LinearRgba;
use glassbox::scene::{Alpha, MapFilter, Phong, TextureSource, Wrap};
use serde_json::{Value, json};

/// The material of a document with one picture, of several textures with these samplers.
fn pictured(material: Value, samplers: Value) -> (Phong, Vec<String>) {
    let (mut app, notes) = document(plain(), |d| {
        d["images"] = json!([{ "uri": "a%20b.png" }]);
        d["textures"] = json!([{ "source": 0 }, { "source": 0, "sampler": 0 }]);
        if samplers != json!([]) {
            d["samplers"] = samplers;
        }
        d["materials"] = json!([material]);
        d["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    // That light and a camera were added is said elsewhere.
    let notes = notes.into_iter();
    let notes = notes.filter(|note| !note.contains("was added") && !note.contains("were added"));
    (objects(app.world_mut())[0].1.clone(), notes.collect())
}

#[test]
fn every_picture_that_phong_has_a_place_for_is_taken_with_its_factor_and_sampler() {
    let (phong, notes) = pictured(
        json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0.0,
                "baseColorFactor": [0.5, 0.25, 1.0, 0.75] },
            "emissiveTexture": { "index": 1 }, "emissiveFactor": [1.0, 0.5, 0.25],
            "normalTexture": { "index": 1, "scale": 0.5 },
            "alphaMode": "MASK", "alphaCutoff": 0.25,
        }),
        json!([{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987 }]),
    );
    assert_eq!(notes, [""; 0]);
    let plain = TextureSource::new("a b.png");
    let sampled = TextureSource {
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Mirror,
        filter: MapFilter::Nearest,
        ..plain.clone()
    };
    assert_eq!(phong.diffuse, LinearRgba::rgb(0.5, 0.25, 1.0));
    assert_eq!(phong.diffuse_map, Some(plain));
    assert_eq!(phong.emission, LinearRgba::rgb(1.0, 0.5, 0.25));
    assert_eq!(phong.emission_map, Some(sampled.clone()));
    assert_eq!((phong.normal_map, phong.normal_scale), (Some(sampled), 0.5));
    assert_eq!(
        (phong.opacity, phong.alpha),
        (0.75, Alpha::Mask { cutoff: 0.25 })
    );
    let cut_out = phong.opacity_map.map(|map| map.path);
    assert_eq!(cut_out.as_deref(), Some("a b.png#alpha"));
}

#[test]
fn a_metal_reflects_in_its_picture_and_what_is_unlit_shows_it() {
    let base = json!({ "baseColorTexture": { "index": 0 }, "roughnessFactor": 0.0 });
    let (metal, _) = pictured(json!({ "pbrMetallicRoughness": base }), json!([]));
    let picture = Some(TextureSource::new("a b.png"));
    assert_eq!(
        (&metal.specular_map, &metal.mirror_map),
        (&picture, &picture)
    );
    assert_eq!(metal.mirror, LinearRgba::WHITE);
    let extensions = json!({ "KHR_materials_unlit": {} });
    let unlit = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 },
        "baseColorFactor": [0.5, 0.25, 1.0, 1.0], "metallicFactor": 0.0 }, "extensions": extensions });
    let (unlit, notes) = pictured(unlit, json!([]));
    assert_eq!(notes, [""; 0]);
    assert_eq!((unlit.emission_map, unlit.diffuse_map), (picture, None));
    assert_eq!(unlit.emission, LinearRgba::rgb(0.5, 0.25, 1.0));
}
