use crate::scene::{Alpha, MapFilter, PhongMap, Wrap};
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
    /// What becomes of the opacity.
    pub alpha: Alpha,
    /// Multiplies what a normal map bends.
    pub normal_scale: f32,
    /// What the numbers are multiplied by, each kind once. Most materials have none, and pay for none.
    pub maps: Vec<Map>,
}

/// A texture of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// What it multiplies.
    pub of: PhongMap,
    /// Index into `World::textures`.
    pub texture: u32,
    /// Beyond its edges, across and down.
    pub wrap: [Wrap; 2],
    /// Between its texels.
    pub filter: MapFilter,
    /// Whether its colours are weighted by its alpha, which is then the opacity that cuts them out.
    pub is_cut_out: bool,
}

impl Map {
    /// A texture that repeats, filtered as the setting says.
    pub fn new(of: PhongMap, texture: u32) -> Self {
        Self {
            of,
            texture,
            wrap: [Wrap::Repeat; 2],
            filter: MapFilter::Setting,
            is_cut_out: false,
        }
    }
}

impl Material {
    /// The map of a kind.
    pub fn map(&self, of: PhongMap) -> Option<&Map> {
        self.maps.iter().find(|map| map.of == of)
    }

    /// Whether it may let light through; a mesh's own alphas apart.
    pub fn is_transparent(&self) -> bool {
        let fades = self.opacity < 1.0 || self.map(PhongMap::Opacity).is_some();
        match self.alpha {
            Alpha::Blend => fades,
            // Above 1 no opacity reaches it.
            Alpha::Mask { cutoff } => fades || cutoff > 1.0,
            Alpha::Opaque => false,
        }
    }
}

/// Some of a world's materials, and maybe others with them: those whose numbers are the same modulo 64 are one to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MaterialSet(u64);

impl MaterialSet {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// With the material of this number.
    #[must_use]
    pub fn with(self, material: u32) -> Self {
        Self(self.0 | 1 << (material % 64))
    }

    /// With those of another one.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// False where no material is in both.
    pub fn may_share(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
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
            alpha: Alpha::Blend,
            normal_scale: 1.0,
            maps: Vec::new(),
        }
    }
}
