use super::{Phong, SceneId};
use bevy::camera::visibility::Visibility;
use bevy::ecs::{component::Component, reflect::ReflectComponent};
use bevy::math::{Vec2, Vec3};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;

/// Where an object's mesh comes from, so that it can be saved and made again.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
#[require(Transform, Visibility, SceneId, Phong)]
pub enum MeshSource {
    /// A shape with its numbers, generated.
    Shape(Shape),
    /// One mesh of an OBJ, glTF or GLB file.
    File {
        /// Relative to the scene file's folder, with `/` between its parts and escapes as in
        /// [`TextureSource::path`](super::TextureSource::path).
        path: String,
        /// Which mesh of the file, as the importer names it; empty for the file's only mesh.
        name: String,
    },
}

impl Default for MeshSource {
    fn default() -> Self {
        Self::Shape(Shape::default())
    }
}

/// The shapes that Glassbox generates. All of them carry normals and texture coordinates.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub enum Shape {
    /// One triangle.
    Triangle {
        /// Its corners, counter-clockwise seen from the side that its normal points to.
        corners: [Vec3; 3],
    },
    /// A flat parallelogram `corner + u·edges[0] + v·edges[1]`, its normal along `edges[0] × edges[1]`.
    Quad {
        /// One corner.
        corner: Vec3,
        /// The two edges that leave it.
        edges: [Vec3; 2],
    },
    /// A flat rectangle in the plane y = 0, centred, facing up; its texture repeats.
    Ground {
        /// Extent along x and z.
        size: Vec2,
        /// Extent of one copy of the texture; one copy begins at the corner with the least x and z.
        tile: Vec2,
    },
    /// Two flat triangles between four corners, which need not lie in one plane.
    Quadrilateral {
        /// Once around, counter-clockwise seen from the side that its normals point to. The triangles
        /// meet along the line from the first to the third.
        corners: [Vec3; 4],
    },
    /// A six-sided block with flat sides, centred, axis-parallel; each side carries the whole texture.
    Cuboid {
        /// Edge lengths.
        size: Vec3,
    },
    /// An upright block over a convex polygon, its foot on y = 0; closed, with flat sides.
    Prism {
        /// Corners of its foot as (x, z), once around, either way.
        base: Vec<Vec2>,
        /// Extent along y.
        height: f32,
    },
    /// A latitude–longitude sphere with smooth normals, its poles on the y axis.
    Sphere {
        /// Distance of every vertex from the centre.
        radius: f32,
        /// Divisions around the axis, at least 3.
        segments: u32,
        /// Divisions from pole to pole, at least 2.
        rings: u32,
    },
    /// A closed cylinder around the y axis, centred, with flat caps.
    Cylinder {
        /// Radius of the side.
        radius: f32,
        /// Extent along y.
        height: f32,
        /// Divisions around the axis, at least 3.
        segments: u32,
    },
    /// A torus around the y axis.
    Torus {
        /// From the centre to the middle of the tube.
        major_radius: f32,
        /// Radius of the tube.
        minor_radius: f32,
        /// Divisions around the axis, at least 3.
        segments: u32,
        /// Divisions around the tube, at least 3.
        sides: u32,
    },
    /// Newell's teapot: 32 bicubic Bézier patches, y up, its foot on y = 0, two units high before scaling.
    Teapot {
        /// Each patch becomes `divisions × divisions` quads, at least 1.
        divisions: u32,
    },
    /// A head with a neck: a smooth, displaced, closed surface, two units high, centred, facing +Z.
    Head {
        /// Divisions around the axis, at least 3.
        segments: u32,
        /// Divisions from chin to crown, at least 2.
        rings: u32,
    },
    /// A (p, q) torus knot around the y axis with a displaced tube. It lies on a torus of radii 1 and 0.4.
    Knot {
        /// Turns around the axis, coprime to `q`.
        p: u32,
        /// Turns through the hole.
        q: u32,
        /// Radius of the tube.
        tube_radius: f32,
        /// Height of the ripples on the tube, as a fraction of its radius.
        displacement: f32,
        /// Divisions along the knot, at least 3.
        segments: u32,
        /// Divisions around the tube, at least 3.
        sides: u32,
    },
}

impl Default for Shape {
    fn default() -> Self {
        Self::Cuboid { size: Vec3::ONE }
    }
}
