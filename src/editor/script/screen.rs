//! Pictures of the window.

use crate::io::{check_not_read, replace_file};
use crate::view::shoot_window;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy::image::Image;
use std::path::{Path, PathBuf};

/// What became of the picture that was asked for last.
#[derive(Resource, Default)]
pub(super) struct Shot(Option<Result<(), String>>);

impl Shot {
    /// Once it is written, or cannot be.
    pub fn take(&mut self) -> Option<Result<(), String>> {
        self.0.take()
    }
}

/// Writes what the window shows with the next frame.
pub(super) fn shoot(world: &mut World, path: PathBuf) {
    if let Err(error) = check_not_read(world, &path) {
        world.resource_mut::<Shot>().0 = Some(Err(error.to_string()));
        return;
    }
    world.resource_mut::<Shot>().0 = None;
    shoot_window(world, move |shot: &mut Shot, image| {
        shot.0 = Some(write(image, &path));
    });
}

fn write(image: &Image, path: &Path) -> Result<(), String> {
    let picture = image
        .clone()
        .try_into_dynamic()
        .map_err(|e| e.to_string())?;
    let format = image::ImageFormat::from_path(path).map_err(|e| e.to_string())?;
    let picture = picture.to_rgb8();
    let written = replace_file(path, |file| {
        (picture.write_to(file, format)).map_err(std::io::Error::other)
    });
    written.map_err(|error| error.to_string())
}
