//! Plots that can be read in black and white: every series has a marker and a dash of its own.

mod draw;
mod labels;
mod raster;
mod ticks;

use crate::film::views::Shown;

/// One plot.
#[derive(Clone, Debug)]
pub struct Plot {
    /// The files' name without their extension.
    pub file: String,
    /// What it shows.
    pub title: String,
    /// From left to right.
    pub x: Axis,
    /// From bottom to top.
    pub y: Axis,
    /// What is drawn, in this order.
    pub series: Vec<Series>,
}

/// An axis of a plot.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Equal steps are equal factors.
    pub logarithmic: bool,
}

impl Axis {
    /// Equal steps are equal differences; zero is on it.
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            logarithmic: false,
        }
    }

    /// Equal steps are equal factors. What is not greater than zero is left out.
    pub fn logarithmic(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            logarithmic: true,
        }
    }
}

/// Points that belong together.
#[derive(Clone, Debug)]
pub struct Series {
    /// For the legend.
    pub name: String,
    /// Where they are.
    pub points: Vec<(f64, f64)>,
    /// Words beside the points; fewer than points where only the first have some.
    pub labels: Vec<String>,
    /// Drawn at each point.
    pub marker: Option<Marker>,
    /// Drawn from point to point.
    pub line: Option<Dash>,
}

impl Series {
    /// Points with neither marker nor line yet.
    pub fn new(name: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.to_owned(),
            points,
            labels: Vec::new(),
            marker: None,
            line: None,
        }
    }

    /// With a marker at each point.
    pub fn marked(mut self, marker: Marker) -> Self {
        self.marker = Some(marker);
        self
    }

    /// With a line from point to point.
    pub fn joined(mut self, dash: Dash) -> Self {
        self.line = Some(dash);
        self
    }
}

/// The shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Marker {
    Circle,
    Ring,
    Square,
    Frame,
    Triangle,
    Diamond,
    Cross,
    /// A circle around another marker.
    Halo,
}

impl Marker {
    /// Those that stand for themselves, the easiest to tell apart first.
    pub const ALL: [Self; 7] = [
        Self::Circle,
        Self::Square,
        Self::Triangle,
        Self::Diamond,
        Self::Ring,
        Self::Frame,
        Self::Cross,
    ];
}

/// The pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Dash {
    Solid,
    Long,
    Short,
    Dotted,
}

impl Dash {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Solid, Self::Long, Self::Short, Self::Dotted];

    /// Pixels drawn and left out; `None` where all are drawn.
    fn pattern(self) -> Option<(i32, i32)> {
        match self {
            Self::Solid => None,
            Self::Long => Some((12, 6)),
            Self::Short => Some((5, 5)),
            Self::Dotted => Some((2, 4)),
        }
    }
}

impl Plot {
    /// As SVG; its words are set in the reader's own sans-serif.
    pub fn svg(&self) -> String {
        draw::svg(self)
    }

    /// As pixels, twice as fine.
    pub fn raster(&self) -> Shown {
        draw::raster(self)
    }
}
