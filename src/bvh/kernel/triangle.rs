//! The ray against one triangle: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (JCGT 2(1), 2013).
//!
//! The corners are moved into a frame in which the ray starts at the origin and runs along z. There the triangle is hit
//! when the three edge functions do not differ in sign.
//!
//! # Why nothing leaks
//! An edge function is the difference of two rounded products. Rounding is monotone, so the difference never has the
//! wrong sign; it can only be zero where the truth is not. Zero counts as inside. Two triangles that share an edge move
//! its corners to the same places and compute, for that edge, exactly opposite numbers. So the moved triangles cover
//! what the true ones cover, without a gap. (A fused multiply-add would break this: its products round differently on
//! either side.)
//!
//! # Rules
//! * Both sides are hit. An edge or a corner belongs to every triangle that touches it.
//! * A triangle without area as the ray sees it (`det == 0`) is missed: so a ray in a triangle's plane misses it.
//! * The ray must also pass the triangle's own box ([`super::slab`]), and `t` is clamped to the piece of the ray within
//!   it. The first throws out the far, tiny triangles whose edge functions all round to zero or one ulp. The second
//!   repairs `t` of a grazing hit. Both together make every hit independent of the tree: the boxes above a triangle
//!   contain its own, so none of them is entered after that `t`.
//!
//! # `t` in f64
//! The paper interpolates `t` from the moved corners, in f32. Its error is that of the farthest corner: a floor of 1e4
//! is not told from a sheet of paper on it, and a ray that leaves a sliver finds it again. Here the crossing with the
//! triangle's plane is computed in f64, where differences of f32 are exact, and rounded once. Only triangles that
//! passed the edge functions pay for it, one or two a ray.
//!
//! # What need not be asked for its box
//! A ray that leaves a surface crosses it again, just behind its origin, and often those that lie in it or behind it: the
//! triangle itself is not tested ([`Ray::starts_on`](super::ray::Ray::starts_on)), and for the others the box decides nothing, so
//! most of the work is saved. Where the edge functions see a crossing, some point of the ray at `s` is within
//! 6uM of the triangle along each axis, u and M as in [`super::slab`], and s lies between `entry` and `exit`. With the plane
//! n · (x - a) = 0, H = n · (a - o) and R = n · d that says |R s - H| <= 6uM |n|₁. The crossing with the plane is at H / R,
//! so `t`, that clamped to the box, is between the two: |R t - H| <= 6uM |n|₁ too. If |H| is more than that and the sign
//! of R is beyond doubt, `t` has the sign of H / R; and if |H| is by so much more than |R| times the limit, `t` is beyond
//! the limit.
//!
//! # What is surely crossed
//! Most crossings are far from every edge: then the line of the ray passes the true triangle, the crossing with the plane lies
//! in its box, and the box has nothing to say. Let h be the largest size of the x' and y' of its corners, L its longest side
//! along any axis, and s the slack, 16u (|v|∞ + |o|∞) or more. Those x' and y' are off by at most 6uM <= 0.38s, so the terms
//! of an edge function by 1.52sh + 0.29s² together; its own roundings are less than 4uh² <= 0.51sh, since h <= 2M and a
//! little. An edge function of more than 3s (h + s) has the sign of the true one, then, and three of one sign say that the
//! line crosses. What products lose that are too small for relative roundings is less than the smallest normal number.
//! * R is the sum of the true edge functions times d_z. In f64 it is off by less than 2⁻⁴⁷L² d_z, and H by 2⁻⁴⁷L² M. So
//!   where the edge functions are larger by another 2⁻²²L², H / R is off by less than u in M and in itself, and rounded to
//!   f32 it moves a point of the ray by 2uM. The pads of [`super::slab`] were made for a line that misses by 6uM: `t` lies
//!   in the box as the ray meets it, and needs no clamp. (L <= 2h and how far its depths are apart.)
//! * If the depths of all corners lie between those of the ray's start and of the limit by more than the slack, so does the
//!   crossing: whether there is one is known without its plane ([`Depths::sure_span`]).

use glam::{DVec3, Vec3, Vec3A};

use super::{object_ray::ObjectRay, slab::triangle_box};

/// An axis of space. Not a number, so that what has three of something is indexed by it without a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// Which axes are x, y and z in the frame of a ray that goes farthest along x, y or z: the last one twice, so that two bits
/// are a number of these.
pub(crate) const FRAMES: [[Axis; 3]; 4] = [
    [Axis::Y, Axis::Z, Axis::X],
    [Axis::Z, Axis::X, Axis::Y],
    [Axis::X, Axis::Y, Axis::Z],
    [Axis::X, Axis::Y, Axis::Z],
];

/// The ray's frame: which axis is z, and the shear that turns the direction into it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    /// Which axes are x, y and z in the frame.
    pub(crate) axes: [Axis; 3],
    /// The origin along those axes.
    pub(crate) from: [f32; 3],
    /// The shear of x and of y by z.
    pub(crate) slope: [f32; 2],
    pub(crate) depths: Depths,
}

impl Shear {
    /// The frame of a ray. `direction` is finite and not zero.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let size = direction.abs();
        // Chosen without a branch, since rays that follow each other may go anywhere: each of these is one instruction
        // or two, but the larger one by `in_plane` would be a jump.
        let in_plane = usize::from(size.x <= size.y);
        let most = if size.x > size.y { size.x } else { size.y };
        let z = if most > size.z { in_plane } else { 2 };
        let axes = FRAMES[z];
        let [x, y, z] = axes.map(|axis| axis as usize);
        let (from, along) = (origin.to_array(), direction.to_array());
        Self {
            axes,
            from: [from[x], from[y], from[z]],
            slope: [along[x] / along[z], along[y] / along[z]],
            depths: Depths::new(along[z], origin.abs().max_element()),
        }
    }
}

/// Where along z of its frame a ray may meet something.
///
/// Depths are measured against z, from the origin: `origin - corner`, as the corners themselves are
/// ([`super::wide::TriangleBlock`]).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depths {
    /// How much deeper the ray is for each of its `t`, and a little more.
    pub(crate) rate: f32,
    /// What the ray's origin adds to the slack.
    pub(crate) slack: f32,
}

impl Depths {
    /// 16u, u as in [`super::slab`].
    pub(crate) const SLACK: f32 = 8.0 * f32::EPSILON;
    /// [`Self::rate`] of a ray whose direction is 1 along z.
    pub(crate) const RATE: f32 = -(1.0 + Self::SLACK);

    /// Of a ray that goes so far `along` z, from an origin of which that is the largest coordinate, without its sign.
    #[inline(always)]
    pub(crate) fn new(along: f32, farthest: f32) -> Self {
        Self {
            rate: along * Self::RATE,
            slack: farthest * Self::SLACK + f32::MIN_POSITIVE,
        }
    }

    /// 16u of what the coordinates of a triangle and of the ray's origin are at most, and a little more; `reach` is no less
    /// than any of the triangle.
    #[inline(always)]
    pub(crate) fn slack_of(&self, reach: f32) -> f32 {
        reach * Self::SLACK + self.slack
    }

    /// Between which depths all of a triangle must lie, so that a ray whose line surely crosses it does so in `0 < t <= limit`,
    /// and in every measure that a ray may have ([`super::safe_ray`]). Twice the slack is more than the roundings of depths, of
    /// `t` and of the limit take.
    #[inline(always)]
    pub(crate) fn sure_span(&self, slack: f32, limit: f32) -> (f32, f32) {
        let soonest = self.rate * (1.0 / IN_RANGE);
        let latest = self.rate * (limit.min(IN_RANGE) * (1.0 - 4.0 * Self::SLACK));
        let (first, last) = if self.rate > 0.0 {
            (soonest, latest)
        } else {
            (latest, soonest)
        };
        (first + slack, last - slack)
    }

    /// Between which depths something of a triangle lies that [`accept`] finds in `0 < t <= limit`. `reach` is no less than
    /// any coordinate of the triangle.
    ///
    /// `t` lies within the triangle's box, and so between its faces across z. Those are off by the pads, 12u of the
    /// triangle's and of the origin's coordinates ([`super::slab`]), and by five roundings, of which two are relative to
    /// the same coordinates and three to `t`: less than 16u of either. What is too small to have relative roundings is
    /// kept.
    #[inline(always)]
    pub(crate) fn span(&self, reach: f32, limit: f32) -> (f32, f32) {
        let slack = self.slack_of(reach);
        let end = limit * self.rate;
        // Each of these is one instruction.
        let first = if end < 0.0 { end } else { 0.0 };
        let last = if end > 0.0 { end } else { 0.0 };
        (first - slack, last + slack)
    }
}

/// A crossing: `t`, and the barycentric weights of corners 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
}

/// Where the ray crosses a triangle, `0 < t <= limit`, whose edge functions do not differ in sign and have a finite sum, not
/// zero: the rest of the test, for the few that get so far ([`super::wide`] has its beginning, for several at once). Whether
/// it `is_sure` that its line does changes nothing but the work.
#[inline(always)]
pub(crate) fn accept(
    ray: &ObjectRay,
    corners: [Vec3; 3],
    [u, v, w]: [f32; 3],
    limit: f32,
    is_sure: bool,
) -> Option<Crossing> {
    let plane = Plane::of(ray, corners);
    let mut t = plane.t();
    if !is_sure {
        if !((t > 0.0) & (t <= limit)) && plane.is_outside(ray, corners, limit) {
            return None;
        }
        let (entry, exit) = ray.slab.span(&triangle_box(corners.map(Vec3A::from)));
        if !((entry <= exit) & (exit > 0.0) & (entry <= limit)) {
            return None;
        }
        t = clamp(t, entry, exit);
    }
    ((t > 0.0) & (t <= limit)).then(|| {
        let inverse = 1.0 / (u + v + w);
        // The zero of an edge function has the sign that the order of its differences gives it; no weight has one.
        Crossing {
            t,
            u: v * inverse + 0.0,
            v: w * inverse + 0.0,
        }
    })
}

/// What an edge function must be beyond doubt by: this many slacks times (the slack and h),
pub(crate) const UNSURE_EDGE: f32 = 3.0;
/// and this part of L², s, h and L of the module.
pub(crate) const UNSURE_PLANE: f32 = 1.0 / (1 << 22) as f32;
/// Neither this nor its reciprocal comes to the end of the numbers when the ray is scaled by 2¹⁰⁰ or its reciprocal
/// ([`super::safe_ray`]).
const IN_RANGE: f32 = (1u64 << 26) as f32;
/// The part of M by which a point of the ray may be off the triangle that it passes: 7u.
const MOVED: f64 = 3.5 * f32::EPSILON as f64;
/// The part of its terms by which n · d may be off, many times over.
const UNSURE: f64 = 1.0 / (1u64 << 40) as f64;
/// A little more than 1, for the roundings of t.
const BEYOND: f64 = 1.0 + 4.0 * f32::EPSILON as f64;

/// A NaN (0/0: the plane contains the ray after all) becomes `entry`.
#[inline(always)]
fn clamp(t: f32, entry: f32, exit: f32) -> f32 {
    let t = if t > entry { t } else { entry };
    if t < exit { t } else { exit }
}

/// A triangle's plane and the line of the ray, in f64: H, R and n of the module.
struct Plane {
    normal: DVec3,
    height: f64,
    rate: f64,
}

impl Plane {
    #[inline(always)]
    fn of(ray: &ObjectRay, corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners;
        let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        let normal = (b - a).cross(c - a);
        Self {
            normal,
            height: normal.dot(a - ray.origin.as_dvec3()),
            rate: normal.dot(ray.direction.as_dvec3()),
        }
    }

    /// Where the line of the ray meets it.
    #[inline(always)]
    fn t(&self) -> f32 {
        (self.height / self.rate) as f32
    }

    /// Whether the triangle is surely not hit in `0 < t <= limit`, whatever its box says (see the module).
    #[inline(always)]
    fn is_outside(&self, ray: &ObjectRay, corners: [Vec3; 3], limit: f32) -> bool {
        let away = corners.map(|corner| (Vec3A::from(corner) - ray.origin).abs());
        let farthest = away[0].max(away[1]).max(away[2]).max_element();
        let size = self.normal.abs().element_sum();
        let off = MOVED * f64::from(farthest) * size;
        let (height, rate) = (self.height.abs(), self.rate.abs());
        let longest = ray.direction.abs().max_element();
        let is_sure = (height > off) & (rate > size * f64::from(longest) * UNSURE);
        let is_behind = (self.height < 0.0) != (self.rate < 0.0);
        let is_beyond = height - off > rate * f64::from(limit) * BEYOND;
        is_sure & (is_behind | is_beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::hard_cases::random::Random;

    /// What the box and the plane say, without a short way.
    fn asked(ray: &ObjectRay, corners: [Vec3; 3], limit: f32) -> Option<f32> {
        let (entry, exit) = ray.slab.span(&triangle_box(corners.map(Vec3A::from)));
        let t = clamp(Plane::of(ray, corners).t(), entry, exit);
        let passes = (entry <= exit) & (exit > 0.0) & (entry <= limit);
        (passes & (t > 0.0) & (t <= limit)).then_some(t)
    }

    /// Whether the edge functions see a crossing.
    fn edges(shear: &Shear, corners: [Vec3; 3]) -> Option<[f32; 3]> {
        let [x, y, z] = shear.axes.map(|axis| axis as usize);
        let moved = corners.map(|p| {
            let depth = p[z] - shear.from[2];
            [
                (p[x] - shear.from[0]) - depth * shear.slope[0],
                (p[y] - shear.from[1]) - depth * shear.slope[1],
            ]
        });
        let edge = |p: [f32; 2], q: [f32; 2]| p[0] * q[1] - p[1] * q[0];
        let [a, b, c] = moved;
        let all = [edge(c, b), edge(a, c), edge(b, a)];
        let is_inside = all.iter().all(|e| *e >= 0.0) || all.iter().all(|e| *e <= 0.0);
        (is_inside && all.iter().sum::<f32>() != 0.0).then_some(all)
    }

    #[test]
    fn what_is_not_asked_for_its_box_would_not_have_been_hit() {
        let mut random = Random::new(11);
        let (mut crossed, mut met, mut short) = (0, 0, 0);
        for round in 0..400_000 {
            let scale = (random.between(-30.0, 30.0) as i32 as f32).exp2();
            let middle = random.cube() * [0.0, 1.0, 100.0][round % 3];
            let flat = [1.0, 1e-2, 1e-5][round / 3 % 3];
            let corner = |p: Vec3| (middle + p * Vec3::new(1.0, flat, 1.0)) * scale;
            let corners = [(); 3].map(|()| corner(random.cube()));
            let [p, q] = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
            let within = corners[0].lerp(corners[1], p).lerp(corners[2], q);
            // From the triangle itself but for a few units in the last place, or from elsewhere; steep, or almost in its plane.
            let ulps = [0.0, 2.0, 20.0, 1e3, 1e6][round / 9 % 5] * f32::EPSILON;
            let origin = within + random.cube() * ulps * within.abs().max_element();
            let direction = if round % 2 == 0 {
                random.cube()
            } else {
                (corners[1] - within) + random.cube() * scale * random.between(0.0, 1e-4)
            };
            let (origin, direction) = (Vec3A::from(origin), Vec3A::from(direction));
            if direction == Vec3A::ZERO {
                continue;
            }
            let shear = Shear::new(origin, direction);
            let longest = direction.abs().max_element();
            let ray = ObjectRay::new(origin, direction, longest);
            let Some(edges) = edges(&shear, corners) else {
                continue;
            };
            crossed += 1;
            let t = Plane::of(&ray, corners).t();
            let limits = [f32::INFINITY, 1.0, 1e-3, t, t.next_down(), 0.5 * t];
            for limit in limits.into_iter().filter(|limit| *limit > 0.0) {
                let expected = asked(&ray, corners, limit);
                let found = accept(&ray, corners, edges, limit, false).map(|hit| hit.t);
                assert_eq!(
                    found, expected,
                    "round {round}, limit {limit:e}, {corners:?}"
                );
                met += usize::from(found.is_some());
                short += usize::from(Plane::of(&ray, corners).is_outside(&ray, corners, limit));
            }
        }
        assert!(
            crossed > 100_000 && met > 50_000 && short > 50_000,
            "{crossed} crossed, {met} hits, {short} not asked"
        );
    }
}
