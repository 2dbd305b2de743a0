//! What surfaces reflect of points of one light, and the shadow rays there: a stage over columns.

use super::light_columns::Points;
use super::questions::{LANES, Questions};
use crate::bvh::beyond_error;
use crate::instruction_sets::vectorized;
use crate::trace::math::vectors::{column_vector, set_column};
use crate::trace::surfaces::shading::{Reflector, lambert, phong};
use glam::Vec3;

/// What the light adds if nothing is in the way, and the ray that finds out.
pub(in crate::trace) struct Replies<const N: usize> {
    pub value: [[f32; N]; 3],
    pub origin: [[f32; N]; 3],
    /// All the way to the point of the light; a unit vector where that is infinitely far.
    pub along: [[f32; N]; 3],
    /// Not zero where lengths leave f32's range: to be asked by themselves.
    pub is_rare: [u32; N],
}
impl Replies<LANES> {
    /// What the askers reflect of the points.
    pub fn of(points: &Points<LANES>, questions: &Questions<LANES>) -> Self {
        if questions.is_glossy {
            reflect_glossy(points, questions)
        } else {
            reflect_matt(points, questions)
        }
    }
}

vectorized! {
    fn reflect_matt(points: &Points<LANES>, questions: &Questions<LANES>) -> Replies<LANES> {
        let mut replies = Replies::nothing(&points.is_rare);
        for i in 0..LANES {
            let reflected = lambert(
                column_vector(&questions.diffuse, i),
                column_vector(&questions.receivers.normal, i),
                column_vector(&questions.geometric_normal, i),
                column_vector(&points.direction, i),
                column_vector(&points.arriving, i),
            );
            replies.set(points, questions, i, reflected);
        }
        replies
    }

    fn reflect_glossy(points: &Points<LANES>, questions: &Questions<LANES>) -> Replies<LANES> {
        let mut replies = Replies::nothing(&points.is_rare);
        for i in 0..LANES {
            let reflector = Reflector {
                diffuse: column_vector(&questions.diffuse, i),
                specular: column_vector(&questions.specular, i),
                shininess: questions.receivers.shininess[i],
                normal: column_vector(&questions.receivers.normal, i),
                geometric_normal: column_vector(&questions.geometric_normal, i),
                to_viewer: column_vector(&questions.to_viewer, i),
            };
            let direction = column_vector(&points.direction, i);
            let reflected = phong(&reflector, direction, column_vector(&points.arriving, i));
            replies.set(points, questions, i, reflected);
        }
        replies
    }
}

impl<const N: usize> Replies<N> {
    #[inline(always)]
    fn nothing(is_rare: &[u32; N]) -> Self {
        Self {
            value: [[0.0; N]; 3],
            origin: [[0.0; N]; 3],
            along: [[0.0; N]; 3],
            is_rare: *is_rare,
        }
    }

    /// The reply to one question, of which the surface reflects so much.
    #[inline(always)]
    fn set(&mut self, points: &Points<N>, questions: &Questions<N>, i: usize, reflected: Vec3) {
        let weight = column_vector(&questions.weight, i) / questions.count[i];
        set_column(&mut self.value, i, weight * reflected);
        let direction = column_vector(&points.direction, i);
        let position = column_vector(&questions.position, i);
        let origin = beyond_error(
            position,
            column_vector(&questions.error, i),
            column_vector(&questions.triangle_normal, i),
            direction,
        );
        set_column(&mut self.origin, i, origin);
        // From the moved origin to the light itself, so that the ray still ends there.
        let distance = points.distance[i];
        let to_light = distance * direction - (origin - position);
        let is_far = distance == f32::INFINITY;
        set_column(
            &mut self.along,
            i,
            if is_far { direction } else { to_light },
        );
    }
}
