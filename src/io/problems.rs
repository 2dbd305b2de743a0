use super::error::FileError;
use bevy::prelude::{Entity, Resource};

/// What could not be loaded since the scene was opened. What had been loaded before is still shown.
#[derive(Resource, Debug, Default)]
pub struct LoadProblems {
    /// The newest last.
    pub problems: Vec<LoadProblem>,
}

/// A source that could not be loaded.
#[derive(Debug)]
pub struct LoadProblem {
    /// The entity that names it; none for the environment.
    pub entity: Option<Entity>,
    /// What it was to become: [`Self::MESH`], [`Self::PICTURE`] or [`Self::ENVIRONMENT`].
    pub what: &'static str,
    /// The file, the place in it, and what would help.
    pub error: FileError,
}

impl LoadProblem {
    /// An object's mesh.
    pub const MESH: &'static str = "mesh";
    /// A material's picture.
    pub const PICTURE: &'static str = "picture";
    /// The environment's map.
    pub const ENVIRONMENT: &'static str = "environment map";
}

impl LoadProblems {
    pub(crate) fn add(&mut self, entity: Option<Entity>, what: &'static str, error: FileError) {
        self.problems.push(LoadProblem {
            entity,
            what,
            error,
        });
    }

    /// Before a source is tried again.
    pub(crate) fn forget(&mut self, entity: Entity, what: &str) {
        self.problems
            .retain(|problem| problem.entity != Some(entity) || problem.what != what);
    }

    pub(crate) fn forget_environment(&mut self) {
        self.problems
            .retain(|problem| problem.what != LoadProblem::ENVIRONMENT);
    }
}
