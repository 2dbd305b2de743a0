//! Where on a parallelogram light a point is chosen: by a density per solid angle that is nearly proportional to
//! cosine × radiance × reflectance, and known.
//!
//! # The cylinder
//! About the axis through the shading point along the light's longer edge, directions have an angle α around it and a
//! sine s of their elevation along it, and dω = dα ds. Directions of one α meet the light along a line parallel to that edge
//! and see one interval of s; the light as a whole is one interval of α. So no equation has to be solved: α is chosen by a
//! density that is linear between nodes (of each, what its interval of s gives by the trapezoid rule), then s likewise
//! between nodes of its own at that α. What lies below the surface's horizon is cut off from both intervals.
//!
//! In place of α stands t = tan(α/2): dα = 2 dt / (1 + t²), and no trigonometry is needed. In place of s stands
//! q = √2 sin(φ/2), φ the elevation: s = q √(2 - q²), cos φ = 1 - q², ds = 2 cos φ / √(2 - q²) dq. In both, the light of a
//! panel that fills the sky is nearly linear between few nodes, as it is not in α and s.
//!
//! # Digits
//! The widths of both intervals are factors of what arrives, so they are computed from the light's own width and length
//! and not as differences. A point is put together from its place on the light, so it lies on the light to f32's last digits.
//! Of lights that look small u and v stand for t and q: they are the same there but for a factor.
//!
//! # Columns
//! Plain loops over N receivers, whose bodies have no branch: N = 1 for one, some dozens for a batch, with the same bits.

use super::piecewise::{choose, larger, relative_luminances, smaller, within_one};
use super::polynomials::{exp2, log2};
use super::receiver::Receivers;
use glam::Vec3;
use std::f32::consts::SQRT_2;

/// Below this solid angle in sr digits of t and q get scarce.
const LEAST_SOLID_ANGLE: f32 = 1e-4;

/// As a part of the longer edge, the least width or length that rounding leaves some digits of.
const LEAST_EXTENT: f32 = 1e-6;

/// The sharpest lobe that the nodes see, as an exponent times their squared distance in radians: a sharper one may
/// fall between them.
const SHARPEST: f32 = 2.0;

/// Nodes along α for matt receivers, and for those with a highlight. Along q there are always five.
const MATT_ROWS: usize = 3;
const GLOSSY_ROWS: usize = 9;

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
    luminances: [f32; 4],
    is_even: bool,
    /// The light's first edge is the longer one, and stands in the second's place here.
    is_turned: bool,
}

/// The places that numbers choose, in columns.
#[derive(Clone, Copy, Debug)]
pub struct Places<const N: usize> {
    /// Along the first and the second edge, in [0, 1].
    pub uv: [[f32; N]; 2],
    /// One over the density, sr; 0 where the light does not shine.
    pub solid_angle: [f32; N],
}

/// The light from the receivers, in its own axes: towards its plane, across, along.
struct Views<const N: usize> {
    offset: [[f32; N]; 3],
    normal: [[f32; N]; 3],
    mirrored: [[f32; N]; 3],
    /// The first and the last line, in u, of which some part is not below the horizon.
    ends: [[f32; N]; 2],
    /// t of the first line, and how much more it is of the last.
    first: [f32; N],
    width: [f32; N],
}

/// A line of the light: what directions of one α meet.
struct Lines<const N: usize> {
    u: [f32; N],
    /// dα/dt.
    stretch: [f32; N],
    /// Distance from the axis, squared and not.
    squared: [f32; N],
    distance: [f32; N],
    /// Component along the axis of the line's start.
    start: [f32; N],
    /// The normal's and the mirrored direction's component away from the axis.
    normal: [f32; N],
    mirrored: [f32; N],
    /// The part above the horizon: in v, and in q.
    v: [[f32; N]; 2],
    q: [[f32; N]; 2],
}

/// What a surface reflects, as the nodes see it.
struct Lobes<const N: usize> {
    diffuse: [f32; N],
    specular: [f32; N],
    shininess: [f32; N],
}

impl ParallelogramFrame {
    /// Of a light with that corner, edges and linear RGB at the corners in the order of
    /// [`ParallelogramLight::colors`](super::ParallelogramLight::colors); `None` where rounding leaves no parallelogram.
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

    /// The places that `numbers` in [0, 1) choose for matt receivers, of which nothing but where they are and their
    /// normals is read.
    #[inline(always)]
    pub fn matt_places<const N: usize>(
        &self,
        receivers: &Receivers<N>,
        numbers: &[[f32; N]; 2],
    ) -> Places<N> {
        match self.is_even {
            true => self.places::<false, true, MATT_ROWS, N>(receivers, numbers),
            false => self.places::<false, false, MATT_ROWS, N>(receivers, numbers),
        }
    }

    /// The same for receivers with a highlight.
    #[inline(always)]
    pub fn glossy_places<const N: usize>(
        &self,
        receivers: &Receivers<N>,
        numbers: &[[f32; N]; 2],
    ) -> Places<N> {
        match self.is_even {
            true => self.places::<true, true, GLOSSY_ROWS, N>(receivers, numbers),
            false => self.places::<true, false, GLOSSY_ROWS, N>(receivers, numbers),
        }
    }

    #[inline(always)]
    fn places<const GLOSSY: bool, const EVEN: bool, const ROWS: usize, const N: usize>(
        &self,
        receivers: &Receivers<N>,
        numbers: &[[f32; N]; 2],
    ) -> Places<N> {
        let views = self.views::<GLOSSY, N>(receivers);
        let lobes = self.lobes::<GLOSSY, ROWS, N>(receivers, &views);
        let mut marginal = [[0.0; N]; ROWS];
        let mut seen = [0.0; N];
        for (row, marginal) in marginal.iter_mut().enumerate() {
            let part = row as f32 / (ROWS - 1) as f32;
            let lines = self.lines::<GLOSSY, N>(&views, |_| part, |_| true);
            let nodes = self.nodes::<GLOSSY, EVEN, N>(&views, &lobes, &lines);
            for i in 0..N {
                let sum =
                    0.5 * (nodes[0][i] + nodes[4][i]) + nodes[1][i] + nodes[2][i] + nodes[3][i];
                let angle = (lines.q[1][i] - lines.q[0][i]) * lines.stretch[i];
                marginal[i] = sum * angle;
                seen[i] += angle;
            }
        }
        let across = choose(&marginal, &numbers[0]);
        let looks_large =
            |i: usize| seen[i] * views.width[i] > LEAST_SOLID_ANGLE / SQRT_2 * ROWS as f32;
        let lines = self.lines::<GLOSSY, N>(&views, |i| across.place[i], looks_large);
        let nodes = self.nodes::<GLOSSY, EVEN, N>(&views, &lobes, &lines);
        let along = choose(&nodes, &numbers[1]);

        let [mut u, mut v, mut solid_angle] = [[0.0; N]; 3];
        for i in 0..N {
            let height = self.height(&lines, i);
            let q = lines.q[0][i] + along.place[i] * height;
            let c = larger(1.0 - q * q, f32::MIN_POSITIVE);
            let root = (2.0 - q * q).sqrt();
            let y = lines.distance[i] * (q * root) / c;
            let stretch = lines.stretch[i] * (2.0 * c / root);
            let warped = stretch * (views.width[i] * height);

            let [v0, v1] = [lines.v[0][i], lines.v[1][i]];
            let even_v = v0 + along.place[i] * (v1 - v0);
            let shown = (views.ends[1][i] - views.ends[0][i]) * (v1 - v0);
            let even = shown * self.even_solid_angle(&views, i, [lines.u[i], even_v]);
            let is_large = looks_large(i);
            u[i] = lines.u[i];
            v[i] = if is_large {
                self.v_at(&lines, i, y)
            } else {
                even_v
            };
            let chosen = if is_large { warped } else { even };
            let shines = views.offset[0][i] > 0.0 && views.ends[0][i] < views.ends[1][i];
            let density = across.density[i] * along.density[i];
            solid_angle[i] = if shines { chosen / density } else { 0.0 };
        }
        Places {
            uv: if self.is_turned { [v, u] } else { [u, v] },
            solid_angle,
        }
    }

    #[inline(always)]
    fn views<const GLOSSY: bool, const N: usize>(&self, receivers: &Receivers<N>) -> Views<N> {
        let mut views = Views {
            offset: [[0.0; N]; 3],
            normal: [[0.0; N]; 3],
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
            views.ends[0][i] = first;
            views.ends[1][i] = last;
            views.first[i] = t;
            views.width[i] = width;
        }
        views
    }

    /// Lobes no sharper than the nodes can see: where the light is nearest to the axis they are farthest apart.
    #[inline(always)]
    fn lobes<const GLOSSY: bool, const ROWS: usize, const N: usize>(
        &self,
        receivers: &Receivers<N>,
        views: &Views<N>,
    ) -> Lobes<N> {
        let mut lobes = Lobes {
            diffuse: receivers.diffuse,
            specular: receivers.specular,
            shininess: receivers.shininess,
        };
        if GLOSSY {
            let nearest = |i: usize| within_one(-views.first[i] / views.width[i]);
            let lines = self.lines::<false, N>(views, nearest, |_| true);
            for i in 0..N {
                // In radians, at most.
                let across = 2.0 / (ROWS - 1) as f32 * views.width[i];
                let along = SQRT_2 / 4.0 * (lines.q[1][i] - lines.q[0][i]);
                let step = larger(across, along);
                let shininess = smaller(receivers.shininess[i], SHARPEST / (step * step));
                let [diffuse, specular] = receivers.parts(i);
                lobes.diffuse[i] = diffuse;
                lobes.specular[i] = specular * (0.5 * (shininess + 2.0));
                lobes.shininess[i] = shininess;
            }
        }
        lobes
    }

    /// The lines at places in [0, 1] of the interval of t, or of that of u where there is no difference but in digits.
    #[inline(always)]
    fn lines<const GLOSSY: bool, const N: usize>(
        &self,
        views: &Views<N>,
        place: impl Fn(usize) -> f32,
        by_angle: impl Fn(usize) -> bool,
    ) -> Lines<N> {
        let mut lines = Lines {
            u: [0.0; N],
            stretch: [0.0; N],
            squared: [0.0; N],
            distance: [0.0; N],
            start: [0.0; N],
            normal: [0.0; N],
            mirrored: [0.0; N],
            v: [[0.0; N]; 2],
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
            let crossing = within_one(-(normal + start * ny) * self.per_length / ny);
            let v = [
                if ny > 0.0 { crossing } else { 0.0 },
                if ny < 0.0 { crossing } else { 1.0 },
            ];
            let q = v.map(|v| {
                let y = start + v * self.length;
                let r = (squared + y * y).sqrt();
                y / (r * (r + distance)).sqrt()
            });
            lines.u[i] = u;
            lines.stretch[i] = 2.0 / (1.0 + t * t);
            lines.squared[i] = squared;
            lines.distance[i] = distance;
            lines.start[i] = start;
            lines.normal[i] = normal * per_distance;
            if GLOSSY {
                let [mz, mx] = [0, 1].map(|axis| views.mirrored[axis][i]);
                lines.mirrored[i] = (z * mz + x * mx) * per_distance;
            }
            for end in 0..2 {
                lines.v[end][i] = v[end];
                lines.q[end][i] = q[end];
            }
        }
        lines
    }

    /// What the density per q is to be at five places of the lines.
    #[inline(always)]
    fn nodes<const GLOSSY: bool, const EVEN: bool, const N: usize>(
        &self,
        views: &Views<N>,
        lobes: &Lobes<N>,
        lines: &Lines<N>,
    ) -> [[f32; N]; 5] {
        let mut nodes = [[0.0; N]; 5];
        for (k, nodes) in nodes.iter_mut().enumerate() {
            let part = 0.25 * k as f32;
            for i in 0..N {
                let q = lines.q[0][i] + part * (lines.q[1][i] - lines.q[0][i]);
                let square = q * q;
                let c = 1.0 - square;
                // √(2 - q²); a density may be off by a little, as long as it is known.
                let root = if GLOSSY {
                    larger(2.0 - square, 0.0).sqrt()
                } else {
                    1.414_2 - square * (0.353_6 + 0.060_6 * square)
                };
                let s = q * root;
                // ds/dq is 2c over the root, and that is nearly this.
                let stretch = c * (0.707_1 + square * (0.176_8 + 0.116_1 * square));
                let cosine = c * lines.normal[i] + s * views.normal[2][i];
                let mut node = larger(cosine, 0.0) * stretch;
                if GLOSSY {
                    let r_dot_v = c * lines.mirrored[i] + s * views.mirrored[2][i];
                    let exponent = smaller(log2(larger(r_dot_v, f32::MIN_POSITIVE)), 0.0);
                    let lobe = exp2(lobes.shininess[i] * exponent);
                    node *= lobes.diffuse[i] + lobes.specular[i] * lobe;
                }
                if !EVEN {
                    let v = self.v_at(lines, i, lines.distance[i] * s / larger(c, 1e-6));
                    let [a, b, c, d] = self.luminances;
                    let near = a + lines.u[i] * (b - a);
                    let far = c + lines.u[i] * (d - c);
                    node *= near + v * (far - near);
                }
                nodes[i] = node;
            }
        }
        nodes
    }

    /// Where a line has this component along the axis.
    #[inline(always)]
    fn v_at<const N: usize>(&self, lines: &Lines<N>, i: usize, y: f32) -> f32 {
        let v = (y - lines.start[i]) * self.per_length;
        smaller(larger(v, lines.v[0][i]), lines.v[1][i])
    }

    /// The width of a line's interval of q.
    #[inline(always)]
    fn height<const N: usize>(&self, lines: &Lines<N>, i: usize) -> f32 {
        let [v0, v1] = [lines.v[0][i], lines.v[1][i]];
        let [q0, q1] = [lines.q[0][i], lines.q[1][i]];
        let [y0, y1] = [v0, v1].map(|v| lines.start[i] + v * self.length);
        let [r0, r1] = [y0, y1].map(|y| (lines.squared[i] + y * y).sqrt());
        // One sign: (q₁² - q₀²) / (q₁ + q₀), where q² = 1 - distance/r, without a difference.
        let across = (v1 - v0) * self.length;
        let short = lines.distance[i] * across * (y0 + y1) / ((r0 + r1) * (r0 * r1) * (q0 + q1));
        if y0 * y1 > 0.0 { short } else { q1 - q0 }
    }

    /// Of points chosen evenly over the area, one over the density at a place: area times the solid angle per area.
    #[inline(always)]
    fn even_solid_angle<const N: usize>(
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
