//! Rendered pictures as files that say how they came about.

use super::super::error::FileError;
use super::light_layers::{LAYER, free_name, layer_name};
use super::write::write_exr_layers;
use super::{PictureFormat, write_picture_with_notes};
use crate::film::{LightPictures, Picture, Status, develop};
use crate::scene::{Output, RenderSettings, SETTINGS};
use std::path::Path;

/// A name and a text.
pub type Note = (&'static str, String);

/// Writes a picture with notes: linear light where the format holds it, before bloom, exposure and
/// view transform, else what a screen shows.
pub fn write_rendered(
    file: &Path,
    picture: &Picture,
    output: &Output,
    notes: &[Note],
) -> Result<(), FileError> {
    let pixels = if PictureFormat::of(file)?.is_linear() {
        picture
            .pixels
            .iter()
            .map(|pixel| pixel.to_array())
            .collect()
    } else {
        develop(picture, output)
    };
    write_picture_with_notes(file, picture.width, picture.height, &pixels, notes)
}

/// Writes a picture as OpenEXR with a layer for what each light adds and one for what shines by itself, `Combined_NAME` with
/// the light's name and `Combined_Own`: as Blender calls the passes of its light groups.
pub fn write_lights(
    file: &Path,
    picture: &Picture,
    lights: &LightPictures,
    name: impl Fn(u64) -> String,
    notes: &[Note],
) -> Result<(), FileError> {
    let mut layers = vec![("Own".to_owned(), &lights.own)];
    for light in &lights.lights {
        let names: Vec<String> = light.ids.iter().map(|id| layer_name(&name(*id))).collect();
        let name = match &names[..] {
            [name] => name.as_str(),
            _ => "Others",
        };
        let name = free_name(name, light.ids[0], |name| {
            layers.iter().any(|(taken, _)| taken == name)
        });
        layers.push((name, &light.picture));
    }
    for (name, _) in &mut layers {
        name.insert_str(0, LAYER);
    }
    write_exr_layers(file, picture, &layers, notes)
}

/// What a file says about itself: enough to render the same picture again. The same render says the
/// same, so there is no time in it.
pub fn picture_notes(camera: &str, settings: &RenderSettings, status: &Status) -> Vec<Note> {
    let words: Vec<String> = SETTINGS
        .iter()
        .map(|setting| format!("{}={}", setting.path, setting.value_text(settings)))
        .collect();
    let mut notes = vec![
        (
            "Software",
            format!("Glassbox {}", env!("CARGO_PKG_VERSION")),
        ),
        ("Camera", camera.to_owned()),
        ("Settings", words.join(" ")),
        ("Samples", format!("{}", status.samples)),
    ];
    if let Some(error) = status.error() {
        let bound = if error.is_bound { "at most " } else { "" };
        notes.push(("Error", format!("{bound}{:.3e}", error.relative())));
    }
    notes
}
