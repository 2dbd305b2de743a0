use super::parallelogram_frame::ParallelogramFrame;
use super::segment_warp::SegmentFrame;
use super::{Lights, ParallelogramLight, SegmentLight};
use crate::scene::{Lighting, RenderSettings};

/// What choosing points of lights for the surfaces that see them needs to know of each, in the order of the lights;
/// nothing where all points of a light are alike.
#[derive(Clone, Debug, Default)]
pub(super) struct LightFrames {
    segments: Vec<Option<SegmentFrame>>,
    parallelograms: Vec<Option<ParallelogramFrame>>,
}

impl LightFrames {
    /// Forgets the lights of the batch before, and gets ready for these.
    pub fn begin(&mut self, lights: &Lights, settings: &RenderSettings) {
        self.segments.clear();
        self.parallelograms.clear();
        if settings.lighting == Lighting::Classic || !settings.features.soft_shadows {
            return;
        }
        let (segments, parallelograms) = (&lights.segments, &lights.parallelograms);
        self.segments
            .extend(segments.iter().map(SegmentLight::frame));
        self.parallelograms
            .extend(parallelograms.iter().map(ParallelogramLight::frame));
    }

    /// Of the segment light with that index.
    pub fn segment(&self, i: usize) -> Option<Frame> {
        let frame = self.segments.get(i).copied().flatten();
        frame.map(Frame::Segment)
    }

    /// Of the parallelogram light with that index.
    pub fn parallelogram(&self, i: usize) -> Option<Frame> {
        let frame = self.parallelograms.get(i).copied().flatten();
        frame.map(Frame::Parallelogram)
    }
}

/// Of a light whose points are not all alike.
#[derive(Clone, Copy, Debug)]
pub(super) enum Frame {
    Segment(SegmentFrame),
    Parallelogram(ParallelogramFrame),
}
