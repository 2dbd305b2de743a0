use super::schema::{Label, Quantity, documented};
use super::{Phong, SceneId};
use bevy::camera::visibility::Visibility;
use bevy::ecs::{component::Component, reflect::ReflectComponent};
use bevy::math::{Vec2, Vec3};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;

documented! {
    /// Where an object's mesh comes from, so that it can be saved and made again.
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    #[require(Transform, Visibility, SceneId, Phong)]
    pub enum MeshSource {
        /// A shape with its numbers, generated.
        Shape(Shape),
        /// One mesh of a model file: OBJ, glTF, GLB, STL or PLY.
        File {
            /// Relative to the scene file's folder, with `/` between its parts and escapes as in
            /// [`TextureSource::path`](super::TextureSource::path).
            path: String,
            /// Which mesh of the file, as the importer names it; empty for the file's only mesh.
            name: String,
        },
    }
}

impl Default for MeshSource {
    fn default() -> Self {
        Self::Shape(Shape::default())
    }
}

/// How often a shape is divided, and to where its slider goes.
const fn divisions(least: f64, shown: f64) -> Quantity {
    Quantity::within(least, 65_536.0, "")
        .shown(least, shown)
        .logarithmic()
}

documented! {
    /// The shapes that Glassbox generates. All of them carry normals and texture coordinates.
    #[derive(Reflect, Clone, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub enum Shape {
        /// A single triangle, by its corners.
        Triangle {
            /// A corner; counter-clockwise seen from the side that the normal points to.
            #[reflect(@Quantity::COORDINATE, @Label("Corner"))]
            corners: [Vec3; 3],
        },
        /// A flat parallelogram: a corner and the two edges that leave it.
        ///
        /// Its normal points along `edges[0] × edges[1]`.
        Quad {
            /// One corner.
            #[reflect(@Quantity::COORDINATE)]
            corner: Vec3,
            /// From the corner to its neighbour; the front is where A × B points.
            #[reflect(@Quantity::COORDINATE, @Label("Edge"))]
            edges: [Vec3; 2],
        },
        /// A level rectangle in the plane y = 0, centred, facing up; its texture repeats.
        Ground {
            /// Extent along x and z.
            #[reflect(@Quantity::EXTENT)]
            size: Vec2,
            /// Extent of one copy of the texture; one copy begins at the corner with the least x and z.
            #[reflect(@Quantity::EXTENT)]
            tile: Vec2,
        },
        /// Two triangles between four corners, which need not lie in one plane.
        Quadrilateral {
            /// A corner; counter-clockwise seen from the side that the normal points to.
            ///
            /// The triangles meet along the line from the first to the third.
            #[reflect(@Quantity::COORDINATE, @Label("Corner"))]
            corners: [Vec3; 4],
        },
        /// A block with flat sides, its edges along the axes.
        ///
        /// It is centred; each side carries the whole texture.
        Cuboid {
            /// Edge lengths.
            #[reflect(@Quantity::EXTENT)]
            size: Vec3,
        },
        /// An upright block over a convex polygon.
        ///
        /// Its foot is on y = 0; it is closed, with flat sides.
        Prism {
            /// Corners of its foot as (x, z), once around, either way.
            #[reflect(@Quantity::COORDINATE)]
            base: Vec<Vec2>,
            /// Extent along y.
            #[reflect(@Quantity::EXTENT)]
            height: f32,
        },
        /// Divided by longitude and latitude, smooth, its poles on the y axis.
        Sphere {
            /// Distance of every vertex from the centre.
            #[reflect(@Quantity::EXTENT)]
            radius: f32,
            /// Divisions around the axis: more is rounder, and more triangles.
            #[reflect(@divisions(3.0, 1024.0))]
            segments: u32,
            /// Divisions from pole to pole.
            #[reflect(@divisions(2.0, 512.0))]
            rings: u32,
        },
        /// Around the y axis, centred, with flat caps.
        Cylinder {
            /// Of the side.
            #[reflect(@Quantity::EXTENT)]
            radius: f32,
            /// Extent along y.
            #[reflect(@Quantity::EXTENT)]
            height: f32,
            /// Divisions around the axis: more is rounder, and more triangles.
            #[reflect(@divisions(3.0, 1024.0))]
            segments: u32,
        },
        /// A ring around the y axis.
        Torus {
            /// From the centre to the middle of the tube.
            #[reflect(@Quantity::EXTENT, @Label("Ring radius"))]
            major_radius: f32,
            /// Of the tube.
            #[reflect(@Quantity::EXTENT, @Label("Tube radius"))]
            minor_radius: f32,
            /// Divisions around the axis: more is rounder, and more triangles.
            #[reflect(@divisions(3.0, 1024.0))]
            segments: u32,
            /// Divisions around the tube.
            #[reflect(@divisions(3.0, 512.0))]
            sides: u32,
        },
        /// Newell's teapot, of 32 curved patches.
        ///
        /// They are bicubic Bézier patches, y up, its foot on y = 0, two units high before scaling.
        Teapot {
            /// Each of its 32 patches becomes n × n quads.
            #[reflect(@divisions(1.0, 64.0))]
            divisions: u32,
        },
        /// A smooth head with a neck, facing +Z.
        ///
        /// A displaced, closed surface, two units high, centred.
        Head {
            /// Divisions around the axis: more is rounder, and more triangles.
            #[reflect(@divisions(3.0, 1024.0))]
            segments: u32,
            /// Divisions from chin to crown.
            #[reflect(@divisions(2.0, 512.0))]
            rings: u32,
        },
        /// A (p, q) torus knot around the y axis, its tube with ripples.
        ///
        /// It lies on a torus of radii 1 and 0.4.
        Knot {
            /// Turns around the axis; no number divides them and those through the hole.
            #[reflect(@divisions(1.0, 12.0), @Label("Turns p"))]
            p: u32,
            /// Turns through the hole; no number divides them and those around the axis.
            #[reflect(@divisions(1.0, 12.0), @Label("Turns q"))]
            q: u32,
            /// Of the tube.
            #[reflect(@Quantity::EXTENT)]
            tube_radius: f32,
            /// Height of the ripples on the tube, as a part of its radius.
            #[reflect(@Quantity::ANY.shown(0.0, 1.0), @Label("Ripples"))]
            displacement: f32,
            /// Divisions along the knot.
            #[reflect(@divisions(3.0, 4096.0))]
            segments: u32,
            /// Divisions around the tube.
            #[reflect(@divisions(3.0, 512.0))]
            sides: u32,
        },
    }
}

impl Default for Shape {
    fn default() -> Self {
        Self::Cuboid { size: Vec3::ONE }
    }
}
