//! A block of triangles against the rays of a packet.

use glam::DVec3;

use super::super::super::goal::Goal;
use super::super::super::ray::TriangleId;
use super::super::super::slab::PAD;
use super::super::{Eight, InstructionSet, Lanes, TriangleBlock, by_axis};
use super::{Found, PacketRays, View, found::lanes_of, largest_size, view::Frame};

/// What is known of a triangle and the rays that reached it.
struct Test<'a, S: InstructionSet> {
    triangle: usize,
    /// The lower and the upper corners of the block's boxes.
    bounds: &'a [[[f32; 8]; 3]; 2],
    /// Which rays' lines cross it.
    passed: u32,
    edges: [S::Packet; 3],
    instance: u32,
}

impl TriangleBlock {
    /// Tests the triangles, one after the other, against those rays. The operations are those of [`Self::cross`], one by
    /// one.
    #[inline(always)]
    pub(crate) fn cross_packet<S: InstructionSet, G: Goal>(
        &self,
        rays: &PacketRays<S::Packet>,
        view: &mut View<S>,
        lanes: u32,
        instance: u32,
        found: &mut Found<S::Packet>,
    ) {
        let bounds = &self.boxes::<S::Eight>();
        let entered = view.may_enter(bounds, found.farthest);
        if entered == 0 {
            return;
        }
        let frame = view.frame(rays);
        let mut is_nearer = false;
        for lane in lanes_of(entered) {
            let (passed, edges) = self.edges_of::<S>(lane, &frame);
            let passed = passed & if G::ANY { lanes & found.active } else { lanes };
            if passed != 0 {
                let test = Test {
                    triangle: lane,
                    bounds,
                    passed,
                    edges,
                    instance,
                };
                is_nearer |= self.accept_packet::<S, G>(&test, rays, view, found);
                if G::ANY && found.active == 0 {
                    return;
                }
            }
        }
        if is_nearer {
            found.look_ahead();
        }
    }

    /// The lower and the upper corners of the triangles' padded boxes: [`triangle_box`](super::super::super::slab::triangle_box),
    /// eight at once.
    #[inline(always)]
    fn boxes<E: Eight>(&self) -> [[[f32; 8]; 3]; 2] {
        let [min, max] = [
            by_axis!(|axis| {
                let [a, b, c] = self.axis(axis);
                E::load(a).min(E::load(b)).min(E::load(c))
            }),
            by_axis!(|axis| {
                let [a, b, c] = self.axis(axis);
                E::load(a).max(E::load(b)).max(E::load(c))
            }),
        ];
        let pad = largest_size(&min)
            .max(largest_size(&max))
            .mul(E::splat(PAD));
        [
            by_axis!(|axis| min[axis].sub(pad).to_array()),
            by_axis!(|axis| max[axis].add(pad).to_array()),
        ]
    }

    /// Which rays' lines cross the triangle, and the edge functions of corners 1 and 2 and the sum of all.
    #[inline(always)]
    fn edges_of<S: InstructionSet>(
        &self,
        triangle: usize,
        frame: &Frame<S::Packet>,
    ) -> (u32, [S::Packet; 3]) {
        let [x, y, z] = frame.axes;
        let [x, y, z] = [
            self.axis(x as usize),
            self.axis(y as usize),
            self.axis(z as usize),
        ];
        let triangle = triangle % 8;
        let [a, b, c] = by_axis!(|i| frame.corner(x[i][triangle], y[i][triangle], z[i][triangle]));
        let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
        let det = u.add(v).add(w);
        let zero = S::Packet::splat(0.0);
        let outside = S::Packet::and(u.min(v).min(w).lt(zero), zero.lt(u.max(v).max(w)));
        let size = det.abs();
        let area = S::Packet::and(zero.lt(size), size.lt(S::Packet::splat(f32::INFINITY)));
        let passed = S::Packet::bits(S::Packet::and_not(outside, area));
        (passed, [v, w, det])
    }

    /// The rest of the test, for rays whose lines cross the triangle; whether any has found a nearer hit.
    #[inline(always)]
    fn accept_packet<S: InstructionSet, G: Goal>(
        &self,
        test: &Test<S>,
        rays: &PacketRays<S::Packet>,
        view: &View<S>,
        found: &mut Found<S::Packet>,
    ) -> bool {
        let Test {
            triangle,
            bounds: [min, max],
            passed,
            edges,
            instance,
        } = *test;
        let triangle = triangle % 8;
        // From the rays' own origins: a view that is padded for turned instances too has wider ones.
        let [x, y, z] = by_axis!(|axis| {
            let backwards = view.backwards[axis];
            let face = if backwards { max } else { min };
            rays.near(axis, backwards, face[axis][triangle])
        });
        let entry = x.max(y).max(z);
        let [x, y, z] = by_axis!(|axis| {
            let backwards = view.backwards[axis];
            let face = if backwards { min } else { max };
            rays.far(axis, backwards, face[axis][triangle])
        });
        let exit = x.min(y).min(z);
        let (zero, limit) = (S::Packet::splat(0.0), found.limit);
        let ahead = S::Packet::and(zero.lt(exit), entry.le(exit.min(limit)));
        let number = self.number(triangle);
        let this = TriangleId {
            instance,
            triangle: number,
        };
        let mut within = passed & S::Packet::bits(ahead);
        if within == 0 {
            return false;
        }
        within &= !found.starting_on(this);
        if G::ANY {
            let sure = S::Packet::and(zero.lt(entry), exit.lt(limit));
            let sure = within & S::Packet::bits(sure);
            found.end(sure);
            within &= !sure;
        }
        if within == 0 {
            return false;
        }
        let [a, b, c] = self.corners(triangle);
        let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
        let t = plane(rays, a, (b - a).cross(c - a));
        let t = t.max(entry).min(exit);
        let ahead = within & S::Packet::bits(zero.lt(t));
        let nearer = ahead & S::Packet::bits(t.lt(limit));
        if G::ANY {
            found.end(nearer);
            return false;
        }
        let tied = ahead & found.hit & !nearer & S::Packet::bits(t.le(limit));
        let won = if tied == 0 {
            nearer
        } else {
            nearer | wins_ties::<S::Packet>(found, tied, (instance, number))
        };
        if won == 0 {
            return false;
        }
        let mask = S::Packet::mask(won);
        found.hit |= won;
        found.limit = S::Packet::select(mask, t, found.limit);
        found.edges = by_axis!(|i| S::Packet::select(mask, edges[i], found.edges[i]));
        let number = S::Packet::splat(f32::from_bits(number));
        let instance = S::Packet::splat(f32::from_bits(instance));
        found.triangle = S::Packet::select(mask, number, found.triangle);
        found.instance = S::Packet::select(mask, instance, found.instance);
        nearer != 0
    }
}

/// `t` where the rays' lines meet a triangle's plane: [`super::super::super::triangle`]'s, in lanes.
#[inline(always)]
fn plane<L: Lanes>(rays: &PacketRays<L>, corner: DVec3, normal: DVec3) -> L {
    let (corner, normal) = (corner.to_array(), normal.to_array());
    let normal = by_axis!(|axis| L::splat_f64(normal[axis]));
    let [x, y, z] = by_axis!(|axis| {
        let corner = L::splat_f64(corner[axis]);
        let away = L::sub_f64(corner, rays.origin[axis].widen());
        L::mul_f64(normal[axis], away)
    });
    let height = L::add_f64(L::add_f64(x, y), z);
    let [x, y, z] = by_axis!(|axis| L::mul_f64(normal[axis], rays.direction[axis].widen()));
    let rate = L::add_f64(L::add_f64(x, y), z);
    L::narrow(L::div_f64(height, rate))
}

/// The edge function of the edge between two corners. Not fused: see [`super::super::super::triangle`].
#[inline(always)]
fn edge<L: Lanes>(p: [L; 2], q: [L; 2]) -> L {
    p[0].mul(q[1]).sub(p[1].mul(q[0]))
}

/// Those of the rays that hit this triangle as far away as another, and this is the one to take.
#[inline(always)]
fn wins_ties<L: Lanes>(found: &Found<L>, tied: u32, this: (u32, u32)) -> u32 {
    let (instance, triangle) = (found.instance.to_array(), found.triangle.to_array());
    lanes_of(tied)
        .filter(|&lane| {
            let other = (
                instance.as_ref()[lane].to_bits(),
                triangle.as_ref()[lane].to_bits(),
            );
            this < other
        })
        .fold(0, |bits, lane| bits | 1 << lane)
}
