//! Medians of rounds in which everything that is compared takes turns.

use std::time::Instant;

/// Seconds that `work` takes.
pub(super) fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The middle one, or the mean of the middle two; not a number where there is none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    match values.len() {
        0 => f64::NAN,
        count if count % 2 == 1 => values[half],
        _ => 0.5 * (values[half - 1] + values[half]),
    }
}

/// Median seconds of each of `count` pieces of work, which take turns for some rounds. Each round begins with another, since
/// what comes before leaves its mark in caches. A first round warms them and is not counted.
pub(super) fn take_turns(count: usize, rounds: usize, mut work: impl FnMut(usize)) -> Vec<f64> {
    let mut times = vec![Vec::with_capacity(rounds); count];
    for round in 0..=rounds {
        for turn in 0..count {
            let i = (turn + round) % count;
            let time = seconds(|| work(i));
            if round > 0 {
                times[i].push(time);
            }
        }
    }
    times.into_iter().map(median).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_takes_its_turn_in_every_round_and_comes_first_in_one() {
        let mut order = Vec::new();
        let times = take_turns(3, 2, |i| order.push(i));
        assert_eq!(order, [0, 1, 2, 1, 2, 0, 2, 0, 1]);
        assert_eq!(times.len(), 3);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
    }
}
