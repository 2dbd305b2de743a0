//! From MTL to Phong: both use the same names.
//!
//! | MTL | Phong |
//! |---|---|
//! | `Kd`, `map_Kd` | `diffuse`, `diffuse_map`; 0 0 0 with a picture counts as 1 1 1 |
//! | `Ks`, `map_Ks` | `specular`, but where `illum` is 0 or 1; `mirror`, where it is 3 to 9; their maps |
//! | `Ns` | `shininess`; below 1 it is 1, and `specular` fades with it |
//! | `d`, `Tr` | `opacity`; `Tr` is 1 - `d`, and `d` wins |
//! | `map_d` | `opacity_map`: its alpha where any of that is below 1, else its brightness |
//! | `Ke`, `map_Ke` | `emission`, `emission_map` |
//! | `norm`, its `-bm` | `normal_map`, `normal_scale` |
//! | `map_Bump` | the same, where its picture holds normals, as many exporters write it; heights are left out |
//!
//! A colour that is not given is 1 1 1 where its picture is, and 0 0 0 where that cannot be found. `-clamp on` clamps.

use super::super::error::{FileError, Place};
use super::super::file_name::of_file;
use super::super::folder::Folder;
use super::super::notes::Notes;
use super::super::picture::{Measured, MeasuredPictures, PictureUse, read_picture};
use super::mtl::{Map, MtlMaterial, NamedMap};
use super::parts::{Pictured, Placement};
use crate::scene::{Phong, PhongMap, TextureSource, Wrap};
use bevy::color::LinearRgba;

/// What is missing takes Phong's default; numbers outside Phong's ranges are clamped, with a note.
///
/// # Errors
/// A picture that has to be looked at needs more memory than is left.
pub(super) fn phong_of(
    material: &MtlMaterial,
    folder: &Folder,
    measured: &mut MeasuredPictures<String>,
    notes: &mut Notes,
) -> Result<(Phong, Pictured), FileError> {
    let mut measure = |map: &Map| {
        measured.measure(map.path.clone(), |limits| {
            read_picture(&folder.resolve(&map.path)?, PictureUse::Data, limits)
        })
    };
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
    if matches!(material.specular_map, Some(None)) {
        exact.specular = LinearRgba::BLACK;
    } else if material.specular.is_none() && material.specular_map.is_some() {
        exact.specular = LinearRgba::WHITE;
    }
    match material.illum {
        Some(0 | 1) => exact.specular = LinearRgba::BLACK,
        Some(3..=9) => exact.mirror = exact.specular,
        // 2 and no model at all mean a highlight alone.
        _ => {}
    }
    // What a picture scales goes with it, and is whole where only the picture is named.
    let goes = |map: &Option<NamedMap>| matches!(map, Some(None));
    let is_whole = |given: Option<[f32; 3]>, map: &Option<NamedMap>| {
        given.is_none() && matches!(map, Some(Some(_)))
    };
    if is_whole(material.diffuse, &material.diffuse_map) || is_black_under_a_map(material) {
        exact.diffuse = LinearRgba::WHITE;
    }
    if goes(&material.emission_map) {
        exact.emission = LinearRgba::BLACK;
    } else if is_whole(material.emission, &material.emission_map) {
        exact.emission = LinearRgba::WHITE;
    }
    if material.refraction.is_some_and(|index| index != 1.0) && exact.opacity < 1.0 {
        note("refraction (Ni) of", "light goes straight through");
    }
    if exact.opacity <= 0.0 {
        note("an opacity of 0 (d 0, or Tr 1 alone), of", "it is not seen");
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
    let named = |map: &Option<NamedMap>| map.clone().flatten();
    let mut normals = named(&material.normal_map);
    if let Some(bumps) = named(&material.bump_map) {
        let is_alone = normals.is_none();
        if is_alone && measure(&bumps)?.is_some_and(holds_normals) {
            note("a map_Bump whose picture holds normals, of", "read as norm");
            normals = Some(bumps);
        } else if is_alone {
            let what = "heights (map_Bump), for which Phong has normals alone, of";
            note(what, "left out");
        } else {
            note("a map_Bump beside norm, of", "left out");
        }
    }
    let maps = [
        (PhongMap::Diffuse, named(&material.diffuse_map)),
        (PhongMap::Specular, named(&material.specular_map)),
        (PhongMap::Emission, named(&material.emission_map)),
        (PhongMap::Opacity, named(&material.opacity_map)),
        (PhongMap::Normal, normals),
    ];
    let placements = maps.iter().filter_map(|(_, map)| map.as_ref());
    let placements: Vec<Placement> = placements.map(|map| map.placement).collect();
    if placements.windows(2).any(|pair| pair[0] != pair[1]) {
        note(
            "pictures with different -s and -o of",
            "all are placed as the first",
        );
    }
    let diffuse_path = named(&material.diffuse_map).map(|map| map.path);
    for (of, map) in maps {
        let Some(map) = map else { continue };
        let is_diffuse = diffuse_path.as_ref() == Some(&map.path);
        let path = match of {
            PhongMap::Opacity => {
                let has_alpha = measure(&map)?.is_some_and(|picture| picture.has_alpha);
                opacity_source(&map, is_diffuse, has_alpha)
            }
            _ => Some(of_file(map.path)),
        };
        let Some(path) = path else {
            note(
                "a map_d that is the colours' picture and has no alpha, of",
                "left out",
            );
            continue;
        };
        let wrap = if map.is_clamped {
            Wrap::Clamp
        } else {
            Wrap::Repeat
        };
        if of == PhongMap::Normal {
            phong.normal_scale = map.bump;
        }
        *of.source_mut(&mut phong) = Some(TextureSource {
            wrap_u: wrap,
            wrap_v: wrap,
            ..TextureSource::new(path)
        });
    }
    if phong.mirror != LinearRgba::BLACK {
        phong.mirror_map.clone_from(&phong.specular_map);
    }
    if phong.specular == LinearRgba::BLACK {
        phong.specular_map = None;
    }
    let pictured = Pictured {
        placement: placements.first().copied().unwrap_or_default(),
        has_pictures: PhongMap::ALL.iter().any(|map| map.source(&phong).is_some()),
    };
    Ok((phong, pictured))
}

/// Some programs write `Kd 0 0 0` where they mean that all colour comes from the picture; and where that is missing,
/// something has to be seen.
fn is_black_under_a_map(material: &MtlMaterial) -> bool {
    material.diffuse == Some([0.0; 3]) && material.diffuse_map.is_some()
}

/// What of a picture means opacity: its alpha where it has any, else its brightness; nothing where it is `is_diffuse`
/// and has none.
fn opacity_source(map: &Map, is_diffuse: bool, has_alpha: bool) -> Option<String> {
    match (has_alpha, is_diffuse) {
        (true, _) => Some(format!("{}#alpha", of_file(map.path.clone()))),
        (false, false) => Some(of_file(map.path.clone())),
        (false, true) => None,
    }
}

/// Whether a picture holds normals in tangent space, not heights: in the mean they point out of the surface, and heights
/// are grey. Such pictures have 8 bits.
fn holds_normals(picture: Measured) -> bool {
    let [red, green, blue, _] = picture.mean;
    let is_middle = |mean: f64| (96.0 / 255.0..160.0 / 255.0).contains(&mean);
    picture.has_8_bits && is_middle(red) && is_middle(green) && blue >= 193.0 / 255.0
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
