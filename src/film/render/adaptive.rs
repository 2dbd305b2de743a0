//! Which pixels get more samples: those whose error falls most for the rays that it takes.
//!
//! Tiles are halved like a chessboard, and each half gets the samples that the other half's pixels
//! ask for. Pixels do not share random numbers, so how many samples a pixel gets does not depend on
//! what its own samples were, and their mean stays unbiased; and what its half moved was not chosen
//! to be small, so the error estimate stays what it is with the same samples for all. (What is left
//! is of second order: the other half's samples were as many as this half's asked for.)

use crate::film::errors::error::{Decline, Moves};
use crate::film::sums::tiles::Pixels;
use std::cmp::Ordering;
use std::ops::Range;

/// Half of the pixels of a tile.
#[derive(Clone, Copy, Debug)]
pub(in crate::film) struct Cell {
    pub tile: u32,
    pub half: usize,
    /// What these pixels have moved.
    pub own: Moves,
    /// What the pixels of the other half have: they decide.
    pub other: Moves,
    /// Rays that a sample takes.
    pub rays: f64,
}

/// More samples for some pixels of a tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Task {
    pub tile: u32,
    pub pixels: Pixels,
    pub range: Range<u64>,
}

/// Rays of a round, at least and at most, as a part of those before it: few rounds follow one another,
/// and what each finds out directs the next.
const LEAST_SHARE: f64 = 0.02;
const LARGEST_SHARE: f64 = 0.25;
/// A round aims a little below the goal, because the estimates that choose are not those that judge.
const AIM: f64 = 0.95;

/// A cell's next doubling.
struct Step {
    cell: usize,
    range: Range<u64>,
    /// By how much it lowers the sum of squared errors.
    gain: f64,
    /// Rays that it takes.
    rays: f64,
}

/// The cells whose samples are doubled next, up to `most` a pixel, so that the sum over all pixels of
/// the relative squared error falls to `goal` soonest; and once it is there, those in which unmet light
/// may still hide more (`hidden` times what they err by it). Empty where all have `most`.
pub(super) fn choose(cells: &[Cell], most: u64, goal: f64, hidden: f64) -> Vec<Task> {
    let (mut error, mut spent) = (0.0, 0.0);
    let mut steps = Vec::new();
    let decline = Decline::of(cells.iter().map(|cell| &cell.own));
    for (i, cell) in cells.iter().enumerate() {
        let count = u64::from(cell.own.count);
        let pixels = f64::from(cell.own.pixels);
        let expected = foreseen(cell, &decline);
        error += expected;
        spent += pixels * count as f64 * cell.rays;
        let next = (2 * count).min(most);
        if next > count {
            steps.push(Step {
                cell: i,
                gain: expected * (1.0 - decline.relative),
                rays: pixels * (next - count) as f64 * cell.rays,
                range: count..next,
            });
        }
    }
    steps.sort_by(|a, b| {
        let by_worth = (b.gain * a.rays).partial_cmp(&(a.gain * b.rays));
        by_worth
            .unwrap_or(Ordering::Equal)
            .then(a.cell.cmp(&b.cell))
    });
    let mut rays = 0.0;
    let mut chosen = Vec::new();
    let small = goal > 0.0 && error <= goal;
    let something_moves = steps.iter().any(|step| step.gain > 0.0);
    for step in steps {
        let blind = small && hidden * unseen(&cells[step.cell]) > goal;
        let enough = rays >= LEAST_SHARE * spent && error <= AIM * goal;
        // Where all samples of a half are alike, most often of nothing, more of them would only fill up a round.
        let idle = something_moves && step.gain == 0.0;
        if !blind && (enough || idle || rays >= LARGEST_SHARE * spent) {
            continue;
        }
        rays += step.rays;
        error -= step.gain;
        let cell = &cells[step.cell];
        chosen.push(Task {
            tile: cell.tile,
            pixels: Pixels::Half(cell.half),
            range: step.range,
        });
    }
    together(chosen)
}

/// How much these pixels err by light that no sample has met, for each sample; the darker half decides.
fn unseen(cell: &Cell) -> f64 {
    let of = |moves: &Moves| moves.reach_with(cell.own.count).relative;
    of(&cell.own).max(of(&cell.other))
}

/// What the other half says of this one: its relative squared error.
fn foreseen(cell: &Cell, decline: &Decline) -> f64 {
    // A picture of one column may have a half without pixels: then the own ones must do.
    let source = if cell.other.pixels > 0 {
        &cell.other
    } else {
        &cell.own
    };
    let Some(expected) = source.expected(decline) else {
        return 0.0;
    };
    let doublings = f64::from(cell.own.count).log2() - f64::from(source.count).log2();
    let per_pixel = expected.relative / f64::from(source.pixels);
    per_pixel * f64::from(cell.own.pixels) * decline.relative.powf(doublings)
}

/// Both halves of a tile with the same samples become one task.
fn together(mut tasks: Vec<Task>) -> Vec<Task> {
    tasks.sort_by_key(|task| (task.tile, task.range.start, task.pixels));
    let mut joined: Vec<Task> = Vec::with_capacity(tasks.len());
    for task in tasks {
        match joined.last_mut() {
            Some(last) if last.tile == task.tile && last.range == task.range => {
                last.pixels = Pixels::All;
            }
            _ => joined.push(task),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(tile: u32, half: usize, own: (f64, u32), other: (f64, u32)) -> Cell {
        let moves = |(square, count): (f64, u32)| Moves {
            absolute: [square, 2.0 * square, 4.0 * square],
            relative: [square, 2.0 * square, 4.0 * square],
            count,
            pixels: 128,
            ..Moves::default()
        };
        Cell {
            tile,
            half,
            own: moves(own),
            other: moves(other),
            rays: 2.0,
        }
    }

    #[test]
    fn a_half_gets_what_the_other_half_asks_for() {
        // Of tile 0 only half 1 moved, so half 0 gets the samples; nothing moved in tile 1.
        let cells = [
            cell(0, 0, (0.0, 16), (1.0, 16)),
            cell(0, 1, (1.0, 16), (0.0, 16)),
            cell(1, 0, (0.0, 16), (0.0, 16)),
            cell(1, 1, (0.0, 16), (0.0, 16)),
        ];
        let tasks = choose(&cells, 1 << 20, 0.1, 0.0);
        assert_eq!(
            tasks,
            [Task {
                tile: 0,
                pixels: Pixels::Half(0),
                range: 16..32
            }]
        );
    }

    #[test]
    fn halves_in_which_nothing_moves_get_samples_only_where_nothing_moves_anywhere() {
        let mut cells: Vec<_> = (0..50)
            .flat_map(|tile| [0, 1].map(|half| cell(tile, half, (0.0, 16), (0.0, 16))))
            .collect();
        let task = |tile, pixels| Task {
            tile,
            pixels,
            range: 16..32,
        };
        assert_eq!(choose(&cells, 1 << 20, 0.0, 0.0), [task(0, Pixels::All)]);
        // One moves: less than the least share of the rays, and no reason to take more.
        let moved = (1.0, 16);
        cells[20] = cell(10, 0, moved, moved);
        let one = task(10, Pixels::Half(0));
        assert_eq!(choose(&cells, 1 << 20, 0.6 / AIM, 0.0), [one]);
    }

    #[test]
    fn what_lowers_the_error_most_for_its_rays_comes_first() {
        let mut cells: Vec<_> = (0..100)
            .flat_map(|tile| {
                let moved = (f64::from(tile), 16);
                [cell(tile, 0, moved, moved), cell(tile, 1, moved, moved)]
            })
            .collect();
        cells[198].rays = 10.0;
        cells[199].rays = 10.0;
        let tasks = choose(&cells, 1 << 20, 0.0, 0.0);
        assert!(tasks.iter().all(|task| task.range == (16..32)));
        let tiles: Vec<_> = tasks.iter().map(|task| task.tile).collect();
        assert!(
            tiles.contains(&98) && !tiles.contains(&99) && !tiles.contains(&1),
            "{tiles:?}"
        );
    }

    #[test]
    fn no_pixel_gets_more_than_the_most_and_in_the_end_all_have_it() {
        let cells = [
            cell(0, 0, (0.0, 100), (0.0, 100)),
            cell(0, 1, (1.0, 64), (0.0, 100)),
        ];
        assert_eq!(
            choose(&cells, 100, 0.0, 0.0),
            [Task {
                tile: 0,
                pixels: Pixels::Half(1),
                range: 64..100
            }]
        );
        assert_eq!(choose(&cells[..1], 100, 0.0, 0.0), []);
    }

    #[test]
    fn a_round_does_no_more_than_the_goal_needs() {
        let cells: Vec<_> = (0..100)
            .flat_map(|tile| [0, 1].map(|half| cell(tile, half, (1.0, 16), (1.0, 16))))
            .collect();
        // 200 in all; every step takes away a half of one.
        let near = choose(&cells, 1 << 20, 199.0 / AIM, 0.0);
        let far = choose(&cells, 1 << 20, 1.0, 0.0);
        let steps = |tasks: &[Task]| {
            tasks
                .iter()
                .map(|t| 1 + usize::from(t.pixels == Pixels::All))
                .sum::<usize>()
        };
        assert_eq!((steps(&near), steps(&far)), (4, 50));
    }
}
