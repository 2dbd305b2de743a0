//! An app's own kind of material, traced: a function says what it is like.
//!
//! `cargo run --release --example own_material`; space switches between Bevy's renderer and the
//! tracer.

use bevy::asset::embedded_asset;
use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy::render::render_resource::AsBindGroup;
use bevy::shader::ShaderRef;
use glassbox::prelude::*;

fn main() {
    let mut app = App::new();
    app.add_plugins((DefaultPlugins, GlassboxPlugins));
    embedded_asset!(app, "examples", "own_material.wgsl");
    app.add_plugins(MaterialPlugin::<Lava>::default())
        .add_traced_material(lava)
        .add_systems(Startup, spawn_scene)
        .add_systems(Update, switch)
        .run();
}

/// Glows, the more the hotter it is.
#[derive(Asset, AsBindGroup, TypePath, Clone)]
struct Lava {
    /// From 0 to 1.
    #[uniform(0)]
    heat: f32,
}

impl Material for Lava {
    fn fragment_shader() -> ShaderRef {
        "embedded://own_material/own_material.wgsl".into()
    }
}

/// The same for the tracer.
fn lava(lava: &Lava) -> Phong {
    Phong {
        diffuse: LinearRgba::rgb(0.05, 0.02, 0.01),
        emission: LinearRgba::rgb(1.0, 0.3, 0.05) * lava.heat,
        ..default()
    }
}

fn spawn_scene(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut standard: ResMut<Assets<StandardMaterial>>,
    mut lavas: ResMut<Assets<Lava>>,
) {
    commands.spawn((
        Mesh3d(meshes.add(Plane3d::default().mesh().size(8.0, 8.0))),
        MeshMaterial3d(standard.add(Color::srgb(0.6, 0.65, 0.7))),
    ));
    for (place, heat) in [(-1.2, 0.2), (0.0, 0.5), (1.2, 1.0)] {
        commands.spawn((
            Mesh3d(meshes.add(Sphere::new(0.5))),
            MeshMaterial3d(lavas.add(Lava { heat })),
            Transform::from_xyz(place, 0.5, 0.0),
        ));
    }
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
        TracedView::default(),
        Transform::from_xyz(0.0, 2.0, 5.0).looking_at(Vec3::Y * 0.4, Vec3::Y),
    ));
}

fn switch(keys: Res<ButtonInput<KeyCode>>, mut view: Single<&mut TracedView>) {
    if keys.just_pressed(KeyCode::Space) {
        view.divider = if view.divider < 1.0 { 1.0 } else { 0.0 };
    }
}
