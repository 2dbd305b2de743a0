//! The editor over a Bevy app's own scene: Bevy's materials and lights, systems that move things,
//! and components that Glassbox has never heard of. Add `EditorPlugins`; that the window
//! asks before it closes is the one setting beside it.
//!
//! `Turning` is reflected: select the box and its section stands in the inspector. Its edits are undone, it is copied
//! along, other things get it with "Add component…", and saved scenes keep it.
//!
//! `cargo run --release --example embed_editor`; F10 switches between the editor and the app.

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use glassbox::prelude::*;

fn main() {
    App::new()
        .add_plugins(DefaultPlugins.set(WindowPlugin {
            // The editor asks before unsaved changes are lost.
            close_when_requested: false,
            ..default()
        }))
        .add_plugins(EditorPlugins)
        .keep_in_scene_files::<Turning>()
        .add_systems(Startup, spawn_scene)
        .add_systems(Update, (switch, turn.run_if(not(in_editor)), bob))
        .run();
}

/// The app's own. What is said of a field with `@` is heeded by the editor's fields; without it they take every number.
#[derive(Component, Reflect)]
#[reflect(Component, Default)]
struct Turning {
    /// Radians a second.
    #[reflect(@Quantity::within(-20.0, 20.0, "rad/s"))]
    speed: f32,
    axis: Axis,
}

#[derive(Reflect, Default)]
enum Axis {
    #[default]
    Up,
    Other(Vec3),
}

impl Default for Turning {
    fn default() -> Self {
        Self {
            speed: 1.0,
            axis: Axis::Up,
        }
    }
}

/// Not reflected, so the editor cannot show it; undo of a deletion brings it back all the same.
#[derive(Component)]
struct Bobbing;

fn spawn_scene(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut images: ResMut<Assets<Image>>,
) {
    commands.spawn((
        Name::new("Ground"),
        Mesh3d(meshes.add(Plane3d::default().mesh().size(8.0, 8.0))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color_texture: Some(images.add(checkers())),
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            ..default()
        })),
    ));
    commands.spawn((
        Name::new("Box"),
        Turning {
            speed: 0.8,
            ..default()
        },
        Mesh3d(meshes.add(Cuboid::default())),
        MeshMaterial3d(materials.add(Color::srgb(0.9, 0.35, 0.1))),
        Transform::from_xyz(-1.2, 0.5, 0.0),
    ));
    commands.spawn((
        Name::new("Ball"),
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
        Name::new("Lamp"),
        Bobbing,
        PointLight {
            intensity: 800_000.0,
            ..default()
        },
        Transform::from_xyz(3.0, 4.0, 3.0),
    ));
    commands.spawn((
        Name::new("Eye"),
        Camera3d::default(),
        Transform::from_xyz(0.0, 3.0, 6.0).looking_at(Vec3::Y * 0.5, Vec3::Y),
    ));
}

/// Light and dark squares.
fn checkers() -> Image {
    const SIDE: u32 = 128;
    let pixels: Vec<u8> = (0..SIDE * SIDE)
        .flat_map(|i| {
            let light = (i / SIDE / 16 + i % SIDE / 16).is_multiple_of(2);
            let [r, g, b] = if light {
                [190, 195, 200]
            } else {
                [90, 100, 115]
            };
            [r, g, b, 255]
        })
        .collect();
    let size = Extent3d {
        width: SIDE,
        height: SIDE,
        depth_or_array_layers: 1,
    };
    // The tracer reads it too: not only the renderer's world.
    Image::new(
        size,
        TextureDimension::D2,
        pixels,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::default(),
    )
}

fn switch(keys: Res<ButtonInput<KeyCode>>, mut editing: ResMut<Editing>) {
    if keys.just_pressed(KeyCode::F10) {
        editing.0 = !editing.0;
    }
}

/// Goes on only while the editor is off.
fn turn(time: Res<Time>, mut things: Query<(&Turning, &mut Transform)>) {
    for (turning, mut place) in &mut things {
        let axis = match turning.axis {
            Axis::Up => Dir3::Y,
            Axis::Other(axis) => Dir3::new(axis).unwrap_or(Dir3::Y),
        };
        place.rotate_axis(axis, turning.speed * time.delta_secs());
    }
}

/// Goes on beneath the editor as well: what an app does is no step that undo would take back.
fn bob(time: Res<Time>, mut things: Query<&mut Transform, With<Bobbing>>) {
    // Two seconds of moving, six of standing still.
    let seconds = time.elapsed_secs() % 8.0;
    if seconds < 2.0 {
        for mut place in &mut things {
            place.translation.y = 4.0 + 0.5 * (seconds * std::f32::consts::PI).sin();
        }
    }
}
