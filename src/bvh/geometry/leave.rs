//! Where a ray starts that leaves a hit close to an edge.
//!
//! Rounding alone would put such a start behind the neighbour beyond the edge ([`super::surface_point`]): out of a closed
//! room. So the point is first moved into its triangle, as little as helps, and lifted off it, as little as the kernel
//! needs; both in f64, where only the last step, to a start in f32, rounds. Then the kernel itself is asked whether that
//! start is on the right side: the ray from there back to the point must meet the point's own triangle first. What is
//! between them, a neighbour in a narrow wedge, sends the point farther in. Since all rays from one start see the corners
//! at the same places, up to what the lift is more than, what holds for this ray holds for the next.
//!
//! # Narrow places
//! A lift ends at the coordinate that rounding finds, up to two steps above the point, and that is beyond the other side
//! of a body which is no thicker. There the coordinates around the point are tried one by one (`Aggregate::leave_narrowly`),
//! and the nearest from which the kernel sees the triangle is taken. Of starts in convex bodies of 2 to 40 steps, turned,
//! mirrored, scaled as unevenly as 1 : 20 : thickness and moving, none of 300,000 then lies outside; without it 27 did,
//! where less than five steps were between the sides (a test has them).
//!
//! What is left: a hit that is far from every edge is lifted by its whole error (`super::surface_point`), three steps and
//! a half at most, and nothing is asked. Two parallel sides that lie closer than six steps of the coordinates, a pane of
//! 9 cm that stands 148 km away, may let such a ray out, one in a thousand at most (a test and the report count them).

use glam::{DVec3, Vec3};

use super::aggregate::Aggregate;
use super::instance::Instance;
use super::surface_point::{NearEdge, SurfacePoint};
use crate::bvh::{Hit, Ray};

/// Half an ulp of 1.
const U: f64 = f32::EPSILON as f64 / 2.0;

/// The lift off the surface is doubled so often before the point is moved farther in.
const LIFTS: u32 = 4;

/// How far in a narrow place is looked through, in blurs: no farther, since where two surfaces lie in each other, all over
/// the triangle, nothing would be found.
const NARROW_INSETS: [f64; 4] = [0.0, 2.0, 4.0, 8.0];

impl Aggregate {
    /// Where a ray starts that leaves a surface by the side to which `towards` points: it meets neither this triangle
    /// again nor what lies behind those that share an edge or a corner with it.
    ///
    /// Where the surfaces beside an edge are closer together, all over the triangle, than coordinates of that size can tell
    /// apart, there is no such place, and it is one beyond the error of the hit.
    pub fn leave(&self, point: &SurfacePoint, towards: Vec3) -> Vec3 {
        match &point.near_edge {
            None => point.leave(towards),
            Some(near) => {
                (self.leave_near_edge(point, near, towards)).unwrap_or_else(|| point.leave(towards))
            }
        }
    }

    /// A ray in a direction, without an end, that leaves a surface at time 0.
    pub fn leaving(&self, point: &SurfacePoint, direction: Vec3) -> Ray {
        Ray {
            starts_on: point.triangle,
            ..Ray::new(self.leave(point, direction), direction)
        }
    }

    #[cold]
    fn leave_near_edge(
        &self,
        point: &SurfacePoint,
        near: &NearEdge,
        towards: Vec3,
    ) -> Option<Vec3> {
        let NearEdge { hit, time } = *near;
        let instance = &self.instances()[hit.instance as usize];
        let place = Place::of(instance, &hit, time, point.normal)?;
        let normal = if towards.dot(point.normal) < 0.0 {
            -place.normal
        } else {
            place.normal
        };
        let mut inset = 2.0 * place.blur;
        loop {
            let (at, last) = place.inset(inset);
            let mut lift = place.lift;
            for _ in 0..LIFTS {
                let start = lifted(at, normal, place.lift, &mut lift)?;
                if self.sees(start, at, normal, &place, &hit, time) {
                    return Some(start);
                }
                lift *= 2.0;
            }
            if last {
                return self.leave_narrowly(normal, &place, &hit, time);
            }
            inset *= 2.0;
        }
    }

    /// The coordinate nearest to the point, or to one farther in, from which the triangle is seen, where lifting straight
    /// up ended behind a surface everywhere.
    fn leave_narrowly(&self, normal: DVec3, place: &Place, hit: &Hit, time: f32) -> Option<Vec3> {
        let mut nearest: Option<(f64, Vec3)> = None;
        for inset in NARROW_INSETS {
            let (at, _) = place.inset(inset * place.blur);
            let mut found: Option<(f64, Vec3)> = None;
            for start in coordinates_around(at.as_vec3()) {
                let way = start.as_dvec3() - at;
                let squared = way.length_squared();
                let is_nearer =
                    |than: &Option<(f64, Vec3)>| than.is_none_or(|(least, _)| squared < least);
                if normal.dot(way) < place.lift || !(is_nearer(&found) || is_nearer(&nearest)) {
                    continue;
                }
                if is_nearer(&found) && self.sees(start, at, normal, place, hit, time) {
                    found = Some((squared, start));
                } else if is_nearer(&nearest) && self.meets_first(start, at, hit, time) {
                    nearest = Some((squared, start));
                }
            }
            if let Some((_, start)) = found {
                return Some(start);
            }
        }
        nearest.map(|(_, start)| start)
    }

    /// Whether a ray from one point to another meets the triangle of the hit first.
    fn meets_first(&self, from: Vec3, to: DVec3, hit: &Hit, time: f32) -> bool {
        let ray = Ray {
            time,
            ..Ray::new(from, (to - from.as_dvec3()).as_vec3())
        };
        let found = self.closest_hit(&ray);
        found.is_some_and(|f| (f.instance, f.triangle) == (hit.instance, hit.triangle))
    }

    /// Whether rays to the surface find the triangle of the hit first: from `start`, and from so far above it that a surface
    /// in which `start` lies is met too.
    fn sees(
        &self,
        start: Vec3,
        at: DVec3,
        normal: DVec3,
        place: &Place,
        hit: &Hit,
        time: f32,
    ) -> bool {
        let mut clearance = 2.0 * place.lift;
        let start_exactly = start.as_dvec3();
        let above = lifted(start_exactly, normal, place.lift, &mut clearance);
        self.meets_first(start, at, hit, time)
            && above.is_some_and(|above| self.meets_first(above, start_exactly, hit, time))
    }
}

/// A point and the 26 that are a step of some coordinates away from it.
fn coordinates_around(middle: Vec3) -> impl Iterator<Item = Vec3> {
    let steps = |p: f32| [p, p.next_up(), p.next_down()];
    let [x, y, z] = middle.to_array().map(steps);
    x.into_iter().flat_map(move |x| {
        y.into_iter()
            .flat_map(move |y| z.into_iter().map(move |z| Vec3::new(x, y, z)))
    })
}

/// `at`, at least `least` above the surface after rounding; `lift` grows where rounding takes it back.
fn lifted(at: DVec3, normal: DVec3, least: f64, lift: &mut f64) -> Option<Vec3> {
    for _ in 0..64 {
        let start = (at + normal * *lift).as_vec3();
        if normal.dot(start.as_dvec3() - at) >= least {
            return Some(start);
        }
        *lift *= 2.0;
    }
    None
}

/// The triangle around a hit, in the world, when it was hit.
struct Place {
    corners: [DVec3; 3],
    /// None below zero; their sum is 1.
    weights: [f64; 3],
    /// Over the edge opposite to each corner.
    heights: [f64; 3],
    normal: DVec3,
    /// What a start has to be above the surface, so that the kernel sees it there.
    lift: f64,
    /// How far a start may be from where it is meant to be, along the surface.
    blur: f64,
}

impl Place {
    /// `None` where it is no triangle in the world.
    fn of(instance: &Instance, hit: &Hit, time: f32, upwards: Vec3) -> Option<Self> {
        let corners = instance.mesh.triangles().corners(hit.triangle);
        let stands = instance.stands_at(time).as_dvec3();
        let corners = corners.map(|corner| instance.exact_linear() * corner.as_dvec3() + stands);
        let [a, b, c] = corners;
        let product = (b - a).cross(c - a);
        let area = product.length();
        let normal = product.try_normalize()?;
        let normal = if normal.dot(upwards.as_dvec3()) < 0.0 {
            -normal
        } else {
            normal
        };
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v].map(|w| f64::from(w).max(0.0));
        let sum: f64 = weights.iter().sum();
        let weights = weights.map(|w| w / sum);
        let point: DVec3 = (0..3).map(|i| weights[i] * corners[i]).sum();
        let reach = corners.map(|corner| (corner - point).abs().max_element());
        let reach = reach.into_iter().fold(0.0, f64::max);
        // The way into object space is what rounds, where there is one (`bvh/geometry/instance.rs`).
        let way = if instance.is_identity() {
            0.0
        } else {
            6.0 * f64::from(instance.condition()) * (point - stands).abs().max_element()
        };
        let seen = U * (8.0 * reach + way);
        // Twice, since a start lies a little elsewhere than the point; and in each of three coordinates.
        let lift = 2.0 * 3.0_f64.sqrt() * seen;
        let steps = point.as_vec3().to_array();
        let steps = DVec3::from_array(steps.map(|p| f64::from(p.abs().next_up() - p.abs())));
        Some(Self {
            corners,
            weights,
            heights: [c - b, a - c, b - a].map(|edge| area / edge.length()),
            normal,
            lift,
            blur: 0.5 * steps.length() + lift,
        })
    }

    /// The point, moved towards the middle until it is this far from every edge; and whether it is there.
    fn inset(&self, distance: f64) -> (DVec3, bool) {
        let ways = (0..3).map(|i| {
            let wanted = distance / self.heights[i] - self.weights[i];
            if wanted <= 0.0 {
                0.0
            } else {
                wanted / (1.0 / 3.0 - self.weights[i]).max(0.0)
            }
        });
        let way = ways.fold(0.0, f64::max);
        let last = way >= 1.0 || way.is_nan();
        let way = way.min(1.0);
        let weights = self.weights.map(|w| w + way * (1.0 / 3.0 - w));
        ((0..3).map(|i| weights[i] * self.corners[i]).sum(), last)
    }
}
