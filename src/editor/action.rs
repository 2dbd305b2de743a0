//! What can be asked of the editor in a message: a command by its id, or what needs a further word.

use crate::scene::{SceneId, Shape};
use bevy::ecs::message::Message;
use bevy::math::{Vec2, Vec3};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::PathBuf;

/// Something that is asked of the editor by program, by its panels or by a script.
#[derive(Message, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// A row of the [table of commands](super::command::CommandTable), by its id.
    #[serde(skip)]
    Run(Cow<'static, str>),
    /// Opens a file, or a built-in scene by its name.
    Open(PathBuf),
    /// Writes the scene to this file.
    SaveAs(PathBuf),
    /// Adds a model file's content to the open scene, where it was dropped in the window, in logical pixels; in the
    /// middle of the view with `None`.
    Import(PathBuf, #[serde(default)] Option<Vec2>),
    /// Adds one thing where the view looks.
    Add(Addition),
    /// Selects these and no others.
    Select(Vec<SceneId>),
    /// Gives an entity a name.
    Rename(SceneId, String),
    /// Makes the second the parent of the first ones; `None`: they get no parent. Places in the world stay.
    Reparent(Vec<SceneId>, Option<SceneId>),
    /// Gives the objects among the first ones a shared material, the second.
    AssignMaterial(Vec<SceneId>, SceneId),
    /// Looks through this camera; `None`: freely again.
    LookThrough(Option<SceneId>),
    /// Shoots a debug ray through a pixel of the traced view, column and row from its top left.
    ShootPixel(u32, u32),
}

impl Action {
    /// Asks for a command without more words: `Action::run("edit.undo")`.
    pub fn run(id: impl Into<Cow<'static, str>>) -> Self {
        Self::Run(id.into())
    }
}

/// What can be added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "their names are those of the components")]
pub enum Addition {
    /// By the name of the shape, as in [`shapes`].
    Shape(String),
    /// An empty place that others can be children of.
    Group,
    PointLamp,
    DirectionalLamp,
    SegmentLamp,
    ParallelogramLamp,
    Camera,
    /// A material that objects can share.
    Material,
}

/// Along which axis the view looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "named as in every modeller")]
pub enum Axis {
    Front,
    Back,
    Left,
    Right,
    Top,
    Bottom,
}

/// The shapes that can be added, by name; about a metre in size, but for the ground, the teapot, the head
/// and the knot.
pub fn shapes() -> Vec<(&'static str, Shape)> {
    vec![
        ("Cuboid", Shape::Cuboid { size: Vec3::ONE }),
        (
            "Sphere",
            Shape::Sphere {
                radius: 0.5,
                segments: 64,
                rings: 32,
            },
        ),
        (
            "Cylinder",
            Shape::Cylinder {
                radius: 0.5,
                height: 1.0,
                segments: 64,
            },
        ),
        (
            "Torus",
            Shape::Torus {
                major_radius: 0.4,
                minor_radius: 0.15,
                segments: 64,
                sides: 32,
            },
        ),
        (
            "Ground",
            Shape::Ground {
                size: Vec2::splat(4.0),
                tile: Vec2::ONE,
            },
        ),
        (
            "Quad",
            Shape::Quad {
                corner: Vec3::new(-0.5, -0.5, 0.0),
                edges: [Vec3::X, Vec3::Y],
            },
        ),
        (
            "Quadrilateral",
            Shape::Quadrilateral {
                corners: [
                    Vec3::new(-0.5, -0.5, 0.0),
                    Vec3::new(0.5, -0.5, 0.0),
                    Vec3::new(0.3, 0.5, 0.0),
                    Vec3::new(-0.3, 0.5, 0.0),
                ],
            },
        ),
        (
            "Triangle",
            Shape::Triangle {
                corners: [
                    Vec3::new(-0.5, -0.5, 0.0),
                    Vec3::new(0.5, -0.5, 0.0),
                    Vec3::new(0.0, 0.5, 0.0),
                ],
            },
        ),
        (
            "Prism",
            Shape::Prism {
                base: vec![
                    Vec2::new(-0.5, -0.3),
                    Vec2::new(0.5, -0.3),
                    Vec2::new(0.0, 0.6),
                ],
                height: 1.0,
            },
        ),
        ("Teapot", Shape::Teapot { divisions: 8 }),
        (
            "Head",
            Shape::Head {
                segments: 32,
                rings: 16,
            },
        ),
        (
            "Knot",
            Shape::Knot {
                p: 2,
                q: 3,
                tube_radius: 0.15,
                displacement: 0.2,
                segments: 256,
                sides: 32,
            },
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_need_not_say_where_a_model_is_dropped() {
        let read: Action = ron::from_str(r#"Import("a.obj")"#).unwrap();
        assert_eq!(read, Action::Import("a.obj".into(), None));
    }
}
