//! What a picture is on the whole, for readers of materials that have to know it: its mean, and whether it has alpha.

use super::super::error::FileError;
use super::read::ReadPicture;
use crate::io::Limits;
use bevy::image::Image;
use exr::prelude::f16;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::Hash;
use wgpu_types::TextureFormat;

/// A picture that was read as numbers, on the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measured {
    /// Of red, green, blue and alpha; what is whole in a file of integers is 1.
    pub mean: [f64; 4],
    /// Any pixel has an alpha below 1.
    pub has_alpha: bool,
    /// As pictures of normals mostly have.
    pub has_8_bits: bool,
}

/// The pictures of one model that were measured. Materials share them, so each is decoded once, and nothing of its
/// memory stays spoken for.
pub(crate) struct MeasuredPictures<'a, Key> {
    limits: &'a Limits,
    known: HashMap<Key, Option<Measured>>,
}

impl<'a, Key: Eq + Hash> MeasuredPictures<'a, Key> {
    pub fn of(limits: &'a Limits) -> Self {
        Self {
            limits,
            known: HashMap::new(),
        }
    }

    /// Measures the picture that has this key and is read so, as numbers; `None` where it cannot be read, which is
    /// noted where it is loaded.
    ///
    /// # Errors
    /// It needs more memory than is left.
    pub fn measure(
        &mut self,
        key: Key,
        read: impl FnOnce(&Limits) -> Result<ReadPicture, FileError>,
    ) -> Result<Option<Measured>, FileError> {
        match self.known.entry(key) {
            Entry::Occupied(known) => Ok(*known.get()),
            Entry::Vacant(free) => {
                let limits = Limits {
                    memory: self.limits.memory.apart(),
                    ..self.limits.clone()
                };
                let measured = match read(&limits) {
                    Ok(ReadPicture { image, .. }) => Measured::of(&image),
                    Err(error) if error.problem.is_of_memory() => return Err(error),
                    Err(_) => None,
                };
                Ok(*free.insert(measured))
            }
        }
    }
}

impl Measured {
    /// `None` for other formats than those of numbers with four channels.
    fn of(image: &Image) -> Option<Self> {
        let data = image.data.as_deref()?;
        let words = || {
            let words = data.as_chunks::<8>().0.iter();
            words.map(|&[r, s, g, h, b, c, a, d]| [[r, s], [g, h], [b, c], [a, d]])
        };
        let format = image.texture_descriptor.format;
        let (sums, whole) = match format {
            TextureFormat::Rgba8Unorm => {
                let pixels = data.as_chunks::<4>().0.iter();
                let pixels = pixels.map(|pixel| pixel.map(f64::from));
                (Sums::of(pixels, 255.0), 255.0)
            }
            TextureFormat::Rgba16Unorm => {
                let number = |bytes| f64::from(u16::from_ne_bytes(bytes));
                (Sums::of(words().map(|p| p.map(number)), 65535.0), 65535.0)
            }
            TextureFormat::Rgba16Float => {
                let number = |bytes| f16::from_ne_bytes(bytes).to_f64();
                (Sums::of(words().map(|p| p.map(number)), 1.0), 1.0)
            }
            TextureFormat::Rgba32Float => {
                let pixels = data.as_chunks::<16>().0.iter();
                let number = |bytes: &[u8; 4]| f64::from(f32::from_ne_bytes(*bytes));
                let pixels = pixels.map(|pixel| {
                    let (values, _) = pixel.as_chunks::<4>();
                    std::array::from_fn(|i| values.get(i).map_or(0.0, number))
                });
                (Sums::of(pixels, 1.0), 1.0)
            }
            _ => return None,
        };
        (sums.count > 0).then(|| Self {
            mean: sums.channels.map(|sum| sum / sums.count as f64 / whole),
            has_alpha: sums.has_alpha,
            has_8_bits: format == TextureFormat::Rgba8Unorm,
        })
    }
}

/// Of all pixels. Those of integers are exact: no picture has as many as would need more than 53 bits.
#[derive(Default)]
struct Sums {
    channels: [f64; 4],
    has_alpha: bool,
    count: u64,
}

impl Sums {
    /// `whole` is what an alpha of 1 is.
    fn of(pixels: impl Iterator<Item = [f64; 4]>, whole: f64) -> Self {
        let mut sums = Self::default();
        for pixel in pixels {
            for (sum, value) in sums.channels.iter_mut().zip(pixel) {
                *sum += value;
            }
            sums.has_alpha |= pixel[3] < whole;
            sums.count += 1;
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PictureUse, read_picture};
    use super::*;
    use crate::io::Budget;
    use image::{DynamicImage, Rgba, RgbaImage};
    use std::path::{Path, PathBuf};

    /// A quarter of its pixels has another colour.
    fn saved(folder: &Path, name: &str, as_file: impl Fn(DynamicImage) -> DynamicImage) -> PathBuf {
        let mut picture = RgbaImage::from_pixel(20, 20, Rgba([255, 0, 51, 255]));
        for y in 0..10 {
            for x in 0..10 {
                picture.put_pixel(x, y, Rgba([51, 204, 51, 51]));
            }
        }
        let path = folder.join(name);
        as_file(DynamicImage::ImageRgba8(picture))
            .save(&path)
            .unwrap();
        path
    }

    fn read(path: &Path) -> impl FnOnce(&Limits) -> Result<ReadPicture, FileError> {
        move |limits| read_picture(path, PictureUse::Data, limits)
    }

    #[test]
    fn mean_and_alpha_are_those_of_the_file_whatever_numbers_it_keeps_them_in() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let files = [
            saved(folder, "8.png", |picture| picture),
            saved(folder, "16.png", |picture| picture.into_rgba16().into()),
            saved(folder, "32.exr", |picture| picture.into_rgba32f().into()),
        ];
        let limits = Limits::default();
        let mut measured = MeasuredPictures::of(&limits);
        for file in &files {
            let found = measured.measure(file.clone(), read(file)).unwrap().unwrap();
            let expected = [0.8, 0.2, 0.2, 0.8];
            let is_near = |(a, b): (&f64, f64)| (a - b).abs() < 1e-6;
            let is_so = found.mean.iter().zip(expected).all(is_near);
            assert!(is_so && found.has_alpha, "{}: {found:?}", file.display());
        }
        let opaque = saved(folder, "rgb.png", |picture| picture.into_rgb8().into());
        let found = measured.measure(opaque.clone(), read(&opaque)).unwrap();
        assert!(!found.unwrap().has_alpha);
        let missing = folder.join("none.png");
        let found = measured.measure(missing.clone(), read(&missing)).unwrap();
        assert_eq!(found, None);
    }

    #[test]
    fn a_picture_is_decoded_once_and_its_memory_given_back() {
        let folder = tempfile::tempdir().unwrap();
        let file = saved(folder.path(), "a.png", |picture| picture);
        // Enough for one of them at a time.
        let limits = Limits {
            memory: Budget::of(5000),
            ..Limits::default()
        };
        let mut measured = MeasuredPictures::of(&limits);
        let first = measured.measure(0, read(&file)).unwrap();
        assert_eq!(measured.measure(1, read(&file)).unwrap(), first);
        let again = measured.measure(0, |_| panic!("it is known"));
        assert_eq!(again.unwrap(), first);
        limits.memory.claim(4000).unwrap();
        let error = measured.measure(2, read(&file)).unwrap_err();
        assert!(error.problem.is_of_memory(), "{error}");
    }
}
