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

use super::parallelogram_frame::{Lines, ParallelogramFrame, Views};
use super::receiver::Receivers;
use crate::trace::math::piecewise::{choose, larger, smaller, within_one};
use crate::trace::math::polynomials::{exp2, log2};
use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Below this solid angle in sr digits of t and q get scarce.
const LEAST_SOLID_ANGLE: f32 = 1e-4;

/// The sharpest lobe that the nodes see, as an exponent times their squared distance in radians: a sharper one may fall
/// between them. Of 2, 4, 8 and no limit, 8 left the least noise under panels 0.3 to 3 times their own size above a
/// floor, with exponents from 50 to 1000.
const SHARPEST: f32 = 8.0;

/// Nodes along α for matt receivers, and for those with a highlight. Along q there are always five.
const MATT_ROWS: usize = 3;
const GLOSSY_ROWS: usize = 9;

/// The places that numbers choose, in columns.
#[derive(Clone, Copy, Debug)]
pub struct Places<const N: usize> {
    /// Along the first and the second edge, in [0, 1].
    pub uv: [[f32; N]; 2],
    /// One over the density, sr; 0 where the light does not shine.
    pub solid_angle: [f32; N],
}

/// What a surface reflects, as the nodes see it.
struct Lobes<const N: usize> {
    diffuse: [f32; N],
    specular: [f32; N],
    shininess: [f32; N],
}

/// What choosing places for some receivers takes that does not depend on the numbers.
pub(in crate::trace) struct Prepared<const ROWS: usize, const N: usize> {
    views: Views<N>,
    lobes: Lobes<N>,
    /// What the lines at the nodes along α give.
    marginal: [[f32; N]; ROWS],
    /// The widths of their intervals of q together: how large the light looks.
    seen: [f32; N],
}

/// Of receivers without a highlight.
pub(in crate::trace) type MattPrepared<const N: usize> = Prepared<MATT_ROWS, N>;

impl ParallelogramFrame {
    /// The places that `numbers` in [0, 1) choose for matt receivers, of which nothing but where they are and their
    /// normals is read.
    #[inline(always)]
    pub fn matt_places<const N: usize>(
        &self,
        receivers: &Receivers<N>,
        numbers: &[[f32; N]; 2],
    ) -> Places<N> {
        let prepared = self.matt_prepared(receivers);
        self.matt_places_of(&prepared, numbers)
    }

    /// The first part of [`Self::matt_places`].
    #[inline(always)]
    pub(in crate::trace) fn matt_prepared<const N: usize>(
        &self,
        receivers: &Receivers<N>,
    ) -> MattPrepared<N> {
        match self.is_even {
            true => self.prepare::<false, true, MATT_ROWS, N>(receivers),
            false => self.prepare::<false, false, MATT_ROWS, N>(receivers),
        }
    }

    /// The rest of it.
    #[inline(always)]
    pub(in crate::trace) fn matt_places_of<const N: usize>(
        &self,
        prepared: &MattPrepared<N>,
        numbers: &[[f32; N]; 2],
    ) -> Places<N> {
        match self.is_even {
            true => self.places::<false, true, MATT_ROWS, N>(prepared, numbers),
            false => self.places::<false, false, MATT_ROWS, N>(prepared, numbers),
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
            true => {
                let prepared = self.prepare::<true, true, GLOSSY_ROWS, N>(receivers);
                self.places::<true, true, GLOSSY_ROWS, N>(&prepared, numbers)
            }
            false => {
                let prepared = self.prepare::<true, false, GLOSSY_ROWS, N>(receivers);
                self.places::<true, false, GLOSSY_ROWS, N>(&prepared, numbers)
            }
        }
    }

    #[inline(always)]
    fn prepare<const GLOSSY: bool, const EVEN: bool, const ROWS: usize, const N: usize>(
        &self,
        receivers: &Receivers<N>,
    ) -> Prepared<ROWS, N> {
        let views = self.views::<GLOSSY, N>(receivers);
        let lobes = self.lobes::<GLOSSY, ROWS, N>(receivers, &views);
        let mut marginal = [[0.0; N]; ROWS];
        let mut seen = [0.0; N];
        for (row, marginal) in marginal.iter_mut().enumerate() {
            let part = row as f32 / (ROWS - 1) as f32;
            // Where the first and the last line are needs no angle.
            let lines = if row == 0 || row == ROWS - 1 {
                self.lines::<GLOSSY, N>(&views, |_| part, |_| false)
            } else {
                self.lines::<GLOSSY, N>(&views, |_| part, |_| true)
            };
            let nodes = self.nodes::<GLOSSY, EVEN, 3, N>(&views, &lobes, &lines);
            for i in 0..N {
                // Simpson's rule.
                let sum = nodes[0][i] + 4.0 * nodes[1][i] + nodes[2][i];
                // 1 / (1 + t²), nearly.
                let square = lines.t[i] * lines.t[i];
                let stretch = 0.997 - square * (0.939 - square * (0.665 - 0.225 * square));
                let angle = (lines.q[1][i] - lines.q[0][i]) * stretch;
                marginal[i] = sum * angle;
                seen[i] += angle;
            }
        }
        Prepared {
            views,
            lobes,
            marginal,
            seen,
        }
    }

    #[inline(always)]
    fn places<const GLOSSY: bool, const EVEN: bool, const ROWS: usize, const N: usize>(
        &self,
        prepared: &Prepared<ROWS, N>,
        numbers: &[[f32; N]; 2],
    ) -> Places<N> {
        let Prepared {
            views,
            lobes,
            marginal,
            seen,
        } = prepared;
        let across = choose(marginal, &numbers[0]);
        let looks_large =
            |i: usize| seen[i] * views.width[i] > 0.5 / SQRT_2 * LEAST_SOLID_ANGLE * ROWS as f32;
        let lines = self.lines::<GLOSSY, N>(views, |i| across.place[i], looks_large);
        let nodes = self.nodes::<GLOSSY, EVEN, 5, N>(views, lobes, &lines);
        let along = choose(&nodes, &numbers[1]);

        let [mut u, mut v, mut solid_angle] = [[0.0; N]; 3];
        for i in 0..N {
            let height = self.height(&lines, i);
            let q = lines.q[0][i] + along.place[i] * height;
            let c = larger(1.0 - q * q, f32::MIN_POSITIVE);
            let root = (2.0 - q * q).sqrt();
            let y = lines.distance[i] * (q * root) / c;
            // dα/dt · ds/dq.
            let stretch = 4.0 * c / (root * (1.0 + lines.t[i] * lines.t[i]));
            let warped = stretch * (views.width[i] * height);

            let [v0, v1] = [lines.v[0][i], lines.v[1][i]];
            let even_v = v0 + along.place[i] * (v1 - v0);
            let shown = (views.ends[1][i] - views.ends[0][i]) * (v1 - v0);
            let even = shown * self.even_solid_angle(views, i, [lines.u[i], even_v]);
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

    /// What the density per q is to be at five places of the lines.
    #[expect(
        clippy::needless_range_loop,
        reason = "every column is read at the same place"
    )]
    #[inline(always)]
    fn nodes<const GLOSSY: bool, const EVEN: bool, const NODES: usize, const N: usize>(
        &self,
        views: &Views<N>,
        lobes: &Lobes<N>,
        lines: &Lines<N>,
    ) -> [[f32; N]; NODES] {
        let mut nodes = [[0.0; N]; NODES];
        for (k, nodes) in nodes.iter_mut().enumerate() {
            let part = k as f32 / (NODES - 1) as f32;
            for i in 0..N {
                let q = lines.q[0][i] + part * (lines.q[1][i] - lines.q[0][i]);
                let square = q * q;
                let c = 1.0 - square;
                // √(2 - q²); a density may be off by a little, as long as it is known.
                let root = if GLOSSY {
                    larger(2.0 - square, 0.0).sqrt()
                } else {
                    SQRT_2 - square * (0.353_6 + 0.060_6 * square)
                };
                let s = q * root;
                // ds/dq is 2c over the root, and that is nearly this.
                let stretch = c * (FRAC_1_SQRT_2 + square * (0.176_8 + 0.116_1 * square));
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
}
