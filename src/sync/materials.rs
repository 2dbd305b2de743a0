use super::instances::{Row, TracedInstances};
use super::material_data::{BoundTextures, MaterialData};
use super::problem::{Fault, SyncProblem};
use super::reading::Switched;
use super::textures::TracedTextures;
use super::traced::Draft;
use crate::scene::{Phong, PhongMaps, SceneId, UsesMaterial};
use crate::trace::{Material, Object};
use bevy::ecs::entity::{Entity, EntityHashSet};
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Changed, Or, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut, SystemParam};
use bevy::platform::collections::HashSet;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The materials that objects have, and which object has which.
#[derive(Resource, Default)]
pub(super) struct TracedMaterials {
    /// Sorted by `SceneId`.
    worn: Vec<Worn>,
    /// One for each row of the objects, in their order.
    wearers: Vec<Wearer>,
    /// How many objects have no material.
    without: u32,
    /// Of objects that name a material which is gone.
    nameless: BTreeMap<SceneId, SyncProblem>,
}

/// A material that objects have.
struct Worn {
    id: SceneId,
    entity: Entity,
    /// How many have it.
    objects: u32,
    stale: bool,
    /// Whether it was ever.
    is_read: bool,
    data: MaterialData,
}

/// An object.
struct Wearer {
    id: SceneId,
    entity: Entity,
    wears: Wears,
    stale: bool,
}

/// Which material an object has.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Wears {
    /// It was not asked yet.
    Unread,
    /// None: it gets the default one.
    Default,
    /// That of the entity with this number.
    Material(SceneId),
}

/// What was found when objects were given their materials.
#[derive(Default)]
struct Dressed {
    /// A material came or went.
    list: bool,
    /// An object has another one.
    wearers: bool,
}

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

type OtherMaterial = (Or<(With<Phong>, With<UsesMaterial>)>, OtherPart);
type OtherPart = Or<(
    Changed<Phong>,
    Changed<PhongMaps>,
    Changed<UsesMaterial>,
    Changed<SceneId>,
    Changed<Name>,
)>;

/// Whose material, or which material, may be another one.
#[derive(SystemParam)]
pub(super) struct Edited<'w, 's> {
    changed: Query<'w, 's, Entity, OtherMaterial>,
    no_phong: RemovedComponents<'w, 's, Phong>,
    no_maps: RemovedComponents<'w, 's, PhongMaps>,
    no_shared: RemovedComponents<'w, 's, UsesMaterial>,
    no_id: RemovedComponents<'w, 's, SceneId>,
    no_name: RemovedComponents<'w, 's, Name>,
    switched: Switched<'w, 's>,
}

impl Edited<'_, '_> {
    fn read(&mut self) -> EntityHashSet {
        let gone = (self.no_phong.read())
            .chain(self.no_maps.read())
            .chain(self.no_shared.read())
            .chain(self.no_id.read())
            .chain(self.no_name.read());
        let all = gone.chain(self.switched.read());
        all.chain(&self.changed).collect()
    }
}

/// What materials are read from.
#[derive(SystemParam)]
pub(super) struct Scene<'w, 's> {
    numbers: Query<'w, 's, &'static SceneId>,
    names: Query<'w, 's, &'static Name>,
    sharing: Query<'w, 's, (Entity, &'static UsesMaterial)>,
    materials: PhongQuery<'w, 's>,
    textures: Res<'w, TracedTextures>,
}

/// Collects the materials that objects use, sorted by `SceneId`, and tells each object its own.
/// An object without any gets the default one.
pub(super) fn sync_materials(
    mut edited: Edited,
    scene: Scene,
    instances: Res<TracedInstances>,
    known: ResMut<TracedMaterials>,
    draft: ResMut<Draft>,
) {
    let (known, draft) = (known.into_inner(), draft.into_inner());
    let mut touched = edited.read();
    touched.extend(scene.textures.users_of_news());
    if draft.anew {
        touched.extend(known.worn.iter().map(|worn| worn.entity));
        touched.extend(instances.rows.iter().map(|row| row.entity));
    }
    if touched.is_empty() && !draft.other_objects {
        return;
    }
    let sharing = scene.sharing.iter();
    let naming = sharing.filter(|(_, shared)| touched.contains(&shared.0));
    let naming: Vec<Entity> = naming.map(|(entity, _)| entity).collect();
    touched.extend(naming);

    let had_default = known.without > 0;
    if draft.other_objects {
        known.follow(&instances.rows);
    }
    for &entity in &touched {
        known.mark(entity, &scene);
    }
    let dressed = known.dress(&scene);
    let other_looks = known.read(&scene);
    if dressed.list || other_looks || had_default != (known.without > 0) {
        known.show(draft);
    }
    if draft.other_objects || dressed.list || dressed.wearers {
        known.show_objects(&instances.rows, draft);
    }
    let problems = known.problems();
    if problems != draft.problems.materials {
        draft.problems.materials = problems;
        draft.reread = true;
    }
}

impl TracedMaterials {
    fn place(&self, id: SceneId) -> Result<usize, usize> {
        self.worn.binary_search_by_key(&id, |worn| worn.id)
    }

    /// Makes the wearers those of these rows.
    fn follow(&mut self, rows: &[Row]) {
        let mut known = std::mem::take(&mut self.wearers).into_iter().peekable();
        let mut wearers = Vec::with_capacity(rows.len());
        for row in rows {
            while let Some(gone) = known.next_if(|wearer| wearer.id < row.id) {
                self.take_off(&gone);
            }
            match known.next_if(|wearer| wearer.id == row.id) {
                Some(wearer) if wearer.entity == row.entity => {
                    wearers.push(wearer);
                    continue;
                }
                Some(gone) => self.take_off(&gone),
                None => {}
            }
            wearers.push(Wearer {
                id: row.id,
                entity: row.entity,
                wears: Wears::Unread,
                stale: true,
            });
        }
        for gone in known {
            self.take_off(&gone);
        }
        self.wearers = wearers;
    }

    /// One object less has the material.
    fn take_off(&mut self, wearer: &Wearer) {
        self.nameless.remove(&wearer.id);
        match wearer.wears {
            Wears::Unread => {}
            Wears::Default => self.without -= 1,
            Wears::Material(id) => {
                if let Ok(place) = self.place(id) {
                    self.worn[place].objects -= 1;
                }
            }
        }
    }

    /// The entity is to be read again, as an object and as a material.
    fn mark(&mut self, entity: Entity, scene: &Scene) {
        let Ok(id) = scene.numbers.get(entity) else {
            return;
        };
        let wearer = self.wearers.binary_search_by_key(id, |wearer| wearer.id);
        if let Ok(wearer) = wearer.map(|place| &mut self.wearers[place]) {
            wearer.stale |= wearer.entity == entity;
        }
        if let Ok(worn) = self.place(*id).map(|place| &mut self.worn[place]) {
            worn.stale |= worn.entity == entity;
        }
    }

    /// Gives each object that may have another material the one that it has now.
    fn dress(&mut self, scene: &Scene) -> Dressed {
        let mut dressed = Dressed::default();
        let mut comes: BTreeMap<SceneId, (Entity, u32)> = BTreeMap::new();
        let mut wearers = std::mem::take(&mut self.wearers);
        for wearer in wearers.iter_mut().filter(|wearer| wearer.stale) {
            wearer.stale = false;
            self.take_off(wearer);
            let before = wearer.wears;
            let is_material = |entity: &Entity| scene.materials.contains(*entity);
            let shared = scene.sharing.get(wearer.entity);
            let shared = shared.ok().map(|(_, shared)| shared.0);
            if shared.is_some_and(|shared| !is_material(&shared)) {
                let name = scene.names.get(wearer.entity).ok();
                let problem = SyncProblem::new("object", wearer.id, name, Fault::NoMaterial);
                self.nameless.insert(wearer.id, problem);
            }
            let own = Some(wearer.entity).filter(is_material);
            let of = shared.filter(is_material).or(own);
            let of = of.and_then(|of| Some((*scene.materials.get(of).ok()?.0, of)));
            wearer.wears = of.map_or(Wears::Default, |(id, _)| Wears::Material(id));
            dressed.wearers |= wearer.wears != before;
            let Some((id, entity)) = of else {
                self.without += 1;
                continue;
            };
            if let Ok(place) = self.place(id) {
                let worn = &mut self.worn[place];
                worn.objects += 1;
                // The number may have gone to another.
                if worn.entity != entity {
                    worn.entity = entity;
                    worn.stale = true;
                    worn.is_read = false;
                }
            } else {
                comes.entry(id).or_insert((entity, 0)).1 += 1;
            }
        }
        self.wearers = wearers;
        let before = self.worn.len();
        self.worn.retain(|worn| worn.objects > 0);
        dressed.list = self.worn.len() < before || !comes.is_empty();
        if !comes.is_empty() {
            let comes = comes.into_iter().map(|(id, (entity, objects))| Worn {
                id,
                entity,
                objects,
                stale: true,
                is_read: false,
                data: MaterialData::default(),
            });
            self.worn.extend(comes);
            self.worn.sort_by_key(|worn| worn.id);
        }
        dressed
    }

    /// Reads the materials that may be others, and says whether any looks different.
    fn read(&mut self, scene: &Scene) -> bool {
        let mut others = false;
        for worn in self.worn.iter_mut().filter(|worn| worn.stale) {
            worn.stale = false;
            let Ok((id, phong, maps, name)) = scene.materials.get(worn.entity) else {
                continue;
            };
            let data = MaterialData::of(*id, name, phong, maps, &scene.textures);
            let is_new = !std::mem::replace(&mut worn.is_read, true);
            if data.waits && !is_new {
                // It stays as it was until its pictures are there, and is read again then.
                continue;
            }
            others |= !data.looks_like(&worn.data);
            worn.data = data;
        }
        others
    }

    /// The materials and their textures, as the world has them.
    fn show(&self, draft: &mut Draft) {
        let mut bound = BoundTextures::default();
        let worn = self.worn.iter();
        let mut list: Vec<Material> = worn.map(|worn| worn.data.bind(&mut bound)).collect();
        if self.without > 0 {
            list.push(Material::default());
        }
        if list != *draft.world.materials {
            draft.world.materials = Arc::new(list);
            draft.changes.materials = true;
        }
        if !same(&bound.list, &draft.world.textures, Arc::ptr_eq) {
            draft.world.textures = Arc::new(bound.list);
            draft.changes.textures = true;
        }
    }

    /// Which object has which material, as the world has it.
    fn show_objects(&self, rows: &[Row], draft: &mut Draft) {
        let mut guess = 0;
        let rows = rows.iter().zip(&self.wearers);
        let objects: Vec<Object> = rows
            .map(|(row, wearer)| {
                let place = match wearer.wears {
                    // Mostly each has its own.
                    Wears::Material(id) => match self.worn.get(guess) {
                        Some(worn) if worn.id == id => guess,
                        _ => self.place(id).unwrap_or_default(),
                    },
                    _ => self.worn.len(),
                };
                guess = place + 1;
                Object {
                    id: row.id.0,
                    material: place as u32,
                    motion_samples: row.motion_samples,
                    mesh: row.mesh.clone(),
                }
            })
            .collect();
        if !same(&objects, &draft.world.objects, same_object) {
            draft.world.objects = Arc::new(objects);
            draft.changes.objects = true;
        }
    }

    fn problems(&self) -> Vec<SyncProblem> {
        let mut met = HashSet::default();
        let mut problems: Vec<SyncProblem> = self.nameless.values().cloned().collect();
        for worn in &self.worn {
            problems.extend(worn.data.problems(&mut met).cloned());
        }
        problems
    }
}

fn same<T>(a: &[T], b: &[T], equal: impl Fn(&T, &T) -> bool) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| equal(a, b))
}

fn same_object(a: &Object, b: &Object) -> bool {
    (a.id, a.material, a.motion_samples) == (b.id, b.material, b.motion_samples)
        && Arc::ptr_eq(&a.mesh, &b.mesh)
}
