//! Which format a picture has: its content tells, whatever its name says.

use super::super::error::Problem;
use image::ImageFormat;

/// How many of a file's first bytes are looked at.
pub(super) const HEAD: usize = 32;

/// The formats that are read, for messages.
const READ: &str = "PNG, JPEG, WebP, TGA, BMP, GIF, DDS, Radiance HDR and OpenEXR are read";

/// The format by a file's first bytes.
pub(super) fn recognised(head: &[u8]) -> Result<ImageFormat, Problem> {
    use ImageFormat as F;
    // Radiance's own programs write `#?RADIANCE`, others `#?RGBE` or their own name.
    if head.starts_with(b"#?") {
        return Ok(F::Hdr);
    }
    match image::guess_format(head) {
        Ok(format @ (F::Png | F::Jpeg | F::WebP | F::Bmp | F::Gif | F::Dds | F::OpenExr)) => {
            Ok(format)
        }
        Ok(other) => {
            let name = other.extensions_str().first().copied().unwrap_or_default();
            Err(Problem::Malformed(format!(
                "is a picture of the kind .{name}, which is not read; {READ}"
            )))
        }
        Err(_) if looks_like_tga(head) => Ok(F::Tga),
        Err(_) => {
            let text = match unread(head) {
                Some(name) => format!("is {name}, which is not read; {READ}"),
                None => format!("is not a picture that can be decoded; {READ}"),
            };
            Err(Problem::Malformed(text))
        }
    }
}

/// What a file is instead that often stands where a picture should, for the message.
fn unread(head: &[u8]) -> Option<&'static str> {
    // These follow the length of the first box (ISO/IEC 14496-12).
    const BOXED: [(&[u8], &str); 4] = [
        (b"ftyphei", "a picture in HEIC"),
        (b"ftypmif1", "a picture in HEIC"),
        (b"JXL ", "a picture in JPEG XL"),
        (b"jP  ", "a picture in JPEG 2000"),
    ];
    const MARKS: [(&[u8], &str); 6] = [
        (b"\xabKTX ", "a texture in KTX"),
        (b"sB", "a texture in Basis Universal"),
        (b"\xff\x0a", "a picture in JPEG XL"),
        (b"\xff\x4f\xff\x51", "a picture in JPEG 2000"),
        (b"8BPS", "a document of Photoshop"),
        (b"<svg", "a drawing in SVG"),
    ];
    let is_at = |start: usize| {
        move |(mark, _): &&(&[u8], _)| head.get(start..).is_some_and(|rest| rest.starts_with(mark))
    };
    let found = MARKS.iter().find(is_at(0));
    let found = found.or_else(|| BOXED.iter().find(is_at(4)));
    found.map(|&(_, name)| name)
}

/// A TGA has no mark at its beginning, but a head whose numbers few other files have (Truevision TGA
/// File Format Specification 2.0, 1991, fields 2 to 5).
fn looks_like_tga(head: &[u8]) -> bool {
    let Some(&[_, has_palette, kind, ..]) = head.first_chunk::<18>() else {
        return false;
    };
    let number = |at: usize| u16::from_le_bytes([head[at], head[at + 1]]);
    let (palette, size, bits) = (head[7], [number(12), number(14)], head[16]);
    let known = match (has_palette, kind) {
        (1, 1 | 9) => matches!(palette, 15 | 16 | 24 | 32) && matches!(bits, 8 | 16),
        (0 | 1, 2 | 10) => matches!(bits, 15 | 16 | 24 | 32),
        (0 | 1, 3 | 11) => matches!(bits, 8 | 16),
        _ => false,
    };
    known && !size.contains(&0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tga_is_known_by_the_numbers_in_its_head_and_text_is_none() {
        let mut head = [0_u8; 18];
        (head[2], head[12], head[14], head[16]) = (2, 4, 4, 24);
        assert_eq!(recognised(&head).unwrap(), ImageFormat::Tga);
        head[16] = 23;
        assert!(recognised(&head).is_err(), "23 bits");
        for text in [&b""[..], b"solid cube of text that is long", b"\x01\x01"] {
            assert!(recognised(text).is_err(), "{text:?}");
        }
    }

    #[test]
    fn a_picture_of_a_kind_that_is_not_read_is_called_by_it() {
        let problem = recognised(b"II*\0 and so on").unwrap_err().to_string();
        assert!(
            problem.contains(".tiff") && problem.contains("PNG"),
            "{problem}"
        );
        let texture = recognised(b"\xabKTX 20\xbb\r\n\x1a\n").unwrap_err();
        assert!(texture.to_string().contains("KTX"), "{texture}");
        for (head, name) in [
            (&b"\0\0\0\x18ftypheic\0\0\0\0"[..], "HEIC"),
            (b"\0\0\0\x0cJXL \r\n\x87\n", "JPEG XL"),
            (b"\0\0\0\x0cjP  \r\n\x87\n", "JPEG 2000"),
            (b"\0\0\0\x1cftypavif\0\0\0\0", "avif"),
        ] {
            let told = recognised(head).unwrap_err().to_string();
            assert!(told.contains(name), "{told}");
        }
    }
}
