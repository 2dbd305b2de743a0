//! A material's components as the tracer keeps it.

use super::problem::{Fault, SyncProblem};
use super::reading::Reader;
use super::texture_data::TextureFault;
use super::textures::TracedTextures;
use crate::scene::schema::quantity_of;
use crate::scene::{Alpha, Phong, PhongMap, PhongMaps, SceneId};
use crate::trace::{Map, Material, Texture};
use bevy::asset::AssetId;
use bevy::ecs::name::Name;
use bevy::image::Image;
use bevy::platform::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A material, its textures not yet among those of a world.
#[derive(Default)]
pub(super) struct MaterialData {
    /// Its maps name [`textures`](Self::textures).
    material: Material,
    textures: Vec<Arc<Texture>>,
    problems: Vec<SyncProblem>,
    /// Which of the problems are of a picture's texels, and of which picture: they are said once of each,
    /// however many materials have it.
    texels: Vec<(usize, AssetId<Image>)>,
    /// Whether it is without a picture that is still being converted or cut out.
    pub waits: bool,
}

impl MaterialData {
    /// Reads it.
    pub fn of(
        id: SceneId,
        name: Option<&Name>,
        phong: &Phong,
        maps: Option<&PhongMaps>,
        textures: &TracedTextures,
    ) -> Self {
        let mut problems = Vec::new();
        let mut reader = Reader {
            kind: "material",
            id,
            name,
            problems: &mut problems,
        };
        Self::read(phong, maps, &mut reader, textures)
    }

    /// Whether it looks the same.
    pub fn looks_like(&self, other: &Self) -> bool {
        let same = |(a, b): (&Arc<Texture>, &Arc<Texture>)| Arc::ptr_eq(a, b);
        self.material == other.material
            && self.textures.len() == other.textures.len()
            && self.textures.iter().zip(&other.textures).all(same)
    }

    /// As a material of the world whose textures are being bound.
    pub fn bind(&self, bound: &mut BoundTextures) -> Material {
        let mut material = self.material.clone();
        for map in &mut material.maps {
            map.texture = bound.place(&self.textures[map.texture as usize]);
        }
        material
    }

    /// What is wrong with it, but for what was said of a picture that is in `met`.
    pub fn problems<'a>(
        &'a self,
        met: &'a mut HashSet<AssetId<Image>>,
    ) -> impl Iterator<Item = &'a SyncProblem> {
        let problems = self.problems.iter().enumerate();
        let said = problems.filter(|(number, _)| {
            let of = self.texels.iter().find(|(of, _)| of == number);
            of.is_none_or(|(_, picture)| met.insert(*picture))
        });
        said.map(|(_, problem)| problem)
    }

    /// The material with every number inside its range.
    fn read(
        phong: &Phong,
        maps: Option<&PhongMaps>,
        reader: &mut Reader,
        textures: &TracedTextures,
    ) -> Self {
        let alpha = match phong.alpha {
            Alpha::Mask { cutoff } => Alpha::Mask {
                cutoff: reader
                    .number("alpha cutoff", cutoff, quantity_of::<Phong>("alpha.cutoff"))
                    .unwrap_or(0.5),
            },
            other => other,
        };
        let unused = PhongMaps::default();
        let mut texels = Vec::new();
        let mut waits = false;
        let mut loaded = |of: PhongMap| {
            let handle = of.loaded(maps.unwrap_or(&unused));
            let fault = match (handle, of.source(phong)) {
                (Some(handle), _) => match textures.get(handle.id()) {
                    None => {
                        waits = true;
                        return None;
                    }
                    Some(Ok(map)) => {
                        let before = reader.problems.len();
                        reader.note_texels(of.name(), map.replaced);
                        texels.extend(
                            (reader.problems.len() > before).then_some((before, handle.id())),
                        );
                        return Some((handle.id(), map));
                    }
                    Some(Err(fault)) => fault,
                },
                (None, Some(source)) => TextureFault::Unresolved(source.path.clone()),
                (None, None) => return None,
            };
            let field = of.name();
            reader.note(Fault::Texture { field, fault });
            None
        };
        let pictures = PhongMap::ALL.map(|of| (of, loaded(of)));
        let opacity = pictures.iter().find(|(of, _)| *of == PhongMap::Opacity);
        let opacity = opacity.and_then(|(_, picture)| *picture).map(|(id, _)| id);
        let mut list = Vec::new();
        let mut bound = Vec::new();
        for (of, picture) in pictures {
            let Some((id, picture)) = picture else {
                continue;
            };
            if of == PhongMap::Opacity && alpha == Alpha::Opaque {
                continue;
            }
            let cuts_out = opacity.filter(|_| of.is_of_colors() && alpha != Alpha::Opaque);
            let pair = cuts_out.map(|opacity| [id, opacity]);
            if pair.is_some_and(|pair| textures.is_being_cut_out(pair)) {
                waits = true;
                continue;
            }
            let cut_out = pair.and_then(|pair| textures.cut_out(pair));
            let source = of.source(phong).unwrap_or(&picture.sampler);
            bound.push(cut_out.unwrap_or(&picture.texture).clone());
            list.push(Map {
                of,
                texture: list.len() as u32,
                wrap: [source.wrap_u, source.wrap_v],
                filter: source.filter,
                is_cut_out: cut_out.is_some(),
            });
        }
        let of = quantity_of::<Phong>;
        let material = Material {
            diffuse: reader.color("diffuse", phong.diffuse, of("diffuse")),
            specular: reader.color("specular", phong.specular, of("specular")),
            mirror: reader.color("mirror", phong.mirror, of("mirror")),
            shininess: reader
                .number("shininess", phong.shininess, of("shininess"))
                .unwrap_or(1.0),
            opacity: reader
                .number("opacity", phong.opacity, of("opacity"))
                .unwrap_or(1.0),
            emission: reader.color("emission", phong.emission, of("emission")),
            alpha,
            normal_scale: reader
                .number("normal scale", phong.normal_scale, of("normal_scale"))
                .unwrap_or(1.0),
            maps: list,
        };
        let problems = std::mem::take(reader.problems);
        Self {
            material,
            textures: bound,
            problems,
            texels,
            waits,
        }
    }
}

/// Textures in the order in which the sorted materials name them first.
#[derive(Default)]
pub(super) struct BoundTextures {
    pub list: Vec<Arc<Texture>>,
    places: HashMap<*const Texture, u32>,
}

impl BoundTextures {
    fn place(&mut self, texture: &Arc<Texture>) -> u32 {
        *self.places.entry(Arc::as_ptr(texture)).or_insert_with(|| {
            self.list.push(texture.clone());
            self.list.len() as u32 - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::color::LinearRgba;

    #[test]
    fn a_shininess_of_which_f32_tells_nothing_is_the_most_that_it_tells_and_is_named() {
        let phong = Phong {
            shininess: 1e9,
            ..Phong::default()
        };
        let textures = TracedTextures::default();
        let found = MaterialData::of(SceneId(4), None, &phong, None, &textures);
        assert_eq!(found.material.shininess, 1e6);
        assert_eq!(found.problems.len(), 1, "{:?}", found.problems);
    }

    #[test]
    fn numbers_out_of_range_are_moved_into_it_and_named() {
        let phong = Phong {
            diffuse: LinearRgba::rgb(0.5, 2.0, 0.5),
            specular: LinearRgba::rgb(f32::NAN, 0.0, 0.0),
            mirror: LinearRgba::rgb(0.0, -1.0, 0.0),
            shininess: 0.0,
            opacity: -3.0,
            emission: LinearRgba::rgb(9.0, 0.0, 0.0),
            ..Phong::default()
        };
        let textures = TracedTextures::default();
        let MaterialData {
            material, problems, ..
        } = MaterialData::of(SceneId(4), None, &phong, None, &textures);
        assert_eq!(material.diffuse.to_array(), [0.5, 1.0, 0.5]);
        assert_eq!(material.specular.to_array(), [0.0; 3]);
        assert_eq!(material.mirror.to_array(), [0.0; 3]);
        assert_eq!((material.shininess, material.opacity), (1.0, 0.0));
        assert_eq!(material.emission.to_array(), [9.0, 0.0, 0.0]);
        let named: Vec<String> = problems.iter().map(ToString::to_string).collect();
        assert_eq!(named.len(), 5, "{named:#?}");
        assert!(
            named[0].starts_with("material 4: its diffuse is 2"),
            "{}",
            named[0]
        );
    }
}
