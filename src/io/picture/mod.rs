//! Picture files: PNG and JPEG hold a screen's values in 8 bits, OpenEXR and Radiance HDR hold
//! linear light in floating point. The extension decides.

mod exr_blocks;
mod jpeg;
mod read;
mod rendered;
mod write;

pub(crate) use exr_blocks::block_bytes;
pub(crate) use jpeg::cut_short;
pub(crate) use read::{PictureUse, decode_picture, read_picture};
pub use rendered::{Note, picture_notes, write_rendered};
pub(crate) use write::encode_png;
pub use write::{write_picture, write_picture_with_notes};

use super::Limits;
use super::error::{FileError, Problem};
use std::path::Path;

/// The picture files that are read and written.
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

    fn image_format(self) -> image::ImageFormat {
        match self {
            Self::Png => image::ImageFormat::Png,
            Self::Jpeg => image::ImageFormat::Jpeg,
            Self::Exr => image::ImageFormat::OpenExr,
            Self::Hdr => image::ImageFormat::Hdr,
        }
    }
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
