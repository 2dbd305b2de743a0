//! What each instruction set of a machine answers.

use glam::Vec3;

use super::super::geometry::aggregate::Places;
use super::super::kernel::wide::{InstructionSet, Query, answer_with_each};
use super::super::traversal::levels::{
    AnyOf, Closest, OneLevel, OneMesh, Passing, TwoLevels, arranged,
};
use crate::bvh::{Aggregate, Hit, Order, Ray, Transmittances};

/// Questions to an aggregate.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) aggregate: &'a Aggregate,
    pub(super) order: Order,
    pub(super) rays: &'a [Ray],
    /// What crossings let through.
    pub(super) through: fn(&Hit) -> Vec3,
}

/// What [`Aggregate::closest_hits_in`], [`Aggregate::occlusions_in`] and [`Aggregate::transmittances_in`] find.
pub(super) struct Answered {
    pub(super) hits: Vec<Option<Hit>>,
    pub(super) occluded: Vec<bool>,
    pub(super) passing: Transmittances,
}

impl Asked<'_> {
    /// Checks the answers of each instruction set of this machine; the names of those that it lacks.
    pub(super) fn with_each(self, check: impl FnMut(&str, Answered)) -> Vec<&'static str> {
        answer_with_each(|| self, check)
    }
}

impl Query for Asked<'_> {
    type Answer = Answered;

    #[inline(always)]
    fn ask<S: InstructionSet>(self) -> Answered {
        let Self {
            aggregate,
            order,
            rays,
            through,
        } = self;
        let mut answered = Answered {
            hits: vec![None; rays.len()],
            occluded: vec![false; rays.len()],
            passing: Transmittances::default(),
        };
        answered.passing.reset(rays.len());
        let through = &mut |_, hit: &Hit| through(hit);
        let (hits, occluded) = (&mut answered.hits[..], &mut answered.occluded[..]);
        let found = &mut answered.passing;
        arranged!(aggregate, of => {
            Closest { of, order, rays, hits }.ask::<S>();
            AnyOf { of, order, rays, occluded }.ask::<S>();
            Passing { of, aggregate, order, rays, through, found }.ask::<S>();
        });
        answered
    }
}
