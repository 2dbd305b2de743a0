//! What is drawn: a switch for every system, and one for all.

use crate::scene::Builder;
use bevy::ecs::{reflect::ReflectResource, resource::Resource};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

/// What is drawn over the picture.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::inspect"]
pub struct InspectSettings {
    /// The master switch: off hides everything and keeps every other setting.
    pub on: bool,
    /// Boxes of the trees.
    pub boxes: BoxSettings,
    /// Boxes and visits of two builders' trees, side by side.
    pub pair: PairSettings,
    /// The debug rays.
    pub rays: RaySettings,
    /// Normals of the meshes.
    pub normals: NormalSettings,
    /// The lights themselves, with their colours.
    pub lights: bool,
    /// Aperture, focus plane and the camera's field of view.
    pub lens: bool,
    /// Where moving things stand when the shutter opens and closes.
    pub motion: bool,
    /// The discs of blurred reflections and transmissions, at the hits of the debug rays.
    pub lobes: bool,
    /// Where the samples of a pixel lie, as a 2-D inset.
    pub pattern: PatternSettings,
    /// No system draws more lines than this, 1 to 10^7: what is left out is said.
    pub max_lines: u32,
}

impl Default for InspectSettings {
    fn default() -> Self {
        Self {
            on: true,
            boxes: BoxSettings::default(),
            pair: PairSettings::default(),
            rays: RaySettings::default(),
            normals: NormalSettings::default(),
            lights: false,
            lens: false,
            motion: false,
            lobes: false,
            pattern: PatternSettings::default(),
            max_lines: 100_000,
        }
    }
}

/// Which boxes, and how they look.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct BoxSettings {
    /// Draws them.
    pub on: bool,
    /// Of which form of the trees.
    pub form: TreeForm,
    /// Which ones.
    pub choice: BoxChoice,
    /// With `Levels`: the first level, the root's being 0.
    pub from_level: u32,
    /// With `Levels`: the last level.
    pub to_level: u32,
    /// With `Leaf`: which one, from 0, in the order of the leaves.
    pub leaf: u32,
    /// With `Path`: the triangle of `object` to which the path goes.
    pub triangle: u32,
    /// Only of the object with this `SceneId`; 0: of all.
    pub object: u64,
    /// Which trees.
    pub trees: TreeChoice,
    /// What the colours say.
    pub color: BoxColor,
    /// The plane that parts each drawn node's children.
    pub split_planes: bool,
    /// The triangles of drawn leaves.
    pub triangles: bool,
}

impl Default for BoxSettings {
    fn default() -> Self {
        Self {
            on: false,
            form: TreeForm::Binary,
            choice: BoxChoice::Levels,
            from_level: 0,
            to_level: 4,
            leaf: 0,
            triangle: 0,
            object: 0,
            trees: TreeChoice::Both,
            color: BoxColor::Level,
            split_planes: false,
            triangles: false,
        }
    }
}

/// Two trees over the same view: on its left the boxes, and what the debug rays visit, in the trees
/// of one builder, on its right in those of another. What is traced stays what it is. The window
/// shows them; where there is none nothing is drawn of them.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct PairSettings {
    /// Shows them, in place of the boxes and visits of the trees that are traced.
    pub on: bool,
    /// Whose trees are on the left.
    pub left: Builder,
    /// Whose trees are on the right.
    pub right: Builder,
}

impl Default for PairSettings {
    fn default() -> Self {
        Self {
            on: false,
            left: Builder::Median,
            right: Builder::Ploc,
        }
    }
}

/// The forms that a tree has.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum TreeForm {
    /// Two children a node, as the builder made it.
    #[default]
    Binary,
    /// Up to eight children a node: some of the binary form's nodes, the levels between them left out. Rays
    /// are traced through it, those of pictures and debug rays. Its levels are drawn, by level or by visits.
    Wide,
}

/// Which boxes.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum BoxChoice {
    /// A range of levels.
    #[default]
    Levels,
    /// One leaf, with its triangles.
    Leaf,
    /// From the root to the leaf that holds a triangle.
    Path,
}

/// Which trees, where there are two levels of them.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum TreeChoice {
    /// The one over the objects, and those of the meshes.
    #[default]
    Both,
    /// The one over the objects alone (with one level: over all triangles).
    Top,
    /// Those of the meshes alone.
    Meshes,
}

/// What a box's colour says.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum BoxColor {
    /// Its level, from the root's dark to the deepest drawn one's bright.
    #[default]
    Level,
    /// Triangles of a leaf; inner nodes are grey.
    LeafSize,
    /// Its part of the tree's SAH cost.
    Cost,
    /// How often the debug rays entered it: nodes that are left out of the wide form never.
    Visits,
}

/// Which rays, and what of them.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct RaySettings {
    /// Draws them.
    pub on: bool,
    /// From the camera.
    pub camera: bool,
    /// Mirrored, sharp or blurred.
    pub mirror: bool,
    /// Through transparent and translucent surfaces.
    pub transmission: bool,
    /// To point lights.
    pub shadow: bool,
    /// To points of area lights.
    pub light_samples: bool,
    /// Those that met nothing: in the colour of what they carry, or in red.
    pub misses: MissColor,
    /// No ray behind more surfaces than this, 0 to 1000.
    pub max_depth: u32,
    /// Boxes of the nodes that the drawn rays entered, white.
    pub visited: bool,
    /// Boxes that were hit but lay behind a nearer hit, red.
    pub pruned: bool,
    /// Outlines of the triangles that were hit.
    pub hit_triangles: bool,
    /// Normals at the hits.
    pub hit_normals: bool,
    /// Visited and pruned nodes of this ray only, by its index; 2^32 - 1: of all drawn rays.
    pub nodes_of: u32,
}

impl Default for RaySettings {
    fn default() -> Self {
        Self {
            on: true,
            camera: true,
            mirror: true,
            transmission: true,
            shadow: true,
            light_samples: true,
            misses: MissColor::Carried,
            max_depth: 50,
            visited: false,
            pruned: false,
            hit_triangles: false,
            hit_normals: false,
            nodes_of: u32::MAX,
        }
    }
}

/// The colour of a ray that met nothing.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum MissColor {
    /// What it carries: the background's or the map's.
    #[default]
    Carried,
    /// Red.
    Red,
}

/// Normals of the meshes.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct NormalSettings {
    /// Draws them.
    pub on: bool,
    /// Between the vertices: 0 none, 1 one on each edge, 2 three on each edge and three inside.
    pub between: u32,
    /// Of the object with this `SceneId` only; 0: of all.
    pub object: u64,
    /// How long they are on the screen, in pixels.
    pub length: f32,
    /// Of those within a square of this many pixels only the nearest is drawn.
    pub spacing: f32,
}

impl Default for NormalSettings {
    fn default() -> Self {
        Self {
            on: false,
            between: 0,
            object: 0,
            length: 18.0,
            spacing: 6.0,
        }
    }
}

/// Which two numbers of each sample a point of the inset shows.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct PatternSettings {
    /// Draws it.
    pub on: bool,
    /// The number to the right.
    pub x: Dimension,
    /// The number downwards.
    pub y: Dimension,
    /// For `LightU` and `LightV`: the light's `SceneId`; 0 for the dome.
    pub light: u64,
}

impl Default for PatternSettings {
    fn default() -> Self {
        Self {
            on: false,
            x: Dimension::PixelX,
            y: Dimension::PixelY,
            light: 0,
        }
    }
}

/// One of the numbers of a sample, as its camera ray and its first hit use them.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash, Default, serde::Serialize)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum Dimension {
    /// The place in the pixel, from the left.
    #[default]
    PixelX,
    /// The place in the pixel, from the top.
    PixelY,
    /// The first number of the place on the lens.
    LensU,
    /// The second one.
    LensV,
    /// When the shutter is open.
    Time,
    /// The first of the numbers that choose a point of a light.
    LightU,
    /// The second one.
    LightV,
    /// The first number of the place in a blurred reflection's disc.
    GlossU,
    /// The second one.
    GlossV,
}

impl Dimension {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::PixelX,
        Self::PixelY,
        Self::LensU,
        Self::LensV,
        Self::Time,
        Self::LightU,
        Self::LightV,
        Self::GlossU,
        Self::GlossV,
    ];
}
