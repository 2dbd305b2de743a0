//! The hard cases: where renderers break, with figures and verdicts.
//!
//! Every row is a function of the number of rays; the tests call the same functions with fewer.

mod angles;
mod cases;
mod edits;
mod environment;
mod errors;
mod far;
mod hairball;
mod inherited_motion;
mod light;
mod maps;
mod motion_and_lens;
mod parallel;
mod pictures;
mod rays;
mod rooms;
mod scenes;
mod transparency;
mod trees;

use super::{Options, Section, Table, Watch};
use crate::film::views::Shown;
use cases::CASES;

/// How much is shot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Rays of a row where rays are counted.
    pub rays: usize,
    /// Triangles of the hairball.
    pub hairball: usize,
    /// Edits.
    pub edits: usize,
    /// Chooses the random numbers.
    pub seed: u64,
}

impl Effort {
    fn of(options: &Options) -> Self {
        let (rays, hairball, edits) = if options.quick {
            (100_000, 100_000, 200)
        } else {
            (10_000_000, 1_000_000, 1_000)
        };
        Self {
            rays,
            hairball,
            edits,
            seed: u64::from(options.seed),
        }
    }
}

/// What came out of a case.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// Rays, pixels or whatever was counted.
    pub counted: u64,
    /// The figures, in words.
    pub figures: String,
    /// Why it does not pass; empty where it does.
    pub faults: Vec<String>,
}

impl Outcome {
    /// So many were counted, with these figures.
    pub fn new(counted: usize, figures: impl Into<String>) -> Self {
        Self {
            counted: counted as u64,
            figures: figures.into(),
            faults: Vec::new(),
        }
    }

    /// Does not pass unless this is true.
    pub fn require(mut self, holds: bool, what: impl Into<String>) -> Self {
        if !holds {
            self.faults.push(what.into());
        }
        self
    }
}

/// Runs all of them.
pub fn measure(options: &Options, watch: Watch) -> Section {
    let effort = Effort::of(options);
    let mut table = Table::new(
        "stability",
        "The hard cases",
        &[
            "#",
            "case",
            "counted",
            "figures",
            "passes when",
            "verdict",
            "seconds",
        ],
    );
    let mut section = Section {
        title: "Stability: the hard cases".into(),
        method: method(),
        ..Section::default()
    };
    let mut rays = 0;
    for (done, case) in CASES.iter().enumerate() {
        watch(
            &format!("{} {}", case.number, case.name),
            done as u64,
            CASES.len() as u64,
        );
        let start = std::time::Instant::now();
        let outcome = (case.run)(&effort);
        let seconds = start.elapsed().as_secs_f64();
        rays += outcome.counted;
        let passed = outcome.faults.is_empty();
        table.push([
            u64::from(case.number).into(),
            case.name.into(),
            outcome.counted.into(),
            outcome.figures.into(),
            case.passes.into(),
            (if passed { "passes" } else { "FAILS" }).into(),
            seconds.into(),
        ]);
        let faults = outcome.faults.into_iter();
        section
            .failures
            .extend(faults.map(|fault| format!("case {} ({}): {fault}", case.number, case.name)));
    }
    let failed = table
        .rows
        .iter()
        .filter(|row| row.contains(&"FAILS".into()))
        .count();
    section.findings.push(format!(
        "{} of the {} hard cases pass, over {} rays, pixels and edits counted.",
        CASES.len() - failed,
        CASES.len(),
        super::table::digits(rays as f64, 3),
    ));
    watch("pictures of hard cases", 0, 1);
    section.pictures = shown();
    section.summary = Some(0);
    section.tables.push(table);
    section
}

fn method() -> Vec<String> {
    vec![
        "Two oracles know no tree: every triangle in turn with the same test in f32, with which the tree must agree to the last \
         bit; and every triangle in f64, with which it must agree except in a band around edges, where an edge function is \
         smaller than its own bound of error (`in the band`: how many rays passed through one)."
            .into(),
        "Bounds that no renderer passes exactly. 9 and 11: t is off by at most Σ (Eᵢ + 4u|Uᵢ|)|zᵢ - z| / (|det| - Σ Eᵢ) / |dz| \
         and relative roundings of z and dz, where Uᵢ are the edge functions in f64, Eᵢ = δ(|Px| + |Py| + |Qx| + |Qy|) + 2δ² + \
         2u(|Px Qy| + |Py Qx|) the error of each in f32, δ = 6u · the largest coordinate relative to the ray's origin, u = 2^-24; \
         it follows from the rounding of every operation of the test. 27: a facet turns dark where its own normal turns away from \
         the light, while the smooth normal still sees it: so at most sin of the largest angle between the two is lost, of the \
         value that faces the light; a convex mesh shadows nothing else of itself."
            .into(),
    ]
}

/// Acne, contact, terminator and seam.
fn shown() -> Vec<(String, String, Shown)> {
    pictures::all()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FEW: Effort = Effort {
        rays: 20_000,
        hairball: 20_000,
        edits: 150,
        seed: 3,
    };

    #[test]
    fn every_hard_case_passes() {
        assert!(CASES.is_sorted_by(|a, b| a.number < b.number));
        for case in CASES {
            let outcome = (case.run)(&FEW);
            println!("{} {}: {}", case.number, case.name, outcome.figures);
            assert!(outcome.counted > 0, "case {} counted nothing", case.number);
            assert!(
                outcome.faults.is_empty(),
                "case {}, {}: {:?}",
                case.number,
                case.name,
                outcome.faults
            );
        }
    }

    #[test]
    fn the_pictures_of_hard_cases_show_something() {
        for (name, _, shown) in shown() {
            let first = shown.pixels[0];
            let others = shown.pixels.iter().filter(|pixel| **pixel != first).count();
            assert!(others > shown.pixels.len() / 10, "{name} is blank");
        }
    }
}
