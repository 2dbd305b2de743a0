//! `glassbox scenes`: what the program brings along.

use super::Failure;
use super::output::say;
use crate::app::headless_app;
use crate::inspect::{counted, plural};
use crate::io::builtin::SCENES;
use crate::io::{OpenOptions, SceneSource, open};
use crate::scene::AnyLamp;
use bevy::asset::Assets;
use bevy::ecs::world::World;
use bevy::mesh::{Mesh, Mesh3d};
use clap::Args;
use serde::Serialize;

#[derive(Args)]
pub(super) struct Scenes {
    /// Print JSON instead of a line each
    #[arg(long)]
    json: bool,
}

/// What there is to say of one.
#[derive(Serialize)]
struct Line {
    name: &'static str,
    triangles: usize,
    lights: usize,
    shows: &'static str,
}

pub(super) fn run(args: Scenes) -> Result<(), Failure> {
    let lines = lines()?;
    if args.json {
        let text = serde_json::to_string_pretty(&lines);
        return say(text.map_err(|error| Failure::System(error.to_string()))?);
    }
    let width = lines.iter().map(|line| line.name.len()).max().unwrap_or(0);
    for Line {
        name,
        triangles,
        lights,
        shows,
    } in lines
    {
        // As wide as each other: what follows stands in columns.
        let what = plural(triangles as u64, "triangle");
        let lights = counted(lights as u64, "light");
        say(format_args!(
            "{name:width$}  {triangles:>6} {what:9}  {lights:8}  {shows}"
        ))?;
    }
    Ok(())
}

fn lines() -> Result<Vec<Line>, Failure> {
    let mut app = headless_app();
    let mut lines = Vec::new();
    for scene in SCENES {
        open(
            app.world_mut(),
            &SceneSource::Builtin(scene),
            OpenOptions::default(),
        )?;
        lines.push(Line {
            name: scene.name,
            triangles: triangles(app.world_mut()),
            lights: lights(app.world_mut()),
            shows: scene.sentence,
        });
    }
    Ok(lines)
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

fn lights(world: &mut World) -> usize {
    world.query_filtered::<(), AnyLamp>().iter(world).count()
}
