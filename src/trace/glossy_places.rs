//! Which places of a light are chosen for surfaces with a highlight: a stage over columns.

use super::light_frames::Frame;
use super::numbers::Pairs;
use super::parallelogram_frame::ParallelogramFrame;
use super::parallelogram_warp::Places;
use super::receiver::Receivers;
use super::segment_warp::{SegmentFrame, SegmentPlaces};
use super::vertices::Vertices;
use crate::instruction_sets::vectorized;
use glam::Vec3;

/// Questions that are answered together: what fills the widest vectors.
const LANES: usize = 32;

/// A place of a light, chosen for a vertex.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChosenPlace {
    /// In [0, 1]²; of a segment the first number counts.
    pub place: [f32; 2],
    /// What arrives per unit of its colour, divided by its density; 0 where nothing does.
    pub arriving: f32,
}

/// What was chosen for those of some questions whose surfaces have a highlight.
#[derive(Default)]
pub(super) struct GlossyPlaces {
    /// Which of the questions.
    glossy: Vec<u32>,
    chosen: Vec<ChosenPlace>,
}

impl GlossyPlaces {
    /// Of a question, by its place in the list.
    pub fn get(&self, i: usize) -> ChosenPlace {
        self.chosen[i]
    }

    /// Chooses a place for each of `questions`: `askers` names its vertex, `numbers` choose, and `from` says where a vertex
    /// is in the frame that moves with the light.
    pub fn choose(
        &mut self,
        frame: &Frame,
        vertices: &Vertices,
        askers: &[u32],
        questions: &[u32],
        numbers: &Pairs,
        from: impl Fn(usize) -> Vec3,
    ) {
        self.chosen.clear();
        self.chosen.resize(questions.len(), ChosenPlace::default());
        self.glossy.clear();
        let vertex_of = |i: u32| askers[questions[i as usize] as usize] as usize;
        let all = 0..questions.len() as u32;
        (self.glossy).extend(all.filter(|&i| vertices.has_highlight(vertex_of(i))));
        for some in self.glossy.chunks(LANES) {
            // The last ones stand for those that are missing.
            let glossy = |lane: usize| some[lane.min(some.len() - 1)];
            let receivers = Receivers::glossy(vertices, |lane| vertex_of(glossy(lane)), &from);
            let numbers = [&numbers.u, &numbers.v].map(|column| {
                std::array::from_fn(|lane| column[questions[glossy(lane) as usize] as usize])
            });
            let places = match frame {
                Frame::Segment(frame) => on_segment(frame, &receivers, &numbers[0]),
                Frame::Parallelogram(frame) => on_parallelogram(frame, &receivers, &numbers),
            };
            for (lane, i) in some.iter().enumerate() {
                self.chosen[*i as usize] = ChosenPlace {
                    place: places.uv.map(|column| column[lane]),
                    arriving: places.solid_angle[lane],
                };
            }
        }
    }
}

fn on_segment(
    frame: &SegmentFrame,
    receivers: &Receivers<LANES>,
    numbers: &[f32; LANES],
) -> Places<LANES> {
    let SegmentPlaces { u, arriving } = glossy_segment(frame, receivers, numbers);
    Places {
        uv: [u, [0.5; LANES]],
        solid_angle: arriving,
    }
}

vectorized! {
    fn on_parallelogram(
        frame: &ParallelogramFrame,
        receivers: &Receivers<LANES>,
        numbers: &[[f32; LANES]; 2],
    ) -> Places<LANES> {
        frame.glossy_places(receivers, numbers)
    }

    fn glossy_segment(
        frame: &SegmentFrame,
        receivers: &Receivers<LANES>,
        numbers: &[f32; LANES],
    ) -> SegmentPlaces<LANES> {
        frame.glossy_places(receivers, numbers)
    }
}
