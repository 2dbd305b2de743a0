//! Radiance pictures in all their spellings.
//!
//! The head is read here and told to the decoder in the one spelling that it knows: any name after `#?`,
//! line ends of any kind, no FORMAT at all, exposures, and the eight orders of pixels (Greg Ward, "Real
//! Pixels", Graphics Gems II, 1991; Radiance's `filefmts.pdf`, "Radiance Picture File Format").

use super::super::error::{FileError, Problem};
use super::as_far::AsFar;
use super::claim_picture;
use super::read::{Decoded, failure};
use crate::io::Limits;
use image::DynamicImage;
use image::codecs::hdr::HdrDecoder;
use std::io::{self, BufRead, Cursor, Read};
use std::path::Path;

/// Bytes of a head: more than any program writes.
const LONGEST_HEAD: u64 = 1 << 16;

/// What stands before the pixels.
#[derive(Debug, PartialEq)]
struct Head {
    /// Rows of pixels, one after the other in the file, and pixels of each.
    rows: [u32; 2],
    /// The rows are columns of the picture.
    transposed: bool,
    /// The picture's columns come from right to left.
    from_right: bool,
    /// Its rows come from the bottom to the top.
    from_bottom: bool,
    /// By what the pixels were multiplied, for red, green and blue.
    exposure: [f32; 3],
    /// They are X, Y and Z (CIE 1931), not red, green and blue.
    xyz: bool,
}

/// Decodes a picture whose first bytes are `#?`.
pub(super) fn decode(
    name: &Path,
    mut reader: impl BufRead,
    limits: &Limits,
) -> Result<Decoded, FileError> {
    let head = head(&mut reader).map_err(|problem| FileError::new(name, problem))?;
    let [rows, pixels] = head.rows;
    let (width, height) = if head.transposed {
        (rows, pixels)
    } else {
        (pixels, rows)
    };
    claim_picture(name, (width, height), 4, limits)?;
    let told = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {pixels}\n");
    let mut doubt = None;
    let decoder = HdrDecoder::new(Cursor::new(told).chain(reader));
    let picture = decoder.and_then(|decoder| {
        DynamicImage::from_decoder(AsFar {
            decoder,
            doubt: &mut doubt,
        })
    });
    let mut picture = picture.map_err(|error| failure(name, error))?.into_rgb32f();
    if head.xyz || head.exposure != [1.0; 3] {
        for pixel in picture.pixels_mut() {
            let rgb = if head.xyz {
                linear_rgb(pixel.0)
            } else {
                pixel.0
            };
            pixel.0 = std::array::from_fn(|i| rgb[i] / head.exposure[i]);
        }
    }
    let mut picture = DynamicImage::ImageRgb32F(picture);
    if head.transposed {
        picture = picture.rotate90().fliph();
    }
    if head.from_right {
        picture = picture.fliph();
    }
    if head.from_bottom {
        picture = picture.flipv();
    }
    Ok(Decoded {
        doubt,
        ..Decoded::from(picture)
    })
}

fn head(reader: &mut impl BufRead) -> Result<Head, Problem> {
    let mut limited = reader.take(LONGEST_HEAD);
    let end = first_end(&mut limited)?;
    let mut exposure = [1.0_f32; 3];
    let mut xyz = false;
    let sizes = loop {
        let line = line(&mut limited, end)?;
        if line.is_empty() {
            break self::line(&mut limited, end)?;
        }
        // Some programs leave out the empty line before it.
        if is_size(&line) {
            break line;
        }
        let Some((key, value)) = line.split_once('=') else {
            continue;
        };
        let numbers = value.split_whitespace().map(str::parse::<f32>);
        let numbers: Vec<f32> = numbers.map_while(Result::ok).collect();
        let factors = match (key.trim(), &numbers[..]) {
            ("FORMAT", _) => {
                xyz = match value.trim() {
                    "32-bit_rle_rgbe" => false,
                    "32-bit_rle_xyze" => true,
                    other => {
                        return Err(Problem::Malformed(format!(
                            "holds pixels of the format `{other}`; Radiance's are 32-bit_rle_rgbe and 32-bit_rle_xyze"
                        )));
                    }
                };
                continue;
            }
            ("EXPOSURE", &[all]) => [all; 3],
            ("COLORCORR", &[r, g, b]) => [r, g, b],
            ("EXPOSURE" | "COLORCORR", _) => [0.0; 3],
            _ => continue,
        };
        if !factors
            .iter()
            .all(|factor| factor.is_finite() && *factor > 0.0)
        {
            return Err(Problem::Malformed(format!(
                "says {}, which must be a number above 0",
                line.trim()
            )));
        }
        // There may be several, and each counts.
        exposure = std::array::from_fn(|i| exposure[i] * factors[i]);
    };
    let words: Vec<&str> = sizes.split_whitespace().collect();
    let wrong = || {
        Problem::Malformed(format!(
            "says `{sizes}` for its size, and not for example -Y 480 +X 640"
        ))
    };
    let [first, rows, second, pixels] = words[..] else {
        return Err(wrong());
    };
    let transposed = first.ends_with('X');
    let (x, y) = if transposed {
        (first, second)
    } else {
        (second, first)
    };
    let from_right = match x {
        "+X" => false,
        "-X" => true,
        _ => return Err(wrong()),
    };
    let from_bottom = match y {
        "-Y" => false,
        "+Y" => true,
        _ => return Err(wrong()),
    };
    let number = |text: &str| text.parse::<u32>().map_err(|_| wrong());
    Ok(Head {
        rows: [number(rows)?, number(pixels)?],
        transposed,
        from_right,
        from_bottom,
        exposure,
        xyz,
    })
}

/// Whether a line of the head is the last, as in `-Y 480 +X 640`.
fn is_size(line: &str) -> bool {
    let is_axis = |word: &str| matches!(word, "+X" | "-X" | "+Y" | "-Y");
    let is_number = |word: &str| word.bytes().all(|byte| byte.is_ascii_digit());
    let mut words = line.split_whitespace();
    let is_pair = |words: &mut std::str::SplitWhitespace| {
        words.next().is_some_and(is_axis) && words.next().is_some_and(is_number)
    };
    is_pair(&mut words) && is_pair(&mut words)
}

/// Skips the first line, and says how it ended: with LF, before which a CR may stand, or with CR alone. So do the
/// others; after the last any byte may follow.
fn first_end(reader: &mut impl BufRead) -> Result<u8, Problem> {
    let unreadable = |error: io::Error| Problem::Unreadable(error.to_string());
    loop {
        let byte = next_byte(reader).map_err(unreadable)?;
        match byte {
            Some(b'\n') => return Ok(b'\n'),
            Some(b'\r') => {
                let is_both = reader.fill_buf().map_err(unreadable)?.first() == Some(&b'\n');
                reader.consume(usize::from(is_both));
                return Ok(if is_both { b'\n' } else { b'\r' });
            }
            Some(_) => {}
            None => return Err(incomplete()),
        }
    }
}

fn next_byte(reader: &mut impl BufRead) -> io::Result<Option<u8>> {
    let byte = reader.fill_buf()?.first().copied();
    reader.consume(usize::from(byte.is_some()));
    Ok(byte)
}

/// The next line without its end.
fn line(reader: &mut impl BufRead, end: u8) -> Result<String, Problem> {
    let mut bytes = Vec::new();
    let read = reader.read_until(end, &mut bytes);
    read.map_err(|error| Problem::Unreadable(error.to_string()))?;
    if bytes.pop() != Some(end) {
        return Err(incomplete());
    }
    Ok(String::from_utf8_lossy(&bytes).trim_end().to_owned())
}

fn incomplete() -> Problem {
    Problem::Truncated("the head is incomplete".into())
}

/// From XYZ to linear light with sRGB's primaries (IEC 61966-2-1).
fn linear_rgb([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        3.240_625 * x - 1.537_208 * y - 0.498_629 * z,
        -0.968_931 * x + 1.875_756 * y + 0.041_518 * z,
        0.055_710 * x - 0.204_021 * y + 1.056_996 * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 by 3 pixels of rising red.
    fn picture(head: &str, sizes: &str) -> Result<Vec<f32>, String> {
        let mut bytes = format!("{head}{sizes}").into_bytes();
        bytes.extend((1..=6_u8).flat_map(|red| [red, 0, 0, 136]));
        let decoded = decode(Path::new("a.hdr"), &bytes[..], &Limits::default());
        let decoded = decoded.map_err(|error| error.to_string())?;
        let picture = decoded.pixels.into_rgb32f();
        Ok(picture.pixels().map(|pixel| pixel.0[0]).collect())
    }

    #[test]
    fn any_name_any_line_ends_and_no_format_are_read() {
        for head in [
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n",
            "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n",
            "#?RADIANCE\r\n# a comment\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n",
            "#?\nGAMMA=1\nVIEW= -vp 0 0 0\n\n",
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n",
            "#?RADIANCE\n\n",
        ] {
            for end in ["\n", "\r\n", "\r"] {
                let head = match end {
                    "\r" => head.replace("\r\n", "\n").replace('\n', "\r"),
                    _ => head.to_owned(),
                };
                let found = picture(&head, &format!("-Y 3 +X 2{end}"));
                assert_eq!(found, Ok(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), "{head:?}");
            }
        }
        // A line feed after a head of other ends is a pixel's.
        let mut bytes = b"#?RADIANCE\r\r-Y 1 +X 1\r".to_vec();
        bytes.extend([10, 0, 0, 136]);
        let decoded = decode(Path::new("a.hdr"), &bytes[..], &Limits::default()).unwrap();
        assert_eq!(decoded.pixels.into_rgb32f().into_raw(), [10.0, 0.0, 0.0]);
    }

    #[test]
    fn what_there_is_of_a_picture_is_shown_and_the_rest_grey() {
        let mut bytes = b"#?RADIANCE\n\n-Y 3 +X 2\n".to_vec();
        bytes.extend((1..=5_u8).flat_map(|red| [red, 0, 0, 136]));
        let decoded = decode(Path::new("a.hdr"), &bytes[..], &Limits::default()).unwrap();
        let told = decoded.doubt.map(|doubt| doubt.to_string());
        assert!(told.is_some_and(|told| told.contains("cut off")));
        let picture = decoded.pixels.into_rgb32f();
        let red: Vec<f32> = picture.pixels().map(|pixel| pixel.0[0]).collect();
        assert_eq!(red[..4], [1.0, 2.0, 3.0, 4.0]);
        assert!(
            red[4..].iter().all(|red| (red - 0.2).abs() < 0.01),
            "{red:?}"
        );
    }

    #[test]
    fn each_order_of_pixels_is_turned_upright() {
        for (sizes, expected) in [
            ("-Y 3 +X 2", [1_u8, 2, 3, 4, 5, 6]),
            ("+Y 3 +X 2", [5, 6, 3, 4, 1, 2]),
            ("-Y 3 -X 2", [2, 1, 4, 3, 6, 5]),
            ("+Y 3 -X 2", [6, 5, 4, 3, 2, 1]),
            ("+X 2 -Y 3", [1, 4, 2, 5, 3, 6]),
            ("+X 2 +Y 3", [3, 6, 2, 5, 1, 4]),
            ("-X 2 -Y 3", [4, 1, 5, 2, 6, 3]),
            ("-X 2 +Y 3", [6, 3, 5, 2, 4, 1]),
        ] {
            let found = picture("#?RADIANCE\n\n", &format!("{sizes}\n")).unwrap();
            assert_eq!(found, expected.map(f32::from), "{sizes}");
        }
    }

    #[test]
    fn exposures_are_taken_back() {
        let head = "#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 4.0\nCOLORCORR=0.5 1 1\n\n";
        assert_eq!(picture(head, "-Y 3 +X 2\n").unwrap()[3], 1.0);
        for wrong in ["EXPOSURE=0", "EXPOSURE=NaN", "COLORCORR=1 2", "EXPOSURE=x"] {
            let error = picture(&format!("#?RADIANCE\n{wrong}\n\n"), "-Y 3 +X 2\n");
            assert!(error.unwrap_err().contains(wrong), "{wrong}");
        }
    }

    #[test]
    fn white_in_xyz_is_white() {
        // The white of sRGB is (0.9505, 1, 1.0891).
        let [r, g, b] = linear_rgb([0.9505, 1.0, 1.0891]);
        assert!(
            [r, g, b].iter().all(|c| (c - 1.0).abs() < 1e-3),
            "{r} {g} {b}"
        );
        let head = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n";
        assert!(picture(head, "-Y 3 +X 2\n").unwrap()[0] > 3.0);
    }

    #[test]
    fn a_head_that_says_no_size_or_never_ends_is_refused() {
        for sizes in [
            "-Y 3\n",
            "-Y a +X 2\n",
            "-Y 3 +Z 2\n",
            "+X 3 +X 2\n",
            "-Y 3 +X 2",
        ] {
            assert!(picture("#?RADIANCE\n\n", sizes).is_err(), "{sizes}");
        }
        let endless = format!("#?RADIANCE\n{}", "#\n".repeat(1 << 16));
        assert!(
            picture(&endless, "\n-Y 3 +X 2\n")
                .unwrap_err()
                .contains("head")
        );
    }
}
