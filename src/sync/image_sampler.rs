//! How an app's own picture says that it is read: by its sampler, where it has one.

use crate::scene::{MapFilter, TextureSource, Wrap};
use bevy::image::{Image, ImageAddressMode, ImageFilterMode, ImageSampler};

/// As a source without a path says it. A border of a colour, which no map has, is the outermost pixels.
pub(super) fn sampler_of(image: &Image) -> TextureSource {
    let ImageSampler::Descriptor(sampler) = &image.sampler else {
        return TextureSource::default();
    };
    let wrap = |mode| match mode {
        ImageAddressMode::Repeat => Wrap::Repeat,
        ImageAddressMode::MirrorRepeat => Wrap::Mirror,
        ImageAddressMode::ClampToEdge | ImageAddressMode::ClampToBorder => Wrap::Clamp,
    };
    TextureSource {
        path: String::new(),
        wrap_u: wrap(sampler.address_mode_u),
        wrap_v: wrap(sampler.address_mode_v),
        filter: match sampler.mag_filter {
            ImageFilterMode::Nearest => MapFilter::Nearest,
            ImageFilterMode::Linear => MapFilter::Linear,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::image::ImageSamplerDescriptor;

    #[test]
    fn a_sampler_says_how_a_picture_wraps_and_none_that_it_repeats() {
        let mut image = Image::default();
        assert_eq!(sampler_of(&image), TextureSource::default());
        image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
            address_mode_u: ImageAddressMode::MirrorRepeat,
            address_mode_v: ImageAddressMode::ClampToEdge,
            mag_filter: ImageFilterMode::Nearest,
            ..ImageSamplerDescriptor::default()
        });
        let expected = TextureSource {
            path: String::new(),
            wrap_u: Wrap::Mirror,
            wrap_v: Wrap::Clamp,
            filter: MapFilter::Nearest,
        };
        assert_eq!(sampler_of(&image), expected);
    }
}
