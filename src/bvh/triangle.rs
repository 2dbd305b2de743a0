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
//! passed the tests above and may be the nearest pay for it, one or two a ray; measured, it costs at most a few per
//! cent of a ray.

use glam::{Vec3, Vec3A};

use super::{
    goal::Goal,
    slab::{SlabRay, triangle_box},
};

/// The ray's frame: which axis is z, and the shear that turns the direction into it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    origin: Vec3A,
    direction: Vec3A,
    /// Which axes are x, y and z in the frame.
    pub(crate) axes: [usize; 3],
    /// The origin along those axes.
    pub(crate) from: [f32; 3],
    /// The shear of x and of y by z.
    pub(crate) slope: [f32; 2],
    /// The direction along z.
    along: f32,
    /// The origin's largest coordinate, without its sign.
    size: f32,
}

/// The axes after each axis.
const FRAMES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

impl Shear {
    /// The frame of a ray. `direction` is finite and not zero.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let size = direction.abs();
        // Chosen without a branch, since rays that follow each other may go anywhere.
        let in_plane = usize::from(size.x <= size.y);
        let most = if in_plane == 0 { size.x } else { size.y };
        let z = if most > size.z { in_plane } else { 2 };
        let axes = FRAMES[z];
        let [x, y, z] = axes;
        let (from, along) = (origin.to_array(), direction.to_array());
        Self {
            origin,
            direction,
            axes,
            from: [from[x], from[y], from[z]],
            slope: [along[x] / along[z], along[y] / along[z]],
            along: along[z],
            size: origin.abs().max_element(),
        }
    }

    /// Between which depths, the z of the frame, something of a triangle lies that [`accept`] finds in
    /// `0 < t <= limit`. `reach` is no less than any coordinate of the triangle.
    ///
    /// `t` lies within the triangle's box, and so between its faces across z. Those are off by the pads, 12u of the
    /// triangle's and of the origin's coordinates ([`super::slab`]), and by five roundings, of which two are relative to
    /// the same coordinates and three to `t`: less than 16u of either. What is too small to have relative roundings is
    /// kept.
    #[inline(always)]
    pub(crate) fn depths(&self, reach: f32, limit: f32) -> (f32, f32) {
        const SLACK: f32 = 8.0 * f32::EPSILON;
        let slack = (reach + self.size) * SLACK + f32::MIN_POSITIVE;
        let end = limit * self.along * (1.0 + SLACK);
        let (first, last) = if end < 0.0 { (end, 0.0) } else { (0.0, end) };
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
/// zero: the rest of the test, for the few that get so far ([`super::wide`] has its beginning, for several at once).
/// With [`Goal::ANY`] only that there is a crossing is right, and the crossing is not, where the triangle's box tells already.
#[inline(always)]
pub(crate) fn accept<G: Goal>(
    shear: &Shear,
    slab: &SlabRay,
    corners: [Vec3; 3],
    [u, v, w]: [f32; 3],
    limit: f32,
) -> Option<Crossing> {
    let (entry, exit) = slab.span(&triangle_box([
        corners[0].into(),
        corners[1].into(),
        corners[2].into(),
    ]));
    if !((entry <= exit) & (exit > 0.0) & (entry <= limit)) {
        return None;
    }
    if G::ANY && (entry > 0.0) & (exit < limit) {
        return Some(Crossing {
            t: exit,
            u: 0.0,
            v: 0.0,
        });
    }
    let t = clamp(plane(shear, corners), entry, exit);
    ((t > 0.0) & (t <= limit)).then(|| {
        let inverse = 1.0 / (u + v + w);
        Crossing {
            t,
            u: v * inverse,
            v: w * inverse,
        }
    })
}

/// A NaN (0/0: the plane contains the ray after all) becomes `entry`.
#[inline(always)]
fn clamp(t: f32, entry: f32, exit: f32) -> f32 {
    let t = if t > entry { t } else { entry };
    if t < exit { t } else { exit }
}

/// `t` where the line of the ray meets the triangle's plane.
#[inline(always)]
fn plane(shear: &Shear, corners: [Vec3; 3]) -> f32 {
    let [a, b, c] = corners;
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let normal = (b - a).cross(c - a);
    let height = normal.dot(a - shear.origin.as_dvec3());
    let rate = normal.dot(shear.direction.as_dvec3());
    (height / rate) as f32
}
