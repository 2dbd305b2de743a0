use super::instances::TracedInstances;
use super::problem::Fault;
use super::reading::{Reader, Switched};
use super::texture_data::TextureFault;
use super::textures::TracedTextures;
use super::traced::Draft;
use crate::scene::schema::quantity_of;
use crate::scene::{Alpha, Phong, PhongMap, PhongMaps, SceneId, UsesMaterial};
use crate::trace::{Map, Material, Object, Texture};
use bevy::asset::AssetId;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Changed, Or};
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::image::Image;
use bevy::platform::collections::{HashMap, HashSet};
use std::sync::Arc;

type Edited = Or<(
    Changed<Phong>,
    Changed<PhongMaps>,
    Changed<UsesMaterial>,
    Changed<SceneId>,
)>;

type PhongQuery<'w, 's> = Query<
    'w,
    's,
    (
        &'static SceneId,
        &'static Phong,
        Option<&'static PhongMaps>,
        Option<&'static Name>,
    ),
>;

/// Collects the materials that objects use, sorted by `SceneId`, and tells each object its own.
/// An object without any gets the default one.
pub(super) fn sync_materials(
    edited: Query<(), Edited>,
    mut no_phong: RemovedComponents<Phong>,
    mut no_maps: RemovedComponents<PhongMaps>,
    mut no_shared: RemovedComponents<UsesMaterial>,
    mut switched: Switched,
    sharing: Query<&UsesMaterial>,
    materials: PhongQuery,
    names: Query<&Name>,
    instances: Res<TracedInstances>,
    textures: Res<TracedTextures>,
    draft: ResMut<Draft>,
) {
    // Not `||`: every reader has to be emptied.
    let gone = no_phong.read().count() + no_maps.read().count() + no_shared.read().count();
    let switched = switched.any();
    let other = draft.other_objects || draft.changes.textures;
    if gone == 0 && !switched && edited.is_empty() && !other {
        return;
    }
    let draft = draft.into_inner();
    let problems = &mut draft.problems.materials;
    problems.clear();
    draft.reread = true;

    // Whose Phong each object uses.
    let mut users: Vec<Option<Entity>> = Vec::with_capacity(instances.rows.len());
    for row in &instances.rows {
        let shared = sharing.get(row.entity).ok().map(|shared| shared.0);
        if shared.is_some_and(|shared| !materials.contains(shared)) {
            Reader {
                kind: "object",
                id: row.id,
                name: names.get(row.entity).ok(),
                problems,
            }
            .note(Fault::NoMaterial);
        }
        users.push(
            shared
                .filter(|&shared| materials.contains(shared))
                .or(materials.contains(row.entity).then_some(row.entity)),
        );
    }
    let mut used: Vec<(SceneId, Entity)> = users
        .iter()
        .flatten()
        .filter_map(|&entity| materials.get(entity).ok().map(|(id, ..)| (*id, entity)))
        .collect();
    used.sort_unstable();
    used.dedup();

    let mut bound = BoundTextures::default();
    let mut places = HashMap::with_capacity(used.len());
    let mut list = Vec::with_capacity(used.len() + 1);
    for (id, entity) in used {
        let Ok((_, phong, maps, name)) = materials.get(entity) else {
            continue;
        };
        let mut reader = Reader {
            kind: "material",
            id,
            name,
            problems,
        };
        places.insert(entity, list.len() as u32);
        list.push(material(phong, maps, &mut reader, &textures, &mut bound));
    }
    if users.contains(&None) {
        list.push(Material::default());
    }
    let default_place = list.len().saturating_sub(1) as u32;
    let objects: Vec<Object> = instances
        .rows
        .iter()
        .zip(users)
        .map(|(row, user)| Object {
            id: row.id.0,
            material: user
                .and_then(|entity| places.get(&entity).copied())
                .unwrap_or(default_place),
            motion_samples: row.motion_samples,
            mesh: row.mesh.clone(),
        })
        .collect();

    if list != *draft.world.materials {
        draft.world.materials = Arc::new(list);
        draft.changes.materials = true;
    }
    if !same(&bound.list, &draft.world.textures, Arc::ptr_eq) {
        draft.world.textures = Arc::new(bound.list);
        draft.changes.textures = true;
    }
    if !same(&objects, &draft.world.objects, same_object) {
        draft.world.objects = Arc::new(objects);
        draft.changes.objects = true;
    }
}

fn same<T>(a: &[T], b: &[T], equal: impl Fn(&T, &T) -> bool) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| equal(a, b))
}

fn same_object(a: &Object, b: &Object) -> bool {
    (a.id, a.material, a.motion_samples) == (b.id, b.material, b.motion_samples)
        && Arc::ptr_eq(&a.mesh, &b.mesh)
}

/// Textures in the order in which the sorted materials name them first.
#[derive(Default)]
struct BoundTextures {
    list: Vec<Arc<Texture>>,
    places: HashMap<*const Texture, u32>,
    /// Pictures that a material uses, so that each is noted once.
    met: HashSet<AssetId<Image>>,
}

impl BoundTextures {
    fn place(&mut self, texture: &Arc<Texture>) -> u32 {
        *self.places.entry(Arc::as_ptr(texture)).or_insert_with(|| {
            self.list.push(texture.clone());
            self.list.len() as u32 - 1
        })
    }
}

/// The material with every number inside its range.
fn material(
    phong: &Phong,
    maps: Option<&PhongMaps>,
    reader: &mut Reader,
    textures: &TracedTextures,
    bound: &mut BoundTextures,
) -> Material {
    let alpha = match phong.alpha {
        Alpha::Mask { cutoff } => Alpha::Mask {
            cutoff: reader
                .number("alpha cutoff", cutoff, quantity_of::<Phong>("alpha.cutoff"))
                .unwrap_or(0.5),
        },
        other => other,
    };
    let unused = PhongMaps::default();
    let mut loaded = |of: PhongMap| {
        let handle = of.loaded(maps.unwrap_or(&unused));
        let fault = match (handle, of.source(phong)) {
            (Some(handle), _) => match textures.get(handle.id()) {
                Ok(map) => {
                    if bound.met.insert(handle.id()) {
                        reader.note_texels(of.name(), map.replaced);
                    }
                    return Some((handle.id(), map));
                }
                Err(fault) => fault,
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
    for (of, picture) in pictures {
        let Some((id, picture)) = picture else {
            continue;
        };
        if of == PhongMap::Opacity && alpha == Alpha::Opaque {
            continue;
        }
        let cuts_out = opacity.filter(|_| of.is_of_colors() && alpha != Alpha::Opaque);
        let cut_out = cuts_out.and_then(|opacity| textures.cut_out(id, opacity));
        let source = of.source(phong).unwrap_or(&picture.sampler);
        list.push(Map {
            of,
            texture: bound.place(cut_out.unwrap_or(&picture.texture)),
            wrap: [source.wrap_u, source.wrap_v],
            filter: source.filter,
            is_cut_out: cut_out.is_some(),
        });
    }
    let of = quantity_of::<Phong>;
    Material {
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
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::color::LinearRgba;

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
        let mut problems = Vec::new();
        let mut reader = Reader {
            kind: "material",
            id: SceneId(4),
            name: None,
            problems: &mut problems,
        };
        let textures = TracedTextures::default();
        let material = material(
            &phong,
            None,
            &mut reader,
            &textures,
            &mut BoundTextures::default(),
        );
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
