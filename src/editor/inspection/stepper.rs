//! A ray's way through the trees, played step by step, forwards and back.

use super::choice::Inspected;
use crate::inspect::{Step, StepKind, Traversal};
use bevy::ecs::system::{Local, ResMut};
use bevy::platform::collections::HashMap;
use std::time::Instant;

/// Steps a second, at first.
const SPEED: f32 = 4.0;

/// The traversal, and how far it was played.
#[derive(Clone, Debug)]
pub(in crate::editor) struct Stepper {
    traversal: Traversal,
    /// What is known of each entry of [`Traversal::stack`].
    marks: Vec<Mark>,
    at: usize,
    /// Goes on by itself.
    pub playing: bool,
    /// Steps a second, above 0.
    pub speed: f32,
    /// The part of a step that has passed.
    passed: f32,
}

impl Default for Stepper {
    fn default() -> Self {
        Self {
            traversal: Traversal::default(),
            marks: Vec::new(),
            at: 0,
            playing: false,
            speed: SPEED,
            passed: 0.0,
        }
    }
}

/// What becomes of a node that is put off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::editor) struct Mark {
    /// Where the ray enters its box; `None` where its turn never comes.
    pub t: Option<f32>,
    /// A hit that is known by now is nearer: it will not be entered.
    pub is_pruned: bool,
}

impl Stepper {
    /// Another traversal, from its first step; an edited scene's stays where it was.
    pub fn load(&mut self, traversal: Traversal, stays: bool) {
        self.marks = marks(&traversal);
        self.traversal = traversal;
        if stays {
            self.at = self.at.min(self.last());
        } else {
            self.at = 0;
            self.playing = false;
        }
        self.passed = 0.0;
    }

    /// How many steps there are.
    pub fn len(&self) -> usize {
        self.traversal.steps.len()
    }

    /// All steps.
    pub fn steps(&self) -> &[Step] {
        &self.traversal.steps
    }

    /// The traversal itself.
    pub fn traversal(&self) -> &Traversal {
        &self.traversal
    }

    /// Which step is shown.
    pub fn at(&self) -> usize {
        self.at
    }

    /// The step that is shown.
    pub fn step(&self) -> Option<&Step> {
        self.traversal.steps.get(self.at)
    }

    fn last(&self) -> usize {
        self.len().saturating_sub(1)
    }

    /// Shows a step; beyond the last one it is the last.
    pub fn go(&mut self, to: usize) {
        self.at = to.min(self.last());
        self.passed = 0.0;
    }

    /// One on.
    pub fn forward(&mut self) {
        self.playing = false;
        self.go(self.at + 1);
    }

    /// One back.
    pub fn back(&mut self) {
        self.playing = false;
        self.go(self.at.saturating_sub(1));
    }

    /// Begins or stops to go on by itself; from the end it begins anew.
    pub fn toggle(&mut self) {
        self.playing = !self.playing && self.len() > 1;
        if self.playing && self.at == self.last() {
            self.go(0);
        }
    }

    /// Lets time pass, in seconds.
    pub fn pass(&mut self, seconds: f32) {
        if !self.playing {
            return;
        }
        self.passed += seconds.max(0.0) * self.speed;
        let whole = self.passed.floor();
        let passed = self.passed - whole;
        self.go(self.at.saturating_add(whole as usize));
        self.passed = passed;
        if self.at == self.last() {
            self.playing = false;
        }
    }

    /// The nodes that are put off after this step, the next one last.
    pub fn stack(&self) -> impl DoubleEndedIterator<Item = ((Option<u32>, u32), Mark)> {
        let range = self
            .step()
            .map_or(0..0, |step| step.stack[0] as usize..step.stack[1] as usize);
        let entries = self.traversal.stack.get(range.clone()).unwrap_or_default();
        let marks = self.marks.get(range).unwrap_or_default();
        entries.iter().copied().zip(marks.iter().copied())
    }

    /// Nodes entered, boxes missed, boxes pruned and triangles tested up to this step, itself
    /// included.
    pub fn counts(&self) -> [usize; 4] {
        let mut counts = [0; 4];
        for step in self.traversal.steps.iter().take(self.at + 1) {
            counts[match step.kind {
                StepKind::Entered => 0,
                StepKind::Missed => 1,
                StepKind::Pruned => 2,
                StepKind::Hit | StepKind::NotHit => 3,
            }] += 1;
        }
        counts
    }
}

/// The next turn of a node.
struct Turn {
    /// Where its box is entered.
    t: Option<f32>,
    is_pruned: bool,
    /// How many hits come later.
    hits: u32,
}

/// Looks ahead: where the ray enters what is put off, and whether it will be pruned without another
/// hit coming first.
fn marks(traversal: &Traversal) -> Vec<Mark> {
    let mut marks = vec![Mark::default(); traversal.stack.len()];
    let mut turns: HashMap<(Option<u32>, u32), Turn> = HashMap::default();
    let mut hits = 0;
    for step in traversal.steps.iter().rev() {
        let range = step.stack[0] as usize..step.stack[1] as usize;
        for (mark, node) in marks[range.clone()].iter_mut().zip(&traversal.stack[range]) {
            if let Some(turn) = turns.get(node) {
                *mark = Mark {
                    t: turn.t,
                    is_pruned: turn.is_pruned && hits == turn.hits,
                };
            }
        }
        let node = (step.instance, step.node);
        match step.kind {
            StepKind::Hit => hits += 1,
            StepKind::NotHit => {}
            kind => {
                let turn = Turn {
                    t: step.t,
                    is_pruned: kind == StepKind::Pruned,
                    hits,
                };
                turns.insert(node, turn);
            }
        }
    }
    marks
}

/// Lets the time of a frame pass.
pub(super) fn play(mut inspected: ResMut<Inspected>, mut last: Local<Option<Instant>>) {
    let now = Instant::now();
    let before = last.replace(now);
    if !inspected.stepper.playing {
        *last = None;
        return;
    }
    if let Some(before) = before {
        // A window that was not drawn for a while does not jump.
        let seconds = (now - before).as_secs_f32().min(0.5);
        inspected.stepper.pass(seconds);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::stepper_of;
    use super::*;

    #[test]
    fn steps_are_played_forwards_and_back_within_their_ends() {
        let (mut stepper, cost) = stepper_of("cornell-box", [300, 240], 0);
        let count = stepper.len();
        assert!(count > 5);
        stepper.back();
        assert_eq!(stepper.at(), 0);
        stepper.forward();
        stepper.forward();
        assert_eq!(stepper.at(), 2);
        stepper.back();
        assert_eq!(stepper.at(), 1);
        stepper.go(usize::MAX);
        assert_eq!(stepper.at(), count - 1);
        // What was counted on the way is what the ray cost.
        let [entered, missed, pruned, triangles] = stepper.counts();
        assert_eq!(entered as u64, cost.nodes);
        assert_eq!((entered + missed + pruned) as u64, cost.boxes);
        assert_eq!(triangles as u64, cost.triangles);
    }

    #[test]
    fn playing_takes_its_time_stops_at_the_end_and_begins_anew_from_there() {
        let (mut stepper, _) = stepper_of("cornell-box", [300, 240], 0);
        stepper.speed = 2.0;
        stepper.toggle();
        stepper.pass(0.4);
        assert_eq!(stepper.at(), 0);
        stepper.pass(0.2);
        assert_eq!(stepper.at(), 1, "1.2 steps have passed");
        stepper.pass(1e6);
        assert_eq!(stepper.at(), stepper.len() - 1);
        assert!(!stepper.playing);
        stepper.toggle();
        assert_eq!((stepper.at(), stepper.playing), (0, true));
    }

    #[test]
    fn a_stack_entry_tells_where_it_is_entered_and_is_pruned_only_once_a_nearer_hit_is_known() {
        let mut pruned = 0;
        for pixel in [[300, 240], [260, 200], [340, 260], [300, 300]] {
            let (mut stepper, _) = stepper_of("knot", pixel, 0);
            for at in 0..stepper.len() {
                stepper.go(at);
                for (node, mark) in stepper.stack() {
                    let rest = &stepper.steps()[at + 1..];
                    let turn = rest
                        .iter()
                        .position(|s| s.triangle.is_none() && (s.instance, s.node) == node);
                    let Some(turn) = turn else { continue };
                    assert_eq!(mark.t, rest[turn].t, "step {at}");
                    let hit_first = rest[..turn].iter().any(|s| s.kind == StepKind::Hit);
                    let is = rest[turn].kind == StepKind::Pruned && !hit_first;
                    assert_eq!(mark.is_pruned, is, "step {at}, {node:?}");
                    pruned += usize::from(is);
                }
            }
        }
        assert!(pruned > 0, "nothing was ever pruned");
    }

    #[test]
    fn nothing_to_play_is_no_fault() {
        let mut stepper = Stepper::default();
        stepper.toggle();
        stepper.forward();
        stepper.back();
        stepper.pass(1.0);
        assert_eq!((stepper.at(), stepper.len()), (0, 0));
        assert!(stepper.step().is_none());
        assert_eq!(stepper.stack().count(), 0);
    }
}
