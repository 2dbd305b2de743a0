//! How narrow the wedges are that a mesh's triangles make with their neighbours.
//!
//! A point of a triangle is only known up to rounding, so a ray that starts there starts a little off the surface. Beside
//! an edge that may already be behind the neighbour, and the sooner, the narrower the wedge between the two. So each
//! triangle knows its narrowest: with `angle` between it and what it shares an edge or a corner with, a start `h` above the
//! surface needs a distance of `h / sin(angle)` from there (see [`super::surface_point`]).

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::triangles::Triangles;

/// Wedges narrower than one over two to this are taken for ones of this.
const NARROWEST: u8 = 12;

/// Around a corner of more triangles than this not every pair is compared: all of them count as [`NARROWEST`].
const MOST_AROUND: usize = 64;

/// One over the sine of each triangle's narrowest wedge, at least 1, rounded up to a power of two (but for a tenth of
/// one).
#[derive(Clone, Debug, Default)]
pub(super) struct Wedges {
    /// Exponents; empty where all are 0.
    exponents: Box<[u8]>,
    narrowest: u8,
}

impl Wedges {
    /// Of the triangles of a mesh. Corners at the same place are the same corner, whatever their index.
    pub(super) fn of(triangles: &Triangles) -> Self {
        let corners = Corners::of(triangles);
        let exponents: Box<[u8]> = (0..triangles.len() as u32)
            .into_par_iter()
            .map(|triangle| corners.narrowest(triangle))
            .collect();
        let narrowest = exponents.iter().copied().max().unwrap_or(0);
        Self {
            exponents: if narrowest > 0 {
                exponents
            } else {
                Box::default()
            },
            narrowest,
        }
    }

    /// One over the sine of the mesh's narrowest wedge.
    pub(super) fn narrowest(&self) -> f32 {
        (1_u32 << self.narrowest) as f32
    }

    /// One over the sine of this triangle's narrowest wedge.
    pub(super) fn of_triangle(&self, triangle: u32) -> f32 {
        let exponent = self.exponents.get(triangle as usize).copied();
        (1_u32 << exponent.unwrap_or(0)) as f32
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.exponents.len()
    }
}

/// Which triangles meet in which corner.
struct Corners<'a> {
    triangles: &'a Triangles,
    /// For each position the first one, in some order, that is at the same place.
    same: Vec<u32>,
    /// Of each position that is the first at its place: where its triangles begin in `around`. One more at the end.
    first: Vec<u32>,
    /// Traced triangles, corner by corner.
    around: Vec<u32>,
}

impl<'a> Corners<'a> {
    fn of(triangles: &'a Triangles) -> Self {
        let same = same_places(triangles.positions());
        let traced: Vec<u32> = (0..triangles.len() as u32)
            .into_par_iter()
            .filter(|&triangle| triangles.is_traced(triangle))
            .collect();
        let places = |triangle: u32| {
            triangles.indices()[triangle as usize].map(|index| same[index as usize] as usize)
        };
        let mut first = vec![0_u32; same.len() + 1];
        for &triangle in &traced {
            for place in places(triangle) {
                first[place + 1] += 1;
            }
        }
        for place in 0..same.len() {
            first[place + 1] += first[place];
        }
        let mut next = first.clone();
        let mut around = vec![0; 3 * traced.len()];
        for &triangle in &traced {
            for place in places(triangle) {
                around[next[place] as usize] = triangle;
                next[place] += 1;
            }
        }
        Self {
            triangles,
            same,
            first,
            around,
        }
    }

    fn places(&self, triangle: u32) -> [u32; 3] {
        self.triangles.indices()[triangle as usize].map(|index| self.same[index as usize])
    }

    fn around(&self, place: u32) -> &[u32] {
        let [from, to] = [0, 1].map(|i| self.first[place as usize + i] as usize);
        &self.around[from..to]
    }

    /// The exponent of a triangle's narrowest wedge.
    fn narrowest(&self, triangle: u32) -> u8 {
        let mut sine = 1.0_f64;
        let places = self.places(triangle);
        let Some(own) = Sector::all(self.triangles.corners(triangle)) else {
            return 0;
        };
        for (corner, sector) in own.iter().enumerate() {
            let around = self.around(places[corner]);
            if around.len() > MOST_AROUND {
                return NARROWEST;
            }
            for &other in around.iter().filter(|&&other| other != triangle) {
                let (theirs, points) = (self.places(other), self.triangles.corners(other));
                let Some(at) = theirs.iter().position(|&place| place == places[corner]) else {
                    continue;
                };
                let others = [(at + 1) % 3, (at + 2) % 3];
                let shared = others.map(|i| places.contains(&theirs[i]));
                let directions = others.map(|i| points[i] - points[at]);
                let angle = match shared {
                    // The same triangle once more is no wedge.
                    [true, true] => continue,
                    [true, false] => sector.across_edge(directions[0], directions[1]),
                    [false, true] => sector.across_edge(directions[1], directions[0]),
                    [false, false] => sector.above(directions),
                };
                sine = sine.min(angle);
            }
        }
        // A right angle that is off by its rounding is no narrow wedge.
        let narrow = ((1.0 / sine).log2() - 0.1).ceil();
        (narrow as u8).min(NARROWEST)
    }
}

/// A triangle as one of its corners sees it: what lies between two edges.
struct Sector {
    /// Unit normal.
    normal: Vec3,
    /// In the plane, from either edge inwards. Unit vectors.
    inwards: [Vec3; 2],
}

impl Sector {
    /// Of the three corners; `None` where f32 knows no normal.
    fn all(corners: [Vec3; 3]) -> Option<[Self; 3]> {
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let normal = (b - a).cross(c - a).try_normalize()?;
        let inwards = [(a, b), (b, c), (c, a)].map(|(from, to)| normal.cross(to - from));
        let [ab, bc, ca] = inwards.map(|n| n.normalize_or_zero().as_vec3());
        let normal = normal.as_vec3();
        Some([[ca, ab], [ab, bc], [bc, ca]].map(|inwards| Self { normal, inwards }))
    }

    /// Sine of the angle to a triangle beyond an edge along `edge`, whose third corner is along `third`; 1 where it is a
    /// right angle or more.
    fn across_edge(&self, edge: Vec3, third: Vec3) -> f64 {
        let edge = edge.as_dvec3().normalize_or_zero();
        let third = third.as_dvec3();
        let across = (third - third.dot(edge) * edge).normalize_or_zero();
        // The edge is one of the two: that which has nothing of it along its own normal.
        let [one, other] = self.inwards.map(|inwards| inwards.as_dvec3());
        let inwards = if one.dot(edge).abs() < other.dot(edge).abs() {
            one
        } else {
            other
        };
        if inwards.dot(across) <= 0.0 {
            1.0
        } else {
            inwards.cross(across).length()
        }
    }

    /// Sine of the least angle at which a triangle with edges along `directions`, that has no more than this corner in
    /// common, stands over this one; 1 where it does not.
    fn above(&self, directions: [Vec3; 2]) -> f64 {
        let inside = |direction: Vec3| {
            // What stands on an edge is that edge's neighbour's business.
            let slack = 1e-6 * direction.length();
            self.inwards.map(|inwards| inwards.dot(direction) - slack)
        };
        let [p, q] = directions.map(inside);
        // Most lie beyond one of the two edges.
        if (p[0] <= 0.0 && q[0] <= 0.0) || (p[1] <= 0.0 && q[1] <= 0.0) {
            return 1.0;
        }
        // The part of its outer edge that lies over the sector.
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (p, q) in p.into_iter().zip(q) {
            let (p, q) = (f64::from(p), f64::from(q));
            if p < 0.0 {
                from = from.max(p / (p - q));
            } else if q < 0.0 {
                to = to.min(p / (p - q));
            }
        }
        if from > to {
            return 1.0;
        }
        let [p, q] = directions.map(|direction| direction.as_dvec3());
        let height = |way: f64| {
            let direction: DVec3 = p.lerp(q, way);
            self.normal.as_dvec3().dot(direction.normalize_or_zero())
        };
        let (from, to) = (height(from), height(to));
        if from * to <= 0.0 {
            0.0
        } else {
            from.abs().min(to.abs())
        }
    }
}

/// For each position the first one, in some order, that is at the same place.
fn same_places(positions: &[Vec3]) -> Vec<u32> {
    // -0 and 0 are the same.
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut order: Vec<([u32; 3], u32)> = positions
        .iter()
        .enumerate()
        .map(|(index, &position)| (bits(position), index as u32))
        .collect();
    order.par_sort_unstable();
    let mut same = vec![0; positions.len()];
    for places in order.chunk_by(|a, b| a.0 == b.0) {
        for (_, index) in places {
            same[*index as usize] = places[0].1;
        }
    }
    same
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::hard_cases::meshes::{cube, mesh, soup, sphere};

    fn wedge(angle: f32) -> Triangles {
        // Two triangles over the x axis.
        let (sin, cos) = angle.sin_cos();
        let third = [Vec3::new(0.5, 1.0, 0.0), Vec3::new(0.4, cos, sin)];
        soup(third.map(|third| [Vec3::ZERO, Vec3::X, third]))
    }

    #[test]
    fn a_wedge_is_as_narrow_as_the_angle_between_its_triangles() {
        for angle in [2.5_f32, 1.6, 1.0, 0.3, 0.05, 1e-3] {
            let wedges = Wedges::of(&wedge(angle));
            let expected = if angle > std::f32::consts::FRAC_PI_2 {
                1.0
            } else {
                1.0 / angle.sin()
            };
            for narrow in [
                wedges.of_triangle(0),
                wedges.of_triangle(1),
                wedges.narrowest(),
            ] {
                assert!(
                    (expected * 0.93..2.0 * expected).contains(&narrow),
                    "{angle} rad: 1/sin is {expected}, told {narrow}"
                );
            }
        }
    }

    #[test]
    fn a_triangle_that_stands_over_another_in_a_corner_makes_a_wedge_too() {
        let over = |height: f32| {
            let far = [Vec3::new(1.0, -1.0, height), Vec3::new(1.0, 1.0, height)];
            let floor = [Vec3::new(2.0, -2.0, 0.0), Vec3::new(2.0, 2.0, 0.0)];
            Wedges::of(&soup([floor, far].map(|[a, b]| [Vec3::ZERO, a, b])))
        };
        assert_eq!(over(0.1).narrowest(), 16.0);
        assert_eq!(over(-0.1).narrowest(), 16.0, "and under it");
        // Beside it, there is none.
        let beside = [Vec3::new(-1.0, -1.0, 0.01), Vec3::new(-1.0, 1.0, 0.01)];
        let floor = [Vec3::new(2.0, -2.0, 0.0), Vec3::new(2.0, 2.0, 0.0)];
        let both = [floor, beside].map(|[a, b]| [Vec3::ZERO, a, b]);
        assert_eq!(Wedges::of(&soup(both)).narrowest(), 1.0);
    }

    #[test]
    fn boxes_and_spheres_have_none_and_pay_no_memory() {
        for mesh in [cube(), sphere(3)] {
            let wedges = Wedges::of(&mesh);
            assert_eq!((wedges.narrowest(), wedges.bytes()), (1.0, 0));
        }
    }

    #[test]
    fn corners_are_shared_by_place_whatever_their_index() {
        let shared = mesh(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.5, 1.0, 0.1)],
            vec![[0, 1, 2], [1, 0, 3]],
        );
        let apart: Vec<[Vec3; 3]> = (0..2).map(|i| shared.corners(i)).collect();
        let (shared, apart) = (Wedges::of(&shared), Wedges::of(&soup(apart)));
        assert!(shared.narrowest() > 8.0, "{shared:?}");
        assert_eq!(shared.exponents, apart.exponents);
    }

    #[test]
    fn a_corner_of_very_many_triangles_takes_no_longer_and_counts_as_narrow() {
        let hub = |i: u32| Vec3::new(1.0, i as f32 * 1e-3, 0.5);
        let fan = soup((0..50_000).map(|i| [Vec3::ZERO, hub(i), hub(i + 1)]));
        assert_eq!(Wedges::of(&fan).narrowest(), 4096.0);
        // So does the same triangle, many times over.
        let heap = soup((0..50_000).map(|_| [Vec3::ZERO, Vec3::X, Vec3::Y]));
        assert_eq!(Wedges::of(&heap).narrowest(), 4096.0);
    }

    #[test]
    fn triangles_that_are_points_or_lines_or_not_finite_are_nobodys_neighbours() {
        let nan = Vec3::splat(f32::NAN);
        let wedges = Wedges::of(&soup([
            [Vec3::ZERO, Vec3::X, Vec3::Y],
            [Vec3::ZERO, Vec3::X, Vec3::X * 2.0],
            [Vec3::ZERO, Vec3::X, nan],
        ]));
        assert_eq!(wedges.narrowest(), 1.0);
    }
}
