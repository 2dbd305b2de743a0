//! Where on a segment light a point is chosen: by a density proportional to what each piece gives a matt surface, in
//! closed form; by nodes of colour and reflectance over that, where they are not the same everywhere.
//!
//! In the plane through the shading point and the line, the normal has the part R, and a direction ω the component w
//! across it. A piece of the line at the distance r that is seen under the angle dφ is r²/d dφ long, d the line's distance, so
//! it gives n·ω/r² dy = n·ω/d dφ = R/d dw (a segment of intensity 1): w is chosen evenly, and no equation has to be solved.
//!
//! Where the segment is seen under a small angle w stands for the place on it: they are the same there but for a factor.
//!
//! Columns as in [`parallelogram_warp`](super::parallelogram_warp).

use super::receiver::Receivers;
use crate::trace::math::piecewise::{choose, larger, relative_luminances, smaller, within_one};
use crate::trace::math::polynomials::{exp2, log2};
use glam::Vec3;

/// In metres. Distances are multiples of the length, and their squares leave f32's range where they are more than 1e19 of it:
/// from so short a segment points are chosen evenly. Nobody sees its ends apart.
const LEAST_LENGTH: f32 = 1e-12;

/// Seen under a smaller angle, in radians, digits of w get scarce.
const LEAST_ANGLE: f32 = 1e-3;

/// The sharpest lobe that the nodes see, as an exponent times their squared distance in radians: as of parallelograms.
const SHARPEST: f32 = 8.0;

/// Nodes where colour or reflectance differ.
const NODES: usize = 9;

/// Below this squared cosine in the plane a direction lies in the horizon, but for rounding.
const LEAST_SQUARED_COSINE: f32 = 1e-7;

/// A segment light as its points are chosen; lengths are multiples of its own.
#[derive(Clone, Copy, Debug)]
pub struct SegmentFrame {
    start: Vec3,
    /// Unit vector from the first end to the second.
    along: Vec3,
    per_metre: f32,
    /// Luminance at the ends.
    luminances: [f32; 2],
    is_even: bool,
}

/// The places that numbers choose, in columns.
#[derive(Clone, Copy, Debug)]
pub struct SegmentPlaces<const N: usize> {
    /// Along the segment, in [0, 1].
    pub u: [f32; N],
    /// What arrives from there of a segment of intensity 1 W/(sr·m), before the surface's cosine, over the density:
    /// 1/m; 0 where nothing does.
    pub arriving: [f32; N],
}

/// The plane of the line and a receiver; components are towards the line and along it.
struct ReceiverPlanes<const N: usize> {
    distance: [f32; N],
    /// Component along the line of the first end.
    start: [f32; N],
    normal: [[f32; N]; 2],
    mirrored: [[f32; N]; 2],
    /// Length of the normal's part.
    part: [f32; N],
    /// The part of the segment above the horizon: in u, and in w.
    u: [[f32; N]; 2],
    w: [[f32; N]; 2],
    /// What it gives.
    irradiance: [f32; N],
    /// The sine of the angle under which it is seen, or a little less.
    angle: [f32; N],
}

impl SegmentFrame {
    /// Of a light with those ends and linear RGB there; `None` where it is too short.
    pub fn new(ends: [Vec3; 2], colors: &[Vec3; 2]) -> Option<Self> {
        let along = ends[1] - ends[0];
        let length = along.length();
        let luminances = relative_luminances(colors);
        (length >= LEAST_LENGTH).then(|| Self {
            start: ends[0],
            along: along / length,
            per_metre: 1.0 / length,
            luminances,
            is_even: luminances[0] == luminances[1],
        })
    }

    /// The places that `numbers` in [0, 1) choose for matt receivers, of which nothing but where they are and their
    /// normals is read.
    #[inline(always)]
    pub fn matt_places<const N: usize>(
        &self,
        receivers: &Receivers<N>,
        numbers: &[f32; N],
    ) -> SegmentPlaces<N> {
        match self.is_even {
            true => self.places::<false, true, N>(receivers, numbers),
            false => self.places::<false, false, N>(receivers, numbers),
        }
    }

    /// The same for receivers with a highlight.
    #[inline(always)]
    pub fn glossy_places<const N: usize>(
        &self,
        receivers: &Receivers<N>,
        numbers: &[f32; N],
    ) -> SegmentPlaces<N> {
        self.places::<true, false, N>(receivers, numbers)
    }

    #[inline(always)]
    fn places<const GLOSSY: bool, const EVEN: bool, const N: usize>(
        &self,
        receivers: &Receivers<N>,
        numbers: &[f32; N],
    ) -> SegmentPlaces<N> {
        let planes = self.planes::<GLOSSY, N>(receivers);
        let (mut place, mut density) = (*numbers, [1.0; N]);
        if GLOSSY || !EVEN {
            let nodes = self.nodes::<GLOSSY, N>(receivers, &planes);
            let chosen = choose(&nodes, numbers);
            (place, density) = (chosen.place, chosen.density);
        }
        let (mut u, mut arriving) = ([0.0; N], [0.0; N]);
        for i in 0..N {
            let (cosine, [towards, along]) = planes.direction(i, place[i]);
            let warped = self.u_at(&planes, i, [towards, along]);
            let looks_large = planes.angle[i] > LEAST_ANGLE;
            let width = planes.u[1][i] - planes.u[0][i];
            u[i] = if looks_large {
                warped
            } else {
                planes.u[0][i] + place[i] * width
            };
            let y = planes.start[i] + u[i];
            let squared = larger(
                planes.distance[i] * planes.distance[i] + y * y,
                f32::MIN_POSITIVE,
            );
            let of_warped = planes.irradiance[i] / (planes.part[i] * cosine);
            let chosen = if looks_large {
                of_warped
            } else {
                width / squared
            } / density[i];
            let shines = planes.u[0][i] < planes.u[1][i];
            arriving[i] = if shines { chosen * self.per_metre } else { 0.0 };
        }
        SegmentPlaces { u, arriving }
    }

    #[inline(always)]
    fn planes<const GLOSSY: bool, const N: usize>(
        &self,
        receivers: &Receivers<N>,
    ) -> ReceiverPlanes<N> {
        let mut planes = ReceiverPlanes {
            distance: [0.0; N],
            start: [0.0; N],
            normal: [[0.0; N]; 2],
            mirrored: [[0.0; N]; 2],
            part: [0.0; N],
            u: [[0.0; N]; 2],
            w: [[0.0; N]; 2],
            irradiance: [0.0; N],
            angle: [0.0; N],
        };
        let at = |columns: &[[f32; N]; 3], i: usize| {
            Vec3::new(columns[0][i], columns[1][i], columns[2][i])
        };
        for i in 0..N {
            let offset = (self.start - at(&receivers.from, i)) * self.per_metre;
            let start = offset.dot(self.along);
            let foot = offset - start * self.along;
            let d = larger(foot.dot(foot), f32::MIN_POSITIVE).sqrt();
            let towards = foot * (1.0 / d);
            let axes = |v: Vec3| [v.dot(towards), v.dot(self.along)];
            let [n, m] = axes(at(&receivers.normal, i));
            let part = larger(n * n + m * m, f32::MIN_POSITIVE).sqrt();

            let at_first = d * n + start * m;
            let at_last = at_first + m;
            let crossing = within_one(-at_first / m);
            let first = if at_first < 0.0 { crossing } else { 0.0 };
            let last = if at_last < 0.0 { crossing } else { 1.0 };
            let is_above = at_first > 0.0 || at_last > 0.0;
            let u = [first, if is_above { last } else { first }];

            let y = u.map(|u| start + u);
            let r = y.map(|y| (d * d + y * y).sqrt());
            let product = r[0] * r[1];
            let width = u[1] - u[0];
            let sum = y[0] + y[1];
            // ∫ (n d + m y) / r³ dy; of one sign without a difference.
            let short =
                width * sum / product * (n * d / (y[1] * r[0] + y[0] * r[1]) + m / (r[0] + r[1]));
            let long =
                n / d * (y[1] / r[1] - y[0] / r[0]) + m * width * sum / ((r[0] + r[1]) * product);
            planes.irradiance[i] = if y[0] * y[1] > 0.0 { short } else { long };
            planes.angle[i] = if d * d + y[0] * y[1] > 0.0 {
                d * width / product
            } else {
                1.0
            };
            for end in 0..2 {
                planes.u[end][i] = u[end];
                planes.w[end][i] = (n * y[end] - m * d) / (part * r[end]);
            }
            planes.distance[i] = d;
            planes.start[i] = start;
            planes.normal[0][i] = n;
            planes.normal[1][i] = m;
            planes.part[i] = part;
            if GLOSSY {
                let mirrored = axes(at(&receivers.mirrored, i));
                for (axis, value) in mirrored.into_iter().enumerate() {
                    planes.mirrored[axis][i] = value;
                }
            }
        }
        planes
    }

    /// What the density is to be at places evenly spaced in w.
    #[expect(
        clippy::needless_range_loop,
        reason = "every column is read at the same place"
    )]
    #[inline(always)]
    fn nodes<const GLOSSY: bool, const N: usize>(
        &self,
        receivers: &Receivers<N>,
        planes: &ReceiverPlanes<N>,
    ) -> [[f32; N]; NODES] {
        let mut nodes = [[0.0; N]; NODES];
        for (k, nodes) in nodes.iter_mut().enumerate() {
            let place = k as f32 / (NODES - 1) as f32;
            for i in 0..N {
                let (_, [towards, along]) = planes.direction(i, place);
                let u = self.u_at(planes, i, [towards, along]);
                let [a, b] = self.luminances;
                let mut node = a + u * (b - a);
                if GLOSSY {
                    // At most: in the middle of the horizon w is an angle.
                    let step = 1.6 / (NODES - 1) as f32 * (planes.w[1][i] - planes.w[0][i]);
                    let shininess = smaller(receivers.shininess[i], SHARPEST / (step * step));
                    let r_dot_v = towards * planes.mirrored[0][i] + along * planes.mirrored[1][i];
                    let exponent = smaller(log2(larger(r_dot_v, f32::MIN_POSITIVE)), 0.0);
                    let [diffuse, specular] = receivers.parts(i);
                    let lobe = 0.5 * (shininess + 2.0) * exp2(shininess * exponent);
                    node *= diffuse + specular * lobe;
                }
                nodes[i] = node;
            }
        }
        nodes
    }

    /// Where a direction in the plane meets the segment.
    #[inline(always)]
    fn u_at<const N: usize>(
        &self,
        planes: &ReceiverPlanes<N>,
        i: usize,
        [towards, along]: [f32; 2],
    ) -> f32 {
        let y = planes.distance[i] * along / larger(towards, f32::MIN_POSITIVE);
        smaller(larger(y - planes.start[i], planes.u[0][i]), planes.u[1][i])
    }
}

impl<const N: usize> ReceiverPlanes<N> {
    /// The direction at a place in w, in [0, 1]: its cosine with the normal's part, and its components.
    #[inline(always)]
    fn direction(&self, i: usize, place: f32) -> (f32, [f32; 2]) {
        let w = self.w[0][i] + place * (self.w[1][i] - self.w[0][i]);
        let cosine = larger(1.0 - w * w, LEAST_SQUARED_COSINE).sqrt();
        let per_part = 1.0 / self.part[i];
        let [n, m] = [self.normal[0][i] * per_part, self.normal[1][i] * per_part];
        (cosine, [n * cosine - m * w, m * cosine + n * w])
    }
}
