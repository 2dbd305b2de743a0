//! Whether a JPEG is all there. Its decoder shows what there is of one that was cut off, and grey below, without a word.

use super::super::error::Problem;
use std::io::{self, BufRead, ErrorKind};

/// What to say of a JPEG that was read and has no end.
pub(super) fn cut_short(bytes: impl BufRead) -> Option<Problem> {
    match reaches_end(bytes) {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Some(Problem::CutShort),
        _ => None,
    }
}

/// Walks from marker to marker (ITU T.81, B.1) until the end of the image, or something that is no JPEG.
fn reaches_end(mut bytes: impl BufRead) -> io::Result<()> {
    let mut next = || -> io::Result<u8> {
        let byte = bytes.fill_buf()?.first().copied();
        let byte = byte.ok_or_else(|| io::Error::from(ErrorKind::UnexpectedEof))?;
        bytes.consume(1);
        Ok(byte)
    };
    if [next()?, next()?] != [0xff, 0xd8] {
        return Ok(());
    }
    let mut in_scan = false;
    loop {
        let byte = next()?;
        if byte != 0xff {
            if in_scan {
                continue;
            }
            return Ok(());
        }
        let mut marker = next()?;
        while marker == 0xff {
            marker = next()?;
        }
        match marker {
            0xd9 => return Ok(()),
            // A byte of the data that looks like a marker, and those that stand alone.
            0x00 | 0x01 | 0xd0..=0xd7 => {}
            _ => {
                let length = u16::from_be_bytes([next()?, next()?]);
                for _ in 2..length {
                    next()?;
                }
                in_scan = marker == 0xda;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::jpeg::JpegEncoder;
    use image::{ImageBuffer, Rgb};

    #[test]
    fn a_jpeg_without_its_end_is_told_from_one_that_is_whole() {
        let picture = ImageBuffer::from_fn(64, 64, |x, y| Rgb([x as u8 * 4, y as u8 * 4, 99_u8]));
        let mut whole = Vec::new();
        picture
            .write_with_encoder(JpegEncoder::new_with_quality(&mut whole, 90))
            .unwrap();
        let told = |bytes: &[u8]| cut_short(bytes).map(|problem| problem.to_string());
        assert_eq!(told(&whole), None);
        assert_eq!(told(&[&whole[..], b"something behind it"].concat()), None);
        assert_eq!(told(b"no JPEG at all"), None);
        for length in [whole.len() / 2, whole.len() - 40, whole.len() - 1] {
            let text = told(&whole[..length]).expect("a part was taken for the whole");
            assert!(text.contains("cut off"), "{text}");
        }
    }
}
