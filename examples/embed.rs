//! A Bevy app's own scene, of Bevy's own materials and lights, traced: add `GlassboxPlugins`, and
//! give the camera a `TracedView`. No egui.
//!
//! `cargo run --release --example embed`; space switches between Bevy's renderer and the tracer.

use bevy::prelude::*;
use glassbox::prelude::*;

fn main() {
    App::new()
        .add_plugins(DefaultPlugins)
        .add_plugins(GlassboxPlugins)
        .add_systems(Startup, spawn_scene)
        .add_systems(Update, (turn, switch))
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
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.6, 0.65, 0.7),
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            ..default()
        })),
    ));
    commands.spawn((
        Turning,
        Mesh3d(meshes.add(Cuboid::default())),
        MeshMaterial3d(materials.add(Color::srgb(0.9, 0.35, 0.1))),
        Transform::from_xyz(-1.0, 0.5, 0.0),
    ));
    commands.spawn((
        Mesh3d(meshes.add(Sphere::new(0.7))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color: Color::srgb(0.9, 0.9, 0.95),
            metallic: 1.0,
            perceptual_roughness: 0.1,
            ..default()
        })),
        Transform::from_xyz(0.8, 0.7, 0.2),
    ));
    commands.spawn((
        PointLight {
            intensity: 800_000.0,
            ..default()
        },
        Transform::from_xyz(3.0, 5.0, 3.0),
    ));
    commands.spawn((
        Camera3d::default(),
        TracedView::default(),
        Msaa::Off,
        Transform::from_xyz(0.0, 3.0, 6.0).looking_at(Vec3::Y * 0.5, Vec3::Y),
    ));
}

/// Moving something starts the picture over, coarse to fine.
fn turn(time: Res<Time>, mut things: Query<&mut Transform, With<Turning>>) {
    // Two seconds of turning, four of standing still.
    if time.elapsed_secs() % 6.0 < 2.0 {
        for mut thing in &mut things {
            thing.rotate_y(time.delta_secs());
        }
    }
}

fn switch(keys: Res<ButtonInput<KeyCode>>, mut view: Single<&mut TracedView>) {
    if keys.just_pressed(KeyCode::Space) {
        view.divider = if view.divider < 1.0 { 1.0 } else { 0.0 };
    }
}
