//! Picture files. What is written the extension decides: PNG and JPEG hold a screen's values in 8 bits,
//! OpenEXR and Radiance HDR linear light in floating point. What is read its content tells, and there
//! are more kinds of it: WebP, TGA, BMP, DDS, and the first frame of a GIF.

mod as_far;
mod content;
mod dds;
mod exr_blocks;
mod exr_head;
mod exr_subsampled;
mod first_frame;
mod jpeg;
mod light_layers;
mod measured;
mod open_exr;
mod png_pixels;
mod radiance;
mod read;
mod rendered;
mod room;
mod write;

pub(crate) use exr_blocks::block_bytes;
pub(crate) use exr_head::{exr_head, exr_problem, from_exr, to_exr};
pub use light_layers::{LightLayers, layer_name};
pub(crate) use measured::{Measured, MeasuredPictures};
pub(crate) use read::{PictureUse, ReadPicture, decode_picture, read_picture};
pub use rendered::{Note, picture_notes, write_lights, write_rendered};
pub use room::check_room;
pub(crate) use write::{encode_png, stage_picture};
pub use write::{write_picture, write_picture_with_notes};

use super::budget::picture_bytes;
use super::error::{FileError, Problem};
use super::{Limits, check_writable};
use std::path::Path;

/// The picture files that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// 8 bits a channel, lossless.
    Png,
    /// 8 bits a channel, lossy.
    Jpeg,
    /// OpenEXR, 32-bit floating point, linear.
    Exr,
    /// Radiance, 8 bits a channel and a shared exponent, linear.
    Hdr,
}

impl PictureFormat {
    /// The format that a file's extension names.
    pub fn of(path: &Path) -> Result<Self, FileError> {
        let extension = super::extension(path);
        match extension.as_str() {
            "png" => Ok(Self::Png),
            "jpg" | "jpeg" => Ok(Self::Jpeg),
            "exr" => Ok(Self::Exr),
            "hdr" => Ok(Self::Hdr),
            _ => Err(FileError::new(
                path,
                Problem::UnknownExtension {
                    extension,
                    wanted: "pictures; .png, .jpg, .exr and .hdr are",
                },
            )),
        }
    }

    /// Whether it holds linear light, before exposure and view transform.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Exr | Self::Hdr)
    }

    /// The most pixels on either side that a file of this format says.
    pub fn largest_side(self) -> u64 {
        match self {
            // Its head has 16 bits for each.
            Self::Jpeg => u64::from(u16::MAX),
            Self::Png | Self::Exr | Self::Hdr => Limits::PICTURE_SIDE,
        }
    }

    fn image_format(self) -> image::ImageFormat {
        match self {
            Self::Png => image::ImageFormat::Png,
            Self::Jpeg => image::ImageFormat::Jpeg,
            Self::Exr => image::ImageFormat::OpenExr,
            Self::Hdr => image::ImageFormat::Hdr,
        }
    }
}

/// Refuses a picture that could not be written, before the work whose result it shall hold is done: by its
/// format, its size, the place where it shall lie, and a disk that is as good as full ([`check_room`]).
pub fn check_picture(file: &Path, width: u64, height: u64) -> Result<PictureFormat, FileError> {
    let format = PictureFormat::of(file)?;
    check_format_size(file, format, width, height)?;
    check_writable(file)?;
    check_room(file, format.picture_bytes(width, height))?;
    Ok(format)
}

/// Refuses what the format cannot hold, or the limits forbid.
fn check_format_size(
    file: &Path,
    format: PictureFormat,
    width: u64,
    height: u64,
) -> Result<(), FileError> {
    check_size(file, width, height, &Limits::default())?;
    let limit = format.largest_side();
    if width.max(height) > limit {
        let problem = Problem::PictureTooLong {
            width,
            height,
            limit,
        };
        return Err(FileError::new(file, problem));
    }
    Ok(())
}

/// How the names of picture files that are read end, in lower case: for file dialogs. What counts is what is
/// in them.
pub const PICTURE_EXTENSIONS: [&str; 11] = [
    "png", "jpg", "jpeg", "webp", "tga", "bmp", "gif", "dds", "hdr", "pic", "exr",
];

/// What a decoder may ask for at once: four channels of 16 bytes for the largest picture, and as much again
/// for what it needs meanwhile.
fn decoder_bytes(limits: &Limits) -> u64 {
    limits.pixels.saturating_mul(32)
}

/// Refuses a picture that is empty or beyond the limits, and speaks for the memory of one with so many bytes a channel
/// that is not.
fn claim_picture(
    file: &Path,
    (width, height): (u32, u32),
    channel_bytes: u8,
    limits: &Limits,
) -> Result<(), FileError> {
    check_size(file, width.into(), height.into(), limits)?;
    let bytes = picture_bytes(width, height, channel_bytes.into());
    let claimed = limits.memory.claim(bytes);
    claimed.map_err(|problem| FileError::new(file, problem))
}

/// Refuses a picture that is empty or beyond the limits, before memory is asked for.
pub fn check_size(file: &Path, width: u64, height: u64, limits: &Limits) -> Result<(), FileError> {
    if width == 0 || height == 0 {
        return Err(FileError::new(
            file,
            Problem::PictureEmpty {
                width: u32::try_from(width).unwrap_or(u32::MAX),
                height: u32::try_from(height).unwrap_or(u32::MAX),
            },
        ));
    }
    let too_long = width.max(height) > Limits::PICTURE_SIDE;
    if too_long || width * height > limits.pixels {
        return Err(FileError::new(
            file,
            Problem::PictureTooLarge {
                width,
                height,
                limit: limits.pixels,
            },
        ));
    }
    Ok(())
}
