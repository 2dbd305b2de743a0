//! How the error of the running render falls: error against time, both by their logarithms, where
//! a straight line is a power law and its slope the exponent.

use super::super::says::{Says, name_control};
use super::super::status::{error_text, percent};
use super::super::theme::accent;
use super::still_plot::still_plot;
use crate::film::{Status, TrendPoint};
use bevy::ecs::resource::Resource;
use bevy_egui::egui::{Stroke, Ui};
use egui_plot::{GridInput, GridMark, Line, LineStyle, PlotPoints, Points};
use std::ops::RangeInclusive;

/// A curve that is kept for comparison.
#[derive(Resource, Default)]
pub(in super::super) struct ErrorCurve {
    kept: Vec<[f64; 2]>,
}

/// The logarithms of time and error, where both have one.
fn places(trend: &[TrendPoint]) -> Vec<[f64; 2]> {
    trend
        .iter()
        .map(|point| [point.seconds.log10(), point.error.relative().log10()])
        .filter(|place| place.iter().all(|part| part.is_finite()))
        .collect()
}

pub(super) fn error_plot_ui(ui: &mut Ui, status: Option<&Status>, curve: &mut ErrorCurve) {
    let places = status.map_or_else(Vec::new, |status| places(&status.trend));
    let slope = status.and_then(Status::decline);
    let told = status
        .and_then(Status::error)
        .filter(|_| !places.is_empty());
    let label = match (slope, told) {
        (Some(slope), Some(error)) => {
            format!("{} now, falling as t^-{slope:.2}", error_text(&error))
        }
        // The plot stays where it is, so that what is below it does not jump with every edit.
        (_, None) => "known after a few samples".to_owned(),
        (None, Some(_)) => "too early for a slope".to_owned(),
    };
    ui.label(label)
        .says("The slope in this plot: 0.5 is plain random sampling, more is better");
    let color = accent(ui);
    let faint = ui.visuals().weak_text_color();
    let kept = curve.kept.clone();
    let current = places.clone();
    // Through the last point: what plain random sampling would do from here.
    let reference = places.last().map(|&[time, error]| {
        let start = places[0][0];
        vec![[start, error + 0.5 * (time - start)], [time, error]]
    });
    let shown = still_plot("error-of-time", 170.0)
        .show_axes([true, true])
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(|mark, shown| within(mark.value, shown, power(mark.value, "s")))
        .y_axis_formatter(|mark, shown| within(mark.value, shown, power(mark.value + 2.0, "%")))
        .label_formatter(|_, at| {
            let error = percent(10_f64.powf(at.y));
            format!("{:.3} s\n{error}", 10_f64.powf(at.x))
        })
        .show(ui, move |plot| {
            if let Some(reference) = reference {
                let line = Line::new("t^-0.5", PlotPoints::from(reference))
                    .stroke(Stroke::new(1.0, faint))
                    .style(LineStyle::dashed_loose());
                plot.line(line);
            }
            if !kept.is_empty() {
                let line = Line::new("kept", PlotPoints::from(kept));
                plot.line(line.stroke(Stroke::new(1.0, faint)));
            }
            plot.line(Line::new("error", PlotPoints::from(current.clone())).color(color));
            plot.points(
                Points::new("passes", PlotPoints::from(current))
                    .color(color)
                    .radius(2.5),
            );
        });
    name_control(
        &shown.response,
        "The picture's error against time, both as powers of ten",
    );
    ui.horizontal(|ui| {
        let says = "Keeps this curve, to compare with other settings";
        if ui.small_button("Keep").says(says).clicked() {
            curve.kept = places;
        }
        let forget = ui.add_enabled(
            !curve.kept.is_empty(),
            bevy_egui::egui::Button::new("Forget").small(),
        );
        if forget.says("Takes the kept curve away").clicked() {
            curve.kept.clear();
        }
    });
}

/// A line at each power of ten, faint ones between where there are few.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let [first, last] = [low.floor() as i32, high.ceil() as i32];
    if !(low.is_finite() && high.is_finite()) || last - first > 40 {
        return Vec::new();
    }
    let fine = last - first <= 3;
    let mut marks = Vec::new();
    for decade in first..=last {
        marks.push(GridMark {
            value: f64::from(decade),
            step_size: 1.0,
        });
        if fine {
            marks.extend([2.0_f64, 5.0].map(|part| GridMark {
                value: f64::from(decade) + part.log10(),
                step_size: 0.3,
            }));
        }
    }
    marks
}

/// A label, where it does not stick out of the plot: the axis draws those of all grid lines.
fn within(value: f64, shown: &RangeInclusive<f64>, label: String) -> String {
    // Half a line of text, as a part of the plot's height.
    let margin = 0.05 * (shown.end() - shown.start());
    let inside = shown.start() + margin..=shown.end() - margin;
    if inside.contains(&value) {
        label
    } else {
        String::new()
    }
}

/// `0.1 s` from -1.
fn power(exponent: f64, unit: &str) -> String {
    let value = 10_f64.powf(exponent);
    match value {
        v if !(1e-3..1000.0).contains(&v) => format!("{v:.0e} {unit}"),
        v if v >= 1.0 => format!("{v:.0} {unit}"),
        v => format!("{} {unit}", (v * 1000.0).round() / 1000.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;

    #[test]
    fn a_point_stands_at_the_logarithms_and_one_without_them_is_left_out() {
        let point = |seconds, relative_mse| TrendPoint {
            samples: 1.0,
            seconds,
            error: ErrorEstimate {
                rmse: 0.0,
                relative_mse,
                is_bound: false,
            },
        };
        let trend = [point(0.0, 1.0), point(10.0, 1e-4), point(20.0, 0.0)];
        let found = places(&trend);
        assert_eq!(found.len(), 1);
        assert!((found[0][0] - 1.0).abs() < 1e-12 && (found[0][1] + 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_label_that_would_stick_out_of_the_plot_is_left_out() {
        for (value, shown) in [(-1.0, true), (0.0, false), (-1.99, false), (1.0, false)] {
            let label = within(value, &(-2.0..=0.0), "x".into());
            assert_eq!(!label.is_empty(), shown, "{value}");
        }
    }

    #[test]
    fn grid_lines_stand_at_powers_of_ten() {
        let input = GridInput {
            bounds: (-2.3, 0.4),
            base_step_size: 1.0,
        };
        let whole: Vec<f64> = decades(input)
            .iter()
            .filter(|mark| mark.step_size == 1.0)
            .map(|mark| mark.value)
            .collect();
        assert_eq!(whole, [-3.0, -2.0, -1.0, 0.0, 1.0]);
        assert_eq!([power(-1.0, "s"), power(2.0, "%")], ["0.1 s", "100 %"]);
    }
}
