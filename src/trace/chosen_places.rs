//! Which places of a light are chosen for the vertices that ask for one: a stage over columns.

use super::light_frames::Frame;
use super::numbers::Pairs;
use super::parallelogram_frame::ParallelogramFrame;
use super::parallelogram_warp::Places;
use super::radiance::Vertex;
use super::receiver::Receivers;
use super::segment_warp::{SegmentFrame, SegmentPlaces};
use crate::instruction_sets::vectorized;
use glam::Vec3;

/// Vertices that are done together: what fills the widest vectors.
const LANES: usize = 32;

/// A place of a light, chosen for a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChosenPlace {
    /// In [0, 1]²; of a segment the first number counts.
    pub place: [f32; 2],
    /// What arrives per unit of its colour, divided by its density; 0 where nothing does.
    pub arriving: f32,
}

/// What was chosen for everyone who asked, in their order.
#[derive(Default)]
pub(super) struct ChosenPlaces {
    /// Who asks, by whether a highlight counts: the number of the question.
    matt: Vec<u32>,
    glossy: Vec<u32>,
    chosen: Vec<ChosenPlace>,
}

impl ChosenPlaces {
    pub fn get(&self, question: usize) -> ChosenPlace {
        self.chosen[question]
    }

    /// Chooses a place for every question: `askers` names its vertex, `numbers` choose, and `from` says where a vertex is in
    /// the frame that moves with the light.
    pub fn choose(
        &mut self,
        frame: &Frame,
        vertices: &[Vertex],
        askers: &[u32],
        numbers: &Pairs,
        from: impl Fn(&Vertex) -> Vec3,
    ) {
        self.chosen.clear();
        self.chosen.resize(askers.len(), ChosenPlace::default());
        self.matt.clear();
        self.glossy.clear();
        for (question, asker) in askers.iter().enumerate() {
            let is_matt = vertices[*asker as usize].surface.specular == Vec3::ZERO;
            let list = if is_matt {
                &mut self.matt
            } else {
                &mut self.glossy
            };
            list.push(question as u32);
        }
        for (questions, glossy) in [(&self.matt, false), (&self.glossy, true)] {
            for some in questions.chunks(LANES) {
                // The last ones stand for those that are missing.
                let question = |lane: usize| some[lane.min(some.len() - 1)] as usize;
                let receivers = Receivers::gather(|lane| {
                    let vertex = &vertices[askers[question(lane)] as usize];
                    (&vertex.surface, from(vertex))
                });
                let numbers = [&numbers.u, &numbers.v]
                    .map(|column| std::array::from_fn(|lane| column[question(lane)]));
                let places = match frame {
                    Frame::Segment(frame) => segment_places(frame, glossy, &receivers, &numbers[0]),
                    Frame::Parallelogram(frame) => places_on(frame, glossy, &receivers, &numbers),
                };
                for (lane, question) in some.iter().enumerate() {
                    self.chosen[*question as usize] = ChosenPlace {
                        place: places.uv.map(|column| column[lane]),
                        arriving: places.solid_angle[lane],
                    };
                }
            }
        }
    }
}

fn segment_places(
    frame: &SegmentFrame,
    glossy: bool,
    receivers: &Receivers<LANES>,
    numbers: &[f32; LANES],
) -> Places<LANES> {
    let SegmentPlaces { u, arriving } = if glossy {
        glossy_segment(frame, receivers, numbers)
    } else {
        matt_segment(frame, receivers, numbers)
    };
    Places {
        uv: [u, [0.5; LANES]],
        solid_angle: arriving,
    }
}

fn places_on(
    frame: &ParallelogramFrame,
    glossy: bool,
    receivers: &Receivers<LANES>,
    numbers: &[[f32; LANES]; 2],
) -> Places<LANES> {
    if glossy {
        glossy_parallelogram(frame, receivers, numbers)
    } else {
        matt_parallelogram(frame, receivers, numbers)
    }
}

vectorized! {
    fn matt_parallelogram(
        frame: &ParallelogramFrame,
        receivers: &Receivers<LANES>,
        numbers: &[[f32; LANES]; 2],
    ) -> Places<LANES> {
        frame.matt_places(receivers, numbers)
    }

    fn glossy_parallelogram(
        frame: &ParallelogramFrame,
        receivers: &Receivers<LANES>,
        numbers: &[[f32; LANES]; 2],
    ) -> Places<LANES> {
        frame.glossy_places(receivers, numbers)
    }

    fn matt_segment(
        frame: &SegmentFrame,
        receivers: &Receivers<LANES>,
        numbers: &[f32; LANES],
    ) -> SegmentPlaces<LANES> {
        frame.matt_places(receivers, numbers)
    }

    fn glossy_segment(
        frame: &SegmentFrame,
        receivers: &Receivers<LANES>,
        numbers: &[f32; LANES],
    ) -> SegmentPlaces<LANES> {
        frame.glossy_places(receivers, numbers)
    }
}
