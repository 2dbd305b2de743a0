//! How a texture's pixels are kept.

use super::srgb;
use glam::Vec3;

/// The pixels of a texture, row by row from the top: as the file had them, so that a large map stays
/// small.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8 bits a channel, sRGB-encoded, RGBA.
    Srgb8(Vec<[u8; 4]>),
    /// 8 bits a channel, linear, RGBA.
    Linear8(Vec<[u8; 4]>),
    /// 16 bits a channel, sRGB-encoded, RGBA.
    Srgb16(Vec<[u16; 4]>),
    /// 16 bits a channel, linear, RGBA.
    Linear16(Vec<[u16; 4]>),
    /// Linear floating point, opaque.
    Linear32(Vec<[f32; 3]>),
    /// Linear floating point and alpha.
    LinearAlpha32(Vec<[f32; 4]>),
}

impl Texels {
    /// How many.
    pub(in crate::trace) fn len(&self) -> usize {
        match self {
            Self::Srgb8(t) | Self::Linear8(t) => t.len(),
            Self::Srgb16(t) | Self::Linear16(t) => t.len(),
            Self::Linear32(t) => t.len(),
            Self::LinearAlpha32(t) => t.len(),
        }
    }

    /// Linear RGB of one; `raw` leaves sRGB values as they are.
    #[inline]
    pub(super) fn rgb(&self, i: usize, raw: bool) -> Vec3 {
        match self {
            Self::Srgb8(t) if !raw => {
                let table = srgb::decode_table();
                Vec3::new(
                    table[t[i][0] as usize],
                    table[t[i][1] as usize],
                    table[t[i][2] as usize],
                )
            }
            Self::Srgb8(t) | Self::Linear8(t) => {
                Vec3::new(t[i][0] as f32, t[i][1] as f32, t[i][2] as f32) / 255.0
            }
            Self::Linear32(t) => Vec3::from(t[i]),
            Self::Srgb16(t) if !raw => {
                let table = srgb::decode_table_16();
                let [r, g, b, _] = t[i].map(|c| table[usize::from(c)]);
                Vec3::new(r, g, b)
            }
            Self::Srgb16(t) | Self::Linear16(t) => {
                Vec3::new(t[i][0] as f32, t[i][1] as f32, t[i][2] as f32) / 65535.0
            }
            Self::LinearAlpha32(t) => {
                let [r, g, b, _] = t[i];
                Vec3::new(r, g, b)
            }
        }
    }

    /// Alpha of one in [0, 1].
    #[inline]
    pub(in crate::trace) fn alpha(&self, i: usize) -> f32 {
        match self {
            Self::Srgb8(t) | Self::Linear8(t) => t[i][3] as f32 / 255.0,
            Self::Srgb16(t) | Self::Linear16(t) => t[i][3] as f32 / 65535.0,
            Self::Linear32(_) => 1.0,
            Self::LinearAlpha32(t) => t[i][3],
        }
    }

    /// Floating-point colours as sRGB in 16 bits, for those that once were. Others stay as they are.
    pub fn into_srgb_16(self) -> Self {
        let encoded = |rgb: [f32; 3]| rgb.map(|c| sixteen_bits(srgb::encode(c)));
        match self {
            Self::Linear32(t) => {
                let opaque = |[r, g, b]: [u16; 3]| [r, g, b, u16::MAX];
                Self::Srgb16(t.into_iter().map(|rgb| opaque(encoded(rgb))).collect())
            }
            Self::LinearAlpha32(t) => {
                let texels = t.into_iter().map(|[red, green, blue, alpha]| {
                    let [r, g, b] = encoded([red, green, blue]);
                    [r, g, b, sixteen_bits(alpha)]
                });
                Self::Srgb16(texels.collect())
            }
            other => other,
        }
    }

    /// Whether every alpha is 1.
    pub(super) fn are_opaque(&self) -> bool {
        match self {
            Self::Srgb8(t) | Self::Linear8(t) => t.iter().all(|texel| texel[3] == u8::MAX),
            Self::Srgb16(t) | Self::Linear16(t) => t.iter().all(|texel| texel[3] == u16::MAX),
            Self::Linear32(_) => true,
            Self::LinearAlpha32(t) => t.iter().all(|texel| texel[3] == 1.0),
        }
    }

    /// The same colours with other alphas in [0, 1], as many as there are texels, in the precision of
    /// the colours.
    pub(super) fn with_alpha(&self, alphas: impl Iterator<Item = f32>) -> Self {
        fn replaced<T: Copy>(
            texels: &[[T; 4]],
            alphas: impl Iterator<Item = f32>,
            kept: impl Fn(f32) -> T,
        ) -> Vec<[T; 4]> {
            let pairs = texels.iter().zip(alphas);
            pairs
                .map(|(&[r, g, b, _], alpha)| [r, g, b, kept(alpha)])
                .collect()
        }
        match self {
            Self::Srgb8(t) => Self::Srgb8(replaced(t, alphas, eight_bits)),
            Self::Linear8(t) => Self::Linear8(replaced(t, alphas, eight_bits)),
            Self::Srgb16(t) => Self::Srgb16(replaced(t, alphas, sixteen_bits)),
            Self::Linear16(t) => Self::Linear16(replaced(t, alphas, sixteen_bits)),
            Self::LinearAlpha32(t) => Self::LinearAlpha32(replaced(t, alphas, |alpha| alpha)),
            Self::Linear32(t) => {
                let pairs = t.iter().zip(alphas);
                Self::LinearAlpha32(pairs.map(|(&[r, g, b], a)| [r, g, b, a]).collect())
            }
        }
    }
}

/// The nearest of 256 values.
pub(super) fn eight_bits(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// The nearest of 65,536 values.
pub(super) fn sixteen_bits(value: f32) -> u16 {
    (value * 65535.0).round() as u16
}
