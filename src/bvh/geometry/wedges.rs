//! How narrow the wedges are that a mesh's triangles make with their neighbours.
//!
//! A point of a triangle is only known up to rounding, so a ray that starts there starts a little off the surface. Beside
//! an edge that may already be behind the neighbour, and the sooner, the narrower the wedge between the two. So each
//! triangle knows its narrowest: with `angle` between it and what it shares an edge or a corner with, a start `h` above the
//! surface needs a distance of `h / sin(angle)` from there (see [`super::surface_point`]).

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::mesh_tree::MeshTree;
use crate::bvh::triangles::Triangles;

/// Wedges narrower than one over two to this are taken for ones of this.
const NARROWEST: u8 = 12;

/// Around a corner of more triangles than this not every pair is compared: all of them count as [`NARROWEST`]. Tips of cones,
/// poles of spheres and caps of cylinders have fewer.
const MOST_AROUND: usize = 1024;
/// Where pairs around corners of many triangles are more than [`MOST_PAIRS`], only corners of no more than this are looked at.
const FEW_AROUND: usize = 64;
const MOST_PAIRS: usize = 1 << 22;

/// One over the sine of each triangle's narrowest wedge, at least 1, rounded up to a power of two (but for a tenth of
/// one).
#[derive(Clone, Debug, Default)]
pub(in crate::bvh) struct Wedges {
    /// Exponents; empty where all are 0.
    exponents: Box<[u8]>,
}

impl Wedges {
    /// Of those triangles of a mesh that are traced. Corners at the same place are the same corner, whatever their index.
    pub(in crate::bvh) fn of(triangles: &Triangles, traced: &[u32]) -> Self {
        let corners = Corners::of(triangles, traced);
        let found: Vec<u8> = traced
            .par_iter()
            .with_min_len(1024)
            .map(|&triangle| corners.narrowest(triangle))
            .collect();
        let mut exponents = Box::default();
        if found.iter().any(|exponent| *exponent > 0) {
            let mut all = vec![0; triangles.len()];
            for (&triangle, exponent) in traced.iter().zip(found) {
                all[triangle as usize] = exponent;
            }
            exponents = all.into_boxed_slice();
        }
        Self { exponents }
    }

    /// One over the sine of this triangle's narrowest wedge.
    #[inline(always)]
    fn of_triangle(&self, triangle: u32) -> f32 {
        let exponent = self.exponents.get(triangle as usize).copied();
        (1_u32 << exponent.unwrap_or(0)) as f32
    }

    /// Memory held, in bytes.
    pub(in crate::bvh) fn bytes(&self) -> usize {
        self.exponents.len()
    }
}

impl MeshTree {
    /// One over the sine of the narrowest wedge that a triangle makes with its neighbours, at least 1.
    #[inline(always)]
    pub(crate) fn wedge_of(&self, triangle: u32) -> f32 {
        self.wedges().of_triangle(triangle)
    }
}

/// Which triangles meet in which corner.
struct Corners<'a> {
    triangles: &'a Triangles,
    /// The corners of each triangle, by place: positions at the same place have one number.
    places: Vec<[u32; 3]>,
    /// Of each place: where its triangles begin in `around`. One more at the end.
    first: Vec<u32>,
    /// Traced triangles and which of their corners it is, place by place.
    around: Vec<(u32, u8)>,
    /// Triangles around a corner that are compared with each other.
    most_around: usize,
}

impl<'a> Corners<'a> {
    fn of(triangles: &'a Triangles, traced: &[u32]) -> Self {
        let same = same_places(triangles.positions());
        let places: Vec<[u32; 3]> = (triangles.indices().iter())
            .map(|corners| corners.map(|index| same[index as usize]))
            .collect();
        let mut first = vec![0_u32; same.len() + 1];
        for &triangle in traced {
            for place in places[triangle as usize] {
                first[place as usize + 1] += 1;
            }
        }
        for place in 0..same.len() {
            first[place + 1] += first[place];
        }
        let most_around = most_around(first.windows(2).map(|place| (place[1] - place[0]) as usize));
        let mut next = first.clone();
        let mut around = vec![(0, 0); 3 * traced.len()];
        for &triangle in traced {
            for (corner, place) in (0..).zip(places[triangle as usize]) {
                let next = &mut next[place as usize];
                around[*next as usize] = (triangle, corner);
                *next += 1;
            }
        }
        Self {
            triangles,
            places,
            first,
            around,
            most_around,
        }
    }

    fn around(&self, place: u32) -> &[(u32, u8)] {
        let [from, to] = [0, 1].map(|i| self.first[place as usize + i] as usize);
        &self.around[from..to]
    }

    /// The exponent of a triangle's narrowest wedge.
    fn narrowest(&self, triangle: u32) -> u8 {
        let places = self.places[triangle as usize];
        let points = self.triangles.corners(triangle);
        let [a, b, c] = points.map(|point| point.as_dvec3());
        let Some(normal) = (b - a).cross(c - a).try_normalize() else {
            return 0;
        };
        let normal = normal.as_vec3();
        let mut sine = 1.0_f64;
        for corner in 0..3 {
            let [here, left, right] = [0, 1, 2].map(|i| places[(corner + i) % 3]);
            let around = self.around(here);
            if around.len() > self.most_around {
                return NARROWEST;
            }
            let from = points[corner];
            let [to_left, to_right] = [1, 2].map(|i| points[(corner + i) % 3] - from);
            let sector = Sector {
                normal,
                inwards: [normal.cross(to_left), to_right.cross(normal)],
            };
            for &(other, at) in around {
                if other == triangle {
                    continue;
                }
                let theirs = self.places[other as usize];
                let others = [1, 2].map(|i| (usize::from(at) + i) % 3);
                let [one, two] = others.map(|i| theirs[i]);
                let direction = |i: usize| self.triangles.corner(other, others[i]) - from;
                let is_shared = |place| place == left || place == right;
                let (shared, third) = match (is_shared(one), is_shared(two)) {
                    (false, false) => {
                        sine = sine.min(sector.above([direction(0), direction(1)]));
                        continue;
                    }
                    (true, false) => (one, 1),
                    (false, true) => (two, 0),
                    // The same triangle once more is no wedge.
                    (true, true) => continue,
                };
                // Each edge at one of its ends.
                if shared < here {
                    continue;
                }
                let edge = usize::from(shared == right);
                if sector.inwards[edge].dot(direction(third)) > 0.0 {
                    let along = [to_left, to_right][edge];
                    sine = sine.min(sector.across_edge(edge, along, direction(third)));
                }
            }
        }
        // A right angle that is off by its rounding is no narrow wedge.
        let narrow = ((1.0 / sine).log2() - 0.1).ceil();
        (narrow as u8).min(NARROWEST)
    }
}

/// How many triangles are compared with each other where so many meet around each corner: as many as [`MOST_PAIRS`] allow,
/// halved until they do.
fn most_around(counts: impl Iterator<Item = usize>) -> usize {
    let mut most = MOST_AROUND;
    let halvings = (MOST_AROUND / FEW_AROUND).ilog2() as usize;
    let mut pairs = [0; (MOST_AROUND / FEW_AROUND).ilog2() as usize];
    for count in counts.filter(|count| (FEW_AROUND + 1..=MOST_AROUND).contains(count)) {
        let halving = (MOST_AROUND / count).ilog2() as usize;
        pairs[halving.min(halvings - 1)] += count * count;
    }
    let mut left: usize = pairs.iter().sum();
    for pairs in pairs {
        if left <= MOST_PAIRS {
            break;
        }
        left -= pairs;
        most /= 2;
    }
    most
}

/// A triangle as one of its corners sees it: what lies between two edges.
struct Sector {
    /// Unit normal.
    normal: Vec3,
    /// In the plane, from either edge inwards, as long as the edge.
    inwards: [Vec3; 2],
}

impl Sector {
    /// Sine of the angle to a triangle beyond the edge `along`, whose third corner, along `third`, stands over this one.
    #[cold]
    fn across_edge(&self, edge: usize, along: Vec3, third: Vec3) -> f64 {
        let along = along.as_dvec3().normalize_or_zero();
        let third = third.as_dvec3();
        let across = (third - third.dot(along) * along).normalize_or_zero();
        let inwards = self.inwards[edge].as_dvec3().normalize_or_zero();
        inwards.cross(across).length()
    }

    /// Sine of the least angle at which a triangle with edges along `directions`, that has no more than this corner in
    /// common, stands over this one; 1 where it does not.
    fn above(&self, directions: [Vec3; 2]) -> f64 {
        let [p, q] = directions.map(|direction| self.inwards.map(|n| n.dot(direction)));
        // Most lie beyond one of the two edges.
        if (p[0] <= 0.0 && q[0] <= 0.0) || (p[1] <= 0.0 && q[1] <= 0.0) {
            return 1.0;
        }
        self.least_height(directions)
    }

    #[cold]
    fn least_height(&self, directions: [Vec3; 2]) -> f64 {
        let inside = |direction: Vec3| {
            // What stands on an edge is that edge's neighbour's business.
            let slack = |inwards: &Vec3| 1e-6 * direction.length() * inwards.length();
            self.inwards
                .map(|inwards| inwards.dot(direction) - slack(&inwards))
        };
        let [p, q] = directions.map(inside);
        // The part of its outer edge that lies over the sector.
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (p, q) in p.into_iter().zip(q) {
            let (p, q) = (f64::from(p), f64::from(q));
            if p <= 0.0 && q <= 0.0 {
                return 1.0;
            }
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

    fn of(triangles: &Triangles) -> Wedges {
        let traced = (0..triangles.len() as u32).filter(|&t| triangles.is_traced(t));
        Wedges::of(triangles, &traced.collect::<Vec<_>>())
    }

    /// Of all its triangles.
    fn narrowest(wedges: &Wedges) -> f32 {
        let count = wedges.exponents.len() as u32;
        (0..count).fold(1.0, |most, triangle| most.max(wedges.of_triangle(triangle)))
    }

    /// A drum of so many segments: its caps are fans around their middles.
    fn drum(segments: u32) -> Triangles {
        let rim = |i: u32, y| {
            let turn = (i % segments) as f32 * std::f32::consts::TAU / segments as f32;
            Vec3::new(turn.cos(), y, turn.sin())
        };
        soup((0..segments).flat_map(|i| {
            let [[a, b], [c, d]] = [0.0, 1.0].map(|y| [rim(i, y), rim(i + 1, y)]);
            [[Vec3::ZERO, a, b], [Vec3::Y, d, c], [a, c, b], [b, c, d]]
        }))
    }

    fn wedge(angle: f32) -> Triangles {
        // Two triangles over the x axis.
        let (sin, cos) = angle.sin_cos();
        let third = [Vec3::new(0.5, 1.0, 0.0), Vec3::new(0.4, cos, sin)];
        soup(third.map(|third| [Vec3::ZERO, Vec3::X, third]))
    }

    #[test]
    fn a_wedge_is_as_narrow_as_the_angle_between_its_triangles() {
        for angle in [2.5_f32, 1.6, 1.0, 0.3, 0.05, 1e-3] {
            let wedges = of(&wedge(angle));
            let expected = if angle > std::f32::consts::FRAC_PI_2 {
                1.0
            } else {
                1.0 / angle.sin()
            };
            for narrow in [
                wedges.of_triangle(0),
                wedges.of_triangle(1),
                narrowest(&wedges),
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
            narrowest(&of(&soup([floor, far].map(|[a, b]| [Vec3::ZERO, a, b]))))
        };
        assert_eq!(over(0.1), 16.0);
        assert_eq!(over(-0.1), 16.0, "and under it");
        // Beside it, there is none.
        let beside = [Vec3::new(-1.0, -1.0, 0.01), Vec3::new(-1.0, 1.0, 0.01)];
        let floor = [Vec3::new(2.0, -2.0, 0.0), Vec3::new(2.0, 2.0, 0.0)];
        let both = [floor, beside].map(|[a, b]| [Vec3::ZERO, a, b]);
        assert_eq!(narrowest(&of(&soup(both))), 1.0);
    }

    #[test]
    fn boxes_and_spheres_have_none_and_pay_no_memory() {
        for mesh in [cube(), sphere(3)] {
            let wedges = of(&mesh);
            assert_eq!((narrowest(&wedges), wedges.bytes()), (1.0, 0));
        }
    }

    #[test]
    fn corners_are_shared_by_place_whatever_their_index() {
        let shared = mesh(
            vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.5, 1.0, 0.1)],
            vec![[0, 1, 2], [1, 0, 3]],
        );
        let apart: Vec<[Vec3; 3]> = (0..2).map(|i| shared.corners(i)).collect();
        let (shared, apart) = (of(&shared), of(&soup(apart)));
        assert!(narrowest(&shared) > 8.0, "{shared:?}");
        assert_eq!(shared.exponents, apart.exponents);
    }

    #[test]
    fn a_corner_of_very_many_triangles_takes_no_longer_and_counts_as_narrow() {
        let hub = |i: u32| Vec3::new(1.0, i as f32 * 1e-3, 0.5);
        let fan = soup((0..50_000).map(|i| [Vec3::ZERO, hub(i), hub(i + 1)]));
        assert_eq!(narrowest(&of(&fan)), 4096.0);
        // So does the same triangle, many times over.
        let heap = soup((0..50_000).map(|_| [Vec3::ZERO, Vec3::X, Vec3::Y]));
        assert_eq!(narrowest(&of(&heap)), 4096.0);
    }

    #[test]
    fn a_fan_of_many_triangles_is_no_wedge_and_its_mesh_has_none() {
        for segments in [24, 64, 96, 512, 1000] {
            let wedges = of(&drum(segments));
            assert_eq!(narrowest(&wedges), 1.0, "{segments} segments");
        }
    }

    #[test]
    fn a_wedge_in_a_fan_of_many_triangles_is_found() {
        let mut corners: Vec<[Vec3; 3]> = {
            let drum = drum(200);
            (0..drum.len() as u32).map(|i| drum.corners(i)).collect()
        };
        // Over the lower cap, at a tenth.
        corners.push([
            Vec3::ZERO,
            Vec3::new(0.5, 0.05, 0.2),
            Vec3::new(0.5, 0.05, -0.2),
        ]);
        let wedges = of(&soup(corners));
        assert_eq!(wedges.of_triangle(800), 16.0);
        let narrow = (0..800).filter(|i| wedges.of_triangle(*i) > 1.0).count();
        assert!((10..40).contains(&narrow), "{narrow} of 800");
    }

    #[test]
    fn of_very_many_fans_those_of_fewer_triangles_are_looked_at() {
        let fans = |size: usize, count: usize| vec![size; count];
        let most = |counts: Vec<usize>| most_around(counts.into_iter());
        assert_eq!(most(fans(1024, 4)), 1024);
        assert_eq!(most(fans(1024, 5)), 512);
        assert_eq!(most([fans(1024, 5), fans(100, 400)].concat()), 512);
        assert_eq!(most(fans(100, 420)), 64);
        assert_eq!(most([fans(64, 1 << 20), fans(5000, 100)].concat()), 1024);
    }

    #[test]
    fn triangles_that_are_points_or_lines_or_not_finite_are_nobodys_neighbours() {
        let nan = Vec3::splat(f32::NAN);
        let wedges = of(&soup([
            [Vec3::ZERO, Vec3::X, Vec3::Y],
            [Vec3::ZERO, Vec3::X, Vec3::X * 2.0],
            [Vec3::ZERO, Vec3::X, nan],
        ]));
        assert_eq!(narrowest(&wedges), 1.0);
    }
}
