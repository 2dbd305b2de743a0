use glam::Vec3;

/// A Phong material, resolved: colours in linear RGB, textures as indices into `World::textures`.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// kd.
    pub diffuse: Vec3,
    /// ks: the highlight.
    pub specular: Vec3,
    /// km: the reflection.
    pub mirror: Vec3,
    /// s ≥ 1.
    pub shininess: f32,
    /// d in [0, 1].
    pub opacity: f32,
    /// ke, radiance.
    pub emission: Vec3,
    /// Takes the place of `diffuse`. Where there is an opacity map, too, this one's alpha is that
    /// opacity, and weights its colours.
    pub diffuse_map: Option<u32>,
    /// Multiplies `opacity`.
    pub opacity_map: Option<u32>,
}

impl Default for Material {
    /// Grey, matt, opaque.
    fn default() -> Self {
        Self {
            diffuse: Vec3::splat(0.8),
            specular: Vec3::ZERO,
            mirror: Vec3::ZERO,
            shininess: 10.0,
            opacity: 1.0,
            emission: Vec3::ZERO,
            diffuse_map: None,
            opacity_map: None,
        }
    }
}
