//! A model without lights or a camera is shown so that its shape can be seen.

use super::app::{opened, write};
use bevy::color::LinearRgba;
use bevy::ecs::name::Name;
use bevy::math::Vec3;
use bevy::prelude::{App, Entity, With, World};
use bevy::transform::components::Transform;
use glassbox::io::{Opened, import, save};
use glassbox::scene::*;

fn open(name: &str, text: &str) -> (App, Opened) {
    let folder = tempfile::tempdir().unwrap();
    opened(&write(folder.path(), name, text))
}

/// A box whose faces face outwards, as OBJ.
fn cube(at: [i32; 3], size: i32, first: i32) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let [x, y, z] = [0, 1, 2].map(|axis| at[axis] + size * (i >> axis & 1));
        text += &format!("v {x} {y} {z}\n");
    }
    for face in [
        [1, 3, 4, 2],
        [5, 6, 8, 7],
        [1, 2, 6, 5],
        [3, 7, 8, 4],
        [1, 5, 7, 3],
        [2, 4, 8, 6],
    ] {
        let [a, b, c, d] = face.map(|corner| corner + first - 1);
        text += &format!("f {a} {b} {c} {d}\n");
    }
    text
}

fn lamps(world: &mut World) -> Vec<String> {
    let mut query = world.query_filtered::<&Name, (With<DirectionalLamp>, With<SceneId>)>();
    query.iter(world).map(ToString::to_string).collect()
}

fn notes<'a>(opened: &'a Opened, what: &str) -> Vec<&'a str> {
    let notes = opened.notes.iter().filter(|note| note.what.contains(what));
    notes.map(|note| note.instead).collect()
}

#[test]
fn a_model_without_lights_gets_two_and_a_dome_that_can_be_edited_and_says_so_in_one_note() {
    let (mut app, opened) = open("a.obj", &cube([0; 3], 1, 1));
    let names = lamps(app.world_mut());
    assert_eq!(names, ["Key light", "Back light"]);
    assert_eq!(opened.notes.len(), 2, "{:?}", opened.notes);
    assert_eq!(notes(&opened, "has no light").len(), 1);
    assert_eq!(notes(&opened, "has no camera").len(), 1);
    let environment = app.world().resource::<Environment>();
    let LinearRgba {
        red, green, blue, ..
    } = environment.background;
    assert!(
        red > 0.1 && red == green && green == blue,
        "neutral as they are"
    );
    assert!(environment.lights && environment.hidden, "before black");
}

#[test]
fn the_dome_comes_back_from_glb_and_a_scene_that_it_is_put_into_keeps_its_own() {
    let (mut app, _) = open("a.obj", &cube([0; 3], 1, 1));
    let environment = app.world().resource::<Environment>().clone();
    let names = lamps(app.world_mut());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.glb");
    let notes = save(app.world_mut(), &file).unwrap();
    assert!(
        !notes.iter().any(|note| note.what.contains("environment")),
        "{notes:?}"
    );
    let (mut again, reopened) = opened(&file);
    assert_eq!(*again.world().resource::<Environment>(), environment);
    assert_eq!(lamps(again.world_mut()), names);
    assert_eq!(reopened.notes.len(), 0, "{:?}", reopened.notes);
    let (mut other, _) = open("b.obj", &cube([0; 3], 1, 1));
    let own = Environment::default();
    other.world_mut().insert_resource(own.clone());
    let mut next = 100;
    let imported = import(other.world_mut(), &file, || {
        next += 1;
        SceneId(next)
    })
    .unwrap();
    assert_eq!(
        imported
            .notes
            .iter()
            .filter(|note| note.what == "an environment")
            .count(),
        1
    );
    assert_eq!(*other.world().resource::<Environment>(), own);
    // A dome without lamps is light enough.
    let world = again.world_mut();
    let mut query = world.query_filtered::<Entity, With<DirectionalLamp>>();
    let all: Vec<Entity> = query.iter(world).collect();
    for lamp in all {
        world.despawn(lamp);
    }
    let bare = folder.path().join("bare.glb");
    save(again.world_mut(), &bare).unwrap();
    let (mut dome, reopened) = opened(&bare);
    assert!(lamps(dome.world_mut()).is_empty(), "{:?}", reopened.notes);
    assert_eq!(*dome.world().resource::<Environment>(), environment);
}

#[test]
fn the_dome_of_a_model_without_lights_is_saved_and_opens_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let (mut app, _) = opened(&write(folder.path(), "a.obj", cube([0; 3], 1, 1)));
    let file = folder.path().join("a.scn.ron");
    glassbox::io::save(app.world_mut(), &file).unwrap();
    let (again, _) = opened(&file);
    let dome = |app: &App| app.world().resource::<Environment>().clone();
    assert_eq!(dome(&again), dome(&app));
    assert!(dome(&again).lights);
}

#[test]
fn what_is_dark_itself_stands_before_grey() {
    let folder = tempfile::tempdir().unwrap();
    // Where it shines it does so in spots, and a mirror shows the black around it.
    for shine in ["Ks 0 0 0", "Ks 0.5 0.5 0.5\nillum 2", "Ks 1 1 1\nillum 3"] {
        let mtl = format!("newmtl soot\nKd 0.01 0.01 0.01\n{shine}\n");
        write(folder.path(), "a.mtl", mtl);
        let text = format!("mtllib a.mtl\nusemtl soot\n{}", cube([0; 3], 1, 1));
        let (app, opened) = opened(&write(folder.path(), "a.obj", text));
        let environment = app.world().resource::<Environment>();
        let background = environment.background;
        let is_grey = background.red > 0.1 && background.red == background.blue;
        assert!(is_grey && !environment.hidden, "{shine}: {environment:?}");
        let said = notes(&opened, "has no light");
        assert!(said[0].contains("as the background"), "{:?}", opened.notes);
    }
}

/// Share of the object's pixels that are darker than a linear 0.05.
fn dark_share(text: &str) -> f32 {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a.obj", text);
    let picture = |view: &str| {
        let name = format!("{view}.png");
        let start = ["render", "a.obj", "-o", &name, "--view", view];
        let arguments = [&start[..], &["--size", "64x64", "--spp", "4"]].concat();
        crate::cli::succeeds(folder.path(), &arguments);
        image::open(folder.path().join(name)).unwrap().into_luma8()
    };
    let (shaded, albedo) = (picture("shaded"), picture("albedo"));
    let object: Vec<u8> = (shaded.pixels().zip(albedo.pixels()))
        .filter(|(_, albedo)| albedo.0[0] > 150)
        .map(|(shaded, _)| shaded.0[0])
        .collect();
    let count = object.len();
    assert!(count > 400, "only {count} of 4096 pixels show it");
    // sRGB 63 is 0.05.
    object.iter().filter(|&&value| value < 63).count() as f32 / count as f32
}

#[test]
fn hardly_anything_of_a_model_without_lights_is_black() {
    // A large box with smaller ones on it and before it, which shade it.
    let pile = [
        cube([0; 3], 4, 1),
        cube([1, 4, 1], 2, 9),
        cube([1, 0, 4], 2, 17),
        cube([4, 0, 1], 2, 25),
    ];
    let share = dark_share(&pile.concat());
    assert!(share < 0.02, "{:.1} % are nearly black", 100.0 * share);
}

/// A triangle under a sun of that strength, as glTF.
fn under_a_sun(intensity: f32) -> String {
    let data = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let light = format!(r#"{{"type": "directional", "intensity": {intensity}}}"#);
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {{"KHR_lights_punctual": {{"lights": [{light}]}}}},
        "nodes": [{{"mesh": 0}}, {{"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}],
        "scenes": [{{"nodes": [0, 1]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{data}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}]}}"#
    )
}

#[test]
fn a_picture_that_would_be_nearly_black_is_exposed_and_says_so() {
    let exposure = |app: &App| app.world().resource::<RenderSettings>().output.exposure;
    let (app, opened) = open("a.gltf", &under_a_sun(1e-3));
    let stops = exposure(&app);
    assert!((9.0..24.0).contains(&stops), "by {stops} stops");
    let said = notes(&opened, &format!("by {stops} stops"));
    assert_eq!(said.len(), 1, "{:?}", opened.notes);
    let (mut app, opened) = open("a.gltf", &under_a_sun(500.0));
    assert_eq!(exposure(&app), 0.0);
    assert!(notes(&opened, "stops").is_empty(), "{:?}", opened.notes);
    assert_eq!(lamps(app.world_mut()).len(), 1, "it has its own");
}

#[test]
fn weak_lights_shine_more_where_exposure_would_wash_out_what_glows() {
    let unlit = r#""materials": [{"extensions": {"KHR_materials_unlit": {}}}, {}], "meshes": ["#;
    let text = under_a_sun(1.0).replace(r#""meshes": ["#, unlit);
    let both = r#""primitives": [{"material": 0, "attributes": {"POSITION": 0}},
        {"material": 1, "attributes": {"POSITION": 0}}]"#;
    let text = text.replace(r#""primitives": [{"attributes": {"POSITION": 0}}]"#, both);
    let (mut app, opened) = open("a.gltf", &text);
    let world = app.world_mut();
    assert_eq!(world.resource::<RenderSettings>().output.exposure, 0.0);
    let sun = world
        .query::<&DirectionalLamp>()
        .single(world)
        .unwrap()
        .clone();
    assert!((1.0..4.0).contains(&sun.intensity), "{}", sun.intensity);
    let said = notes(&opened, "all but what glows");
    assert_eq!(said, ["they shine by as much more"], "{:?}", opened.notes);
}

#[test]
fn the_key_light_stands_over_the_left_shoulder_of_whoever_looks() {
    // Its front is where x is less.
    let plate = "v 0 0 0\nv 0 1 0\nv 0 1 1\nv 0 0 1\nf 4 3 2 1\n";
    let (mut app, _) = open("a.obj", plate);
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<&Transform, With<SceneCamera>>();
    let eye = *cameras.single(world).unwrap();
    assert!(eye.forward().x > 0.7, "it looks along {:?}", eye.forward());
    let mut lamps = world.query_filtered::<(&Name, &Transform), With<DirectionalLamp>>();
    let key = lamps
        .iter(world)
        .find(|(name, _)| name.as_str() == "Key light");
    let from = Vec3::from(key.expect("a key light").1.back());
    let left = from.dot(eye.left().into());
    let behind = from.dot(-*eye.forward());
    assert!(left > 0.2 && from.y > 0.5 && behind > 0.5, "{from}");
}

#[test]
fn a_camera_of_the_file_that_looks_past_everything_is_told() {
    let looking = |rotation: &str, kind: &str| {
        let camera = format!(
            r#""cameras": [{kind}], "nodes": [{{"camera": 0,
            "translation": [0.0, 0.0, 5.0], "rotation": {rotation}}}, "#
        );
        let text =
            under_a_sun(500.0).replace(r#""nodes": [{"mesh""#, &format!(r#"{camera}{{"mesh""#));
        let text = text.replace(
            r#""scenes": [{"nodes": [0, 1]}]"#,
            r#""scenes": [{"nodes": [0, 1, 2]}]"#,
        );
        let (_, opened) = open("a.gltf", &text);
        notes(&opened, "looks past everything").len()
    };
    let perspective = r#"{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}"#;
    let orthographic = r#"{"type": "orthographic",
        "orthographic": {"xmag": 2.0, "ymag": 2.0, "znear": 0.0, "zfar": 10.0}}"#;
    for kind in [perspective, orthographic] {
        // Ahead, back, to the side.
        let turns = [
            "[0, 0, 0, 1]",
            "[0, 1, 0, 0]",
            "[0, 0.7071068, 0, 0.7071068]",
        ];
        let told = turns.map(|turn| looking(turn, kind));
        assert_eq!(told, [0, 1, 1], "{kind}");
    }
}
