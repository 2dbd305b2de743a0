//! `glassbox scenes`: what the program brings along.

use super::Failure;
use super::output::say;
use crate::app::headless_app;
use crate::io::builtin::SCENES;
use crate::io::{OpenOptions, SceneSource, open};
use crate::scene::{DirectionalLamp, ParallelogramLamp, PointLamp, SegmentLamp};
use bevy::asset::Assets;
use bevy::ecs::query::{Or, With};
use bevy::ecs::world::World;
use bevy::mesh::{Mesh, Mesh3d};

pub(super) fn run() -> Result<(), Failure> {
    let mut app = headless_app();
    let width = SCENES
        .iter()
        .map(|scene| scene.name.len())
        .max()
        .unwrap_or(0);
    for scene in SCENES {
        open(
            app.world_mut(),
            &SceneSource::Builtin(scene),
            OpenOptions::default(),
        )?;
        let (triangles, lights) = (triangles(app.world_mut()), lights(app.world_mut()));
        let (name, sentence) = (scene.name, scene.sentence);
        let plural = if lights == 1 { " " } else { "s" };
        say(format_args!(
            "{name:width$}  {triangles:>6} triangles  {lights} light{plural}  {sentence}"
        ))?;
    }
    Ok(())
}

/// Triangles of all objects, as their meshes have them: no tree is built for this.
fn triangles(world: &mut World) -> usize {
    let mut objects = world.query::<&Mesh3d>();
    let meshes = world.resource::<Assets<Mesh>>();
    objects
        .iter(world)
        .filter_map(|object| meshes.get(object.id()))
        .map(|mesh| mesh.indices().map_or(mesh.count_vertices(), |i| i.len()) / 3)
        .sum()
}

type Lamp = Or<(
    With<PointLamp>,
    With<DirectionalLamp>,
    With<SegmentLamp>,
    With<ParallelogramLamp>,
)>;

fn lights(world: &mut World) -> usize {
    world.query_filtered::<(), Lamp>().iter(world).count()
}
