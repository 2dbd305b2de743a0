use super::super::engine::{Engine, Mode};
use super::super::progressive::Progressive;
use super::super::snapshot::Snapshot;
use super::super::status::Ending;
use crate::film::lock;
use crate::film::subject::Subject;
use crate::film::test_scene::{camera, edited, lit, many, repainted, settings};
use crate::trace::{Gains, Lights, PointLight, Untinted, World};
use glam::{UVec2, Vec3};
use std::sync::Arc;

pub(super) const SIZE: UVec2 = UVec2::new(37, 22);

pub(super) fn start(world: &World, spp: u32) -> Progressive {
    Progressive::start(world.clone(), camera(), settings(SIZE, spp)).unwrap()
}

#[test]
fn another_colour_of_a_light_takes_no_ray_and_is_the_picture_of_a_render_with_that_colour() {
    let before = lit();
    let render = start(&before, 16);
    render.wait();
    let rays = render.status().rays;
    for factor in [Vec3::new(0.25, 3.0, 1.0), Vec3::ZERO, Vec3::splat(1e6)] {
        let world = edited(&before, |lights| {
            lights.points[0].color *= factor;
            lights.directionals[0].color = factor;
            for color in &mut lights.parallelograms[1].colors {
                *color *= factor.max_element();
            }
        });
        assert!(render.edit(world.clone(), &Gains::default()));
        assert_eq!(render.wait(), Ending::Samples);
        assert_eq!(render.status().rays, rays, "no ray more");
        let fresh = start(&world, 16);
        fresh.wait();
        assert_eq!(render.snapshot().picture, fresh.snapshot().picture);
        assert_eq!(render.film().picture(), fresh.film().picture());
        let errors = [&render, &fresh].map(|render| render.status().error().unwrap());
        let ratio = errors[0].relative() / errors[1].relative();
        assert!((0.2..5.0).contains(&ratio), "{errors:?}");
    }
}

/// An edit of some light: its colour, its place, its being there.
fn change(lights: &mut Lights, numbers: &mut impl FnMut(u32) -> u32) {
    let offset = Vec3::new(
        numbers(9) as f32 - 4.0,
        numbers(5) as f32,
        numbers(9) as f32 - 4.0,
    ) * 0.1;
    let color = Vec3::new(numbers(4) as f32, numbers(4) as f32, numbers(4) as f32);
    match numbers(9) {
        0 => lights
            .points
            .iter_mut()
            .for_each(|light| light.color = color),
        1 => lights
            .points
            .iter_mut()
            .for_each(|light| light.position += offset),
        2 => lights
            .segments
            .iter_mut()
            .for_each(|light| light.ends[0] += offset),
        3 => lights
            .segments
            .iter_mut()
            .for_each(|light| light.colors = [color; 2]),
        4 => lights.parallelograms.truncate(1),
        5 => lights
            .parallelograms
            .iter_mut()
            .for_each(|light| light.edges[0] += offset),
        6 => {
            let fresh = lit();
            lights.parallelograms = fresh.lights.parallelograms.clone();
        }
        7 => lights.points.clear(),
        _ => {
            let id = 200 + u64::from(numbers(50));
            if lights.all().all(|light| light.id() != id) {
                lights.points.push(PointLight {
                    id,
                    position: Vec3::new(0.2, 1.0, 0.7) + offset,
                    color,
                    cone: None,
                });
                lights.points.sort_by_key(|light| light.id);
            }
        }
    }
}

#[test]
fn after_any_edits_of_lights_and_materials_at_any_moment_the_picture_is_that_of_a_fresh_render() {
    let mut state = 7_u32;
    let mut numbers = |below: u32| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 16) % below
    };
    let (mut taken, mut kept) = (0, 0);
    for spp in [1, 5, 16] {
        let mut now = lit();
        let mut render = start(&now, spp);
        for step in 0..30 {
            // Some edits find a render at work, some one that has ended.
            if numbers(3) > 0 {
                render.wait();
            }
            if numbers(4) > 0 {
                now = edited(&now, |lights| change(lights, &mut numbers));
            }
            if numbers(3) == 0 {
                let diffuse = Vec3::new(0.5, 0.1, numbers(10) as f32 / 10.0);
                now = repainted(&now, numbers(3) as usize, diffuse);
            }
            kept += 1;
            if render.edit(now.clone(), &Gains::default()) {
                taken += 1;
            } else {
                render = start(&now, spp);
            }
            if step % 5 == 4 {
                render.wait();
                let fresh = start(&now, spp);
                fresh.wait();
                let pictures = [&render, &fresh].map(|render| render.snapshot().picture);
                assert_eq!(pictures[0], pictures[1], "{spp} samples, step {step}");
                assert_eq!(render.film().counts(), fresh.film().counts());
            }
        }
    }
    assert!(2 * taken > kept, "only {taken} of {kept} edits were taken");
}

#[test]
fn lights_that_share_a_plane_are_rendered_again_together_and_a_light_that_is_seen_with_all() {
    let before = lit();
    let subject = |world: &World, lights| Subject {
        light: Untinted::of(world, lights, &[], &Gains::default()),
        ..Subject::new(world.clone(), camera(), settings(SIZE, 1), true)
    };
    let planes = |world: &World, lights| {
        super::same_planes(&subject(&before, lights), &subject(world, lights))
    };
    let moved = edited(&before, |lights| lights.parallelograms[1].corner.x += 0.1);
    let all = [Some(0), Some(1), Some(2), Some(3), Some(4)];
    assert_eq!(planes(&moved, 8).unwrap(), [&all[..], &[None]].concat());
    assert_eq!(
        planes(&moved, 2).unwrap(),
        [Some(0), Some(1), Some(2), None]
    );
    assert_eq!(planes(&moved, 0).unwrap(), [Some(0), None]);
    let gone = edited(&before, |lights| lights.points.clear());
    assert_eq!(
        planes(&gone, 8).unwrap(),
        [Some(0), Some(2), Some(3), Some(4), Some(5)]
    );
    assert_eq!(planes(&gone, 2).unwrap(), [Some(0), Some(2), None, None]);
    let seen = edited(&before, |lights| lights.parallelograms[0].visible = true);
    assert_eq!(planes(&seen, 8), None);
}

#[test]
fn another_material_is_rendered_again_where_paths_met_it_and_nowhere_else() {
    let size = UVec2::new(320, 180);
    let start =
        |world: &World| Progressive::start(world.clone(), camera(), settings(size, 5)).unwrap();
    let before = lit();
    let render = start(&before);
    render.wait();
    let mut rays = render.status().rays.total();
    let mut now = before;
    // The wall is seen by itself, and in the mirror.
    for (step, green) in [0.9, 0.1, 0.5].into_iter().enumerate() {
        now = repainted(&now, 1, Vec3::new(0.2, green, 0.2));
        if step == 1 {
            now = edited(&now, |lights| lights.points[0].position.x += 0.1);
        }
        assert!(render.edit(now.clone(), &Gains::default()));
        assert_eq!(render.wait(), Ending::Samples);
        let fresh = start(&now);
        fresh.wait();
        assert_eq!(render.snapshot().picture, fresh.snapshot().picture);
        assert_eq!(render.film().counts(), fresh.film().counts());
        assert_eq!(render.status().samples, 5.0);
        let all = fresh.status().rays.total();
        let more = render.status().rays.total() - rays;
        assert!(
            2 * more < all,
            "step {step}: {more} rays more, {all} for all"
        );
        rays += more;
    }
    let mut glass = now.clone();
    Arc::make_mut(&mut glass.materials)[1].opacity = 0.5;
    assert!(
        !render.edit(glass.with_needs(), &Gains::default()),
        "its shadow"
    );
}

#[test]
fn what_one_material_shows_while_it_is_rendered_again_is_what_was_there() {
    let size = UVec2::new(320, 180);
    let mode = Mode {
        watched: true,
        samples: 0..2,
        region: None,
    };
    let world = lit();
    let subject = Subject::new(world.clone(), camera(), settings(size, 2), true);
    let engine = Engine::new(subject, mode, None);
    engine.run(&|_| {});
    let mut snapshot = Snapshot::black(size);
    engine.redraw(&mut snapshot);
    let before = snapshot.picture.clone();
    let red = repainted(&world, 1, Vec3::X);
    assert!(engine.edit(red, &Gains::default()));
    engine.take_edit();
    engine.redraw(&mut snapshot);
    assert_eq!(snapshot.picture, before, "nothing new is known");
    engine.run(&|_| {});
    engine.redraw(&mut snapshot);
    assert_ne!(snapshot.picture, before);
}

#[test]
fn who_is_edited_comes_first_and_nobody_where_all_are() {
    let world = many(1..41);
    let subject = Subject::new(world.clone(), camera(), settings(SIZE, 1), true);
    let first = |edit: &dyn Fn(&mut Lights)| {
        let world = edited(&world, |lights| edit(lights));
        super::edited_first(&subject, &world)
    };
    assert_eq!(first(&|lights| lights.points[36].color.x = 0.5), [37]);
    let none: [u64; 0] = [];
    assert_eq!(first(&|lights| lights.points[2].color.x = 0.5), none);
    let all = |lights: &mut Lights| lights.points.iter_mut().for_each(|l| l.color *= 0.5);
    assert_eq!(first(&all), none);
    let subject = subject.edited(world.clone(), vec![30, 20], Gains::default());
    let moved = edited(&world, |lights| {
        lights.points[39].position.x = 0.5;
        lights.points.remove(19);
    });
    assert_eq!(super::edited_first(&subject, &moved), [40, 30]);
}

#[test]
fn an_edit_that_takes_long_keeps_what_it_can_and_is_refused_where_that_is_hardly_anything() {
    let started = |world: &World| {
        let mode = Mode {
            watched: true,
            samples: 0..4,
            region: None,
        };
        let subject = Subject::new(world.clone(), camera(), settings(SIZE, 4), true);
        let engine = Engine::new(subject, mode, None);
        engine.run(&|_| {});
        engine
    };
    let world = lit();
    let engine = started(&world);
    let all = engine.status().rays.total();
    // As if it took ten seconds a sample.
    lock(&engine.speed).seconds_a_sample = Some(10.0);
    let other = edited(&world, |lights| {
        lights.points[0].position.x += 0.1;
        lights.directionals[0].to_light = Vec3::Y;
        lights.segments[0].ends[0].x += 0.1;
        for light in &mut lights.parallelograms {
            light.corner.x += 0.1;
        }
    });
    assert!(!engine.edit(other, &Gains::default()));
    let moved = edited(&world, |lights| lights.points[0].position.x += 0.1);
    assert!(engine.edit(moved.clone(), &Gains::default()));
    assert_eq!(engine.run(&|_| {}), Ending::Samples);
    let status = engine.status();
    let more = status.rays.total() - all;
    assert_eq!(status.before.rays, all);
    let rate = more as f64 / status.seconds * 1e-6;
    assert!((status.mrays_per_s() / rate - 1.0).abs() < 1e-9);
    assert!(more < all / 2, "{more} rays for one light, {all} for all");
    assert_eq!(engine.picture(), started(&moved).picture());
}

#[test]
fn a_light_that_moves_among_many_takes_a_part_of_a_sample() {
    let world = lit();
    let subject = Subject::new(world.clone(), camera(), settings(SIZE, 1), true);
    let part = |edit: &dyn Fn(&mut Lights)| {
        let world = edited(&world, |lights| edit(lights));
        super::Edit::between(&subject, world, &Gains::default())
            .unwrap()
            .part_of_sample(0.0)
    };
    assert_eq!(
        part(&|lights| lights.points[0].position.x += 0.1),
        1.5 / 6.0
    );
    let two = |lights: &mut Lights| {
        lights.points[0].position.x += 0.1;
        lights.segments[0].ends[0].x += 0.1;
    };
    assert_eq!(part(&two), 2.5 / 6.0);
}

#[test]
fn rays_to_first_and_second_hits_are_traced_once_however_often_lights_and_materials_are_edited() {
    let world = lit();
    let render = start(&world, 4);
    render.wait();
    let rays = |render: &Progressive| {
        let rays = render.status().rays;
        (rays.camera, rays.mirror)
    };
    let (camera, mirror) = rays(&render);
    let pixels = u64::from(SIZE.element_product());
    assert_eq!(camera, pixels * 4);
    assert!(mirror > 0);
    // Of first samples it is kept from the start.
    assert!(render.memory().hits > 0);
    let (mut now, mut after) = (world, None);
    for step in 0..4 {
        now = match step {
            2 => repainted(&now, 1, Vec3::new(0.2, 0.7, 0.2)),
            _ => edited(&now, |lights| lights.points[0].position.x += 0.1),
        };
        assert!(render.edit(now.clone(), &Gains::default()));
        render.wait();
        let rays = rays(&render);
        assert_eq!(rays.0, camera + pixels * 3, "step {step}");
        assert!(rays.1 < 2 * mirror, "step {step}");
        let known = *after.get_or_insert(rays);
        assert_eq!(rays, known, "step {step}: those of the first edit are kept");
        let fresh = start(&now, 4);
        fresh.wait();
        assert_eq!(render.snapshot().picture, fresh.snapshot().picture);
    }
}

#[test]
fn while_materials_are_edited_what_hides_lights_is_found_out_once() {
    let world = lit();
    let render = start(&world, 4);
    render.wait();
    let mut now = world.clone();
    let mut before = render.status().rays.shadow;
    let mut shadow_rays = |edited: World| {
        now = edited;
        assert!(render.edit(now.clone(), &Gains::default()));
        render.wait();
        let fresh = start(&now, 4);
        fresh.wait();
        assert_eq!(render.snapshot().picture, fresh.snapshot().picture);
        let more = render.status().rays.shadow - before;
        before += more;
        (now.clone(), more)
    };
    let (world, first) = shadow_rays(repainted(&world, 1, Vec3::splat(0.3)));
    let (world, second) = shadow_rays(repainted(&world, 1, Vec3::new(0.1, 0.4, 0.2)));
    assert!(first > 0);
    assert_eq!(second, 0);
    // Of a light that moved nothing is known, and of the others what was.
    let move_light = |world| edited(world, |lights| lights.points[0].position.x += 0.1);
    let (world, of_light) = shadow_rays(move_light(&world));
    let (world, _) = shadow_rays(move_light(&world));
    let (world, first) = shadow_rays(repainted(&world, 1, Vec3::splat(0.2)));
    let (world, second) = shadow_rays(repainted(&world, 1, Vec3::splat(0.3)));
    assert!(0 < first && first <= of_light, "{first} of {of_light}");
    assert_eq!(second, 0);
    // What has a highlight chooses points on lights with an extent by it, and lights without one have theirs.
    let (world, _) = shadow_rays(edited(&world, |lights| lights.points[0].position.x += 0.1));
    let (world, first) = shadow_rays(repainted(&world, 2, Vec3::splat(0.2)));
    let (world, second) = shadow_rays(repainted(&world, 2, Vec3::splat(0.3)));
    assert!(0 < second && second < first, "{second}, {first}");
    // Of lights that are numbered otherwise nothing is known.
    let (world, _) = shadow_rays(edited(&world, |lights| _ = lights.points.remove(0)));
    let (_, first) = shadow_rays(repainted(&world, 1, Vec3::splat(0.1)));
    assert!(first > 0);
}

#[test]
fn what_a_very_bright_light_far_away_adds_stays_in_the_range_of_its_plane() {
    let far = edited(&lit(), |lights| {
        lights.points[0].position = Vec3::new(3e9, 1e10, 1e9);
        lights.points[0].color = Vec3::new(1e20, 2e19, 0.0);
    });
    let render = start(&far, 1);
    render.wait();
    let apart = render.film().picture();
    let file = super::super::at_once::render(&far, &camera(), &settings(SIZE, 1), &|_, _| {});
    let file = file.film.picture();
    for (one, other) in apart.pixels.iter().zip(&file.pixels) {
        let allowed = 1e-5 * other.max(Vec3::splat(1e-6));
        let is_near = (*one - *other).abs().cmple(allowed);
        assert!(is_near.all(), "{one} {other}");
    }
}
