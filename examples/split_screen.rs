//! A game for two on one screen, the left half traced and the right one rasterised.
//!
//! `cargo run --release --example split_screen`; space changes sides.

use bevy::camera::Viewport;
use bevy::prelude::*;
use glassbox::prelude::*;

fn main() {
    App::new()
        .add_plugins((DefaultPlugins, GlassboxPlugins))
        .add_systems(Startup, spawn_scene)
        .add_systems(Update, (fit, change_sides))
        .run();
}

/// Which half of the window a player's camera has: 0 is the left one.
#[derive(Component)]
struct Half(u32);

fn spawn_scene(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(12.0, 12.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.5, 0.55, 0.6))),
    ));
    commands.spawn((
        Mesh3d(meshes.add(Torus::new(0.4, 1.0))),
        MeshMaterial3d(materials.add(Color::srgb(0.9, 0.35, 0.1))),
        Transform::from_xyz(0.0, 0.4, 0.0),
    ));
    commands.spawn((
        PointLight {
            intensity: 1_500_000.0,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(3.0, 5.0, 2.0),
    ));
    let places = [Vec3::new(-3.0, 3.0, 5.0), Vec3::new(3.0, 3.0, 5.0)];
    for (half, place) in (0..).zip(places) {
        let mut player = commands.spawn((
            Half(half),
            Camera3d::default(),
            Camera {
                order: half as isize,
                ..default()
            },
            Transform::from_translation(place).looking_at(Vec3::ZERO, Vec3::Y),
        ));
        if half == 0 {
            player.insert(TracedView::default());
        }
    }
}

/// Each player has half of the window, however large it is.
fn fit(window: Single<&Window>, mut players: Query<(&Half, &mut Camera)>) {
    let half = UVec2::new(window.physical_width() / 2, window.physical_height());
    if half.min_element() == 0 {
        return;
    }
    for (Half(side), mut camera) in &mut players {
        let place = UVec2::new(side * half.x, 0);
        let fits = camera.viewport.as_ref().is_some_and(|viewport| {
            (viewport.physical_position, viewport.physical_size) == (place, half)
        });
        if !fits {
            camera.viewport = Some(Viewport {
                physical_position: place,
                physical_size: half,
                ..default()
            });
        }
    }
}

/// A picture goes with its component, and the other view begins its own.
fn change_sides(
    mut commands: Commands,
    keys: Res<ButtonInput<KeyCode>>,
    players: Query<(Entity, Has<TracedView>), With<Half>>,
) {
    if keys.just_pressed(KeyCode::Space) {
        for (player, is_traced) in &players {
            let mut player = commands.entity(player);
            match is_traced {
                true => player.remove::<TracedView>(),
                false => player.insert(TracedView::default()),
            };
        }
    }
}
