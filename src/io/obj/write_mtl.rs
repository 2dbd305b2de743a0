use super::super::error::FileError;
use super::super::exported::{Exported, pixels_of};
use super::super::folder::{Folder, stays_inside};
use super::super::replace::replace_file;
use super::super::scene_file::Rebase;
use super::super::sources::BUILTIN;
use crate::io::Limits;
use crate::scene::TextureSource;
use bevy::asset::Handle;
use bevy::color::LinearRgba;
use bevy::image::Image;
use bevy::prelude::World;
use image::DynamicImage;
use std::collections::HashSet;
use std::io::Write;
use std::path::Path;

/// Writes the materials. A picture that is a file is named from the MTL's folder; one that is not,
/// or lies elsewhere, is written beside it as `NAME-texture0.png` (or `.exr` where it holds floats).
pub(super) fn write_mtl(
    world: &World,
    file: &Path,
    exported: &mut Exported,
) -> Result<(), FileError> {
    let limits = Limits::default();
    let mut pictures = Pictures {
        world,
        file,
        rebase: Rebase::new(world, file),
        written: Vec::new(),
        replaced: super::super::read_bytes(file, limits.file_bytes, &limits.memory)
            .unwrap_or_default(),
        taken: HashSet::new(),
    };
    pictures.take_names(exported);
    let mut maps = Vec::new();
    for material in &exported.materials {
        let (phong, loaded) = (&material.phong, &material.maps);
        let notes = &mut exported.notes;
        maps.push([
            pictures.name(phong.diffuse_map.as_ref(), loaded.diffuse.as_ref(), notes)?,
            pictures.name(phong.opacity_map.as_ref(), loaded.opacity.as_ref(), notes)?,
        ]);
    }
    replace_file(file, |out| {
        for (material, [diffuse, opacity]) in exported.materials.iter().zip(&maps) {
            let phong = &material.phong;
            let rgb = |c: LinearRgba| format!("{} {} {}", c.red, c.green, c.blue);
            writeln!(out, "newmtl {}", material.name)?;
            writeln!(out, "Kd {}", rgb(phong.diffuse))?;
            writeln!(out, "Ks {}", rgb(phong.specular))?;
            writeln!(out, "Ns {}", phong.shininess)?;
            writeln!(out, "d {}", phong.opacity)?;
            writeln!(out, "Ke {}", rgb(phong.emission))?;
            if let Some(picture) = diffuse {
                writeln!(out, "map_Kd {picture}")?;
            }
            if let Some(picture) = opacity {
                writeln!(out, "map_d {picture}")?;
            }
            writeln!(out)?;
        }
        Ok(())
    })
}

struct Pictures<'a> {
    world: &'a World,
    file: &'a Path,
    rebase: Rebase,
    /// Sources that were written beside the file, and their names.
    written: Vec<(String, String)>,
    /// The MTL that was there: the pictures that it brought along are replaced with it.
    replaced: Vec<u8>,
    /// Files that materials name, which stay as they are.
    taken: HashSet<String>,
}

impl Pictures<'_> {
    /// A picture that is a file, as the MTL can name it.
    fn named(&self, path: &str) -> Option<String> {
        let is_file = !path.starts_with(BUILTIN) && !path.contains('#');
        let named = is_file.then(|| self.rebase.path(path, &mut Vec::new()));
        named.filter(|named| stays_inside(named))
    }

    /// Notes the names that no picture may be written under.
    fn take_names(&mut self, exported: &Exported) {
        let materials = exported.materials.iter().map(|material| &material.phong);
        let maps = materials.flat_map(|phong| [&phong.diffuse_map, &phong.opacity_map]);
        let named = maps.flatten().filter_map(|map| self.named(&map.path));
        self.taken = named.collect();
    }

    fn is_replaced(&self, name: &str) -> bool {
        let mut lines = self.replaced.split(|&byte| byte == b'\n');
        lines.any(|line| line.trim_ascii_end().ends_with(name.as_bytes()))
    }

    /// A name for a picture that is written beside the file.
    fn free_name(&self, extension: &str, folder: &Path) -> String {
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let mut number = self.written.len();
        loop {
            let name = format!("{stem}-texture{number}.{extension}");
            let written = self.written.iter().any(|(_, other)| *other == name);
            let kept = folder.join(&name).exists() && !self.is_replaced(&name);
            if !(written || kept || self.taken.contains(&name)) {
                return name;
            }
            number += 1;
        }
    }

    /// What the MTL calls a picture; `None` where there is none, or none that can be written.
    fn name(
        &mut self,
        source: Option<&TextureSource>,
        loaded: Option<&Handle<Image>>,
        notes: &mut Vec<String>,
    ) -> Result<Option<String>, FileError> {
        let Some(TextureSource { path }) = source else {
            return Ok(None);
        };
        if let Some(named) = self.named(path) {
            return Ok(Some(named));
        }
        if let Some((_, name)) = self.written.iter().find(|(source, _)| source == path) {
            return Ok(Some(name.clone()));
        }
        let pixels = loaded.and_then(|handle| pixels_of(self.world, handle.id()));
        let Some(pixels) = pixels else {
            notes.push(format!(
                "the picture `{path}` is not loaded and was left out"
            ));
            return Ok(None);
        };
        let extension = match pixels {
            DynamicImage::ImageRgba32F(_) => "exr",
            _ => "png",
        };
        let folder = Folder::of(self.file, true).path;
        let name = self.free_name(extension, &folder);
        write_pixels(&folder.join(&name), &pixels)?;
        notes.push(format!("the picture `{path}` was written as `{name}`"));
        self.written.push((path.clone(), name.clone()));
        Ok(Some(name))
    }
}

fn write_pixels(file: &Path, pixels: &DynamicImage) -> Result<(), FileError> {
    let format = match pixels {
        DynamicImage::ImageRgba32F(_) => image::ImageFormat::OpenExr,
        _ => image::ImageFormat::Png,
    };
    replace_file(file, |out| {
        pixels.write_to(out, format).map_err(std::io::Error::other)
    })
}
