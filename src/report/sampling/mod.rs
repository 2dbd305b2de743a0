//! How fast the picture's error falls, for each way to choose samples.

mod curve;
mod gains;
mod rows;

use super::{Options, Section, Subject, Table, Watch};
use crate::film::RELATIVE_FLOOR;
use curve::{Effort, Way, curve, reference, shrunk};
use gains::Gains;
use rows::{plot, point_cells, slope_cells};

/// The error whose time is told.
const GOAL: f64 = 0.01;

/// Measures all scenes.
pub fn measure(subjects: &[Subject], options: &Options, watch: Watch) -> Section {
    let effort = Effort::of(options);
    let mut points_table = Table::new(
        "sampling",
        "Error of the picture, against samples, seconds and rays",
        &[
            "scene",
            "samples chosen",
            "samples a pixel",
            "seconds",
            "Mrays",
            "RMSE",
            "relative MSE",
            "relative error",
            "film's estimate",
            "estimate / true",
        ],
    );
    let mut slopes_table = Table::new(
        "slopes",
        "How fast the relative error falls: error ~ x^slope; and when it reaches 1 %",
        &[
            "scene",
            "samples chosen",
            "slope over samples",
            "over rays",
            "over seconds",
            "film's own, over seconds",
            "seconds to 1 %",
            "Mrays to 1 %",
            "1 % is",
        ],
    );
    let mut section = Section {
        title: "Sampling: error against time".into(),
        method: method(&effort),
        ..Section::default()
    };
    let mut gains = Gains::default();
    for subject in subjects {
        let settings = shrunk(subject, &effort, options);
        let what = format!("sampling of {}", subject.name);
        let pictures = (effort.counts.len() * Way::ALL.len()) as u64 * u64::from(effort.seeds);
        let mut done = 0;
        let mut step = || {
            done += 1;
            watch(&what, done, pictures);
        };
        watch(&what, 0, pictures);
        let reference = reference(subject, &settings, &effort);
        let curves =
            Way::ALL.map(|way| curve(way, subject, &settings, &effort, &reference, &mut step));
        for (way, curve) in Way::ALL.iter().zip(&curves) {
            for point in curve {
                points_table.push(point_cells(&subject.name, *way, point));
            }
            slopes_table.push(slope_cells(&subject.name, *way, curve));
        }
        gains.add(&curves);
        section
            .plots
            .push(plot(subject, &curves, "seconds", "seconds", |point| {
                point.seconds
            }));
        section
            .plots
            .push(plot(subject, &curves, "rays", "million rays", |point| {
                point.rays * 1e-6
            }));
    }
    section.findings = gains.findings();
    section.summary = Some(1);
    section.tables = vec![points_table, slopes_table];
    section
}

fn method(effort: &Effort) -> Vec<String> {
    vec![format!(
        "Pictures of {} pixels on the longer side, {} seeds each, against a reference of {} samples a pixel with another seed. \
         Squared errors are averaged over seeds; seconds are the median. `relative MSE` is the mean over pixels of squared \
         error / (value² + {RELATIVE_FLOOR}), each averaged over the channels, `relative error` its root. Jitter is on a grid \
         with as many cells as samples. Adaptive sampling gets as its goal what the film estimates for Sobol points with the \
         same number of samples for every pixel. Slopes are least squares through logarithms; where 1 % lies beyond what was \
         measured (extrapolated), along the fitted line; where the first point is there, it is reached there at most. The film's own slope is that of its estimates over its last two doublings, as the \
         editor shows it while it renders. The estimate is calibrated for Sobol points and for independent numbers from 16 samples on; \
         it is known to be off where the edge of a bright lamp runs exactly along a row of pixels.",
        effort.side, effort.seeds, effort.reference
    )]
}
