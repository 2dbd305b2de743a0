//! A cube of six pictures, as a sky is given in, as the panorama that the tracer reads.

use super::texture_data::{Converted, TextureFault, trace_texture};
use crate::trace::{Texels, Texture, direction_at};
use bevy::image::Image;
use bevy::math::{Vec2, Vec3};
use rayon::prelude::*;
use wgpu_types::{Extent3d, TextureDataOrder, TextureDimension};

/// Columns that a panorama has at most.
const MOST_COLUMNS: u32 = 4096;
/// And at the least, so that the sides of a cube of single colours do not run into each other far.
const LEAST_COLUMNS: u32 = 64;

/// Whether it is six pictures of the same size, one upon the other.
pub(super) fn is_cube(image: &Image) -> bool {
    let descriptor = &image.texture_descriptor;
    let size = descriptor.size;
    descriptor.dimension == TextureDimension::D2
        && size.depth_or_array_layers == 6
        && size.width == size.height
}

/// The panorama of a cube, as fine as its sides are along the horizon: towards +X, -X, +Y, -Y, +Z and -Z
/// as graphics cards have them, with Bevy's z, which is the other way round.
pub(super) fn trace_cube(image: &Image) -> Result<Converted, TextureFault> {
    let Converted { texture, replaced } = trace_texture(&stacked(image)?)?;
    let side = texture.width();
    let width = side.saturating_mul(4).clamp(LEAST_COLUMNS, MOST_COLUMNS);
    let height = width / 2;
    let mut texels = vec![[0.0; 3]; width as usize * height as usize];
    let rows = texels.par_chunks_mut(width as usize).enumerate();
    rows.for_each(|(y, row)| {
        for (x, texel) in row.iter_mut().enumerate() {
            let place = Vec2::new(
                (x as f32 + 0.5) / width as f32,
                (y as f32 + 0.5) / height as f32,
            );
            *texel = towards(&texture, side, direction_at(place, 0.0)).into();
        }
    });
    let texture = Texture::new(width, height, Texels::Linear32(texels));
    Ok(Converted {
        texture: texture.map_err(|error| TextureFault::Broken(error.to_string()))?,
        replaced,
    })
}

/// The largest level of the six pictures as one, below each other.
fn stacked(image: &Image) -> Result<Image, TextureFault> {
    let descriptor = &image.texture_descriptor;
    let data = image.data.as_deref().ok_or(TextureFault::NoData)?;
    let side = descriptor.size.width;
    let levels = descriptor.mip_level_count;
    let texel = descriptor.format.block_copy_size(None);
    let texel = texel.ok_or(TextureFault::Format(descriptor.format))? as usize;
    let bytes = |level: u32| ((side >> level).max(1) as usize).pow(2) * texel;
    let picture = bytes(0);
    let apart = match image.data_order {
        TextureDataOrder::MipMajor => picture,
        TextureDataOrder::LayerMajor => (0..levels.max(1)).map(bytes).sum(),
    };
    let pictures = data.chunks(apart.max(1)).take(6);
    let pictures = pictures.filter_map(|all| all.get(..picture));
    let mut stacked = Image::new_uninit(
        Extent3d {
            width: side,
            height: side.saturating_mul(6),
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        descriptor.format,
        image.asset_usage,
    );
    stacked.texture_descriptor.label = descriptor.label;
    stacked.data = Some(pictures.flatten().copied().collect());
    Ok(stacked)
}

/// What a cube shows in a direction, between the four texels around it on its side.
fn towards(stacked: &Texture, side: u32, direction: Vec3) -> Vec3 {
    let Vec3 { x, y, z } = direction * Vec3::new(1.0, 1.0, -1.0);
    let size = Vec3::new(x, y, z).abs();
    // Which side, and where on it: to the right and down.
    let (number, right, down, depth) = if size.x >= size.y.max(size.z) {
        match x > 0.0 {
            true => (0, -z, -y, size.x),
            false => (1, z, -y, size.x),
        }
    } else if size.y >= size.z {
        match y > 0.0 {
            true => (2, x, z, size.y),
            false => (3, x, -z, size.y),
        }
    } else {
        match z > 0.0 {
            true => (4, x, -y, size.z),
            false => (5, -x, -y, size.z),
        }
    };
    let last = (side - 1) as f32;
    let place = |along: f32| {
        let texel = (0.5 * (along / depth + 1.0) * side as f32 - 0.5).clamp(0.0, last);
        let first = texel.floor();
        let next = (first + 1.0).min(last);
        ([first as u32, next as u32], texel - first)
    };
    let (columns, across) = place(right);
    let (rows, below) = place(down);
    let row = |y: u32| {
        let [a, b] = columns.map(|x| stacked.texel(x, number * side + y, false));
        a.lerp(b, across)
    };
    row(rows[0]).lerp(row(rows[1]), below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::Environment;
    use bevy::asset::RenderAssetUsages;
    use std::sync::Arc;
    use wgpu_types::TextureFormat;

    /// A cube of one colour a side, its red the side's number, and of as many levels.
    fn cube(side: u32, levels: u32, order: TextureDataOrder) -> Image {
        let size = Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: 6,
        };
        let format = TextureFormat::Rgba32Float;
        let usage = RenderAssetUsages::MAIN_WORLD;
        let mut image = Image::new_uninit(size, TextureDimension::D2, format, usage);
        image.texture_descriptor.mip_level_count = levels;
        image.data_order = order;
        let texels = |number: u32, level: u32| {
            // Smaller levels are of another colour, which is never to be seen.
            let red = if level == 0 { number as f32 } else { 99.0 };
            let count = ((side >> level).max(1) as usize).pow(2);
            [red, 0.5, 0.0, 1.0]
                .map(f32::to_ne_bytes)
                .concat()
                .repeat(count)
        };
        let pairs = |number: u32| (0..levels).map(move |level| (number, level));
        let mut all: Vec<(u32, u32)> = (0..6).flat_map(pairs).collect();
        if order == TextureDataOrder::MipMajor {
            all.sort_by_key(|&(number, level)| (level, number));
        }
        image.data = Some(all.into_iter().flat_map(|(n, l)| texels(n, l)).collect());
        image
    }

    fn seen(image: &Image, direction: Vec3) -> f32 {
        let environment = Environment {
            map: Some(Arc::new(trace_cube(image).unwrap().texture)),
            intensity: 1.0,
            ..Environment::default()
        };
        environment.radiance(direction).x
    }

    #[test]
    fn each_side_of_a_cube_is_seen_where_bevy_shows_it_in_whatever_order_its_levels_lie() {
        let order = [TextureDataOrder::LayerMajor, TextureDataOrder::MipMajor];
        for (levels, order) in [(1, order[0]), (4, order[0]), (4, order[1])] {
            let image = cube(8, levels, order);
            // Behind is the side towards +Z: a cube's z is the other way round.
            let sides = [
                Vec3::X,
                Vec3::NEG_X,
                Vec3::Y,
                Vec3::NEG_Y,
                Vec3::NEG_Z,
                Vec3::Z,
            ];
            let found = sides.map(|direction| seen(&image, direction));
            assert_eq!(
                found,
                [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
                "{levels} levels, {order:?}"
            );
        }
    }

    #[test]
    fn a_side_is_neither_mirrored_nor_turned() {
        let mut image = cube(2, 1, TextureDataOrder::LayerMajor);
        // The side straight ahead: from the left, from above.
        let reds = [10.0_f32, 20.0, 30.0, 40.0];
        let data = image.data.as_mut().unwrap();
        for (i, red) in reds.into_iter().enumerate() {
            let place = (4 * 4 + i) * 16;
            data[place..place + 4].copy_from_slice(&red.to_ne_bytes());
        }
        let corners = [(-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let found = corners.map(|(x, y)| seen(&image, Vec3::new(0.5 * x, 0.5 * y, -1.0)));
        for (found, wanted) in found.into_iter().zip(reds) {
            // The panorama's texels are a tenth of this side.
            assert!((found - wanted).abs() < 2.0, "{found}, not {wanted}");
        }
    }

    #[test]
    fn a_cube_that_lacks_sides_or_pixels_is_refused() {
        let mut short = cube(4, 1, TextureDataOrder::LayerMajor);
        short.data.as_mut().unwrap().truncate(4 * 4 * 16 * 5);
        let refused = |image: &Image| trace_cube(image).unwrap_err();
        assert!(matches!(refused(&short), TextureFault::Broken(_)));
        short.data = None;
        assert_eq!(refused(&short), TextureFault::NoData);
        let empty = cube(0, 1, TextureDataOrder::LayerMajor);
        assert!(matches!(refused(&empty), TextureFault::Broken(_)));
    }
}
