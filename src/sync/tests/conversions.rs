//! Large pictures, which become textures behind the frames: what was there before stays until then.

use super::background::{pending, until};
use super::*;
use crate::scene::{
    Environment, EnvironmentMap, PhongMap, PhongMaps, RenderSettings, TextureFilter,
};
use crate::sync::finish;
use crate::trace::Texture;

/// Of one colour, in floats, and larger than what is converted within a frame.
fn large(layers: u32, red: f32) -> Image {
    let size = Extent3d {
        width: 300,
        height: 300,
        depth_or_array_layers: layers,
    };
    let texel = [red, 0.5, 0.0, 1.0].map(f32::to_ne_bytes).concat();
    let usage = RenderAssetUsages::MAIN_WORLD;
    let format = TextureFormat::Rgba32Float;
    Image::new_fill(size, TextureDimension::D2, &texel, format, usage)
}

fn add(app: &mut App, image: Image) -> Handle<Image> {
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

fn background() -> Small {
    let mut small = Small::new();
    small.app.insert_resource(TreeBuilding::InBackground);
    small
}

/// What is all around.
fn around(app: &App) -> Option<Arc<Texture>> {
    world(app).environment.map.clone()
}

fn red(texture: &Texture) -> f32 {
    texture.texel(0, 0, false).x
}

/// The map of the first object's colour.
fn map(app: &App) -> Option<f32> {
    let world = world(app);
    let material = &world.materials[world.objects[0].material as usize];
    let map = material.map(PhongMap::Diffuse)?;
    Some(red(&world.textures[map.texture as usize]))
}

fn paint(small: &mut Small, picture: &Handle<Image>) {
    let maps = PhongMaps {
        diffuse: Some(picture.clone()),
        ..PhongMaps::default()
    };
    let mut object = small.app.world_mut().entity_mut(small.objects[0]);
    object.insert(maps);
}

#[test]
fn a_sky_is_put_together_behind_the_frames_and_the_one_before_is_seen_until_then() {
    let mut small = background();
    let first = add_image(&mut small.app, 51);
    small.app.insert_resource(EnvironmentMap(Some(first)));
    small.app.update();
    let before = around(&small.app).expect("a small picture is there at once");
    let mut cube = large(6, 7.0);
    let data = cube.data.as_mut().unwrap();
    data[..4].copy_from_slice(&f32::NAN.to_ne_bytes());
    let cube = add(&mut small.app, cube);
    small.app.insert_resource(EnvironmentMap(Some(cube)));
    assert_eq!(frame(&mut small.app), Changes::default());
    let now = around(&small.app).unwrap();
    assert!(Arc::ptr_eq(&before, &now), "the old sky is gone");
    assert_eq!((pending(&small.app), problems(&small.app)), (1, Vec::new()));
    until(&mut small.app, |app| pending(app) == 0);
    let now = around(&small.app).unwrap();
    assert_eq!((now.width(), red(&now)), (1200, 7.0));
    let named = problems(&small.app);
    assert!(
        named.len() == 1 && named[0].contains("1 texels"),
        "{named:?}"
    );
    // One that cannot be read is named, too.
    let mut broken = large(6, 1.0);
    broken.data.as_mut().unwrap().truncate(3 << 20);
    let broken = add(&mut small.app, broken);
    small.app.insert_resource(EnvironmentMap(Some(broken)));
    until(&mut small.app, |app| around(app).is_none());
    let named = problems(&small.app);
    assert!(
        named.len() == 1 && named[0].contains("is broken"),
        "{named:?}"
    );
}

#[test]
fn a_material_keeps_its_picture_until_the_edited_one_is_there() {
    let mut small = background();
    let picture = add(&mut small.app, large(1, 1.0));
    paint(&mut small, &picture);
    small.app.update();
    assert_eq!((map(&small.app), problems(&small.app)), (None, Vec::new()));
    until(&mut small.app, |app| map(app) == Some(1.0));
    // Edited in every frame, and seen all the same.
    let mut seen = Vec::new();
    for red in 2..10_000 {
        let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
        *images.get_mut(&picture).unwrap() = large(1, red as f32);
        small.app.update();
        let now = map(&small.app).expect("it had a picture");
        if seen.last() != Some(&now) {
            seen.push(now);
        }
        if seen.len() == 4 {
            break;
        }
    }
    assert!(seen.len() == 4 && seen.is_sorted(), "{seen:?}");
    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    *images.get_mut(&picture).unwrap() = large(1, 0.25);
    until(&mut small.app, |app| pending(app) == 0);
    assert_eq!(map(&small.app), Some(0.25));
    // Another picture, which is not there yet: the one before stays.
    let other = add(&mut small.app, large(1, 0.75));
    paint(&mut small, &other);
    small.app.update();
    assert_eq!(map(&small.app), Some(0.25));
    finish(&mut small.app);
    assert_eq!((map(&small.app), pending(&small.app)), (Some(0.75), 0));
}

#[test]
fn a_picture_that_goes_while_it_is_converted_is_missing_and_one_that_nobody_uses_is_not_waited_for()
{
    let mut small = background();
    let [first, second] = [1.0, 2.0].map(|red| add(&mut small.app, large(1, red)));
    paint(&mut small, &first);
    small.app.update();
    assert_eq!(pending(&small.app), 1);
    let mut images = small.app.world_mut().resource_mut::<Assets<Image>>();
    images.remove(&first);
    small.app.update();
    let named = problems(&small.app);
    assert!(
        named.len() == 1 && named[0].contains("is not loaded"),
        "{named:?}"
    );
    paint(&mut small, &second);
    small.app.update();
    assert_eq!(pending(&small.app), 1);
    let mut object = small.app.world_mut().entity_mut(small.objects[0]);
    object.remove::<PhongMaps>();
    small.app.update();
    assert_eq!((pending(&small.app), problems(&small.app)), (0, Vec::new()));
    // And again: what was begun for nobody does not come back.
    paint(&mut small, &second);
    small.app.update();
    until(&mut small.app, |app| pending(app) == 0);
    assert_eq!(map(&small.app), Some(2.0));
}

/// The texture of the first object's colour.
fn map_texture(app: &App) -> Option<Arc<Texture>> {
    let world = world(app);
    let material = &world.materials[world.objects[0].material as usize];
    let map = material.map(PhongMap::Diffuse)?;
    Some(world.textures[map.texture as usize].clone())
}

#[test]
fn smaller_copies_are_made_behind_the_frames_where_mipmaps_are_read_and_nowhere_else() {
    let mut small = background();
    let picture = add(&mut small.app, large(1, 0.3));
    paint(&mut small, &picture);
    until(&mut small.app, |app| {
        map(app) == Some(0.3) && pending(app) == 0
    });
    assert!(!map_texture(&small.app).unwrap().has_levels());
    let mut settings = (small.app.world_mut()).resource_mut::<RenderSettings>();
    settings.texture_filter = TextureFilter::Mipmap;
    small.app.update();
    until(&mut small.app, |app| pending(app) == 0);
    assert!(map_texture(&small.app).unwrap().has_levels());
    // One that comes now has them when it is seen.
    let other = add(&mut small.app, large(1, 0.6));
    paint(&mut small, &other);
    until(&mut small.app, |app| map(app) == Some(0.6));
    assert!(map_texture(&small.app).unwrap().has_levels());
}

#[test]
fn where_a_sky_is_bright_is_found_out_behind_the_frames_when_it_is_to_light() {
    let mut small = background();
    let sky = add(&mut small.app, large(1, 0.3));
    small.app.insert_resource(EnvironmentMap(Some(sky)));
    until(&mut small.app, |app| {
        around(app).is_some() && pending(app) == 0
    });
    assert!(!around(&small.app).unwrap().has_dome_table());
    let lights = |app: &App| world(app).environment.lights;
    let mut environment = small.app.world_mut().resource_mut::<Environment>();
    environment.lights = true;
    small.app.update();
    assert!(!lights(&small.app), "not before it is there");
    until(&mut small.app, lights);
    assert!(around(&small.app).unwrap().has_dome_table());
    assert_eq!(pending(&small.app), 0);
}
