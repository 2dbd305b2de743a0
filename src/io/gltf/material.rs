//! glTF's metallic–roughness material and Phong, in both directions.
//!
//! In: with base colour `b`, metalness `m`, roughness `r`, and `F0 = 0.04` (`KHR_materials_specular`
//! scales and tints it):
//!
//! | Phong | from |
//! |---|---|
//! | gloss | `g = (1 - r)²`: Phong's ks mirrors sharply, which a rough surface does not |
//! | `diffuse` | `b · (1 - m·g)`: what a rough metal does not mirror it scatters |
//! | `specular` | `lerp(F0, b, m) · g` |
//! | `shininess` | `2/r⁴ - 2`, within 1 to 10,000: the lobe of the same width (Walter et al. 2007, section 5.2, with α = r²) |
//! | `opacity` | base alpha where `alphaMode` is `BLEND` or `MASK`, else 1 |
//! | `emission` | emissive factor · `KHR_materials_emissive_strength` |
//! | `diffuse_map`, `opacity_map` | the base colour's picture, and its alpha where opacity counts |
//!
//! Out: `b = diffuse`, `m = 0`, `r` from `shininess`, and the exact Phong numbers in the material's
//! `extras` as `glassbox_phong`, which are preferred on the way in. Pictures replace `diffuse`, as
//! they do in Phong; a factor on a picture is left out, with a note.

use crate::scene::Phong;
use bevy::color::LinearRgba;
use serde::{Deserialize, Serialize};

/// Reflectance of common dielectrics at normal incidence, glTF 2.0, appendix B.
const F0: f32 = 0.04;
/// Beyond this a highlight is smaller than a pixel.
const MOST_SHININESS: f32 = 10_000.0;
/// The name under `extras`.
pub(super) const EXTRAS: &str = "glassbox_phong";

/// Phong's numbers as they stand in `extras`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Numbers {
    diffuse: [f32; 3],
    specular: [f32; 3],
    shininess: f32,
    opacity: f32,
    emission: [f32; 3],
}

/// A material's numbers, without its pictures.
pub(super) fn phong_of(material: &gltf::Material) -> Phong {
    if let Some(exact) = exact_phong(material) {
        return exact;
    }
    let pbr = material.pbr_metallic_roughness();
    let [red, green, blue, alpha] = pbr.base_color_factor().map(unit);
    let base = [red, green, blue];
    let (metal, rough) = (unit(pbr.metallic_factor()), unit(pbr.roughness_factor()));
    let gloss = (1.0 - rough) * (1.0 - rough);
    let (factor, tint) = material.specular().map_or((1.0, [1.0; 3]), |specular| {
        (
            unit(specular.specular_factor()),
            specular.specular_color_factor(),
        )
    });
    let strength = material.emissive_strength().unwrap_or(1.0);
    let specular = std::array::from_fn(|i| {
        let dielectric = unit(F0 * factor * tint[i]);
        unit((dielectric + metal * (base[i] - dielectric)) * gloss)
    });
    Phong {
        diffuse: color(base.map(|b| b * (1.0 - metal * gloss))),
        specular: color(specular),
        shininess: (2.0 / rough.powi(4) - 2.0).clamp(1.0, MOST_SHININESS),
        opacity: if has_alpha(material) { alpha } else { 1.0 },
        emission: color(material.emissive_factor().map(|e| at_least_0(e * strength))),
        diffuse_map: None,
        opacity_map: None,
    }
}

/// Whether a material's alpha means opacity.
pub(super) fn has_alpha(material: &gltf::Material) -> bool {
    material.alpha_mode() != gltf::material::AlphaMode::Opaque
}

fn exact_phong(material: &gltf::Material) -> Option<Phong> {
    let extras: serde_json::Value = serde_json::from_str(material.extras().as_ref()?.get()).ok()?;
    let numbers: Numbers = serde_json::from_value(extras.get(EXTRAS)?.clone()).ok()?;
    Some(Phong {
        diffuse: color(numbers.diffuse.map(unit)),
        specular: color(numbers.specular.map(unit)),
        shininess: numbers.shininess.clamp(1.0, f32::MAX),
        opacity: unit(numbers.opacity),
        emission: color(numbers.emission.map(at_least_0)),
        diffuse_map: None,
        opacity_map: None,
    })
}

/// A material as glTF says it, without its pictures.
pub(super) fn material_json(name: &str, phong: &Phong) -> serde_json::Value {
    let rgb = |c: LinearRgba| [c.red, c.green, c.blue];
    let numbers = Numbers {
        diffuse: rgb(phong.diffuse),
        specular: rgb(phong.specular),
        shininess: phong.shininess,
        opacity: phong.opacity,
        emission: rgb(phong.emission),
    };
    let rough = (2.0 / (phong.shininess + 2.0)).powf(0.25);
    let emission = rgb(phong.emission);
    let strength = emission.iter().copied().fold(1.0, f32::max);
    let [red, green, blue] = rgb(phong.diffuse);
    let mut json = serde_json::json!({
        "name": name,
        "doubleSided": true,
        "pbrMetallicRoughness": {
            "baseColorFactor": [red, green, blue, phong.opacity],
            "metallicFactor": 0.0,
            "roughnessFactor": unit(rough),
        },
        "emissiveFactor": emission.map(|e| e / strength),
        "extras": { EXTRAS: numbers },
    });
    if strength > 1.0 {
        let strength = serde_json::json!({ "emissiveStrength": strength });
        json["extensions"] = serde_json::json!({ "KHR_materials_emissive_strength": strength });
    }
    if phong.opacity < 1.0 || phong.opacity_map.is_some() {
        json["alphaMode"] = "BLEND".into();
    }
    json
}

fn color([red, green, blue]: [f32; 3]) -> LinearRgba {
    LinearRgba::rgb(red, green, blue)
}

/// In [0, 1]; not a number becomes 0.
fn unit(value: f32) -> f32 {
    if value > 0.0 { value.min(1.0) } else { 0.0 }
}

/// Finite and not negative; not a number becomes 0.
fn at_least_0(value: f32) -> f32 {
    if value > 0.0 {
        value.min(f32::MAX)
    } else {
        0.0
    }
}
