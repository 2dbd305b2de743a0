//! A game that goes on while a picture of one of its moments is traced to the end.
//!
//! `cargo run --release --example reference_picture`; P writes `reference.png`.

use bevy::prelude::*;
use glassbox::prelude::*;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, GlassboxPlugins))
        .add_systems(Startup, spawn_scene)
        .add_systems(Update, (turn, shoot))
        .run();
}

#[derive(Component)]
struct Turning;

fn spawn_scene(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(8.0, 8.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.6, 0.65, 0.7))),
    ));
    commands.spawn((
        Turning,
        Mesh3d(meshes.add(Cuboid::default())),
        MeshMaterial3d(materials.add(Color::srgb(0.9, 0.35, 0.1))),
        Transform::from_xyz(0.0, 0.8, 0.0),
    ));
    commands.spawn((
        PointLight {
            intensity: 800_000.0,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(3.0, 5.0, 3.0),
    ));
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.0, 3.0, 5.0).looking_at(Vec3::Y * 0.5, Vec3::Y),
    ));
}

fn turn(time: Res<Time>, mut things: Query<&mut Transform, With<Turning>>) {
    for mut thing in &mut things {
        thing.rotate_y(time.delta_secs());
    }
}

/// The scene is taken as it stands when the key is pressed.
fn shoot(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    camera: Single<Entity, With<Camera3d>>,
) {
    if keys.just_pressed(KeyCode::KeyP) {
        let settings = RenderSettings {
            size: UVec2::new(1920, 1080),
            spp: 4096,
            sampling: Sampling {
                error: 0.01,
                time: 60.0,
                ..default()
            },
            ..default()
        };
        render_reference(&mut commands, *camera, settings).observe(write);
    }
}

fn write(done: On<ReferenceRendered>) {
    let file = "reference.png";
    let picture = done.picture.image().try_into_dynamic();
    match picture.map(|picture| picture.to_rgb8().save(file)) {
        Ok(Ok(())) => info!("{file} is written: {:?}", done.ending),
        problem => error!("{file} was not written: {problem:?}"),
    }
}
