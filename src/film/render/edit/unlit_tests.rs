//! Pictures that an edit leaves tiles of without light.

use super::super::engine::{Engine, Mode};
use super::super::preview::Preview;
use super::super::progressive::Progressive;
use crate::film::lock;
use crate::film::subject::Subject;
use crate::film::test_scene::{camera, edited, lit, repainted, settings};
use crate::trace::{Gains, PlaneSet, World};
use glam::{UVec2, Vec3};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Of which some tiles show a material, and some do not.
const LARGER: UVec2 = UVec2::new(96, 54);

/// A render that somebody watches and that is complete, on this thread.
fn complete(world: &World, spp: u32) -> Engine {
    let mode = Mode {
        watched: true,
        samples: 0..spp.into(),
        region: None,
    };
    let subject = Subject::new(world.clone(), camera(), settings(LARGER, spp), true);
    let engine = Engine::new(subject, mode, None);
    engine.run(&|_| {});
    engine
}

#[test]
fn tiles_of_another_material_have_a_sample_before_other_lights_have_more_than_one() {
    let world = lit();
    let engine = complete(&world, 4);
    let moved = edited(&world, |lights| lights.points[0].position.x += 0.1);
    let now = repainted(&moved, 1, Vec3::X);
    assert!(engine.edit(now.clone(), &Gains::default()));
    engine.take_edit();
    let is_empty = |tile: &&u32| !lock(&engine.tiles[**tile as usize]).has_samples();
    let emptied: Vec<u32> = engine.rendered.iter().filter(is_empty).copied().collect();
    assert!(!emptied.is_empty() && emptied.len() < engine.rendered.len());
    let chunks = engine.next_pass().unwrap();
    assert!(chunks.iter().all(|chunk| chunk.range == (0..1)));
    for tile in emptied {
        let chunk = chunks.iter().find(|chunk| chunk.tile == tile);
        assert_eq!(chunk.map(|chunk| chunk.planes), Some(PlaneSet::ALL));
    }
    engine.run(&|_| {});
    let fresh = Progressive::start(now, camera(), settings(LARGER, 4)).unwrap();
    fresh.wait();
    assert_eq!(engine.picture(), fresh.snapshot().picture);
}

#[test]
fn a_coarse_picture_begins_anew_where_a_light_has_another_colour() {
    let world = lit();
    let engine = complete(&world, 2);
    lock(&engine.speed).seconds_a_sample = Some(10.0);
    let moved = edited(&world, |lights| lights.points[0].position.x += 0.1);
    assert!(engine.edit(moved.clone(), &Gains::default()));
    engine.take_edit();
    engine.begins_coarse.store(false, Ordering::Relaxed);
    // It is seen by now.
    let preview = Preview::new(engine.area);
    preview.begin(8);
    preview.take(&[UVec2::new(8, 8)], &[Vec3::ONE]);
    *lock(&engine.preview) = Some(Arc::new(preview));
    let tinted = edited(&moved, |lights| lights.points[0].color *= 3.0);
    assert!(engine.edit(tinted.clone(), &Gains::default()));
    engine.take_edit();
    assert!(lock(&engine.preview).is_none());
    assert!(engine.begins_coarse.load(Ordering::Relaxed));
    engine.run(&|_| {});
    // Where none is seen another colour is there at once.
    let before = engine.status().rays;
    let again = edited(&tinted, |lights| lights.points[0].color *= 0.5);
    assert!(engine.edit(again.clone(), &Gains::default()));
    assert!(!engine.edit_waits.load(Ordering::Relaxed));
    assert_eq!(engine.status().rays, before);
    let fresh = Progressive::start(again, camera(), settings(LARGER, 2)).unwrap();
    fresh.wait();
    assert_eq!(engine.picture(), fresh.snapshot().picture);
}
