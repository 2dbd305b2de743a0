//! From Phong to MTL, as [`super::phong`] reads it. What has no place there is noted.

use super::super::error::{FileError, Place};
use super::super::exported::Exported;
use super::super::notes::Notes;
use super::written_pictures::{Created, Kept, Pictures, text_of};
use crate::scene::{Alpha, MapFilter, Phong, PhongMap, Wrap};
use bevy::color::LinearRgba;
use bevy::prelude::World;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The materials of an OBJ, and what they need.
pub(super) struct Library {
    /// Of the MTL file.
    pub text: String,
    /// Pictures that were written beside it.
    pub pictures: Created,
    /// Files that were brought along by the MTL that was there, and that nothing names any more.
    pub replaced: Vec<PathBuf>,
}

/// The materials for this MTL file. A picture that is a file is named from its folder; one that is not, that
/// lies elsewhere or has a name that no line can hold, is written beside it as `NAME-texture0.png` (or `.exr` where
/// it holds floats). `left` is another MTL that is replaced with this one.
pub(super) fn library(
    world: &World,
    file: &Path,
    left: Option<&Path>,
    exported: &mut Exported,
) -> Result<Library, FileError> {
    let old = [Some(file), left].into_iter().flatten().filter_map(text_of);
    let old = old.collect::<Vec<_>>().join(&b'\n');
    let mut pictures = Pictures::of(world, file, exported);
    let mut text = String::new();
    for material in &exported.materials {
        let (phong, loaded) = (&material.phong, &material.maps);
        let notes = &mut exported.notes;
        let rgb = |c: LinearRgba| format!("{} {} {}", c.red, c.green, c.blue);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "newmtl {}", material.name);
        let _ = writeln!(text, "Kd {}", rgb(phong.diffuse));
        let (reflected, illum) = reflected(phong);
        for (what, instead) in unlike_reflections(phong) {
            notes.add_named(file, Place::Whole, what, &material.name, instead);
        }
        let _ = writeln!(text, "Ks {}", rgb(reflected));
        let _ = writeln!(text, "illum {illum}");
        let _ = writeln!(text, "Ns {}", phong.shininess);
        let _ = writeln!(text, "d {}", phong.opacity);
        let _ = writeln!(text, "Ke {}", rgb(phong.emission));
        let cannot_say = |notes: &mut Notes, what: &str| {
            let what = format!("{what} an MTL: the material");
            notes.add_named(file, Place::Whole, &what, &material.name, "left out");
        };
        match phong.alpha {
            Alpha::Blend => {}
            Alpha::Mask { .. } => cannot_say(notes, "its cutoff has no place in"),
            Alpha::Opaque => cannot_say(notes, "that it is opaque in any case has no place in"),
        }
        let mut has_colors = false;
        for (map, word) in map_words(phong) {
            let Some(source) = map.source(phong) else {
                continue;
            };
            // Readers, ours too, take Kd 0 0 0 for the picture as it is.
            if map == PhongMap::Diffuse && is_black(phong.diffuse) {
                cannot_say(
                    notes,
                    "a diffuse map that its black colour hides has no place in",
                );
                continue;
            }
            let is_odd = source.wrap_u != source.wrap_v || source.wrap_u == Wrap::Mirror;
            if is_odd || source.filter != MapFilter::Setting {
                let what = format!(
                    "how its {} is wrapped and filtered has no place in",
                    map.name()
                );
                cannot_say(notes, &what);
            }
            let loaded = map.loaded(loaded);
            let picture = match map {
                PhongMap::Opacity => {
                    let colors = phong.diffuse_map.as_ref().filter(|_| has_colors);
                    pictures.name_of_opacity(source, loaded, colors, notes)
                }
                _ => pictures.name(source, loaded, Kept::All, notes),
            };
            let Some(picture) = picture? else { continue };
            has_colors |= map == PhongMap::Diffuse;
            let clamp = if !is_odd && source.wrap_u == Wrap::Clamp {
                CLAMPED
            } else {
                ""
            };
            let scale = match map {
                PhongMap::Normal if phong.normal_scale != 1.0 => {
                    format!("-bm {} ", phong.normal_scale)
                }
                _ => String::new(),
            };
            let _ = writeln!(text, "{word} {clamp}{scale}{picture}");
        }
        text.push('\n');
    }
    let (pictures, replaced) = pictures.finish(&old);
    Ok(Library {
        text,
        pictures,
        replaced,
    })
}

/// How an MTL says that a picture ends at its edges.
pub(super) const CLAMPED: &str = "-clamp on ";

/// The maps that an MTL has, and what it calls them.
fn map_words(phong: &Phong) -> impl Iterator<Item = (PhongMap, &'static str)> {
    let reflected = match is_black(phong.specular) && !is_black(phong.mirror) {
        true => PhongMap::Mirror,
        false => PhongMap::Specular,
    };
    [
        (PhongMap::Diffuse, "map_Kd"),
        (reflected, "map_Ks"),
        (PhongMap::Emission, "map_Ke"),
        (PhongMap::Opacity, "map_d"),
        (PhongMap::Normal, "norm"),
    ]
    .into_iter()
}

fn is_black(color: LinearRgba) -> bool {
    [color.red, color.green, color.blue] == [0.0; 3]
}

/// The one colour that an MTL has for highlight and mirror, and the model that says which of them there are.
fn reflected(phong: &Phong) -> (LinearRgba, u8) {
    match (is_black(phong.specular), is_black(phong.mirror)) {
        (true, true) => (LinearRgba::BLACK, 1),
        (false, true) => (phong.specular, 2),
        (true, false) => (phong.mirror, 3),
        (false, false) => (phong.specular, 3),
    }
}

/// What an MTL says otherwise of reflections, which have one colour and one picture in it, and how.
fn unlike_reflections(phong: &Phong) -> Vec<(&'static str, &'static str)> {
    let mut found = Vec::new();
    if is_black(phong.mirror) {
        return found;
    }
    if is_black(phong.specular) {
        let what = "a mirror without a highlight, which an MTL cannot say, of the material";
        return vec![(what, "it has a highlight of the mirror's colour there")];
    }
    if phong.mirror != phong.specular {
        let what = "highlight and mirror have one colour in an MTL, as has the material";
        found.push((what, "its mirror has that of its highlight there"));
    }
    if phong.mirror_map != phong.specular_map {
        let what = "highlight and mirror have one picture in an MTL, as has the material";
        found.push((what, "its mirror has that of its highlight there"));
    }
    found
}
