//! A parallelogram light in the axes in which its points are chosen, and what directions around a receiver see of it.
//! `parallelogram_warp` has the formulas.

use super::receiver::Receivers;
use crate::trace::math::piecewise::{larger, relative_luminances, smaller, within_one};
use glam::Vec3;

/// As a part of the longer edge, the least width or length that rounding leaves some digits of.
const LEAST_EXTENT: f32 = 1e-6;

/// A parallelogram light as its points are chosen; lengths are multiples of its longer edge.
#[derive(Clone, Copy, Debug)]
pub struct ParallelogramFrame {
    corner: Vec3,
    /// Unit vectors: out of the front, across the second edge, along it.
    axes: [Vec3; 3],
    /// One over the longer edge in metres.
    per_metre: f32,
    /// The first edge's components across and along; the second edge's length.
    width: f32,
    shear: f32,
    length: f32,
    per_width: f32,
    per_length: f32,
    two_sided: bool,
    /// Luminance at the corners.
    pub(in crate::trace) luminances: [f32; 4],
    pub(in crate::trace) is_even: bool,
    /// The light's first edge is the longer one, and stands in the second's place here.
    pub(in crate::trace) is_turned: bool,
}

/// The light from the receivers, in its own axes: towards its plane, across, along.
pub(in crate::trace) struct Views<const N: usize> {
    pub offset: [[f32; N]; 3],
    pub normal: [[f32; N]; 3],
    /// One over how much higher over the horizon a line ends than it starts.
    pub per_rise: [f32; N],
    pub mirrored: [[f32; N]; 3],
    /// The first and the last line, in u, of which some part is not below the horizon.
    pub ends: [[f32; N]; 2],
    /// t of the first line, and how much more it is of the last.
    pub first: [f32; N],
    pub width: [f32; N],
}

/// A line of the light: what directions of one α meet.
pub(in crate::trace) struct Lines<const N: usize> {
    pub u: [f32; N],
    pub t: [f32; N],
    /// Distance from the axis.
    pub distance: [f32; N],
    /// Component along the axis of the line's start.
    pub start: [f32; N],
    /// The normal's and the mirrored direction's component away from the axis.
    pub normal: [f32; N],
    pub mirrored: [f32; N],
    /// The part above the horizon: in v, in distances, and in q.
    pub v: [[f32; N]; 2],
    pub r: [[f32; N]; 2],
    pub q: [[f32; N]; 2],
}

impl ParallelogramFrame {
    /// Of a light with that corner, edges and linear RGB at the corners in the order of
    /// [`ParallelogramLight::colors`](crate::trace::ParallelogramLight::colors); `None` where rounding leaves no parallelogram.
    pub fn new(
        corner: Vec3,
        edges: [Vec3; 2],
        colors: &[Vec3; 4],
        two_sided: bool,
    ) -> Option<Self> {
        let [first, second] = edges.map(Vec3::length);
        let scale = first.max(second);
        let is_turned = first > second;
        let [a, b] = edges.map(|edge| edge / scale);
        let [a, b] = if is_turned { [b, a] } else { [a, b] };
        let front = if is_turned { b.cross(a) } else { a.cross(b) };
        let front = front.normalize_or_zero();
        let length = b.length();
        let along = b / length;
        let shear = a.dot(along);
        let across = a - shear * along;
        let width = across.length();
        let has_extent = width > LEAST_EXTENT && length > LEAST_EXTENT;
        let mut luminances = relative_luminances(colors);
        if is_turned {
            luminances.swap(1, 2);
        }
        (has_extent && (1.0 / scale).is_finite()).then(|| Self {
            corner,
            axes: [front, across / width, along],
            per_metre: 1.0 / scale,
            width,
            shear,
            length,
            per_width: 1.0 / width,
            per_length: 1.0 / length,
            two_sided,
            luminances,
            is_even: luminances.iter().all(|l| *l == luminances[0]),
            is_turned,
        })
    }

    #[inline(always)]
    pub(super) fn views<const GLOSSY: bool, const N: usize>(
        &self,
        receivers: &Receivers<N>,
    ) -> Views<N> {
        let mut views = Views {
            offset: [[0.0; N]; 3],
            normal: [[0.0; N]; 3],
            per_rise: [0.0; N],
            mirrored: [[0.0; N]; 3],
            ends: [[0.0; N]; 2],
            first: [0.0; N],
            width: [0.0; N],
        };
        let at = |columns: &[[f32; N]; 3], i: usize| {
            Vec3::new(columns[0][i], columns[1][i], columns[2][i])
        };
        let [front, across, along] = self.axes;
        for i in 0..N {
            let offset = (self.corner - at(&receivers.from, i)) * self.per_metre;
            let before = offset.dot(front);
            let side = if before > 0.0 && self.two_sided {
                1.0
            } else {
                -1.0
            };
            let axes = |v: Vec3| [side * v.dot(front), v.dot(across), v.dot(along)];
            let [z, x0, y0] = axes(offset);
            let [nz, nx, ny] = axes(at(&receivers.normal, i));
            // Heights above the horizon of the higher ends of the first and the last line.
            let at_first = z * nz + x0 * nx + y0 * ny + larger(self.length * ny, 0.0);
            let at_last = at_first + self.width * nx + self.shear * ny;
            let crossing = within_one(at_first / (at_first - at_last));
            let first = if at_first < 0.0 { crossing } else { 0.0 };
            let last = if at_last < 0.0 { crossing } else { 1.0 };
            let is_above = at_first > 0.0 || at_last > 0.0;
            let last = if is_above { last } else { first };
            let x = [first, last].map(|u| x0 + u * self.width);
            let (t, width) = half_tangents(z, x, (last - first) * self.width);
            for (axis, value) in [z, x0, y0].into_iter().enumerate() {
                views.offset[axis][i] = value;
            }
            for (axis, value) in [nz, nx, ny].into_iter().enumerate() {
                views.normal[axis][i] = value;
            }
            if GLOSSY {
                let mirrored = axes(at(&receivers.mirrored, i));
                for (axis, value) in mirrored.into_iter().enumerate() {
                    views.mirrored[axis][i] = value;
                }
            }
            views.per_rise[i] = self.per_length / ny;
            views.ends[0][i] = first;
            views.ends[1][i] = last;
            views.first[i] = t;
            views.width[i] = width;
        }
        views
    }

    /// The lines at places in [0, 1] of the interval of t, or of that of u where there is no difference but in digits.
    #[inline(always)]
    pub(super) fn lines<const GLOSSY: bool, const N: usize>(
        &self,
        views: &Views<N>,
        place: impl Fn(usize) -> f32,
        by_angle: impl Fn(usize) -> bool,
    ) -> Lines<N> {
        let mut lines = Lines {
            u: [0.0; N],
            t: [0.0; N],
            distance: [0.0; N],
            start: [0.0; N],
            normal: [0.0; N],
            mirrored: [0.0; N],
            v: [[0.0; N]; 2],
            r: [[0.0; N]; 2],
            q: [[0.0; N]; 2],
        };
        for i in 0..N {
            let t = views.first[i] + place(i) * views.width[i];
            let [z, x0, y0] = [0, 1, 2].map(|axis| views.offset[axis][i]);
            let [nz, nx, ny] = [0, 1, 2].map(|axis| views.normal[axis][i]);
            // 1 - t², at least what rounding leaves of it.
            let rest = larger((1.0 - t) * (1.0 + t), 1e-12);
            let u = (2.0 * t * z / rest - x0) * self.per_width;
            let [first, last] = [views.ends[0][i], views.ends[1][i]];
            let u = smaller(larger(u, first), last);
            let even = first + place(i) * (last - first);
            let u = if by_angle(i) { u } else { even };
            let x = x0 + u * self.width;
            let start = y0 + u * self.shear;
            let squared = larger(z * z + x * x, f32::MIN_POSITIVE);
            let distance = squared.sqrt();
            let per_distance = 1.0 / distance;
            let normal = z * nz + x * nx;
            let crossing = within_one(-(normal + start * ny) * views.per_rise[i]);
            let v = [
                if ny > 0.0 { crossing } else { 0.0 },
                if ny < 0.0 { crossing } else { 1.0 },
            ];
            lines.u[i] = u;
            lines.t[i] = t;
            lines.distance[i] = distance;
            lines.start[i] = start;
            lines.normal[i] = normal * per_distance;
            if GLOSSY {
                let [mz, mx] = [0, 1].map(|axis| views.mirrored[axis][i]);
                lines.mirrored[i] = (z * mz + x * mx) * per_distance;
            }
            for (end, v) in v.into_iter().enumerate() {
                let y = start + v * self.length;
                let r = (squared + y * y).sqrt();
                lines.v[end][i] = v;
                lines.r[end][i] = r;
                lines.q[end][i] = y / (r * (r + distance)).sqrt();
            }
        }
        lines
    }

    /// Where a line has this component along the axis.
    #[inline(always)]
    pub(super) fn v_at<const N: usize>(&self, lines: &Lines<N>, i: usize, y: f32) -> f32 {
        let v = (y - lines.start[i]) * self.per_length;
        smaller(larger(v, lines.v[0][i]), lines.v[1][i])
    }

    /// The width of a line's interval of q.
    #[inline(always)]
    pub(in crate::trace) fn height<const N: usize>(&self, lines: &Lines<N>, i: usize) -> f32 {
        let [v0, v1] = [lines.v[0][i], lines.v[1][i]];
        let [q0, q1] = [lines.q[0][i], lines.q[1][i]];
        let [y0, y1] = [v0, v1].map(|v| lines.start[i] + v * self.length);
        let [r0, r1] = [lines.r[0][i], lines.r[1][i]];
        // One sign: (q₁² - q₀²) / (q₁ + q₀), where q² = 1 - distance/r, without a difference.
        let across = (v1 - v0) * self.length;
        let short = lines.distance[i] * across * (y0 + y1) / ((r0 + r1) * (r0 * r1) * (q0 + q1));
        if y0 * y1 > 0.0 { short } else { q1 - q0 }
    }

    /// Of points chosen evenly over the area, one over the density at a place: area times the solid angle per area.
    #[inline(always)]
    pub(super) fn even_solid_angle<const N: usize>(
        &self,
        views: &Views<N>,
        i: usize,
        [u, v]: [f32; 2],
    ) -> f32 {
        let [z, x0, y0] = [0, 1, 2].map(|axis| views.offset[axis][i]);
        let x = x0 + u * self.width;
        let y = y0 + u * self.shear + v * self.length;
        let squared = larger(z * z + x * x + y * y, f32::MIN_POSITIVE);
        self.width * self.length * z / (squared * squared.sqrt())
    }
}

/// tan(α/2) of the first of two angles whose tangents are x/z, and how much more it is of the second: their x differ
/// by `width`.
#[inline(always)]
fn half_tangents(z: f32, x: [f32; 2], width: f32) -> (f32, f32) {
    let h = x.map(|x| (z * z + x * x).sqrt());
    let divisors = h.map(|h| larger(z + h, f32::MIN_POSITIVE));
    let t = [x[0] / divisors[0], x[1] / divisors[1]];
    // One sign: x₁/(z+h₁) - x₀/(z+h₀) without a difference.
    let lever = z + z * z * (x[0] + x[1]) / (x[1] * h[0] + x[0] * h[1]);
    let short = width * lever / (divisors[0] * divisors[1]);
    (
        t[0],
        if x[0] * x[1] > 0.0 {
            short
        } else {
            t[1] - t[0]
        },
    )
}
