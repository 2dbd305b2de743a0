//! What belongs to the scene as a whole: its background, and how it is rendered.
//!
//! `--set key=value` reaches every field by its reflected path, for example
//! `features.shadows=false` or `tree.builder=Sah`.

use super::schema::{Label, MostPixels, Needs, Quantity, documented};
use super::{TextureSource, TreeSettings};
use bevy::asset::Handle;
use bevy::color::LinearRgba;
use bevy::ecs::{reflect::ReflectResource, resource::Resource};
use bevy::image::Image;
use bevy::math::UVec2;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use std::f64::consts::PI;

documented! {
    /// What a ray carries that meets nothing.
    #[derive(Resource, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Resource, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    pub struct Environment {
        /// What is seen where there is nothing, and no picture.
        ///
        /// Used where there is no map, or where `RenderSettings::features.environment` is off.
        #[reflect(@Quantity::FACTOR)]
        pub background: LinearRgba,
        /// A panorama around the scene: background, reflections and, if it is to, light.
        ///
        /// An equirectangular picture, +Y up, its middle column at -Z.
        #[reflect(@Label("Picture"))]
        pub map: Option<TextureSource>,
        /// Turns the picture about the vertical axis, in radians.
        #[reflect(@Quantity::ANY.unit("°").shown(-PI, PI))]
        pub rotation: f32,
        /// Multiplies the picture.
        #[reflect(@Quantity::FACTOR)]
        pub intensity: f32,
        /// Light comes from all of it, with shadows: a sky, suns in a picture. Not with Classic lighting.
        #[reflect(@Label("Lights the scene"))]
        pub lights: bool,
        /// Shadow rays to it at the first hit of each pixel, shared by the pixel's samples: more makes its light less noisy.
        #[reflect(@Quantity::SAMPLES, @Needs::on("lights"))]
        pub samples: u32,
        /// The camera sees black where there is nothing, or the background's colour where there is a picture. Mirrors show
        /// what is around all the same, and so does its light.
        #[reflect(@Label("Hidden"))]
        pub hidden: bool,
    }
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
            hidden: false,
        }
    }
}

/// The map of the [`Environment`], loaded. Not saved: made again from its source.
#[derive(Resource, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Resource, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct EnvironmentMap(pub Option<Handle<Image>>);

/// A whole number on a slider.
pub(super) const fn whole(least: u32, most: u32) -> Quantity {
    Quantity::slider(least as f64, most as f64, "")
}

documented! {
    /// How the scene is rendered.
    #[derive(Resource, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Resource, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    pub struct RenderSettings {
        /// Pixels of the picture.
        #[reflect(@Quantity::within(1.0, 65_536.0, "").step(1.0), @MostPixels(1 << 28))]
        pub size: UVec2,
        /// Samples of each pixel (effects may ask for more); the most with an error or a time to stop at.
        #[reflect(@whole(1, 1 << 20).logarithmic(), @Label("Samples (spp)"))]
        pub spp: u32,
        /// n of n × n jittered samples of each pixel: they ask for n² samples.
        #[reflect(@whole(1, 16), @Label("Jitter n×n"))]
        pub jitter: u32,
        /// Chooses the random numbers; the same seed gives the same picture.
        #[reflect(@Quantity::within(0.0, u32::MAX as f64, "").step(0.25))]
        pub seed: u32,
        /// Where the random numbers come from.
        pub sequence: Sequence,
        /// When to stop, and which pixels get more samples.
        pub sampling: Sampling,
        /// Where in the pixel samples lie.
        #[reflect(@Label("In the pixel"))]
        pub pixel: PixelSampling,
        /// What a light's colour means.
        pub lighting: Lighting,
        /// Mirror bounces.
        #[reflect(@whole(0, 50), @Label("Mirror depth"), @Needs::on("features.mirrors"))]
        pub max_depth: u32,
        /// The switches.
        pub features: Features,
        /// Rays of a glossy reflection at the first hit.
        #[reflect(@Quantity::SAMPLES, @Needs::on("features.glossy"))]
        pub gloss_samples: u32,
        /// Rays through a translucent surface at the first hit.
        #[reflect(@Quantity::SAMPLES, @Label("Rays through"), @Needs::on("features.translucency"))]
        pub translucency_samples: u32,
        /// How texels are read.
        pub texture_filter: TextureFilter,
        /// How the trees are built.
        pub tree: TreeSettings,
        /// What is done after tracing.
        pub output: Output,
    }
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

documented! {
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
}

documented! {
    /// When a render stops before it has `spp` samples of each pixel, and in which order they come.
    #[derive(Reflect, Clone, Copy, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct Sampling {
        /// With an error or a time to stop at: samples go first where they lower the error most; off: every pixel gets the
        /// same.
        pub adaptive: bool,
        /// Relative error of the picture to stop at, as it is estimated: 0.01 is one percent; 0 does not stop.
        #[reflect(@Quantity::within(0.0, 1000.0, "").step(0.001).zero_is("never"), @Label("Stop at error"))]
        pub error: f32,
        /// Seconds of tracing to stop after, but not before each pixel has a sample; 0 does not stop.
        #[reflect(@Quantity::within(0.0, 1e7, "s").step(0.1).zero_is("never"), @Label("Stop after"))]
        pub time: f32,
    }
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

documented! {
    /// Where in the pixel samples lie.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub enum PixelSampling {
        /// Spread over the pixel: smooth edges.
        #[default]
        Area,
        /// All at the pixel's centre: jagged edges.
        Center,
        /// All at the pixel's lower left corner, as programs do that count `ndc = 2x/W - 1`.
        Corner,
    }
}

documented! {
    /// What a light's colour means.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub enum Lighting {
        /// Radiometric: inverse square, cosine at emitters, lights add up.
        #[default]
        Physical,
        /// Light colours are not attenuated, and lights are averaged: simple, not physical.
        ///
        /// As simple Phong ray tracers do it: normals are taken as the mesh gives them, textures are not decoded, emission is
        /// ignored.
        Classic,
    }
}

documented! {
    /// The switches of the picture. What is off costs nothing.
    #[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct Features {
        /// Phong shading; off: the value is kd.
        pub shading: bool,
        /// km > 0 reflects.
        pub mirrors: bool,
        /// Shadow rays; off: every light arrives.
        pub shadows: bool,
        /// Area lights as areas; off: each is one point at its middle.
        #[reflect(@Needs::on("features.shadows"))]
        pub soft_shadows: bool,
        /// Smooth normals; off: each triangle's own.
        #[reflect(@Label("Smooth normals"))]
        pub normal_interpolation: bool,
        /// The maps of materials.
        pub textures: bool,
        /// The environment map; off: the background colour.
        #[reflect(@Label("Environment map"))]
        pub environment: bool,
        /// Samples of an area light grow with its size: `samples` is per square metre (or metre).
        #[reflect(@Label("Scale by size"), @Needs::on("features.soft_shadows"))]
        pub scale_light_samples: bool,
        /// Mirrors blur by their shininess; off: they are sharp.
        #[reflect(@Needs::on("features.mirrors"))]
        pub glossy: bool,
        /// Opacity below 1 lets light through; off: everything is opaque.
        pub transparency: bool,
        /// Transmitted rays blur by the shininess; off: they go straight on.
        #[reflect(@Needs::on("features.transparency"))]
        pub translucency: bool,
        /// The camera's lens; off: a pinhole.
        pub lens: bool,
        /// Entities and the camera move while the shutter is open; off: they stand as at t = 0.
        #[reflect(@Label("Motion blur"))]
        pub motion: bool,
    }
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

documented! {
    /// How texels are read.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub enum TextureFilter {
        /// The texel that the point falls into: squares when near.
        Nearest,
        /// Between the four nearest texels.
        #[default]
        Bilinear,
        /// Trilinear: from smaller copies of the texture, by the width of the ray; no flicker far away.
        Mipmap,
    }
}

documented! {
    /// What is done with the linear picture after tracing. None of it traces a ray.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct Output {
        /// Light that bright places spill over their surroundings; it comes before the exposure.
        pub bloom: Bloom,
        /// In stops: the picture is multiplied by 2^exposure.
        #[reflect(@Quantity::within(-64.0, 64.0, "EV").step(0.02))]
        pub exposure: f32,
        /// From scene-referred values to a screen's.
        pub view_transform: ViewTransform,
    }
}

documented! {
    /// Light that bright places spill over their surroundings, as in an eye or a lens.
    ///
    /// Pixels whose largest component exceeds `threshold`, through a Gaussian of `sigma` pixels, times
    /// `intensity`, are added to the linear picture.
    #[derive(Reflect, Clone, Copy, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct Bloom {
        /// Bright places spill light over their surroundings; off: the picture stays as it was traced.
        #[reflect(@Label("Bloom"))]
        pub enabled: bool,
        /// Linear value above which a pixel is bright.
        #[reflect(@Quantity::PART, @Label("Bloom threshold"), @Needs::on("output.bloom.enabled"))]
        pub threshold: f32,
        /// The part of the bright pixels' light that is added again around them.
        #[reflect(@Quantity::PART, @Label("Bloom intensity"), @Needs::on("output.bloom.enabled"))]
        pub intensity: f32,
        /// Width of the blur, the Gaussian's standard deviation, in pixels; 0 does not blur.
        #[reflect(
            @Quantity::within(0.0, 1000.0, "px").step(0.1),
            @Label("Bloom sigma"),
            @Needs::on("output.bloom.enabled")
        )]
        pub sigma: f32,
    }
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

documented! {
    /// From scene-referred values to a screen's.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub enum ViewTransform {
        /// Clamped to [0, 1], nothing else.
        Raw,
        /// Clamped, then the sRGB curve.
        #[reflect(@Label("sRGB"))]
        #[default]
        Srgb,
        /// Fits very bright light into the screen's range without hard clipping.
        ///
        /// Troy Sobotka's AgX: 16.5 stops are fitted, and what is very bright loses its colour instead of being clipped in one
        /// channel after the other.
        #[reflect(@Label("AgX"))]
        AgX,
    }
}
