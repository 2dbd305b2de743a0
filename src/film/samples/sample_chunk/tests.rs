use super::*;
use crate::film::sums::tiles::{Pixels, TileGrid};
use crate::film::test_scene;
use glam::UVec2;

/// All samples of the first tile.
fn whole_tile(subject: &Subject, samples: u64) -> (Tile, Chunk) {
    let tile = TileGrid::new(subject.settings.size).tile(0);
    let chunk = Chunk {
        tile: 0,
        pixels: Pixels::All,
        planes: PlaneSet::ALL,
        range: 0..samples,
        of: samples,
    };
    (tile, chunk)
}

#[test]
fn a_chunk_stops_between_the_surfaces_that_one_sample_goes_through_and_forgets_it() {
    let (world, camera) = test_scene::sheets(40);
    let settings = test_scene::settings(UVec2::new(16, 16), 1);
    let subject = Subject::new(world, camera, settings, false);
    let (tile, chunk) = whole_tile(&subject, 1);
    let batch = BatchSize::new(&subject);
    let sum = |scratch: &mut Scratch, most: u32| {
        let asked = Cell::new(0);
        let work = Work {
            subject: &subject,
            batch: &batch,
            kept: None,
            stopped: &|| {
                asked.set(asked.get() + 1);
                asked.get() > most
            },
        };
        let rays = scratch.sum_chunk(&work, tile, &chunk);
        (rays, asked.get(), scratch.sums.clone())
    };
    let mut scratch = Scratch::default();
    let (rays, asked, whole) = sum(&mut scratch, u32::MAX);
    // Every sample goes through them all; some go on by chance where little is left.
    let rays = rays.unwrap();
    assert!(rays.transmission >= 36 * rays.camera, "{rays:?}");
    assert!(asked >= 36, "asked {asked} times");
    for most in [0, 1, 30] {
        let (rays, asked, _) = sum(&mut scratch, most);
        assert_eq!((rays, asked), (None, most + 1));
        let (again, _, sums) = sum(&mut scratch, u32::MAX);
        assert!(again.is_some() && sums == whole, "after {most}");
    }
}

#[test]
fn a_chunk_that_stops_is_not_said_to_have_met_anything() {
    let settings = test_scene::settings(UVec2::new(16, 16), 4);
    let subject = Subject::new(test_scene::world(), test_scene::camera(), settings, false);
    let (tile, chunk) = whole_tile(&subject, 4);
    let batch = BatchSize::new(&subject);
    let mut scratch = Scratch::default();
    let mut sum = |stops: bool| {
        let work = Work {
            subject: &subject,
            batch: &batch,
            kept: None,
            stopped: &|| stops,
        };
        let done = scratch.sum_chunk(&work, tile, &chunk);
        (done.is_some(), scratch.octaves.iter().sum::<u32>())
    };
    assert_eq!(sum(true), (false, 0));
    assert_eq!(sum(false), (true, 4 * TILE_PIXELS as u32));
    assert_eq!(sum(true), (false, 4 * TILE_PIXELS as u32));
    assert_eq!(sum(false), (true, 8 * TILE_PIXELS as u32));
}

#[test]
fn the_sums_of_a_chunk_are_those_of_its_samples_one_by_one_whatever_a_batch_holds() {
    let settings = test_scene::settings(UVec2::new(16, 16), 64);
    let (world, camera) = (test_scene::world(), test_scene::camera());
    let subject = Subject::new(world.clone(), camera.clone(), settings.clone(), false);
    let (tile, _) = whole_tile(&subject, 1);
    let mut scratch = Scratch::default();
    for (pixels, range) in [
        (Pixels::All, 0..1),
        (Pixels::All, 2..9),
        (Pixels::All, 3..24),
        (Pixels::Half(1), 8..45),
    ] {
        let chunk = Chunk {
            tile: 0,
            pixels,
            planes: PlaneSet::ALL,
            range: range.clone(),
            of: range.end - range.start,
        };
        let places: Vec<_> = tile.places(pixels).collect();
        let ids: Vec<_> = (places.iter())
            .flat_map(|place| {
                let pixel = pixel_in_tile(*place);
                range.clone().map(move |index| SampleId { pixel, index })
            })
            .collect();
        let batch = BatchSize::new(&subject);
        let planes = subject.planes();
        let mut one_by_one = SumColumns::default();
        one_by_one.reset(planes * TILE_PIXELS);
        for (i, id) in ids.iter().enumerate() {
            let one = std::iter::once(*id);
            let taken = scratch.evaluate(&subject, PlaneSet::ALL, one, &batch, &|| false);
            assert!(taken.is_some());
            let place = places[i / (range.end - range.start) as usize];
            for plane in 0..planes {
                one_by_one.add(plane * TILE_PIXELS + place, &scratch.values[plane..=plane]);
            }
        }
        for size in [1, 3, 16, 100, 512] {
            batch.now.store(size, Ordering::Relaxed);
            let work = Work {
                subject: &subject,
                batch: &batch,
                kept: None,
                stopped: &|| false,
            };
            assert!(scratch.sum_chunk(&work, tile, &chunk).is_some());
            assert!(scratch.sums == one_by_one, "{range:?}, {size} at once");
        }
    }
}

#[test]
fn among_many_lights_a_batch_is_of_some_samples_and_stops_between_lights() {
    let settings = test_scene::settings(UVec2::new(16, 16), 1);
    let world = test_scene::many(1..2001);
    let subject = Subject::new(world, test_scene::camera(), settings, false);
    let (tile, chunk) = whole_tile(&subject, 1);
    let batch = BatchSize::new(&subject);
    assert_eq!(batch.get(), LEAST_OF_MANY_LIGHTS);
    batch.learn(LEAST_OF_MANY_LIGHTS, LONG + LONG);
    assert_eq!(batch.get(), LEAST_OF_MANY_LIGHTS);
    let asked = Cell::new(0);
    let work = Work {
        subject: &subject,
        batch: &batch,
        kept: None,
        stopped: &|| {
            asked.set(asked.get() + 1);
            true
        },
    };
    let mut scratch = Scratch::default();
    let taken = scratch.take_samples(
        &work,
        tile.origin,
        &BatchPlaces {
            tile: 0,
            places: &tile.places(Pixels::All).collect::<Vec<_>>(),
            indices: 0..1,
            by_place: false,
        },
        chunk.planes,
    );
    assert_eq!((taken, asked.get()), (None, 1));
}
