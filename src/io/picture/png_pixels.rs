//! The pixels of a PNG, and nothing else that stands in one: a few megabytes of a colour profile or of text unpack to
//! gigabytes.

use super::super::budget::picture_bytes;
use super::super::error::FileError;
use super::as_far::AsFar;
use super::read::{Decoded, failure};
use super::{claim_picture, decoder_bytes};
use crate::io::Limits;
use image::error::{DecodingError, ImageResult, LimitError, LimitErrorKind};
use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat};
use png::{BitDepth, DecodingError as PngError, Reader, Transformations};
use std::io::{BufRead, Seek};
use std::path::Path;

/// Decodes a PNG, as far as it can be decoded.
pub(super) fn decode(
    name: &Path,
    reader: impl BufRead + Seek,
    limits: &Limits,
) -> Result<Decoded, FileError> {
    let fails = |error| failure(name, problem(error));
    let mut decoder = png::Decoder::new(reader);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_ignore_text_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    let head = decoder.read_header_info().map_err(fails)?;
    let (width, height) = head.size();
    let channel = if head.bit_depth == BitDepth::Sixteen {
        2
    } else {
        1
    };
    claim_picture(name, (width, height), channel, limits)?;
    // What else it keeps, it keeps twice.
    let left =
        picture_bytes(width, height, channel.into()).saturating_add(limits.memory.left() / 2);
    decoder.set_limits(png::Limits {
        bytes: usize::try_from(left.max(LEAST).min(decoder_bytes(limits))).unwrap_or(usize::MAX),
    });
    let reader = decoder.read_info().map_err(fails)?;
    let mut doubt = None;
    let picture = DynamicImage::from_decoder(AsFar {
        decoder: Pixels { reader },
        doubt: &mut doubt,
    });
    Ok(Decoded {
        doubt,
        ..Decoded::from(picture.map_err(|error| failure(name, error))?)
    })
}

/// Bytes that decoding the smallest picture takes: its library reserves some for every chunk.
const LEAST: u64 = 1 << 16;

struct Pixels<R: BufRead + Seek> {
    reader: Reader<R>,
}

impl<R: BufRead + Seek> ImageDecoder for Pixels<R> {
    fn dimensions(&self) -> (u32, u32) {
        self.reader.info().size()
    }

    /// Expanded, so that a palette is colours and no channel has fewer bits than 8.
    fn color_type(&self) -> ColorType {
        use png::ColorType as C;
        match self.reader.output_color_type() {
            (C::Grayscale, BitDepth::Sixteen) => ColorType::L16,
            (C::GrayscaleAlpha, BitDepth::Sixteen) => ColorType::La16,
            (C::Rgb, BitDepth::Sixteen) => ColorType::Rgb16,
            (C::Rgba, BitDepth::Sixteen) => ColorType::Rgba16,
            (C::Grayscale, _) => ColorType::L8,
            (C::GrayscaleAlpha, _) => ColorType::La8,
            (C::Rgb | C::Indexed, _) => ColorType::Rgb8,
            (C::Rgba, _) => ColorType::Rgba8,
        }
    }

    fn read_image(mut self, bytes: &mut [u8]) -> ImageResult<()> {
        let color = self.color_type();
        let read = self.reader.next_frame(bytes);
        // Numbers of 16 bits are big-endian in the file, those of rows that came before an error too.
        if color.bytes_per_pixel() == 2 * color.channel_count() {
            for value in bytes.as_chunks_mut::<2>().0 {
                *value = u16::from_be_bytes(*value).to_ne_bytes();
            }
        }
        read.map(|_| ()).map_err(problem)
    }

    fn read_image_boxed(self: Box<Self>, bytes: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(bytes)
    }
}

fn problem(error: PngError) -> ImageError {
    match error {
        PngError::IoError(error) => ImageError::IoError(error),
        PngError::LimitsExceeded => {
            ImageError::Limits(LimitError::from_kind(LimitErrorKind::InsufficientMemory))
        }
        other => ImageError::Decoding(DecodingError::new(ImageFormat::Png.into(), other)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::read::{PictureUse, decode_picture};
    use super::*;
    use crate::io::Budget;
    use image::{ImageBuffer, Rgb};
    use std::io::Cursor;

    /// A small picture with another chunk behind its head.
    fn with_chunk(kind: [u8; 4], data: &[u8]) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let picture = ImageBuffer::from_pixel(4, 4, Rgb([10, 20, 30_u8]));
        picture.write_to(&mut file, ImageFormat::Png).unwrap();
        let file = file.into_inner();
        // The signature, and the head with its length, kind and checksum.
        let (head, rest) = file.split_at(8 + 12 + 13);
        let length = (data.len() as u32).to_be_bytes();
        let checked = [&kind[..], data].concat();
        let sum = crc(&checked).to_be_bytes();
        [head, &length, &checked, &sum, rest].concat()
    }

    /// Of ISO 3309, bit by bit.
    fn crc(bytes: &[u8]) -> u32 {
        let step = |crc: u32, _| match crc & 1 {
            1 => crc >> 1 ^ 0xedb8_8320,
            _ => crc >> 1,
        };
        !(bytes.iter()).fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
    }

    #[test]
    fn what_stands_beside_the_pixels_is_not_unpacked() {
        // Blocks of zlib that are stored, so that the test needs no packer: a megabyte of a profile, and of text.
        let mut packed = vec![0x78, 0x01];
        let block = [0_u8; 0xffff];
        for i in 0..16 {
            packed.push(u8::from(i == 15));
            packed.extend([0xff, 0xff, 0, 0]);
            packed.extend(block);
        }
        // Adler-32 of zeros: 1, and how many there are.
        let count = 16 * 0xffff_u32 % 65521;
        packed.extend((count << 16 | 1).to_be_bytes());
        // A decoder that unpacks it is not allowed as much.
        let small = Limits {
            memory: Budget::of(1000),
            pixels: 4096,
            ..Limits::default()
        };
        for (kind, head) in [
            (*b"iCCP", &b"profile\0\0"[..]),
            (*b"zTXt", b"Comment\0\0"),
            (*b"iTXt", b"Comment\0\x01\0\0\0"),
        ] {
            let file = with_chunk(kind, &[head, &packed].concat());
            let read = decode_picture(Path::new("a.png"), &file, PictureUse::Data, &small);
            let kind = String::from_utf8_lossy(&kind).into_owned();
            let read = read.unwrap_or_else(|error| panic!("{kind}: {error}"));
            assert_eq!(read.image.data.unwrap()[..4], [10, 20, 30, 255], "{kind}");
        }
    }

    #[test]
    fn what_is_kept_beside_the_pixels_counts_as_memory() {
        let file = with_chunk(*b"eXIf", &[b'I'; 1 << 20]);
        let read = |bytes| {
            let limits = Limits {
                memory: Budget::of(bytes),
                ..Limits::default()
            };
            decode_picture(Path::new("a.png"), &file, PictureUse::Data, &limits).map(|_| ())
        };
        read(8 << 20).unwrap();
        let text = read(1 << 20).unwrap_err().to_string();
        assert!(text.contains("memory") && text.contains("a.png"), "{text}");
    }
}
