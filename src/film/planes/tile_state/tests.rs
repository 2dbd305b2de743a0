use super::*;
use crate::film::{Sum, test_scene};
use crate::trace::World;
use glam::UVec2;
use std::sync::Arc;

fn tile() -> TileState {
    let tile = Tile {
        origin: UVec2::new(16, 32),
        extent: UVec2::new(16, 5),
    };
    TileState::new(tile)
}

fn chunk(range: Range<u64>, of: u64, pixels: Pixels) -> Chunk {
    Chunk {
        tile: 0,
        pixels,
        planes: PlaneSet::ALL,
        range,
        of,
    }
}

fn subject() -> Subject {
    let settings = test_scene::settings(UVec2::new(64, 64), 8);
    let world = World {
        lights: Arc::default(),
        ..test_scene::world()
    };
    Subject::new(world, test_scene::camera(), settings, false)
}

/// Of each of these segments, one after the other.
fn sums(segments: impl IntoIterator<Item = Range<u64>>, pixels: Pixels) -> SumColumns {
    let mut sums = SumColumns::default();
    for segment in segments {
        let first = sums.len();
        sums.extend(TILE_PIXELS);
        for place in tile().tile.places(pixels) {
            let mut sum = Sum::default();
            for value in segment.clone() {
                sum.add(Vec3::splat((value * 1000 + place as u64) as f32));
            }
            sums.set(first + place, &sum);
        }
    }
    sums
}

#[test]
fn a_chunk_from_the_first_sample_on_is_cut_at_the_powers_of_two() {
    let segments = |range, of| chunk(range, of, Pixels::All).segments().collect::<Vec<_>>();
    assert_eq!(segments(0..11, 11), [0..1, 1..2, 2..4, 4..8, 8..11]);
    assert_eq!(segments(4..8, 4).as_slice(), std::slice::from_ref(&(4..8)));
    assert_eq!(segments(0..8, 16).as_slice(), std::slice::from_ref(&(0..8)));
    assert_eq!(segments(3..3, 0), []);
}

#[test]
fn the_pieces_of_a_pass_enter_the_pixels_together_in_any_order() {
    let mut whole = tile();
    let start = chunk(0..4, 4, Pixels::All);
    let first = sums(start.segments(), Pixels::All);
    assert!(whole.absorb(&subject(), &start, first.all(), 10));
    let mut pieces = tile();
    assert!(pieces.absorb(&subject(), &start, first.all(), 10));
    let rest = sums(std::iter::once(4..8), Pixels::All);
    assert!(whole.absorb(&subject(), &chunk(4..8, 4, Pixels::All), rest.all(), 10));
    for (range, half, complete) in [
        (6..8, 1, false),
        (6..8, 0, false),
        (4..6, 0, true),
        (4..6, 1, true),
    ] {
        let before = pieces.film_tile();
        let piece = chunk(range.clone(), 4, Pixels::Half(half));
        let sums = sums(std::iter::once(range), Pixels::Half(half));
        let done = pieces.absorb(&subject(), &piece, sums.all(), 0);
        assert_eq!(done, complete);
        assert_eq!(pieces.film_tile() == before, !complete);
    }
    assert!(pieces.pending.is_none());
    assert_eq!(whole.film_tile(), pieces.film_tile());
    assert_eq!(whole.moves, pieces.moves);
    assert_eq!(whole.samples, 8 * 80);
    assert_eq!((whole.count(0), whole.count(1)), (Some(8), Some(8)));
    assert_eq!(whole.moves.map(|moves| moves.pixels), [40; 2]);
    let film = whole.take_film_tile();
    assert_eq!(film, pieces.film_tile());
    assert_eq!(
        film.sum(TILE_PIXELS - 1),
        Sum::default(),
        "outside the picture"
    );
}

#[test]
fn samples_that_are_all_alike_leave_what_their_sums_leave() {
    let size = UVec2::splat(16);
    let origin = UVec2::ZERO;
    let tile = || {
        TileState::new(Tile {
            origin,
            extent: size,
        })
    };
    let color = Vec3::new(0.1, 7.0, 1e-30);
    let (mut even, mut summed) = (tile(), tile());
    for (range, pixels) in [
        (0..4, Pixels::All),
        (4..8, Pixels::Half(1)),
        (8..11, Pixels::Half(1)),
        (4..8, Pixels::Half(0)),
    ] {
        let length = range.end - range.start;
        let chunk = chunk(range, length, pixels);
        let mut sums = SumColumns::default();
        for segment in chunk.segments() {
            let first = sums.len();
            sums.extend(TILE_PIXELS);
            let sum = Sum::of_many(color, segment.end - segment.start);
            let places = tile().tile.places(pixels);
            places.for_each(|place| sums.set(first + place, &sum));
        }
        assert!(summed.absorb(&subject(), &chunk, sums.all(), 9));
        assert!(even.absorb_even(&subject(), &chunk, color, 9));
        assert_eq!(even.means(), summed.means());
        assert_eq!(even.film_tile().sums, summed.film_tile().sums);
        assert_eq!(
            even.film_tile().past.columns(),
            summed.film_tile().past.columns()
        );
        assert_eq!((even.rays, even.samples), (summed.rays, summed.samples));
        assert_eq!(even.planes.counts(), summed.planes.counts());
        for (even, summed) in even.moves().into_iter().zip(summed.moves()) {
            let reach = |moves: Moves| [moves.reach.absolute, moves.reach.relative];
            for (even, summed) in reach(even).into_iter().zip(reach(summed)) {
                assert!((even / summed - 1.0).abs() < 1e-12);
            }
            let others = |moves: Moves| (moves.absolute, moves.relative, moves.count);
            assert_eq!(others(even), others(summed));
            assert_eq!(even.pixels, summed.pixels);
        }
    }
    // What comes in between, as it would from a file, is added to it.
    let chunk = chunk(8..9, 1, Pixels::Half(0));
    let mut sums = SumColumns::default();
    sums.reset(TILE_PIXELS);
    sums.add(0, &[Vec3::ONE; 4]);
    for tile in [&mut even, &mut summed] {
        tile.absorb(&subject(), &chunk, sums.all(), 1);
    }
    assert_eq!(even.take_film_tile().sums, summed.take_film_tile().sums);
    // Of later samples by themselves it is not known how far they moved.
    let mut later = tile();
    later.absorb_even(&subject(), &self::chunk(4..8, 4, Pixels::All), color, 1);
    assert_eq!(later.film_tile().past.columns()[0][0], f32::INFINITY);
}

#[test]
fn how_far_a_mean_moved_is_kept_for_the_last_three_doublings() {
    let mut tile = tile();
    let start = chunk(0..8, 8, Pixels::All);
    let sums = sums(start.segments(), Pixels::All);
    tile.absorb(&subject(), &start, sums.all(), 0);
    // Means of 0..1, 0..2, 0..4, 0..8 in thousands: 0, 0.5, 1.5, 3.5.
    let film = tile.film_tile();
    let moved = film.past.columns().map(|column| column[0]);
    assert_eq!(moved, [4e6, 1e6, 0.25e6]);
}
