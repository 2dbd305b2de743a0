use super::super::error::{FileError, Problem};
use bevy::prelude::World;
use std::path::Path;

pub(crate) fn write_glb(_: &mut World, file: &Path) -> Result<Vec<String>, FileError> {
    Err(FileError::new(
        file,
        Problem::Malformed("GLB is not written yet".into()),
    ))
}
