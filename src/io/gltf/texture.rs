//! How materials use pictures: which, where they lie on a mesh, and how they are read.

use super::super::error::FileError;
use super::super::file_name::{encoded, of_file, split_fragment};
use super::super::picture::{MeasuredPictures, PictureUse};
use super::document::{Document, Picture, image_of};
use super::json::Json;
use super::read::decode_texture;
use crate::scene::{MapFilter, TextureSource, Wrap};
use bevy::math::{Affine2, Vec2};

/// How a material uses a texture.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct TextureInfo {
    pub texture: usize,
    /// Which set of texture coordinates.
    pub set: usize,
    /// Moves them.
    pub transform: Option<Affine2>,
}

impl TextureInfo {
    pub fn of(json: Json) -> Option<Self> {
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

/// The alpha channel of a picture.
pub(super) fn alpha_of(picture: &TextureSource) -> TextureSource {
    let has_part = !split_fragment(&picture.path).1.is_empty();
    let separator = if has_part { "." } else { "#" };
    TextureSource {
        path: format!("{}{separator}alpha", picture.path),
        ..picture.clone()
    }
}

const NEAREST: usize = 9728;
const LINEAR: usize = 9729;
/// Both, and those two with mipmaps.
const MIN_FILTERS: [usize; 6] = [NEAREST, LINEAR, 9984, 9985, 9986, 9987];
const REPEAT: usize = 10_497;
const CLAMP_TO_EDGE: usize = 33_071;
const MIRRORED_REPEAT: usize = 33_648;

/// How a texture is read beyond its edges and between its pixels.
fn sampled(document: &Document, texture: usize, path: String) -> TextureSource {
    let json = document.json();
    let named = json
        .element("textures", texture)
        .and_then(|texture| texture.index("sampler"));
    let sampler = named.and_then(|sampler| json.element("samplers", sampler));
    let Some(sampler) = sampler else {
        if let Some(named) = named {
            let what = format!("sampler {named}, which there is not");
            let instead = "its pictures repeat";
            document.note(&format!("textures[{texture}]"), what, instead);
        }
        return TextureSource::new(path);
    };
    // What none of glTF's modes is stays unread, and is told so.
    let wrap = |key| match sampler.one_of(key, &[REPEAT, CLAMP_TO_EDGE, MIRRORED_REPEAT]) {
        Some(CLAMP_TO_EDGE) => Wrap::Clamp,
        Some(MIRRORED_REPEAT) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    // How a picture is made smaller is a setting of the render.
    sampler.one_of("minFilter", &MIN_FILTERS);
    TextureSource {
        path,
        wrap_u: wrap("wrapS"),
        wrap_v: wrap("wrapT"),
        filter: match sampler.one_of("magFilter", &[NEAREST, LINEAR]) {
            Some(NEAREST) => MapFilter::Nearest,
            Some(LINEAR) => MapFilter::Linear,
            _ => MapFilter::Setting,
        },
    }
}

/// The sampler of such a texture; `None` where it is what a texture without one has.
pub(super) fn sampler_json(source: &TextureSource) -> Option<serde_json::Value> {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => REPEAT,
        Wrap::Clamp => CLAMP_TO_EDGE,
        Wrap::Mirror => MIRRORED_REPEAT,
    };
    let TextureSource {
        wrap_u,
        wrap_v,
        filter,
        ..
    } = source;
    let mut json = serde_json::json!({ "wrapS": wrap(*wrap_u), "wrapT": wrap(*wrap_v) });
    match filter {
        MapFilter::Setting if (*wrap_u, *wrap_v) == (Wrap::Repeat, Wrap::Repeat) => return None,
        MapFilter::Setting => {}
        MapFilter::Nearest => json["magFilter"] = NEAREST.into(),
        MapFilter::Linear => json["magFilter"] = LINEAR.into(),
    }
    Some(json)
}

/// How scenes name the picture of a texture, if there is one. One that is not there is noted.
///
/// # Errors
/// What it lies in needs more memory than is left.
pub(super) fn texture_source(
    document: &Document,
    texture: Option<TextureInfo>,
) -> Result<Option<TextureSource>, FileError> {
    let Some(TextureInfo { texture, .. }) = texture else {
        return Ok(None);
    };
    let path = match document.texture(texture) {
        Ok(Picture::Beside(path)) => of_file(path),
        Ok(Picture::Inside(_)) => {
            let file = document.file.file_name().unwrap_or_default();
            format!("{}#texture{texture}", encoded(file))
        }
        Err(error) if error.problem.is_of_memory() => return Err(error),
        Err(error) => {
            let what = error.problem.to_string();
            let instead = "its materials have no picture there";
            let mut notes = document.notes.borrow_mut();
            notes.add(&error.file, error.place, what, instead);
            return Ok(None);
        }
    };
    Ok(Some(sampled(document, texture, path)))
}

/// Pictures that were measured, by their places among the images.
pub(super) type MeasuredImages<'a> = MeasuredPictures<'a, Option<usize>>;

/// The mean of a picture's red, green, blue and alpha as numbers; `None` where it cannot be read.
///
/// # Errors
/// It needs more memory than is left.
pub(super) fn mean(
    document: &Document,
    measured: &mut MeasuredImages,
    texture: usize,
) -> Result<Option<[f32; 4]>, FileError> {
    let json = document.json().element("textures", texture);
    let measured = measured.measure(json.and_then(image_of), |limits| {
        decode_texture(document, texture, PictureUse::Data, limits)
    })?;
    Ok(measured.map(|picture| picture.mean.map(|channel| channel as f32)))
}
