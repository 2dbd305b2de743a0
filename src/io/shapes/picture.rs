//! The pictures behind `builtin:` names: made by code, so that a scene needs no file.

use bevy::asset::RenderAssetUsages;
use bevy::image::Image;
use bevy::math::{DVec2, DVec3, Vec3};
use image::{DynamicImage, Rgba, Rgba32FImage, RgbaImage};
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// A `builtin:` name that names no picture.
#[derive(Error, Debug, Clone, PartialEq)]
#[error("`{name}` is no generated picture; there are {}", NAMES.join(", "))]
pub struct PictureError {
    /// What was asked for.
    pub name: String,
}

/// The generated pictures.
pub const NAMES: [&str; 3] = ["builtin:checker", "builtin:uv", "builtin:sky"];

/// Pixels of a side of the two square pictures.
const SIDE: u32 = 512;
/// Pixels of the sky.
const SKY: [u32; 2] = [1024, 512];

/// Where the sun of `builtin:sky` stands, of any length: to the left behind a camera that looks along -Z.
pub const SUN: DVec3 = DVec3::new(-0.62, 0.60, 0.50);

/// The picture of a name with its prefix: `builtin:checker` (8 × 8 squares) and `builtin:uv` (a
/// colour for every place, a grid of eighths) as 8-bit sRGB; `builtin:sky` as linear radiance in
/// `f32`, equirectangular, +Y up, its middle column at -Z and +X to the right of it.
pub fn texture(name: &str) -> Result<Image, PictureError> {
    let (picture, is_srgb) = match name {
        "builtin:checker" => (square(checker), true),
        "builtin:uv" => (square(places), true),
        "builtin:sky" => (sky(), false),
        _ => return Err(PictureError { name: name.into() }),
    };
    let usage = RenderAssetUsages::default();
    Ok(Image::from_dynamic(picture, is_srgb, usage))
}

fn square(color: fn(DVec2) -> [u8; 3]) -> DynamicImage {
    DynamicImage::ImageRgba8(RgbaImage::from_fn(SIDE, SIDE, |x, y| {
        let at = (DVec2::new(x.into(), y.into()) + 0.5) / f64::from(SIDE);
        let [r, g, b] = color(at);
        Rgba([r, g, b, 255])
    }))
}

fn checker(at: DVec2) -> [u8; 3] {
    let cell = (at * 8.0).floor();
    match (cell.x + cell.y) % 2.0 == 0.0 {
        true => [238, 232, 220],
        false => [112, 124, 142],
    }
}

/// Red grows with u, green towards the top, a grid marks eighths, and a white square the origin of
/// v-up coordinates: a texture that lies mirrored or upside down shows it.
fn places(at: DVec2) -> [u8; 3] {
    let in_cell = (at * 8.0).fract();
    let to_line = in_cell.min(1.0 - in_cell).min_element();
    let cell = (at * 8.0).floor();
    if to_line < 0.04 {
        return [30, 30, 34];
    }
    if cell == DVec2::new(0.0, 7.0) {
        return [250, 250, 250];
    }
    let lift = if (cell.x + cell.y) % 2.0 == 0.0 {
        40.0
    } else {
        0.0
    };
    let color = DVec3::new(50.0 + 165.0 * at.x, 50.0 + 165.0 * (1.0 - at.y), 110.0);
    (color + lift).to_array().map(|x| x as u8)
}

fn sky() -> DynamicImage {
    let [width, height] = SKY;
    DynamicImage::ImageRgba32F(Rgba32FImage::from_fn(width, height, |x, y| {
        let [r, g, b] = sky_radiance(direction_of(x, y)).to_array();
        Rgba([r, g, b, 1.0])
    }))
}

/// The direction in which a texel of the sky is seen.
fn direction_of(x: u32, y: u32) -> DVec3 {
    let [width, height] = SKY.map(f64::from);
    let azimuth = TAU * ((f64::from(x) + 0.5) / width - 0.5);
    let elevation = PI * (0.5 - (f64::from(y) + 0.5) / height);
    let (up, across) = elevation.sin_cos();
    DVec3::new(azimuth.sin() * across, up, -azimuth.cos() * across)
}

/// Radiance from a direction: a function of the direction alone, so that the map has no seam and
/// its poles are one colour.
fn sky_radiance(direction: DVec3) -> Vec3 {
    let up = direction.y;
    let zenith = DVec3::new(0.07, 0.19, 0.52);
    let haze = DVec3::new(0.50, 0.63, 0.82);
    let ground = DVec3::new(0.20, 0.185, 0.17);
    let mut color = haze.lerp(zenith, up.max(0.0).powf(0.5));
    if up > 0.0 {
        // Clouds hang in a plane and fade before they crowd together at the horizon.
        let at = DVec2::new(direction.x, direction.z) / (up + 0.12) * 1.4;
        let cover = smooth_step(0.50, 0.78, clouds(at)) * smooth_step(0.02, 0.30, up);
        color = color.lerp(DVec3::splat(1.05), 0.85 * cover);
    }
    let towards_sun = direction.dot(SUN.normalize()).max(0.0);
    color += DVec3::new(1.0, 0.85, 0.62)
        * (14.0 * towards_sun.powf(3000.0)
            + 0.9 * towards_sun.powf(60.0)
            + 0.25 * towards_sun.powf(6.0));
    let below = smooth_step(0.015, -0.03, up);
    let ground = haze.lerp(ground, smooth_step(-0.02, 0.22, -up));
    color.lerp(ground, below).as_vec3()
}

/// Five octaves of value noise, in [0, 1].
fn clouds(at: DVec2) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for octave in 0..5 {
        let (scale, weight) = (f64::from(1 << octave), 0.5_f64.powi(octave));
        sum += weight * noise(at * scale + f64::from(octave) * 17.3);
        weights += weight;
    }
    sum / weights
}

/// Random values at whole coordinates, smooth between them, in [0, 1].
fn noise(at: DVec2) -> f64 {
    let corner = at.floor();
    let t = at - corner;
    let t = t * t * (3.0 - 2.0 * t);
    let value = |dx: f64, dy: f64| {
        let [x, y] = [corner.x + dx, corner.y + dy].map(|c| c as i32 as u32);
        let mut bits = x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841);
        // The finaliser of MurmurHash3 (A. Appleby).
        bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
        bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
        f64::from(bits ^ (bits >> 16)) / f64::from(u32::MAX)
    };
    let lower = value(0.0, 0.0) * (1.0 - t.x) + value(1.0, 0.0) * t.x;
    let upper = value(0.0, 1.0) * (1.0 - t.x) + value(1.0, 1.0) * t.x;
    lower * (1.0 - t.y) + upper * t.y
}

/// 0 at `from`, 1 at `to`, level at both.
fn smooth_step(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_its_picture_and_no_other_has() {
        for name in NAMES {
            let image = texture(name).unwrap();
            let texels = (image.width() * image.height()) as usize;
            let bytes = image.data.as_ref().unwrap().len();
            let per_texel = if name == "builtin:sky" { 16 } else { 4 };
            assert_eq!(bytes, texels * per_texel, "{name}");
        }
        let error = texture("builtin:chequer").unwrap_err().to_string();
        assert!(error.contains("builtin:checker"), "{error}");
    }

    #[test]
    fn the_sky_has_no_seam_and_its_poles_are_one_colour() {
        let DynamicImage::ImageRgba32F(sky) = sky() else {
            panic!("the sky is not 32-bit");
        };
        let [width, height] = SKY;
        let apart = |a: (u32, u32), b: (u32, u32)| {
            let (a, b) = (sky.get_pixel(a.0, a.1), sky.get_pixel(b.0, b.1));
            (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max)
        };
        let seam = (0..height)
            .map(|y| apart((0, y), (width - 1, y)))
            .fold(0.0, f32::max);
        let inside = (0..height)
            .map(|y| apart((width / 4, y), (width / 4 + 1, y)))
            .fold(0.0, f32::max);
        assert!(
            seam < 2.0 * inside + 0.01,
            "seam {seam}, elsewhere {inside}"
        );
        for y in [0, height - 1] {
            let pole = (0..width)
                .map(|x| apart((0, y), (x, y)))
                .fold(0.0, f32::max);
            assert!(pole < 0.02, "pole {y}: {pole}");
        }
        assert!(
            sky.pixels()
                .all(|p| p.0.iter().all(|x| x.is_finite() && *x >= 0.0))
        );
    }

    #[test]
    fn the_sun_lamps_of_scenes_come_from_where_the_sky_is_brightest() {
        let DynamicImage::ImageRgba32F(sky) = sky() else {
            panic!("the sky is not 32-bit");
        };
        let brightest = sky
            .enumerate_pixels()
            .max_by(|a, b| a.2[0].total_cmp(&b.2[0]))
            .map(|(x, y, _)| direction_of(x, y));
        let angle = brightest.unwrap().angle_between(SUN).to_degrees();
        assert!(angle < 0.5, "{angle} degrees apart");
    }
}
