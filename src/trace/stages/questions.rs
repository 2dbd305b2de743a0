//! What vertices ask of lights, in columns.

use super::vertices::Vertices;
use crate::instruction_sets::vectorized;
use crate::trace::light_sampling::receiver::Receivers;
use crate::trace::math::vectors::{Vectors, column_vector, set_column};
use crate::trace::random::numbers::Pairs;
use glam::Vec3;

/// Questions that are answered together: what fills the widest vectors.
pub(in crate::trace) const LANES: usize = 32;

/// Points of lights that vertices ask for: matt ones, or ones with a highlight.
pub(in crate::trace) struct Questions<const N: usize> {
    pub is_glossy: bool,
    /// Which they are: so many, in the first lanes.
    askers: [u32; N],
    count_of_askers: usize,
    /// Where they are in the frame in which the light stands still, and how they reflect: of matt ones only the normal.
    pub receivers: Receivers<N>,
    /// Two in [0, 1) for each.
    pub numbers: [[f32; N]; 2],
    /// As in [`Vertices`](super::vertices::Vertices).
    pub position: [[f32; N]; 3],
    pub error: [[f32; N]; 3],
    pub triangle_normal: [[f32; N]; 3],
    pub geometric_normal: [[f32; N]; 3],
    pub diffuse: [[f32; N]; 3],
    /// Of those with a highlight.
    pub specular: [[f32; N]; 3],
    pub to_viewer: [[f32; N]; 3],
    /// What the reflected radiance is multiplied by, and how many points share it.
    pub weight: [[f32; N]; 3],
    pub count: [f32; N],
}

impl Questions<LANES> {
    /// Of vertices that all have a highlight, or that all have none.
    pub fn nothing(is_glossy: bool) -> Self {
        Self {
            is_glossy,
            askers: [0; LANES],
            count_of_askers: 0,
            receivers: Receivers::NOWHERE,
            numbers: [[0.5; LANES]; 2],
            position: [[0.0; LANES]; 3],
            error: [[0.0; LANES]; 3],
            triangle_normal: [[0.0; LANES]; 3],
            geometric_normal: [[0.0; LANES]; 3],
            diffuse: [[0.0; LANES]; 3],
            specular: [[0.0; LANES]; 3],
            to_viewer: [[0.0; LANES]; 3],
            weight: [[0.0; LANES]; 3],
            count: [1.0; LANES],
        }
    }

    /// Puts vertices into the first lanes, which stand where the lights see them. The other lanes keep what they had.
    #[inline(always)]
    pub fn ask(&mut self, some: &[u32], weights: &Vectors, vertices: &Vertices) {
        self.askers[..some.len()].copy_from_slice(some);
        self.count_of_askers = some.len();
        gather(&vertices.normal, some, &mut self.receivers.normal);
        gather(&vertices.position, some, &mut self.position);
        gather(&vertices.error, some, &mut self.error);
        gather(&vertices.triangle_normal, some, &mut self.triangle_normal);
        gather(&vertices.geometric_normal, some, &mut self.geometric_normal);
        gather(&vertices.diffuse, some, &mut self.diffuse);
        gather(weights, some, &mut self.weight);
        self.receivers.from = self.position;
        if self.is_glossy {
            gather(&vertices.specular, some, &mut self.specular);
            gather(&vertices.to_viewer, some, &mut self.to_viewer);
            for (lane, &vertex) in some.iter().enumerate() {
                self.receivers.shininess[lane] = vertices.shininess[vertex as usize];
            }
            let Self {
                receivers,
                diffuse,
                specular,
                to_viewer,
                ..
            } = self;
            reflect_like(receivers, diffuse, specular, to_viewer);
        }
    }

    /// The vertices, lane by lane.
    #[inline(always)]
    pub fn askers(&self) -> impl Iterator<Item = usize> + use<> {
        let (askers, count) = (self.askers, self.count_of_askers);
        askers.into_iter().take(count).map(|vertex| vertex as usize)
    }

    /// How many points of a light share what each vertex reflects.
    #[inline(always)]
    pub fn share(&mut self, counts: &[u32]) {
        for (lane, vertex) in self.askers().enumerate() {
            self.count[lane] = counts[vertex] as f32;
        }
    }

    /// Where each vertex is in the frame that moves with a light.
    #[inline(always)]
    pub fn stand_at(&mut self, from: impl Fn(usize) -> Vec3) {
        for (lane, vertex) in self.askers().enumerate() {
            set_column(&mut self.receivers.from, lane, from(vertex));
        }
    }

    /// The numbers that choose the places of those vertices' next questions.
    #[inline(always)]
    pub fn draw(&mut self, numbers: &Pairs, question: impl Fn(usize) -> usize) {
        for (lane, vertex) in self.askers().enumerate() {
            [self.numbers[0][lane], self.numbers[1][lane]] = numbers.get(question(vertex));
        }
    }
}

/// All questions that are answered in columns.
#[derive(Default)]
pub(in crate::trace) struct Columns {
    /// So many of them.
    questions: Vec<Questions<LANES>>,
    count: usize,
    matt: Vec<u32>,
    glossy: Vec<u32>,
}

impl Columns {
    /// What vertices ask that light can add something to, but for those beside edges.
    pub fn gather(&mut self, weights: &Vectors, vertices: &Vertices) {
        self.matt.clear();
        self.glossy.clear();
        for vertex in 0..vertices.len() {
            if weights.get(vertex) == Vec3::ZERO || vertices.is_near_edge[vertex] {
                continue;
            }
            let alike = if vertices.has_highlight(vertex) {
                &mut self.glossy
            } else {
                &mut self.matt
            };
            alike.push(vertex as u32);
        }
        self.count = 0;
        for (alike, is_glossy) in [(&self.matt, false), (&self.glossy, true)] {
            for some in alike.chunks(LANES) {
                if self.questions.len() == self.count {
                    self.questions.push(Questions::nothing(is_glossy));
                }
                let questions = &mut self.questions[self.count];
                questions.is_glossy = is_glossy;
                questions.ask(some, weights, vertices);
                self.count += 1;
            }
        }
    }

    /// How many points of a light share what each vertex reflects.
    pub fn share(&mut self, counts: &[u32]) {
        for questions in self.all() {
            questions.share(counts);
        }
    }

    pub fn all(&mut self) -> &mut [Questions<LANES>] {
        &mut self.questions[..self.count]
    }
}

/// Vectors into the first lanes. Most vertices come in turn: those are copied at once.
#[inline(always)]
fn gather(vectors: &Vectors, of: &[u32], lanes: &mut [[f32; LANES]; 3]) {
    let first = of[0];
    let in_turn = (first..).zip(of).all(|(turn, &vertex)| turn == vertex);
    for (lanes, column) in lanes.iter_mut().zip(vectors.columns()) {
        if in_turn {
            lanes[..of.len()].copy_from_slice(&column[first as usize..][..of.len()]);
        } else {
            for (lane, &vertex) in lanes.iter_mut().zip(of) {
                *lane = column[vertex as usize];
            }
        }
    }
}
vectorized! {
    /// How surfaces with a highlight reflect, as choosing points for them takes it.
    fn reflect_like(
        receivers: &mut Receivers<LANES>,
        diffuse: &[[f32; LANES]; 3],
        specular: &[[f32; LANES]; 3],
        to_viewer: &[[f32; LANES]; 3],
    ) {
        for i in 0..LANES {
            let [diffuse, specular, to_viewer] =
                [diffuse, specular, to_viewer].map(|columns| column_vector(columns, i));
            receivers.reflect_like(i, diffuse, specular, to_viewer);
        }
    }
}
