//! Lights that are seen: which of them rays meet.
//!
//! Of few each is asked. Of many those alone whose ball, around all of the light and what rounding adds, the ray may cross:
//! that is asked of [`LANES`] of them at a time, and a panel is met where it is met by itself, bit for bit.

use crate::bvh::Ray;
use crate::instruction_sets::vectorized;
use crate::trace::Lights;
use crate::trace::math::vectors::{column_vector, set_column};
use glam::Vec3;

/// So many are asked one by one.
const FEW: usize = 8;
const LANES: usize = 16;
/// By how much a ball is larger than what is in it, besides for rounding: squared.
const ROOM: f32 = 1.1;
/// Where a ray meets a light's plane is good to some units of rounding of the distance, over the sine of the angle between
/// the light's edges, and so is the ray's distance from the ball's middle.
const ROUNDING: f32 = 64.0 * f32::EPSILON;
/// (r + e)² is no more than 1.1 r² + 11 e².
const OF_ROUNDING: f32 = 11.0;

/// The lights of a world that are seen, as far as they are kept in columns.
#[derive(Default)]
pub(in crate::trace) struct VisibleLights {
    /// Their numbers among the parallelograms, in order.
    numbers: Vec<u32>,
    balls: Vec<Balls>,
    /// Which of them a ray may meet.
    may_meet: Vec<u32>,
}

/// Around some lights, in columns. A place without a light has a radius below zero.
#[derive(Clone, Copy)]
struct Balls {
    middle: [[f32; LANES]; 3],
    /// The square of the radius, with room.
    radius: [f32; LANES],
    /// What rounding may add to that, as a part of the squared distance to the middle.
    rounding: [f32; LANES],
}

impl Balls {
    const NONE: Self = Self {
        middle: [[0.0; LANES]; 3],
        radius: [-1.0; LANES],
        rounding: [0.0; LANES],
    };
}

impl VisibleLights {
    /// Those of these lights. Where some move, or they are few, none is kept in columns.
    pub fn of(&mut self, lights: &Lights) {
        self.numbers.clear();
        self.balls.clear();
        let panels = (0..).zip(&lights.parallelograms);
        let numbers = panels.filter(|(_, panel)| panel.visible).map(|(i, _)| i);
        self.numbers.extend(numbers);
        if self.numbers.len() <= FEW || !lights.moving.is_empty() {
            return;
        }
        for numbers in self.numbers.chunks(LANES) {
            let mut balls = Balls::NONE;
            for (lane, number) in numbers.iter().enumerate() {
                let panel = &lights.parallelograms[*number as usize];
                let [a, b] = panel.edges;
                let middle = panel.corner + 0.5 * (a + b);
                // Half of the longer diagonal, and what the middle may be off.
                let half = 0.5 * (a + b).length().max((a - b).length());
                let radius = half + 4.0 * f32::EPSILON * middle.abs().max_element();
                let sine = panel.area_normal().length() / (a.length() * b.length());
                let rounding = OF_ROUNDING * (ROUNDING / sine).powi(2);
                set_column(&mut balls.middle, lane, middle);
                balls.radius[lane] = ROOM * radius * radius;
                balls.rounding[lane] = rounding;
            }
            self.balls.push(balls);
        }
    }

    /// The numbers of the lights that a ray may meet, in order.
    pub fn near(&mut self, ray: &Ray) -> &[u32] {
        if self.balls.is_empty() {
            return &self.numbers;
        }
        self.may_meet.clear();
        let mut crosses = [0; LANES];
        for (balls, numbers) in self.balls.iter().zip(self.numbers.chunks(LANES)) {
            if cross(balls, ray.origin, ray.direction, &mut crosses) {
                let met = numbers.iter().zip(&crosses).filter(|(_, is)| **is != 0);
                self.may_meet.extend(met.map(|(number, _)| *number));
            }
        }
        &self.may_meet
    }
}

vectorized! {
    /// Which balls a ray may cross, its whole line; whether it is any.
    fn cross(balls: &Balls, origin: Vec3, direction: Vec3, crosses: &mut [u32; LANES]) -> bool {
        let along = direction.length_squared();
        let mut any = 0;
        for (i, crosses) in crosses.iter_mut().enumerate() {
            let to_middle = column_vector(&balls.middle, i) - origin;
            let beside = to_middle.cross(direction).length_squared();
            let radius = balls.radius[i];
            let reach = radius + balls.rounding[i] * (to_middle.length_squared() + radius);
            // What is no number may be anywhere.
            let misses = (beside > reach * along) | (radius < 0.0);
            *crosses = u32::from(!misses);
            any |= *crosses;
        }
        any != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::ParallelogramLight;
    use crate::trace::test_scene::Numbers;
    use glam::{Quat, Vec2};

    fn panels(count: u64, numbers: &mut Numbers) -> Lights {
        let panels = (0..count).map(|id| {
            // Some are thin, and some slanted until hardly anything is left.
            let size = Vec2::new(numbers.next(), numbers.next() * numbers.next());
            let edge = (numbers.in_cube()).normalize_or(Vec3::X);
            let slanted = numbers.in_cube() * (1e-4_f32).powf(numbers.next());
            ParallelogramLight {
                id,
                corner: 30.0 * numbers.in_cube(),
                edges: [size.x * edge, size.y * (edge + slanted)],
                colors: [Vec3::ONE; 4],
                two_sided: id % 3 > 0,
                visible: id % 5 > 0,
                samples: 1,
            }
        });
        Lights {
            parallelograms: panels.collect(),
            ..Lights::default()
        }
    }

    #[test]
    fn no_light_that_a_ray_meets_is_left_out_and_most_others_are() {
        let mut numbers = Numbers(5);
        let (mut met, mut asked, mut all) = (0, 0, 0);
        for far in [0.0, 1e3, 1e6] {
            let mut lights = panels(150, &mut numbers);
            let turned = Quat::from_rotation_y(numbers.next());
            for panel in &mut lights.parallelograms {
                panel.corner = turned * panel.corner + Vec3::splat(far);
            }
            let mut seen = VisibleLights::default();
            seen.of(&lights);
            for i in 0..20_000 {
                // At a place of one of them, inside, on its border or a little beside it.
                let panel = &lights.parallelograms[i % 150];
                let [u, v] = [0, 1].map(|_| 1.2 * numbers.next() - 0.1);
                let to = panel.corner + u.clamp(0.0, 1.0) * panel.edges[0] + v * panel.edges[1];
                let origin = 40.0 * numbers.in_cube() + Vec3::splat(far);
                let ray = Ray::new(origin, (to - origin) * (1.0 + 10.0 * numbers.next()));
                let near = seen.near(&ray).to_vec();
                for (number, panel) in (0..).zip(&lights.parallelograms) {
                    if panel.visible && panel.meet(ray.origin, ray.direction).is_some() {
                        assert!(near.contains(&number), "{panel:?}, {ray:?}");
                        met += 1;
                    }
                }
                asked += near.len();
                all += seen.numbers.len();
            }
        }
        assert!(met > 10_000, "{met}");
        assert!(10 * asked < all, "{asked} of {all}");
    }

    #[test]
    fn few_lights_and_lights_that_move_are_all_asked() {
        let mut seen = VisibleLights::default();
        let ray = Ray::new(Vec3::splat(1e3), Vec3::X);
        let mut lights = panels(9, &mut Numbers(1));
        seen.of(&lights);
        assert_eq!(seen.near(&ray), [1, 2, 3, 4, 6, 7, 8]);
        lights = panels(40, &mut Numbers(1));
        lights.moving.push(crate::trace::MovingLight {
            id: 3,
            velocity: Vec3::X,
            samples: 2,
        });
        seen.of(&lights);
        assert_eq!(seen.near(&ray).len(), 32);
        lights.moving.clear();
        seen.of(&lights);
        assert!(seen.near(&ray).is_empty());
    }
}
