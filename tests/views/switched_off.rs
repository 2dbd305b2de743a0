//! An app with the editor in it, and the editor off: the app's own picture and nothing over it.

use crate::window::{Display, finish, missing};
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::winit::WinitSettings;
use glassbox::prelude::*;
use std::path::Path;
use std::process::Command;

/// Tells the app which it is, and where its picture goes.
const WHICH: &str = "GLASSBOX_TEST_APP";
const SHOT: &str = "GLASSBOX_TEST_SHOT";

/// Until the picture is what it will be: pipelines are compiled at once, sizes and cameras settle in a few frames.
const FRAMES: u32 = 30;

#[test]
fn an_editor_that_is_switched_off_draws_nothing_over_the_app() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let shot = |which: &str| {
        let file = folder.path().join(which);
        // A process has one event loop, which keeps the display that it was begun with.
        let test = "views::switched_off::app_with_or_without_the_editor";
        let mut command = Command::new(std::env::current_exe().unwrap());
        command
            .args(["--ignored", "--exact", test, "--nocapture"])
            .current_dir(folder.path())
            .env("GLASSBOX_CONFIG_DIR", folder.path().join("settings"))
            .env(WHICH, which)
            .env(SHOT, &file);
        let output = finish(display.show(command));
        let (out, err) = crate::cli::texts(&output);
        assert!(out.contains("1 passed"), "{which}: {out}\n{err}");
        std::fs::read(file).unwrap()
    };
    let plain = shot("plain");
    let colors: std::collections::HashSet<_> = plain.as_chunks::<4>().0.iter().collect();
    assert!(colors.len() > 20, "the app shows {} colours", colors.len());
    let on = shot("on");
    let differ = |other: &[u8]| {
        assert_eq!(other.len(), plain.len());
        let pixels = plain
            .as_chunks::<4>()
            .0
            .iter()
            .zip(other.as_chunks::<4>().0);
        pixels.filter(|(a, b)| a != b).count()
    };
    let all = plain.len() / 4;
    assert!(differ(&on) > all / 4, "switched on it is seen");
    // The same program draws the same triangles: to the bit.
    for which in ["off", "off again"] {
        assert_eq!(differ(&shot(which)), 0, "of {all} pixels, {which}");
    }
}

#[test]
#[ignore = "begun by an_editor_that_is_switched_off_draws_nothing_over_the_app, on a display of its own"]
fn app_with_or_without_the_editor() {
    let Ok(which) = std::env::var(WHICH) else {
        missing(
            "this opens a window: an_editor_that_is_switched_off_draws_nothing_over_the_app begins it",
        );
        return;
    };
    let mut app = App::new();
    app.add_plugins(super::plugins_for(Window {
        resolution: (320, 200).into(),
        ..default()
    }));
    if which != "plain" {
        let on = which != "off";
        app.add_plugins(EditorPlugins).insert_resource(Editing(on));
    }
    app.insert_resource(WinitSettings::continuous())
        .insert_resource(ClearColor(Color::srgb(0.1, 0.2, 0.4)))
        .add_systems(Startup, spawn)
        .add_systems(Update, look);
    assert!(app.run().is_success());
}

/// A ball and a box in the light of a lamp.
fn spawn(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (mesh, color, x) in [
        (
            Mesh::from(Sphere::new(0.8)),
            Color::srgb(0.9, 0.3, 0.1),
            -1.0,
        ),
        (
            Mesh::from(Cuboid::default()),
            Color::srgb(0.2, 0.8, 0.3),
            1.0,
        ),
    ] {
        commands.spawn((
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(materials.add(color)),
            Transform::from_xyz(x, 0.0, 0.0),
        ));
    }
    let lamp = Transform::from_xyz(2.0, 3.0, 4.0);
    commands.spawn((PointLight::default(), lamp));
    let eye = Transform::from_xyz(0.0, 1.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((Camera3d::default(), eye));
}

/// Takes the picture when the app stands; an app that is `off again` is switched on first, and then off.
fn look(mut frame: Local<u32>, editing: Option<ResMut<Editing>>, mut commands: Commands) {
    *frame += 1;
    let is_again = std::env::var(WHICH).is_ok_and(|which| which == "off again");
    let last = if is_again { 2 * FRAMES } else { FRAMES };
    if let Some(mut editing) = editing
        && is_again
        && *frame == FRAMES
    {
        editing.0 = false;
    }
    if *frame == last {
        commands.spawn(Screenshot::primary_window()).observe(
            |captured: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
                let pixels = captured.image.data.as_ref().unwrap();
                let file = std::env::var_os(SHOT).unwrap();
                std::fs::write(Path::new(&file), pixels).unwrap();
                exit.write(AppExit::Success);
            },
        );
    }
}
