//! What is wrong with a file ends in one line that names the file, the place and what would help,
//! and in nothing else: no panic, no half-written output, the open scene untouched.

#[cfg(target_os = "linux")]
mod full_disk;
mod gltf;
mod gltf_container;
mod limits;
mod memory;
mod models;
mod output;
mod pictures;
#[cfg(unix)]
mod pipes;
mod scans;
mod scenes;

use crate::files::app::app;
use bevy::mesh::Mesh3d;
use bevy::prelude::{Entity, With, World};
use glassbox::io::{FileError, OpenOptions, SceneSource, open};
use glassbox::scene::{PointLamp, SceneId};
use std::path::Path;

/// Opens a file that must be refused, checks that the scene which was open is still there, and
/// returns the error.
pub fn refused(file: &Path) -> FileError {
    refused_with(file, OpenOptions::default())
}

/// The same with options.
pub fn refused_with(file: &Path, options: OpenOptions) -> FileError {
    let mut app = app();
    let world = app.world_mut();
    world.spawn((SceneId(17), PointLamp::default()));
    let before = ids(world);
    let result = open(world, &SceneSource::named(file), options);
    let error = match result {
        Err(error) => error,
        Ok(opened) => panic!("{} was opened: {opened:?}", file.display()),
    };
    assert_eq!(ids(world), before, "the open scene was touched");
    error
}

fn ids(world: &mut World) -> Vec<u64> {
    world
        .query::<&SceneId>()
        .iter(world)
        .map(|id| id.0)
        .collect()
}

/// One line, and in it each of these.
pub fn says(error: &FileError, parts: &[&str]) {
    let line = error.to_string();
    assert_eq!(line.lines().count(), 1, "{line}");
    for part in parts {
        assert!(line.contains(part), "`{part}` is not in: {line}");
    }
}

/// Opens a file that can be shown in part: one of its notes, a line, says each of these. Returns how many triangles
/// there are.
pub fn opens_and_says(file: &Path, parts: &[&str]) -> usize {
    let (mut app, opened) = crate::files::app::opened(file);
    let lines = opened.notes.lines();
    let says = |line: &&String| parts.iter().all(|part| line.contains(part));
    assert_eq!(
        lines.iter().filter(says).count(),
        1,
        "{parts:?} is not said once: {lines:#?}"
    );
    let world = app.world_mut();
    let mut query = world.query_filtered::<Entity, With<Mesh3d>>();
    let objects: Vec<_> = query.iter(world).collect();
    let triangles = |&object: &Entity| crate::files::app::triangles(world, object).len();
    objects.iter().map(triangles).sum()
}
