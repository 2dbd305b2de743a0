//! What stands where in a glTF file: morph weights, skins, instances.

use super::gltf::{POSITIONS, base64, corners, document, place, plain};
use super::models::objects;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::prelude::Assets;
use glassbox::scene::SceneId;
use serde_json::json;

#[test]
fn morph_weights_and_skins_stand_as_the_file_starts_with_them() {
    let primitive =
        json!({ "attributes": { "POSITION": 0 }, "indices": 2, "targets": [{ "POSITION": 0 }] });
    for (of_mesh, of_node, factor) in [(0.5, None, 1.5), (0.5, Some(2.0), 3.0)] {
        let (mut app, _) = document(primitive.clone(), |d| {
            d["meshes"][0]["weights"] = json!([of_mesh]);
            if let Some(weight) = of_node {
                d["nodes"][0]["weights"] = json!([weight]);
            }
        });
        assert_eq!(corners(&mut app)[0][1], factor * Vec3::from(POSITIONS[1]));
    }
    let primitive =
        json!({ "attributes": { "POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 4 }, "indices": 2 });
    let (mut app, notes) = document(primitive, |d| {
        // All weight on the first joint: bytes of zeros, and of ones behind every fourth.
        let bytes = [[0_u8; 20], [255, 0, 0, 0].repeat(5).try_into().unwrap()].concat();
        let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
        d["buffers"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "byteLength": 40, "uri": uri }));
        let views = d["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 1, "byteLength": 20 }));
        views.push(json!({ "buffer": 1, "byteOffset": 20, "byteLength": 20 }));
        let accessors = d["accessors"].as_array_mut().unwrap();
        for (view, normalized) in [(3, false), (4, true)] {
            accessors.push(
                json!({ "bufferView": view, "componentType": 5121, "count": 5,
                "type": "VEC4", "normalized": normalized }),
            );
        }
        d["skins"] = json!([{ "joints": [1] }]);
        d["nodes"] = json!([
            { "mesh": 0, "skin": 0, "translation": [50.0, 0.0, 0.0] },
            { "name": "bone", "translation": [0.0, 3.0, 0.0], "scale": [2.0, 2.0, 2.0] },
        ]);
        d["scenes"] = json!([{ "nodes": [0, 1] }]);
    });
    let expected = 2.0 * Vec3::from(POSITIONS[1]) + Vec3::new(0.0, 3.0, 0.0);
    let found = corners(&mut app)[0][1];
    assert!(found.abs_diff_eq(expected, 1e-5), "{found}: {notes:?}");
    let world = app.world_mut();
    let mut shown = world
        .query_filtered::<&bevy::transform::components::Transform, bevy::prelude::With<Mesh3d>>();
    let places: Vec<_> = shown.iter(world).map(|place| place.translation).collect();
    assert_eq!(places, [Vec3::ZERO], "the joint places it, not the node");
}

#[test]
fn a_mesh_that_is_instanced_is_there_as_often() {
    let (mut app, notes) = document(plain(), |d| {
        // The positions serve as places.
        let instancing = json!({ "attributes": { "TRANSLATION": 0 } });
        d["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": instancing });
        d["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    });
    assert_eq!(objects(app.world_mut()).len(), POSITIONS.len(), "{notes:?}");
    for (i, [x, y, z]) in POSITIONS.into_iter().enumerate() {
        let place = place(app.world_mut(), &format!("node/{i}"));
        assert_eq!(place.translation, Vec3::new(x, y, z).into());
    }
}

#[test]
fn vertices_that_no_triangle_has_are_not_there() {
    // The indices name four of the five vertices.
    let (mut app, _) = document(plain(), |d| {
        d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(0);
    });
    assert_eq!(corners(&mut app).len(), 2);
    let world = app.world_mut();
    let handle = world.query::<&Mesh3d>().single(world).unwrap().0.clone();
    let mesh = world.resource::<Assets<Mesh>>().get(&handle).unwrap();
    let counts: Vec<usize> = mesh.attributes().map(|(_, values)| values.len()).collect();
    assert_eq!(counts, [4; 3]);
}

#[test]
fn what_a_matrix_shears_is_sheared_here_with_all_that_stands_below_it() {
    use bevy::math::{Affine3A, Mat4, Vec4};
    let columns = |matrix: Mat4| matrix.to_cols_array().to_vec();
    // Far away, where the shear is small beside the translation.
    let above = Mat4::from_cols(
        Vec4::new(1.0, 0.0, 0.0, 0.0),
        Vec4::new(0.5, 2.0, 0.0, 0.0),
        Vec4::new(0.0, -0.25, 1.0, 0.0),
        Vec4::new(9000.0, 0.0, 0.0, 1.0),
    );
    let below = Mat4::from_rotation_z(0.7) * Mat4::from_scale(Vec3::new(1.0, -2.0, 1.0));
    let (mut app, notes) = document(plain(), |d| {
        d["nodes"] = json!([
            { "name": "above", "mesh": 0, "matrix": columns(above), "children": [1] },
            { "name": "below", "mesh": 0, "matrix": columns(below) },
        ]);
    });
    assert!(
        !notes.iter().any(|note| note.contains("shear")),
        "{notes:?}"
    );
    let world = app.world_mut();
    assert_eq!(objects(world).len(), 2);
    for (name, expected) in [("above/turned", above), ("below", above * below)] {
        let off = place(world, name).matrix3 - Affine3A::from_mat4(expected).matrix3;
        let largest = off
            .to_cols_array()
            .map(f32::abs)
            .into_iter()
            .fold(0.0, f32::max);
        assert!(largest < 1e-5, "{name}: {off}");
    }
}

#[test]
fn a_value_of_a_kind_that_is_none_of_its_own_is_told() {
    let (_, notes) = document(plain(), |d| {
        d["nodes"][0]["scale"] = json!([2.0, 2.0]);
        d["nodes"][0]["matrix"] = json!(null);
        d["materials"] = json!([{
            "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.0, 0.0], "roughnessFactor": "rough" },
        }]);
        d["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    for key in ["`scale`", "`baseColorFactor`", "`roughnessFactor`"] {
        let told = notes.iter().filter(|note| note.contains(key));
        assert_eq!(told.count(), 1, "{key}: {notes:#?}");
    }
    assert!(
        !notes.iter().any(|note| note.contains("`matrix`")),
        "{notes:#?}"
    );
}

#[test]
fn a_place_that_is_written_and_read_again_is_the_same_to_the_last_bit() {
    use bevy::math::Mat4;
    use bevy::prelude::With;
    use bevy::transform::components::Transform;
    let turned = |x: f32, y: f32| Mat4::from_rotation_x(x) * Mat4::from_rotation_y(y);
    let (mut app, _) = document(plain(), |d| {
        let matrices = (0..40).map(|i| turned(0.37 * i as f32, 1.3 - 0.1 * i as f32));
        let nodes = matrices.map(|m| json!({ "mesh": 0, "matrix": m.to_cols_array().to_vec() }));
        d["nodes"] = nodes.collect();
        d["nodes"][0] = json!({ "mesh": 0, "rotation": [0.5, 0.5, 0.5, 0.51] });
        d["nodes"][1] = json!({ "mesh": 0, "rotation": [0.70710677, 0.0, 0.0, 0.70710677] });
        d["scenes"] = json!([{ "nodes": (0..40).collect::<Vec<_>>() }]);
    });
    let places = |world: &mut bevy::prelude::World| -> Vec<Transform> {
        let mut shown = world.query_filtered::<(&SceneId, &Transform), With<Mesh3d>>();
        let mut all: Vec<_> = shown.iter(world).map(|(id, at)| (id.0, *at)).collect();
        all.sort_by_key(|(id, _)| *id);
        all.into_iter().map(|(_, at)| at).collect()
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.glb");
    glassbox::io::save(app.world_mut(), &file).unwrap();
    let (mut again, _) = super::app::opened(&file);
    let (first, second) = (places(app.world_mut()), places(again.world_mut()));
    assert_eq!(first.len(), 40);
    let other = first.iter().zip(&second).find(|(a, b)| a != b);
    assert_eq!(other, None);
}

/// A strip whose skin has two joints, after a change; `joints` and `weights` are those of each vertex.
fn skinned(
    joints: [u8; 4],
    weights: [[f32; 4]; 5],
    change: impl FnOnce(&mut serde_json::Value),
) -> (bevy::prelude::App, Vec<String>) {
    let primitive =
        json!({ "attributes": { "POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 4 }, "indices": 2 });
    document(primitive, |d| {
        let weights = weights.into_iter().flatten().flat_map(f32::to_le_bytes);
        let bytes: Vec<u8> = joints.repeat(5).into_iter().chain(weights).collect();
        let uri = format!("data:application/octet-stream;base64,{}", base64(&bytes));
        let buffers = d["buffers"].as_array_mut().unwrap();
        buffers.push(json!({ "byteLength": 100, "uri": uri }));
        let views = d["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 1, "byteLength": 20 }));
        views.push(json!({ "buffer": 1, "byteOffset": 20, "byteLength": 80 }));
        let accessors = d["accessors"].as_array_mut().unwrap();
        for (view, kind) in [(3, 5121), (4, 5126)] {
            accessors.push(
                json!({ "bufferView": view, "componentType": kind, "count": 5, "type": "VEC4" }),
            );
        }
        d["skins"] = json!([{ "joints": [1, 2] }]);
        d["nodes"] = json!([
            { "mesh": 0, "skin": 0 },
            { "translation": [0.0, 0.0, 2.0] },
            { "translation": [0.0, 0.0, 4.0] },
        ]);
        d["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
        change(d);
    })
}

#[test]
fn what_a_skin_cannot_mean_is_told_and_the_rest_of_it_moves_the_mesh() {
    let half = [[0.5, 0.5, 0.0, 0.0]; 5];
    let height = |app: &mut bevy::prelude::App| corners(app)[0][0].z;
    let of_skin = |notes: &[String]| {
        let said = ["joint", "rotation"];
        let said = notes
            .iter()
            .filter(|note| said.iter().any(|word| note.contains(word)));
        said.cloned().collect::<Vec<_>>()
    };
    let (mut app, notes) = skinned([0, 1, 0, 0], half, |_| {});
    assert_eq!((height(&mut app), of_skin(&notes)), (3.0, vec![]));
    let mut some = half;
    some[4] = [0.0; 4];
    let negative = [[1.5, -0.5, 0.0, 0.0]; 5];
    type Change = fn(&mut serde_json::Value);
    let cases: [(_, _, Change, f32, &str); 5] = [
        (
            [0, 7, 0, 0],
            half,
            |_| {},
            2.0,
            "joints that its skin does not have",
        ),
        ([0, 1, 0, 0], negative, |_| {}, 2.0, "below 0 or no numbers"),
        (
            [0, 1, 0, 0],
            some,
            |_| {},
            3.0,
            "vertices that no joint moves",
        ),
        (
            [0, 1, 0, 0],
            half,
            |d| d["skins"][0]["joints"] = json!([1, 99]),
            1.0,
            "a joint that is no node",
        ),
        (
            [0, 1, 0, 0],
            half,
            |d| d["nodes"][1]["rotation"] = json!([0.0, 0.0, 0.0, 0.0]),
            3.0,
            "a rotation of zeros",
        ),
    ];
    for (joints, weights, change, expected, what) in cases {
        let (mut app, notes) = skinned(joints, weights, change);
        let told = of_skin(&notes);
        assert!(
            told.len() == 1 && told[0].contains(what),
            "{what}: {notes:#?}"
        );
        assert_eq!(height(&mut app), expected, "{what}");
    }
}

#[test]
fn a_mesh_whose_skin_cannot_be_used_stands_where_its_node_is() {
    type Change = fn(&mut serde_json::Value);
    let half = [[0.5, 0.5, 0.0, 0.0]; 5];
    let cases: [Change; 3] = [
        |d| d["nodes"][0]["skin"] = json!(99),
        |d| {
            let attributes = &mut d["meshes"][0]["primitives"][0]["attributes"];
            attributes.as_object_mut().unwrap().remove("JOINTS_0");
        },
        |d| d["accessors"][4]["count"] = json!(4),
    ];
    for (number, change) in cases.into_iter().enumerate() {
        let (mut app, notes) = skinned([0, 1, 0, 0], half, |d| {
            d["nodes"][0]["translation"] = json!([50.0, 0.0, 0.0]);
            d["nodes"][0]["children"] = json!([1]);
            d["scenes"] = json!([{ "nodes": [0, 2] }]);
            change(d);
        });
        let told = notes.iter().filter(|note| note.contains("its skin:"));
        assert_eq!(told.count(), 1, "{number}: {notes:#?}");
        let at = place(app.world_mut(), "node 0").translation;
        assert_eq!(at, Vec3::new(50.0, 0.0, 0.0).into(), "{number}");
        assert_eq!(corners(&mut app)[0][1], POSITIONS[1].into(), "{number}");
        let world = app.world_mut();
        let mut shown = world.query::<(&Mesh3d, &bevy::prelude::Transform)>();
        let places: Vec<_> = shown.iter(world).map(|(_, at)| at.translation.x).collect();
        assert_eq!(places, [50.0], "{number}");
    }
}

#[test]
fn what_a_morph_target_moves_besides_is_told() {
    let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 2,
        "targets": [{ "POSITION": 0, "COLOR_0": 0, "TEXCOORD_0": 1 }] });
    let (_, notes) = document(primitive, |d| {
        d["meshes"][0]["weights"] = json!([1.0, 0.5]);
    });
    for what in [
        "`COLOR_0`",
        "`TEXCOORD_0`",
        "more weights than morph targets",
    ] {
        let told = notes.iter().filter(|note| note.contains(what)).count();
        assert_eq!(told, 1, "{what}: {notes:#?}");
    }
}
