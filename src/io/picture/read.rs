use super::super::error::{FileError, Problem};
use super::{PictureFormat, block_bytes, check_size};
use crate::io::budget::picture_bytes;
use crate::io::{Limits, open_regular};
use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Luma};
use std::io::{BufRead, BufReader, Cursor, Seek};
use std::path::Path;

/// What a picture's values stand for, and so how they are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum PictureUse {
    /// Colours: 8-bit files become sRGB-encoded `Rgba8UnormSrgb`, others linear `Rgba32Float`.
    Color,
    /// Numbers: 8-bit files become `Rgba8Unorm` as they are.
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
        let file = open_regular(path)?;
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
    let (header, blocks) = count_blocks(header).map_err(|error| failure(name, error.into()))?;
    let header = header
        .into_decoder()
        .map_err(|error| failure(name, error))?;
    let ((width, height), color) = (header.dimensions(), header.color_type());
    drop(header);
    check_size(name, width.into(), height.into(), limits)?;
    let channel = color.bytes_per_pixel() / color.channel_count();
    (limits.memory)
        .claim(picture_bytes(width, height, channel.into()).saturating_add(blocks))
        .map_err(|problem| FileError::new(name, problem))?;
    let mut decoder_limits = image::Limits::default();
    // Four channels of 16 bytes at most, and as much again for what a decoder needs meanwhile.
    decoder_limits.max_alloc = Some(limits.pixels.saturating_mul(32));
    body.limits(decoder_limits);
    let picture = body.decode().map_err(|error| failure(name, error))?;
    Ok(to_image(picture, usage))
}

/// The reader again, and the bytes of the blocks that an OpenEXR file decodes at a time: each thread has one, compressed
/// and not. Other formats go line by line.
fn count_blocks<R: BufRead + Seek>(
    header: ImageReader<R>,
) -> std::io::Result<(ImageReader<R>, u64)> {
    const AT_A_TIME: u64 = 8;
    if header.format() != Some(ImageFormat::OpenExr) {
        return Ok((header, 0));
    }
    let mut file = header.into_inner();
    let meta = exr::meta::MetaData::read_from_buffered(&mut file, false);
    file.rewind()?;
    let headers = meta.map(|meta| meta.headers).unwrap_or_default();
    let blocks = headers.iter().map(block_bytes).max().unwrap_or_default();
    let reader = ImageReader::with_format(file, ImageFormat::OpenExr);
    Ok((reader, blocks.saturating_mul(AT_A_TIME)))
}

fn to_image(picture: DynamicImage, usage: PictureUse) -> Image {
    let floating = matches!(
        picture,
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)
    );
    let picture = match usage {
        PictureUse::Alpha => {
            let rgba = picture.into_rgba8();
            let alpha = ImageBuffer::from_fn(rgba.width(), rgba.height(), |x, y| {
                Luma([rgba.get_pixel(x, y).0[3]])
            });
            DynamicImage::ImageLuma8(alpha)
        }
        _ if floating => picture,
        _ => DynamicImage::ImageRgba8(picture.into_rgba8()),
    };
    Image::from_dynamic(
        picture,
        usage == PictureUse::Color,
        RenderAssetUsages::default(),
    )
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
