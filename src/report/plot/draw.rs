//! Drawing with plotters, into SVG or pixels alike.

use super::labels;
use super::raster::Raster;
use super::ticks::Scale;
use super::{Dash, Marker, Plot, Series};
use crate::film::views::Shown;
use plotters::element::{Drawable, PointCollection};
use plotters::prelude::*;
use plotters_backend::text_anchor::{HPos, Pos, VPos};
use plotters_backend::{BackendCoord, DrawingErrorKind};

/// Pixels of the SVG; the raster has two for each.
const SIZE: (u32, u32) = (1200, 600);
/// Columns that the legend gets, beside the plot so that it covers nothing.
const LEGEND: u32 = 380;
/// Height of letters.
const LETTERS: i32 = 17;
/// Width of a letter, about: an SVG's reader has a font of their own.
const LETTER_WIDTH: i32 = 10;
/// Half of a marker.
const RADIUS: i32 = 5;
/// Radius of the circle around another marker.
const HALO: i32 = 10;
/// Colours that differ in brightness and for the colour-blind (Okabe and Ito 2008, "Color Universal Design").
const COLORS: [RGBColor; 6] = [
    RGBColor(0, 0, 0),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 120, 90),
    RGBColor(150, 60, 130),
    RGBColor(110, 110, 110),
];

type Chart<'a, B> = ChartContext<'a, B, Cartesian2d<Scale, Scale>>;
type Area<B> = DrawingArea<B, plotters::coord::Shift>;
type Fault<B> = DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>;

pub(super) fn svg(plot: &Plot) -> String {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        // Drawing into a string can only fail where a caller's numbers make no axis; ticks see to that.
        draw(&area, plot).expect("an SVG in memory takes everything");
    }
    text
}

pub(super) fn raster(plot: &Plot) -> Shown {
    let (width, height) = (2 * SIZE.0, 2 * SIZE.1);
    let mut shown = Shown {
        has_unknown: false,
        width,
        height,
        pixels: vec![[1.0; 3]; (width * height) as usize],
        scale: None,
    };
    let area = Raster(&mut shown).into_drawing_area();
    draw(&area, plot).expect("a picture in memory takes everything");
    drop(area);
    shown
}

fn draw<B: DrawingBackend>(area: &Area<B>, plot: &Plot) -> Result<(), Fault<B>> {
    area.fill(&WHITE)?;
    let (area, legend) = area.split_horizontally(SIZE.0 - LEGEND);
    let all = || plot.series.iter().flat_map(|series| &series.points);
    let x = Scale::over(&plot.x, all().map(|point| point.0));
    let y = Scale::over(&plot.y, all().map(|point| point.1));
    let font = ("sans-serif", LETTERS);
    let mut chart: Chart<B> = ChartBuilder::on(&area)
        .caption(&plot.title, ("sans-serif", LETTERS + 3))
        .margin(14)
        .x_label_area_size(56)
        .y_label_area_size(84)
        .build_cartesian_2d(x.clone(), y.clone())?;
    chart
        .configure_mesh()
        .x_desc(&plot.x.label)
        .y_desc(&plot.y.label)
        .x_labels(x.ticks.len().max(1))
        .y_labels(y.ticks.len().max(1))
        .x_label_formatter(&|place| x.text(*place))
        .y_label_formatter(&|place| y.text(*place))
        .label_style(font)
        .axis_desc_style(font)
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .draw()?;
    for (number, series) in plot.series.iter().enumerate() {
        let place = |&(at, value): &(f64, f64)| Some((x.place(at)?, y.place(value)?));
        let points: Vec<(f64, f64)> = series.points.iter().filter_map(place).collect();
        let color = COLORS[number % COLORS.len()];
        draw_series(&mut chart, series, &points, color)?;
    }
    let place = |&(at, value): &(f64, f64)| Some((x.place(at)?, y.place(value)?));
    draw_labels(&area, &chart, plot, place)?;
    draw_legend(&legend, plot)?;
    legend.present()
}

/// The words beside points.
fn draw_labels<B: DrawingBackend>(
    area: &Area<B>,
    chart: &Chart<B>,
    plot: &Plot,
    place: impl Fn(&(f64, f64)) -> Option<(f64, f64)>,
) -> Result<(), Fault<B>> {
    let style = ("sans-serif", LETTERS)
        .into_font()
        .color(&BLACK)
        .pos(Pos::new(HPos::Center, VPos::Center));
    let (left, top) = area.get_base_pixel();
    let pixel = |point: &(f64, f64)| {
        let (x, y) = chart.backend_coord(&place(point)?);
        Some((x - left, y - top))
    };
    let mut markers = Vec::new();
    for series in &plot.series {
        let half = match series.marker {
            None => continue,
            Some(Marker::Halo) => HALO + 1,
            Some(_) => RADIUS + 1,
        };
        markers.extend(series.points.iter().filter_map(&pixel).map(|at| (at, half)));
    }
    let (mut texts, mut words) = (Vec::new(), Vec::new());
    for series in &plot.series {
        for (point, label) in series.points.iter().zip(&series.labels) {
            let Some(at) = pixel(point) else { continue };
            texts.push(label);
            let width = LETTER_WIDTH * label.chars().count() as i32;
            words.push((at, (width / 2, LETTERS / 2)));
        }
    }
    let (width, height) = area.dim_in_pixel();
    let places = labels::places(&markers, &words, (width as i32, height as i32));
    for ((text, (point, half)), place) in texts.into_iter().zip(words).zip(places) {
        if place.led {
            // To the word's nearer edge, not through it.
            let (x, y) = place.at;
            let end = (
                point.0.clamp(x - half.0, x + half.0),
                point.1.clamp(y - half.1, y + half.1),
            );
            area.draw(&PathElement::new([point, end], BLACK.mix(0.5)))?;
        }
        area.draw(&Text::new(text.clone(), place.at, style.clone()))?;
    }
    Ok(())
}

fn draw_legend<B: DrawingBackend>(area: &Area<B>, plot: &Plot) -> Result<(), Fault<B>> {
    let style = ("sans-serif", LETTERS)
        .into_font()
        .color(&BLACK)
        .pos(Pos::new(HPos::Left, VPos::Center));
    for (number, series) in plot.series.iter().enumerate() {
        let at = (4, 60 + 30 * number as i32);
        area.draw(&Mark {
            at,
            marker: series.marker,
            line: series.line,
            in_legend: true,
            color: COLORS[number % COLORS.len()],
        })?;
        area.draw(&Text::new(
            series.name.clone(),
            (at.0 + LEGEND_LINE + 8, at.1),
            style.clone(),
        ))?;
    }
    Ok(())
}

fn draw_series<B: DrawingBackend>(
    chart: &mut Chart<B>,
    series: &Series,
    points: &[(f64, f64)],
    color: RGBColor,
) -> Result<(), Fault<B>> {
    let style = color.stroke_width(2);
    let line = points.to_vec();
    match series.line.map(Dash::pattern) {
        None => {}
        Some(None) => {
            chart.draw_series(LineSeries::new(line, style))?;
        }
        Some(Some((on, off))) => {
            chart.draw_series(DashedLineSeries::new(line, on, off, style))?;
        }
    }
    chart.draw_series(points.iter().map(|&at| Mark {
        at,
        marker: series.marker,
        line: None,
        in_legend: false,
        color,
    }))?;
    Ok(())
}

/// A marker, and for the legend a piece of the line that it is on.
struct Mark<C> {
    at: C,
    marker: Option<Marker>,
    line: Option<Dash>,
    /// Leaves room for the line whether there is one or not.
    in_legend: bool,
    color: RGBColor,
}

impl<'a, C> PointCollection<'a, C> for &'a Mark<C> {
    type Point = &'a C;
    type IntoIter = std::iter::Once<&'a C>;

    fn point_iter(self) -> std::iter::Once<&'a C> {
        std::iter::once(&self.at)
    }
}

/// Pixels of a line that the legend shows.
const LEGEND_LINE: i32 = 38;

impl<C, B: DrawingBackend> Drawable<B> for Mark<C> {
    fn draw<I: Iterator<Item = BackendCoord>>(
        &self,
        mut points: I,
        backend: &mut B,
        _: (u32, u32),
    ) -> Result<(), DrawingErrorKind<B::ErrorType>> {
        let Some((mut x, y)) = points.next() else {
            return Ok(());
        };
        let style = self.color.stroke_width(2);
        if let Some(line) = self.line {
            let (on, off) = line.pattern().unwrap_or((LEGEND_LINE, 1));
            for start in (0..LEGEND_LINE).step_by((on + off) as usize) {
                let end = (start + on).min(LEGEND_LINE);
                backend.draw_line((x + start, y), (x + end, y), &style)?;
            }
        }
        if self.in_legend {
            x += LEGEND_LINE / 2;
        }
        let Some(marker) = self.marker else {
            return Ok(());
        };
        let (r, at) = (RADIUS, |dx: i32, dy: i32| (x + dx, y + dy));
        match marker {
            Marker::Circle => backend.draw_circle((x, y), r as u32, &style, true),
            Marker::Ring => {
                backend.draw_circle((x, y), r as u32, &WHITE.filled(), true)?;
                backend.draw_circle((x, y), r as u32, &style, false)
            }
            Marker::Square => backend.draw_rect(at(-r, -r), at(r, r), &style, true),
            Marker::Frame => {
                backend.draw_rect(at(-r, -r), at(r, r), &WHITE.filled(), true)?;
                backend.draw_rect(at(-r, -r), at(r, r), &style, false)
            }
            Marker::Triangle => {
                let corners = [at(0, -r - 1), at(r + 1, r), at(-r - 1, r)];
                backend.fill_polygon(corners, &style)
            }
            Marker::Diamond => {
                let corners = [at(0, -r - 2), at(r + 2, 0), at(0, r + 2), at(-r - 2, 0)];
                backend.fill_polygon(corners, &style)
            }
            Marker::Halo => backend.draw_circle((x, y), HALO as u32, &style, false),
            Marker::Cross => {
                backend.draw_line(at(-r, -r), at(r, r), &style)?;
                backend.draw_line(at(-r, r), at(r, -r), &style)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;

    fn plot() -> Plot {
        let points = vec![(1.0, 1e-7), (3.0, 1e-4), (10.0, f64::NAN)];
        let mut series = Series::new("ours <&>", points)
            .marked(Marker::Circle)
            .joined(Dash::Long);
        series.labels = vec!["first".into(), "second".into()];
        Plot {
            file: "p".into(),
            title: "Speed & error".into(),
            x: Axis::linear("Mray/s"),
            y: Axis::logarithmic("error"),
            series: vec![series, Series::new("empty", vec![]).marked(Marker::Ring)],
        }
    }

    #[test]
    fn an_svg_holds_its_words_as_text_and_escapes_them() {
        let text = svg(&plot());
        for part in [
            "<svg",
            "</svg>",
            "Mray/s",
            "first",
            "second",
            "ours &lt;&amp;&gt;",
            "1e-4",
        ] {
            assert!(text.contains(part), "`{part}` is not in:\n{text}");
        }
        assert!(text.contains("sans-serif"));
    }

    #[test]
    fn every_marker_and_dash_leaves_ink_of_its_own() {
        let with = |marker, line| {
            let mut plot = plot();
            plot.series[0].marker = marker;
            plot.series[0].line = line;
            raster(&plot).pixels
        };
        let mut seen = vec![with(None, None)];
        let markers = Marker::ALL.map(|marker| with(Some(marker), None));
        let dashes = Dash::ALL.map(|dash| with(None, Some(dash)));
        for picture in markers.into_iter().chain(dashes) {
            assert!(!seen.contains(&picture), "picture {}", seen.len());
            seen.push(picture);
        }
        let dark = seen[0].iter().filter(|pixel| pixel[0] < 0.5).count();
        assert!(
            dark > 5_000,
            "only {dark} dark pixels: axes and words are missing"
        );
    }
}
