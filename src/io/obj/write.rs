use super::super::error::{FileError, Problem};
use bevy::prelude::World;
use std::path::Path;

pub(crate) fn write_obj(_: &mut World, file: &Path) -> Result<Vec<String>, FileError> {
    Err(FileError::new(
        file,
        Problem::Malformed("OBJ is not written yet".into()),
    ))
}
