//! From MTL to Phong: both use the same names.
//!
//! | MTL | Phong |
//! |---|---|
//! | `Kd`, `map_Kd` | `diffuse`, `diffuse_map` |
//! | `Ks` | `specular`, but where `illum` is 0 or 1; `mirror`, where it is 3 to 9 |
//! | `Ns` | `shininess`; below 1 it is 1, and `specular` fades with it |
//! | `d`, `Tr` | `opacity`; `Tr` is 1 - `d`, and `d` wins |
//! | `map_d` | `opacity_map`: its alpha where any of that is below 1, else its brightness |
//! | `Ke` | `emission` |

use super::super::error::Place;
use super::super::file_name::of_file;
use super::super::folder::Folder;
use super::super::notes::Notes;
use super::super::picture::{PictureUse, read_picture};
use super::mtl::{Map, MtlMaterial};
use super::parts::{Pictured, Placement};
use crate::io::Limits;
use crate::scene::{Phong, TextureSource};
use bevy::color::LinearRgba;

/// What is missing takes Phong's default; numbers outside Phong's ranges are clamped, with a note.
pub(super) fn phong_of(
    material: &MtlMaterial,
    folder: &Folder,
    limits: &Limits,
    notes: &mut Notes,
) -> (Phong, Pictured) {
    let default = Phong::default();
    let place = || Place::Line(material.line);
    let mut note = |what: &str, instead| {
        notes.add_named(&material.file, place(), what, &material.name, instead);
    };
    let color = |given: Option<[f32; 3]>, otherwise| {
        given.map_or(otherwise, |[r, g, b]| LinearRgba::rgb(r, g, b))
    };
    let opacity = material.dissolve;
    let opacity = opacity.or(material.transparency.map(|transparency| 1.0 - transparency));
    let mut exact = Phong {
        diffuse: color(material.diffuse, default.diffuse),
        specular: color(material.specular, default.specular),
        shininess: material.shininess.unwrap_or(default.shininess),
        opacity: opacity.unwrap_or(default.opacity),
        emission: color(material.emission, default.emission),
        ..default
    };
    match material.illum {
        Some(0 | 1) => exact.specular = LinearRgba::BLACK,
        Some(3..=9) => exact.mirror = exact.specular,
        // 2 and no model at all mean a highlight alone.
        _ => {}
    }
    if material.specular_map.is_some() && exact.specular != LinearRgba::BLACK {
        note(
            "map_Ks, which Phong has no place for, of",
            "left out, and Ks with it",
        );
        exact.specular = LinearRgba::BLACK;
        exact.mirror = LinearRgba::BLACK;
    }
    if material.emission_map.is_some() && exact.emission != LinearRgba::BLACK {
        note(
            "map_Ke, which Phong has no place for, of",
            "left out, and Ke with it",
        );
        exact.emission = LinearRgba::BLACK;
    }
    if material.refraction.is_some_and(|index| index != 1.0) && exact.opacity < 1.0 {
        note("refraction (Ni) of", "light goes straight through");
    }
    let mut phong = clamp(exact.clone());
    if phong != exact {
        note("numbers outside Phong's ranges in", "clamped");
    }
    if exact.shininess < 1.0 {
        // A lobe so wide covers everything; in full strength it would hide what is below it.
        let fade = exact.shininess.max(0.0);
        phong.specular = LinearRgba::rgb(
            phong.specular.red * fade,
            phong.specular.green * fade,
            phong.specular.blue * fade,
        );
    }
    let diffuse_map = material.diffuse_map.clone().flatten();
    let opacity_map = material.opacity_map.clone().flatten();
    let placements: Vec<Placement> = [&diffuse_map, &opacity_map]
        .into_iter()
        .flatten()
        .map(|map| map.placement)
        .collect();
    if placements.windows(2).any(|pair| pair[0] != pair[1]) {
        note(
            "pictures with different -s and -o of",
            "all are placed as the first",
        );
    }
    if let Some(map) = opacity_map {
        let is_diffuse = diffuse_map.as_ref().is_some_and(|d| d.path == map.path);
        match opacity_source(&map, is_diffuse, folder, limits) {
            Some(path) => phong.opacity_map = Some(TextureSource { path }),
            None => note(
                "a map_d that is the colours' picture and has no alpha, of",
                "left out",
            ),
        }
    }
    phong.diffuse_map = diffuse_map.map(|map| TextureSource {
        path: of_file(map.path),
    });
    let pictured = Pictured {
        placement: placements.first().copied().unwrap_or_default(),
        has_pictures: phong.diffuse_map.is_some() || phong.opacity_map.is_some(),
    };
    (phong, pictured)
}

/// What of a picture means opacity: its alpha where it has any, else its brightness; nothing where it is `is_diffuse`
/// and has none.
fn opacity_source(map: &Map, is_diffuse: bool, folder: &Folder, limits: &Limits) -> Option<String> {
    let file = folder.resolve(&map.path).ok();
    // One that cannot be read is noted where it is loaded.
    let picture = file.and_then(|file| read_picture(&file, PictureUse::Data, limits).ok());
    let has_alpha = picture.is_some_and(|picture| {
        let pixels = picture.width() as usize * picture.height() as usize;
        let data = picture.data.unwrap_or_default();
        match data.len().checked_div(pixels) {
            Some(4) => data
                .as_chunks::<4>()
                .0
                .iter()
                .any(|pixel| pixel[3] < u8::MAX),
            Some(8) => data
                .as_chunks::<8>()
                .0
                .iter()
                .any(|pixel| pixel[6..] != [u8::MAX; 2]),
            Some(16) => data
                .as_chunks::<16>()
                .0
                .iter()
                .any(|&[.., a, b, c, d]| f32::from_le_bytes([a, b, c, d]) < 1.0),
            _ => false,
        }
    });
    match (has_alpha, is_diffuse) {
        (true, _) => Some(format!("{}#alpha", of_file(map.path.clone()))),
        (false, false) => Some(of_file(map.path.clone())),
        (false, true) => None,
    }
}

fn clamp(phong: Phong) -> Phong {
    let each = |color: LinearRgba, most: f32| {
        LinearRgba::rgb(
            color.red.clamp(0.0, most),
            color.green.clamp(0.0, most),
            color.blue.clamp(0.0, most),
        )
    };
    Phong {
        diffuse: each(phong.diffuse, 1.0),
        specular: each(phong.specular, 1.0),
        mirror: each(phong.mirror, 1.0),
        shininess: phong.shininess.max(1.0),
        opacity: phong.opacity.clamp(0.0, 1.0),
        emission: each(phong.emission, f32::MAX),
        ..phong
    }
}
