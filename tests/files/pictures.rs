//! What pictures hold, from the file to what rays read.

use super::app::write;
use bevy::app::App;
use bevy::color::LinearRgba;
use bevy::math::UVec2;
use glassbox::app::headless_app;
use glassbox::film::render;
use glassbox::io::{OpenOptions, SceneSource, open};
use glassbox::scene::{Environment, Features, RenderSettings, TextureFilter, TextureSource};
use glassbox::sync::{Traced, TracedCameras};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb, Rgb32FImage, Rgba};
use std::path::{Path, PathBuf};

/// A square of 2 m whose material has these lines; the picture appears upright on it.
fn square(folder: &Path, material: &str) -> PathBuf {
    write(folder, "a.mtl", format!("newmtl a\n{material}\n"));
    let text = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n\
                vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n";
    write(folder, "a.obj", text)
}

fn traced(file: &Path) -> App {
    let mut app = headless_app();
    let source = SceneSource::File(file.to_path_buf());
    let opened = open(app.world_mut(), &source, OpenOptions::default());
    opened.unwrap_or_else(|error| panic!("{error}"));
    app.update();
    app
}

fn problems(app: &App) -> Vec<String> {
    let problems = &app.world().resource::<Traced>().problems;
    problems.iter().map(ToString::to_string).collect()
}

/// The farthest from 1 that any pixel is, where nothing is shaded and the background is 1.
fn farthest_from_white(app: &mut App, filter: TextureFilter) -> f32 {
    app.world_mut().insert_resource(Environment {
        background: LinearRgba::WHITE,
        ..Environment::default()
    });
    app.update();
    let world = app.world().resource::<Traced>().world.clone();
    let camera = app.world().resource::<TracedCameras>().0[0].camera.clone();
    let mut worst = 0.0_f32;
    for side in [200, 23] {
        let settings = RenderSettings {
            size: UVec2::splat(side),
            spp: 1,
            texture_filter: filter,
            features: Features {
                shading: false,
                ..Features::default()
            },
            ..RenderSettings::default()
        };
        let picture = render(&world, &camera, &settings, &|_, _| {}).picture;
        let off = |pixel: &bevy::math::Vec3| (*pixel - 1.0).abs().max_element();
        worst = worst.max(picture.pixels.iter().map(off).fold(0.0, f32::max));
    }
    worst
}

/// White inside of a ring of leaves, black outside.
fn is_leaf(x: u32, y: u32, size: u32) -> bool {
    let middle = size as f32 / 2.0;
    let (x, y) = (x as f32 + 0.5 - middle, y as f32 + 0.5 - middle);
    x.hypot(y) < middle * (0.6 + 0.3 * (5.0 * y.atan2(x)).cos())
}

#[test]
fn a_white_cut_out_over_white_has_no_outline() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let leaf = |size, alpha: bool| {
        ImageBuffer::from_fn(size, size, |x, y| match is_leaf(x, y, size) {
            true => Rgba([255_u8; 4]),
            false => Rgba([0, 0, 0, if alpha { 0 } else { 255 }]),
        })
    };
    leaf(64, true).save(path.join("leaf.png")).unwrap();
    leaf(64, false).save(path.join("color.png")).unwrap();
    leaf(64, false).save(path.join("mask.png")).unwrap();
    for material in [
        "map_Kd leaf.png\nmap_d leaf.png",
        "map_Kd color.png\nmap_d mask.png",
    ] {
        for filter in [TextureFilter::Bilinear, TextureFilter::Mipmap] {
            let worst = farthest_from_white(&mut traced(&square(path, material)), filter);
            assert!(worst < 1e-6, "{material}, {filter:?}: {worst} off");
        }
    }
}

/// 64 values of which 8 bits can tell 3.
fn level(x: u32) -> u16 {
    12_345 + 8 * x as u16
}

#[test]
fn a_16_bit_picture_keeps_its_levels_as_colour_and_as_opacity() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let most = u16::MAX;
    let kinds: [(&str, DynamicImage); 4] = [
        (
            "grey",
            ImageBuffer::from_fn(64, 1, |x, _| Luma([level(x)])).into(),
        ),
        (
            "grey with alpha",
            ImageBuffer::from_fn(64, 1, |x, _| LumaA([level(x), most])).into(),
        ),
        (
            "colour",
            ImageBuffer::from_fn(64, 1, |x, _| Rgb([level(x); 3])).into(),
        ),
        (
            "colour with alpha",
            ImageBuffer::from_fn(64, 1, |x, _| Rgba([level(x), 0, 0, most])).into(),
        ),
    ];
    for (kind, picture) in kinds {
        picture.save(path.join("a.png")).unwrap();
        for map in ["map_Kd", "map_d"] {
            let app = traced(&square(path, &format!("{map} a.png")));
            let world = &app.world().resource::<Traced>().world;
            for x in 0..64 {
                let found = world.textures[0].texel(x, 0, true).x;
                let expected = f32::from(level(x)) / f32::from(most);
                assert_eq!(found, expected, "{kind}, {map}, level {x}");
            }
        }
    }
}

#[test]
fn a_16_bit_alpha_keeps_its_levels() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let picture = ImageBuffer::from_fn(64, 1, |x, _| LumaA([u16::MAX, level(x)]));
    DynamicImage::from(picture)
        .save(path.join("a.png"))
        .unwrap();
    for source in ["a.png", "a.png#alpha"] {
        let mut app = traced(&square(path, "map_d a.png"));
        let mut materials = app.world_mut().query::<&mut glassbox::scene::Phong>();
        for mut phong in materials.iter_mut(app.world_mut()) {
            if phong.opacity_map.is_some() {
                phong.opacity_map = Some(TextureSource::new(source));
            }
        }
        app.update();
        let world = &app.world().resource::<Traced>().world;
        for x in 0..64 {
            let uv = bevy::math::Vec2::new((x as f32 + 0.5) / 64.0, 0.5);
            let found = world.textures[0].opacity(uv, 0.0, TextureFilter::Nearest);
            assert_eq!(found, f32::from(level(x)) / 65535.0, "{source}, level {x}");
        }
    }
}

#[test]
fn what_light_cannot_have_is_noted_once_for_each_picture_whatever_it_is_used_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let wrong = [f32::NAN, f32::INFINITY, -5.0, f32::NEG_INFINITY];
    let picture = Rgb32FImage::from_fn(4, 2, |x, y| match y {
        0 => Rgb([0.5, wrong[x as usize], 0.5]),
        _ => Rgb([0.5; 3]),
    });
    picture.save(path.join("a.exr")).unwrap();
    picture.save(path.join("b.exr")).unwrap();
    let text = "map_Kd a.exr\nnewmtl b\nmap_Kd a.exr\nmap_d b.exr";
    let file = square(path, text);
    let more = "usemtl b\nf 1/1 2/2 3/3\n";
    std::fs::write(&file, std::fs::read_to_string(&file).unwrap() + more).unwrap();
    let mut app = traced(&file);
    let found = problems(&app);
    // Colours and numbers are two pictures.
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(
        found[0].contains("4 texels of its diffuse map"),
        "{}",
        found[0]
    );
    assert!(
        found[1].contains("4 texels of its opacity map"),
        "{}",
        found[1]
    );
    let picture = |app: &mut App, path: &str| {
        app.world_mut().resource_mut::<Environment>().map = Some(TextureSource::new(path));
        app.update();
        problems(app)
    };
    assert_eq!(picture(&mut app, "a.exr").len(), 2, "told already");
    let one = Rgb32FImage::from_pixel(1, 1, Rgb([f32::NAN; 3]));
    one.save(path.join("one.exr")).unwrap();
    let found = picture(&mut app, "one.exr");
    assert!(
        found[2].starts_with("environment 0: 1 texels of its map"),
        "{found:#?}"
    );
    let environment = &app.world().resource::<Traced>().world.environment;
    assert_eq!(
        environment.radiance(bevy::math::Vec3::X).to_array(),
        [0.0; 3]
    );
}

/// The colour of the picture's upper left texel, as the tracer reads it.
fn first_texel(folder: &Path, name: &str) -> [f32; 3] {
    let app = traced(&square(folder, &format!("map_Kd {name}")));
    let world = &app.world().resource::<Traced>().world;
    world.textures[0].texel(0, 0, true).into()
}

/// 4x4 texels in two blocks of DXT1's form: the first colour of both everywhere (Microsoft's "DDS_HEADER").
fn dds(color: u16) -> Vec<u8> {
    let mut words = [0_u32; 31];
    (words[0], words[1], words[2], words[3]) = (124, 0x0008_1007, 4, 4);
    (words[4], words[18], words[19]) = (8, 32, 4);
    words[20] = u32::from_le_bytes(*b"DXT1");
    words[26] = 0x1000;
    let mut bytes = b"DDS ".to_vec();
    bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    bytes.extend(color.to_le_bytes());
    bytes.extend([0; 6]);
    bytes
}

/// One pixel of a DDS without compression: flags of its pixel format, bits, masks, and what follows the head.
fn plain_dds(flags: u32, bits: u32, masks: [u32; 4], code: &[u8; 4], rest: &[u8]) -> Vec<u8> {
    let mut words = [0_u32; 31];
    (words[0], words[1], words[2], words[3]) = (124, 0x1007, 1, 1);
    (words[18], words[19], words[21]) = (32, flags, bits);
    words[20] = u32::from_le_bytes(*code);
    words[22..26].copy_from_slice(&masks);
    let mut bytes = b"DDS ".to_vec();
    bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    bytes.extend(rest);
    bytes
}

#[test]
fn a_dds_without_compression_is_read_by_its_masks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let newer = |format: u8| [&[format], &[0; 19][..], &[0, 0, 255, 255]].concat();
    let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    for (what, bytes, expected) in [
        (
            "24 bits",
            plain_dds(
                0x40,
                24,
                [0xff_0000, 0xff00, 0xff, 0],
                &[0; 4],
                &[255, 0, 0],
            ),
            blue,
        ),
        (
            "32 bits",
            plain_dds(
                0x41,
                32,
                [0xff, 0xff00, 0xff_0000, 0xff00_0000],
                &[0; 4],
                &[255, 0, 0, 255],
            ),
            red,
        ),
        (
            "16 bits",
            plain_dds(0x40, 16, [0xf800, 0x7e0, 0x1f, 0], &[0; 4], &[0x1f, 0]),
            blue,
        ),
        (
            "brightness",
            plain_dds(0x2_0000, 8, [0xff, 0, 0, 0], &[0; 4], &[255]),
            [1.0; 3],
        ),
        (
            "brightness with masks of more bits than there are",
            plain_dds(0x2_0000, 8, [0xff00_0000, 0, 0, 0], &[0; 4], &[255]),
            [1.0; 3],
        ),
        ("RGBA", plain_dds(4, 0, [0; 4], b"DX10", &newer(28)), blue),
        ("BGRA", plain_dds(4, 0, [0; 4], b"DX10", &newer(87)), red),
    ] {
        write(path, "a.dds", bytes);
        assert_eq!(first_texel(path, "a.dds"), expected, "{what}");
    }
}

#[test]
fn a_picture_is_known_by_its_content_whatever_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let blue = DynamicImage::from(ImageBuffer::from_pixel(4, 4, Rgb([0_u8, 0, 255])));
    let kinds = [
        ImageFormat::Png,
        ImageFormat::Jpeg,
        ImageFormat::WebP,
        ImageFormat::Tga,
        ImageFormat::Bmp,
        ImageFormat::Gif,
    ];
    for name in ["a.png", "a.jpg", "a.tga", "a.hdr", "a", "a.texture"] {
        for format in kinds {
            blue.save_with_format(path.join(name), format).unwrap();
            let [red, green, found] = first_texel(path, name);
            // A JPEG of one colour is off by one of 255.
            assert!(
                red < 0.01 && green < 0.01 && found > 0.99,
                "{format:?} as {name}: {red} {green} {found}"
            );
        }
        write(path, name, dds(0x001f));
        assert_eq!(first_texel(path, name), [0.0, 0.0, 1.0], "DDS as {name}");
        let head = "#?RGBE\n\n+Y 4 +X 4\n";
        let pixels = [0_u8, 0, 128, 129].repeat(16);
        write(path, name, [head.as_bytes(), &pixels].concat());
        assert_eq!(first_texel(path, name), [0.0, 0.0, 1.0], "HDR as {name}");
    }
}

mod open_exr {
    use super::{first_texel, problems, square, traced};
    use exr::prelude::{Image, SpecificChannels, WritableImage, f16};
    use glassbox::sync::Traced;

    #[test]
    fn channels_of_any_names_in_any_layer_are_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let file = path.join("a.exr");
        let three = |names: [&str; 3]| {
            let channels = SpecificChannels::build();
            let [r, g, b] = names;
            let channels = channels.with_channel(r).with_channel(g).with_channel(b);
            let channels = channels.with_pixel_fn(|_| (0.5_f32, 0.25_f32, 0.125_f32));
            let image = Image::from_channels((4, 4), channels);
            image.write().to_file(&file).unwrap();
            first_texel(path, "a.exr")
        };
        let expected = [0.5, 0.25, 0.125];
        for names in [
            ["R", "G", "B"],
            ["r", "g", "b"],
            ["red", "green", "blue"],
            ["View.Combined.R", "View.Combined.G", "View.Combined.B"],
            ["diffuse.r", "diffuse.g", "diffuse.b"],
        ] {
            assert_eq!(three(names), expected, "{names:?}");
        }
        for name in ["Y", "View.Y", "height"] {
            let channels = SpecificChannels::build().with_channel(name);
            let channels = channels.with_pixel_fn(|_| (0.5_f32,));
            let image = Image::from_channels((4, 4), channels);
            image.write().to_file(&file).unwrap();
            assert_eq!(first_texel(path, "a.exr"), [0.5; 3], "{name}");
        }
    }

    #[test]
    fn luminance_and_chroma_become_colours() {
        let folder = tempfile::tempdir().unwrap();
        let [r, g, b] = [0.5_f32, 0.25, 0.125];
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let channels = SpecificChannels::build();
        let channels = channels
            .with_channel("BY")
            .with_channel("RY")
            .with_channel("Y");
        let channels = channels.with_pixel_fn(|_| ((b - y) / y, (r - y) / y, y));
        let image = Image::from_channels((4, 4), channels);
        image.write().to_file(folder.path().join("a.exr")).unwrap();
        for (found, expected) in first_texel(folder.path(), "a.exr")
            .into_iter()
            .zip([r, g, b])
        {
            // A few roundings of 32 bits.
            assert!((found - expected).abs() < 1e-6, "{found} for {expected}");
        }
    }

    #[test]
    fn infinite_in_16_bits_is_the_largest_of_16_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let channels = SpecificChannels::rgb(|_| (f16::INFINITY, f16::NAN, f16::from_f32(0.3)));
        let image = Image::from_channels((4, 4), channels);
        image.write().to_file(path.join("a.exr")).unwrap();
        let app = traced(&square(path, "map_Kd a.exr"));
        let world = &app.world().resource::<Traced>().world;
        let found = world.textures[0].texel(0, 0, false).to_array();
        assert_eq!(found, [65504.0, 0.0, f16::from_f32(0.3).to_f32()]);
        let problems = problems(&app);
        assert!(problems[0].contains("16 texels"), "{problems:?}");
    }
}
