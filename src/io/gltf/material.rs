//! glTF's metallic–roughness material and Phong, in both directions.
//!
//! In: with base colour `b`, metalness `m`, roughness `r`, and `F0 = 0.04` (`KHR_materials_specular`
//! scales and tints it; its pictures are `specular_map` and `mirror_map` where no metal has them):
//!
//! | Phong | from |
//! |---|---|
//! | gloss | `g = (1 - r)²`: a mirror is sharp, and a rough surface is none |
//! | `diffuse` | `b · (1 - m·g)`: what a rough metal does not mirror it scatters |
//! | `specular`, `mirror` | `lerp(F0, b, m) · g`; times the base colour's picture where `m` is above ½ |
//! | `shininess` | `2/r⁴ - 2`, within 1 to 10,000: the lobe of the same width (Walter et al. 2007, section 5.2, with α = r²) |
//! | `opacity`, `alpha` | base alpha where `alphaMode` is `BLEND` or `MASK`, with its cutoff; else 1; times 1 - transmission |
//! | `emission`, `emission_map` | emissive factor · `KHR_materials_emissive_strength`, and its picture |
//! | `diffuse_map`, `opacity_map` | the base colour's picture, and its alpha where opacity counts |
//! | `normal_map`, `normal_scale` | the normals' picture |
//!
//! A picture of metalness and roughness counts with its mean. `KHR_materials_pbrSpecularGlossiness`: `diffuse` and
//! `specular` as they are there with their pictures, `specular` times the gloss of `r = 1 - glossiness`, which is `mirror`, too; a picture
//! of glossiness counts with its mean. `KHR_materials_unlit`: what would be `diffuse` is `emission`, times
//! the vertices' colours, and reflects nothing.
//!
//! Out: `b = diffuse`, `m = 0`, `r` from `shininess`, and the exact Phong numbers in the material's
//! `extras` as `glassbox_phong`, which are preferred on the way in.

use super::super::error::FileError;
use super::document::Document;
use super::json::Json;
use super::pictures::Pictures;
use super::texture::{MeasuredImages, TextureInfo, alpha_of, mean, texture_source};
use crate::scene::{Alpha, Phong};
use bevy::color::LinearRgba;
use serde::{Deserialize, Serialize};

/// Reflectance of common dielectrics at normal incidence, glTF 2.0, appendix B.
const F0: f32 = 0.04;
/// Beyond this a highlight is smaller than a pixel.
const MOST_SHININESS: f32 = 10_000.0;
/// The name under `extras`.
pub(super) const EXTRAS: &str = "glassbox_phong";

/// Phong's numbers as they stand in `extras`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Numbers {
    diffuse: [f32; 3],
    specular: [f32; 3],
    /// The same as `specular` in files that are older than it.
    mirror: Option<[f32; 3]>,
    shininess: f32,
    opacity: f32,
    emission: [f32; 3],
    /// As glTF's `alphaMode`, which is `OPAQUE` where nothing fades. Files without it blend.
    alpha: Option<String>,
}

pub(super) const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// The material that primitives without one have: white and rough.
pub(super) fn default_phong() -> Phong {
    Phong {
        diffuse: LinearRgba::WHITE,
        shininess: 1.0,
        ..Phong::default()
    }
}

/// A material with its pictures. What cannot be taken over is noted.
///
/// # Errors
/// A picture whose mean is taken needs more memory than is left.
pub(super) fn phong_of(
    document: &Document,
    measured: &mut MeasuredImages,
    index: usize,
    material: Json,
    name: &str,
) -> Result<Phong, FileError> {
    let part = format!("materials[{index}]");
    let note = |what: &str, instead| document.note_named(&part, what, name, instead);
    let extras = material.get("extras").and_then(|extras| extras.get(EXTRAS));
    let exact = extras.and_then(exact_phong);
    let is_exact = exact.is_some();
    // Pictures took the place of colours before there was a mirror of its own.
    let is_of_old = is_exact && extras.is_some_and(|extras| extras.get("mirror").is_none());
    let pbr = material.get("pbrMetallicRoughness");
    let glossy = material.extension(SPECULAR_GLOSSINESS);
    let base = match glossy {
        Some(glossy) => glossy.numbers("diffuseFactor"),
        None => pbr.and_then(|pbr| pbr.numbers("baseColorFactor")),
    };
    if has_numbers_outside(material) {
        note("numbers outside glTF's ranges, in", "clamped");
    }
    let [red, green, blue, alpha] = base.unwrap_or([1.0; 4]).map(unit);
    let base = [red, green, blue];
    // Read in any case: what stands beside the exact numbers is not passed over.
    let (mapped, metal) = match glossy {
        Some(glossy) => {
            let phong = specular_glossiness(document, measured, glossy, base, &note)?;
            (phong, 0.0)
        }
        None => metallic_roughness(document, measured, material, base, &note)?,
    };
    let mut phong = exact.unwrap_or(mapped);
    let pictures = Pictures::of(material);
    let placement = |picture: TextureInfo| (picture.set, picture.transform.unwrap_or_default());
    let mut placed = pictures.all().map(placement);
    let first = placed.next();
    if placed.any(|other| Some(other) != first) {
        let what = "pictures with different texture coordinates of";
        note(what, "all are placed as the first");
    }
    let base_picture = texture_source(document, pictures.base)?;
    let has_alpha = opacity(
        material,
        alpha,
        base_picture.is_some(),
        &note,
        &mut phong,
        is_exact,
    );
    if phong.opacity == 0.0 && phong.alpha == Alpha::Blend {
        note("an opacity of 0, of", "it is not seen");
    }
    if has_alpha {
        phong.opacity_map = base_picture.as_ref().map(alpha_of);
    }
    let emissive = material.numbers("emissiveFactor").unwrap_or([0.0; 3]);
    let strength = material.extension("KHR_materials_emissive_strength");
    let strength = strength.and_then(|strength| strength.number("emissiveStrength"));
    if !is_exact {
        let strength = strength.unwrap_or(1.0);
        phong.emission = color(emissive.map(|e| at_least_0(e * strength)));
    }
    phong.emission_map = texture_source(document, pictures.emissive)?;
    if pictures.emissive.is_some() && phong.emission_map.is_none() {
        phong.emission = LinearRgba::BLACK;
    }
    phong.normal_map = texture_source(document, pictures.normal)?;
    let scale = material
        .get("normalTexture")
        .and_then(|json| json.number("scale"));
    phong.normal_scale = scale.unwrap_or(1.0);
    if material.extension("KHR_materials_unlit").is_some() {
        phong.emission = phong.diffuse;
        phong.emission_map = base_picture;
        phong.diffuse = LinearRgba::BLACK;
        phong.specular = LinearRgba::BLACK;
        phong.mirror = LinearRgba::BLACK;
        return Ok(phong);
    }
    if metal > 0.5 && pictures.have_reflections() {
        note("pictures of reflections, on a metal, of", "left out");
    }
    if !is_exact {
        let map = match metal > 0.5 {
            // A metal reflects in its colour.
            true => base_picture.clone(),
            false => pictures.of_reflections(document, &note)?,
        };
        phong.specular_map.clone_from(&map);
        phong.mirror_map = map;
    }
    if base_picture.is_some() && metal > 0.0 && metal < 1.0 && !is_exact {
        let what = "a picture on what is partly metal, of";
        note(what, "highlights take its colour where more than half is");
    }
    if is_of_old && base_picture.is_some() {
        phong.diffuse = LinearRgba::WHITE;
    }
    phong.diffuse_map = base_picture;
    Ok(phong)
}

/// Whether a number of a material is clamped.
fn has_numbers_outside(material: Json) -> bool {
    let of = |extension| material.extension(extension);
    let pbr = material.get("pbrMetallicRoughness");
    let glossy = of(SPECULAR_GLOSSINESS);
    let parts = [
        (pbr, "baseColorFactor"),
        (pbr, "metallicFactor"),
        (pbr, "roughnessFactor"),
        (glossy, "diffuseFactor"),
        (glossy, "specularFactor"),
        (glossy, "glossinessFactor"),
        (of("KHR_materials_specular"), "specularFactor"),
        (of("KHR_materials_transmission"), "transmissionFactor"),
    ];
    let is_outside =
        |(part, key): (Option<Json>, _)| part.is_some_and(|part| part.is_outside(key, 0.0..=1.0));
    let below_0 = |key| material.is_outside(key, 0.0..=f64::INFINITY);
    parts.into_iter().any(is_outside) || below_0("emissiveFactor") || below_0("alphaCutoff")
}

/// The material, and how much of it is metal.
fn metallic_roughness(
    document: &Document,
    measured: &mut MeasuredImages,
    material: Json,
    base: [f32; 3],
    note: &impl Fn(&str, &'static str),
) -> Result<(Phong, f32), FileError> {
    let pbr = material.get("pbrMetallicRoughness");
    let factor = |key| {
        let number = pbr.and_then(|pbr| pbr.number(key));
        unit(number.unwrap_or(1.0))
    };
    let (mut metal, mut rough) = (factor("metallicFactor"), factor("roughnessFactor"));
    let picture = pbr.and_then(|pbr| TextureInfo::of(pbr.get("metallicRoughnessTexture")?));
    if let Some(picture) = picture {
        match mean(document, measured, picture.texture)? {
            Some([_, green, blue, _]) => {
                note(
                    "a picture of metalness and roughness, of",
                    "its mean is taken",
                );
                rough *= green;
                metal *= blue;
            }
            None => {
                note(
                    "a picture of metalness and roughness that cannot be read, of",
                    "rough, no metal",
                );
                (metal, rough) = (0.0, 1.0);
            }
        }
    }
    let gloss = (1.0 - rough) * (1.0 - rough);
    let specular = material.extension("KHR_materials_specular");
    let factor = specular.and_then(|specular| specular.number("specularFactor"));
    let factor = unit(factor.unwrap_or(1.0));
    let tint = specular.and_then(|specular| specular.numbers("specularColorFactor"));
    let tint = tint.unwrap_or([1.0; 3]);
    let specular = std::array::from_fn(|i| {
        let dielectric = unit(F0 * factor * tint[i]);
        unit((dielectric + metal * (base[i] - dielectric)) * gloss)
    });
    let phong = Phong {
        diffuse: color(base.map(|b| b * (1.0 - metal * gloss))),
        specular: color(specular),
        mirror: color(specular),
        shininess: shininess(rough),
        ..Phong::default()
    };
    Ok((phong, metal))
}

fn specular_glossiness(
    document: &Document,
    measured: &mut MeasuredImages,
    json: Json,
    base: [f32; 3],
    note: &impl Fn(&str, &'static str),
) -> Result<Phong, FileError> {
    let mut glossiness = unit(json.number("glossinessFactor").unwrap_or(1.0));
    let picture = json
        .get("specularGlossinessTexture")
        .and_then(TextureInfo::of);
    let mean = picture.map(|picture| mean(document, measured, picture.texture));
    // One that cannot be read is noted where reflections take its colour.
    if let Some([.., alpha]) = mean.transpose()?.flatten() {
        if glossiness > 0.0 && alpha < 1.0 {
            note("a picture of glossiness, of", "its mean is taken");
        }
        glossiness *= alpha;
    }
    let rough = 1.0 - glossiness;
    let gloss = (1.0 - rough) * (1.0 - rough);
    let specular = json.numbers("specularFactor").unwrap_or([1.0; 3]);
    let specular = color(specular.map(|s| unit(s) * gloss));
    Ok(Phong {
        diffuse: color(base),
        specular,
        mirror: specular,
        shininess: shininess(rough),
        ..Phong::default()
    })
}

fn shininess(rough: f32) -> f32 {
    (2.0 / rough.powi(4) - 2.0).clamp(1.0, MOST_SHININESS)
}

/// Opacity without the picture's, and what it means; true where the alpha of the picture counts too.
fn opacity(
    material: Json,
    alpha: f32,
    has_picture: bool,
    note: &impl Fn(&str, &'static str),
    phong: &mut Phong,
    is_exact: bool,
) -> bool {
    let mode = material.text("alphaMode").unwrap_or("OPAQUE");
    if !matches!(mode, "OPAQUE" | "MASK" | "BLEND") {
        note("an alphaMode that there is not, of", "read as OPAQUE");
    }
    let cutoff = at_least_0(material.number("alphaCutoff").unwrap_or(0.5));
    let mode = match mode {
        "BLEND" => Alpha::Blend,
        "MASK" => Alpha::Mask { cutoff },
        _ => Alpha::Opaque,
    };
    let transmission = material.extension("KHR_materials_transmission");
    let transmission = transmission.map(|json| json.number("transmissionFactor").unwrap_or(0.0));
    let through = unit(transmission.unwrap_or(0.0));
    let is_cut_out = matches!(mode, Alpha::Mask { .. }) && has_picture;
    if through > 0.0 {
        let instead = if is_cut_out {
            "left out, as it is cut out"
        } else {
            "it is opacity, and light goes straight through"
        };
        note("transmission, of", instead);
    }
    if is_exact {
        // A file of ours is opaque for others where nothing fades.
        if phong.alpha != Alpha::Blend {
            phong.alpha = mode;
        }
        return mode != Alpha::Opaque;
    }
    (phong.opacity, phong.alpha) = match mode {
        Alpha::Opaque if through > 0.0 => (1.0 - through, Alpha::Blend),
        Alpha::Opaque => (1.0, Alpha::Opaque),
        Alpha::Mask { cutoff } if through > 0.0 && !is_cut_out => {
            (f32::from(alpha >= cutoff) * (1.0 - through), Alpha::Blend)
        }
        Alpha::Mask { .. } => (alpha, mode),
        Alpha::Blend => (alpha * (1.0 - through), mode),
    };
    mode != Alpha::Opaque
}

fn exact_phong(json: Json) -> Option<Phong> {
    let numbers: Numbers = serde_json::from_value(json.value().clone()).ok()?;
    Some(Phong {
        diffuse: color(numbers.diffuse.map(unit)),
        specular: color(numbers.specular.map(unit)),
        mirror: color(numbers.mirror.unwrap_or(numbers.specular).map(unit)),
        shininess: numbers.shininess.clamp(1.0, f32::MAX),
        opacity: unit(numbers.opacity),
        emission: color(numbers.emission.map(at_least_0)),
        // The cutoff stands where other programs read it.
        alpha: match numbers.alpha.as_deref() {
            Some("MASK") => Alpha::Mask { cutoff: 0.5 },
            Some("OPAQUE") => Alpha::Opaque,
            _ => Alpha::Blend,
        },
        ..Phong::default()
    })
}

/// A material as glTF says it, without its pictures.
pub(super) fn material_json(name: &str, phong: &Phong) -> serde_json::Value {
    let rgb = |c: LinearRgba| [c.red, c.green, c.blue];
    let numbers = Numbers {
        diffuse: rgb(phong.diffuse),
        specular: rgb(phong.specular),
        mirror: Some(rgb(phong.mirror)),
        shininess: phong.shininess,
        opacity: phong.opacity,
        emission: rgb(phong.emission),
        alpha: Some(alpha_mode(phong.alpha).to_owned()),
    };
    let rough = (2.0 / (phong.shininess + 2.0)).powf(0.25);
    let emission = rgb(phong.emission);
    let strength = emission.iter().copied().fold(1.0, f32::max);
    let [red, green, blue] = rgb(phong.diffuse);
    let mut json = serde_json::json!({
        "name": name,
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": [red, green, blue, phong.opacity],
            "metallicFactor": 0.0,
            "roughnessFactor": unit(rough),
        },
        "emissiveFactor": emission.map(|e| e / strength),
        "extras": { EXTRAS: numbers },
    });
    if strength > 1.0 {
        let strength = serde_json::json!({ "emissiveStrength": strength });
        json["extensions"] = serde_json::json!({ "KHR_materials_emissive_strength": strength });
    }
    if phong.opacity < 1.0 || phong.opacity_map.is_some() {
        json["alphaMode"] = alpha_mode(phong.alpha).into();
    }
    if let Alpha::Mask { cutoff } = phong.alpha {
        json["alphaMode"] = "MASK".into();
        json["alphaCutoff"] = cutoff.into();
    }
    json
}

fn alpha_mode(alpha: Alpha) -> &'static str {
    match alpha {
        Alpha::Blend => "BLEND",
        Alpha::Mask { .. } => "MASK",
        Alpha::Opaque => "OPAQUE",
    }
}

pub(super) fn color([red, green, blue]: [f32; 3]) -> LinearRgba {
    LinearRgba::rgb(red, green, blue)
}

/// In [0, 1]; not a number becomes 0.
fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Finite and not negative; not a number becomes 0.
pub(super) fn at_least_0(value: f32) -> f32 {
    if value > 0.0 {
        value.min(f32::MAX)
    } else {
        0.0
    }
}
