//! Lines over a picture, drawn without a GPU: thin, tested against the picture's depth, with a faint
//! hidden part.

use super::line_set::{Dot, Label, LineSet, Panel, Segment};
use crate::film::views::font;
use crate::scene::Projection;
use crate::trace::{Camera, srgb};
use bevy::color::LinearRgba;
use glam::{IVec2, UVec2, Vec2, Vec3};

/// How much of a line is left where something stands before it.
pub const FAINT: f32 = 0.22;

/// A line this much behind a surface still counts as on it, as a fraction of the distance.
const SLACK: f32 = 0.004;

/// Rows of a picture for each pixel of a line's width.
const ROWS_PER_PIXEL: f32 = 900.0;

/// What stands before a perspective camera by less than this part of a segment's reach is cut off.
const NEAR: f32 = 1e-4;

/// Radius of a point, in widths of a line.
const DOT_RADIUS: f32 = 2.0;

/// A picture to draw over.
pub struct Overlay<'a> {
    /// From where the picture is seen, through a pinhole.
    pub camera: &'a Camera,
    /// Columns and rows.
    pub size: UVec2,
    /// For each pixel, row by row, the distance from the camera to the first surface along its
    /// middle's ray; infinite where there is none.
    pub depths: &'a [f32],
    /// The picture, encoded for a screen.
    pub pixels: &'a mut [[f32; 3]],
}

/// Draws planes, lines, points and labels, in this order, each set over those before it.
pub fn draw_over(overlay: &mut Overlay, sets: &[LineSet]) {
    for panel in sets.iter().flat_map(|set| &set.planes) {
        overlay.panel(panel);
    }
    for set in sets {
        for segment in &set.segments {
            overlay.segment(segment);
        }
        for dot in &set.points {
            overlay.dot(dot);
        }
    }
    for label in sets.iter().flat_map(|set| &set.labels) {
        overlay.label(label);
    }
}

/// A place in the picture, and how far along the view axis it is.
#[derive(Clone, Copy)]
struct Projected {
    place: Vec2,
    ahead: f32,
}

impl Overlay<'_> {
    fn time(&self) -> f32 {
        self.camera.optics.shutter[0]
    }

    fn eye(&self) -> Vec3 {
        self.camera.position + self.time() * self.camera.optics.velocity
    }

    /// The distance as `depths` has it: from the eye, or for an orthographic camera from its plane.
    fn distance(&self, point: Vec3) -> f32 {
        let offset = point - self.eye();
        match self.camera.projection {
            Projection::Perspective { .. } => offset.length(),
            Projection::Orthographic { .. } => offset.dot(self.camera.forward),
        }
    }

    fn width(&self) -> f32 {
        (self.size.y as f32 / ROWS_PER_PIXEL).max(1.0)
    }

    /// The farthest surface around a pixel: a line on a slanted surface is not hidden by its
    /// neighbour.
    fn depth(&self, x: i32, y: i32) -> f32 {
        let mut farthest = 0.0_f32;
        for dy in -1..=1 {
            for dx in -1..=1 {
                let at = IVec2::new(x + dx, y + dy)
                    .clamp(IVec2::ZERO, self.size.as_ivec2() - IVec2::ONE);
                let index = at.y as usize * self.size.x as usize + at.x as usize;
                farthest = farthest.max(self.depths.get(index).copied().unwrap_or(f32::INFINITY));
            }
        }
        farthest
    }

    /// Mixes a colour into a pixel.
    fn blend(&mut self, x: i32, y: i32, color: LinearRgba, part: f32, distance: f32) {
        let inside = x >= 0 && y >= 0 && (x as u32) < self.size.x && (y as u32) < self.size.y;
        if !inside || part <= 0.0 {
            return;
        }
        let hidden = distance > self.depth(x, y) * (1.0 + SLACK);
        let part = (part * color.alpha * if hidden { FAINT } else { 1.0 }).clamp(0.0, 1.0);
        let index = y as usize * self.size.x as usize + x as usize;
        if let Some(pixel) = self.pixels.get_mut(index) {
            let over = [color.red, color.green, color.blue]
                .map(|channel| srgb::encode(channel.clamp(0.0, 1.0)));
            for (channel, over) in pixel.iter_mut().zip(over) {
                *channel += part * (over - *channel);
            }
        }
    }

    fn segment(&mut self, segment: &Segment) {
        let Some((ends, shares)) = self.clipped(segment.ends) else {
            return;
        };
        let [a, b] = ends.map(|end| self.project(end));
        let (Some(a), Some(b)) = (a, b) else { return };
        let Some([from, to]) = on_screen([a.place, b.place], self.size.as_vec2()) else {
            return;
        };
        // Along its longer side a pixel a step, across it as wide as it is.
        let steep = (b.place.y - a.place.y).abs() > (b.place.x - a.place.x).abs();
        let along = |p: Vec2| if steep { p.y } else { p.x };
        let across = |p: Vec2| if steep { p.x } else { p.y };
        let length = along(b.place) - along(a.place);
        if length == 0.0 {
            return;
        }
        let (low, high) = (
            along(a.place.lerp(b.place, from)),
            along(a.place.lerp(b.place, to)),
        );
        let (low, high) = (low.min(high), low.max(high));
        let half = 0.5 * self.width();
        for step in low.floor() as i32..=high.floor() as i32 {
            // The part of the pixel's length that the line has.
            let covers = (high.min(step as f32 + 1.0) - low.max(step as f32)).clamp(0.0, 1.0);
            let u = ((step as f32 + 0.5 - along(a.place)) / length).clamp(0.0, 1.0);
            let middle = across(a.place) + u * (across(b.place) - across(a.place));
            // Depth is linear in the inverse on the screen (perspective), or itself (orthographic).
            let world = match self.camera.projection {
                Projection::Perspective { .. } => u / b.ahead / ((1.0 - u) / a.ahead + u / b.ahead),
                Projection::Orthographic { .. } => u,
            };
            let point = ends[0].lerp(ends[1], world);
            let color = mix(segment.colors, shares[0] + world * (shares[1] - shares[0]));
            let distance = self.distance(point);
            for row in (middle - half).floor() as i32..=(middle + half).floor() as i32 {
                let part = (middle + half).min(row as f32 + 1.0) - (middle - half).max(row as f32);
                let (x, y) = if steep { (row, step) } else { (step, row) };
                self.blend(x, y, color, part.min(1.0) * covers, distance);
            }
        }
    }

    /// The part of a segment ahead of the camera, and the shares of its way where it begins and ends.
    fn clipped(&self, [a, b]: [Vec3; 2]) -> Option<([Vec3; 2], [f32; 2])> {
        if matches!(self.camera.projection, Projection::Orthographic { .. }) {
            return Some(([a, b], [0.0, 1.0]));
        }
        let ahead = |point: Vec3| (point - self.eye()).dot(self.camera.forward);
        let (da, db) = (ahead(a), ahead(b));
        let near = NEAR * da.abs().max(db.abs());
        if da < near && db < near {
            return None;
        }
        let at_near = (near - da) / (db - da);
        let (from, to) = match (da < near, db < near) {
            (true, _) => (at_near, 1.0),
            (_, true) => (0.0, at_near),
            _ => (0.0, 1.0),
        };
        Some(([a.lerp(b, from), a.lerp(b, to)], [from, to]))
    }

    fn project(&self, point: Vec3) -> Option<Projected> {
        let (place, ahead) = self.camera.project(point, self.size, self.time())?;
        Some(Projected { place, ahead })
    }

    fn dot(&mut self, dot: &Dot) {
        let Some(at) = self.project(dot.at) else {
            return;
        };
        let radius = DOT_RADIUS * self.width();
        let reach = Vec2::splat(radius + 1.0);
        let limit = self.size.as_vec2() + reach;
        if at.place.cmplt(-reach).any() || at.place.cmpgt(limit).any() {
            return;
        }
        let distance = self.distance(dot.at);
        let (low, high) = (
            (at.place - reach).floor().as_ivec2(),
            (at.place + reach).floor().as_ivec2(),
        );
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let away = (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - at.place).length();
                let part = (radius + 0.5 - away).clamp(0.0, 1.0);
                self.blend(x, y, dot.color, part, distance);
            }
        }
    }

    /// Pixel by pixel: where its ray passes the parallelogram.
    fn panel(&mut self, panel: &Panel) {
        let [a, b] = panel.edges;
        let normal = a.cross(b);
        let squared = normal.length_squared();
        if squared == 0.0 || !squared.is_finite() {
            return;
        }
        let corners = [Vec3::ZERO, a, a + b, b].map(|edge| self.project(panel.corner + edge));
        let (mut low, mut high) = (Vec2::ZERO, self.size.as_vec2());
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            let places = [a.place, b.place, c.place, d.place];
            low = low.max(places.iter().fold(high, |low, p| low.min(*p)));
            high = high.min(places.iter().fold(Vec2::ZERO, |high, p| high.max(*p)));
        }
        for y in low.y as i32..high.y.ceil() as i32 {
            for x in low.x as i32..high.x.ceil() as i32 {
                let place = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let ray = self.camera.ray(place, self.size, [0.5; 2], self.time());
                let t = (panel.corner - ray.origin).dot(normal) / ray.direction.dot(normal);
                let at = ray.at(t) - panel.corner;
                let u = at.cross(b).dot(normal) / squared;
                let v = a.cross(at).dot(normal) / squared;
                let inside = (0.0..=1.0).contains(&u) && (0.0..=1.0).contains(&v);
                if t > 0.0 && inside {
                    self.blend(x, y, panel.color, 1.0, t);
                }
            }
        }
    }

    /// Text is never hidden: it is there to be read.
    fn label(&mut self, label: &Label) {
        let Some(at) = self.project(label.at) else {
            return;
        };
        let unit = self.width().round() as i32;
        let (left, top) = (at.place.x as i32, at.place.y as i32);
        for (i, rows) in (0..).zip(label.text.chars().map(font::glyph)) {
            let Some(rows) = rows else { continue };
            for (row, bits) in (0..).zip(rows) {
                for column in (0..font::WIDTH).filter(|c| bits >> (font::WIDTH - 1 - c) & 1 == 1) {
                    let x = left + (i * font::ADVANCE as i32 + column as i32) * unit;
                    let y = top + row * unit;
                    for (dx, dy) in (0..unit).flat_map(|dx| (0..unit).map(move |dy| (dx, dy))) {
                        self.blend(x + dx, y + dy, label.color, 1.0, 0.0);
                    }
                }
            }
        }
    }
}

fn mix([a, b]: [LinearRgba; 2], share: f32) -> LinearRgba {
    a * (1.0 - share) + b * share
}

/// The share of a line at which it enters the picture and at which it leaves it (Liang and Barsky
/// 1984, "A new concept and method for line clipping"); `None` where it does not touch it.
fn on_screen([a, b]: [Vec2; 2], size: Vec2) -> Option<[f32; 2]> {
    let way = b - a;
    let (mut from, mut to) = (0.0_f32, 1.0_f32);
    for axis in 0..2 {
        for (step, room) in [(-way[axis], a[axis]), (way[axis], size[axis] - a[axis])] {
            if step == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                from = from.max(room / step);
            } else {
                to = to.min(room / step);
            }
        }
    }
    (from <= to).then_some([from, to])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::{Stands, System};

    const SIZE: UVec2 = UVec2::new(65, 65);

    fn drawn(depth: f32, draw: impl Fn(&mut LineSet)) -> Vec<[f32; 3]> {
        // 2 m high at a distance of 1 m: 32.5 pixels to a metre there.
        let camera = Camera::looking_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 2.0 * 1f32.atan());
        let mut pixels = vec![[0.0; 3]; 65 * 65];
        let mut set = LineSet::new(System::Rays);
        draw(&mut set);
        let depths = vec![depth; 65 * 65];
        let mut overlay = Overlay {
            camera: &camera,
            size: SIZE,
            depths: &depths,
            pixels: &mut pixels,
        };
        draw_over(&mut overlay, &[set]);
        pixels
    }

    fn at(pixels: &[[f32; 3]], x: usize, y: usize) -> [f32; 3] {
        pixels[y * 65 + x]
    }

    const RED: LinearRgba = LinearRgba::rgb(1.0, 0.0, 0.0);

    #[test]
    fn a_line_through_the_middle_covers_the_middle_row_and_no_other() {
        let across = [Vec3::new(-5.0, 0.0, -2.0), Vec3::new(5.0, 0.0, -2.0)];
        let pixels = drawn(f32::INFINITY, |set| set.line(across, RED, Stands::Camera));
        for y in 0..65 {
            for x in 0..65 {
                let expected = if y == 32 { 1.0 } else { 0.0 };
                let found = at(&pixels, x, y)[0];
                assert!((found - expected).abs() < 1e-6, "{found} at {x}, {y}");
            }
        }
    }

    #[test]
    fn what_stands_behind_a_surface_is_faint_and_what_is_behind_the_camera_is_not_drawn() {
        let across = [Vec3::new(-5.0, 0.0, -2.0), Vec3::new(5.0, 0.0, -2.0)];
        let pixels = drawn(1.0, |set| set.line(across, RED, Stands::Camera));
        assert!((at(&pixels, 32, 32)[0] - FAINT).abs() < 1e-6);
        let behind = across.map(|end| -end);
        let pixels = drawn(1.0, |set| set.line(behind, RED, Stands::Camera));
        assert!(pixels.iter().all(|pixel| *pixel == [0.0; 3]));
    }

    #[test]
    fn a_line_that_begins_behind_the_camera_is_drawn_from_where_it_comes_into_view() {
        // From below and behind to the middle of the view, 4 m ahead.
        let ends = [Vec3::new(0.0, -1.0, 2.0), Vec3::new(0.0, 0.0, -4.0)];
        let pixels = drawn(f32::INFINITY, |set| set.line(ends, RED, Stands::Camera));
        assert!(at(&pixels, 32, 60)[0] > 0.9, "{:?}", at(&pixels, 32, 60));
        assert_eq!(at(&pixels, 32, 20), [0.0; 3]);
    }

    #[test]
    fn a_panel_covers_its_inside_in_part() {
        let pixels = drawn(f32::INFINITY, |set| {
            set.planes.push(Panel {
                corner: Vec3::new(-0.5, -0.5, -1.0),
                edges: [Vec3::X, Vec3::Y],
                color: LinearRgba::new(1.0, 1.0, 1.0, 0.5),
                stands: Stands::Camera,
            });
        });
        assert!((at(&pixels, 32, 32)[1] - 0.5).abs() < 1e-6);
        assert_eq!(at(&pixels, 10, 32), [0.0; 3]);
    }
}
