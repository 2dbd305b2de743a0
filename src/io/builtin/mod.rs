//! The built-in scenes: spawned by code, so that a bare binary has something to show.
//!
//! Their objects are generated shapes, so each of them can be saved as a scene file.

mod cornell;
mod first;
mod marbles;
mod meshes;
mod showcase;
mod spheres;
mod stage;

#[cfg(test)]
mod tests;

use bevy::ecs::world::World;

/// A scene that comes with the program.
pub struct BuiltinScene {
    /// What the command line calls it.
    pub name: &'static str,
    /// What it is, for the list of scenes.
    pub sentence: &'static str,
    /// Spawns its entities, numbered from 1 in their order, and replaces `Environment` and
    /// `RenderSettings`. For a world that holds no scene yet.
    pub spawn: fn(&mut World),
}

/// The scene that is shown when none is asked for.
pub const DEFAULT: &str = "cornell-box";

/// All of them, from simple to rich.
pub const SCENES: &[BuiltinScene] = &[
    BuiltinScene {
        name: "triangle",
        sentence: "One triangle and a point light: the smallest scene there is.",
        spawn: first::triangle,
    },
    BuiltinScene {
        name: "cube-segment-light",
        sentence: "A cube under a segment light that goes from amber to blue, with soft shadows.",
        spawn: first::cube_segment_light,
    },
    BuiltinScene {
        name: "textured-cube",
        sentence: "A cube that wears a test texture, on a checkered floor.",
        spawn: first::textured_cube,
    },
    BuiltinScene {
        name: "cornell-box",
        sentence: "Cornell's box by its published measurements, the tall block a mirror, with a point light.",
        spawn: cornell::with_point_light,
    },
    BuiltinScene {
        name: "cornell-box-parallelogram-light",
        sentence: "The same box with its published ceiling light, and soft shadows.",
        spawn: cornell::with_parallelogram_light,
    },
    BuiltinScene {
        name: "head",
        sentence: "A head of a thousand triangles between three point lights.",
        spawn: meshes::head,
    },
    BuiltinScene {
        name: "teapot",
        sentence: "Newell's teapot, glazed, under sun and sky.",
        spawn: meshes::teapot,
    },
    BuiltinScene {
        name: "knot",
        sentence: "A golden rope of 87 thousand triangles, tied in a trefoil knot.",
        spawn: meshes::knot,
    },
    BuiltinScene {
        name: "spheres",
        sentence: "Spheres from matte to mirror under the sky.",
        spawn: spheres::spheres,
    },
    BuiltinScene {
        name: "marbles",
        sentence: "Marbles through a lens while one rolls past: blur by depth and by motion, brushed steel, tinted glass.",
        spawn: marbles::marbles,
    },
    BuiltinScene {
        name: "showcase",
        sentence: "Everything at once: textures, mirrors, all four kinds of light, the sky, two cameras.",
        spawn: showcase::showcase,
    },
];

/// What a new scene begins with: a cube on a floor, a lamp above it and a camera that sees them. As
/// [`BuiltinScene::spawn`].
pub(super) fn new_scene(world: &mut World) {
    first::new_scene(world);
}

/// The scene of that name.
pub fn find(name: &str) -> Option<&'static BuiltinScene> {
    SCENES.iter().find(|scene| scene.name == name)
}
