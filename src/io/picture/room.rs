//! Whether a picture that is yet to be traced will have room on its disk.

use super::super::budget::Size;
use super::super::error::{FileError, Problem};
use super::super::replace::free_bytes;
use super::PictureFormat;
use std::path::Path;

/// How far pictures are compressed at most, as a divisor of their bytes: pictures of the built-in scenes, 200 pixels wide
/// and with 4 samples each, take from a seventeenth (a triangle before a sky, as JPEG) to all of them (OpenEXR).
const COMPRESSION: u64 = 16;

impl PictureFormat {
    /// Bytes that a pixel takes, uncompressed.
    fn pixel_bytes(self) -> u64 {
        match self {
            Self::Png | Self::Jpeg => 3,
            Self::Hdr => 4,
            Self::Exr => 12,
        }
    }

    /// Bytes of a picture of that many pixels, uncompressed.
    pub fn picture_bytes(self, width: u64, height: u64) -> u64 {
        let pixels = width.saturating_mul(height);
        pixels.saturating_mul(self.pixel_bytes())
    }
}

/// Refuses a picture of so many bytes, uncompressed, where the disk has less left than a sixteenth of them; where it has
/// less than all of them, says so: whether the picture will fit is known when it has been traced. `None` where it
/// fits in any case, and where the system does not tell what is free.
pub fn check_room(file: &Path, bytes: u64) -> Result<Option<FileError>, FileError> {
    match free_bytes(file) {
        Some(free) => room_within(file, bytes, free),
        None => Ok(None),
    }
}

/// The same where so many bytes are free.
fn room_within(file: &Path, bytes: u64, free: u64) -> Result<Option<FileError>, FileError> {
    if free >= bytes {
        return Ok(None);
    }
    let problem = Problem::LittleSpace {
        most: Size(bytes),
        free: Size(free),
    };
    let doubt = FileError::new(file, problem);
    if free < bytes / COMPRESSION {
        Err(doubt)
    } else {
        Ok(Some(doubt))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_with_less_than_a_sixteenth_is_refused_and_one_with_less_than_all_is_told() {
        let file = Path::new("a.png");
        let bytes = PictureFormat::Png.picture_bytes(800, 600);
        assert_eq!(bytes, 1_440_000);
        for (free, expected) in [
            (0, Some(false)),
            (89_999, Some(false)),
            (90_000, Some(true)),
            (1_439_999, Some(true)),
            (1_440_000, None),
        ] {
            let room = room_within(file, bytes, free);
            let is_allowed = room.is_ok();
            let told = room.unwrap_or_else(Some).map(|doubt| {
                let text = doubt.to_string();
                let says = text.contains("a.png") && text.contains("up to 1 MB");
                assert!(says && text.contains("are free on its disk"), "{text}");
                is_allowed
            });
            assert_eq!(told, expected, "with {free} bytes free");
        }
        assert!(room_within(file, PictureFormat::Exr.picture_bytes(u64::MAX, 2), 1 << 50).is_err());
    }
}
