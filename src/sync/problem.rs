use super::{MeshFault, TextureFault};
use crate::bvh::SingularTransform;
use crate::scene::{RangeProblem, RenderSettings, SceneId, range_problems};
use bevy::ecs::name::Name;
use bevy::math::Vec3;
use std::sync::Arc;

/// Something of the scene that cannot be traced as it is.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{subject}: {fault}")]
pub struct SyncProblem {
    /// Whose it is: `light 7 "lamp"`, or `settings`.
    pub subject: Arc<str>,
    /// The entity's number; unassigned where it is none's.
    pub id: SceneId,
    /// What is wrong, and what was done about it.
    pub fault: Fault,
}

/// What is wrong with an entity, and what was done about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The transform cannot be traced through.
    #[error("{0}; left out")]
    Transform(SingularTransform),
    /// The mesh cannot be traced.
    #[error("its mesh {0}; left out")]
    Mesh(MeshFault),
    /// Single triangles of the mesh cannot be traced.
    #[error(
        "{count} of its triangles have corners that are not finite, or farther away than 1e12; they are left out"
    )]
    TrianglesLeftOut {
        /// How many.
        count: u32,
    },
    /// A texture cannot be read.
    #[error("its {field} {fault}; drawn without it")]
    Texture {
        /// Which map.
        field: &'static str,
        /// Why.
        fault: TextureFault,
    },
    /// A picture holds what light cannot have.
    #[error(
        "{count} texels of its {field} are not finite or less than 0; {largest:?} is used for what is infinite, else 0"
    )]
    Texels {
        /// Which map.
        field: &'static str,
        /// How many.
        count: u64,
        /// The largest finite number.
        largest: f32,
    },
    /// The material that an object names is not there.
    #[error("the material that it names is gone; drawn with its own")]
    NoMaterial,
    /// A number is NaN or infinite.
    #[error("its {field} is not a finite number; correct it")]
    NotFinite {
        /// Which.
        field: &'static str,
    },
    /// A lamp is larger than can be computed with.
    #[error("its {field} is more than {most:e}; left out")]
    TooLarge {
        /// Its length in m, or its area in m².
        field: &'static str,
        /// The most.
        most: f64,
    },
    /// It moves beyond what can be traced while the shutter is open.
    #[error(
        "its velocity, together with those of its parents, is {velocity}, not a finite number or more than 1e12; left out"
    )]
    Velocity {
        /// In the world.
        velocity: Vec3,
    },
    /// A number is outside its range; the nearest one inside was taken.
    #[error("its {field} is {value}, out of range; {used} is used")]
    OutOfRange {
        /// Which.
        field: &'static str,
        /// What it is.
        value: f32,
        /// What was taken.
        used: f32,
    },
    /// A length, area or angle is zero, so there is nothing to trace.
    #[error("its {field} is nothing; left out")]
    Degenerate {
        /// Which.
        field: &'static str,
    },
    /// A cone is so narrow that it lights single points, or nothing. It is traced as it is.
    #[error(
        "its {field} is {angle:e} rad, less than what directions are told apart by (1e-7 rad): it lights single points or nothing"
    )]
    Narrow {
        /// Which.
        field: &'static str,
        /// In radians.
        angle: f32,
    },
    /// Something of another program's component has nothing here that it could become.
    #[error("{0}")]
    LeftOut(Arc<str>),
    /// A render setting is out of range.
    #[error("{0}")]
    Setting(RangeProblem),
}

impl SyncProblem {
    pub(super) fn new(kind: &str, id: SceneId, name: Option<&Name>, fault: Fault) -> Self {
        let subject = match name {
            Some(name) => format!("{kind} {} \"{}\"", id.0, name.as_str()),
            None => format!("{kind} {}", id.0),
        };
        Self {
            subject: subject.into(),
            id,
            fault,
        }
    }

    pub(super) fn of_settings(settings: &RenderSettings) -> Vec<Self> {
        range_problems(settings)
            .into_iter()
            .map(|problem| Self {
                subject: "settings".into(),
                id: SceneId::default(),
                fault: Fault::Setting(problem),
            })
            .collect()
    }
}
