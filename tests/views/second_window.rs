//! A second window, on a display that is started for the test.

use crate::window::{Display, finish, missing};
use bevy::camera::RenderTarget;
use bevy::mesh::PlaneMeshBuilder;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::{PrimaryWindow, WindowRef};
use bevy::winit::WinitSettings;
use glassbox::film::State;
use glassbox::prelude::*;
use std::process::Command;

/// Tells the test that it was begun on a display of its own.
const BEGUN: &str = "GLASSBOX_TEST_WINDOWS";

#[test]
fn a_second_window_shows_its_own_picture() {
    let Some(display) = Display::open() else {
        return;
    };
    // A process has one event loop, which keeps the display that it was begun with.
    let test = "views::second_window::in_two_windows";
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["--ignored", "--exact", test, "--nocapture"])
        .env(BEGUN, "1");
    let output = finish(display.show(command));
    let (out, err) = crate::cli::texts(&output);
    assert!(out.contains("1 passed"), "{out}\n{err}");
}

/// What each window shows in its middle, by whether it is the primary one.
#[derive(Resource, Default)]
struct Shots {
    asked: bool,
    seen: Vec<(bool, [u8; 3])>,
}

#[test]
#[ignore = "begun by a_second_window_shows_its_own_picture, on a display of its own"]
fn in_two_windows() {
    if std::env::var_os(BEGUN).is_none() {
        missing("this opens windows: a_second_window_shows_its_own_picture begins it");
        return;
    }
    let mut app = App::new();
    app.add_plugins((super::plugins_for(small("first")), GlassboxPlugins))
        .insert_resource(WinitSettings::continuous())
        .insert_resource(ClearColor(Color::BLACK))
        .insert_resource(RenderSettings {
            spp: 2,
            ..default()
        })
        .init_resource::<Shots>()
        .add_systems(Startup, spawn)
        .add_systems(Update, look);
    assert!(app.run().is_success());
}

fn small(title: &str) -> Window {
    Window {
        title: title.into(),
        resolution: (96, 64).into(),
        ..default()
    }
}

/// A red wall at -Z for the first window, a green one at +Z for the other.
fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
    let other = commands.spawn(small("second")).id();
    let windows = [WindowRef::Primary, WindowRef::Entity(other)];
    let walls = [(Dir3::NEG_Z, LinearRgba::RED), (Dir3::Z, LinearRgba::GREEN)];
    for (window, (direction, color)) in windows.into_iter().zip(walls) {
        let wall = PlaneMeshBuilder::new(Dir3::Z, Vec2::splat(20.0)).build();
        let glow = Phong {
            diffuse: LinearRgba::BLACK,
            emission: color,
            ..default()
        };
        commands.spawn((
            Mesh3d(meshes.add(wall)),
            glow,
            super::facing_origin(direction, 5.0),
        ));
        commands.spawn((
            Camera3d::default(),
            TracedView::default(),
            RenderTarget::Window(window),
            Transform::IDENTITY.looking_to(direction, Vec3::Y),
        ));
    }
}

fn look(
    views: Query<&TracedRender>,
    traced: Res<Traced>,
    windows: Query<(Entity, Has<PrimaryWindow>), With<Window>>,
    mut frames: Local<u32>,
    mut shots: ResMut<Shots>,
    mut commands: Commands,
    mut exit: MessageWriter<AppExit>,
) {
    let is_done = |view: &TracedRender| {
        let ended = view.status().map(|status| status.state);
        matches!(ended, Some(State::Ended(_))) && view.shown().is_some()
    };
    let all = traced.pending == 0 && views.iter().count() == 2 && views.iter().all(is_done);
    *frames = if all { *frames + 1 } else { 0 };
    // The last print is on the screen by then.
    if *frames > 10 && !shots.asked {
        shots.asked = true;
        for (window, is_first) in &windows {
            commands.spawn(Screenshot::window(window)).observe(
                move |captured: On<ScreenshotCaptured>, mut shots: ResMut<Shots>| {
                    let color = captured.image.get_color_at(48, 32);
                    let [r, g, b, _] = color.unwrap().to_srgba().to_u8_array();
                    shots.seen.push((is_first, [r, g, b]));
                },
            );
        }
    }
    if shots.seen.len() == 2 {
        shots.seen.sort_by_key(|(is_first, _)| !is_first);
        let wanted = [(true, [255, 0, 0]), (false, [0, 255, 0])];
        let is_so = shots.seen == wanted;
        if !is_so {
            eprintln!("{:?}, not {wanted:?}", shots.seen);
        }
        exit.write(if is_so {
            AppExit::Success
        } else {
            AppExit::error()
        });
    }
}
