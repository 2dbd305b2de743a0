//! The sRGB curve (IEC 61966-2-1).

use std::sync::OnceLock;

/// Linear to encoded, for a value in [0, 1].
pub fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Encoded to linear, for each of the 256 values of a byte.
pub fn decode_table() -> &'static [f32; 256] {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    TABLE.get_or_init(|| std::array::from_fn(|i| decode(i as f64 / 255.0)))
}

/// Encoded to linear, for each of the 65,536 values of two bytes.
pub fn decode_table_16() -> &'static [f32] {
    static TABLE: OnceLock<Vec<f32>> = OnceLock::new();
    TABLE.get_or_init(|| {
        (0..=u16::MAX)
            .map(|i| decode(f64::from(i) / 65535.0))
            .collect()
    })
}

fn decode(c: f64) -> f32 {
    let linear = if c <= 0.04045 {
        c / 12.92
    } else {
        ((c + 0.055) / 1.055).powf(2.4)
    };
    linear as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_undoes_decoding() {
        for (i, &linear) in decode_table().iter().enumerate() {
            let back = encode(linear) * 255.0;
            assert!((back - i as f32).abs() < 1e-3, "{i} becomes {back}");
        }
        for (i, &linear) in decode_table_16().iter().enumerate() {
            let back = encode(linear) * 65535.0;
            // Far from the half at which it would be another of them.
            assert!((back - i as f32).abs() < 0.1, "{i} becomes {back}");
        }
    }
}
