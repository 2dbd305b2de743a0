//! Edits of a scene of more lights than have planes of their own.

use super::super::engine::{Engine, Mode};
use super::tests::{SIZE, start};
use crate::film::subject::Subject;
use crate::film::test_scene::{camera, edited, many, settings};
use crate::film::{LightMix, lock};
use crate::trace::Gains;
use glam::Vec3;

#[test]
fn one_of_many_lights_that_is_edited_takes_its_own_rays_and_no_other_s() {
    let mut now = many(1..101);
    let render = start(&now, 4);
    render.wait();
    let mut before = render.status().rays.total();
    for step in 0..4 {
        now = edited(&now, |lights| match step {
            // The first edit gives it a plane of its own.
            0 | 1 => lights.points[70].color *= 1.5,
            2 => lights.points[70].position.y += 0.2,
            _ => lights.points[70].color = Vec3::ZERO,
        });
        assert!(render.edit(now.clone(), &Gains::default()));
        render.wait();
        let fresh = start(&now, 4);
        fresh.wait();
        let all = fresh.status().rays.total();
        let more = render.status().rays.total() - before;
        assert!(step == 0 || 4 * more < all, "step {step}: {more} of {all}");
        before += more;
        let pictures = [&render, &fresh].map(|render| render.snapshot().picture);
        for (one, other) in pictures[0].pixels.iter().zip(&pictures[1].pixels) {
            // Lights that share a plane are added in f32.
            let difference = (*one - *other).abs().max_element();
            assert!(difference <= 1e-5 * other.max_element(), "{one} {other}");
        }
    }
}

#[test]
fn a_light_that_is_set_apart_from_many_is_no_reason_to_begin_anew() {
    let world = many(1..301);
    let mode = Mode {
        watched: true,
        samples: 0..1,
        region: None,
    };
    let subject = Subject::new(world.clone(), camera(), settings(SIZE, 1), true);
    let engine = Engine::new(subject, mode, None);
    engine.run(&|_| {});
    // As if it took ten seconds a sample.
    lock(&engine.speed).seconds_a_sample = Some(10.0);
    let mut now = world;
    let mut rays = Vec::new();
    for _ in 0..2 {
        let before = engine.status().rays.total();
        now = edited(&now, |lights| lights.points[200].position.y += 0.1);
        assert!(engine.edit(now.clone(), &Gains::default()));
        engine.run(&|_| {});
        rays.push(engine.status().rays.total() - before);
    }
    assert!(4 * rays[1] < rays[0], "{rays:?}");
}

#[test]
fn a_faint_light_of_many_has_all_its_rays_where_it_shines_alone() {
    let mut world = many(1..101);
    world = edited(&world, |lights| lights.points[70].color *= 1e-3);
    let solo: Gains = world
        .lights
        .all()
        .map(|lamp| (lamp.id(), Vec3::ZERO))
        .filter(|(id, _)| *id != 71)
        .collect();
    assert!(world.needs.faint > 0.0);
    assert_eq!(solo.applied(&world).needs.faint, 0.0);
    let subject = Subject::new(world.clone(), camera(), settings(SIZE, 1), true);
    // Which of the others are asked for is another question then.
    assert!(super::Edit::between(&subject, world.clone(), &solo).is_none());
    let mix = LightMix {
        apart: true,
        gains: solo.clone(),
    };
    let alone = Subject::mixed(world.clone(), camera(), settings(SIZE, 1), Vec::new(), &mix);
    assert_eq!(alone.light.world.needs.faint, 0.0);
    let edit = super::Edit::between(&alone, world, &solo).unwrap();
    assert!(!edit.needs_rays());
}
