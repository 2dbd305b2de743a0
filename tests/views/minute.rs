//! A minute of a game that spawns, despawns and edits meshes in every frame, with a renderer: its memory stays what it is.

use super::{Game, RED};
use bevy::prelude::*;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Until lists, pools of textures and the driver's shaders have grown to their size.
const WARM_UP: Duration = Duration::from_secs(15);
const WHOLE: Duration = Duration::from_secs(60);
/// MiB between the first and the last third after the warm-up: allocators and drivers give back pages when they like (1.5
/// were measured in 5,000 frames). A mesh of every frame that stayed, with its tree, would be some hundreds.
const TOLERANCE: f64 = 12.0;

/// MiB of memory that this process has now.
fn resident() -> f64 {
    let pages = std::fs::read_to_string("/proc/self/statm").unwrap();
    let pages: f64 = pages.split(' ').nth(1).unwrap().parse().unwrap();
    pages * 4096.0 / f64::from(1 << 20)
}

/// One mesh is another in every frame, and an object and a lamp come and go.
fn edit(game: &mut Game, frame: usize, mesh: &Handle<Mesh>, spawned: &mut VecDeque<Entity>) {
    let world = game.app.world_mut();
    let mut meshes = world.resource_mut::<Assets<Mesh>>();
    let wobble = 0.5 + 0.1 * (frame % 10) as f32;
    let other = Sphere::new(wobble).mesh().uv(48, 24);
    meshes.insert(mesh.id(), other).expect("it is used");
    let new = match frame % 2 {
        0 => Sphere::new(0.3).mesh().uv(48, 24),
        _ => Mesh::from(Cuboid::from_length(0.5)),
    };
    let new = Mesh3d(meshes.add(new));
    let material = StandardMaterial {
        metallic: (frame % 7) as f32 / 7.0,
        ..default()
    };
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    let material = MeshMaterial3d(materials.add(material));
    let place = Transform::from_xyz((frame % 10) as f32 - 5.0, 0.0, -6.0);
    let object = world.spawn((new, material, place)).id();
    let lamp = world.spawn((PointLight::default(), place)).id();
    spawned.extend([object, lamp]);
    while spawned.len() > 40 {
        let oldest = spawned.pop_front().unwrap();
        world.despawn(oldest);
    }
}

#[test]
#[ignore = "a minute, and the process has to be its own"]
fn a_minute_of_spawning_despawning_and_edits_in_every_frame_leaves_memory_as_it_was() {
    let Some(mut game) = Game::open() else {
        return;
    };
    game.view(RED, None, 0);
    let world = game.app.world_mut();
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Sphere::new(1.0).mesh().uv(48, 24));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::default());
    let place = Transform::from_xyz(0.0, 0.0, -4.0);
    world.spawn((Mesh3d(mesh.clone()), MeshMaterial3d(material), place));
    let (start, mut spawned, mut seen) = (Instant::now(), VecDeque::new(), Vec::new());
    let mut frames = 0;
    while start.elapsed() < WHOLE {
        edit(&mut game, frames, &mesh, &mut spawned);
        game.app.update();
        frames += 1;
        if start.elapsed() > WARM_UP {
            seen.push(resident());
        } else if frames.is_multiple_of(100) {
            eprintln!("warming up: {:.1} MiB after {frames} frames", resident());
        }
    }
    let thirds = seen.chunks(seen.len().div_ceil(3)).map(|third| {
        let mut third = third.to_vec();
        third.sort_by(f64::total_cmp);
        third[third.len() / 2]
    });
    let thirds: Vec<f64> = thirds.collect();
    eprintln!("{frames} frames; MiB by thirds after the warm-up: {thirds:.1?}");
    let grown = thirds[2] - thirds[0];
    assert!(
        grown < TOLERANCE,
        "{grown:.1} MiB in {frames} frames: {thirds:.1?}"
    );
}
