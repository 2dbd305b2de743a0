//! Frames of a moving scene of Bevy's own materials and lights, without a window or a renderer.
//!
//! `cargo run --release --example headless_frames` writes `frame-0.png` to `frame-7.png`.

use bevy::prelude::*;
use glassbox::app::headless_app_with;
use glassbox::prelude::*;
use glassbox::{film, io};

const FRAMES: u32 = 8;

fn main() -> Result {
    let mut app = headless_app_with(StandardMappingPlugin);
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let floor = meshes.add(Plane3d::default().mesh().size(8.0, 8.0));
    let cube = meshes.add(Cuboid::default());
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let grey = materials.add(Color::srgb(0.6, 0.65, 0.7));
    let orange = materials.add(Color::srgb(0.9, 0.35, 0.1));
    app.world_mut()
        .spawn((Mesh3d(floor), MeshMaterial3d(grey), Transform::default()));
    let turning = app.world_mut().spawn((
        Mesh3d(cube),
        MeshMaterial3d(orange),
        Transform::from_xyz(0.0, 0.8, 0.0),
    ));
    let turning = turning.id();
    app.world_mut().spawn((
        PointLight {
            intensity: 800_000.0,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_xyz(3.0, 5.0, 3.0),
    ));
    let eye = Transform::from_xyz(0.0, 3.0, 5.0).looking_at(Vec3::Y * 0.5, Vec3::Y);
    let camera = traced_camera(&eye.into(), &Projection::default(), None)
        .ok_or("a camera that sees nothing")?;
    let settings = RenderSettings {
        size: UVec2::new(480, 270),
        spp: 16,
        ..default()
    };
    for frame in 0..FRAMES {
        let mut place = app
            .world_mut()
            .get_mut::<Transform>(turning)
            .ok_or("the cube is gone")?;
        place.rotation = Quat::from_rotation_y(frame as f32 * 0.2);
        app.update();
        let traced = app.world().resource::<Traced>();
        for problem in &traced.problems {
            eprintln!("{problem}");
        }
        let rendered = film::render(&traced.world, &camera, &settings, &|_, _| {});
        let file = format!("frame-{frame}.png");
        io::write_rendered(file.as_ref(), &rendered.picture, &settings.output, &[])?;
    }
    Ok(())
}
