//! How large the frames of a GIF or WebP are, which may be larger than the picture that they are cut to: their decoders
//! make room for them by what they say of themselves.

use std::io::{self, BufRead, Read, Seek, SeekFrom};

/// Width and height of the first frame of a GIF (GIF89a, 18 to 24); `None` where the file has none.
pub(super) fn of_gif(mut bytes: impl BufRead) -> io::Result<Option<[u32; 2]>> {
    let mut head = [0; 13];
    bytes.read_exact(&mut head)?;
    let flags = head[10];
    if flags & 0x80 != 0 {
        skip(&mut bytes, 3 << ((flags & 7) + 1))?;
    }
    loop {
        match byte(&mut bytes)? {
            0x2c => {
                let mut place = [0; 8];
                bytes.read_exact(&mut place)?;
                let [_, _, _, _, w0, w1, h0, h1] = place;
                return Ok(Some(
                    [[w0, w1], [h0, h1]].map(|pair| u16::from_le_bytes(pair).into()),
                ));
            }
            0x21 => {
                byte(&mut bytes)?;
                loop {
                    match byte(&mut bytes)? {
                        0 => break,
                        length => skip(&mut bytes, length.into())?,
                    }
                }
            }
            // Between blocks, as some programs write.
            0 => {}
            _ => return Ok(None),
        }
    }
}

/// Width and height of the largest lossy frame of a WebP (RFC 9649, 2; RFC 6386, 9.1) that may be the first; `None` where
/// it has none. Lossless ones are compared with the picture before there is room for them.
pub(super) fn of_webp(mut bytes: impl BufRead + Seek) -> io::Result<Option<[u32; 2]>> {
    let mut largest = None;
    let area = |[width, height]: [u32; 2]| u64::from(width) * u64::from(height);
    let moving = walk(&mut bytes, 12, |size| {
        largest = largest.max(Some((area(size), size)))
    })?;
    if let Some(start) = moving {
        walk(&mut bytes, start, |size| {
            largest = largest.max(Some((area(size), size)))
        })?;
    }
    Ok(largest.map(|(_, size)| size))
}

/// Goes from chunk to chunk until the end of the file, and tells the sizes of lossy frames. Returns where the chunks of the
/// first frame of an animation begin.
fn walk(
    bytes: &mut (impl BufRead + Seek),
    start: u64,
    mut frame: impl FnMut([u32; 2]),
) -> io::Result<Option<u64>> {
    let mut moving = None;
    let mut at = start;
    bytes.seek(SeekFrom::Start(start))?;
    // Kind and length, and what a frame begins with.
    let mut head = [0; 18];
    while is_there(bytes.read_exact(&mut head[..8]))? {
        let [k0, k1, k2, k3, a, b, c, d, ..] = head;
        let length = i64::from(u32::from_le_bytes([a, b, c, d]));
        let mut left = length + (length & 1);
        match &[k0, k1, k2, k3] {
            b"VP8 " if is_there(bytes.read_exact(&mut head[8..]))? => {
                let side =
                    |at: usize| u32::from(u16::from_le_bytes([head[at], head[at + 1]]) & 0x3fff);
                frame([side(14), side(16)]);
                left -= 10;
            }
            // What is said of the frame is 16 bytes.
            b"ANMF" => moving = moving.or(Some(at + 8 + 16)),
            _ => {}
        }
        bytes.seek_relative(left)?;
        at += 8 + (length + (length & 1)) as u64;
    }
    Ok(moving)
}

/// Whether bytes were read, and not the end of the file met.
fn is_there(read: io::Result<()>) -> io::Result<bool> {
    match read {
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        read => read.map(|()| true),
    }
}

fn byte(bytes: &mut impl Read) -> io::Result<u8> {
    let mut byte = [0];
    bytes.read_exact(&mut byte)?;
    Ok(byte[0])
}

fn skip(bytes: &mut impl BufRead, count: u64) -> io::Result<()> {
    io::copy(&mut bytes.take(count), &mut io::sink()).map(|_| ())
}

/// Bytes of a file.
pub(super) fn length(bytes: &mut impl Seek) -> io::Result<u64> {
    let length = bytes.seek(SeekFrom::End(0))?;
    bytes.seek(SeekFrom::Start(0))?;
    Ok(length)
}

#[cfg(test)]
mod tests {
    use super::super::read::{PictureUse, decode_picture};
    use super::*;
    use crate::io::{Budget, Limits};
    use image::codecs::gif::GifEncoder;
    use image::codecs::jpeg::JpegEncoder;
    use image::codecs::webp::WebPEncoder;
    use image::{Frame, Rgba, RgbaImage};
    use std::io::Cursor;
    use std::path::Path;

    fn read(bytes: &[u8], memory: u64) -> Result<(), String> {
        let limits = Limits {
            memory: Budget::of(memory),
            ..Limits::default()
        };
        let read = decode_picture(Path::new("a.pic"), bytes, PictureUse::Data, &limits);
        read.map(|_| ()).map_err(|error| error.to_string())
    }

    fn gif(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let picture = RgbaImage::from_pixel(width, height, Rgba([9, 9, 9, 255]));
        GifEncoder::new(&mut bytes)
            .encode_frame(Frame::new(picture))
            .unwrap();
        bytes
    }

    #[test]
    fn a_frame_of_a_gif_that_is_larger_than_the_picture_counts_as_memory() {
        let mut bytes = gif(300, 200);
        assert_eq!(of_gif(&bytes[..]).unwrap(), Some([300, 200]));
        // The picture, and not its frame, is 4 pixels wide and high.
        bytes[6..10].copy_from_slice(&[4, 0, 4, 0]);
        assert_eq!(of_gif(&bytes[..]).unwrap(), Some([300, 200]));
        assert_eq!(read(&bytes, 1 << 20), Ok(()));
        let text = read(&bytes, 200_000).unwrap_err();
        assert!(
            text.contains("a.pic") && text.contains("--memory"),
            "{text}"
        );
        // One that is larger than any picture may be.
        let at = bytes
            .windows(5)
            .position(|five| five == [0x2c, 0, 0, 0, 0])
            .unwrap();
        bytes[at + 5..at + 9].copy_from_slice(&[0x30, 0x75, 0x30, 0x75]);
        let text = read(&bytes, 1 << 40).unwrap_err();
        assert!(text.contains("30000x30000"), "{text}");
        assert_eq!(read(&gif(300, 200), 1 << 20), Ok(()));
    }

    /// A WebP of 4 by 4 pixels with a lossy frame of another size, still or in an animation.
    fn webp(width: u16, height: u16, moves: bool) -> Vec<u8> {
        let chunk = |kind: &[u8], data: &[u8]| {
            let length = (data.len() as u32).to_le_bytes();
            [kind, &length, data].concat()
        };
        let mut frame = vec![0x10, 0, 0, 0x9d, 0x01, 0x2a];
        frame.extend(width.to_le_bytes());
        frame.extend(height.to_le_bytes());
        frame.extend([0; 16]);
        let frame = chunk(b"VP8 ", &frame);
        let head = chunk(
            b"VP8X",
            &[if moves { 2 } else { 0 }, 0, 0, 0, 3, 0, 0, 3, 0, 0],
        );
        let rest = if moves {
            let around = [
                &[0, 0, 0, 0, 0, 0, 3, 0, 0, 3, 0, 0, 1, 0, 0, 0],
                &frame[..],
            ]
            .concat();
            [chunk(b"ANIM", &[0; 6]), chunk(b"ANMF", &around)].concat()
        } else {
            frame
        };
        chunk(b"RIFF", &[b"WEBP", &head[..], &rest].concat())
    }

    #[test]
    fn a_frame_of_a_webp_that_is_larger_than_the_picture_counts_as_memory() {
        for moves in [false, true] {
            let bytes = webp(1600, 1200, moves);
            let found = of_webp(Cursor::new(&bytes)).unwrap();
            assert_eq!(found, Some([1600, 1200]), "moves: {moves}");
            let text = read(&bytes, 1 << 20).unwrap_err();
            assert!(text.contains("--memory"), "moves: {moves}: {text}");
            // With enough memory it is not what it says.
            let text = read(&bytes, 1 << 30).unwrap_err();
            assert!(!text.contains("--memory"), "moves: {moves}: {text}");
        }
        let mut whole = Vec::new();
        let pixels = [200; 4 * 4 * 3];
        let encoder = WebPEncoder::new_lossless(&mut whole);
        encoder
            .encode(&pixels, 4, 4, image::ExtendedColorType::Rgb8)
            .unwrap();
        assert_eq!(of_webp(Cursor::new(&whole)).unwrap(), None);
        assert_eq!(read(&whole, 1 << 20), Ok(()));
    }

    #[test]
    fn a_jpeg_with_much_behind_its_end_counts_as_memory() {
        let mut bytes = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut bytes, 90);
        image::ImageEncoder::write_image(
            encoder,
            &[90; 8 * 8 * 3],
            8,
            8,
            image::ExtendedColorType::Rgb8,
        )
        .unwrap();
        bytes.resize(1 << 20, 0);
        assert_eq!(read(&bytes, 4 << 20), Ok(()));
        let text = read(&bytes, 1 << 20).unwrap_err();
        assert!(text.contains("--memory"), "{text}");
    }
}
