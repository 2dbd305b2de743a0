//! A Bevy image as the tracer keeps it.

use crate::trace::{Texels, Texture};
use bevy::image::Image;
use wgpu_types::{TextureDimension, TextureFormat};

/// Why an image cannot be a texture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TextureFault {
    /// The asset is not there: not loaded yet, failed to load, or removed.
    #[error("is not loaded")]
    Missing,
    /// The component names a file, and nothing loaded it.
    #[error("`{0}` was not loaded")]
    Unresolved(String),
    /// The renderer took the pixels away, or there never were any.
    #[error("has no pixels in main memory; give its asset RenderAssetUsages::MAIN_WORLD too")]
    NoData,
    /// A cube, a volume, or an array of pictures.
    #[error("is not a single flat picture")]
    NotFlat,
    /// Pixels of a kind that is not read.
    #[error(
        "has pixels of the format {0:?}, which is not read; use 8, 16 or 32 bits a channel, uncompressed"
    )]
    Format(TextureFormat),
    /// The size and the data do not fit.
    #[error("is broken: {0}")]
    Broken(String),
}

/// The first level of the picture. Which formats hold sRGB and which linear values, their names say.
pub(super) fn trace_texture(image: &Image) -> Result<Texture, TextureFault> {
    let descriptor = &image.texture_descriptor;
    let flat =
        descriptor.dimension == TextureDimension::D2 && descriptor.size.depth_or_array_layers == 1;
    if !flat {
        return Err(TextureFault::NotFlat);
    }
    let data = image.data.as_deref().ok_or(TextureFault::NoData)?;
    let (width, height) = (image.width(), image.height());
    let texels = texels(
        descriptor.format,
        data,
        u64::from(width) * u64::from(height),
    )?;
    Texture::new(width, height, texels).map_err(|error| TextureFault::Broken(error.to_string()))
}

fn texels(format: TextureFormat, data: &[u8], count: u64) -> Result<Texels, TextureFault> {
    // Smaller versions of the picture may follow it.
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let bytes = |data: &'_ [u8]| -> Vec<[u8; 4]> {
        data.as_chunks().0.iter().copied().take(count).collect()
    };
    let swap = |[b, g, r, a]: [u8; 4]| [r, g, b, a];
    Ok(match format {
        TextureFormat::Rgba8UnormSrgb => Texels::Srgb8(bytes(data)),
        TextureFormat::Rgba8Unorm => Texels::Linear8(bytes(data)),
        TextureFormat::Bgra8UnormSrgb => Texels::Srgb8(bytes(data).into_iter().map(swap).collect()),
        TextureFormat::Bgra8Unorm => Texels::Linear8(bytes(data).into_iter().map(swap).collect()),
        // One channel is grey; two are grey and alpha, as Bevy's PNG loader has them.
        TextureFormat::R8Unorm => {
            Texels::Linear8(data.iter().take(count).map(|&g| [g, g, g, 255]).collect())
        }
        TextureFormat::Rg8Unorm => {
            let pairs = data.as_chunks().0.iter().take(count);
            Texels::Linear8(pairs.map(|&[g, a]| [g, g, g, a]).collect())
        }
        TextureFormat::R16Unorm => floats(data, count, |[g]: [u16; 1]| [unit(g); 3]),
        TextureFormat::Rgba16Unorm => {
            floats(data, count, |[r, g, b, _]: [u16; 4]| [r, g, b].map(unit))
        }
        TextureFormat::R32Float => wide(data, count, |[g]: [f32; 1]| [g; 3]),
        TextureFormat::Rgba32Float => wide(data, count, |[r, g, b, _]: [f32; 4]| [r, g, b]),
        TextureFormat::Rgba16Float => {
            floats(data, count, |[r, g, b, _]: [u16; 4]| [r, g, b].map(half))
        }
        other => return Err(TextureFault::Format(other)),
    })
}

/// Texels of `N` channels of two bytes each. What is not finite becomes black: one such texel
/// would spread over the picture.
fn floats<const N: usize>(
    data: &[u8],
    count: usize,
    color: impl Fn([u16; N]) -> [f32; 3],
) -> Texels {
    let words: Vec<u16> = data
        .as_chunks()
        .0
        .iter()
        .map(|&b| u16::from_ne_bytes(b))
        .collect();
    let texels = words.as_chunks().0.iter().take(count);
    Texels::Linear32(texels.map(|&texel| finite(color(texel))).collect())
}

/// Texels of `N` channels of four bytes each.
fn wide<const N: usize>(data: &[u8], count: usize, color: impl Fn([f32; N]) -> [f32; 3]) -> Texels {
    let words: Vec<f32> = data
        .as_chunks()
        .0
        .iter()
        .map(|&b| f32::from_ne_bytes(b))
        .collect();
    let texels = words.as_chunks().0.iter().take(count);
    Texels::Linear32(texels.map(|&texel| finite(color(texel))).collect())
}

fn finite(color: [f32; 3]) -> [f32; 3] {
    color.map(|c| if c.is_finite() { c } else { 0.0 })
}

/// 16 bits as a fraction of their largest value.
fn unit(value: u16) -> f32 {
    f32::from(value) / f32::from(u16::MAX)
}

/// IEEE 754 binary16: a sign, 5 bits of exponent, 10 of fraction.
fn half(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let fraction = f32::from(bits & 0x3ff) / 1024.0;
    sign * match exponent {
        0 => fraction * 2f32.powi(-14),
        31 => f32::INFINITY,
        _ => (1.0 + fraction) * 2f32.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::asset::RenderAssetUsages;
    use wgpu_types::Extent3d;

    fn image(format: TextureFormat, width: u32, data: Vec<u8>) -> Image {
        let mut image = Image::new_uninit(
            Extent3d {
                width,
                height: 1,
                depth_or_array_layers: 1,
            },
            TextureDimension::D2,
            format,
            RenderAssetUsages::MAIN_WORLD,
        );
        image.data = Some(data);
        image
    }

    fn first(format: TextureFormat, data: Vec<u8>) -> [f32; 3] {
        trace_texture(&image(format, 1, data))
            .unwrap()
            .texel(0, 0, true)
            .into()
    }

    #[test]
    fn every_format_that_is_read_gives_its_channels_in_order() {
        let rgb = [51.0 / 255.0, 102.0 / 255.0, 204.0 / 255.0];
        assert_eq!(
            first(TextureFormat::Rgba8UnormSrgb, vec![51, 102, 204, 9]),
            rgb
        );
        assert_eq!(first(TextureFormat::Rgba8Unorm, vec![51, 102, 204, 9]), rgb);
        assert_eq!(first(TextureFormat::Bgra8Unorm, vec![204, 102, 51, 9]), rgb);
        assert_eq!(
            first(TextureFormat::Bgra8UnormSrgb, vec![204, 102, 51, 9]),
            rgb
        );
        assert_eq!(first(TextureFormat::R8Unorm, vec![255]), [1.0; 3]);
        assert_eq!(first(TextureFormat::Rg8Unorm, vec![255, 3]), [1.0; 3]);
        let floats = |v: &[f32]| v.iter().flat_map(|x| x.to_ne_bytes()).collect::<Vec<u8>>();
        let wide = floats(&[7.5, 0.25, f32::NAN, 1.0]);
        assert_eq!(first(TextureFormat::Rgba32Float, wide), [7.5, 0.25, 0.0]);
        assert_eq!(first(TextureFormat::R32Float, floats(&[2.0])), [2.0; 3]);
        let words = |v: &[u16]| v.iter().flat_map(|x| x.to_ne_bytes()).collect::<Vec<u8>>();
        let halves = words(&[0x3c00, 0xc100, 0x0001, 0]);
        assert_eq!(
            first(TextureFormat::Rgba16Float, halves),
            [1.0, -2.5, 2f32.powi(-24)]
        );
        let units = words(&[0xffff, 0, 0xffff, 0]);
        assert_eq!(first(TextureFormat::Rgba16Unorm, units), [1.0, 0.0, 1.0]);
    }

    #[test]
    fn only_srgb_formats_are_decoded() {
        let decoded = |format| {
            let texture = trace_texture(&image(format, 1, vec![188, 188, 188, 255])).unwrap();
            texture.texel(0, 0, false).x
        };
        assert!((decoded(TextureFormat::Rgba8UnormSrgb) - 0.5029).abs() < 1e-3);
        assert_eq!(decoded(TextureFormat::Rgba8Unorm), 188.0 / 255.0);
    }

    #[test]
    fn an_image_that_is_no_flat_readable_picture_is_refused_with_the_reason() {
        let format = TextureFormat::Bc1RgbaUnorm;
        let compressed = image(format, 4, vec![0; 8]);
        assert_eq!(
            trace_texture(&compressed).unwrap_err(),
            TextureFault::Format(format)
        );
        let mut gone = image(TextureFormat::Rgba8Unorm, 1, vec![0; 4]);
        gone.data = None;
        assert_eq!(trace_texture(&gone).unwrap_err(), TextureFault::NoData);
        let mut layers = image(TextureFormat::Rgba8Unorm, 1, vec![0; 8]);
        layers.texture_descriptor.size.depth_or_array_layers = 2;
        assert_eq!(trace_texture(&layers).unwrap_err(), TextureFault::NotFlat);
        let short = image(TextureFormat::Rgba8Unorm, 4, vec![0; 8]);
        assert!(matches!(
            trace_texture(&short).unwrap_err(),
            TextureFault::Broken(_)
        ));
    }
}
