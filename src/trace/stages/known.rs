//! What is known of a batch's samples before they are evaluated, and what is found out of them meanwhile: what their camera
//! rays hit, what the rays hit that leave first hits, where one of each sample does at most, and what hides lights from either.

use super::paths::Paths;
use super::second_hits::SecondHit;
use super::visibility::Visibility;
use crate::bvh::Hit;

/// See the module. Of each there is one for each sample, or none: then nothing is known, and nothing is found out.
#[derive(Default)]
pub struct Known {
    camera_hits: Vec<Option<Hit>>,
    has_camera_hits: bool,
    second_hits: Vec<SecondHit>,
    /// From first hits and from second ones.
    visibilities: [Vec<Visibility>; 2],
}

impl Known {
    /// What the camera rays of the last batch hit, one for each sample.
    pub fn camera_hits(&self) -> &[Option<Hit>] {
        &self.camera_hits
    }

    /// `fill` may put what the camera rays of the next batch hit into an empty list, one for each sample, where it is known
    /// from before: true where it did. They are not traced then.
    pub fn know_camera_hits(&mut self, fill: impl FnOnce(&mut Vec<Option<Hit>>) -> bool) {
        self.camera_hits.clear();
        self.has_camera_hits = fill(&mut self.camera_hits);
    }

    /// What is known of the lights that something hides from the first and from the second hits of the next batch: what is
    /// found out is added to it. There is none after a batch that found out nothing.
    pub fn visibilities(&mut self) -> &mut [Vec<Visibility>; 2] {
        &mut self.visibilities
    }

    /// The same of what rays hit that leave first hits. A ray of which it is known is not traced.
    pub fn second_hits(&mut self) -> &mut Vec<SecondHit> {
        &mut self.second_hits
    }

    /// What a batch of so many samples uses and adds to, bounce by bounce, and the hits of its camera rays.
    pub(super) fn by_bounce(&mut self, samples: usize) -> (KnownNow<'_>, &mut Vec<Option<Hit>>) {
        let has_hits = std::mem::take(&mut self.has_camera_hits);
        let [first, second] = &mut self.visibilities;
        let now = KnownNow {
            visibilities: of_each(first, samples),
            has_learnt: false,
            has_camera_hits: has_hits && self.camera_hits.len() == samples,
            hits: None,
            next: Some(Next {
                hits: of_each(&mut self.second_hits, samples),
                visibilities: of_each(second, samples),
            }),
            bounce: 0,
            found: Found::default(),
        };
        (now, &mut self.camera_hits)
    }

    /// Lets go of everything, after a batch that was not finished.
    pub(super) fn forget(&mut self) {
        self.keep(Found::default());
    }

    /// Lets go of what was known before a batch that did not add to it: it need not be kept again.
    pub(super) fn keep(&mut self, found: Found) {
        for (visibilities, is_new) in self.visibilities.iter_mut().zip(found.visibilities) {
            if !is_new {
                visibilities.clear();
            }
        }
        if !found.second_hits {
            self.second_hits.clear();
        }
    }
}

/// One for each sample; `None` where there are none.
fn of_each<T>(kept: &mut [T], samples: usize) -> Option<&mut [T]> {
    (kept.len() == samples).then_some(kept)
}

/// What is known of the bounce that a batch is at.
pub(in crate::trace) struct KnownNow<'a> {
    /// Of its hits, by their samples; and whether they tell more than before.
    pub visibilities: Option<&'a mut [Visibility]>,
    pub has_learnt: bool,
    /// Its hits are the camera's, and known.
    has_camera_hits: bool,
    hits: Option<&'a mut [SecondHit]>,
    next: Option<Next<'a>>,
    bounce: usize,
    found: Found,
}

/// What is known of the second bounce.
struct Next<'a> {
    hits: Option<&'a mut [SecondHit]>,
    visibilities: Option<&'a mut [Visibility]>,
}

/// Which lists tell more than before.
#[derive(Clone, Copy, Default)]
pub(in crate::trace) struct Found {
    visibilities: [bool; 2],
    second_hits: bool,
}

impl<'a> KnownNow<'a> {
    /// Whether the hits of this bounce are the camera's, and known.
    pub fn has_camera_hits(&self) -> bool {
        self.has_camera_hits
    }

    /// What this bounce's rays hit, as far as that is known, to be added to.
    pub fn take_hits(&mut self) -> Option<&'a mut [SecondHit]> {
        self.hits.take()
    }

    /// Hits of this bounce were found that were not known.
    pub fn found_hits(&mut self) {
        self.found.second_hits = true;
    }

    /// The bounce of these paths comes next.
    pub fn next_bounce(&mut self, paths: &Paths) {
        self.visibilities = None;
        self.has_camera_hits = false;
        let has_learnt = std::mem::take(&mut self.has_learnt);
        if let Some(visibilities) = self.found.visibilities.get_mut(self.bounce) {
            *visibilities = has_learnt;
        }
        self.bounce += 1;
        if let Some(next) = self.next.take()
            && paths.are_one_of_a_sample()
        {
            (self.hits, self.visibilities) = (next.hits, next.visibilities);
        }
    }

    /// What was found out in all bounces.
    pub fn found(self) -> Found {
        self.found
    }
}
