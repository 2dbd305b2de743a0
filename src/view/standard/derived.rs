//! What is made of an app's pictures: the mean of one, and the alpha of one as a picture of its own.

use bevy::asset::{AssetEvent, AssetId, Assets, Handle, RenderAssetUsages};
use bevy::image::Image;
use bevy::platform::collections::HashMap;
use bevy::prelude::{DetectChangesMut, MessageReader, ResMut, Resource};
use bevy::render::render_resource::TextureFormat;

/// Kept by the picture that they were made of, until that is edited.
#[derive(Resource, Default)]
pub(super) struct DerivedPictures {
    /// Of red, green and blue, in [0, 1]; `None` where the picture is not there or cannot be read.
    means: HashMap<AssetId<Image>, Option<[f32; 3]>>,
    /// `None` where nothing of it is transparent, or it is not there.
    alphas: HashMap<AssetId<Image>, Option<Handle<Image>>>,
}

#[cfg(test)]
impl DerivedPictures {
    /// How many are kept.
    pub fn kept(&self) -> usize {
        self.means.len() + self.alphas.len()
    }
}

/// Pictures that were edited, loaded or removed say something else.
pub(super) fn forget_edited(
    mut events: MessageReader<AssetEvent<Image>>,
    mut derived: ResMut<DerivedPictures>,
) {
    let mut any = false;
    for event in events.read() {
        if let AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } =
            event
        {
            let known = derived.bypass_change_detection();
            any |= known.means.remove(id).is_some() | known.alphas.remove(id).is_some();
        }
    }
    if any {
        // Materials that use them are mapped again.
        derived.set_changed();
    }
}

/// The pictures, for one material.
pub(super) struct Pictures<'a> {
    pub images: &'a mut Assets<Image>,
    pub derived: &'a mut DerivedPictures,
}

impl Pictures<'_> {
    /// The mean of the first level, as its numbers are.
    pub fn mean(&mut self, picture: &Handle<Image>) -> Option<[f32; 3]> {
        let images = &*self.images;
        let mean = || mean(images.get(picture)?);
        *(self.derived.means.entry(picture.id())).or_insert_with(mean)
    }

    /// A picture as bright as this one is opaque.
    pub fn alpha(&mut self, picture: &Handle<Image>) -> Option<Handle<Image>> {
        if let Some(known) = self.derived.alphas.get(&picture.id()) {
            return known.clone();
        }
        let alpha = self.images.get(picture).and_then(alpha);
        let alpha = alpha.map(|image| self.images.add(image));
        self.derived.alphas.insert(picture.id(), alpha.clone());
        alpha
    }
}

/// Four bytes a pixel, where it has so many.
fn bytes(image: &Image) -> Option<&[[u8; 4]]> {
    let is_plain = matches!(
        image.texture_descriptor.format,
        TextureFormat::Rgba8Unorm | TextureFormat::Rgba8UnormSrgb
    );
    let pixels = image.width() as usize * image.height() as usize;
    let data = image.data.as_ref().filter(|_| is_plain)?;
    data.as_chunks().0.get(..pixels)
}

fn mean(image: &Image) -> Option<[f32; 3]> {
    let pixels = f64::from(image.width()) * f64::from(image.height());
    let mut sums = [0.0_f64; 3];
    if let Some(bytes) = bytes(image) {
        for pixel in bytes {
            for (sum, &channel) in sums.iter_mut().zip(pixel) {
                *sum += f64::from(channel) / 255.0;
            }
        }
    } else {
        for y in 0..image.height() {
            for x in 0..image.width() {
                let color = image.get_color_at(x, y).ok()?.to_srgba();
                let color = [color.red, color.green, color.blue];
                for (sum, channel) in sums.iter_mut().zip(color) {
                    *sum += f64::from(channel);
                }
            }
        }
    }
    (pixels > 0.0).then(|| sums.map(|sum| (sum / pixels) as f32))
}

fn alpha(image: &Image) -> Option<Image> {
    let alphas: Vec<u8> = match bytes(image) {
        Some(bytes) => bytes.iter().map(|pixel| pixel[3]).collect(),
        None => {
            let (width, height) = (image.width(), image.height());
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let alpha = |(x, y)| {
                let color = image.get_color_at(x, y).ok()?;
                Some((bevy::color::Alpha::alpha(&color).clamp(0.0, 1.0) * 255.0).round() as u8)
            };
            places.map(alpha).collect::<Option<_>>()?
        }
    };
    if alphas.iter().all(|alpha| *alpha == 255) {
        return None;
    }
    let descriptor = &image.texture_descriptor;
    let mut picture = Image::new(
        descriptor.size,
        descriptor.dimension,
        alphas,
        TextureFormat::R8Unorm,
        RenderAssetUsages::MAIN_WORLD,
    );
    picture.sampler = image.sampler.clone();
    Some(picture)
}
