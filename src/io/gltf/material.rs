//! glTF's metallic–roughness material and Phong, in both directions.
//!
//! In: with base colour `b`, metalness `m`, roughness `r`, and `F0 = 0.04` (`KHR_materials_specular`
//! scales and tints it):
//!
//! | Phong | from |
//! |---|---|
//! | gloss | `g = (1 - r)²`: a mirror is sharp, and a rough surface is none |
//! | `diffuse` | `b · (1 - m·g)`: what a rough metal does not mirror it scatters |
//! | `specular`, `mirror` | `lerp(F0, b, m) · g` |
//! | `shininess` | `2/r⁴ - 2`, within 1 to 10,000: the lobe of the same width (Walter et al. 2007, section 5.2, with α = r²) |
//! | `opacity` | base alpha where `alphaMode` is `BLEND`; 0 or 1 where it is `MASK`; else 1; times 1 - transmission |
//! | `emission` | emissive factor · `KHR_materials_emissive_strength` |
//! | `diffuse_map`, `opacity_map` | the base colour's picture, and its alpha where opacity counts |
//!
//! A picture of metalness and roughness counts with its mean. `KHR_materials_pbrSpecularGlossiness`: `diffuse` and
//! `specular` as they are there, `specular` times the gloss of `r = 1 - glossiness`, which is `mirror`, too. `KHR_materials_unlit`: what would
//! be `diffuse` is `emission`, and reflects nothing.
//!
//! Out: `b = diffuse`, `m = 0`, `r` from `shininess`, and the exact Phong numbers in the material's
//! `extras` as `glassbox_phong`, which are preferred on the way in. Pictures replace `diffuse`, as
//! they do in Phong; a factor on a picture is left out, with a note.

use super::super::error::FileError;
use super::super::file_name::{encoded, of_file, split_fragment};
use super::super::picture::PictureUse;
use super::document::{Document, Picture};
use super::json::Json;
use super::read::read_texture;
use crate::scene::{Phong, TextureSource};
use bevy::color::LinearRgba;
use bevy::math::{Affine2, Vec2};
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
}

/// How a material uses a texture.
#[derive(Clone, Copy)]
pub(super) struct TextureInfo {
    pub texture: usize,
    /// Which set of texture coordinates.
    pub set: usize,
    /// Moves them.
    pub transform: Option<Affine2>,
}

impl TextureInfo {
    fn of(json: Json) -> Option<Self> {
        let texture = json.index("index")?;
        let set = json.index("texCoord").unwrap_or(0);
        let Some(transform) = json.extension("KHR_texture_transform") else {
            return Some(Self {
                texture,
                set,
                transform: None,
            });
        };
        let pair = |key, otherwise| transform.numbers::<2>(key).unwrap_or(otherwise);
        // It turns counter-clockwise as seen in a picture whose v points down.
        let affine = Affine2::from_scale_angle_translation(
            pair("scale", [1.0; 2]).into(),
            -transform.number("rotation").unwrap_or(0.0),
            Vec2::from(pair("offset", [0.0; 2])),
        );
        Some(Self {
            texture,
            set: transform.index("texCoord").unwrap_or(set),
            transform: Some(affine),
        })
    }
}

/// The picture of a material's colour, whose texture coordinates meshes take.
pub(super) fn base_texture(document: &Document, material: Option<usize>) -> Option<TextureInfo> {
    let material = document.json().element("materials", material?)?;
    let glossy = material.extension(SPECULAR_GLOSSINESS);
    let json = match glossy {
        Some(glossy) => glossy.get("diffuseTexture"),
        None => material
            .get("pbrMetallicRoughness")?
            .get("baseColorTexture"),
    };
    TextureInfo::of(json?)
}

const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// The material that primitives without one have: white and rough.
pub(super) fn default_phong() -> Phong {
    Phong {
        diffuse: LinearRgba::WHITE,
        shininess: 1.0,
        ..Phong::default()
    }
}

/// A material with its pictures. What cannot be taken over is noted.
pub(super) fn phong_of(document: &Document, index: usize, material: Json, name: &str) -> Phong {
    let part = format!("materials[{index}]");
    let note = |what: &str, instead| document.note_named(&part, what, name, instead);
    let extras = material.get("extras").and_then(|extras| extras.get(EXTRAS));
    let exact = extras.and_then(exact_phong);
    let is_exact = exact.is_some();
    let pbr = material.get("pbrMetallicRoughness");
    let glossy = material.extension(SPECULAR_GLOSSINESS);
    let base = match glossy {
        Some(glossy) => glossy.numbers("diffuseFactor"),
        None => pbr.and_then(|pbr| pbr.numbers("baseColorFactor")),
    };
    let [red, green, blue, alpha] = base.unwrap_or([1.0; 4]).map(unit);
    let base = [red, green, blue];
    // Read in any case: what stands beside the exact numbers is not passed over.
    let mapped = match glossy {
        Some(glossy) => specular_glossiness(glossy, base),
        None => metallic_roughness(document, material, base, &note),
    };
    let mut phong = exact.unwrap_or(mapped);
    let texture = base_texture(document, Some(index));
    let has_alpha = opacity(
        material,
        alpha,
        texture.is_some(),
        &note,
        &mut phong,
        is_exact,
    );
    let emissive_picture = material.get("emissiveTexture").and_then(TextureInfo::of);
    let emissive = material.numbers("emissiveFactor").unwrap_or([0.0; 3]);
    let strength = material.extension("KHR_materials_emissive_strength");
    let strength = strength.and_then(|strength| strength.number("emissiveStrength"));
    if !is_exact {
        let strength = strength.unwrap_or(1.0);
        phong.emission = color(emissive.map(|e| at_least_0(e * strength)));
    }
    if emissive_picture.is_some() && phong.emission != LinearRgba::BLACK {
        note("an emissive picture, of", "left out, and what it scales");
        phong.emission = LinearRgba::BLACK;
    }
    if material.extension("KHR_materials_unlit").is_some() {
        if texture.is_some() {
            note("an unlit picture, of", "lit as others are");
        } else {
            phong.emission = phong.diffuse;
            phong.diffuse = LinearRgba::BLACK;
        }
        phong.specular = LinearRgba::BLACK;
        phong.mirror = LinearRgba::BLACK;
    }
    if let Some(texture) = texture {
        pictures(document, texture, has_alpha, &note, base, &mut phong);
    }
    phong
}

fn metallic_roughness(
    document: &Document,
    material: Json,
    base: [f32; 3],
    note: &impl Fn(&str, &'static str),
) -> Phong {
    let pbr = material.get("pbrMetallicRoughness");
    let factor = |key| {
        let number = pbr.and_then(|pbr| pbr.number(key));
        unit(number.unwrap_or(1.0))
    };
    let (mut metal, mut rough) = (factor("metallicFactor"), factor("roughnessFactor"));
    let picture = pbr.and_then(|pbr| TextureInfo::of(pbr.get("metallicRoughnessTexture")?));
    if let Some(picture) = picture {
        match mean(document, picture.texture) {
            Some([_, green, blue]) => {
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
    Phong {
        diffuse: color(base.map(|b| b * (1.0 - metal * gloss))),
        specular: color(specular),
        mirror: color(specular),
        shininess: shininess(rough),
        ..Phong::default()
    }
}

fn specular_glossiness(json: Json, base: [f32; 3]) -> Phong {
    let rough = 1.0 - unit(json.number("glossinessFactor").unwrap_or(1.0));
    let gloss = (1.0 - rough) * (1.0 - rough);
    let specular = json.numbers("specularFactor").unwrap_or([1.0; 3]);
    let specular = color(specular.map(|s| unit(s) * gloss));
    Phong {
        diffuse: color(base),
        specular,
        mirror: specular,
        shininess: shininess(rough),
        ..Phong::default()
    }
}

fn shininess(rough: f32) -> f32 {
    (2.0 / rough.powi(4) - 2.0).clamp(1.0, MOST_SHININESS)
}

/// Opacity without the picture's; true where the alpha of the picture counts too.
fn opacity(
    material: Json,
    alpha: f32,
    has_picture: bool,
    note: &impl Fn(&str, &'static str),
    phong: &mut Phong,
    is_exact: bool,
) -> bool {
    let mode = material.text("alphaMode").unwrap_or("OPAQUE");
    let cutoff = material.number("alphaCutoff").unwrap_or(0.5);
    let mut has_alpha = true;
    let opacity = match mode {
        "BLEND" => alpha,
        "MASK" if has_picture => {
            note("a picture that cuts out (MASK), of", "it fades there");
            alpha
        }
        "MASK" => f32::from(alpha >= cutoff),
        _ => {
            has_alpha = false;
            1.0
        }
    };
    let transmission = material.extension("KHR_materials_transmission");
    let transmission = transmission.map(|json| json.number("transmissionFactor").unwrap_or(0.0));
    let through = unit(transmission.unwrap_or(0.0));
    if through > 0.0 {
        note(
            "transmission, of",
            "it is opacity, and light goes straight through",
        );
    }
    if !is_exact {
        phong.opacity = opacity * (1.0 - through);
    }
    has_alpha
}

fn pictures(
    document: &Document,
    texture: TextureInfo,
    has_alpha: bool,
    note: &impl Fn(&str, &'static str),
    base: [f32; 3],
    phong: &mut Phong,
) {
    let source = match texture_source(document, texture.texture) {
        Ok(source) => source,
        Err(error) => {
            let what = error.problem.to_string();
            let instead = "its materials have no picture there";
            let mut notes = document.notes.borrow_mut();
            notes.add(&error.file, error.place, what, instead);
            return;
        }
    };
    if base.iter().any(|&factor| factor != 1.0) {
        note("the colour on a picture of", "the picture takes its place");
    }
    if has_alpha {
        let has_part = !split_fragment(&source).1.is_empty();
        let separator = if has_part { "." } else { "#" };
        let path = format!("{source}{separator}alpha");
        phong.opacity_map = Some(TextureSource { path });
    }
    phong.diffuse_map = Some(TextureSource { path: source });
    sampling(document, texture.texture, note);
}

/// Says what of a texture's sampler is not read.
fn sampling(document: &Document, texture: usize, note: &impl Fn(&str, &'static str)) {
    const NEAREST: usize = 9728;
    const REPEAT: usize = 10_497;
    let json = document.json();
    let sampler = json
        .element("textures", texture)
        .and_then(|texture| texture.index("sampler"))
        .and_then(|sampler| json.element("samplers", sampler));
    let Some(sampler) = sampler else { return };
    let is_other = |key| sampler.index(key).is_some_and(|mode| mode != REPEAT);
    // Both are read, so that neither counts as passed over.
    if is_other("wrapS") | is_other("wrapT") {
        note("a picture that does not repeat, of", "it repeats here");
    }
    // How a picture is made smaller is a setting of the render.
    sampler.index("minFilter");
    if sampler.index("magFilter") == Some(NEAREST) {
        note(
            "a picture with hard pixels, of",
            "the render's filter smooths it",
        );
    }
}

/// How scenes name the picture of a texture.
fn texture_source(document: &Document, texture: usize) -> Result<String, FileError> {
    match document.texture(texture)? {
        Picture::Beside(path) => Ok(of_file(path)),
        Picture::Inside(_) => {
            let file = document.file.file_name().unwrap_or_default();
            Ok(format!("{}#texture{texture}", encoded(file)))
        }
    }
}

/// The mean of a picture's red, green and blue as numbers.
fn mean(document: &Document, texture: usize) -> Option<[f32; 3]> {
    let image = read_texture(
        document,
        &format!("texture{texture}"),
        PictureUse::Data,
        &mut Vec::new(),
    )
    .ok()?;
    let pixels = image.width() as usize * image.height() as usize;
    let data = image.data?;
    let mut sums = [0_u64; 3];
    let pixel_bytes = data.len().checked_div(pixels)?;
    // The upper bytes of 16 bits are near enough.
    let step = match pixel_bytes {
        4 => 1,
        8 => 2,
        _ => return None,
    };
    for pixel in data.chunks_exact(pixel_bytes) {
        for (channel, sum) in sums.iter_mut().enumerate() {
            *sum += u64::from(pixel[channel * step + step - 1]);
        }
    }
    Some(sums.map(|sum| (sum as f64 / pixels as f64 / 255.0) as f32))
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
        json["alphaMode"] = "BLEND".into();
    }
    json
}

fn color([red, green, blue]: [f32; 3]) -> LinearRgba {
    LinearRgba::rgb(red, green, blue)
}

/// In [0, 1]; not a number becomes 0.
fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Finite and not negative; not a number becomes 0.
fn at_least_0(value: f32) -> f32 {
    if value > 0.0 {
        value.min(f32::MAX)
    } else {
        0.0
    }
}
