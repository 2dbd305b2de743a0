//! What is drawn: a switch for every system, and one for all.

use crate::scene::Builder;
use crate::scene::schema::{Label, Quantity, documented};
use bevy::ecs::{reflect::ReflectResource, resource::Resource};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

documented! {
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
        /// Aperture, focus plane and field of view of the camera.
        pub lens: bool,
        /// Where moving things stand when the shutter opens and closes.
        pub motion: bool,
        /// The discs of blurred reflections and transmissions at the debug rays' hits.
        #[reflect(@Label("Blur discs"))]
        pub lobes: bool,
        /// Where the samples of a pixel lie, as a 2-D inset.
        pub pattern: PatternSettings,
        /// No system draws more lines than this; what is left out is said.
        #[reflect(@Quantity::within(1.0, 1e7, "").step(100.0), @Label("Most lines"))]
        pub max_lines: u32,
    }
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

documented! {
    /// Which boxes, and how they look.
    #[derive(Reflect, Clone, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct BoxSettings {
        /// Boxes of the trees' nodes.
        #[reflect(@Label("Draw"))]
        pub on: bool,
        /// Binary: as the builder made them; wide: up to sixteen children a node, through which pictures and debug rays are
        /// traced.
        pub form: TreeForm,
        /// A range of levels, one leaf, or the way to a triangle.
        #[reflect(@Label("Which"))]
        pub choice: BoxChoice,
        /// The first level that is drawn; the root's is 0.
        ///
        /// With `Levels`.
        pub from_level: u32,
        /// The last level that is drawn.
        ///
        /// With `Levels`.
        pub to_level: u32,
        /// Which leaf, from 0, in the order in which the trees have them; A and S step.
        ///
        /// With `Leaf`.
        pub leaf: u32,
        /// Which triangle of the object, from 0, in the mesh's own order.
        ///
        /// With `Path`: to which the path goes.
        pub triangle: u32,
        /// Only of the object with this `SceneId`; 0: of all.
        pub object: u64,
        /// The one over the objects, those of the meshes, or both.
        pub trees: TreeChoice,
        /// What a box's colour says: dark is little, bright is much.
        #[reflect(@Label("Colour"))]
        pub color: BoxColor,
        /// The plane between each drawn node's children, with its axis: x red, y green, z blue.
        pub split_planes: bool,
        /// The triangles of drawn leaves.
        pub triangles: bool,
    }
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

documented! {
    /// Two views of the same: over the left one the boxes, and what the debug rays visit, in the trees
    /// of one builder, over the right one in those of another. What is traced stays what it is. The window
    /// shows them; where there is none nothing is drawn of them.
    #[derive(Reflect, Clone, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct PairSettings {
        /// Two views from one place, each with the picture: over the left one the boxes of one builder's trees, over the
        /// right one another's, and below each what there is to count.
        #[reflect(@Label("Show"))]
        pub on: bool,
        /// Whose trees are on the left.
        pub left: Builder,
        /// Whose trees are on the right.
        pub right: Builder,
    }
}

impl Default for PairSettings {
    fn default() -> Self {
        Self {
            on: false,
            left: Builder::Median,
            right: Builder::default(),
        }
    }
}

documented! {
    /// The forms that a tree has.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum TreeForm {
        /// Two children a node, as the builder made it.
        #[default]
        Binary,
        /// Up to sixteen children a node, made of the binary form: what rays are traced through.
        ///
        /// Some of the binary form's nodes, the levels between them left out; rays of pictures and debug rays go through it.
        /// Its levels are drawn, by level or by visits.
        Wide,
    }
}

documented! {
    /// Which boxes.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum BoxChoice {
        /// All nodes from one level to another.
        #[default]
        Levels,
        /// A single leaf, by its number, with its triangles.
        #[reflect(@Label("One leaf"))]
        Leaf,
        /// From the root to the leaf that holds a triangle.
        #[reflect(@Label("Way to a triangle"))]
        Path,
    }
}

documented! {
    /// Which trees, where there are two levels of them.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum TreeChoice {
        /// The one over the objects, and those of the meshes.
        #[default]
        Both,
        /// The one over the objects alone (with one level: over all triangles).
        #[reflect(@Label("Over the objects"))]
        Top,
        /// Those of the meshes alone, whose leaves are triangles.
        #[reflect(@Label("Of the meshes"))]
        Meshes,
    }
}

documented! {
    /// What a box's colour says.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum BoxColor {
        /// How deep the node is: from the root's dark to the deepest drawn one's bright.
        #[default]
        Level,
        /// How many triangles or objects a leaf holds; inner nodes are grey.
        LeafSize,
        /// What the node adds to the cost of a random ray.
        #[reflect(@Label("SAH cost"))]
        Cost,
        /// How many of the debug ray's rays entered the node; never one that the wide form leaves out.
        Visits,
    }
}

documented! {
    /// Which rays, and what of them.
    #[derive(Reflect, Clone, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct RaySettings {
        /// The debug rays: point at the picture and press R.
        #[reflect(@Label("Draw"))]
        pub on: bool,
        /// From the camera.
        pub camera: bool,
        /// Mirrored, sharp or blurred.
        pub mirror: bool,
        /// Through transparent and translucent surfaces.
        pub transmission: bool,
        /// To point lights, in the colour that arrives.
        pub shadow: bool,
        /// To points of area lights.
        pub light_samples: bool,
        /// Those that met nothing: in the colour of what they carry, or in red.
        pub misses: MissColor,
        /// No ray behind more surfaces than this.
        #[reflect(@Quantity::within(0.0, 1000.0, "").shown(0.0, 50.0), @Label("Bounces"))]
        pub max_depth: u32,
        /// Boxes of the nodes that the drawn rays entered, white.
        #[reflect(@Label("Visited nodes"))]
        pub visited: bool,
        /// Boxes that were hit but lay behind a nearer hit, red.
        #[reflect(@Label("Pruned nodes"))]
        pub pruned: bool,
        /// Outlines of the triangles that were hit.
        pub hit_triangles: bool,
        /// Normals at the hits.
        pub hit_normals: bool,
        /// Visited and pruned nodes of this ray only, by its index; 2^32 - 1: of all drawn rays.
        pub nodes_of: u32,
    }
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

documented! {
    /// The colour of a ray that met nothing.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum MissColor {
        /// The light that the ray carries: the background's, or that of its picture.
        #[default]
        Carried,
        /// Red, whatever the ray carries.
        Red,
    }
}

documented! {
    /// Normals of the meshes.
    #[derive(Reflect, Clone, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct NormalSettings {
        /// Normals of the meshes.
        #[reflect(@Label("Draw"))]
        pub on: bool,
        /// Between the vertices: 0 none, 1 one on each edge, 2 three on each edge and three inside.
        #[reflect(@Quantity::slider(0.0, 2.0, ""))]
        pub between: u32,
        /// Of the object with this `SceneId` only; 0: of all.
        pub object: u64,
        /// How long they are on the screen, in pixels.
        #[reflect(@Quantity::within(0.0, 1e4, "px").shown(1.0, 200.0))]
        pub length: f32,
        /// Of those within a square of this many pixels only the nearest is drawn.
        #[reflect(@Quantity::within(0.0, 1e4, "px").shown(0.0, 100.0))]
        pub spacing: f32,
    }
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

documented! {
    /// Which two numbers of each sample a point of the inset shows.
    #[derive(Reflect, Clone, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct PatternSettings {
        /// Where the samples of the picked pixel lie.
        #[reflect(@Label("Sample pattern"))]
        pub on: bool,
        /// The number of a sample that goes to the right.
        #[reflect(@Label("Pattern across"))]
        pub x: Dimension,
        /// The number of a sample that goes down.
        #[reflect(@Label("Pattern down"))]
        pub y: Dimension,
        /// For `LightU` and `LightV`: the light's `SceneId`; 0 for the dome.
        pub light: u64,
    }
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

documented! {
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
        /// The second number of the place on the lens.
        LensV,
        /// When the shutter is open.
        Time,
        /// The first of the numbers that choose a point of a light.
        LightU,
        /// The second of the numbers that choose a point of a light.
        LightV,
        /// The first number of the place in a blurred reflection's disc.
        GlossU,
        /// The second number of the place in a blurred reflection's disc.
        GlossV,
    }
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
