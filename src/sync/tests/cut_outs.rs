//! A diffuse map and the opacity map that cuts it out are one texture to the tracer.

use super::*;
use crate::scene::{PhongMap, PhongMaps, TextureFilter};

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
