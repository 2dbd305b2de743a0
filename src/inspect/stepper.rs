//! A ray's way through the trees, played step by step, forwards and back.

use super::{Step, StepKind, Traversal};
use bevy::platform::collections::HashMap;

/// Steps a second, at first.
const SPEED: f32 = 4.0;

/// The traversal, and how far it was played.
#[derive(Clone, Debug)]
pub struct Stepper {
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
pub struct Mark {
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

    /// Whether there is no step.
    pub fn is_empty(&self) -> bool {
        self.traversal.steps.is_empty()
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
