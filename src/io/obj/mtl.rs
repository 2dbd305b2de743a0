//! The material file of an OBJ. tobj parses it; the lines are checked first, because it stops the
//! program at a colour with fewer than three numbers, and because an error should name its line.

use super::super::error::{FileError, Place, Problem};
use super::super::file_name::of_file;
use super::super::folder::Folder;
use crate::io::Limits;
use crate::io::budget::ENTITY;
use crate::scene::{Phong, TextureSource};
use bevy::color::LinearRgba;
use std::path::PathBuf;

/// An MTL file holds text of a few lines a material; more than this is something else.
const FILE_BYTES: u64 = 1 << 26;

/// The materials of an MTL file.
pub(super) struct Library {
    /// Where it lies.
    pub file: PathBuf,
    /// As tobj wants them.
    pub loaded: tobj::MTLLoadResult,
    /// What could not be taken over.
    pub notes: Vec<String>,
}

/// Reads the MTL file that an OBJ in `folder` calls `name`, and checks each of its lines. Pictures
/// must exist; their names start from the MTL's folder in the file and from the OBJ's in the result.
pub(super) fn read_mtl(name: &str, folder: &Folder, limits: &Limits) -> Result<Library, FileError> {
    let file = &folder.resolve(name)?;
    let prefix = name.rfind('/').map_or("", |slash| &name[..=slash]);
    let limit = FILE_BYTES.min(limits.file_bytes);
    let bytes = super::super::read_bytes(file, limit, &limits.memory)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut checked = String::with_capacity(text.len());
    let mut notes = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = check_line(line.trim(), prefix, folder, &mut notes)
            .map_err(|problem| FileError::at(file, Place::Line(number as u64 + 1), problem))?;
        checked.push_str(&line);
        checked.push('\n');
    }
    let materials = checked.lines().filter(|line| line.starts_with("newmtl"));
    (limits.memory)
        .claim(ENTITY * materials.count() as u64)
        .map_err(|problem| FileError::new(file, problem))?;
    Ok(Library {
        file: file.clone(),
        loaded: tobj::load_mtl_buf(&mut checked.as_bytes()),
        notes,
    })
}

/// The line as tobj shall see it.
fn check_line(
    line: &str,
    prefix: &str,
    folder: &Folder,
    notes: &mut Vec<String>,
) -> Result<String, Problem> {
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    match word {
        "newmtl" if rest.is_empty() => Err(Problem::Malformed("a material has no name".into())),
        "Ka" | "Kd" | "Ks" | "Ke" => {
            let numbers = finite_numbers(word, rest)?;
            // One number stands for grey.
            let rgb = match numbers[..] {
                [r] => [r; 3],
                [r, g, b] => [r, g, b],
                _ => {
                    return Err(Problem::Truncated(format!(
                        "{word} needs 3 numbers and has {}",
                        numbers.len()
                    )));
                }
            };
            Ok(format!("{word} {} {} {}", rgb[0], rgb[1], rgb[2]))
        }
        "Ns" | "d" | "Ni" | "Tr" => {
            // `d -halo` depends on the view; its number is taken.
            let numbers = finite_numbers(word, rest.trim_start_matches("-halo"))?;
            match numbers.first() {
                Some(number) => Ok(format!("{word} {number}")),
                None => Err(Problem::Truncated(format!("{word} has no number"))),
            }
        }
        "map_Kd" | "map_d" => {
            let path = after_options(rest, word, notes).replace('\\', "/");
            if path.is_empty() {
                return Err(Problem::Truncated(format!("{word} names no picture")));
            }
            let path = format!("{prefix}{path}");
            let full = folder
                .resolve(&path)
                .map_err(|_| Problem::RefersOutside { path: path.clone() })?;
            if !full.is_file() {
                return Err(Problem::MissingFile { path });
            }
            Ok(format!("{word} {}", of_file(path)))
        }
        _ if word.starts_with("map_") || matches!(word, "bump" | "disp" | "decal" | "refl") => {
            notes.push(format!("`{word}` has no place in Phong and was left out"));
            Ok(String::new())
        }
        // Everything else is not read: `illum`, `Tf`, `sharpness` and what renderers added.
        "newmtl" => Ok(line.to_owned()),
        _ => Ok(String::new()),
    }
}

fn finite_numbers(word: &str, rest: &str) -> Result<Vec<f32>, Problem> {
    rest.split_ascii_whitespace()
        .map(|number| match number.parse::<f32>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(Problem::NotFinite {
                what: format!("{word}'s `{number}`"),
            }),
            Err(_) => Err(Problem::Malformed(format!(
                "{word}'s `{number}` is not a number"
            ))),
        })
        .collect()
}

/// The picture's name without the options before it, each with the numbers that follow it.
fn after_options<'a>(rest: &'a str, word: &str, notes: &mut Vec<String>) -> &'a str {
    let mut rest = rest;
    while let Some(option) = rest.strip_prefix('-') {
        let (option, mut after) = option
            .split_once(char::is_whitespace)
            .unwrap_or((option, ""));
        let most = match option {
            "o" | "s" | "t" => 3,
            "mm" => 2,
            _ => 1,
        };
        for i in 0..most {
            after = after.trim_start();
            let (value, then) = after.split_once(char::is_whitespace).unwrap_or((after, ""));
            // `-o`, `-s` and `-t` take one to three numbers.
            if i > 0 && value.parse::<f32>().is_err() {
                break;
            }
            after = then;
        }
        notes.push(format!("{word}: the option `-{option}` was left out"));
        rest = after.trim_start();
    }
    rest
}

/// MTL and Phong use the same names; what is missing takes Phong's default.
/// Numbers outside Phong's ranges are clamped, with a note.
pub(super) fn phong_of(material: &tobj::Material, notes: &mut Vec<String>) -> Phong {
    let default = Phong::default();
    let color = |given: Option<[f32; 3]>, otherwise| {
        given.map_or(otherwise, |[r, g, b]| LinearRgba::rgb(r, g, b))
    };
    let transparency = material.unknown_param.get("Tr");
    let transparency = transparency.and_then(|value| value.parse::<f32>().ok());
    let opacity = material.dissolve.or(transparency.map(|tr| 1.0 - tr));
    let texture = |path: &Option<String>| path.clone().map(|path| TextureSource { path });
    let exact = Phong {
        diffuse: color(material.diffuse, default.diffuse),
        specular: color(material.specular, default.specular),
        shininess: material.shininess.unwrap_or(default.shininess),
        opacity: opacity.unwrap_or(default.opacity),
        emission: color(material.emissive, default.emission),
        diffuse_map: texture(&material.diffuse_texture),
        opacity_map: texture(&material.dissolve_texture),
    };
    let clamped = clamp(exact.clone());
    if clamped != exact {
        notes.push(format!(
            "material `{}`: numbers outside Phong's ranges were clamped",
            material.name
        ));
    }
    clamped
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
        shininess: phong.shininess.max(1.0),
        opacity: phong.opacity.clamp(0.0, 1.0),
        emission: each(phong.emission, f32::MAX),
        ..phong
    }
}
