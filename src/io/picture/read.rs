use super::super::error::{FileError, Problem};
use super::{PictureFormat, check_size};
use crate::io::Limits;
use crate::scene::SRGB_16_BITS;
use crate::trace::srgb::decode_table_16;
use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use image::{DynamicImage, ImageBuffer, ImageReader, Luma, Rgba};
use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::Path;
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

/// What a picture's values stand for, and so how they are kept: 16-bit files stay in 16 bits, floating
/// point stays as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum PictureUse {
    /// Colours: 8-bit files become sRGB-encoded `Rgba8UnormSrgb`, others linear `Rgba32Float`, with the
    /// label [`SRGB_16_BITS`] where they had 16 bits.
    Color,
    /// Numbers: 8-bit files become `Rgba8Unorm` as they are, 16-bit ones `Rgba16Unorm`.
    Data,
    /// Only the alpha channel, spread over red, green and blue as numbers.
    Alpha,
}

/// Reads a picture file. Its size is checked in the header, before anything is decoded.
pub(crate) fn read_picture(
    path: &Path,
    usage: PictureUse,
    limits: &Limits,
) -> Result<Image, FileError> {
    let format = PictureFormat::of(path)?;
    let open = || {
        let file = File::open(path).map_err(|error| FileError::reading(path, &error))?;
        let metadata = file.metadata();
        if metadata.is_ok_and(|metadata| metadata.is_dir()) {
            return Err(FileError::new(path, Problem::IsAFolder));
        }
        Ok(ImageReader::with_format(
            BufReader::new(file),
            format.image_format(),
        ))
    };
    decode(path, open()?, open()?, usage, limits)
}

/// Decodes a picture that lies inside another file. PNG or JPEG, by its first bytes.
pub(crate) fn decode_picture(
    name: &Path,
    bytes: &[u8],
    usage: PictureUse,
    limits: &Limits,
) -> Result<Image, FileError> {
    let format = image::guess_format(bytes).map_err(|error| failure(name, error))?;
    let open = || ImageReader::with_format(Cursor::new(bytes), format);
    decode(name, open(), open(), usage, limits)
}

fn decode<R: BufRead + Seek>(
    name: &Path,
    header: ImageReader<R>,
    mut body: ImageReader<R>,
    usage: PictureUse,
    limits: &Limits,
) -> Result<Image, FileError> {
    let (width, height) = header
        .into_dimensions()
        .map_err(|error| failure(name, error))?;
    check_size(name, width.into(), height.into(), limits)?;
    let mut decoder_limits = image::Limits::default();
    // Four channels of 16 bytes at most, and as much again for what a decoder needs meanwhile.
    decoder_limits.max_alloc = Some(limits.pixels.saturating_mul(32));
    body.limits(decoder_limits);
    let picture = body.decode().map_err(|error| failure(name, error))?;
    Ok(to_image(picture, usage))
}

/// The picture as Bevy keeps it, with as many bits as the file has.
fn to_image(picture: DynamicImage, usage: PictureUse) -> Image {
    use DynamicImage as D;
    let is_float = matches!(picture, D::ImageRgb32F(_) | D::ImageRgba32F(_));
    let is_16_bits = matches!(
        picture,
        D::ImageLuma16(_) | D::ImageLumaA16(_) | D::ImageRgb16(_) | D::ImageRgba16(_)
    );
    // Of numbers the tracer alone makes use, and not every graphics card takes them in 16 bits.
    let world = match usage {
        PictureUse::Color => RenderAssetUsages::default(),
        PictureUse::Data | PictureUse::Alpha => RenderAssetUsages::MAIN_WORLD,
    };
    let (width, height) = (picture.width(), picture.height());
    match usage {
        PictureUse::Color if is_16_bits => srgb_16(&picture.into_rgba16()),
        PictureUse::Data if is_16_bits => {
            Image::from_dynamic(D::ImageRgba16(picture.into_rgba16()), false, world)
        }
        PictureUse::Color | PictureUse::Data if is_float => {
            Image::from_dynamic(picture, false, world)
        }
        PictureUse::Color | PictureUse::Data => {
            let picture = D::ImageRgba8(picture.into_rgba8());
            Image::from_dynamic(picture, usage == PictureUse::Color, world)
        }
        PictureUse::Alpha if is_float => {
            let alphas = picture.into_rgba32f();
            let alphas = alphas.pixels().flat_map(|pixel| pixel.0[3].to_ne_bytes());
            grey(width, height, alphas.collect(), TextureFormat::R32Float)
        }
        PictureUse::Alpha if is_16_bits => {
            let alphas = picture.into_rgba16();
            let alphas = alphas.pixels().flat_map(|pixel| pixel.0[3].to_ne_bytes());
            grey(width, height, alphas.collect(), TextureFormat::R16Unorm)
        }
        PictureUse::Alpha => {
            let rgba = picture.into_rgba8();
            let alpha =
                ImageBuffer::from_fn(width, height, |x, y| Luma([rgba.get_pixel(x, y).0[3]]));
            Image::from_dynamic(D::ImageLuma8(alpha), false, world)
        }
    }
}

/// Linear floats with the label that tells that they were encoded.
fn srgb_16(picture: &ImageBuffer<Rgba<u16>, Vec<u16>>) -> Image {
    let table = decode_table_16();
    let values = picture.pixels().flat_map(|pixel| {
        let [r, g, b, a] = pixel.0;
        let [r, g, b] = [r, g, b].map(|c| table[usize::from(c)]);
        [r, g, b, f32::from(a) / f32::from(u16::MAX)]
    });
    let mut image = Image::new(
        extent(picture.width(), picture.height()),
        TextureDimension::D2,
        values.flat_map(f32::to_ne_bytes).collect(),
        TextureFormat::Rgba32Float,
        RenderAssetUsages::default(),
    );
    image.texture_descriptor.label = Some(SRGB_16_BITS);
    image
}

fn grey(width: u32, height: u32, values: Vec<u8>, format: TextureFormat) -> Image {
    let size = extent(width, height);
    let world = RenderAssetUsages::MAIN_WORLD;
    Image::new(size, TextureDimension::D2, values, format, world)
}

fn extent(width: u32, height: u32) -> Extent3d {
    Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    }
}

fn failure(name: &Path, error: image::ImageError) -> FileError {
    use image::ImageError as E;
    let problem = match error {
        E::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            Problem::Truncated("the picture is incomplete".into())
        }
        E::IoError(error) => Problem::Unreadable(one_line(&error.to_string())),
        E::Limits(_) => Problem::Malformed(
            "asks for more memory than the largest picture allowed; scale the picture down".into(),
        ),
        other => Problem::Malformed(format!(
            "is not a picture that can be decoded: {}",
            one_line(&other.to_string())
        )),
    };
    FileError::new(name, problem)
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
