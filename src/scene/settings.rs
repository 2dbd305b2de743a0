//! What belongs to the scene as a whole: its background, and how it is rendered.
//!
//! `--set key=value` reaches every field by its reflected path, for example
//! `features.shadows=false` or `tree.builder=Sah`.

use super::TextureSource;
use bevy::asset::Handle;
use bevy::color::LinearRgba;
use bevy::ecs::{reflect::ReflectResource, resource::Resource};
use bevy::image::Image;
use bevy::math::UVec2;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

/// What a ray carries that meets nothing.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct Environment {
    /// Used where there is no map, or where `RenderSettings::features.environment` is off.
    pub background: LinearRgba,
    /// An equirectangular picture, +Y up, its middle column at -Z.
    pub map: Option<TextureSource>,
    /// Turns the map about the y axis, in radians.
    pub rotation: f32,
    /// Multiplies the map, ≥ 0.
    pub intensity: f32,
    /// Whether it lights the scene, from everywhere: a dome. Not with Classic lighting.
    pub lights: bool,
    /// Shadow rays at the first hit, 1–1000; used where it lights.
    pub samples: u32,
}

impl Default for Environment {
    fn default() -> Self {
        Self {
            background: LinearRgba::BLACK,
            map: None,
            rotation: 0.0,
            intensity: 1.0,
            lights: false,
            samples: 1,
        }
    }
}

/// The map of the [`Environment`], loaded. Not saved: made again from its source.
#[derive(Resource, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct EnvironmentMap(pub Option<Handle<Image>>);

/// How the scene is rendered.
#[derive(Resource, Reflect, Clone, Debug, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct RenderSettings {
    /// Pixels, 1 to 65,536 each and at most 2^28 together.
    pub size: UVec2,
    /// Samples of each pixel, 1 to 2^20; effects may ask for more. The most a pixel gets where
    /// `sampling` has an error or a time to stop at.
    pub spp: u32,
    /// n of n × n jittered samples of each pixel, 1–16: they ask for n² samples.
    pub jitter: u32,
    /// Chooses the random numbers; the same seed gives the same picture.
    pub seed: u32,
    /// Where the random numbers come from.
    pub sequence: Sequence,
    /// When to stop, and which pixels get more samples.
    pub sampling: Sampling,
    /// Where in the pixel samples lie.
    pub pixel: PixelSampling,
    /// What a light's colour means.
    pub lighting: Lighting,
    /// Mirror bounces, 0–50.
    pub max_depth: u32,
    /// The switches.
    pub features: Features,
    /// Rays of a glossy reflection at the first hit, 1–1000.
    pub gloss_samples: u32,
    /// Rays through a translucent surface at the first hit, 1–1000.
    pub translucency_samples: u32,
    /// How texels are read.
    pub texture_filter: TextureFilter,
    /// How the trees are built.
    pub tree: TreeSettings,
    /// What is done after tracing.
    pub output: Output,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            size: UVec2::new(800, 800),
            spp: 16,
            jitter: 1,
            seed: 0,
            sequence: Sequence::default(),
            sampling: Sampling::default(),
            pixel: PixelSampling::default(),
            lighting: Lighting::default(),
            max_depth: 6,
            features: Features::default(),
            gloss_samples: 1,
            translucency_samples: 1,
            texture_filter: TextureFilter::default(),
            tree: TreeSettings::default(),
            output: Output::default(),
        }
    }
}

/// Where the random numbers come from.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub enum Sequence {
    /// Owen-scrambled Sobol points: the error falls faster than one over the root of the samples.
    #[default]
    Sobol,
    /// Independent random numbers, to compare with.
    Independent,
    /// Random numbers in the cells of the `jitter` × `jitter` grid, pair by pair and each cell once: what
    /// distributed ray tracing began with (Cook, Porter, Carpenter 1984), to compare with.
    Jittered,
}

/// When a render stops before it has `spp` samples of each pixel, and in which order they come.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct Sampling {
    /// With an error or a time to stop at: samples go first where they lower the error most. Without,
    /// every pixel gets the same.
    pub adaptive: bool,
    /// Stops when the estimated relative error of the picture has fallen to this, 0 to 1000: 0.01 is
    /// one percent; 0 does not stop.
    pub error: f32,
    /// Stops after this many seconds of tracing, 0 to 10^7, but not before each pixel has a sample;
    /// 0 does not stop.
    pub time: f32,
}

impl Default for Sampling {
    fn default() -> Self {
        Self {
            adaptive: true,
            error: 0.0,
            time: 0.0,
        }
    }
}

/// Where in the pixel samples lie.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub enum PixelSampling {
    /// Spread over the pixel's area: smooth edges.
    #[default]
    Area,
    /// All of them at its centre.
    Center,
    /// All of them at its lower left corner, as programs do that count `ndc = 2x/W - 1`.
    Corner,
}

/// What a light's colour means.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub enum Lighting {
    /// Radiometric: inverse square, cosine at emitters, lights add up.
    #[default]
    Physical,
    /// As simple Phong ray tracers do it, not physical: a light's colour arrives unattenuated, lights are
    /// averaged, normals are taken as the mesh gives them, textures are not decoded, emission is ignored.
    Classic,
}

/// The switches of the picture. What is off costs nothing.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct Features {
    /// Phong shading; off: the value is kd.
    pub shading: bool,
    /// ks > 0 reflects.
    pub mirrors: bool,
    /// Shadow rays; off: every light arrives.
    pub shadows: bool,
    /// Area lights as areas; off: each is one point at its middle.
    pub soft_shadows: bool,
    /// Smooth normals; off: each triangle's own.
    pub normal_interpolation: bool,
    /// Diffuse and opacity maps.
    pub textures: bool,
    /// The environment map; off: the background colour.
    pub environment: bool,
    /// Samples of an area light grow with its size: `samples` is per square metre (or metre).
    pub scale_light_samples: bool,
    /// Mirrors blur by their shininess; off: they are sharp.
    pub glossy: bool,
    /// Opacity below 1 lets light through; off: everything is opaque.
    pub transparency: bool,
    /// Transmitted rays blur by the shininess; off: they go straight on.
    pub translucency: bool,
    /// The camera's lens; off: a pinhole.
    pub lens: bool,
    /// Entities and the camera move while the shutter is open; off: they stand as at t = 0.
    pub motion: bool,
}

impl Default for Features {
    fn default() -> Self {
        Self {
            shading: true,
            mirrors: true,
            shadows: true,
            soft_shadows: true,
            normal_interpolation: true,
            textures: true,
            environment: true,
            scale_light_samples: false,
            glossy: false,
            transparency: true,
            translucency: false,
            lens: true,
            motion: true,
        }
    }
}

/// How texels are read.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub enum TextureFilter {
    /// The texel that the point falls into.
    Nearest,
    /// Between the four nearest.
    #[default]
    Bilinear,
    /// Bilinear, between the two sizes of the picture whose texels are as large as the ray is wide.
    Mipmap,
}

/// How the trees are built. The picture does not depend on it.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct TreeSettings {
    /// Who puts the triangles together.
    pub builder: Builder,
    /// Two levels (a tree per mesh and one over the objects), or one tree over all triangles.
    pub levels: Levels,
    /// Levels of `Median` and `Sah` trees, 1–64; a node at the last level is a leaf whatever its size.
    pub max_depth: u32,
    /// Triangles of a leaf, 1–255; `Median` and `Sah` may exceed it only at `max_depth`.
    pub max_leaf_size: u32,
    /// Bins per axis of `Sah`, 2–64.
    pub bins: u32,
    /// How much time `Ploc` takes for a better tree.
    pub preset: Preset,
}

impl Default for TreeSettings {
    fn default() -> Self {
        Self {
            builder: Builder::default(),
            levels: Levels::default(),
            max_depth: 64,
            max_leaf_size: 8,
            bins: 16,
            preset: Preset::default(),
        }
    }
}

impl TreeSettings {
    /// A simple textbook tree, to compare with: median split, at most ten levels, one tree for all.
    pub const SIMPLE: Self = Self {
        builder: Builder::Median,
        levels: Levels::One,
        max_depth: 10,
        max_leaf_size: 8,
        bins: 16,
        preset: Preset::Medium,
    };
}

/// How a tree is built.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum Builder {
    /// No tree: every ray tests every triangle.
    None,
    /// Half of the triangles on either side, along the longest axis.
    Median,
    /// Binned surface area heuristic.
    #[default]
    Sah,
    /// obvhs: parallel locally-ordered clustering merges neighbours bottom-up, then reinsertion
    /// improves the tree.
    Ploc,
}

/// How many levels of trees there are.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub enum Levels {
    /// One tree over every triangle of every object.
    One,
    /// A tree per mesh, shared by the objects that use it, and one over the objects.
    #[default]
    Two,
}

/// obvhs' own presets, from quick to build to quick to trace.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
#[expect(missing_docs, reason = "the names say it all")]
pub enum Preset {
    Fastest,
    Fast,
    #[default]
    Medium,
    Slow,
    VerySlow,
}

/// What is done with the linear picture after tracing. None of it traces a ray.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct Output {
    /// Light that bright places spill over their surroundings; it comes before the exposure.
    pub bloom: Bloom,
    /// In stops: the picture is multiplied by 2^exposure.
    pub exposure: f32,
    /// From scene-referred values to a screen's.
    pub view_transform: ViewTransform,
}

/// Light that bright places spill over their surroundings, as in an eye or a lens.
///
/// Pixels whose largest component exceeds `threshold`, through a Gaussian of `sigma` pixels, times
/// `intensity`, are added to the linear picture.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct Bloom {
    /// Off: the picture stays as it was traced.
    pub enabled: bool,
    /// 0–1, in the linear picture's unit.
    pub threshold: f32,
    /// 0–1: the part of the bright pixels' light that is added again around them.
    pub intensity: f32,
    /// Standard deviation of the Gaussian in pixels, 0–1000; 0 does not blur.
    pub sigma: f32,
}

impl Default for Bloom {
    fn default() -> Self {
        Self {
            enabled: false,
            threshold: 0.8,
            intensity: 0.25,
            sigma: 8.0,
        }
    }
}

/// From scene-referred values to a screen's.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub enum ViewTransform {
    /// Clamped to [0, 1], nothing else.
    Raw,
    /// Clamped, then the sRGB curve.
    #[default]
    Srgb,
    /// Troy Sobotka's AgX: 16.5 stops are fitted into the screen's range, and what is very bright
    /// loses its colour instead of being clipped in one channel after the other.
    AgX,
}
