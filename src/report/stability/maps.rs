//! Cases of pictures: what they hold, and where they shall lie.

use super::scenes::{object, once, quad, world};
use super::{Effort, Outcome};
use crate::app::headless_app;
use crate::film::render;
use crate::io::{check_picture, check_room};
use crate::report::table::digits;
use crate::scene::{
    EnvironmentMap, Features, Phong, PhongMap, PhongMaps, RenderSettings, SceneId, TextureFilter,
};
use crate::sync::Traced;
use crate::trace::{Camera, Environment, Map, Material, Mesh, Texels, Texture};
use bevy::asset::{Assets, RenderAssetUsages};
use bevy::image::Image;
use glam::{UVec2, Vec2, Vec3};
use std::sync::Arc;
use wgpu_types::{Extent3d, TextureDimension, TextureFormat};

/// A disc of white leaves; what is transparent is black.
fn leaf(size: u32) -> Vec<[u8; 4]> {
    let middle = size as f32 / 2.0;
    let texel = |i: u32| {
        let offset = Vec2::new((i % size) as f32, (i / size) as f32) + 0.5 - middle;
        let edge = middle * (0.6 + 0.3 * (5.0 * offset.y.atan2(offset.x)).cos());
        if offset.length() < edge {
            [255; 4]
        } else {
            [0; 4]
        }
    };
    (0..size * size).map(texel).collect()
}

pub(super) fn cut_outs(effort: &Effort) -> Outcome {
    let corners = quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
    let (instance, mut square) = object(1, &corners, Vec::new(), 0);
    square.mesh = Arc::new(Mesh {
        uvs: corners
            .map(|corner| (corner.truncate() + 1.0) / 2.0)
            .to_vec(),
        ..Mesh::of(square.mesh.tree.clone())
    });
    let material = Material {
        diffuse: Vec3::ONE,
        maps: vec![
            Map {
                is_cut_out: true,
                ..Map::new(PhongMap::Diffuse, 0)
            },
            Map::new(PhongMap::Opacity, 0),
        ],
        ..Material::default()
    };
    let mut scene = world(vec![(instance, square)], vec![material]);
    scene.textures = Texture::new(64, 64, Texels::Srgb8(leaf(64)))
        .map(|texture| Arc::new(vec![Arc::new(texture)]))
        .unwrap_or_default();
    scene.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    let scene = scene.with_needs();
    let from = Vec3::new(0.4, 0.3, 3.0);
    let camera = Camera::looking_at(from, Vec3::ZERO, Vec3::Y, 0.8);
    let largest = if effort.rays > 1_000_000 { 800 } else { 100 };
    let (mut counted, mut worst) = (0, 0.0_f32);
    for texture_filter in [TextureFilter::Bilinear, TextureFilter::Mipmap] {
        for side in [largest, 60, 20, 5] {
            let settings = RenderSettings {
                size: UVec2::splat(side),
                texture_filter,
                features: Features {
                    shading: false,
                    ..Features::default()
                },
                ..once()
            };
            let picture = render(&scene, &camera, &settings, &|_, _| {}).picture;
            let off = |pixel: &Vec3| (*pixel - 1.0).abs().max_element();
            worst = worst.max(picture.pixels.iter().map(off).fold(0.0, f32::max));
            counted += picture.pixels.len();
        }
    }
    let figures = format!("at most {} off white", digits(f64::from(worst), 2));
    Outcome::new(counted, figures).require(worst < 1e-6, format!("{worst} off white"))
}

/// A picture of floats, four channels a texel.
fn floats(width: u32, texels: &[f32]) -> Image {
    Image::new(
        Extent3d {
            width,
            height: texels.len() as u32 / (4 * width),
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        texels.iter().flat_map(|c| c.to_ne_bytes()).collect(),
        TextureFormat::Rgba32Float,
        RenderAssetUsages::MAIN_WORLD,
    )
}

pub(super) fn not_light(_: &Effort) -> Outcome {
    let wrong = [f32::INFINITY, f32::NAN, -5.0, f32::NEG_INFINITY];
    let texels: Vec<f32> = wrong.iter().flat_map(|&c| [c, 0.5, 0.5, 1.0]).collect();
    let mut app = headless_app();
    // A map of an app's own comes after what files say of it.
    app.update();
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let environment = images.add(floats(4, &texels));
    let wrong_map = |images: &mut Assets<Image>| Some(images.add(floats(4, &texels)));
    let maps = PhongMaps {
        diffuse: wrong_map(&mut images),
        specular: wrong_map(&mut images),
        mirror: wrong_map(&mut images),
        emission: wrong_map(&mut images),
        normal: wrong_map(&mut images),
        opacity: Some(images.add(floats(1, &[f32::NAN; 4]))),
    };
    app.insert_resource(EnvironmentMap(Some(environment)));
    let mesh = crate::scene::MeshSource::Shape(crate::scene::Shape::default());
    let transform = bevy::transform::components::Transform::default();
    app.world_mut()
        .spawn((SceneId(1), mesh, Phong::default(), maps, transform));
    app.update();
    let traced = app.world().resource::<Traced>();
    let notes: Vec<String> = traced.problems.iter().map(ToString::to_string).collect();
    let counts = [
        ("4 texels", "diffuse"),
        ("4 texels", "specular"),
        ("4 texels", "mirror"),
        ("4 texels", "emission"),
        ("4 texels", "normal"),
        ("1 texels", "opacity"),
        ("4 texels", "its map"),
    ];
    let told = counts.iter().all(|(count, map)| {
        let mut notes = notes.iter();
        notes.any(|note| note.contains(count) && note.contains(map))
    });
    let (mut least, mut most, mut finite) = (f32::INFINITY, 0.0_f32, true);
    let around = (0..64_u8).map(|i| f32::from(i) / 64.0 * std::f32::consts::TAU);
    for angle in around.clone() {
        let light = traced
            .world
            .environment
            .radiance(Vec3::new(angle.cos(), 0.1, angle.sin()));
        finite &= light.is_finite();
        (least, most) = (least.min(light.x), most.max(light.x));
    }
    let mut others_are_0 = true;
    for texture in traced.world.textures.iter() {
        for filter in [TextureFilter::Bilinear, TextureFilter::Mipmap] {
            for u in around.clone() {
                let uv = Vec2::new(u, 0.5);
                let color = texture.sample(uv, 0.3, filter, false);
                let opacity = texture.opacity(uv, 0.3, filter);
                finite &= color.is_finite() && opacity.is_finite() && color.min_element() >= 0.0;
            }
        }
        let texel = |i: u8| {
            let uv = Vec2::new((f32::from(i) + 0.5) / 4.0, 0.5);
            texture.sample(uv, 0.0, TextureFilter::Nearest, false).x
        };
        others_are_0 &= [1, 2, 3].iter().all(|&i| texel(i) == 0.0);
        most = most.max(texel(0));
    }
    let figures = format!(
        "{} notes; light from {} to {}",
        notes.len(),
        digits(f64::from(least), 2),
        digits(f64::from(most), 2)
    );
    Outcome::new(25, figures)
        .require(
            told && notes.len() == counts.len(),
            format!("{} notes: {}", notes.len(), notes.join("; ")),
        )
        .require(
            finite,
            "a texel that is not finite, or less than 0, is read",
        )
        .require(others_are_0, "NaN or a negative number is not 0")
        .require(
            least >= 0.0 && (most / f32::MAX.sqrt() - 1.0).abs() < 1e-6,
            format!("infinite is {most:e}"),
        )
}

pub(super) fn unwritable(_: &Effort) -> Outcome {
    let folder = std::env::temp_dir();
    let a_file = std::env::current_exe().unwrap_or_default();
    let beyond = [
        (folder.join("glassbox.jpg"), 65_536, 1),
        (folder.join("glassbox.jpeg"), 1, 65_536),
        (folder.join("glassbox.png"), 65_537, 1),
        (folder.join("glassbox.exr"), 65_536, 65_536),
        (folder.join("glassbox.bmp"), 1, 1),
        (folder.join("glassbox"), 1, 1),
        (folder.join("glassbox-no-such-folder").join("a.png"), 1, 1),
        (folder.clone(), 1, 1),
        (folder.join("glassbox.png/"), 1, 1),
        // A file as if it were a folder.
        (a_file.join("a.png"), 1, 1),
    ];
    let passed: Vec<String> = beyond
        .iter()
        .filter(|(file, width, height)| check_picture(file, *width, *height).is_ok())
        .map(|(file, width, height)| format!("{} {width}x{height}", file.display()))
        .collect();
    let fits = [
        ("jpg", 65_535),
        ("png", 65_536),
        ("exr", 65_536),
        ("hdr", 65_536),
    ];
    let refused: Vec<String> = fits
        .iter()
        .filter_map(|(extension, width)| {
            let file = folder.join(format!("glassbox.{extension}"));
            Some(check_picture(&file, *width, 1).err()?.to_string())
        })
        .collect();
    // More than any disk has, and next to nothing.
    let [vast, small] = [u64::MAX, 1].map(|bytes| check_room(&folder.join("glassbox.png"), bytes));
    let (space, is_told) = match &vast {
        Ok(_) => ("its disk does not tell its space".to_owned(), true),
        Err(error) => {
            let text = error.to_string();
            let is_told = text.contains("are free on its disk");
            (format!("no space for 16 EB: “{text}”"), is_told)
        }
    };
    let figures = format!(
        "{} of {} refused, {} of {} allowed, without a ray; {space}",
        beyond.len() - passed.len(),
        beyond.len(),
        fits.len() - refused.len(),
        fits.len()
    );
    Outcome::new(beyond.len() + fits.len() + 2, figures)
        .require(passed.is_empty(), passed.join(", "))
        .require(refused.is_empty(), refused.join("; "))
        .require(is_told, space)
        .require(small.is_ok(), "a byte is refused")
}
