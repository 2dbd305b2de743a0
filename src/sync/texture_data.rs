//! A Bevy image as the tracer keeps it.

use crate::scene::SRGB_16_BITS;
use crate::trace::{Texels, Texture};
use bevy::asset::RenderAssetUsages;
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
        "has pixels of the format {0:?}, which is not read; use 8, 16 or 32 bits a channel, or Rgb9e5Ufloat, uncompressed"
    )]
    Format(TextureFormat),
    /// The size and the data do not fit.
    #[error("is broken: {0}")]
    Broken(String),
}

/// What a texel of 32 bits that is infinite, or larger than this, counts as: 2^64. A film limits a sample
/// to 2^40, so none can be told from brighter ones; and sums of texels, and their products with an
/// intensity, stay finite.
const LARGEST: f32 = (1_u128 << 64) as f32;
/// The same for 16 bits: the largest finite number that they hold.
const LARGEST_HALF: f32 = 65504.0;

/// A picture as the tracer keeps it.
#[derive(Debug)]
pub(super) struct Converted {
    pub texture: Texture,
    /// Texels with a channel that could not be taken as it was.
    pub replaced: Replaced,
}

/// Texels of a picture that light cannot have, and what is read instead: 0 for what is no number or less
/// than 0, the largest number for what is infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Replaced {
    /// How many.
    pub count: u64,
    /// The largest number.
    pub largest: f32,
}

/// The first level of the picture. Which formats hold sRGB and which linear values, their names say;
/// but for what carries the label [`SRGB_16_BITS`].
pub(super) fn trace_texture(image: &Image) -> Result<Converted, TextureFault> {
    let descriptor = &image.texture_descriptor;
    let flat =
        descriptor.dimension == TextureDimension::D2 && descriptor.size.depth_or_array_layers == 1;
    if !flat {
        return Err(TextureFault::NotFlat);
    }
    // Said at once, and not when an edit asks for pixels that are gone by then.
    if !image.asset_usage.contains(RenderAssetUsages::MAIN_WORLD) {
        return Err(TextureFault::NoData);
    }
    let data = image.data.as_deref().ok_or(TextureFault::NoData)?;
    let (width, height) = (image.width(), image.height());
    let (texels, replaced) = texels(
        descriptor.format,
        data,
        u64::from(width) * u64::from(height),
    )?;
    let texels = match texels {
        Texels::Linear32(_) | Texels::LinearAlpha32(_)
            if descriptor.label == Some(SRGB_16_BITS) =>
        {
            texels.into_srgb_16()
        }
        texels => texels,
    };
    let texture = Texture::new(width, height, texels);
    Ok(Converted {
        texture: texture.map_err(|error| TextureFault::Broken(error.to_string()))?,
        replaced,
    })
}

fn texels(
    format: TextureFormat,
    data: &[u8],
    count: u64,
) -> Result<(Texels, Replaced), TextureFault> {
    // Smaller versions of the picture may follow it.
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let bytes = |data: &'_ [u8]| -> Vec<[u8; 4]> {
        data.as_chunks().0.iter().copied().take(count).collect()
    };
    let swap = |[b, g, r, a]: [u8; 4]| [r, g, b, a];
    let numbers = match format {
        TextureFormat::Rgba8UnormSrgb => Texels::Srgb8(bytes(data)),
        TextureFormat::Rgba8Unorm => Texels::Linear8(bytes(data)),
        TextureFormat::Bgra8UnormSrgb => Texels::Srgb8(bytes(data).into_iter().map(swap).collect()),
        TextureFormat::Bgra8Unorm => Texels::Linear8(bytes(data).into_iter().map(swap).collect()),
        // One channel is grey; two are grey and alpha, as Bevy's PNG loader has them. It calls 16 bits
        // whole numbers then, where it means parts of 1.
        TextureFormat::R8Unorm => {
            Texels::Linear8(data.iter().take(count).map(|&g| [g, g, g, 255]).collect())
        }
        TextureFormat::Rg8Unorm => {
            let pairs = data.as_chunks().0.iter().take(count);
            Texels::Linear8(pairs.map(|&[g, a]| [g, g, g, a]).collect())
        }
        TextureFormat::R16Unorm | TextureFormat::R16Uint => {
            sixteen(data, count, |[g]: [u16; 1]| [g, g, g, u16::MAX])
        }
        TextureFormat::Rg16Unorm | TextureFormat::Rg16Uint => {
            sixteen(data, count, |[g, a]: [u16; 2]| [g, g, g, a])
        }
        TextureFormat::Rgba16Unorm | TextureFormat::Rgba16Uint => sixteen(data, count, |t| t),
        TextureFormat::R16Float => {
            let grey = |[g]: [u16; 1]| [half(g), half(g), half(g), 1.0];
            return Ok(floats(&words(data), count, LARGEST_HALF, grey));
        }
        TextureFormat::Rgba16Float => {
            let color = |texel: [u16; 4]| texel.map(half);
            return Ok(floats(&words(data), count, LARGEST_HALF, color));
        }
        TextureFormat::R32Float => {
            let grey = |[g]: [f32; 1]| [g, g, g, 1.0];
            return Ok(floats(&wide_words(data), count, LARGEST, grey));
        }
        TextureFormat::Rgba32Float => {
            return Ok(floats(&wide_words(data), count, LARGEST, |texel| texel));
        }
        TextureFormat::Rgb9e5Ufloat => {
            let words: Vec<u32> = (data.as_chunks().0.iter())
                .map(|&b| u32::from_ne_bytes(b))
                .collect();
            return Ok(floats(&words, count, LARGEST, shared_exponent));
        }
        other => return Err(TextureFault::Format(other)),
    };
    Ok((numbers, Replaced::default()))
}

fn words(data: &[u8]) -> Vec<u16> {
    let words = data.as_chunks().0.iter();
    words.map(|&b| u16::from_ne_bytes(b)).collect()
}

fn wide_words(data: &[u8]) -> Vec<f32> {
    let words = data.as_chunks().0.iter();
    words.map(|&b| f32::from_ne_bytes(b)).collect()
}

/// Texels of `N` channels of 16 bits each.
fn sixteen<const N: usize>(
    data: &[u8],
    count: usize,
    color: impl Fn([u16; N]) -> [u16; 4],
) -> Texels {
    let words = words(data);
    let texels = words.as_chunks().0.iter().take(count);
    Texels::Linear16(texels.map(|&texel| color(texel)).collect())
}

/// Texels of `N` floating-point channels each. What light cannot have is replaced: one such texel would
/// spread over the picture.
fn floats<T: Copy, const N: usize>(
    words: &[T],
    count: usize,
    largest: f32,
    color: impl Fn([T; N]) -> [f32; 4],
) -> (Texels, Replaced) {
    let texels = || words.as_chunks().0.iter().take(count).map(|&t| color(t));
    let number = |channel: f32, most: f32| {
        if channel > 0.0 {
            channel.min(most)
        } else {
            0.0
        }
    };
    let mend = |[r, g, b, a]: [f32; 4]| {
        let [r, g, b] = [r, g, b].map(|channel| number(channel, largest));
        [r, g, b, number(a, 1.0)]
    };
    let is_wrong = |[r, g, b, a]: [f32; 4]| {
        let color = [r, g, b]
            .iter()
            .any(|channel| !(0.0..=largest).contains(channel));
        color || !(a >= 0.0 && a.is_finite())
    };
    let replaced = Replaced {
        count: texels().filter(|&texel| is_wrong(texel)).count() as u64,
        largest,
    };
    let opaque = texels().all(|texel| texel[3] >= 1.0);
    let texels = texels().map(mend);
    let kept = if opaque {
        Texels::Linear32(texels.map(|[r, g, b, _]| [r, g, b]).collect())
    } else {
        Texels::LinearAlpha32(texels.collect())
    };
    (kept, replaced)
}

/// IEEE 754 binary16: a sign, 5 bits of exponent, 10 of fraction.
fn half(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from(bits >> 10 & 0x1f);
    let fraction = f32::from(bits & 0x3ff) / 1024.0;
    sign * match exponent {
        0 => fraction * 2f32.powi(-14),
        31 if fraction > 0.0 => f32::NAN,
        31 => f32::INFINITY,
        _ => (1.0 + fraction) * 2f32.powi(exponent - 15),
    }
}

/// Three times 9 bits, red lowest, and above them the exponent that they share, with a bias of 15: a
/// channel is its 9 bits · 2^(e - 24) (Vulkan's specification, "RGB to shared exponent conversion").
fn shared_exponent([word]: [u32; 1]) -> [f32; 4] {
    let scale = 2f32.powi((word >> 27) as i32 - 24);
    let channel = |at: u32| (word >> at & 0x1ff) as f32 * scale;
    [channel(0), channel(9), channel(18), 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let converted = trace_texture(&image(format, 1, data)).unwrap();
        converted.texture.texel(0, 0, true).into()
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
        let halves = words(&[0x3c00, 0x4100, 0x0001, 0]);
        assert_eq!(
            first(TextureFormat::Rgba16Float, halves),
            [1.0, 2.5, 2f32.powi(-24)]
        );
        // 256, 64 and 511, all of them times 2^(16 - 24).
        let shared = 16_u32 << 27 | 511 << 18 | 64 << 9 | 256;
        assert_eq!(
            first(TextureFormat::Rgb9e5Ufloat, shared.to_ne_bytes().to_vec()),
            [1.0, 0.25, 511.0 / 256.0]
        );
        let units = words(&[0xffff, 0, 0xffff, 0]);
        assert_eq!(first(TextureFormat::Rgba16Unorm, units), [1.0, 0.0, 1.0]);
        for format in [TextureFormat::R16Unorm, TextureFormat::R16Uint] {
            assert_eq!(first(format, words(&[0xffff])), [1.0; 3]);
        }
        for format in [TextureFormat::Rg16Unorm, TextureFormat::Rg16Uint] {
            assert_eq!(first(format, words(&[0xffff, 3])), [1.0; 3]);
        }
    }

    fn opacity(format: TextureFormat, data: Vec<u8>) -> f32 {
        let converted = trace_texture(&image(format, 1, data)).unwrap();
        let nearest = crate::scene::TextureFilter::Nearest;
        converted
            .texture
            .opacity(bevy::math::Vec2::ZERO, 0.0, nearest)
    }

    #[test]
    fn alpha_is_kept_in_16_bits_and_in_floating_point() {
        let words = |v: &[u16]| v.iter().flat_map(|x| x.to_ne_bytes()).collect::<Vec<u8>>();
        let most = u16::MAX;
        let alpha = 1234.0 / 65535.0;
        let color = words(&[most, most, most, 1234]);
        assert_eq!(opacity(TextureFormat::Rgba16Unorm, color), alpha);
        assert_eq!(
            opacity(TextureFormat::Rg16Uint, words(&[most, 1234])),
            alpha
        );
        assert_eq!(opacity(TextureFormat::R16Unorm, words(&[1234])), alpha);
        let floats = [1.0_f32, 1.0, 1.0, 0.3].map(f32::to_ne_bytes);
        assert_eq!(
            opacity(TextureFormat::Rgba32Float, floats.as_flattened().to_vec()),
            0.3
        );
        let halves = words(&[0x3c00, 0x3c00, 0x3c00, 0x3400]);
        assert_eq!(opacity(TextureFormat::Rgba16Float, halves), 0.25);
    }

    #[test]
    fn colours_that_were_srgb_in_16_bits_come_back_as_they_were() {
        let all: Vec<u16> = (0..=u16::MAX).step_by(17).collect();
        let table = crate::trace::srgb::decode_table_16();
        let floats = all
            .iter()
            .flat_map(|&c| [table[usize::from(c)]; 3].into_iter().chain([1.0]));
        let data = floats.flat_map(f32::to_ne_bytes).collect();
        let mut image = image(TextureFormat::Rgba32Float, all.len() as u32, data);
        image.texture_descriptor.label = Some(SRGB_16_BITS);
        let texture = trace_texture(&image).unwrap().texture;
        for (x, &value) in all.iter().enumerate() {
            let raw = texture.texel(x as u32, 0, true).x;
            assert_eq!(raw, f32::from(value) / 65535.0);
            assert_eq!(
                texture.texel(x as u32, 0, false).x,
                table[usize::from(value)]
            );
        }
    }

    #[test]
    fn what_light_cannot_have_is_replaced_and_counted_by_texels() {
        let (inf, nan) = (f32::INFINITY, f32::NAN);
        let texels = [
            [inf, 1.0, -0.0, 1.0],
            [nan, -5.0, inf, 1.0],
            [f32::MAX, 0.0, 0.0, 1.0],
            [1.0, 2.0, 3.0, 1.0],
            [-inf, 0.0, 0.0, 1.0],
        ];
        let data = texels.as_flattened().iter().flat_map(|c| c.to_ne_bytes());
        let wide = image(TextureFormat::Rgba32Float, 5, data.collect());
        let Converted { texture, replaced } = trace_texture(&wide).unwrap();
        assert_eq!((replaced.count, replaced.largest), (4, LARGEST));
        let found: Vec<[f32; 3]> = (0..5).map(|x| texture.texel(x, 0, false).into()).collect();
        assert_eq!(
            found,
            [
                [LARGEST, 1.0, 0.0],
                [0.0, 0.0, LARGEST],
                [LARGEST, 0.0, 0.0],
                [1.0, 2.0, 3.0],
                [0.0; 3]
            ]
        );
        let halves = [0x7c00_u16, 0x7e00, 0xbc00, 0x7e00];
        let data = halves.iter().flat_map(|c| c.to_ne_bytes()).collect();
        let one = trace_texture(&image(TextureFormat::Rgba16Float, 1, data)).unwrap();
        assert_eq!(one.replaced.count, 1);
        assert_eq!(
            one.texture.texel(0, 0, false).to_array(),
            [65504.0, 0.0, 0.0]
        );
    }

    #[test]
    fn a_map_of_the_largest_numbers_stays_finite_however_it_is_filtered() {
        use crate::scene::TextureFilter;
        use bevy::math::Vec2;
        let data = vec![f32::INFINITY; 4 * 7]
            .into_iter()
            .flat_map(f32::to_ne_bytes);
        let wide = image(TextureFormat::Rgba32Float, 7, data.collect());
        let texture = trace_texture(&wide).unwrap().texture;
        for filter in [TextureFilter::Bilinear, TextureFilter::Mipmap] {
            for footprint in [0.0, 0.2, 0.5, 1.0] {
                let at = |i: u8| {
                    let uv = Vec2::splat(f32::from(i) * 0.01);
                    texture.sample(uv, footprint, filter, false).x
                };
                let worst = (0..100)
                    .map(|i| (at(i) / LARGEST - 1.0).abs())
                    .fold(0.0, f32::max);
                assert!(worst < 1e-5, "{filter:?}, {footprint}: {worst}");
            }
        }
    }

    #[test]
    fn only_srgb_formats_are_decoded() {
        let decoded = |format| {
            let converted = trace_texture(&image(format, 1, vec![188, 188, 188, 255]));
            converted.unwrap().texture.texel(0, 0, false).x
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
