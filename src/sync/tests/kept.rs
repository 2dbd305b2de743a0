//! What is kept from frame to frame is of what there is, however much has come and gone.

use super::*;
use crate::scene::{Motion, PhongMaps};
use crate::sync::ids::IdOwners;
use crate::sync::meshes::TracedMeshes;
use crate::sync::motions::WorldMotions;
use crate::sync::textures::TracedTextures;
use std::collections::VecDeque;

/// How long every list is.
fn kept(app: &App) -> [usize; 8] {
    let world = app.world();
    let [pictures, cut_outs] = world.resource::<TracedTextures>().kept();
    let traced = &world.resource::<Traced>().world;
    [
        world.resource::<TracedMeshes>().kept(),
        pictures,
        cut_outs,
        world.resource::<IdOwners>().kept(),
        world.resource::<WorldMotions>().kept(),
        traced.objects.len(),
        traced.materials.len(),
        traced.textures.len(),
    ]
}

#[test]
fn lists_are_as_long_as_what_there_is_whatever_has_come_and_gone() {
    let mut app = app();
    let mut there = VecDeque::new();
    let mut lengths = Vec::new();
    for i in 0..300_u32 {
        let mesh = add_mesh(&mut app, 3 + i % 5);
        let mut images = app.world_mut().resource_mut::<Assets<Image>>();
        let [diffuse, opacity] = [0, 1].map(|_| Some(images.add(picture(i as u8))));
        let maps = PhongMaps {
            diffuse,
            opacity,
            ..PhongMaps::default()
        };
        let motion = Motion {
            velocity: bevy::math::Vec3::X,
            samples: 1,
        };
        let place = Transform::from_xyz(i as f32, 0.0, 0.0);
        let object = (Mesh3d(mesh), Phong::default(), maps, motion, place);
        let world = app.world_mut();
        there.push_back(world.spawn(object).id());
        there.push_back(world.spawn((PointLamp::default(), place)).id());
        while there.len() > 20 {
            world.despawn(there.pop_front().unwrap());
        }
        app.update();
        if i >= 30 {
            lengths.push(kept(&app));
        }
    }
    let first = lengths[0];
    assert_eq!(
        first,
        [10, 20, 10, 20, 10, 10, 10, 20],
        "of ten objects and ten lamps"
    );
    let other = lengths.iter().position(|length| *length != first);
    assert_eq!(other, None, "{first:?} became {:?}", lengths.last());
    for entity in there {
        app.world_mut().despawn(entity);
    }
    // Numbers are looked through when another one is wanted.
    app.world_mut().spawn(PointLamp::default());
    app.update();
    assert_eq!(kept(&app), [0, 0, 0, 1, 0, 0, 0, 0]);
}

fn picture(grey: u8) -> Image {
    Image::new(
        Extent3d::default(),
        TextureDimension::D2,
        vec![grey, grey, grey, 100],
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::MAIN_WORLD,
    )
}
