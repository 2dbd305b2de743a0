//! Any kind of material, mapped by a function of the app's.

use super::derived::{DerivedPictures, Pictures};
use super::returned::Returned;
use super::unknown::KnownMaterials;
use super::{Mapped, MappingSystems, material};
use crate::scene::{NotTraced, Phong, PhongMaps};
use crate::sync::LeftOut;
use bevy::asset::{AssetEvent, Assets};
use bevy::image::Image;
use bevy::pbr::{Material, MeshMaterial3d, StandardMaterial};
use bevy::platform::collections::HashSet;
use bevy::prelude::{
    App, Changed, Commands, DetectChanges, DetectChangesMut, Entity, IntoScheduleConfigs,
    MessageReader, PostUpdate, Query, RemovedComponents, Res, ResMut, Resource, Without,
};

/// A material as ours, and what is left out of it.
pub(super) struct Surface {
    pub phong: Phong,
    pub maps: PhongMaps,
    pub left_out: Vec<String>,
}

/// What a material of an app's own is traced as; a [`Phong`], one with its [`PhongMaps`] and a `StandardMaterial` become
/// it by `into`.
#[derive(Clone, Debug)]
pub enum TracedAs {
    /// Ours, with pictures of the app's.
    Phong(Box<Phong>, PhongMaps),
    /// What Bevy's material is traced as, by the table of [`standard`](super): for one that extends it.
    Standard(Box<StandardMaterial>),
}

impl From<Phong> for TracedAs {
    fn from(phong: Phong) -> Self {
        (phong, PhongMaps::default()).into()
    }
}

impl From<(Phong, PhongMaps)> for TracedAs {
    fn from((phong, maps): (Phong, PhongMaps)) -> Self {
        Self::Phong(Box::new(phong), maps)
    }
}

impl From<StandardMaterial> for TracedAs {
    fn from(material: StandardMaterial) -> Self {
        Self::Standard(Box::new(material))
    }
}

impl TracedAs {
    fn surface(self, pictures: &mut Pictures) -> Surface {
        match self {
            Self::Phong(phong, maps) => Surface {
                phong: *phong,
                maps,
                left_out: Vec::new(),
            },
            Self::Standard(standard) => material::surface(&standard, pictures),
        }
    }
}

/// Traces materials of an app's own.
pub trait AddTracedMaterial {
    /// Objects with this material are traced as the function says, now and whenever it is edited. Needs
    /// [`StandardMappingPlugin`](super::StandardMappingPlugin), before or after.
    ///
    /// ```no_run
    /// # use bevy::pbr::{ExtendedMaterial, MaterialExtension};
    /// # use bevy::prelude::*;
    /// # use bevy::render::render_resource::AsBindGroup;
    /// # use glassbox::prelude::*;
    /// #[derive(Asset, AsBindGroup, TypePath, Clone)]
    /// struct Poster {
    ///     #[texture(0)]
    ///     #[sampler(1)]
    ///     picture: Handle<Image>,
    /// }
    /// # impl Material for Poster {}
    /// # #[derive(Asset, AsBindGroup, TypePath, Clone)]
    /// # struct Wet {}
    /// # impl MaterialExtension for Wet {}
    /// # fn build(app: &mut App) {
    /// // With pictures …
    /// app.add_traced_material(|poster: &Poster| {
    ///     let diffuse = Some(poster.picture.clone());
    ///     (Phong::default(), PhongMaps { diffuse, ..default() })
    /// });
    /// // … and as the material that it extends.
    /// app.add_traced_material(|wet: &ExtendedMaterial<StandardMaterial, Wet>| wet.base.clone());
    /// # }
    /// ```
    fn add_traced_material<M: Material, T: Into<TracedAs> + 'static>(
        &mut self,
        traced_as: fn(&M) -> T,
    ) -> &mut Self;
}

impl AddTracedMaterial for App {
    fn add_traced_material<M: Material, T: Into<TracedAs> + 'static>(
        &mut self,
        traced_as: fn(&M) -> T,
    ) -> &mut Self {
        let is_new = !self.world().contains_resource::<Mapping<M>>();
        register(self, move |material: &M, pictures| {
            traced_as(material).into().surface(pictures)
        });
        if is_new {
            self.init_resource::<DerivedPictures>()
                .init_resource::<LeftOut>()
                .add_systems(
                    PostUpdate,
                    map_materials::<M>
                        .in_set(MappingSystems)
                        .before(super::unknown::name_unknown)
                        .before(crate::sync::SyncSystems),
                );
        }
        self
    }
}

/// How one kind of material is mapped.
#[derive(Resource)]
pub(super) struct Mapping<M: Material>(Box<dyn Fn(&M, &mut Pictures) -> Surface + Send + Sync>);

/// From now on this kind of material is known.
pub(super) fn register<M: Material>(
    app: &mut App,
    surface: impl Fn(&M, &mut Pictures) -> Surface + Send + Sync + 'static,
) {
    app.insert_resource(Mapping::<M>(Box::new(surface)));
    let mut known = app.world_mut().get_resource_or_init::<KnownMaterials>();
    known.insert::<MeshMaterial3d<M>>();
}

/// Whose material, and what it was mapped to.
type Objects<'w, 's, M> = Query<
    'w,
    's,
    (
        Entity,
        &'static MeshMaterial3d<M>,
        Option<&'static Mapped<(Phong, PhongMaps)>>,
    ),
    Without<NotTraced>,
>;

/// Keeps ours beside a material of this kind.
pub(super) fn map_materials<M: Material>(
    mut commands: Commands,
    mapping: Res<Mapping<M>>,
    assets: Res<Assets<M>>,
    mut images: ResMut<Assets<Image>>,
    mut derived: ResMut<DerivedPictures>,
    mut left_out: ResMut<LeftOut>,
    mut events: MessageReader<AssetEvent<M>>,
    edited: Query<Entity, Changed<MeshMaterial3d<M>>>,
    objects: Objects<M>,
    mut gone: RemovedComponents<MeshMaterial3d<M>>,
    mut returned: Returned,
) {
    for entity in returned.no_longer() {
        LeftOut::note(&mut left_out, "material", entity, Vec::new());
    }
    for entity in gone.read() {
        // What was taken away and given back is there.
        if objects.contains(entity) {
            continue;
        }
        LeftOut::note(&mut left_out, "material", entity, Vec::new());
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.try_remove::<(Phong, PhongMaps, Mapped<(Phong, PhongMaps)>)>();
        }
    }
    let changed: HashSet<_> = events
        .read()
        .filter_map(|event| match event {
            AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } => {
                Some(*id)
            }
            _ => None,
        })
        .collect();
    let all = derived.is_changed() || mapping.is_changed();
    let edited = edited.iter().chain(returned.read());
    let edited: Vec<Entity> = if all || !changed.is_empty() {
        let worn = objects.iter();
        let worn = worn.filter(|(_, worn, _)| all || changed.contains(&worn.0.id()));
        worn.map(|(entity, ..)| entity).chain(edited).collect()
    } else {
        edited.collect()
    };
    if edited.is_empty() {
        return;
    }
    let mut pictures = Pictures {
        images: images.bypass_change_detection(),
        derived: derived.bypass_change_detection(),
    };
    for entity in edited {
        let Ok((entity, worn, mapped)) = objects.get(entity) else {
            continue;
        };
        let Some(material) = assets.get(&worn.0) else {
            // Bevy draws nothing of it until it is there.
            let what = "its material is not loaded; drawn without it".to_owned();
            LeftOut::note(&mut left_out, "material", entity, vec![what]);
            if mapped.is_some() {
                let mut entity = commands.entity(entity);
                entity.try_remove::<(Phong, PhongMaps, Mapped<(Phong, PhongMaps)>)>();
            }
            continue;
        };
        let surface = (mapping.0)(material, &mut pictures);
        LeftOut::note(&mut left_out, "material", entity, surface.left_out);
        let ours = (surface.phong, surface.maps);
        if mapped.is_none_or(|mapped| mapped.0 != ours) {
            commands.entity(entity).insert((ours.clone(), Mapped(ours)));
        }
    }
}
