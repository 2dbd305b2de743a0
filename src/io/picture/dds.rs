//! DDS pictures whose pixels are not compressed, which the decoder of the blocks does not read (Microsoft, "DDS_HEADER",
//! "DDS_PIXELFORMAT", "DDS_HEADER_DXT10").

use super::super::error::{FileError, Problem};
use super::claim_picture;
use super::read::Decoded;
use crate::io::Limits;
use image::{DynamicImage, ImageBuffer, Rgba};
use std::io::{self, Read};
use std::path::Path;

/// The head with its mark, and what follows it where it is of the newer kind.
const HEAD: usize = 128;
const NEWER_HEAD: usize = 20;
/// What stands for pixels that are not there.
const GREY: [u8; 4] = [0x80, 0x80, 0x80, u8::MAX];
/// Flags of the pixel format: which masks count.
const HAS_ALPHA: u32 = 0x1;
const HAS_CODE: u32 = 0x4;
const HAS_COLORS: u32 = 0x40;
const HAS_LUMINANCE: u32 = 0x2_0000;

/// Where the channels of a pixel are.
struct Layout {
    /// Bytes of a pixel, 1 to 4.
    bytes: usize,
    /// Bits of red, green, blue and alpha; none is 0, or 1 of alpha.
    masks: [u32; 4],
}

/// The largest level of a picture whose pixels are not compressed; `None` where they are, or of a kind that is not known.
pub(super) fn decode_uncompressed(
    name: &Path,
    reader: &mut impl Read,
    limits: &Limits,
) -> Result<Option<Decoded>, FileError> {
    let mut head = [0; HEAD];
    reader
        .read_exact(&mut head)
        .map_err(|error| failure(name, &error))?;
    let word = |at: usize| {
        let bytes = head[at..].first_chunk();
        bytes.map_or(0, |&bytes| u32::from_le_bytes(bytes))
    };
    let (height, width) = (word(12), word(16));
    let Some(layout) = layout(&word, reader).map_err(|error| failure(name, &error))? else {
        return Ok(None);
    };
    claim_picture(name, (width, height), 1, limits)?;
    let mut row = vec![0; width as usize * layout.bytes];
    let mut pixels = Vec::with_capacity(width as usize * height as usize * GREY.len());
    let mut doubt = None;
    for y in 0..height {
        match reader.read_exact(&mut row) {
            Err(error) if y > 0 && error.kind() == io::ErrorKind::UnexpectedEof => {
                doubt = Some(Problem::CutShort);
                break;
            }
            read => read.map_err(|error| failure(name, &error))?,
        }
        for pixel in row.chunks_exact(layout.bytes) {
            let mut bytes = [0; 4];
            bytes[..layout.bytes].copy_from_slice(pixel);
            let value = u32::from_le_bytes(bytes);
            let [red, green, blue, alpha] = layout.masks;
            pixels.extend([red, green, blue].map(|mask| channel(value, mask, 0)));
            pixels.push(channel(value, alpha, u8::MAX));
        }
    }
    let all = width as usize * height as usize;
    let missing = all - pixels.len() / GREY.len();
    pixels.extend(std::iter::repeat_n(GREY, missing).flatten());
    let picture: Option<ImageBuffer<Rgba<u8>, _>> = ImageBuffer::from_raw(width, height, pixels);
    Ok(picture.map(|picture| Decoded {
        doubt,
        ..Decoded::from(DynamicImage::ImageRgba8(picture))
    }))
}

fn layout(word: &impl Fn(usize) -> u32, reader: &mut impl Read) -> io::Result<Option<Layout>> {
    let (flags, code, bits) = (word(80), word(84), word(88));
    if flags & HAS_CODE != 0 {
        if code != u32::from_le_bytes(*b"DX10") {
            return Ok(None);
        }
        let mut newer = [0; NEWER_HEAD];
        reader.read_exact(&mut newer)?;
        let [a, b, c, d, ..] = newer;
        // DXGI_FORMAT: R8G8B8A8, B8G8R8A8 and B8G8R8X8, as numbers and as screens take them.
        let masks = match u32::from_le_bytes([a, b, c, d]) {
            28 | 29 => [0xff, 0xff00, 0xff_0000, 0xff00_0000],
            87 | 91 => [0xff_0000, 0xff00, 0xff, 0xff00_0000],
            88 | 93 => [0xff_0000, 0xff00, 0xff, 0],
            _ => return Ok(None),
        };
        return Ok(Some(Layout { bytes: 4, masks }));
    }
    if !matches!(bits, 8 | 16 | 24 | 32) {
        return Ok(None);
    }
    let all = u32::MAX >> (32 - bits);
    let [red, green, blue, alpha] = [92, 96, 100, 104].map(|at| word(at) & all);
    let alpha = if flags & HAS_ALPHA != 0 { alpha } else { 0 };
    let masks = match flags {
        _ if flags & HAS_COLORS != 0 => [red, green, blue, alpha],
        // Some programs write masks for more bits than there are.
        _ if flags & HAS_LUMINANCE != 0 && red == 0 => [all, all, all, 0],
        _ if flags & HAS_LUMINANCE != 0 => [red, red, red, alpha],
        _ => return Ok(None),
    };
    Ok(Some(Layout {
        bytes: bits as usize / 8,
        masks,
    }))
}

/// The bits of a mask as a number up to 255.
fn channel(value: u32, mask: u32, otherwise: u8) -> u8 {
    if mask == 0 {
        return otherwise;
    }
    let shift = mask.trailing_zeros();
    let (value, most) = (u64::from((value & mask) >> shift), u64::from(mask >> shift));
    // Masks with holes are none that any program writes; they give some colour.
    ((value * 255 + most / 2) / most).min(255) as u8
}

fn failure(name: &Path, error: &io::Error) -> FileError {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => {
            let text = "the picture is incomplete".to_owned();
            FileError::new(name, Problem::Truncated(text))
        }
        _ => FileError::reading(name, error),
    }
}
