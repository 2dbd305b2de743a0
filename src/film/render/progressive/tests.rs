use super::super::at_once::{render, render_samples};
use super::super::light_pictures::render_lights;
use super::super::status::State;
use super::*;
use crate::film::test_scene::{camera, settings, world};
use crate::film::{Picture, TILE};
use glam::Vec3;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

const SIZE: UVec2 = UVec2::new(70, 45);

fn start(spp: u32) -> Progressive {
    Progressive::start(world(), camera(), settings(SIZE, spp)).unwrap()
}

/// In the same arithmetic: light by light.
fn rendered(spp: u32) -> Picture {
    let settings = settings(SIZE, spp);
    render_lights(&world(), &camera(), &settings, &|_| {})
        .0
        .picture
}

fn as_a_file(spp: u32) -> Picture {
    render(&world(), &camera(), &settings(SIZE, spp), &|_, _| {}).picture
}

fn wait_for(render: &Progressive, what: impl Fn(&Status) -> bool) {
    let start = Instant::now();
    while !what(&render.status()) {
        assert!(start.elapsed().as_secs() < 60, "{:?}", render.status());
        thread::sleep(Duration::from_micros(200));
    }
}

#[test]
fn the_last_picture_is_the_same_however_it_was_paused_and_refocused() {
    for spp in [1, 3, 16, 100] {
        let expected = rendered(spp);
        let quiet = start(spp);
        assert_eq!(quiet.wait(), Ending::Samples);
        assert_eq!(quiet.snapshot().picture, expected, "{spp} spp at one go");
        let busy = start(spp);
        for i in 0..40 {
            busy.pause();
            busy.set_focus(Vec2::new((i * 37 % 70) as f32, (i * 11 % 45) as f32));
            thread::sleep(Duration::from_micros(300));
            busy.resume();
            thread::sleep(Duration::from_micros(500));
        }
        assert_eq!(busy.wait(), Ending::Samples);
        assert_eq!(
            busy.snapshot().picture,
            expected,
            "{spp} spp with interruptions"
        );
        assert_eq!(busy.status().rays, quiet.status().rays, "{spp} spp");
        assert_eq!(busy.status().samples, f64::from(spp));
    }
}

#[test]
fn with_an_error_to_stop_at_it_is_the_picture_of_a_render_that_nobody_watches() {
    let mut settings = settings(SIZE, 1 << 10);
    settings.sampling.adaptive = true;
    settings.sampling.error = 0.03;
    let (expected, _) = render_lights(&world(), &camera(), &settings, &|_| {});
    assert!(
        expected.status.samples < 1024.0,
        "the test wants samples that go where the error is"
    );
    for _ in 0..4 {
        let render = Progressive::start(world(), camera(), settings.clone()).unwrap();
        assert_eq!(render.wait(), Ending::Error);
        assert_eq!(render.snapshot().picture, expected.picture);
    }
}

#[test]
fn a_file_has_threads_of_its_own_and_a_view_shares_those_of_views() {
    let pool = |priority| shared_pool(priority).unwrap();
    let (view, file) = (pool(Priority::View), pool(Priority::File));
    assert!(!Arc::ptr_eq(&view, &file));
    assert!(Arc::ptr_eq(&view, &pool(Priority::View)));
    let render = Progressive::start_for_file(world(), camera(), settings(SIZE, 4)).unwrap();
    assert_eq!(render.wait(), Ending::Samples);
    assert_eq!(render.snapshot().picture, as_a_file(4));
    assert!(Arc::ptr_eq(render.engine.pool.as_ref().unwrap(), &file));
}

#[test]
fn of_two_views_neither_waits_for_a_pass_of_the_other() {
    // Each of its passes is as long as all before it.
    let long = settings(UVec2::splat(256), 1 << 14);
    let long = Progressive::start(world(), camera(), long).unwrap();
    wait_for(&long, |status| status.trend.len() >= 7);
    let passes = |render: &Progressive| render.status().trend.len();
    let before = passes(&long);
    let short = start(4);
    assert_eq!(short.wait(), Ending::Samples);
    let ended = passes(&long) - before;
    // It takes the threads five times and more, and would have waited for as many passes; one may have been at its
    // end, and other tests share the threads.
    assert!(ended <= 2, "{ended} passes of the other ended meanwhile");
    assert_eq!(long.status().state, State::Running);
    long.cancel();
}

#[test]
fn views_that_are_rendered_at_the_same_time_get_on_as_fast_as_each_other() {
    let start = |side| {
        let endless = settings(UVec2::splat(side), 1 << 16);
        Progressive::start(world(), camera(), endless).unwrap()
    };
    // Passes of the large one have become long when the small ones begin.
    let large = start(384);
    wait_for(&large, |status| status.samples >= 4.0);
    let views = [large, start(48), start(96)];
    for view in &views {
        wait_for(view, |status| status.samples >= 1.0);
    }
    let rays = || views.each_ref().map(|view| view.status().rays.total());
    // Other tests share the threads, so that a view may have no turn for a while.
    let before = rays();
    let (mut all, mut is_even) = ([0; 3], false);
    for window in 0..30 {
        thread::sleep(Duration::from_millis(400));
        let now = rays();
        all = std::array::from_fn(|i| now[i] - before[i]);
        let [least, most] = [all.iter().min(), all.iter().max()].map(|rays| *rays.unwrap());
        is_even = most < 3 * least;
        if window >= 5 && is_even {
            break;
        }
    }
    assert!(is_even, "{all:?} rays");
    for view in views {
        assert_eq!(view.status().state, State::Running);
    }
}

#[test]
fn a_cancelled_render_keeps_whole_passes_of_tiles_only() {
    let mut passes = BTreeMap::new();
    let cancelled = start(1 << 12);
    wait_for(&cancelled, |status| status.samples > 5.0);
    cancelled.cancel();
    assert_eq!(cancelled.wait(), Ending::Cancelled);
    assert_eq!(cancelled.status().state, State::Ended(Ending::Cancelled));
    let film = cancelled.film();
    let picture = cancelled.snapshot().picture;
    for y in 0..SIZE.y {
        for x in 0..SIZE.x {
            let count = film.count(x, y);
            assert!(count.is_power_of_two(), "{count} samples at {x}, {y}");
            let expected = passes.entry(count).or_insert_with(|| rendered(count));
            assert_eq!(
                picture.pixel(x, y),
                expected.pixel(x, y),
                "{count} samples at {x}, {y}"
            );
        }
    }
}

#[test]
fn a_paused_render_stands_still_and_its_clock_too() {
    let render = start(1 << 12);
    wait_for(&render, |status| status.samples >= 2.0);
    render.pause();
    // What is under way ends within a batch; nothing comes after.
    let start = Instant::now();
    let mut status = render.status();
    loop {
        thread::sleep(Duration::from_millis(100));
        let now = render.status();
        if now.samples == status.samples && now.seconds == status.seconds {
            break;
        }
        assert!(start.elapsed().as_secs() < 60, "still going: {now:?}");
        status = now;
    }
    assert_eq!(status.state, State::Paused);
    let mut snapshot = render.snapshot();
    assert!(
        !render.refresh(&mut snapshot),
        "a picture that stands changed"
    );
    render.cancel();
    assert_eq!(render.wait(), Ending::Cancelled);
}

#[test]
fn a_snapshot_that_is_refreshed_equals_a_new_one() {
    let render = start(64);
    let mut snapshot = render.snapshot();
    while render.status().state == State::Running {
        render.refresh(&mut snapshot);
    }
    render.wait();
    render.refresh(&mut snapshot);
    assert_eq!(snapshot.picture, render.snapshot().picture);
    assert_eq!(snapshot.picture, rendered(64));
}

#[test]
fn a_region_gets_the_pictures_own_samples_and_the_rest_of_a_snapshot_stays() {
    let region = URect::new(20, 5, 40, 17);
    let grown = URect::new(16, 0, 48, 32);
    let render = Progressive::start_region(
        world(),
        camera(),
        settings(SIZE, 20),
        Some(region),
        &LightMix::default(),
    );
    let render = render.unwrap();
    let mut snapshot = Snapshot::black(SIZE);
    snapshot.picture.pixels.fill(Vec3::splat(7.0));
    assert_eq!(render.wait(), Ending::Samples);
    assert!(render.refresh(&mut snapshot));
    let (expected, film) = (rendered(20), render.film());
    for y in 0..SIZE.y {
        for x in 0..SIZE.x {
            let inside =
                UVec2::new(x, y).cmpge(grown.min).all() && UVec2::new(x, y).cmplt(grown.max).all();
            let shown = if inside {
                expected.pixel(x, y)
            } else {
                Vec3::splat(7.0)
            };
            assert_eq!(snapshot.picture.pixel(x, y), shown, "{x}, {y}");
            assert_eq!(film.count(x, y), if inside { 20 } else { 0 }, "{x}, {y}");
        }
    }
    let status = render.status();
    assert_eq!((status.samples, status.divider), (20.0, Some(1)));
    assert_eq!(status.rays.camera, 20 * u64::from(2 * 2 * TILE * TILE));
    assert!(
        !render.refresh(&mut snapshot),
        "a picture that stands changed"
    );
}

#[test]
fn a_pixel_has_the_samples_and_the_error_that_the_whole_film_says() {
    let render = start(16);
    render.wait();
    let (film, errors) = (render.film(), render.film().relative_errors());
    for pixel in [UVec2::ZERO, UVec2::new(33, 20), UVec2::new(69, 44)] {
        let (samples, error) = render.pixel(pixel).unwrap();
        assert_eq!(samples, film.count(pixel.x, pixel.y));
        assert_eq!(
            error.relative,
            errors[(pixel.y * SIZE.x + pixel.x) as usize]
        );
        let sum = film.sum(pixel.x, pixel.y);
        assert_eq!(render.pixel_sum(pixel), Some((sum, samples)));
    }
    assert_eq!(render.pixel(SIZE), None);
    assert_eq!(render.pixel_sum(SIZE), None);
}

#[test]
fn a_region_outside_the_picture_ends_at_once() {
    let outside = Some(URect::new(900, 0, 950, 9));
    let render = Progressive::start_region(
        world(),
        camera(),
        settings(SIZE, 20),
        outside,
        &LightMix::default(),
    )
    .unwrap();
    assert_eq!(render.wait(), Ending::Samples);
    assert_eq!(render.status().rays.total(), 0);
    assert_eq!(render.snapshot().picture, Picture::black(SIZE));
}

#[test]
fn samples_in_two_parts_are_the_samples_in_one() {
    let part = |samples| {
        let settings = settings(SIZE, 1);
        render_samples(&world(), &camera(), &settings, samples, &|_| {}).film
    };
    let mut film = part(37..41);
    assert!(film.merge(&part(0..37)));
    assert_eq!(film.picture(), as_a_file(41));
    assert!(!film.merge(&Film::new(UVec2::ONE)));
}

#[test]
fn the_picture_does_not_depend_on_the_number_of_threads() {
    let expected = rendered(20);
    for threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        assert_eq!(pool.install(|| rendered(20)), expected, "{threads} threads");
    }
}
