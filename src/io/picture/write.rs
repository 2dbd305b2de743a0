use super::super::error::{FileError, Problem};
use super::super::replace::Staged;
use super::{PictureFormat, check_format_size, to_exr};
use crate::film::Picture;
use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ImageBuffer, ImageResult};
use std::io;
use std::path::Path;

/// Of 1 to 100. The step where colour is still not subsampled visibly and files stay small.
const JPEG_QUALITY: u8 = 95;

/// Writes a picture, row by row from the top left. The extension decides on the format:
/// `.png` and `.jpg` take view-transformed values, clamped to [0, 1] and rounded to 8 bits
/// (not a number becomes 0); `.exr` and `.hdr` take linear light as it is.
///
/// The file appears complete or not at all.
pub fn write_picture(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
) -> Result<(), FileError> {
    write_picture_with_notes(path, width, height, pixels, &[])
}

/// The same with notes, a name and a text each: a PNG keeps them as international text, an OpenEXR
/// file `Software` as that attribute and the others as lines of `comments`; JPEG and HDR have no
/// place for them. A name is 1 to 79 letters; a text is one line, in which a space stands for each
/// control character.
pub fn write_picture_with_notes(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
    notes: &[(&str, String)],
) -> Result<(), FileError> {
    stage(path, width, height, pixels, notes)?.commit()
}

/// The same, complete beside its place: for one of several files that belong together.
pub(crate) fn stage_picture(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
) -> Result<Staged, FileError> {
    stage(path, width, height, pixels, &[])
}

fn stage(
    path: &Path,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
    notes: &[(&str, String)],
) -> Result<Staged, FileError> {
    let format = PictureFormat::of(path)?;
    check_format_size(path, format, width.into(), height.into())?;
    let wrong_size = || {
        FileError::new(
            path,
            Problem::PictureSize {
                width,
                height,
                given: pixels.len(),
            },
        )
    };
    if pixels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(wrong_size());
    }
    let picture = if format.is_linear() {
        ImageBuffer::from_raw(width, height, pixels.as_flattened().to_vec())
            .map(DynamicImage::ImageRgb32F)
    } else {
        let bytes = pixels.as_flattened().iter().map(|&v| to_byte(v)).collect();
        ImageBuffer::from_raw(width, height, bytes).map(DynamicImage::ImageRgb8)
    }
    .ok_or_else(wrong_size)?;
    Staged::new(path, |writer| {
        io_result(match format {
            PictureFormat::Png if !notes.is_empty() => {
                return write_png(writer, &picture, notes);
            }
            PictureFormat::Exr => {
                return write_exr(writer, width, height, pixels, notes);
            }
            PictureFormat::Jpeg => {
                picture.write_with_encoder(JpegEncoder::new_with_quality(writer, JPEG_QUALITY))
            }
            _ => picture.write_to(writer, format.image_format()),
        })
    })
}

fn write_png(
    writer: impl io::Write,
    picture: &DynamicImage,
    notes: &[(&str, String)],
) -> io::Result<()> {
    let mut encoder = png::Encoder::new(writer, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    for (name, text) in notes {
        encoder
            .add_itxt_chunk((*name).to_owned(), of_one_line(text))
            .map_err(io::Error::other)?;
    }
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer
        .write_image_data(picture.as_bytes())
        .and_then(|()| writer.finish())
        .map_err(|error| match error {
            png::EncodingError::IoError(error) => error,
            other => io::Error::other(other),
        })
}

/// Writes a picture and parts of it, each with its name, as an OpenEXR file: channels `R`, `G`, `B`, and `NAME.R` and so on
/// for each part. All are of one size.
pub(super) fn write_exr_layers(
    path: &Path,
    picture: &Picture,
    layers: &[(String, &Picture)],
    notes: &[(&str, String)],
) -> Result<(), FileError> {
    use exr::prelude::*;
    let (width, height) = (picture.width, picture.height);
    check_format_size(path, PictureFormat::Exr, width.into(), height.into())?;
    let whole = std::iter::once((None, picture));
    let named = layers.iter().map(|(name, layer)| (Some(name), *layer));
    let channels = whole.chain(named).flat_map(|(name, layer)| {
        ["R", "G", "B"]
            .into_iter()
            .enumerate()
            .map(move |(i, channel)| {
                let name = match name {
                    Some(name) => format!("{name}.{channel}"),
                    None => channel.to_owned(),
                };
                let samples = layer.pixels.iter().map(|pixel| pixel[i]).collect();
                AnyChannel::new(to_exr(&name), FlatSamples::F32(samples))
            })
    });
    let channels = AnyChannels::sort(channels.collect());
    let size = (width as usize, height as usize);
    let layer = Layer::new(size, attributes(notes), exr_encoding(), channels);
    let staged = Staged::new(path, |writer| {
        exr_result(Image::from_layer(layer).write().to_buffered(writer))
    })?;
    staged.commit()
}

/// In this order however many threads compress the tiles, so that the same picture is the same file.
fn exr_encoding() -> exr::image::Encoding {
    use exr::prelude::*;
    Encoding {
        line_order: LineOrder::Increasing,
        ..Encoding::FAST_LOSSLESS
    }
}

fn exr_result(result: exr::error::UnitResult) -> io::Result<()> {
    result.map_err(|error| match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}

/// A text as it stands in one line. What names in it hold must not end the line: another would be read as a note of ours.
fn of_one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// Attributes of other names would stand in an order of chance, and no two files be the same.
fn attributes(notes: &[(&str, String)]) -> exr::meta::header::LayerAttributes {
    let mut attributes = exr::meta::header::LayerAttributes::default();
    let mut lines = Vec::new();
    for (name, note) in notes {
        let note = of_one_line(note);
        if *name == "Software" {
            attributes.software_name = Some(to_exr(&note));
        } else {
            lines.push(format!("{name}: {note}"));
        }
    }
    if !lines.is_empty() {
        attributes.comments = Some(to_exr(&lines.join("\n")));
    }
    attributes
}

fn write_exr(
    writer: impl io::Write + io::Seek,
    width: u32,
    height: u32,
    pixels: &[[f32; 3]],
    notes: &[(&str, String)],
) -> io::Result<()> {
    use exr::prelude::*;
    let size = (width as usize, height as usize);
    let pixel = |at: Vec2<usize>| {
        let [r, g, b] = pixels[at.y() * size.0 + at.x()];
        (r, g, b)
    };
    let layer = Layer::new(
        size,
        attributes(notes),
        exr_encoding(),
        SpecificChannels::rgb(pixel),
    );
    exr_result(Image::from_layer(layer).write().to_buffered(writer))
}

/// Encodes a picture as a PNG in memory, with as many bits as it has,, to embed it in a model file.
pub(crate) fn encode_png(picture: &DynamicImage) -> io::Result<Vec<u8>> {
    let mut bytes = io::Cursor::new(Vec::new());
    io_result(picture.write_to(&mut bytes, image::ImageFormat::Png))?;
    Ok(bytes.into_inner())
}

fn io_result(result: ImageResult<()>) -> io::Result<()> {
    result.map_err(|error| match error {
        image::ImageError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

fn to_byte(value: f32) -> u8 {
    // A float becomes an integer by saturation, and not a number becomes 0.
    (value * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Limits;
    use crate::io::picture::{PictureUse, read_picture};

    const PIXELS: [[f32; 3]; 4] = [
        [0.0, 0.25, 0.5],
        [1.0, 2.0, -1.0],
        [f32::NAN, 0.75, 0.1],
        [0.2, 0.4, 0.6],
    ];

    #[test]
    fn a_png_holds_the_nearest_of_256_values_and_clamps() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_picture(&path, 2, 2, &PIXELS).unwrap();
        let bytes = image::open(&path).unwrap().into_rgb8().into_raw();
        assert_eq!(
            bytes,
            [0, 64, 128, 255, 255, 0, 0, 191, 26, 51, 102, 153],
            "{bytes:?}"
        );
    }

    #[test]
    fn an_exr_holds_linear_light_exactly_and_an_hdr_within_its_mantissa() {
        let folder = tempfile::tempdir().unwrap();
        let pixels = [[0.0_f32, 0.25, 0.5], [1.0, 200.0, 0.125]];
        for (name, tolerance) in [("a.exr", 0.0), ("a.hdr", 1.0 / 128.0)] {
            let path = folder.path().join(name);
            write_picture(&path, 2, 1, &pixels).unwrap();
            let read = read_picture(&path, PictureUse::Color, &Limits::default()).unwrap();
            let read: Vec<f32> = read
                .image
                .data
                .unwrap()
                .as_chunks()
                .0
                .iter()
                .map(|&b| f32::from_le_bytes(b))
                .collect();
            for (pixel, back) in pixels.iter().zip(read.as_chunks::<4>().0) {
                let largest = pixel.iter().copied().fold(0.0, f32::max);
                for i in 0..3 {
                    let error = (pixel[i] - back[i]).abs();
                    assert!(
                        error <= tolerance * largest,
                        "{name}: {pixel:?} came back as {back:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_bytes_of_a_picture_are_the_same_each_time() {
        let folder = tempfile::tempdir().unwrap();
        let (width, height) = (500, 400);
        let pixels: Vec<[f32; 3]> = (0..width * height)
            .map(|i| [i as f32, (i % 97) as f32 * 0.1, (i / 500) as f32])
            .collect();
        for name in ["a.exr", "a.hdr", "a.png", "a.jpg"] {
            for notes in [vec![], vec![("Software", "Glassbox".to_owned())]] {
                let path = folder.path().join(name);
                let write = || {
                    write_picture_with_notes(&path, width, height, &pixels, &notes).unwrap();
                    std::fs::read(&path).unwrap()
                };
                let first = write();
                for _ in 0..8 {
                    assert!(write() == first, "{name} differs, notes: {}", notes.len());
                }
            }
        }
    }

    #[test]
    fn notes_are_kept_and_the_pixels_are_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let notes = [
            ("Software", "Glassbox".to_owned()),
            ("Camera", "größe Ж".into()),
        ];
        for name in ["a.png", "a.exr"] {
            let (with, without) = (
                folder.path().join(name),
                folder.path().join(format!("b{name}")),
            );
            let pixels = PIXELS.map(|pixel| pixel.map(|v| if v.is_nan() { 0.0 } else { v }));
            write_picture_with_notes(&with, 2, 2, &pixels, &notes).unwrap();
            write_picture(&without, 2, 2, &pixels).unwrap();
            let read = |path| image::open(path).unwrap().into_rgb32f();
            assert_eq!(read(&with), read(&without), "{name}");
        }
        let png = png::Decoder::new(io::BufReader::new(
            std::fs::File::open(folder.path().join("a.png")).unwrap(),
        ));
        let reader = png.read_info().unwrap();
        let text: Vec<_> = reader
            .info()
            .utf8_text
            .iter()
            .map(|t| t.get_text().unwrap())
            .collect();
        assert_eq!(text, notes.clone().map(|(_, text)| text));
        let exr = exr::meta::MetaData::read_from_file(folder.path().join("a.exr"), false).unwrap();
        let kept = &exr.headers[0].own_attributes;
        let bytes =
            |text: &Option<exr::meta::attribute::Text>| text.clone().unwrap().as_slice().to_vec();
        assert_eq!(bytes(&kept.software_name), b"Glassbox");
        assert_eq!(bytes(&kept.comments), "Camera: größe Ж".as_bytes());
    }

    #[test]
    fn a_name_with_line_breaks_in_it_is_no_other_note() {
        let folder = tempfile::tempdir().unwrap();
        let (png, exr) = (folder.path().join("a.png"), folder.path().join("a.exr"));
        let notes = [
            ("Camera", "A\nSettings: output.exposure=10\r\u{85}\0".into()),
            ("Settings", "output.exposure=0".into()),
        ];
        for path in [&png, &exr] {
            write_picture_with_notes(path, 2, 2, &PIXELS, &notes).unwrap();
        }
        let of_one_line = "A Settings: output.exposure=10   ";
        let file = io::BufReader::new(std::fs::File::open(png).unwrap());
        let reader = png::Decoder::new(file).read_info().unwrap();
        let texts = reader
            .info()
            .utf8_text
            .iter()
            .map(|t| t.get_text().unwrap());
        assert!(texts.into_iter().any(|text| text == of_one_line));
        let exr = exr::meta::MetaData::read_from_file(exr, false).unwrap();
        let comments = exr.headers[0].own_attributes.comments.clone().unwrap();
        let comments = comments.to_string();
        let lines: Vec<&str> = comments.lines().collect();
        let camera = format!("Camera: {of_one_line}");
        assert_eq!(lines, [&camera, "Settings: output.exposure=0"]);
    }

    #[test]
    fn a_picture_that_cannot_be_written_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let error = write_picture(&path, 3, 1, &PIXELS).unwrap_err();
        assert!(
            matches!(error.problem, Problem::PictureSize { .. }),
            "{error}"
        );
        let left = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 0, "{left} files were left");
    }
}
