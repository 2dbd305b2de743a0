use super::super::error::{FileError, Problem};
use super::super::open_to_read;
use super::as_far::AsFar;
use super::content::{HEAD, recognised};
use super::{
    check_size, claim_picture, dds, decoder_bytes, first_frame, jpeg, open_exr, png_pixels,
    radiance,
};
use crate::io::Limits;
use crate::scene::{PhongMap, SRGB_16_BITS};
use crate::trace::srgb::decode_table_16;
use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use exr::prelude::f16;
use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Luma, Rgba};
use std::io::{self, BufRead, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

/// What a picture's values stand for, and so how they are kept: 16-bit files stay in 16 bits, floating
/// point stays as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum PictureUse {
    /// Colours: 8-bit files become sRGB-encoded `Rgba8UnormSrgb`, others linear floats, with the label
    /// [`SRGB_16_BITS`] where they had 16 bits.
    Color,
    /// Numbers: 8-bit files become `Rgba8Unorm` as they are, 16-bit ones `Rgba16Unorm`.
    Data,
    /// Only the alpha channel, spread over red, green and blue as numbers.
    Alpha,
}

impl PictureUse {
    /// What a material's picture is read for.
    pub fn of(map: PhongMap) -> Self {
        if map.is_of_colors() {
            Self::Color
        } else {
            Self::Data
        }
    }
}

/// A picture as its file has it.
pub(super) struct Decoded {
    pub pixels: DynamicImage,
    /// Its floats are those of 16 bits.
    pub is_half: bool,
    /// Where it is not as the file means it: why.
    pub doubt: Option<Problem>,
}

impl From<DynamicImage> for Decoded {
    fn from(pixels: DynamicImage) -> Self {
        Self {
            pixels,
            is_half: false,
            doubt: None,
        }
    }
}

/// A picture.
pub(crate) struct ReadPicture {
    pub image: Image,
    /// Where it is not shown as the file means it: why.
    pub doubt: Option<FileError>,
}

/// Reads a picture file. Its size is checked in the header, before anything is decoded.
pub(crate) fn read_picture(
    path: &Path,
    usage: PictureUse,
    limits: &Limits,
) -> Result<ReadPicture, FileError> {
    let reader = open_to_read(path, limits.file_bytes)?;
    decode(path, reader, usage, limits)
}

/// Decodes a picture that lies inside another file.
pub(crate) fn decode_picture(
    name: &Path,
    bytes: &[u8],
    usage: PictureUse,
    limits: &Limits,
) -> Result<ReadPicture, FileError> {
    decode(name, Cursor::new(bytes), usage, limits)
}

/// By what the first bytes say: names are often wrong.
fn decode(
    name: &Path,
    mut reader: impl BufRead + Seek,
    usage: PictureUse,
    limits: &Limits,
) -> Result<ReadPicture, FileError> {
    let mut head = Vec::with_capacity(HEAD);
    (reader.by_ref().take(HEAD as u64).read_to_end(&mut head))
        .and_then(|_| reader.seek(SeekFrom::Start(0)))
        .map_err(|error| FileError::reading(name, &error))?;
    let fails = |problem| FileError::new(name, problem);
    let decoded = match recognised(&head).map_err(fails)? {
        ImageFormat::Hdr => radiance::decode(name, reader, limits)?,
        ImageFormat::OpenExr => open_exr::decode(name, reader, limits)?,
        ImageFormat::Dds => {
            let plain = dds::decode_uncompressed(name, &mut reader, limits)?;
            rewind(name, &mut reader)?;
            match plain {
                Some(picture) => picture,
                None => decode_as(ImageFormat::Dds, name, reader, limits)?,
            }
        }
        ImageFormat::Png => png_pixels::decode(name, reader, limits)?,
        ImageFormat::Jpeg => {
            // Its decoder holds the file, and once more what stands in it beside the pixels.
            let length = first_frame::length(&mut reader);
            let length = length.map_err(|error| FileError::reading(name, &error))?;
            (limits.memory.apart())
                .claim(length.saturating_mul(2))
                .map_err(fails)?;
            let mut decoded = decode_as(ImageFormat::Jpeg, name, &mut reader, limits)?;
            rewind(name, &mut reader)?;
            decoded.doubt = jpeg::cut_short(reader);
            decoded
        }
        ImageFormat::Gif => {
            let frame = first_frame::of_gif(&mut reader);
            check_frame(name, frame, limits)?;
            rewind(name, &mut reader)?;
            decode_as(ImageFormat::Gif, name, reader, limits)?
        }
        ImageFormat::WebP => {
            let frame = first_frame::of_webp(&mut reader);
            check_frame(name, frame, limits)?;
            rewind(name, &mut reader)?;
            decode_as(ImageFormat::WebP, name, reader, limits)?
        }
        format => decode_as(format, name, reader, limits)?,
    };
    let (doubt, pixels) = (decoded.doubt.map(fails), decoded.pixels);
    Ok(ReadPicture {
        image: to_image(pixels, decoded.is_half, usage),
        doubt,
    })
}

fn rewind(name: &Path, reader: &mut impl Seek) -> Result<(), FileError> {
    let rewound = reader.seek(SeekFrom::Start(0));
    rewound.map_err(|error| FileError::reading(name, &error))?;
    Ok(())
}

/// Refuses a picture with a frame that is beyond the limits by itself. Its decoder, which knows more of the format, says
/// what is wrong where none was found.
fn check_frame(
    name: &Path,
    frame: io::Result<Option<[u32; 2]>>,
    limits: &Limits,
) -> Result<(), FileError> {
    // Of a pixel while the frame is cut to the picture.
    const PIXEL: u64 = 4;
    let Ok(Some(size)) = frame else {
        return Ok(());
    };
    let [width, height] = size.map(u64::from);
    if width * height == 0 {
        return Ok(());
    }
    check_size(name, width, height, limits)?;
    (limits.memory.apart())
        .claim(width * height * PIXEL)
        .map_err(|problem| FileError::new(name, problem))
}

/// The first frame of a picture.
fn decode_as(
    format: ImageFormat,
    name: &Path,
    reader: impl BufRead + Seek,
    limits: &Limits,
) -> Result<Decoded, FileError> {
    let fails = |error| failure(name, error);
    let mut reader = ImageReader::with_format(reader, format);
    let mut decoder_limits = image::Limits::default();
    decoder_limits.max_alloc = Some(decoder_bytes(limits));
    reader.limits(decoder_limits);
    let decoder = reader.into_decoder().map_err(fails)?;
    let (width, height) = decoder.dimensions();
    let channel = decoder.color_type().bytes_per_pixel() / decoder.color_type().channel_count();
    claim_picture(name, (width, height), channel, limits)?;
    let mut doubt = None;
    let picture = match format {
        ImageFormat::Bmp => DynamicImage::from_decoder(AsFar {
            decoder,
            doubt: &mut doubt,
        }),
        _ => DynamicImage::from_decoder(decoder),
    };
    Ok(Decoded {
        doubt,
        ..Decoded::from(picture.map_err(fails)?)
    })
}

/// The picture as Bevy keeps it, with as many bits as the file has.
fn to_image(pixels: DynamicImage, is_half: bool, usage: PictureUse) -> Image {
    use DynamicImage as D;
    let is_float = matches!(pixels, D::ImageRgb32F(_) | D::ImageRgba32F(_));
    let is_16_bits = matches!(
        pixels,
        D::ImageLuma16(_) | D::ImageLumaA16(_) | D::ImageRgb16(_) | D::ImageRgba16(_)
    );
    // Of numbers the tracer alone makes use, and not every graphics card takes them in 16 bits.
    let world = match usage {
        PictureUse::Color => RenderAssetUsages::default(),
        PictureUse::Data | PictureUse::Alpha => RenderAssetUsages::MAIN_WORLD,
    };
    let (width, height) = (pixels.width(), pixels.height());
    match usage {
        PictureUse::Color if is_16_bits => srgb_16(&pixels.into_rgba16()),
        PictureUse::Data if is_16_bits => {
            Image::from_dynamic(D::ImageRgba16(pixels.into_rgba16()), false, world)
        }
        PictureUse::Color | PictureUse::Data if is_half => {
            let values = pixels.into_rgba32f().into_raw();
            let halves = values.iter().flat_map(|&v| f16::from_f32(v).to_ne_bytes());
            new(
                width,
                height,
                halves.collect(),
                TextureFormat::Rgba16Float,
                world,
            )
        }
        PictureUse::Color | PictureUse::Data if is_float => {
            Image::from_dynamic(pixels, false, world)
        }
        PictureUse::Color | PictureUse::Data => {
            let pixels = D::ImageRgba8(pixels.into_rgba8());
            Image::from_dynamic(pixels, usage == PictureUse::Color, world)
        }
        PictureUse::Alpha if is_float => {
            let alphas = pixels.into_rgba32f();
            let alphas = alphas.pixels().flat_map(|pixel| pixel.0[3].to_ne_bytes());
            new(
                width,
                height,
                alphas.collect(),
                TextureFormat::R32Float,
                world,
            )
        }
        PictureUse::Alpha if is_16_bits => {
            let alphas = pixels.into_rgba16();
            let alphas = alphas.pixels().flat_map(|pixel| pixel.0[3].to_ne_bytes());
            new(
                width,
                height,
                alphas.collect(),
                TextureFormat::R16Unorm,
                world,
            )
        }
        PictureUse::Alpha => {
            let rgba = pixels.into_rgba8();
            let alpha =
                ImageBuffer::from_fn(width, height, |x, y| Luma([rgba.get_pixel(x, y).0[3]]));
            Image::from_dynamic(D::ImageLuma8(alpha), false, world)
        }
    }
}

/// Linear floats with the label that tells that they were encoded.
fn srgb_16(pixels: &ImageBuffer<Rgba<u16>, Vec<u16>>) -> Image {
    let table = decode_table_16();
    let values = pixels.pixels().flat_map(|pixel| {
        let [r, g, b, a] = pixel.0;
        let [r, g, b] = [r, g, b].map(|c| table[usize::from(c)]);
        [r, g, b, f32::from(a) / f32::from(u16::MAX)]
    });
    let mut image = new(
        pixels.width(),
        pixels.height(),
        values.flat_map(f32::to_ne_bytes).collect(),
        TextureFormat::Rgba32Float,
        RenderAssetUsages::default(),
    );
    image.texture_descriptor.label = Some(SRGB_16_BITS);
    image
}

fn new(
    width: u32,
    height: u32,
    values: Vec<u8>,
    format: TextureFormat,
    world: RenderAssetUsages,
) -> Image {
    let size = Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    Image::new(size, TextureDimension::D2, values, format, world)
}

pub(super) fn failure(name: &Path, error: image::ImageError) -> FileError {
    use image::ImageError as E;
    let problem = match error {
        E::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            Problem::Truncated("the picture is incomplete".into())
        }
        E::IoError(error) => Problem::Unreadable(one_line(&error.to_string())),
        E::Limits(_) => Problem::Malformed(
            "needs more memory than is left for it; scale the picture down, or save it without what describes it".into(),
        ),
        other => Problem::Malformed(format!(
            "is not a picture that can be decoded: {}",
            one_line(&other.to_string())
        )),
    };
    FileError::new(name, problem)
}

pub(super) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
