use super::schema::{Label, Quantity, documented};
use bevy::asset::Handle;
use bevy::color::LinearRgba;
use bevy::ecs::entity::{Entity, MapEntities};
use bevy::ecs::{component::Component, reflect::ReflectComponent, reflect::ReflectMapEntities};
use bevy::image::Image;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

documented! {
    /// A Phong material, named as in OBJ/MTL.
    ///
    /// On an entity with a mesh it is that object's own material. On an entity without one it is a
    /// shared material, which objects name with [`UsesMaterial`].
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    pub struct Phong {
        /// kd: the colour of the body, lit from all sides alike.
        #[reflect(@Quantity::PART)]
        pub diffuse: LinearRgba,
        /// ks: the highlight's colour, of lights alone; black is matt.
        #[reflect(@Quantity::PART)]
        pub specular: LinearRgba,
        /// km: how much of its surroundings it reflects, and in which colour; black is no mirror.
        #[reflect(@Quantity::PART)]
        pub mirror: LinearRgba,
        /// s: how narrow the highlight is; a glossy reflection's disc has radius 1/s.
        #[reflect(@Quantity::within(1.0, 1e6, "").shown(1.0, 10_000.0).logarithmic())]
        pub shininess: f32,
        /// d: 1 is opaque; below it light goes on through the surface, tinted.
        #[reflect(@Quantity::PART)]
        pub opacity: f32,
        /// ke: radiance that the surface sends out by itself; it is seen, but lights nothing.
        #[reflect(@Quantity::FACTOR)]
        pub emission: LinearRgba,
        /// What becomes of the opacity, its map's and the vertices' included.
        pub alpha: Alpha,
        /// How far the normal map bends normals: 1 as it is painted, below 0 inwards.
        #[reflect(@Quantity::within(f32::MIN as f64, f32::MAX as f64, ""))]
        pub normal_scale: f32,
        /// A picture that multiplies the diffuse colour.
        pub diffuse_map: Option<TextureSource>,
        /// A picture that multiplies the highlight's colour.
        pub specular_map: Option<TextureSource>,
        /// A picture that multiplies what is mirrored.
        pub mirror_map: Option<TextureSource>,
        /// A picture that multiplies the emission.
        pub emission_map: Option<TextureSource>,
        /// A picture whose brightness multiplies the opacity.
        ///
        /// Pictures of colours are cut out by it: where their colours are mixed, each counts by its opacity.
        pub opacity_map: Option<TextureSource>,
        /// A picture of normals: red to its right, green to its upper edge, blue outwards.
        ///
        /// In tangent space; they take the place of the mesh's.
        pub normal_map: Option<TextureSource>,
    }
}

impl Default for Phong {
    fn default() -> Self {
        Self {
            diffuse: LinearRgba::rgb(0.8, 0.8, 0.8),
            specular: LinearRgba::BLACK,
            mirror: LinearRgba::BLACK,
            shininess: 10.0,
            opacity: 1.0,
            emission: LinearRgba::BLACK,
            alpha: Alpha::Blend,
            normal_scale: 1.0,
            diffuse_map: None,
            specular_map: None,
            mirror_map: None,
            emission_map: None,
            opacity_map: None,
            normal_map: None,
        }
    }
}

documented! {
    /// What a surface's opacity means.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub enum Alpha {
        /// What is not opaque lets light through in part.
        #[default]
        Blend,
        /// There where the opacity, filtered, reaches the cutoff, and nothing elsewhere.
        Mask {
            /// The opacity from which on the surface is there; above 1 nothing is.
            #[reflect(@Quantity::within(0.0, f32::MAX as f64, "").shown(0.0, 1.0))]
            cutoff: f32,
        },
        /// Opacity and its map mean nothing.
        Opaque,
    }
}

/// Which picture of a [`Phong`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "named like the numbers that they multiply")]
pub enum PhongMap {
    Diffuse,
    Specular,
    Mirror,
    Emission,
    Opacity,
    Normal,
}

impl PhongMap {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Diffuse,
        Self::Specular,
        Self::Mirror,
        Self::Emission,
        Self::Opacity,
        Self::Normal,
    ];

    /// As messages call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Diffuse => "diffuse map",
            Self::Specular => "specular map",
            Self::Mirror => "mirror map",
            Self::Emission => "emission map",
            Self::Opacity => "opacity map",
            Self::Normal => "normal map",
        }
    }

    /// Whether it holds colours; the others hold numbers.
    pub fn is_of_colors(self) -> bool {
        !matches!(self, Self::Opacity | Self::Normal)
    }

    /// Where it comes from.
    pub fn source(self, phong: &Phong) -> Option<&TextureSource> {
        let source = match self {
            Self::Diffuse => &phong.diffuse_map,
            Self::Specular => &phong.specular_map,
            Self::Mirror => &phong.mirror_map,
            Self::Emission => &phong.emission_map,
            Self::Opacity => &phong.opacity_map,
            Self::Normal => &phong.normal_map,
        };
        source.as_ref()
    }

    /// The same, to be set.
    pub fn source_mut(self, phong: &mut Phong) -> &mut Option<TextureSource> {
        match self {
            Self::Diffuse => &mut phong.diffuse_map,
            Self::Specular => &mut phong.specular_map,
            Self::Mirror => &mut phong.mirror_map,
            Self::Emission => &mut phong.emission_map,
            Self::Opacity => &mut phong.opacity_map,
            Self::Normal => &mut phong.normal_map,
        }
    }

    /// The loaded picture.
    pub fn loaded(self, maps: &PhongMaps) -> Option<&Handle<Image>> {
        let handle = match self {
            Self::Diffuse => &maps.diffuse,
            Self::Specular => &maps.specular,
            Self::Mirror => &maps.mirror,
            Self::Emission => &maps.emission,
            Self::Opacity => &maps.opacity,
            Self::Normal => &maps.normal,
        };
        handle.as_ref()
    }

    /// The same, to be set.
    pub fn loaded_mut(self, maps: &mut PhongMaps) -> &mut Option<Handle<Image>> {
        match self {
            Self::Diffuse => &mut maps.diffuse,
            Self::Specular => &mut maps.specular,
            Self::Mirror => &mut maps.mirror,
            Self::Emission => &mut maps.emission,
            Self::Opacity => &mut maps.opacity,
            Self::Normal => &mut maps.normal,
        }
    }
}

documented! {
    /// A picture file, or one that a generated scene brings along, and how a material reads it.
    #[derive(Reflect, Clone, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub struct TextureSource {
        /// Relative to the scene file's folder, with `/` between its parts. `model.glb#texture0` is a
        /// picture inside a glTF file; `builtin:checker` is one that Glassbox generates. Where no such file is there, `%` and
        /// two hexadecimal digits are a byte of a name; `\`, `:` and bytes that are no UTF-8 are written so.
        pub path: String,
        /// What there is beyond the picture's left and right edge.
        ///
        /// The environment's own map goes around.
        pub wrap_u: Wrap,
        /// What there is beyond the picture's upper and lower edge.
        pub wrap_v: Wrap,
        /// What there is between the picture's pixels.
        pub filter: MapFilter,
    }
}

impl TextureSource {
    /// A picture that repeats, filtered as the render's setting says.
    pub fn new(path: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            ..Self::default()
        }
    }
}

documented! {
    /// What there is of a picture beyond its edge.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum Wrap {
        /// The picture again.
        #[default]
        Repeat,
        /// The picture's outermost pixels.
        Clamp,
        /// The picture again, every second time reversed.
        Mirror,
    }
}

documented! {
    /// What there is between the pixels of a map.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum MapFilter {
        /// What the render's texture filter says.
        #[default]
        #[reflect(@Label("As the render"))]
        Setting,
        /// Hard pixels, whatever the render's texture filter is.
        Nearest,
        /// What the render's texture filter says, but never hard pixels: those become bilinear.
        Linear,
    }
}

/// Label of an [`Image`] of linear floats that were sRGB-encoded in 16 bits: Bevy has no format for such
/// colours. The tracer keeps them encoded, which is as exact, takes half the memory, and leaves Classic
/// lighting its raw values.
pub const SRGB_16_BITS: &str = "sRGB in 16 bits";

/// The pictures of a [`Phong`], loaded. Not saved: made again from the sources.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct PhongMaps {
    /// Multiplies `Phong::diffuse`.
    pub diffuse: Option<Handle<Image>>,
    /// Multiplies `Phong::specular`.
    pub specular: Option<Handle<Image>>,
    /// Multiplies `Phong::mirror`.
    pub mirror: Option<Handle<Image>>,
    /// Multiplies `Phong::emission`.
    pub emission: Option<Handle<Image>>,
    /// Multiplies `Phong::opacity`.
    pub opacity: Option<Handle<Image>>,
    /// Bends normals.
    pub normal: Option<Handle<Image>>,
}

/// Names the entity whose [`Phong`] this object uses instead of its own.
#[derive(Component, Reflect, MapEntities, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, MapEntities, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct UsesMaterial(#[entities] pub Entity);
