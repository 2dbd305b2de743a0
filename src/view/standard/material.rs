//! Bevy's material as ours.

use super::add_material::Surface;
use super::derived::Pictures;
use crate::scene::{Alpha, Phong, PhongMaps};
use bevy::camera::Exposure;
use bevy::color::{ColorToComponents, LinearRgba};
use bevy::math::{Affine2, Vec3};
use bevy::mesh::UvChannel;
use bevy::pbr::StandardMaterial;
use bevy::prelude::AlphaMode;
use bevy::render::render_resource::Face;

/// The narrowest highlight that is told from a mirror.
const MOST_SHININESS: f32 = 10_000.0;

/// Ours, and what of Bevy's is left out.
pub(super) fn surface(material: &StandardMaterial, pictures: &mut Pictures) -> Surface {
    let mut left_out = left_out(material);
    let (mut rough, mut metal) = (
        material.perceptual_roughness.clamp(0.0, 1.0),
        material.metallic.clamp(0.0, 1.0),
    );
    if let Some(map) = &material.metallic_roughness_texture {
        left_out.push("its map of metalness and roughness counts with its mean".into());
        if let Some([_, green, blue]) = pictures.mean(map) {
            rough *= green;
            metal *= blue;
        }
    }
    let base = &material.base_color_texture;
    if base.is_some() && metal > 0.0 && metal < 1.0 {
        left_out.push(
            "it is partly metal: highlights take the colour of its map where more than half is"
                .into(),
        );
    }
    let phong = phong(material, rough, metal);
    let maps = if material.unlit {
        PhongMaps {
            emission: base.clone(),
            ..PhongMaps::default()
        }
    } else {
        let metal = base.as_ref().filter(|_| metal > 0.5);
        PhongMaps {
            diffuse: base.clone(),
            specular: metal.cloned(),
            mirror: metal.cloned(),
            emission: material.emissive_texture.clone(),
            normal: material.normal_map_texture.clone(),
            ..PhongMaps::default()
        }
    };
    let fades = phong.alpha != Alpha::Opaque;
    let opacity = base.as_ref().filter(|_| fades);
    let maps = PhongMaps {
        opacity: opacity.and_then(|base| pictures.alpha(base)),
        ..maps
    };
    Surface {
        phong,
        maps,
        left_out,
    }
}

/// Without maps, with this roughness and metalness in place of the material's.
fn phong(material: &StandardMaterial, rough: f32, metal: f32) -> Phong {
    let color = |v: Vec3| LinearRgba::rgb(v.x, v.y, v.z);
    let unit = |v: Vec3| v.clamp(Vec3::ZERO, Vec3::ONE);
    let base = LinearRgba::from(material.base_color);
    let (alpha, opacity) = opacity(material, base.alpha.clamp(0.0, 1.0));
    let base = base.to_vec3();
    if material.unlit {
        return Phong {
            diffuse: LinearRgba::BLACK,
            specular: LinearRgba::BLACK,
            mirror: LinearRgba::BLACK,
            emission: color(base.max(Vec3::ZERO)),
            opacity,
            alpha,
            ..Phong::default()
        };
    }
    let base = unit(base);
    let gloss = (1.0 - rough).powi(2);
    let tint = LinearRgba::from(material.specular_tint).to_vec3();
    let dielectric = unit(0.16 * material.reflectance * material.reflectance * tint);
    let specular = color(unit(dielectric.lerp(base, metal) * gloss));
    // A part of it is exposed as lit surfaces are.
    let exposed = material.emissive_exposure_weight;
    let emission = 1.0 + (Exposure::default().exposure() - 1.0) * exposed;
    Phong {
        diffuse: color(base * (1.0 - metal * gloss)),
        specular,
        mirror: specular,
        shininess: (2.0 / rough.powi(4) - 2.0).clamp(1.0, MOST_SHININESS),
        emission: color(material.emissive.to_vec3().max(Vec3::ZERO) * emission),
        opacity,
        alpha,
        ..Phong::default()
    }
}

/// How what fades does so, and how much is there. Light that is transmitted goes straight through.
fn opacity(material: &StandardMaterial, alpha: f32) -> (Alpha, f32) {
    let through = material.specular_transmission.clamp(0.0, 1.0);
    match material.alpha_mode {
        AlphaMode::Opaque if through > 0.0 => (Alpha::Blend, 1.0 - through),
        AlphaMode::Opaque => (Alpha::Opaque, alpha),
        AlphaMode::Mask(cutoff) => (Alpha::Mask { cutoff }, alpha),
        _ => (Alpha::Blend, alpha * (1.0 - through)),
    }
}

/// What the tracer has nothing for.
fn left_out(material: &StandardMaterial) -> Vec<String> {
    let maps = [
        (&material.base_color_texture, &material.base_color_channel),
        (&material.emissive_texture, &material.emissive_channel),
        (&material.normal_map_texture, &material.normal_map_channel),
    ];
    let any_map = maps.iter().any(|(map, _)| map.is_some());
    let is_second = |channel: &UvChannel| matches!(channel, UvChannel::Uv1);
    let mut used = maps.iter().filter(|(map, _)| map.is_some());
    let flipped = material.flip_normal_map_y && material.normal_map_texture.is_some();
    let alpha_mode = match material.alpha_mode {
        AlphaMode::Premultiplied => Some("premultiplied"),
        AlphaMode::Add => Some("additive"),
        AlphaMode::Multiply => Some("multiplying"),
        _ => None,
    };
    let notes = [
        (
            any_map && material.uv_transform != Affine2::IDENTITY,
            "its uv_transform is left out: maps lie as the mesh's texture coordinates say",
        ),
        (
            used.any(|(_, channel)| is_second(channel)),
            "its second texture coordinates are left out: the first place all maps",
        ),
        (
            material.occlusion_texture.is_some(),
            "its occlusion map is left out: no light comes from all around",
        ),
        (material.depth_map.is_some(), "its depth map is left out"),
        (flipped, "its normal map is not flipped: green is up"),
        (material.clearcoat > 0.0, "its clearcoat is left out"),
        (
            material.anisotropy_strength != 0.0,
            "its anisotropy is left out",
        ),
        (
            material.diffuse_transmission > 0.0,
            "its diffuse transmission is left out",
        ),
        (
            material.specular_transmission > 0.0,
            "its transmission is opacity: light goes straight through",
        ),
        (
            material.cull_mode == Some(Face::Front),
            "its culling is left out: both sides are seen",
        ),
    ];
    let notes = notes.into_iter().filter(|(is_so, _)| *is_so);
    let mut notes: Vec<String> = notes.map(|(_, note)| note.into()).collect();
    if let Some(mode) = alpha_mode {
        notes.push(format!("its {mode} alpha blends"));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::super::derived::DerivedPictures;
    use super::*;
    use bevy::asset::{Assets, RenderAssetUsages};
    use bevy::color::Color;
    use bevy::image::Image;
    use bevy::prelude::default;
    use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

    fn mapped(material: &StandardMaterial) -> Surface {
        mapped_with(material, &mut Assets::default())
    }

    fn mapped_with(material: &StandardMaterial, images: &mut Assets<Image>) -> Surface {
        let derived = &mut DerivedPictures::default();
        surface(material, &mut Pictures { images, derived })
    }

    fn red() -> Color {
        Color::linear_rgb(0.8, 0.1, 0.1)
    }

    fn picture(pixels: &[[u8; 4]]) -> Image {
        Image::new(
            Extent3d {
                width: pixels.len() as u32,
                ..default()
            },
            TextureDimension::D2,
            pixels.concat(),
            TextureFormat::Rgba8Unorm,
            RenderAssetUsages::MAIN_WORLD,
        )
    }

    #[test]
    fn a_matte_material_is_matte_and_a_metal_mirrors_in_its_colour() {
        let matte = mapped(&StandardMaterial {
            base_color: red(),
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            ..default()
        });
        assert_eq!(matte.phong.diffuse, LinearRgba::rgb(0.8, 0.1, 0.1));
        assert_eq!(matte.phong.specular.to_vec3(), Vec3::ZERO);
        assert_eq!(matte.phong.shininess, 1.0);
        let metal = mapped(&StandardMaterial {
            base_color: red(),
            metallic: 1.0,
            perceptual_roughness: 0.1,
            ..default()
        });
        let mirrored = metal.phong.mirror.to_vec3() / Vec3::new(0.8, 0.1, 0.1);
        assert!((mirrored - 0.81).abs().max_element() < 1e-6, "{mirrored}");
        assert_eq!(metal.phong.shininess, MOST_SHININESS);
    }

    #[test]
    fn a_rough_metal_scatters_what_it_does_not_mirror() {
        let rough = mapped(&StandardMaterial {
            base_color: red(),
            perceptual_roughness: 1.0,
            metallic: 1.0,
            ..default()
        });
        assert_eq!(rough.phong.mirror.to_vec3(), Vec3::ZERO, "it is a mirror");
        assert_eq!(rough.phong.diffuse, LinearRgba::rgb(0.8, 0.1, 0.1));
    }

    #[test]
    fn an_opaque_material_is_opaque_whatever_its_alpha() {
        let see_through = StandardMaterial {
            base_color: Color::linear_rgba(1.0, 1.0, 1.0, 0.25),
            ..default()
        };
        let mode = |alpha_mode| {
            let material = StandardMaterial {
                alpha_mode,
                ..see_through.clone()
            };
            let phong = mapped(&material).phong;
            (phong.alpha, phong.opacity)
        };
        assert_eq!(mode(AlphaMode::Opaque).0, Alpha::Opaque);
        assert_eq!(mode(AlphaMode::Mask(0.3)).0, Alpha::Mask { cutoff: 0.3 });
        assert_eq!(mode(AlphaMode::Blend), (Alpha::Blend, 0.25));
    }

    #[test]
    fn a_mask_is_cut_out_by_the_alpha_of_its_picture_and_an_opaque_one_is_not() {
        let mut images = Assets::default();
        let leaf = images.add(picture(&[[10, 20, 30, 255], [10, 20, 30, 64]]));
        let mut material = StandardMaterial {
            base_color_texture: Some(leaf.clone()),
            alpha_mode: AlphaMode::Mask(0.5),
            ..default()
        };
        let maps = mapped_with(&material, &mut images).maps;
        let alpha = images.get(&maps.opacity.unwrap()).unwrap();
        assert_eq!(alpha.data.as_deref(), Some(&[255, 64][..]));
        assert_eq!(maps.diffuse, Some(leaf));
        material.alpha_mode = AlphaMode::Opaque;
        assert_eq!(mapped_with(&material, &mut images).maps.opacity, None);
    }

    #[test]
    fn a_picture_of_metalness_and_roughness_counts_with_its_mean() {
        let mut images = Assets::default();
        let map = images.add(picture(&[[0, 255, 255, 255], [0, 0, 255, 255]]));
        let mapped = mapped_with(
            &StandardMaterial {
                base_color: Color::WHITE,
                metallic: 1.0,
                perceptual_roughness: 1.0,
                metallic_roughness_texture: Some(map),
                ..default()
            },
            &mut images,
        );
        // Half as rough: a gloss of a quarter.
        assert!((mapped.phong.mirror.red - 0.25).abs() < 1e-6);
        assert_eq!(mapped.left_out.len(), 1, "{:?}", mapped.left_out);
    }

    #[test]
    fn an_unlit_material_shows_its_colour_by_itself() {
        let phong = mapped(&StandardMaterial {
            base_color: red(),
            unlit: true,
            ..default()
        })
        .phong;
        assert_eq!(phong.emission, LinearRgba::rgb(0.8, 0.1, 0.1));
        let others = [phong.diffuse, phong.specular, phong.mirror];
        assert_eq!(others, [LinearRgba::BLACK; 3]);
    }

    #[test]
    fn what_has_nothing_that_it_could_become_is_named() {
        assert!(mapped(&StandardMaterial::default()).left_out.is_empty());
        let material = StandardMaterial {
            clearcoat: 1.0,
            diffuse_transmission: 0.5,
            specular_transmission: 0.5,
            alpha_mode: AlphaMode::Add,
            occlusion_texture: Some(default()),
            base_color_texture: Some(default()),
            base_color_channel: UvChannel::Uv1,
            uv_transform: Affine2::from_scale(bevy::math::Vec2::splat(2.0)),
            ..default()
        };
        let named = mapped(&material).left_out;
        assert_eq!(named.len(), 7, "{named:#?}");
    }
}
