//! A diffuse map and the opacity map that cuts it out are one texture to the tracer.

use super::background::{pending, until};
use super::*;
use crate::scene::{PhongMap, PhongMaps, TextureFilter};
use crate::sync::finish;

/// Two texels side by side.
fn pair(left: [u8; 4], right: [u8; 4]) -> Image {
    Image::new(
        Extent3d {
            width: 2,
            height: 1,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        [left, right].concat(),
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::MAIN_WORLD,
    )
}

/// Half-way between the texels of the first object's diffuse map.
fn middle(app: &App) -> f32 {
    let world = world(app);
    let map = world.materials[0].map(PhongMap::Diffuse).unwrap().texture as usize;
    let uv = bevy::math::Vec2::splat(0.5);
    world.textures[map]
        .sample_cut_out(uv, 0.0, TextureFilter::Bilinear, false)
        .x
}

#[test]
fn a_diffuse_map_follows_the_opacity_map_that_cuts_it_out() {
    let mut small = Small::new();
    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    let white = [255; 4];
    let black = [0, 0, 0, 255];
    let diffuse = images.add(pair(white, black));
    let opacity = images.add(pair(white, black));
    let maps = |opacity: Option<Handle<Image>>| PhongMaps {
        diffuse: Some(diffuse.clone()),
        opacity,
        ..PhongMaps::default()
    };
    let object = small.objects[0];
    let with = maps(Some(opacity.clone()));
    small.app.world_mut().entity_mut(object).insert(with);
    small.app.update();
    assert_eq!(middle(&small.app), 1.0, "only the white one is there");
    let before = world(&small.app);
    small.edit::<Transform>(object, |t| t.translation.x = 1.0);
    small.app.update();
    assert!(
        Arc::ptr_eq(&before.textures, &world(&small.app).textures),
        "made again"
    );

    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(&opacity).unwrap() = pair(white, white);
    small.app.update();
    assert_eq!(middle(&small.app), 0.5, "both are there");

    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(&opacity).unwrap() = pair(black, white);
    small.app.update();
    assert_eq!(middle(&small.app), 0.0, "only the black one is there");

    small.app.world_mut().entity_mut(object).insert(maps(None));
    small.app.update();
    assert_eq!(middle(&small.app), 0.5, "nothing cuts it out");
    assert_eq!(world(&small.app).textures.len(), 1);
}

const WHITE: [u8; 4] = [255; 4];
const BLACK: [u8; 4] = [0, 0, 0, 255];

/// The two in columns, of which there are so many that it is not cut out within a frame.
fn columns(even: [u8; 4], odd: [u8; 4]) -> Image {
    const SIDE: u32 = 300;
    let row = [even, odd].concat().repeat(SIDE as usize / 2);
    Image::new(
        Extent3d {
            width: SIDE,
            height: SIDE,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        row.repeat(SIDE as usize),
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::MAIN_WORLD,
    )
}

/// A scene whose first object has a large diffuse map; the map, and a large opacity map that leaves the white columns.
fn large() -> (Small, [Handle<Image>; 2]) {
    let mut small = Small::new();
    small.app.insert_resource(TreeBuilding::InBackground);
    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    let pictures = [(); 2].map(|()| images.add(columns(WHITE, BLACK)));
    wear(&mut small, &pictures[0], None);
    small.app.update();
    (small, pictures)
}

fn wear(small: &mut Small, diffuse: &Handle<Image>, opacity: Option<&Handle<Image>>) {
    let maps = PhongMaps {
        diffuse: Some(diffuse.clone()),
        opacity: opacity.cloned(),
        ..PhongMaps::default()
    };
    let mut object = small.app.world_mut().entity_mut(small.objects[0]);
    object.insert(maps);
}

fn paint(small: &mut Small, picture: &Handle<Image>, even: [u8; 4], odd: [u8; 4]) {
    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(picture).unwrap() = columns(even, odd);
}

#[test]
fn large_maps_are_cut_out_behind_the_frames_and_what_was_there_before_is_seen_until_then() {
    let (mut small, [diffuse, opacity]) = large();
    assert_eq!(middle(&small.app), 0.5, "nothing cuts it out");
    wear(&mut small, &diffuse, Some(&opacity));
    small.app.update();
    assert_eq!((pending(&small.app), middle(&small.app)), (1, 0.5));
    until(&mut small.app, |app| pending(app) == 0);
    assert_eq!(middle(&small.app), 1.0, "only the white ones are there");
    assert_eq!(frame(&mut small.app), Changes::default());

    paint(&mut small, &opacity, WHITE, WHITE);
    small.app.update();
    assert_eq!((pending(&small.app), middle(&small.app)), (1, 1.0));
    until(&mut small.app, |app| pending(app) == 0);
    assert_eq!(middle(&small.app), 0.5, "all are there");

    paint(&mut small, &opacity, BLACK, WHITE);
    small.app.update();
    assert_eq!(pending(&small.app), 1);
    finish(&mut small.app);
    assert_eq!((pending(&small.app), middle(&small.app)), (0, 0.0));
}

#[test]
fn of_an_opacity_map_that_is_edited_in_every_frame_some_states_are_seen() {
    let (mut small, [diffuse, opacity]) = large();
    wear(&mut small, &diffuse, Some(&opacity));
    small.app.update();
    until(&mut small.app, |app| pending(app) == 0);
    let mut seen = Vec::new();
    for i in 0..10_000 {
        match i % 2 {
            0 => paint(&mut small, &opacity, WHITE, BLACK),
            _ => paint(&mut small, &opacity, BLACK, WHITE),
        }
        small.app.update();
        let now = middle(&small.app);
        assert!(now == 0.0 || now == 1.0, "{now}: neither one nor the other");
        if seen.last() != Some(&now) {
            seen.push(now);
        }
        if seen.len() == 4 {
            return;
        }
    }
    panic!("{seen:?}");
}

#[test]
fn what_goes_while_it_is_cut_out_is_missing_and_what_nobody_wears_is_not_waited_for() {
    let (mut small, [diffuse, opacity]) = large();
    wear(&mut small, &diffuse, Some(&opacity));
    small.app.update();
    assert_eq!(pending(&small.app), 1);
    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    images.remove(&opacity);
    small.app.update();
    let named = problems(&small.app);
    assert!(
        named.len() == 1 && named[0].contains("is not loaded"),
        "{named:?}"
    );
    assert_eq!((pending(&small.app), middle(&small.app)), (0, 0.5));

    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    let other = images.add(columns(BLACK, WHITE));
    wear(&mut small, &diffuse, Some(&other));
    small.app.update();
    assert_eq!(pending(&small.app), 1);
    wear(&mut small, &diffuse, None);
    small.app.update();
    assert_eq!((pending(&small.app), problems(&small.app)), (0, Vec::new()));
    // And again: what was begun for nobody does not come back.
    wear(&mut small, &diffuse, Some(&other));
    small.app.update();
    until(&mut small.app, |app| pending(app) == 0);
    assert_eq!(middle(&small.app), 0.0, "only the black ones are there");
}
