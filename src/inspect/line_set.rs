//! Lines, points, planes and labels as plain data: what a gizmo draws, a file holds and a test reads.

use super::{InspectSettings, System};
use bevy::color::LinearRgba;
use glam::Vec3;
use serde::Serialize;
use std::fmt;

/// What one system shows. World space, metres; colours are linear, alpha is how much covers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineSet {
    /// Whose it is.
    pub system: System,
    /// Straight lines.
    pub segments: Vec<Segment>,
    /// Single points.
    pub points: Vec<Dot>,
    /// Parallelograms that cover what is behind them in part.
    pub planes: Vec<Panel>,
    /// Text at a place.
    pub labels: Vec<Label>,
    /// How much was left out because there was more than a picture can show.
    pub thinned: Option<Thinned>,
    /// What there was nothing to draw of, and why, in a sentence each.
    pub notes: Vec<String>,
    /// The most lines, and the most points; what comes after them is counted and left out.
    #[serde(skip)]
    most: usize,
    #[serde(skip)]
    left_out: [usize; 2],
}

/// A straight line whose colour goes from one end's to the other's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Segment {
    /// Both ends.
    pub ends: [Vec3; 2],
    /// The colour at each end.
    pub colors: [LinearRgba; 2],
    /// What it shows.
    pub stands: Stands,
}

/// A point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Dot {
    /// Where.
    pub at: Vec3,
    /// Its colour.
    pub color: LinearRgba,
    /// What it shows.
    pub stands: Stands,
}

/// A parallelogram.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Panel {
    /// One corner.
    pub corner: Vec3,
    /// The edges that leave it.
    pub edges: [Vec3; 2],
    /// Its colour.
    pub color: LinearRgba,
    /// What it shows.
    pub stands: Stands,
}

/// Text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Label {
    /// Where it begins.
    pub at: Vec3,
    /// What it says.
    pub text: String,
    /// Its colour.
    pub color: LinearRgba,
    /// What it is about.
    pub stands: Stands,
}

/// What something drawn shows, so that a pointer above it can tell its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stands {
    /// A node of the tree of an instance's mesh, or of the top tree.
    Node {
        /// Index into the aggregate's instances; `None` for the top tree.
        instance: Option<u32>,
        /// Index into the tree's nodes.
        node: u32,
    },
    /// A ray: index into [`RayTree::rays`](crate::trace::RayTree::rays).
    Ray(u32),
    /// A triangle.
    Triangle {
        /// Index into the aggregate's instances.
        instance: u32,
        /// Index into the mesh's triangles.
        triangle: u32,
    },
    /// An object, by its `SceneId`.
    Object(u64),
    /// A light, by its `SceneId`.
    Light(u64),
    /// The camera.
    Camera,
}

/// How much of something is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Thinned {
    /// What is counted: nodes, normals, rays.
    pub what: &'static str,
    /// How many are drawn.
    pub drawn: usize,
    /// Of how many.
    pub of: usize,
    /// By which rule the others were left out.
    pub rule: &'static str,
}

impl fmt::Display for Thinned {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            what,
            drawn,
            of,
            rule,
        } = self;
        write!(f, "{drawn} of {of} {what} are drawn: {rule}")
    }
}

impl LineSet {
    /// An empty set, with room for all that comes.
    pub fn new(system: System) -> Self {
        Self::with_room(system, usize::MAX)
    }

    /// An empty set, with room for as many lines as the settings allow.
    pub(super) fn of(system: System, inspect: &InspectSettings) -> Self {
        Self::with_room(system, inspect.max_lines as usize)
    }

    fn with_room(system: System, most: usize) -> Self {
        Self {
            system,
            segments: Vec::new(),
            points: Vec::new(),
            planes: Vec::new(),
            labels: Vec::new(),
            thinned: None,
            notes: Vec::new(),
            most,
            left_out: [0; 2],
        }
    }

    /// Says what there was no room for.
    pub(super) fn say_what_is_left_out(&mut self) {
        let [lines, points] = std::mem::take(&mut self.left_out);
        let parts = [
            ("lines", self.segments.len(), lines),
            ("points", self.points.len(), points),
        ];
        for (what, drawn, left_out) in parts.into_iter().filter(|part| part.2 > 0) {
            let thinned = Thinned {
                what,
                drawn,
                of: drawn + left_out,
                rule: "the first ones",
            };
            match self.thinned {
                None => self.thinned = Some(thinned),
                Some(_) => self.notes.push(thinned.to_string()),
            }
        }
    }

    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
            && self.points.is_empty()
            && self.planes.is_empty()
            && self.labels.is_empty()
    }

    /// What it says of itself in words: what was left out first.
    pub fn says(&self) -> impl Iterator<Item = String> {
        let left_out = self.thinned.as_ref().map(Thinned::to_string);
        left_out.into_iter().chain(self.notes.iter().cloned())
    }

    /// A line of one colour.
    pub(super) fn line(&mut self, ends: [Vec3; 2], color: LinearRgba, stands: Stands) {
        self.gradient(ends, [color; 2], stands);
    }

    /// A line between two colours. One that is not finite is left out: no screen can show it.
    pub(super) fn gradient(&mut self, ends: [Vec3; 2], colors: [LinearRgba; 2], stands: Stands) {
        if ends.iter().any(|end| !end.is_finite()) {
            return;
        }
        if self.segments.len() >= self.most {
            self.left_out[0] += 1;
        } else {
            self.segments.push(Segment {
                ends,
                colors,
                stands,
            });
        }
    }

    /// A closed line through points.
    pub(super) fn closed(&mut self, corners: &[Vec3], color: LinearRgba, stands: Stands) {
        for (i, &corner) in corners.iter().enumerate() {
            self.line([corner, corners[(i + 1) % corners.len()]], color, stands);
        }
    }

    /// A circle of `radius` in the plane of two perpendicular unit vectors.
    pub(super) fn circle(
        &mut self,
        center: Vec3,
        [x, y]: [Vec3; 2],
        radius: f32,
        color: LinearRgba,
        stands: Stands,
    ) {
        let corners: Vec<Vec3> = (0..CIRCLE_SEGMENTS)
            .map(|i| {
                let angle = i as f32 * std::f32::consts::TAU / CIRCLE_SEGMENTS as f32;
                center + radius * (angle.cos() * x + angle.sin() * y)
            })
            .collect();
        self.closed(&corners, color, stands);
    }

    /// The twelve edges of a box, its corners numbered by the bits x, y, z.
    pub(super) fn edges(&mut self, corners: &[Vec3; 8], color: LinearRgba, stands: Stands) {
        for axis in 0..3 {
            for corner in (0..8).filter(|corner| corner >> axis & 1 == 0) {
                let ends = [corners[corner], corners[corner | 1 << axis]];
                self.line(ends, color, stands);
            }
        }
    }

    /// A point; one that is not finite is left out.
    pub(super) fn dot(&mut self, at: Vec3, color: LinearRgba, stands: Stands) {
        if !at.is_finite() {
            return;
        }
        if self.points.len() >= self.most {
            self.left_out[1] += 1;
        } else {
            self.points.push(Dot { at, color, stands });
        }
    }
}

/// Straight pieces of a circle: at a quarter of a picture's height none is longer than 15 pixels.
pub const CIRCLE_SEGMENTS: usize = 48;

/// The eight corners of a box, numbered by the bits x, y, z.
pub(super) fn box_corners(min: Vec3, max: Vec3) -> [Vec3; 8] {
    std::array::from_fn(|i| {
        Vec3::new(
            if i & 1 == 0 { min.x } else { max.x },
            if i & 2 == 0 { min.y } else { max.y },
            if i & 4 == 0 { min.z } else { max.z },
        )
    })
}
