//! What is true, found without a tree: every ray against every triangle.
//!
//! [`brute`] uses our own triangle test in f32; the trees must agree with it to the last bit.
//!
//! [`Exact`] computes in f64, with transforms, inverses and formulas of its own. Around each edge lies a band in which
//! f32 cannot tell the sides apart; it is where an edge function is smaller than its error bound. With u = 2⁻²⁴, all
//! quantities relative to the ray's origin in object space, M the largest coordinate of the three corners:
//! * a corner's sheared x and y are off by `δ = 6uM`, and with a transform by `2|εo| + 2|z||εd|/|dz|` more, where
//!   `εo = 6u |L⁻¹||o - T|` and `εd = 5u |L⁻¹||d|` bound the object ray's own error;
//! * so an edge function `P x Q` is off by `E = δ (|Px| + |Py| + |Qx| + |Qy|) + 2δ² + 2u (|Px Qy| + |Py Qx|)`.
//!
//! Outside the band the answer must be the truth. `t = Σ Uᵢ zᵢ / Σ Uᵢ / dz` is off by at most
//! `Σ (Eᵢ + 4u |Uᵢ|) |zᵢ - z| / (|det| - Σ Eᵢ) / |dz|`, and by relative roundings of z and dz: the running bound.

use glam::{DMat3, DVec3, Vec3};

use super::super::geometry::instance::Instance;
use super::super::kernel::safe_ray::SafeRay;
use crate::bvh::hard_cases::sieve::{Sheared, Sieve};
use crate::bvh::hard_cases::single::{ReadyRay, SingleTriangle};
use crate::bvh::{Aggregate, Hit, Ray};

const U: f64 = f32::EPSILON as f64 / 2.0;

/// The nearest hit, by our triangle test, over every triangle of every instance in turn.
pub(crate) fn brute(aggregate: &Aggregate, ray: &Ray) -> Option<Hit> {
    brute_among(aggregate, ray, |instance, _, all| {
        let triangles = aggregate.instances()[instance].mesh.triangles();
        all.extend((0..triangles.len() as u32).filter(|&t| triangles.is_traced(t)));
    })
}

/// The same, where only these triangles of each instance can be hit, which are added to a list.
fn brute_among(
    aggregate: &Aggregate,
    ray: &Ray,
    mut candidates: impl FnMut(usize, &ReadyRay, &mut Vec<u32>),
) -> Option<Hit> {
    let safe = SafeRay::new(ray)?;
    let mut best: Option<Hit> = None;
    let mut some = Vec::new();
    for (number, instance) in aggregate.instances().iter().enumerate() {
        let Some(object) = instance.to_object_ray(&safe.world, ray.time) else {
            continue;
        };
        let ready = ReadyRay::of(object);
        let triangles = instance.mesh.triangles();
        some.clear();
        candidates(number, &ready, &mut some);
        for &triangle in &some {
            let single = SingleTriangle::new(triangles.corners(triangle));
            let Some((t, u, v)) = single.cross(&ready, f32::INFINITY) else {
                continue;
            };
            let hit = Hit {
                t,
                instance: number as u32,
                triangle,
                u,
                v,
            };
            if safe.measure.reaches(hit.t) && best.is_none_or(|best| hit.beats(&best)) {
                best = Some(hit);
            }
        }
    }
    best.map(|hit| safe.measure.scaled(hit))
}

/// What f64 says of one ray and one triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exact {
    pub(crate) verdict: Verdict,
    /// Where the ray meets the triangle's plane; meaningless for a miss.
    pub(crate) t: f64,
    /// How far f32 may be from it; infinite inside the band.
    pub(crate) t_bound: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Hit,
    Miss,
    /// f32 may say either.
    Band,
}

/// A ray as f64 sees it from an instance.
pub(crate) struct ExactRay {
    origin: DVec3,
    direction: DVec3,
    origin_error: f64,
    direction_error: f64,
}

impl ExactRay {
    pub(crate) fn new(instance: &Instance, ray: &Ray) -> Self {
        let transform = instance.world_from_object();
        let linear = transform.matrix3;
        let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis].map(|v| v.as_dvec3());
        let translation = transform.translation.as_dvec3();
        // Cramer's rule.
        let determinant = x.dot(y.cross(z));
        let rows = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)).transpose();
        let inverse = rows * (1.0 / determinant);
        let from = ray.origin.as_dvec3() - translation;
        let direction = ray.direction.as_dvec3();
        let exact = *transform == glam::Affine3A::IDENTITY;
        let blur = |k: f64, v: DVec3| {
            if exact {
                0.0
            } else {
                k * U * (inverse.abs() * v.abs()).max_element()
            }
        };
        Self {
            origin: inverse * from,
            direction: inverse * direction,
            origin_error: blur(6.0, from),
            direction_error: blur(5.0, direction),
        }
    }

    /// Which axes are x, y and z where it looks along z.
    fn axes(&self) -> [usize; 3] {
        let size = self.direction.abs();
        if size.x == size.max_element() {
            [1, 2, 0]
        } else if size.y == size.max_element() {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        }
    }

    /// The same ray for many triangles at once.
    pub(crate) fn sheared(&self) -> Sheared {
        let axes = self.axes();
        let [x, y, z] = axes;
        let along = self.direction;
        Sheared {
            axes,
            from: axes.map(|axis| self.origin[axis]),
            slope: [along[x] / along[z], along[y] / along[z]],
            along: along[z].abs(),
            origin_error: self.origin_error,
            direction_error: self.direction_error,
        }
    }

    pub(crate) fn cross(&self, corners: [Vec3; 3]) -> Exact {
        let [x, y, z] = self.axes();
        let along = self.direction;
        let relative = corners.map(|corner| corner.as_dvec3() - self.origin);
        let largest = relative
            .iter()
            .map(|p| p.abs().max_element())
            .fold(0.0, f64::max);
        let flat = relative.map(|p| {
            (
                p[x] - along[x] / along[z] * p[z],
                p[y] - along[y] / along[z] * p[z],
            )
        });
        let deepest = relative.iter().map(|p| p[z].abs()).fold(0.0, f64::max);
        let delta = 6.001 * U * largest
            + 2.0 * self.origin_error
            + 2.0 * deepest * self.direction_error / along[z].abs();
        let mut values = [0.0; 3];
        let mut errors = [0.0; 3];
        for i in 0..3 {
            let (p, q) = (flat[(i + 2) % 3], flat[(i + 1) % 3]);
            values[i] = p.0 * q.1 - p.1 * q.0;
            errors[i] = delta * (p.0.abs() + p.1.abs() + q.0.abs() + q.1.abs())
                + 2.0 * delta * delta
                + 2.0 * U * ((p.0 * q.1).abs() + (p.1 * q.0).abs());
        }
        let sure = |sign: f64, i: usize| values[i] * sign > errors[i];
        let [plus, minus] = [1.0, -1.0].map(|sign| (0..3).filter(|&i| sure(sign, i)).count());
        let verdict = if plus == 3 || minus == 3 {
            Verdict::Hit
        } else if plus > 0 && minus > 0 {
            Verdict::Miss
        } else {
            Verdict::Band
        };
        let det: f64 = values.iter().sum();
        let depth = (0..3).map(|i| values[i] * relative[i][z]).sum::<f64>() / det;
        let slack = det.abs() - errors.iter().sum::<f64>();
        let t_bound = if slack > 0.0 {
            let spread: f64 = (0..3)
                .map(|i| (errors[i] + 4.0 * U * values[i].abs()) * (relative[i][z] - depth).abs())
                .sum();
            let roundings = 12.0 * U * deepest
                + self.origin_error
                + deepest * self.direction_error / along[z].abs();
            (spread / slack + roundings) / along[z].abs()
        } else {
            f64::INFINITY
        };
        Exact {
            verdict,
            t: depth / along[z],
            t_bound,
        }
    }
}

/// How many rays lay inside the band, and how many disagreed outside of it.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rays: usize,
    pub(crate) hits: usize,
    pub(crate) in_band: usize,
    pub(crate) wrong: usize,
    /// Answers of the tree that are not those of [`brute`], bit for bit.
    pub(crate) unlike_brute_force: usize,
    pub(crate) first_wrong: Option<String>,
    /// The largest relative error of a `t` outside the band.
    pub(crate) worst_t: f64,
    /// The largest part of its running bound that an error of `t` took up.
    pub(crate) worst_of_bound: f64,
}

impl Tally {
    /// Compares what was found with the truth in f64.
    pub(crate) fn judge(
        &mut self,
        aggregate: &Aggregate,
        sieve: &Sieve,
        ray: &Ray,
        found: Option<Hit>,
    ) {
        self.judge_among(aggregate, ray, found, |instance, ray, some| {
            sieve.exact(instance, ray, some);
        });
    }

    /// The same, where only these triangles of each instance can be hit, which are added to a list.
    pub(crate) fn judge_among(
        &mut self,
        aggregate: &Aggregate,
        ray: &Ray,
        found: Option<Hit>,
        mut candidates: impl FnMut(usize, &Sheared, &mut Vec<u32>),
    ) {
        self.rays += 1;
        self.hits += usize::from(found.is_some());
        let mut wrong = |why: String| {
            self.wrong += 1;
            self.first_wrong
                .get_or_insert(format!("{why}: {ray:?} {found:?}"));
        };
        let mut of_found = None;
        let mut some = Vec::new();
        // A `t` that f32 cannot hold is beyond every ray's end.
        let end = f64::from(ray.t_max.min(f32::MAX));
        // The nearest end of what surely is hit, at its latest.
        let mut nearest_sure = f64::INFINITY;
        let mut band = false;
        for (number, instance) in aggregate.instances().iter().enumerate() {
            let exact_ray = ExactRay::new(instance, ray);
            let triangles = instance.mesh.triangles();
            if let Some(hit) = found.filter(|hit| hit.instance == number as u32) {
                of_found = Some(exact_ray.cross(triangles.corners(hit.triangle)));
            }
            some.clear();
            candidates(number, &exact_ray.sheared(), &mut some);
            for &triangle in &some {
                let exact = exact_ray.cross(triangles.corners(triangle));
                let (early, late) = (exact.t - exact.t_bound, exact.t + exact.t_bound);
                match exact.verdict {
                    Verdict::Hit if early > 0.0 && late < end => {
                        nearest_sure = nearest_sure.min(late);
                    }
                    Verdict::Hit if early > end => {}
                    Verdict::Miss => {}
                    // Also a hit that lies on one of the ray's ends.
                    _ => band |= late > 0.0 || exact.t_bound.is_nan(),
                }
            }
        }
        match (found, of_found) {
            (None, _) if nearest_sure < f64::INFINITY => {
                return wrong(format!("missed what is at {nearest_sure}"));
            }
            (Some(_), Some(exact)) if exact.verdict == Verdict::Miss => {
                return wrong("hit what is missed".into());
            }
            (Some(hit), Some(exact)) => {
                let t = f64::from(hit.t);
                if exact.verdict == Verdict::Hit {
                    let off = (t - exact.t).abs();
                    self.worst_t = self.worst_t.max(off / exact.t.abs());
                    self.worst_of_bound = self.worst_of_bound.max(off / exact.t_bound);
                }
                if exact.verdict == Verdict::Hit && (t - exact.t).abs() > exact.t_bound {
                    return wrong(format!("t is {} off, bound {}", t - exact.t, exact.t_bound));
                }
                if t > nearest_sure {
                    return wrong(format!("there is a nearer hit at {nearest_sure}"));
                }
            }
            _ => {}
        }
        self.in_band += usize::from(band);
    }

    /// Both oracles at once: the tree's answer against brute force's, bit for bit, and against f64's outside the band.
    pub(crate) fn of(aggregate: &Aggregate, rays: impl IntoIterator<Item = Ray>) -> Self {
        let mut tally = Self::default();
        let sieve = Sieve::of(aggregate);
        for ray in rays {
            let found = aggregate.closest_hit(&ray);
            let truth = brute_among(aggregate, &ray, |instance, ray, some| {
                sieve.rounded(instance, ray.shear(), some);
            });
            if !same(found, truth) || aggregate.occluded(&ray) != truth.is_some() {
                tally.unlike_brute_force += 1;
                tally.first_wrong.get_or_insert(format!(
                    "the tree found {found:?}, brute force {truth:?}, {ray:?}"
                ));
            }
            tally.judge(aggregate, &sieve, &ray, found);
        }
        tally
    }

    /// Adds what another tally counted.
    pub(crate) fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.in_band += other.in_band;
        self.wrong += other.wrong;
        self.unlike_brute_force += other.unlike_brute_force;
        self.first_wrong = self.first_wrong.take().or(other.first_wrong);
        self.worst_t = self.worst_t.max(other.worst_t);
        self.worst_of_bound = self.worst_of_bound.max(other.worst_of_bound);
    }

    /// Whether nothing is wrong.
    pub(crate) fn is_right(&self) -> bool {
        self.wrong == 0 && self.unlike_brute_force == 0
    }
}

/// [`Tally::of`], where nothing may be wrong.
#[cfg(test)]
pub(crate) fn check(
    what: &str,
    aggregate: &Aggregate,
    rays: impl IntoIterator<Item = Ray>,
) -> Tally {
    let tally = Tally::of(aggregate, rays);
    assert!(tally.is_right(), "{what}: {tally:?}");
    println!(
        "{what}: {} rays, {} hits, {} in the band",
        tally.rays, tally.hits, tally.in_band
    );
    tally
}

/// The same to the last bit.
pub(crate) fn same(a: Option<Hit>, b: Option<Hit>) -> bool {
    let bits = |h: Hit| {
        (
            h.t.to_bits(),
            h.instance,
            h.triangle,
            h.u.to_bits(),
            h.v.to_bits(),
        )
    };
    a.map(bits) == b.map(bits)
}
