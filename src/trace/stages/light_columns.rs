//! Which points of one light surfaces are given: a stage over columns.
//!
//! Whatever takes a branch, a cone, a dome or a hit beside an edge, is asked question by question in
//! [`direct`](super::direct), by the same formulas.

use super::questions::{LANES, Questions};
use super::replies::Replies;
use crate::instruction_sets::vectorized;
use crate::scene::Lighting;
use crate::trace::light_sampling::lamp::Lamp;
use crate::trace::light_sampling::light_frames::Frame;
use crate::trace::light_sampling::parallelogram_frame::ParallelogramFrame;
use crate::trace::light_sampling::parallelogram_warp::{MattPrepared, Places};
use crate::trace::light_sampling::receiver::Receivers;
use crate::trace::light_sampling::segment_warp::{SegmentFrame, SegmentPlaces};
use crate::trace::math::vectors::{column_vector, set_column};
use crate::trace::world::lights::{
    DirectionalLight, ParallelogramLight, SegmentLight, inverse_square, is_near_or_far,
};
use crate::trace::world::sun_disc::SunDisc;
use glam::Vec3;
/// Points of a light as their askers see them: the columns of [`LightPoint`](crate::trace::LightPoint).
pub(in crate::trace) struct Points<const N: usize> {
    pub direction: [[f32; N]; 3],
    /// Infinite where the light is.
    pub distance: [f32; N],
    /// Nothing where no point was chosen.
    pub arriving: [[f32; N]; 3],
    /// As in [`Replies`].
    pub is_rare: [u32; N],
}

/// A light that gives columns of questions their answers.
pub(super) enum Source<'a> {
    /// A point, and its W/sr.
    Point(Vec3, Vec3),
    /// A unit vector there, and W/m² that arrive.
    Direction(Vec3, Vec3),
    Sun(&'a DirectionalLight, &'a SunDisc),
    Segment(&'a SegmentLight, &'a SegmentFrame),
    Parallelogram(&'a ParallelogramLight, &'a ParallelogramFrame),
}

impl<'a> Source<'a> {
    /// Of a lamp with that frame; `None` where its points are asked for one by one.
    pub fn of(lamp: Lamp<'a>, frame: Option<&'a Frame>, soft_shadows: bool) -> Option<Self> {
        match (lamp, frame) {
            (Lamp::Point(light), _) if light.cone.is_none() => {
                Some(Self::Point(light.position, light.color))
            }
            (Lamp::Directional(light), _) => Some(match &light.disc {
                Some(disc) if soft_shadows => Self::Sun(light, disc),
                _ => Self::Direction(light.to_light, light.color),
            }),
            (Lamp::Segment(light), Some(Frame::Segment(frame))) => {
                Some(Self::Segment(light, frame))
            }
            (Lamp::Parallelogram(light), Some(Frame::Parallelogram(frame))) => {
                Some(Self::Parallelogram(light, frame))
            }
            _ => None,
        }
    }

    /// Whether the light is infinitely far.
    pub fn is_far(&self) -> bool {
        matches!(self, Self::Direction(..) | Self::Sun(..))
    }

    /// What is the same for all points that the same vertices ask for.
    pub fn prepare(&self, questions: &Questions<LANES>) -> Option<MattPrepared<LANES>> {
        match *self {
            Self::Parallelogram(_, frame) if !questions.is_glossy => {
                Some(prepare(frame, &questions.receivers))
            }
            _ => None,
        }
    }

    /// What was [prepared](Self::prepare) for these vertices, and their numbers.
    pub fn answer(
        &self,
        prepared: &Option<MattPrepared<LANES>>,
        questions: &Questions<LANES>,
    ) -> Replies<LANES> {
        let points = self.points(prepared, questions);
        Replies::of(&points, questions)
    }

    fn points(
        &self,
        prepared: &Option<MattPrepared<LANES>>,
        questions: &Questions<LANES>,
    ) -> Points<LANES> {
        match *self {
            Self::Point(position, color) => of_point(position, color, questions),
            Self::Direction(to_light, color) => of_direction(to_light, color),
            Self::Sun(light, disc) => of_sun(light, disc, questions),
            Self::Segment(light, frame) => {
                let places = if questions.is_glossy {
                    on_segment_for_glossy(frame, questions)
                } else {
                    on_segment(frame, questions)
                };
                of_segment(light, &places, questions)
            }
            Self::Parallelogram(light, frame) => {
                let places = match prepared {
                    Some(prepared) => on_parallelogram(frame, prepared, questions),
                    None => on_parallelogram_for_glossy(frame, questions),
                };
                of_parallelogram(light, &places, questions)
            }
        }
    }
}

vectorized! {
    fn of_point(position: Vec3, color: Vec3, questions: &Questions<LANES>) -> Points<LANES> {
        let mut points = Points::nothing();
        for i in 0..LANES {
            let offset = position - column_vector(&questions.receivers.from, i);
            let distance = offset.length();
            points.set_near(i, offset, distance, color * inverse_square(distance));
        }
        points
    }

    fn of_direction(to_light: Vec3, color: Vec3) -> Points<LANES> {
        let mut points = Points::nothing();
        for i in 0..LANES {
            points.set_far(i, to_light, color);
        }
        points
    }

    fn of_sun(
        light: &DirectionalLight,
        disc: &SunDisc,
        questions: &Questions<LANES>,
    ) -> Points<LANES> {
        let [u, v] = &questions.numbers;
        let frame = disc.frame(light.to_light, Lighting::Physical);
        let mut points = Points::nothing();
        for i in 0..LANES {
            let (direction, counts) = frame.direction([u[i], v[i]]);
            points.set_far(i, direction, light.color * counts);
        }
        points
    }

    fn on_segment(frame: &SegmentFrame, questions: &Questions<LANES>) -> SegmentPlaces<LANES> {
        frame.matt_places(&questions.receivers, &questions.numbers[0])
    }

    fn on_segment_for_glossy(
        frame: &SegmentFrame,
        questions: &Questions<LANES>,
    ) -> SegmentPlaces<LANES> {
        frame.glossy_places(&questions.receivers, &questions.numbers[0])
    }

    fn of_segment(
        light: &SegmentLight,
        places: &SegmentPlaces<LANES>,
        questions: &Questions<LANES>,
    ) -> Points<LANES> {
        let mut points = Points::nothing();
        for i in 0..LANES {
            let from = column_vector(&questions.receivers.from, i);
            let offset = light.offset(from, places.u[i]);
            let arriving = light.color(places.u[i]) * arriving_part(places.arriving[i]);
            points.set_near(i, offset, offset.length(), arriving);
        }
        points
    }

    fn prepare(
        frame: &ParallelogramFrame,
        receivers: &Receivers<LANES>,
    ) -> MattPrepared<LANES> {
        frame.matt_prepared(receivers)
    }

    fn on_parallelogram(
        frame: &ParallelogramFrame,
        prepared: &MattPrepared<LANES>,
        questions: &Questions<LANES>,
    ) -> Places<LANES> {
        frame.matt_places_of(prepared, &questions.numbers)
    }

    fn on_parallelogram_for_glossy(
        frame: &ParallelogramFrame,
        questions: &Questions<LANES>,
    ) -> Places<LANES> {
        frame.glossy_places(&questions.receivers, &questions.numbers)
    }

    fn of_parallelogram(
        light: &ParallelogramLight,
        places: &Places<LANES>,
        questions: &Questions<LANES>,
    ) -> Points<LANES> {
        let mut points = Points::nothing();
        for i in 0..LANES {
            let from = column_vector(&questions.receivers.from, i);
            let [u, v] = [places.uv[0][i], places.uv[1][i]];
            let offset = light.offset(from, [u, v]);
            let arriving = light.color(u, v) * arriving_part(places.solid_angle[i]);
            points.set_near(i, offset, offset.length(), arriving);
        }
        points
    }
}

/// What arrives for a density of which the reciprocal is a number; else nothing.
#[inline(always)]
fn arriving_part(per_density: f32) -> f32 {
    let counts = per_density > 0.0 && per_density < f32::INFINITY;
    if counts { per_density } else { 0.0 }
}

impl<const N: usize> Points<N> {
    #[inline(always)]
    fn nothing() -> Self {
        Self {
            direction: [[0.0; N]; 3],
            distance: [0.0; N],
            arriving: [[0.0; N]; 3],
            is_rare: [0; N],
        }
    }

    /// A point `offset` away.
    #[inline(always)]
    fn set_near(&mut self, i: usize, offset: Vec3, distance: f32, arriving: Vec3) {
        set_column(&mut self.direction, i, offset * (1.0 / distance));
        self.distance[i] = distance;
        set_column(&mut self.arriving, i, arriving);
        self.is_rare[i] = is_near_or_far(offset.length_squared()) as u32;
    }

    #[inline(always)]
    fn set_far(&mut self, i: usize, direction: Vec3, arriving: Vec3) {
        set_column(&mut self.direction, i, direction);
        self.distance[i] = f32::INFINITY;
        set_column(&mut self.arriving, i, arriving);
    }
}
#[cfg(test)]
mod tests {
    use super::super::shadow_rays::shadow_ray;
    use super::*;
    use crate::bvh::{Hit, Ray};
    use crate::scene::{Lighting, RenderSettings};
    use crate::trace::math::vectors::Vectors;
    use crate::trace::random::numbers::Pairs;
    use crate::trace::surfaces::shading::reflected;
    use crate::trace::test_scene::{self, Numbers};
    use crate::trace::world::lights::{DirectionalLight, PointLight};
    use crate::trace::{Cone, LightPoint, Surface};

    /// The point that numbers choose for one surface by itself.
    fn point(
        lamp: Lamp,
        frame: Option<&Frame>,
        surface: &Surface,
        numbers: [f32; 2],
    ) -> Option<LightPoint> {
        let from = surface.point.position;
        match frame {
            Some(frame) => lamp.point_for(frame, surface, from, numbers),
            None => lamp.point(surface, from, numbers, Lighting::Physical),
        }
    }

    #[test]
    fn columns_give_a_surface_what_it_is_given_alone_to_the_bit() {
        let world = test_scene::world();
        let (rays, hits) = test_scene::rays(&world);
        let settings = RenderSettings::default();
        let vertices = test_scene::vertices(&world, &settings, (&rays, &hits), Cone::default());
        let mut weights = Vectors::default();
        weights.resize(vertices.len());
        let mut numbers = Numbers(5);
        let mut drawn = Pairs::default();
        drawn.fill(vertices.len(), [0.0; 2]);
        for i in 0..vertices.len() {
            weights.set(i, numbers.in_cube().abs());
            (drawn.u[i], drawn.v[i]) = (numbers.next(), numbers.next());
        }
        let counts: Vec<u32> = (0..vertices.len()).map(|i| 1 + i as u32 % 3).collect();

        let points =
            [Vec3::new(0.5, 2.0, 0.3), Vec3::new(1e6, 1.0, 0.0)].map(|position| PointLight {
                id: 1,
                position,
                color: Vec3::new(3.0, 2.0, 1.0),
                cone: None,
            });
        let directions = [0.0, 0.1, 3.0].map(|diameter| DirectionalLight {
            id: 2,
            to_light: Vec3::new(0.6, 0.8, 0.0),
            color: Vec3::ONE,
            disc: SunDisc::of_diameter(diameter),
            samples: 1,
        });
        let segments = [Vec3::ONE, Vec3::X].map(|color| SegmentLight {
            id: 3,
            ends: [Vec3::new(-1.0, 1.5, 0.0), Vec3::new(2.0, 1.0, 0.5)],
            colors: [Vec3::ONE, color],
            samples: 1,
        });
        let parallelograms =
            [(Vec3::ONE, false), (Vec3::X, true)].map(|(color, two_sided)| ParallelogramLight {
                id: 4,
                corner: Vec3::new(-0.5, 1.2, -0.4),
                edges: [Vec3::X, Vec3::new(0.2, 0.1, 0.8)],
                colors: [Vec3::ONE, color, Vec3::ONE, Vec3::ONE],
                two_sided,
                visible: false,
                samples: 1,
            });
        let lamps = (points.iter().map(Lamp::Point))
            .chain(directions.iter().map(Lamp::Directional))
            .chain(segments.iter().map(Lamp::Segment))
            .chain(parallelograms.iter().map(Lamp::Parallelogram));
        for lamp in lamps {
            let frame = lamp.frame();
            let source = Source::of(lamp, frame.as_ref(), true).unwrap();
            let ordinary = (0..vertices.len()).filter(|&i| !vertices.is_near_edge[i]);
            let (glossy, matt): (Vec<_>, Vec<_>) = ordinary
                .map(|i| i as u32)
                .partition(|&i| vertices.has_highlight(i as usize));
            let mut lit = [0, 0];
            let some_of = |all: &[u32], is_glossy| {
                let some = all.chunks(LANES).map(<[u32]>::to_vec);
                some.map(|some| (some, is_glossy)).collect::<Vec<_>>()
            };
            for (some, is_glossy) in [some_of(&matt, false), some_of(&glossy, true)].concat() {
                let mut questions = Questions::nothing(is_glossy);
                questions.ask(&some, &weights, &vertices);
                questions.share(&counts);
                questions.draw(&drawn, |vertex| vertex);
                let replies = source.answer(&source.prepare(&questions), &questions);
                for (lane, &question) in some.iter().enumerate() {
                    let i = question as usize;
                    let surface = vertices.surface(i);
                    let point = point(lamp, frame.as_ref(), &surface, drawn.get(i));
                    let value = point.map_or(Vec3::ZERO, |point| {
                        let reflected = reflected(&surface, &point, Lighting::Physical);
                        weights.get(i) / counts[i] as f32 * reflected
                    });
                    let place: (&Ray, &Hit) = (&rays[i], &hits[i]);
                    if replies.is_rare[lane] != 0 {
                        continue;
                    }
                    let found = column_vector(&replies.value, lane);
                    assert_eq!(found, value, "{lamp:?}: {place:?}");
                    if let Some(point) = point
                        && value != Vec3::ZERO
                    {
                        lit[usize::from(is_glossy)] += 1;
                        let ray = shadow_ray(&world.aggregate, &surface, &point, 0.0);
                        let found = [&replies.origin, &replies.along]
                            .map(|columns| column_vector(columns, lane));
                        assert_eq!(found, [ray.origin, ray.direction], "{lamp:?}: {place:?}");
                        assert_eq!(source.is_far(), ray.t_max == f32::INFINITY);
                    }
                }
            }
            assert!(
                lit[0] > 1000 && lit[1] > 1000,
                "{lamp:?} lights only {lit:?}"
            );
        }
    }
}
