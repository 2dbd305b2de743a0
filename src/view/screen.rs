//! What stands on the screen of a view: its picture, and the depth of what was traced, so that
//! gizmos are hidden by what they stand behind. The renderer draws it in [`screen_pass`](super::screen_pass).

use bevy::asset::{Handle, RenderAssetUsages};
use bevy::camera::Projection;
use bevy::image::{Image, ImageSampler, TextureFormatPixelInfo};
use bevy::math::{UVec2, Vec3};
use bevy::prelude::Component;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

/// What a view shows. A camera without it shows nothing that was traced.
#[derive(Component, Clone, Debug, PartialEq)]
#[component(clone_behavior = Ignore)]
pub(super) struct Screen {
    /// Encoded for the screen.
    pub picture: Handle<Image>,
    /// Metres along the view axis.
    pub depth: Handle<Image>,
    /// Left of this part of the viewport's width the picture is not drawn.
    pub divider: f32,
    /// What turns metres into the depth that is written: [`depth_numbers`].
    pub numbers: Vec3,
    /// The picture has its pixels' shape until one of the view's new size is there; else it fills the view, whatever its size.
    pub keeps_shape: bool,
}

/// How many times as wide as a picture a view is that is as high, where the picture was clearly made for another view; 1
/// where it was made for this one, up to pixels that are rounded.
pub(super) fn widening(view: UVec2, picture: UVec2) -> f32 {
    let aspect = view.x as f32 / view.y as f32;
    let wanted = picture.y as f32 * aspect;
    let is_other = (wanted - picture.x as f32).abs() > 2.0 + aspect;
    if is_other {
        wanted / picture.x as f32
    } else {
        1.0
    }
}

/// Bytes in RGBA, as they go to the screen.
pub(super) fn picture_image(width: u32, height: u32, bytes: Vec<u8>) -> Image {
    image(width, height, bytes, TextureFormat::Rgba8UnormSrgb)
}

/// Metres along the view axis, one number a pixel.
pub(super) fn depth_image(width: u32, height: u32, depths: &[f32]) -> Image {
    let bytes = depths.iter().flat_map(|d| d.to_ne_bytes()).collect();
    image(width, height, bytes, TextureFormat::R32Float)
}

/// As far as anything is, until depths have been traced.
pub(super) fn no_depth() -> Image {
    depth_image(1, 1, &[f32::MAX])
}

fn image(width: u32, height: u32, bytes: Vec<u8>, format: TextureFormat) -> Image {
    debug_assert_eq!(
        bytes.len(),
        (width * height) as usize * format.pixel_size().unwrap_or(0),
    );
    let size = Extent3d {
        width,
        height,
        depth_or_array_layers: 1,
    };
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new(size, TextureDimension::D2, bytes, format, usage);
    // Pixels are pixels: a coarse preview and a zoomed one show what they are.
    image.sampler = ImageSampler::nearest();
    image
}

/// With `m` metres along the view axis, Bevy's reversed depth is `x / m + y - z · m`.
pub(super) fn depth_numbers(projection: &Projection) -> Vec3 {
    match projection {
        Projection::Orthographic(p) => {
            let length = p.far - p.near;
            Vec3::new(0.0, p.far / length, 1.0 / length)
        }
        Projection::Perspective(p) => Vec3::new(p.near, 0.0, 0.0),
        Projection::Custom(_) => Vec3::new(0.1, 0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::camera::{OrthographicProjection, PerspectiveProjection};

    #[test]
    fn a_picture_of_the_view_before_is_as_high_in_the_new_one_and_not_stretched() {
        let whole = UVec2::new(1080, 822);
        assert_eq!(widening(whole, UVec2::new(540, 822)), 2.0);
        assert_eq!(widening(UVec2::new(540, 822), whole), 0.5);
        for pixel_size in 1..40 {
            assert_eq!(widening(whole, whole / pixel_size), 1.0, "{pixel_size}");
        }
    }

    #[test]
    fn metres_become_the_depth_that_bevys_own_projections_give() {
        let perspective = PerspectiveProjection {
            near: 0.2,
            ..PerspectiveProjection::default()
        };
        let orthographic = OrthographicProjection {
            near: -3.0,
            far: 70.0,
            ..OrthographicProjection::default_3d()
        };
        let projections = [
            Projection::Perspective(perspective),
            Projection::Orthographic(orthographic),
        ];
        for projection in projections {
            let numbers = depth_numbers(&projection);
            for metres in [0.5, 2.0, 30.0] {
                let clip = projection.get_clip_from_view();
                let wanted = clip.project_point3(Vec3::NEG_Z * metres).z;
                let depth = numbers.x / metres + numbers.y - numbers.z * metres;
                let off = (depth - wanted).abs();
                assert!(off < 1e-6, "{metres} m: {depth}, not {wanted}");
            }
        }
    }
}
