//! Pictures that end too early or are damaged, as far as they can be decoded.

use super::super::error::Problem;
use super::read::one_line;
use image::error::ImageResult;
use image::{ColorType, ImageDecoder, ImageError};
use std::io::ErrorKind;

/// Decodes what there is of a picture whose decoder writes row after row, and fills what there is not with grey.
pub(super) struct AsFar<'a, D> {
    pub decoder: D,
    /// Where the picture is not all there: what to say of it.
    pub doubt: &'a mut Option<Problem>,
}

/// Grey in 8 and in 16 bits, whose bytes are the same in either order.
const GREY: u8 = 0x80;
/// And as a number.
const GREY_LIGHT: f32 = 0.2;
/// From one grey of numbers to the next.
const STEP: f32 = 1e-3;

impl<D: ImageDecoder> ImageDecoder for AsFar<'_, D> {
    fn dimensions(&self) -> (u32, u32) {
        self.decoder.dimensions()
    }

    fn color_type(&self) -> ColorType {
        self.decoder.color_type()
    }

    fn read_image(self, bytes: &mut [u8]) -> ImageResult<()> {
        let color = self.decoder.color_type();
        // By turns, so that no picture of one colour is taken for what was there before it.
        let greys = [grey(color, 0), grey(color, 1)];
        let pixel = greys[0].len();
        let mut pixels = bytes.chunks_exact_mut(pixel).zip(greys.iter().cycle());
        pixels
            .by_ref()
            .for_each(|(pixel, grey)| pixel.copy_from_slice(grey));
        let Err(error) = self.decoder.read_image(bytes) else {
            return Ok(());
        };
        let mut pixels = bytes.chunks_exact(pixel).zip(greys.iter().cycle());
        if pixels.all(|(pixel, grey)| pixel == grey) {
            return Err(error);
        }
        *self.doubt = Some(doubt(&error));
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, bytes: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(bytes)
    }
}

/// The bytes of an opaque grey pixel, or of one that is lighter by a step.
fn grey(color: ColorType, step: u8) -> Vec<u8> {
    let channels = usize::from(color.channel_count());
    let bytes = usize::from(color.bytes_per_pixel()) / channels;
    if bytes == 4 {
        let mut pixel = vec![GREY_LIGHT + f32::from(step) * STEP; channels];
        if color.has_alpha() {
            pixel[channels - 1] = 1.0;
        }
        return pixel.into_iter().flat_map(f32::to_ne_bytes).collect();
    }
    let mut pixel = vec![GREY + step; channels * bytes];
    if color.has_alpha() {
        pixel[(channels - 1) * bytes..].fill(u8::MAX);
    }
    pixel
}

/// What to say of a picture that could be decoded in part.
fn doubt(error: &ImageError) -> Problem {
    match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => Problem::CutShort,
        other => Problem::DecodedInPart(one_line(&other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::super::read::{PictureUse, decode_picture};
    use crate::io::Limits;
    use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb, Rgba};
    use std::io::Cursor;
    use std::path::Path;

    const SIDE: u32 = 64;

    /// As numbers, and what is said of it.
    fn decoded(bytes: &[u8]) -> Result<(Vec<u8>, String), String> {
        let name = Path::new("a.png");
        let read = decode_picture(name, bytes, PictureUse::Data, &Limits::default());
        let read = read.map_err(|error| error.to_string())?;
        let told = read.doubt.map(|doubt| doubt.to_string());
        Ok((
            read.image.data.unwrap_or_default(),
            told.unwrap_or_default(),
        ))
    }

    fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).expect("a picture");
        bytes.into_inner()
    }

    /// What no filter and no repetition makes shorter.
    fn mixed(x: u32, y: u32) -> u16 {
        let n = (x + 7 * SIDE * y).wrapping_mul(0x9e37_79b1);
        ((n ^ n >> 15).wrapping_mul(0x85eb_ca6b) >> 16) as u16
    }

    #[test]
    fn a_picture_without_its_end_is_shown_as_far_as_it_reaches_and_grey_beyond() {
        let eight = |x, y| [mixed(x, y) as u8, 7, 9];
        let colors = ImageBuffer::from_fn(SIDE, SIDE, |x, y| Rgb(eight(x, y)));
        let faded = ImageBuffer::from_fn(SIDE, SIDE, |x, y| {
            let [r, g, b] = eight(x, y);
            Rgba([r, g, b, 100])
        });
        let deep = ImageBuffer::from_fn(SIDE, SIDE, |x, y| Luma([mixed(x, y)]));
        for (kind, picture, format, grey) in [
            (
                "8 bits",
                colors.clone().into(),
                ImageFormat::Png,
                &[128, 128, 128, 255][..],
            ),
            (
                "alpha",
                DynamicImage::from(faded),
                ImageFormat::Png,
                &[128, 128, 128, 255],
            ),
            ("16 bits", deep.into(), ImageFormat::Png, &[128; 6]),
            (
                "BMP",
                colors.into(),
                ImageFormat::Bmp,
                &[128, 128, 128, 255],
            ),
        ] {
            let bytes = encoded(&picture, format);
            let (whole, told) = decoded(&bytes).unwrap();
            assert_eq!(told, "", "{kind}");
            if format == ImageFormat::Png {
                // Without its last part, which holds nothing.
                let (found, told) = decoded(&bytes[..bytes.len() - 12]).unwrap();
                assert_eq!(found, whole, "{kind}");
                assert!(told.contains("a.png: was cut off"), "{kind}: {told}");
            }
            let (found, told) = decoded(&bytes[..bytes.len() / 2]).unwrap();
            assert!(told.contains("a.png: was cut off"), "{kind}: {told}");
            let pixel = whole.len() / (SIDE * SIDE) as usize;
            let rows = found.chunks_exact(SIDE as usize * pixel);
            let wholes = whole.chunks_exact(SIDE as usize * pixel);
            let same = rows
                .clone()
                .zip(wholes)
                .filter(|(row, whole)| row == whole)
                .count();
            assert!(
                (20..44).contains(&same),
                "{kind}: {same} rows of half of it"
            );
            let near = |(found, grey): (&u8, &u8)| found.abs_diff(*grey) < 2;
            let is_near = |p: &[u8]| p.iter().zip(grey).all(near);
            let is_grey = |row: &&[u8]| row.chunks_exact(pixel).all(is_near);
            let missing = rows.filter(is_grey).count();
            // The row in which it ends may be there in part.
            assert!(
                same + missing + 1 >= SIDE as usize,
                "{kind}: {same} and {missing}"
            );
        }
    }

    #[test]
    fn a_picture_with_wrong_data_in_its_middle_is_said_to_be_damaged() {
        let picture = ImageBuffer::from_fn(SIDE, SIDE, |x, y| Luma([mixed(x, y) as u8]));
        let mut bytes = encoded(&picture.into(), ImageFormat::Png);
        let middle = bytes.len() / 2;
        bytes[middle..middle + 16].fill(0xff);
        match decoded(&bytes) {
            Ok((_, told)) => assert!(told.contains("is damaged"), "{told}"),
            Err(told) => assert!(told.contains("a.png"), "{told}"),
        }
    }

    #[test]
    fn a_picture_of_grey_alone_is_not_taken_for_one_of_which_nothing_is_there() {
        for grey in [0x80, 0x81] {
            let picture = ImageBuffer::from_pixel(SIDE, SIDE, Luma([grey]));
            let bytes = encoded(&picture.into(), ImageFormat::Png);
            let (found, told) = decoded(&bytes[..bytes.len() - 12]).unwrap();
            assert!(told.contains("cut off"), "{told}");
            assert!(
                found
                    .as_chunks()
                    .0
                    .iter()
                    .all(|p| *p == [grey, grey, grey, 255])
            );
        }
    }

    #[test]
    fn a_picture_of_which_nothing_is_there_is_none() {
        let picture = ImageBuffer::from_fn(SIDE, SIDE, |x, y| Luma([mixed(x, y) as u8]));
        let bytes = encoded(&picture.into(), ImageFormat::Png);
        let told = decoded(&bytes[..45]).unwrap_err();
        assert!(told.contains("incomplete"), "{told}");
    }
}
