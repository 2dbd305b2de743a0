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
fn the_colours_of_vertices_of_what_is_unlit_are_seen_and_need_no_note() {
    let (mut app, notes) = document(plain(), |d| {
        d["materials"] = json!([{ "extensions": { "KHR_materials_unlit": {} } }]);
        let primitive = &mut d["meshes"][0]["primitives"][0];
        primitive["material"] = json!(0);
        // The positions once more, as colours.
        primitive["attributes"]["COLOR_0"] = json!(0);
    });
    assert!(
        !notes.iter().any(|note| note.contains("unlit")),
        "{notes:?}"
    );
    let (_, phong, _) = &objects(app.world_mut())[0];
    // What has no body shows the colours of its vertices as it shines.
    assert_eq!(phong.diffuse, LinearRgba::BLACK);
    assert_eq!(phong.emission, LinearRgba::WHITE);
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

#[test]
fn pictures_of_reflections_are_taken_where_nothing_is_metal() {
    let pbr = json!({ "metallicFactor": 0.0, "roughnessFactor": 0.0 });
    let specular = |textures: Value| {
        let extensions = json!({ "KHR_materials_specular": textures });
        pictured(
            json!({ "pbrMetallicRoughness": pbr, "extensions": extensions }),
            json!([]),
        )
    };
    let texture = json!({ "index": 0 });
    for (textures, path) in [
        (json!({ "specularColorTexture": texture }), "a b.png"),
        (json!({ "specularTexture": texture }), "a b.png#alpha"),
    ] {
        let (phong, notes) = specular(textures);
        let expected = Some(TextureSource::new(path));
        assert_eq!(
            (&phong.specular_map, &phong.mirror_map),
            (&expected, &expected)
        );
        assert_eq!(notes, [""; 0]);
    }
    let both = json!({ "specularColorTexture": texture, "specularTexture": texture });
    let (phong, notes) = specular(both);
    assert_eq!(phong.specular_map, Some(TextureSource::new("a b.png")));
    assert!(
        notes.len() == 1 && notes[0].contains("strength"),
        "{notes:?}"
    );
}

#[test]
fn a_picture_of_specular_and_glossiness_gives_reflections_their_colour() {
    let glossy =
        json!({ "specularGlossinessTexture": { "index": 0 }, "specularFactor": [0.5, 0.5, 0.5] });
    let extensions = json!({ "KHR_materials_pbrSpecularGlossiness": glossy });
    let (phong, notes) = pictured(json!({ "extensions": extensions }), json!([]));
    let picture = Some(TextureSource::new("a b.png"));
    assert_eq!(
        (&phong.specular_map, &phong.mirror_map),
        (&picture, &picture)
    );
    // The picture has no alpha: as glossy as the factor says.
    assert_eq!(phong.mirror, LinearRgba::rgb(0.5, 0.5, 0.5));
    assert_eq!(notes, [""; 0]);
}

#[test]
fn what_refers_to_nothing_or_means_nothing_is_told() {
    let lower = json!({ "alphaMode": "mask" });
    let (phong, notes) = pictured(lower, json!([]));
    assert_eq!(phong.alpha, Alpha::Opaque);
    assert!(
        notes.iter().any(|note| note.contains("alphaMode")),
        "{notes:?}"
    );
    let texture = json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 1 }, "metallicFactor": 0.0 } });
    // The second texture has a sampler, and here there are none.
    let (_, notes) = pictured(texture, json!([]));
    assert!(
        notes.iter().any(|note| note.contains("sampler 0")),
        "{notes:?}"
    );
    let (_, notes) = document(plain(), |d| d["scene"] = json!(7));
    assert!(
        notes.iter().any(|note| note.contains("scene 7")),
        "{notes:?}"
    );
    let (_, notes) = document(
        json!({ "attributes": { "POSITION": 0 }, "indices": 2, "material": 0 }),
        |d| {
            d["images"] = json!([{ "uri": "a%20b.png" }]);
            d["textures"] = json!([{ "source": 0 }]);
            d["materials"] =
                json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
        },
    );
    assert!(
        notes.iter().any(|note| note.contains("TEXCOORD_0")),
        "{notes:?}"
    );
}

#[test]
fn numbers_and_modes_that_gltf_does_not_have_are_told() {
    let told = |notes: &[String], what: &str| {
        let some = notes.iter().filter(|note| note.contains(what)).count();
        assert_eq!(some, 1, "{what}: {notes:#?}");
    };
    let sampled = |sampler: Value| {
        let base = json!({ "baseColorTexture": { "index": 1 }, "metallicFactor": 0.0 });
        let (phong, notes) = pictured(
            json!({ "pbrMetallicRoughness": base }),
            json!([sampler.clone()]),
        );
        let map = phong.diffuse_map.expect("a picture");
        assert_eq!((map.wrap_u, map.wrap_v), (Wrap::Repeat, Wrap::Repeat));
        notes
    };
    for (key, number) in [
        ("wrapS", 1),
        ("wrapT", 33_070),
        ("magFilter", 9987),
        ("minFilter", 1),
    ] {
        told(&sampled(json!({ key: number })), key);
    }
    let known = json!({ "wrapS": 10_497, "wrapT": 10_497, "magFilter": 9729, "minFilter": 9984 });
    assert_eq!(sampled(known), [""; 0]);

    let pbr = |key: &str, value: Value| json!({ "pbrMetallicRoughness": { key: value } });
    let of = |extension: &str, key: &str, value: Value| json!({ "extensions": { extension: { key: value } } });
    let glossy = "KHR_materials_pbrSpecularGlossiness";
    for material in [
        pbr("baseColorFactor", json!([5.0, 0.0, 0.0, 1.0])),
        pbr("baseColorFactor", json!([0.0, 0.0, 0.0, -1.0])),
        pbr("metallicFactor", json!(1.5)),
        pbr("roughnessFactor", json!(-0.1)),
        of(glossy, "diffuseFactor", json!([0.0, 2.0, 0.0, 1.0])),
        of(glossy, "specularFactor", json!([0.0, 2.0, 0.0])),
        of(glossy, "glossinessFactor", json!(7)),
        of("KHR_materials_specular", "specularFactor", json!(2)),
        of(
            "KHR_materials_transmission",
            "transmissionFactor",
            json!(-1),
        ),
        json!({ "emissiveFactor": [0.0, -1.0, 0.0] }),
        json!({ "alphaMode": "MASK", "alphaCutoff": -1.0 }),
    ] {
        let (_, notes) = pictured(material, json!([]));
        told(&notes, "outside glTF's ranges");
    }
    let (_, notes) = pictured(
        json!({ "pbrMetallicRoughness": { "baseColorFactor": [0.0, 1.0, 0.5, 1.0],
            "metallicFactor": 0.0, "roughnessFactor": 1 }, "emissiveFactor": [2.0, 0.0, 0.0] }),
        json!([]),
    );
    assert!(
        !notes.iter().any(|note| note.contains("ranges")),
        "{notes:?}"
    );

    let (_, notes) = document(plain(), |d| {
        d["materials"] = json!([{}]);
        d["meshes"][0]["primitives"][0]["material"] = json!(7);
    });
    told(&notes, "material 7, which there is not");
    let (_, notes) = document(plain(), |d| {
        d["nodes"][0]["rotation"] = json!([0.0, 0.0, 0.0, 5.0]);
    });
    told(&notes, "not of length 1");
    let lit = |light: Value| {
        let (_, notes) = document(plain(), |d| {
            d["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
            d["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
        });
        notes
    };
    for (inner, outer) in [(1.0, 0.5), (-0.1, 0.5), (0.0, 2.0)] {
        let spot = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        let notes = lit(json!({ "type": "spot", "intensity": 1000, "spot": spot }));
        told(&notes, "none of a cone");
    }
    let notes = lit(json!({ "type": "spot", "intensity": 1000 }));
    assert!(!notes.iter().any(|note| note.contains("cone")), "{notes:?}");
    let notes = lit(json!({ "type": "point", "intensity": -5.0 }));
    told(&notes, "impossible numbers");
    assert!(
        !notes.iter().any(|note| note.contains("`type`")),
        "{notes:?}"
    );
}
