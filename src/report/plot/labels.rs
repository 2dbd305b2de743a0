//! Where words stand beside points, so that none covers another or a point.

/// Pixels between a word and what it keeps away from.
const GAP: i32 = 3;
/// How far from their points words may stand, the nearest first: in half heights of a word.
const RINGS: i32 = 7;
/// From where a word is so far away that a thin line leads to it, in rings.
const LED: i32 = 2;

/// A word's rectangle: its middle, and half its width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Frame {
    middle: (i32, i32),
    half: (i32, i32),
}

impl Frame {
    fn meets(&self, other: &Self) -> bool {
        let apart = |a: i32, b: i32, reach: i32| (a - b).abs() >= reach + GAP;
        let (x, y) = (self.half.0 + other.half.0, self.half.1 + other.half.1);
        !apart(self.middle.0, other.middle.0, x) && !apart(self.middle.1, other.middle.1, y)
    }

    /// How many pixels of its reach lie beyond these borders.
    fn beyond(&self, size: (i32, i32)) -> i32 {
        let over = |middle: i32, half: i32, size: i32| {
            (half - middle).max(0) + (middle + half - size).max(0)
        };
        over(self.middle.0, self.half.0, size.0) + over(self.middle.1, self.half.1, size.1)
    }
}

/// A word that wants a place: the pixel of its point, and half its own width and height.
pub(super) type Word = ((i32, i32), (i32, i32));

/// Where a word stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Its middle.
    pub at: (i32, i32),
    /// Whether a line from its point should lead to it.
    pub led: bool,
}

/// A place for each word, in their order: the first around its point that is free. `markers` are all of the plot, each
/// its middle and half its width; `size` is the area's.
/// Where no place is free it is the one that covers least.
pub(super) fn places(
    markers: &[((i32, i32), i32)],
    words: &[Word],
    size: (i32, i32),
) -> Vec<Place> {
    let mut taken: Vec<Frame> = markers
        .iter()
        .map(|&(middle, half)| Frame {
            middle,
            half: (half, half),
        })
        .collect();
    let mut places = Vec::with_capacity(words.len());
    for &(point, half) in words {
        let cost = |frame: &Frame| {
            let covers = taken.iter().filter(|other| frame.meets(other)).count() as i32;
            1000 * covers + frame.beyond(size)
        };
        let here = markers.iter().filter(|(at, _)| *at == point);
        let marker = here.map(|(_, half)| *half).max().unwrap_or(0);
        // `min_by_key` takes the first of equals: the nearest.
        let best = around(point, half, marker).min_by_key(|(_, frame)| cost(frame));
        let Some((ring, frame)) = best else { continue };
        taken.push(frame);
        places.push(Place {
            at: frame.middle,
            led: ring >= LED,
        });
    }
    places
}

/// Places around a point, from the nearest ones on: above first, then beside, below and across.
fn around((x, y): (i32, i32), half: (i32, i32), marker: i32) -> impl Iterator<Item = (i32, Frame)> {
    const WAYS: [(i32, i32); 8] = [
        (0, -1),
        (1, 0),
        (0, 1),
        (-1, 0),
        (1, -1),
        (1, 1),
        (-1, 1),
        (-1, -1),
    ];
    (0..RINGS).flat_map(move |ring| {
        WAYS.into_iter().map(move |(right, down)| {
            let step = marker + GAP + ring * half.1;
            let middle = (x + right * (step + half.0), y + down * (step + half.1));
            (ring, Frame { middle, half })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (i32, i32) = (800, 600);
    const WORD: (i32, i32) = (9, 8);

    #[test]
    fn a_word_alone_stands_above_its_point() {
        let places = places(&[((100, 100), 5)], &[((100, 100), WORD)], SIZE);
        assert_eq!(places.len(), 1);
        assert_eq!(places[0].at, (100, 100 - 5 - GAP - 8));
        assert!(!places[0].led);
        // Above all markers that are there.
        let places = super::places(
            &[((100, 100), 5), ((100, 100), 10)],
            &[((100, 100), WORD)],
            SIZE,
        );
        assert_eq!(places[0].at, (100, 100 - 10 - GAP - 8));
    }

    #[test]
    fn words_of_points_in_a_heap_cover_neither_each_other_nor_a_point_and_stay_inside() {
        for (dx, dy) in [(1, 0), (9, 1), (3, -3), (0, 0)] {
            let points: Vec<(i32, i32)> = (0..8).map(|i| (60 + i * dx, 590 + i * dy)).collect();
            let words: Vec<_> = points.iter().map(|&point| (point, WORD)).collect();
            let markers: Vec<_> = points.iter().map(|&point| (point, 5)).collect();
            let places = places(&markers, &words, SIZE);
            assert_eq!(places.len(), words.len());
            let frames: Vec<Frame> = places
                .iter()
                .map(|place| Frame {
                    middle: place.at,
                    half: WORD,
                })
                .collect();
            for (i, frame) in frames.iter().enumerate() {
                assert_eq!(frame.beyond(SIZE), 0, "{dx} {dy}: {frame:?}");
                let marks = points.iter().map(|&middle| Frame {
                    middle,
                    half: (5, 5),
                });
                for other in frames[..i].iter().copied().chain(marks) {
                    assert!(!frame.meets(&other), "{dx} {dy}: {frame:?} on {other:?}");
                }
            }
        }
    }
}
