use bevy::asset::Handle;
use bevy::color::LinearRgba;
use bevy::ecs::entity::{Entity, MapEntities};
use bevy::ecs::{component::Component, reflect::ReflectComponent, reflect::ReflectMapEntities};
use bevy::image::Image;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

/// A Phong material, named as in OBJ/MTL.
///
/// On an entity with a mesh it is that object's own material. On an entity without one it is a
/// shared material, which objects name with [`UsesMaterial`].
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct Phong {
    /// kd, in [0, 1]. A diffuse map takes its place.
    pub diffuse: LinearRgba,
    /// ks, in [0, 1]: the highlight.
    pub specular: LinearRgba,
    /// km, in [0, 1]: how much of what the mirror direction shows is reflected.
    pub mirror: LinearRgba,
    /// s ≥ 1: how narrow the highlight is; a glossy reflection's disc has radius 1/s.
    pub shininess: f32,
    /// d in [0, 1]: 1 is opaque.
    pub opacity: f32,
    /// ke ≥ 0, radiance that the surface sends out by itself. It is seen; it does not light others.
    pub emission: LinearRgba,
    /// A picture that takes the place of `diffuse`.
    pub diffuse_map: Option<TextureSource>,
    /// A picture whose brightness multiplies `opacity`. The diffuse map is cut out by it: where its
    /// colours are mixed, each counts by its opacity.
    pub opacity_map: Option<TextureSource>,
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
            diffuse_map: None,
            opacity_map: None,
        }
    }
}

/// A picture file, or one that a generated scene brings along.
#[derive(Reflect, Clone, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Default, Clone, PartialEq, Debug, Hash)]
pub struct TextureSource {
    /// Relative to the scene file's folder, with `/` between its parts. `model.glb#texture0` is a
    /// picture inside a glTF file; `builtin:checker` is one that Glassbox generates. Where no such file is there, `%` and
    /// two hexadecimal digits are a byte of a name; `\`, `:` and bytes that are no UTF-8 are written so.
    pub path: String,
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
    /// Takes the place of `Phong::diffuse`.
    pub diffuse: Option<Handle<Image>>,
    /// Multiplies `Phong::opacity`.
    pub opacity: Option<Handle<Image>>,
}

/// Names the entity whose [`Phong`] this object uses instead of its own.
#[derive(Component, Reflect, MapEntities, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, MapEntities, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct UsesMaterial(#[entities] pub Entity);
