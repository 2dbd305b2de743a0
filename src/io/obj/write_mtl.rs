use super::super::error::{FileError, Place};
use super::super::exported::{Exported, pixels_of};
use super::super::file_name::{BUILTIN, fits_a_line, split_fragment};
use super::super::folder::{Folder, stays_inside};
use super::super::identity::folder_of;
use super::super::notes::Notes;
use super::super::replace::replace_file;
use super::super::scene_file::Rebase;
use super::super::sources::SceneFiles;
use super::stem_of;
use crate::io::Limits;
use crate::scene::{Alpha, MapFilter, Phong, PhongMap, TextureSource, Wrap};
use bevy::asset::Handle;
use bevy::color::LinearRgba;
use bevy::image::Image;
use bevy::prelude::World;
use image::DynamicImage;
use std::collections::HashSet;
use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
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

/// Files that were not there before. They go again when this is dropped, unless they are kept. Not [`Staged`] ones, as
/// there may be thousands, and each of those is an open file.
///
/// [`Staged`]: super::super::replace::Staged
#[derive(Default)]
pub(super) struct Created(Vec<PathBuf>);

impl Created {
    pub fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for Created {
    fn drop(&mut self) {
        for file in &self.0 {
            // What cannot be tidied up adds nothing to the error that is reported.
            let _ = std::fs::remove_file(file);
        }
    }
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
    let mut pictures = Pictures {
        world,
        file,
        rebase: Rebase::new(world, file),
        beside: Vec::new(),
        created: Created::default(),
        taken: HashSet::new(),
    };
    pictures.take_names(exported);
    let mut text = String::new();
    for material in &exported.materials {
        let (phong, loaded) = (&material.phong, &material.maps);
        let notes = &mut exported.notes;
        let rgb = |c: LinearRgba| format!("{} {} {}", c.red, c.green, c.blue);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "newmtl {}", material.name);
        let _ = writeln!(text, "Kd {}", rgb(phong.diffuse));
        let (highlight, illum) = highlight(phong);
        if phong.mirror != LinearRgba::BLACK && phong.mirror != phong.specular {
            let what =
                "highlight and mirror have one colour in an MTL, that of the material's highlight:";
            notes.add_named(file, Place::Whole, what, &material.name, "written so");
        }
        let _ = writeln!(text, "Ks {}", rgb(highlight));
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
        for (map, word) in map_words(phong) {
            let Some(source) = map.source(phong) else {
                continue;
            };
            let is_odd = source.wrap_u != source.wrap_v || source.wrap_u == Wrap::Mirror;
            if is_odd || source.filter != MapFilter::Setting {
                let what = format!(
                    "how its {} is wrapped and filtered has no place in",
                    map.name()
                );
                cannot_say(notes, &what);
            }
            let Some(picture) = pictures.name(Some(source), map.loaded(loaded), notes)? else {
                continue;
            };
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
        if phong.mirror_map.is_some() && phong.mirror_map != phong.specular_map {
            cannot_say(notes, "a mirror map of its own has no place in");
        }
        text.push('\n');
    }
    Ok(Library {
        text,
        replaced: pictures.replaced(&old),
        pictures: pictures.created,
    })
}

/// How an MTL says that a picture ends at its edges.
const CLAMPED: &str = "-clamp on ";

/// The maps that an MTL has, and what it calls them.
fn map_words(phong: &Phong) -> impl Iterator<Item = (PhongMap, &'static str)> {
    let highlight = match phong.specular {
        LinearRgba::BLACK if phong.specular_map.is_none() => PhongMap::Mirror,
        _ => PhongMap::Specular,
    };
    [
        (PhongMap::Diffuse, "map_Kd"),
        (highlight, "map_Ks"),
        (PhongMap::Emission, "map_Ke"),
        (PhongMap::Opacity, "map_d"),
        (PhongMap::Normal, "norm"),
    ]
    .into_iter()
}

/// The one colour that an MTL has for highlight and mirror, and the model that says which of them there are.
fn highlight(phong: &Phong) -> (LinearRgba, u8) {
    const NONE: LinearRgba = LinearRgba::BLACK;
    match (phong.specular, phong.mirror) {
        (NONE, NONE) => (NONE, 1),
        (specular, NONE) => (specular, 2),
        (NONE, mirror) => (mirror, 3),
        (specular, _) => (specular, 3),
    }
}

/// The content of a file that is there.
pub(super) fn text_of(file: &Path) -> Option<Vec<u8>> {
    // Not of a pipe, which would be waited for.
    let there = file.is_file();
    let limits = Limits::default();
    there.then(|| {
        super::super::read_bytes(file, limits.file_bytes, &limits.memory).unwrap_or_default()
    })
}

struct Pictures<'a> {
    world: &'a World,
    file: &'a Path,
    rebase: Rebase,
    /// Sources that become files beside the MTL, and their names.
    beside: Vec<(String, String)>,
    created: Created,
    /// Files that materials name, which stay as they are.
    taken: HashSet<String>,
}

impl Pictures<'_> {
    /// A picture that is a file, as the MTL can name it.
    fn named(&self, path: &str) -> Option<String> {
        let is_file = !path.starts_with(BUILTIN) && split_fragment(path).1.is_empty();
        let named = is_file.then(|| self.rebase.path(path, &mut Notes::default()))?;
        // Nothing is escaped in an MTL.
        let here = Folder::of(self.file, true);
        let named = match here.file_of(&named).strip_prefix(&here.path) {
            Ok(inside) => inside.to_str()?.to_owned(),
            Err(_) => named,
        };
        (fits_a_line(&named) && stays_inside(&named)).then_some(named)
    }

    /// Notes the names that no picture may be written under.
    fn take_names(&mut self, exported: &Exported) {
        let materials = exported.materials.iter().map(|material| &material.phong);
        let maps = materials.flat_map(|phong| PhongMap::ALL.map(|map| map.source(phong)));
        let named = maps.flatten().filter_map(|map| self.named(&map.path));
        self.taken = named.collect();
    }

    /// A name for a picture that is written beside the file, and whether this very picture has it already.
    fn free_name(&self, extension: &str, bytes: &[u8]) -> (String, bool) {
        let stem = stem_of(self.file);
        let mut number = self.beside.len();
        loop {
            let name = format!("{stem}-texture{number}.{extension}");
            number += 1;
            let given = self.beside.iter().any(|(_, other)| *other == name);
            if given || self.taken.contains(&name) {
                continue;
            }
            let place = folder_of(self.file).join(&name);
            match place.symlink_metadata() {
                Err(_) => return (name, false),
                Ok(there) if there.is_file() && there.len() == bytes.len() as u64 => {
                    if text_of(&place).is_some_and(|there| there == bytes) {
                        return (name, true);
                    }
                }
                Ok(_) => {}
            }
        }
    }

    /// What the MTL calls a picture; `None` where there is none, or none that can be written.
    fn name(
        &mut self,
        source: Option<&TextureSource>,
        loaded: Option<&Handle<Image>>,
        notes: &mut Notes,
    ) -> Result<Option<String>, FileError> {
        let Some(TextureSource { path, .. }) = source else {
            return Ok(None);
        };
        if let Some(named) = self.named(path) {
            return Ok(Some(named));
        }
        if let Some((_, name)) = self.beside.iter().find(|(source, _)| source == path) {
            return Ok(Some(name.clone()));
        }
        let pixels = loaded.and_then(|handle| pixels_of(self.world, handle.id()));
        let Some(pixels) = pixels else {
            let what = "a picture that is not loaded:";
            notes.add_named(self.file, Place::Whole, what, path, "left out");
            return Ok(None);
        };
        let (extension, format) = match pixels {
            DynamicImage::ImageRgba32F(_) => ("exr", image::ImageFormat::OpenExr),
            _ => ("png", image::ImageFormat::Png),
        };
        let mut bytes = Cursor::new(Vec::new());
        let encoded = pixels.write_to(&mut bytes, format);
        encoded.map_err(|error| FileError::writing(self.file, &std::io::Error::other(error)))?;
        let bytes = bytes.into_inner();
        let (name, is_there) = self.free_name(extension, &bytes);
        if !is_there {
            let place = folder_of(self.file).join(&name);
            replace_file(&place, |out| out.write_all(&bytes))?;
            self.created.0.push(place);
        }
        let what = format!("an MTL cannot name the picture `{path}`, written as");
        notes.add_named(self.file, Place::Whole, what, &name, "named so");
        self.beside.push((path.clone(), name.clone()));
        Ok(Some(name))
    }

    /// Pictures that the old MTL brought along, by their names, and that neither the new one nor the scene names.
    fn replaced(&self, old: &[u8]) -> Vec<PathBuf> {
        let start = format!("{}-texture", stem_of(self.file));
        let is_own = |name: &&str| {
            let rest = name.strip_prefix(&start);
            let number = rest.and_then(|rest| {
                let without_png = rest.strip_suffix(".png");
                without_png.or_else(|| rest.strip_suffix(".exr"))
            });
            number.is_some_and(|n| !n.is_empty() && n.bytes().all(|byte| byte.is_ascii_digit()))
        };
        let old = String::from_utf8_lossy(old);
        let names = old.lines().filter_map(|line| {
            let (word, name) = line.split_once(' ')?;
            let is_map = word.starts_with("map_") || word == "norm";
            let name = name.strip_prefix(CLAMPED).unwrap_or(name);
            let after_scale = name
                .strip_prefix("-bm ")
                .and_then(|rest| rest.split_once(' '));
            let name = after_scale.map_or(name, |(_, name)| name);
            is_map.then_some(name.trim())
        });
        let files = self.world.get_resource::<SceneFiles>();
        let is_used = |name: &&str| {
            let place = folder_of(self.file).join(name);
            self.taken.contains(*name)
                || self.beside.iter().any(|(_, other)| other == name)
                || files.is_some_and(|files| {
                    super::super::check_outputs([&*place], files.inputs()).is_err()
                })
        };
        let names = names.filter(is_own).filter(|name| !is_used(name));
        names.map(|name| folder_of(self.file).join(name)).collect()
    }
}
