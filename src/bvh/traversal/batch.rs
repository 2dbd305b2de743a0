//! Rays of a batch that are walked one by one, and were made ready eight at a time.
//!
//! What the tests need of a ray, its reciprocals, its frame and its slack, takes as long as a node or two when it is made for
//! one ray, and a fifth of that when it is made for eight. The numbers are those of [`SafeRay`] and [`Shear`], bit for bit.
//!
//! [`Shear`]: crate::bvh::kernel::triangle::Shear

use glam::{Vec3, Vec3A};

use super::tree_ray::{TreeRay, WorldRay};
use crate::bvh::geometry::aggregate::Aggregate;
use crate::bvh::kernel::columns::Columns;
use crate::bvh::kernel::object_ray::ObjectRay;
use crate::bvh::kernel::ray::{Ray, TriangleId};
use crate::bvh::kernel::safe_ray::{Measure, SafeRay};
use crate::bvh::kernel::slab::{PAD, SlabRay};
use crate::bvh::kernel::triangle::{Axis, Depths, FRAMES};
use crate::bvh::kernel::wide::{
    Eight, PacketRays, Sides, Sight, WideRay, by_axis, farthest_along, lanes_of, largest_size,
};

/// A number for each ray.
type Column = [f32; 8];

/// At most eight rays, their numbers column by column. The columns come first, each in one cache line.
#[repr(C, align(64))]
pub(super) struct Batch<'a> {
    /// What faces are measured from that a ray meets first and last, by axis.
    near_origin: [Column; 3],
    far_origin: [Column; 3],
    /// Minus one over the direction.
    backward: [Column; 3],
    /// See [`Shear`](crate::bvh::kernel::triangle::Shear).
    from: [Column; 3],
    slope: [Column; 2],
    /// See [`Depths`].
    rate: Column,
    slack: Column,
    origin: [Column; 3],
    direction: [Column; 3],
    /// The slack around the origin that triangles' own boxes need.
    pad: Column,
    /// Bits of numbers, above [`WAYS`]: where the ray goes backwards, an axis each, and then the number of its frame.
    way: Column,
    /// Where it ends, and its scale: see [`SafeRay`].
    end: Column,
    scale: Column,
    /// The rays that are no miss from the start.
    alive: u32,
    rays: &'a [Ray],
}

/// A number whose last five bits are zero, and become what is added to it.
const WAYS: f32 = (1 << 23) as f32;

impl<'a> Batch<'a> {
    /// How many rays there are at most.
    pub(super) const SIZE: usize = 8;

    /// At most [`Self::SIZE`] rays. Boxes that are not a triangle's own need a slack of `pad` around the origin, relative to
    /// its size.
    #[inline(always)]
    pub(in crate::bvh) fn new<E: Eight>(rays: &'a [Ray], pad: f32) -> Self {
        let mut columns = Columns::<E>::of(rays);
        let mut scale = [1.0; Self::SIZE];
        if columns.safe.count_ones() as usize != rays.len() {
            let scaled = scaled(rays, &mut scale);
            columns = Columns::of(&scaled[..rays.len()]);
        }
        let Columns {
            world, end, safe, ..
        } = columns;
        let padded = world.with_pad(pad);
        let along = farthest_along(&world.direction);
        let from = framed(&world.origin, along);
        let [right, up, forward] = framed(&world.direction, along);
        let zero = E::splat(0.0);
        let farthest = largest_size(&world.origin);
        let slack = farthest.mul(E::splat(Depths::SLACK));
        Self {
            near_origin: by_axis!(|i| {
                let [above, below] = padded.padded(i);
                E::select(world.goes_backwards(i), below, above).to_array()
            }),
            far_origin: by_axis!(|i| {
                let [above, below] = padded.padded(i);
                E::select(world.goes_backwards(i), above, below).to_array()
            }),
            backward: by_axis!(|i| zero.sub(world.inverse[i]).to_array()),
            from: by_axis!(|i| from[i].to_array()),
            slope: [right.div(forward).to_array(), up.div(forward).to_array()],
            rate: forward.mul(E::splat(Depths::RATE)).to_array(),
            slack: slack.add(E::splat(f32::MIN_POSITIVE)).to_array(),
            origin: by_axis!(|i| world.origin[i].to_array()),
            direction: by_axis!(|i| world.direction[i].to_array()),
            pad: farthest.mul(E::splat(PAD)).to_array(),
            way: ways(&world, along).to_array(),
            end: end.to_array(),
            scale,
            alive: safe,
            rays,
        }
    }

    /// The rays that are no miss from the start.
    #[inline(always)]
    pub(in crate::bvh) fn rays(&'a self) -> impl Iterator<Item = RayOfBatch<'a>> {
        lanes_of(self.alive).map(|lane| RayOfBatch { batch: self, lane })
    }
}

/// The rays as [`SafeRay`] scales them, and by how much; as they are where they are a miss.
#[cold]
fn scaled(rays: &[Ray], scale: &mut Column) -> [Ray; Batch::SIZE] {
    let mut scaled = [Ray::new(Vec3::ZERO, Vec3::ZERO); Batch::SIZE];
    for ((scaled, scale), ray) in scaled.iter_mut().zip(scale).zip(rays) {
        *scaled = *ray;
        if let Some(safe) = SafeRay::new(ray) {
            scaled.direction = safe.world.direction.into();
            scaled.t_max = safe.end;
            *scale = safe.measure.scale();
        }
    }
    scaled
}

/// Vectors along the axes of each ray's frame.
#[inline(always)]
fn framed<E: Eight>(v: &[E; 3], [x, y]: [E::Mask; 2]) -> [E; 3] {
    by_axis!(|i| {
        let [first, second] = [v[(i + 1) % 3], v[(i + 2) % 3]];
        E::select(x, first, E::select(y, second, v[i]))
    })
}

/// See [`Batch::way`].
#[inline(always)]
fn ways<E: Eight>(rays: &PacketRays<E>, [x, y]: [E::Mask; 2]) -> E {
    let zero = E::splat(0.0);
    let backwards = by_axis!(|i| {
        let bit = E::splat((1 << i) as f32);
        E::select(rays.goes_backwards(i), bit, zero)
    });
    let frame = E::select(x, zero, E::select(y, E::splat(8.0), E::splat(16.0)));
    let [x, y, z] = backwards;
    x.add(y).add(z).add(frame.add(E::splat(WAYS)))
}

/// One of the rays.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct RayOfBatch<'a> {
    batch: &'a Batch<'a>,
    lane: usize,
}

impl RayOfBatch<'_> {
    /// Its place in the batch.
    #[inline(always)]
    pub(in crate::bvh) fn place(&self) -> usize {
        self.lane
    }

    #[inline(always)]
    fn of(&self, column: &Column) -> f32 {
        column[self.lane % Batch::SIZE]
    }

    #[inline(always)]
    fn three(&self, columns: &[Column; 3]) -> [f32; 3] {
        by_axis!(|i| self.of(&columns[i]))
    }

    /// See [`Batch::way`].
    #[inline(always)]
    fn way(&self) -> u32 {
        self.of(&self.batch.way).to_bits()
    }
}

impl TreeRay for RayOfBatch<'_> {
    type Sight<'a>
        = Self
    where
        Self: 'a;

    #[inline(always)]
    fn wide<E: Eight>(&self, start: f32) -> WideRay<E> {
        let Batch {
            near_origin,
            far_origin,
            backward,
            ..
        } = self.batch;
        WideRay {
            sides: Sides::of(self.way()),
            near_origin: by_axis!(|i| E::splat(self.of(&near_origin[i]))),
            far_origin: by_axis!(|i| E::splat(self.of(&far_origin[i]))),
            backward: by_axis!(|i| E::splat(self.of(&backward[i]))),
            start: E::splat(start),
        }
    }

    #[inline(always)]
    fn sight(&mut self) -> Self {
        *self
    }
}

impl Sight for RayOfBatch<'_> {
    #[inline(always)]
    fn axes(&self) -> [Axis; 3] {
        FRAMES[(self.way() >> 3) as usize % FRAMES.len()]
    }

    #[inline(always)]
    fn from(&self) -> [f32; 3] {
        self.three(&self.batch.from)
    }

    #[inline(always)]
    fn slope(&self) -> [f32; 2] {
        let [right, up] = &self.batch.slope;
        [self.of(right), self.of(up)]
    }

    #[inline(always)]
    fn depths(&self) -> Depths {
        Depths {
            rate: self.of(&self.batch.rate),
            slack: self.of(&self.batch.slack),
        }
    }

    #[inline(always)]
    fn ray(&self) -> ObjectRay {
        self.world()
    }
}

impl WorldRay for RayOfBatch<'_> {
    type InTree<'a>
        = Self
    where
        Self: 'a;

    #[inline(always)]
    fn in_tree(&self) -> Self {
        *self
    }

    /// The batch was padded for those boxes.
    #[inline(always)]
    fn at_top<E: Eight>(&self, _: &Aggregate) -> WideRay<E> {
        self.wide(0.0)
    }

    #[inline(always)]
    fn world(&self) -> ObjectRay {
        let Batch {
            origin,
            direction,
            backward,
            pad,
            ..
        } = self.batch;
        let origin = Vec3A::from_array(self.three(origin));
        let slab = SlabRay {
            above: origin,
            below: origin,
            inverse: -Vec3A::from_array(self.three(backward)),
        };
        ObjectRay {
            origin,
            direction: Vec3A::from_array(self.three(direction)),
            slab: slab.with_pad(origin, self.of(pad)),
        }
    }

    #[inline(always)]
    fn start(&self) -> f32 {
        0.0
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.of(&self.batch.end)
    }

    #[inline(always)]
    fn time(&self) -> f32 {
        self.batch.rays[self.lane].time
    }

    #[inline(always)]
    fn measure(&self) -> Measure {
        Measure::new(self.of(&self.batch.scale), self.batch.rays[self.lane].t_max)
    }

    #[inline(always)]
    fn starts_on(&self) -> TriangleId {
        self.batch.rays[self.lane].starts_on
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::hard_cases::random::Random;
    use crate::bvh::kernel::triangle::Shear;
    use crate::bvh::kernel::wide::{Lanes, Portable};

    /// Everything that tests of boxes and triangles see of a ray, as bits.
    fn seen(ray: &impl WorldRay, mut in_tree: impl TreeRay) -> Vec<u32> {
        let wide = in_tree.wide::<Portable>(ray.start());
        let sight = in_tree.sight();
        let (world, depths) = (sight.ray(), sight.depths());
        let columns = [wide.near_origin, wide.far_origin, wide.backward];
        let columns = columns.as_flattened().iter();
        let numbers = columns.map(|column| column.to_array()[3]);
        let vectors = [
            world.origin,
            world.direction,
            world.slab.above,
            world.slab.below,
            world.slab.inverse,
        ];
        let numbers = numbers
            .chain(vectors.into_iter().flat_map(|v| v.to_array()))
            .chain(sight.from())
            .chain(sight.slope())
            .chain([depths.rate, depths.slack, ray.end(), ray.time()]);
        let sides = wide.sides.first.into_iter().chain(wide.sides.last);
        let axes = sight.axes().map(|axis| axis as u32);
        numbers
            .map(f32::to_bits)
            .chain(sides.map(|side| side as u32))
            .chain(axes)
            .collect()
    }

    #[test]
    fn a_ray_of_a_batch_is_to_the_last_bit_what_it_is_by_itself() {
        let mut random = Random::new(4);
        let (mut alive, mut scaled) = (0, 0);
        for round in 0..40_000 {
            let rays: Vec<Ray> = (0..=round % Batch::SIZE)
                .map(|_| {
                    let mut direction = random.cube();
                    for axis in 0..3 {
                        direction[axis] *= random.of(&[1.0, 1.0, 1.0, 0.0, -0.0, 1e-20]);
                    }
                    if random.below(3) == 0 {
                        // Two components of one size, or three.
                        direction = direction.signum() * random.of(&[Vec3::ONE, Vec3::X + Vec3::Z]);
                    }
                    let size = random.of(&[1.0, 1.0, 1.0, 1.0, 1.0, 1e-30, 1e-42, 1e30, f32::NAN]);
                    Ray {
                        t_max: random.of(&[f32::INFINITY, 1.0, 1.0, 1e-40, 0.0, f32::NAN]),
                        time: random.of(&[0.0, 0.5, 1.0, 1.0, 1.5]),
                        ..Ray::new(random.cube() * 100.0, direction * size)
                    }
                })
                .collect();
            let batch = Batch::new::<Portable>(&rays, PAD);
            let mut left = rays.len();
            for ray in batch.rays() {
                left -= 1;
                let safe = SafeRay::new(&rays[ray.place()]).expect("no miss");
                let expected = seen(&safe, safe.in_tree());
                assert_eq!(seen(&ray, ray.in_tree()), expected, "{:?}", safe.world);
                let Shear { axes, .. } = Shear::new(safe.world.origin, safe.world.direction);
                assert_eq!(ray.axes(), axes);
                assert_eq!(ray.measure().scale(), safe.measure.scale());
                alive += 1;
                scaled += usize::from(safe.measure.scale() != 1.0);
            }
            // What is left out has no hit: either is a miss at once, or so short that it ends where it starts.
            let misses = rays
                .iter()
                .filter(|ray| SafeRay::new(ray).is_none_or(|safe| safe.end == 0.0));
            assert_eq!(misses.count(), left, "{rays:?}");
        }
        assert!(
            alive > 30_000 && scaled > 3_000,
            "{alive} rays, {scaled} of them scaled"
        );
    }
}
