//! The pictures of an MTL: those that it can name, and those that are written beside it.

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
use super::write_mtl::CLAMPED;
use crate::io::Limits;
use crate::scene::{PhongMap, TextureSource};
use bevy::asset::Handle;
use bevy::image::Image;
use bevy::prelude::World;
use image::DynamicImage;
use std::collections::HashSet;
use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};

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

/// The content of a file that is there.
pub(super) fn text_of(file: &Path) -> Option<Vec<u8>> {
    // Not of a pipe, which would be waited for.
    let there = file.is_file();
    let limits = Limits::default();
    there.then(|| {
        super::super::read_bytes(file, limits.file_bytes, &limits.memory).unwrap_or_default()
    })
}

/// What is written of a picture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    All,
    /// Without alpha.
    Brightness,
}

fn has_alpha(pixels: &DynamicImage) -> bool {
    match pixels {
        DynamicImage::ImageRgba8(pixels) => pixels.pixels().any(|pixel| pixel.0[3] < u8::MAX),
        DynamicImage::ImageRgba16(pixels) => pixels.pixels().any(|pixel| pixel.0[3] < u16::MAX),
        DynamicImage::ImageRgba32F(pixels) => pixels.pixels().any(|pixel| pixel.0[3] < 1.0),
        _ => false,
    }
}

fn without_alpha(pixels: DynamicImage) -> DynamicImage {
    match pixels {
        DynamicImage::ImageRgba8(_) => pixels.into_rgb8().into(),
        DynamicImage::ImageRgba16(_) => pixels.into_rgb16().into(),
        DynamicImage::ImageRgba32F(_) => pixels.into_rgb32f().into(),
        other => other,
    }
}

/// The pictures of one MTL while it is written.
pub(super) struct Pictures<'a> {
    world: &'a World,
    file: &'a Path,
    rebase: Rebase,
    /// Sources that become files beside the MTL, what is kept of them, and their names.
    beside: Vec<(String, Kept, String)>,
    created: Created,
    /// Files that materials name, which stay as they are.
    taken: HashSet<String>,
}

impl<'a> Pictures<'a> {
    /// For an MTL at this place. Nothing is written over that its materials name.
    pub fn of(world: &'a World, file: &'a Path, exported: &Exported) -> Self {
        let mut pictures = Self {
            world,
            file,
            rebase: Rebase::new(world, file),
            beside: Vec::new(),
            created: Created::default(),
            taken: HashSet::new(),
        };
        let materials = exported.materials.iter().map(|material| &material.phong);
        let maps = materials.flat_map(|phong| PhongMap::ALL.map(|map| map.source(phong)));
        let named = maps.flatten().filter_map(|map| pictures.named(&map.path));
        pictures.taken = named.collect();
        pictures
    }

    /// Those that were written, and those that the old MTL brought along and that neither the new one nor the scene
    /// names.
    pub fn finish(self, old: &[u8]) -> (Created, Vec<PathBuf>) {
        let replaced = self.replaced(old);
        (self.created, replaced)
    }

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

    /// A name for a picture that is written beside the file, and whether this very picture has it already.
    fn free_name(&self, extension: &str, bytes: &[u8]) -> (String, bool) {
        let stem = stem_of(self.file);
        let mut number = self.beside.len();
        loop {
            let name = format!("{stem}-texture{number}.{extension}");
            number += 1;
            let given = self.beside.iter().any(|(.., other)| *other == name);
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

    /// The same of a picture whose brightness is opacity, of a material whose colours' picture is `colors`. Readers, ours
    /// too, take a `map_d` for alpha where it has any, or where it is the colours' picture: such a one is written without
    /// its alpha, under a name of its own.
    pub fn name_of_opacity(
        &mut self,
        source: &TextureSource,
        loaded: Option<&Handle<Image>>,
        colors: Option<&TextureSource>,
        notes: &mut Notes,
    ) -> Result<Option<String>, FileError> {
        let file_of = |path: &str| self.named(path).unwrap_or_else(|| path.to_owned());
        let is_of_colors = colors.is_some_and(|map| file_of(&map.path) == file_of(&source.path));
        let pixels = loaded.and_then(|handle| pixels_of(self.world, handle.id()));
        let kept = match is_of_colors || pixels.is_some_and(|pixels| has_alpha(&pixels)) {
            true => Kept::Brightness,
            false => Kept::All,
        };
        self.name(source, loaded, kept, notes)
    }

    /// What the MTL calls a picture; `None` where it cannot be written.
    pub fn name(
        &mut self,
        TextureSource { path, .. }: &TextureSource,
        loaded: Option<&Handle<Image>>,
        kept: Kept,
        notes: &mut Notes,
    ) -> Result<Option<String>, FileError> {
        if let Some(named) = self.named(path).filter(|_| kept == Kept::All) {
            return Ok(Some(named));
        }
        let is_it = |(source, how, _): &&(String, Kept, String)| source == path && *how == kept;
        if let Some((.., name)) = self.beside.iter().find(is_it) {
            return Ok(Some(name.clone()));
        }
        let pixels = loaded.and_then(|handle| pixels_of(self.world, handle.id()));
        let Some(pixels) = pixels else {
            let what = "a picture that is not loaded:";
            notes.add_named(self.file, Place::Whole, what, path, "left out");
            return Ok(None);
        };
        let pixels = match kept {
            Kept::All => pixels,
            Kept::Brightness => without_alpha(pixels),
        };
        let (extension, format) = match pixels {
            DynamicImage::ImageRgba32F(_) | DynamicImage::ImageRgb32F(_) => {
                ("exr", image::ImageFormat::OpenExr)
            }
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
        let (what, instead) = match kept {
            Kept::All => (
                format!("an MTL cannot name the picture `{path}`, written as"),
                "named so",
            ),
            Kept::Brightness => (
                format!("an MTL would take the alpha of `{path}` for opacity, written as"),
                "its brightness alone is there",
            ),
        };
        notes.add_named(self.file, Place::Whole, what, &name, instead);
        self.beside.push((path.clone(), kept, name.clone()));
        Ok(Some(name))
    }

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
                || self.beside.iter().any(|(.., other)| other == name)
                || files.is_some_and(|files| {
                    super::super::check_outputs([&*place], files.inputs()).is_err()
                })
        };
        let names = names.filter(is_own).filter(|name| !is_used(name));
        names.map(|name| folder_of(self.file).join(name)).collect()
    }
}
