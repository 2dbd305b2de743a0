//! What lets light through, and the pictures that say where, through files of models and back.

use super::app::{app, opened};
use super::models::objects;
use bevy::asset::Assets;
use bevy::ecs::name::Name;
use bevy::image::Image;
use bevy::prelude::{App, Transform};
use glassbox::io::{SceneFiles, save};
use glassbox::scene::*;
use image::{Rgba, RgbaImage};
use std::path::Path;

/// Two pixels: opaque and dark, nearly transparent and bright.
fn half_clear(file: &Path) {
    let mut picture = RgbaImage::from_pixel(2, 1, Rgba([10, 10, 10, 255]));
    picture.put_pixel(1, 0, Rgba([200, 200, 200, 20]));
    picture.save(file).unwrap();
}

/// A scene of one object for each material, beside the pictures that they name.
fn scene(folder: &Path, materials: &[Phong]) -> App {
    let mut app = app();
    let world = app.world_mut();
    world.resource_mut::<SceneFiles>().folder.path = folder.to_path_buf();
    for (id, material) in (1..).zip(materials) {
        world.spawn((
            SceneId(id),
            Name::new(format!("{id}")),
            Transform::default(),
            MeshSource::default(),
            material.clone(),
        ));
    }
    app.update();
    app
}

/// Whether the picture of each material's opacity, if it has one, leaves all as opaque as it is.
fn is_whole(app: &mut App) -> Vec<Option<bool>> {
    let world = app.world_mut();
    let mut found: Vec<(String, Option<bool>)> = Vec::new();
    let mut maps = world.query::<(&Name, &Phong, Option<&PhongMaps>)>();
    let images = world.resource::<Assets<Image>>();
    for (name, phong, maps) in maps.iter(world) {
        if phong == &Phong::default() {
            continue;
        }
        let picture = maps.and_then(|maps| maps.opacity.as_ref());
        let data = picture.map(|picture| images.get(picture).unwrap().data.as_ref().unwrap());
        let whole = data.map(|data| data.iter().all(|&byte| byte == 255));
        found.push((name.to_string(), whole));
    }
    found.sort();
    found.into_iter().map(|(_, whole)| whole).collect()
}

#[test]
fn a_picture_whose_alpha_meant_nothing_makes_nothing_more_transparent_in_a_glb() {
    let folder = tempfile::tempdir().unwrap();
    half_clear(&folder.path().join("a.png"));
    let colored = Phong {
        diffuse_map: Some(TextureSource::new("a.png")),
        ..Phong::default()
    };
    let materials = [
        Phong {
            opacity: 0.5,
            ..colored.clone()
        },
        Phong {
            alpha: Alpha::Mask { cutoff: 0.5 },
            ..colored.clone()
        },
        // This one's does.
        Phong {
            opacity: 0.5,
            opacity_map: Some(TextureSource::new("a.png#alpha")),
            ..colored
        },
    ];
    let mut first = scene(folder.path(), &materials);
    assert_eq!(is_whole(&mut first), [None, None, Some(false)]);
    let file = folder.path().join("a.glb");
    save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    let (mut second, _) = opened(&file);
    let read = objects(second.world_mut());
    let numbers: Vec<_> = (read.iter())
        .map(|(_, phong, _)| (phong.opacity, phong.alpha))
        .collect();
    let expected = materials
        .each_ref()
        .map(|phong| (phong.opacity, phong.alpha));
    assert_eq!(numbers, expected);
    let whole = is_whole(&mut second);
    assert_eq!(whole, [Some(true), Some(true), Some(false)]);
}

/// The brightness of the picture of each material's opacity, pixel by pixel, with the alpha that it has.
fn opacities(app: &mut App) -> Vec<(String, Vec<[u8; 2]>)> {
    let world = app.world_mut();
    let mut maps = world.query::<(&Phong, &PhongMaps)>();
    let images = world.resource::<Assets<Image>>();
    let found = maps.iter(world).filter_map(|(phong, maps)| {
        let data = images.get(maps.opacity.as_ref()?)?.data.as_ref()?;
        let pixels = data.as_chunks::<4>().0.iter();
        let pixels = pixels.map(|pixel| [pixel[0], pixel[3]]).collect();
        Some((phong.opacity_map.as_ref()?.path.clone(), pixels))
    });
    let mut found: Vec<_> = found.collect();
    found.sort();
    found
}

#[test]
fn brightness_that_is_opacity_comes_back_from_an_obj_as_brightness() {
    let folder = tempfile::tempdir().unwrap();
    half_clear(&folder.path().join("a.png"));
    let opaque = RgbaImage::from_pixel(2, 1, Rgba([77, 77, 77, 255]));
    opaque.save(folder.path().join("b.png")).unwrap();
    opaque.save(folder.path().join("c.png")).unwrap();
    let map = |path: &str| Some(TextureSource::new(path));
    let materials = [
        // With alpha of its own, which says something else.
        Phong {
            opacity_map: map("a.png"),
            ..Phong::default()
        },
        // The colours' picture.
        Phong {
            diffuse_map: map("b.png"),
            opacity_map: map("./b.png"),
            ..Phong::default()
        },
        // Neither: it can be named as it is.
        Phong {
            opacity_map: map("c.png"),
            ..Phong::default()
        },
    ];
    let mut first = scene(folder.path(), &materials);
    let file = folder.path().join("o.obj");
    let notes = save(first.world_mut(), &file).unwrap_or_else(|error| panic!("{error}"));
    let told = notes.lines();
    let is_told = |line: &&String| line.contains("its brightness alone is there");
    assert_eq!(told.iter().filter(is_told).count(), 2, "{told:?}");
    let (mut second, opened) = opened(&file);
    let dark_and_bright = vec![[10, 255], [200, 255]];
    let grey = vec![[77, 255]; 2];
    let expected = [
        ("c.png", grey.clone()),
        ("o-texture0.png", dark_and_bright),
        ("o-texture1.png", grey),
    ];
    let expected = expected.map(|(path, pixels)| (path.to_owned(), pixels));
    assert_eq!(
        opacities(&mut second),
        expected,
        "{:?}",
        opened.notes.lines()
    );
}
