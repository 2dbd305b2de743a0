//! The figures of a scene's curves as rows of tables, and as plots.

use super::super::fit::{power_law, reaches};
use super::super::{Axis, Cell, Dash, Marker, Plot, Series, Subject};
use super::GOAL;
use super::curve::{Point, Way};

pub(super) fn point_cells(scene: &str, way: Way, point: &Point) -> [Cell; 10] {
    [
        scene.into(),
        way.name().into(),
        point.samples.into(),
        point.seconds.into(),
        (point.rays * 1e-6).into(),
        point.rmse.into(),
        point.relative_mse.into(),
        point.relative().into(),
        point.estimate.into(),
        point
            .estimate
            .map(|estimate| estimate / point.relative())
            .into(),
    ]
}

pub(super) fn slope_cells(scene: &str, way: Way, curve: &[Point]) -> [Cell; 9] {
    let over = |x: fn(&Point) -> f64| -> Vec<(f64, f64)> {
        curve
            .iter()
            .map(|point| (x(point), point.relative()))
            .collect()
    };
    let slope = |x| power_law(&over(x)).map(|(slope, _)| slope);
    let reached = |x| reaches(&over(x), GOAL);
    let (seconds, rays) = (
        reached(|point| point.seconds),
        reached(|point| point.rays * 1e-6),
    );
    [
        scene.into(),
        way.name().into(),
        slope(|point| point.samples).into(),
        slope(|point| point.rays).into(),
        slope(|point| point.seconds).into(),
        (curve.last().and_then(|point| point.decline))
            .map(|decline| -decline)
            .into(),
        seconds.map(|seconds| seconds.at).into(),
        rays.map(|rays| rays.at).into(),
        // Both are of the same errors.
        seconds.or(rays).map(|reached| reached.how.name()).into(),
    ]
}

pub(super) fn plot(
    subject: &Subject,
    curves: &[Vec<Point>; Way::ALL.len()],
    name: &str,
    label: &str,
    x: fn(&Point) -> f64,
) -> Plot {
    let dashes = [Dash::Dotted, Dash::Short, Dash::Solid, Dash::Long];
    let markers = [
        Marker::Cross,
        Marker::Triangle,
        Marker::Circle,
        Marker::Frame,
    ];
    let mut series: Vec<Series> = (Way::ALL.iter().zip(curves))
        .zip(dashes.into_iter().zip(markers))
        .map(|((way, curve), (dash, marker))| {
            let points = curve.iter().map(|point| (x(point), point.relative()));
            Series::new(way.name(), points.collect())
                .joined(dash)
                .marked(marker)
        })
        .collect();
    let estimates = (curves[2].iter()).filter_map(|point| Some((x(point), point.estimate?)));
    series.push(Series::new("film's estimate, Sobol", estimates.collect()).marked(Marker::Ring));
    Plot {
        file: format!("sampling-{}-{name}", subject.file()),
        title: format!("{}: error against {label}", subject.name),
        x: Axis::logarithmic(label),
        y: Axis::logarithmic("relative error"),
        series,
    }
}
