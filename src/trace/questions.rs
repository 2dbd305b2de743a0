//! What vertices ask of one light, in columns.

use super::numbers::Pairs;
use super::receiver::Receivers;
use super::vectors::{Vectors, column_vector, set_column};
use super::vertices::Vertices;
use crate::instruction_sets::vectorized;
use glam::Vec3;

/// Questions that are answered together: what fills the widest vectors.
pub(super) const LANES: usize = 32;

/// Points of one light that vertices ask for: matt ones, or ones with a highlight.
pub(super) struct Questions<const N: usize> {
    pub is_glossy: bool,
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

    /// Puts vertices into the first lanes, each with how many points share what it reflects: `from` says where a vertex is
    /// in the frame that moves with the light, where any does. The other lanes keep what they had.
    #[inline(always)]
    pub fn ask(
        &mut self,
        some: &[u32],
        counts: &[u32],
        weights: &Vectors,
        vertices: &Vertices,
        from: Option<&impl Fn(usize) -> Vec3>,
    ) {
        gather(&vertices.normal, some, &mut self.receivers.normal);
        gather(&vertices.position, some, &mut self.position);
        gather(&vertices.error, some, &mut self.error);
        gather(&vertices.triangle_normal, some, &mut self.triangle_normal);
        gather(&vertices.geometric_normal, some, &mut self.geometric_normal);
        gather(&vertices.diffuse, some, &mut self.diffuse);
        gather(weights, some, &mut self.weight);
        for (count, &vertex) in self.count.iter_mut().zip(some) {
            *count = counts[vertex as usize] as f32;
        }
        match from {
            None => self.receivers.from = self.position,
            Some(from) => {
                for (lane, &vertex) in some.iter().enumerate() {
                    set_column(&mut self.receivers.from, lane, from(vertex as usize));
                }
            }
        }
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

    /// The numbers that choose the places of those vertices' next questions.
    #[inline(always)]
    pub fn draw(&mut self, numbers: &Pairs, questions: impl Iterator<Item = usize>) {
        for (lane, question) in questions.enumerate() {
            [self.numbers[0][lane], self.numbers[1][lane]] = numbers.get(question);
        }
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
