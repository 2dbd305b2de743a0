//! A scene to which random edits are made, and a fresh app with the same entities.

use super::dice::Dice;
use super::*;
use crate::scene::{
    Alpha, Builder, DirectionalLamp, Environment, Levels, Motion, NotTraced, ParallelogramLamp,
    PhongMaps, RenderSettings, SceneId, SegmentLamp, UsesMaterial,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::name::Name;
use bevy::math::Vec3;
use bevy::platform::collections::HashMap;

/// The app under test, and what its edits choose from.
pub(super) struct Edited {
    pub app: App,
    pub dice: Dice,
    entities: Vec<Entity>,
    meshes: Vec<Handle<Mesh>>,
    images: Vec<Handle<Image>>,
}

impl Edited {
    pub fn new(seed: u64, building: TreeBuilding) -> Self {
        let mut app = app();
        app.insert_resource(building);
        Self {
            meshes: (3..8).map(|sides| add_mesh(&mut app, sides)).collect(),
            images: (1..4)
                .map(|value| add_image(&mut app, value * 50))
                .collect(),
            app,
            dice: Dice(seed),
            entities: Vec::new(),
        }
    }

    /// Any entity but a disabled one: Bevy itself forgets what happens to those, and does not
    /// carry transforms past them.
    fn any(&mut self) -> Option<Entity> {
        let world = self.app.world();
        let enabled = |entity: &&Entity| world.get::<Disabled>(**entity).is_none();
        let enabled: Vec<&Entity> = self.entities.iter().filter(enabled).collect();
        (!enabled.is_empty()).then(|| *enabled[self.dice.below(enabled.len())])
    }

    fn switch(&mut self) {
        let entity = self.entities[self.dice.below(self.entities.len())];
        let mut entity = self.app.world_mut().entity_mut(entity);
        if entity.contains::<Disabled>() {
            entity.remove::<Disabled>();
        } else if !entity.contains::<ChildOf>() && !entity.contains::<Children>() {
            entity.insert(Disabled);
        }
    }

    pub fn spawn_object(&mut self) {
        let mesh = self.meshes[self.dice.below(self.meshes.len())].clone();
        let bundle = (Mesh3d(mesh), self.dice.transform(), self.dice.phong());
        self.entities.push(self.app.world_mut().spawn(bundle).id());
    }

    pub fn spawn_other(&mut self) {
        let transform = self.dice.transform();
        let color = self.dice.color();
        let point = self.dice.vector();
        let kind = self.dice.below(6);
        let phong = self.dice.phong();
        let mut entity = self.app.world_mut().spawn(transform);
        match kind {
            0 => entity.insert(PointLamp {
                color,
                ..PointLamp::default()
            }),
            1 => entity.insert(DirectionalLamp {
                color,
                ..DirectionalLamp::default()
            }),
            2 => entity.insert(SegmentLamp {
                ends: [Vec3::ZERO, point],
                ..SegmentLamp::default()
            }),
            3 => entity.insert(ParallelogramLamp {
                corner: point,
                ..ParallelogramLamp::default()
            }),
            4 => entity.insert(SceneCamera::default()),
            _ => entity.insert((phong, Visibility::default())),
        };
        let id = entity.id();
        self.entities.push(id);
    }

    fn change<C: Component<Mutability = Mutable>>(
        &mut self,
        change: impl FnOnce(&mut C, &mut Dice),
    ) {
        if let Some(entity) = self.any()
            && let Some(mut component) = self.app.world_mut().get_mut::<C>(entity)
        {
            change(&mut component, &mut self.dice);
        }
    }

    fn reparent(&mut self) {
        let (Some(child), Some(parent)) = (self.any(), self.any()) else {
            return;
        };
        let world = self.app.world_mut();
        let mut above = Some(parent);
        while let Some(entity) = above {
            if entity == child {
                world.entity_mut(child).remove::<ChildOf>();
                return;
            }
            above = world
                .get::<ChildOf>(entity)
                .map(|child_of| child_of.parent());
        }
        world.entity_mut(child).insert(ChildOf(parent));
    }

    fn edit_mesh(&mut self) {
        let handle = self.meshes[self.dice.below(self.meshes.len())].clone();
        let mesh = fan(3 + self.dice.below(9) as u32);
        let mut meshes = self.app.world_mut().resource_mut::<Assets<Mesh>>();
        *meshes.get_mut(&handle).unwrap() = mesh;
    }

    fn edit_settings(&mut self) {
        let builder = [Builder::Median, Builder::Sah, Builder::Ploc][self.dice.below(3)];
        let levels = [Levels::One, Levels::Two][self.dice.below(2)];
        let environment = self.dice.below(2) == 0;
        let background = self.dice.color();
        let world = self.app.world_mut();
        let mut settings = world.resource_mut::<RenderSettings>();
        settings.tree.builder = builder;
        settings.tree.levels = levels;
        settings.features.environment = environment;
        settings.features.motion = !environment;
        world.resource_mut::<Environment>().background = background;
    }

    pub fn edit(&mut self) {
        let image = self.images[self.dice.below(self.images.len())].clone();
        let other = self.images[self.dice.below(self.images.len())].clone();
        let fades = self.dice.below(2) == 0;
        let mesh = self.meshes[self.dice.below(self.meshes.len())].clone();
        let target = self.any();
        match self.dice.below(26) {
            0 | 1 => self.spawn_object(),
            2 => self.spawn_other(),
            3 => {
                if let Some(entity) = target {
                    self.app.world_mut().despawn(entity);
                    // Children go with their parents.
                    let world = self.app.world();
                    self.entities
                        .retain(|&entity| world.get_entity(entity).is_ok());
                }
            }
            4..=6 => self.change::<Transform>(|transform, dice| *transform = dice.transform()),
            7 => self.reparent(),
            8 | 9 => self.change::<Visibility>(|visibility, dice| {
                *visibility = [
                    Visibility::Hidden,
                    Visibility::Inherited,
                    Visibility::Visible,
                ][dice.below(3)];
            }),
            10 | 11 => self.change::<Phong>(|phong, dice| *phong = dice.phong()),
            12 => self.change::<Mesh3d>(|mesh3d, _| mesh3d.0 = mesh),
            13 => self.change::<PointLamp>(|lamp, dice| lamp.color = dice.color()),
            14 => self.change::<ParallelogramLamp>(|lamp, dice| lamp.corner = dice.vector()),
            15 => {
                if let (Some(user), Some(material)) = (target, self.any()) {
                    let mut user = self.app.world_mut().entity_mut(user);
                    if !user.contains::<UsesMaterial>() {
                        user.insert(UsesMaterial(material));
                    } else {
                        user.remove::<UsesMaterial>();
                    }
                }
            }
            16 => {
                if let Some(entity) = target {
                    let mut entity = self.app.world_mut().entity_mut(entity);
                    if entity.contains::<PhongMaps>() {
                        entity.remove::<PhongMaps>();
                    } else {
                        let diffuse = Some(image);
                        // It cuts out what is not opaque.
                        let opacity = Some(other).filter(|_| fades);
                        entity.insert(PhongMaps {
                            diffuse,
                            opacity,
                            ..PhongMaps::default()
                        });
                    }
                }
            }
            17 => self.switch(),
            18 => self.edit_mesh(),
            19 => {
                if let Some(entity) = target {
                    let velocity = self.dice.vector();
                    let mut entity = self.app.world_mut().entity_mut(entity);
                    if entity.contains::<Motion>() {
                        entity.remove::<Motion>();
                    } else {
                        entity.insert(Motion {
                            velocity,
                            samples: 3,
                        });
                    }
                }
            }
            20 => {
                let mut images = self.app.world_mut().resource_mut::<Assets<Image>>();
                *images.get_mut(&image).unwrap() = self::image(self.dice.below(256) as u8);
            }
            21 => {
                if let Some(entity) = target {
                    let number = self.dice.below(9);
                    let mut entity = self.app.world_mut().entity_mut(entity);
                    match number {
                        0 => entity.remove::<Name>(),
                        _ => entity.insert(Name::new(format!("thing {number}"))),
                    };
                }
            }
            22 => self.exchange_numbers(),
            23 => {
                if let Some(entity) = target {
                    let mut entity = self.app.world_mut().entity_mut(entity);
                    if entity.contains::<NotTraced>() {
                        entity.remove::<NotTraced>();
                    } else if fades {
                        entity.insert(NotTraced);
                    }
                }
            }
            24 => self.change::<Phong>(|phong, dice| {
                phong.alpha = [Alpha::Opaque, Alpha::Blend][dice.below(2)];
                phong.opacity = dice.number().abs();
            }),
            _ => self.edit_settings(),
        }
    }

    /// Of two entities each gets what the other had.
    fn exchange_numbers(&mut self) {
        let (Some(a), Some(b)) = (self.any(), self.any()) else {
            return;
        };
        let world = self.app.world_mut();
        let of = |entity: Entity| world.get::<SceneId>(entity).copied();
        if let (Some(of_a), Some(of_b)) = (of(a), of(b)) {
            world.entity_mut(a).insert(of_b);
            world.entity_mut(b).insert(of_a);
        }
    }

    /// Another app with the same entities, spawned in another order and all in one frame.
    pub fn fresh(&mut self) -> App {
        let mut new = app();
        let old = self.app.world();
        for resource in [0, 1] {
            match resource {
                0 => new.insert_resource(old.resource::<RenderSettings>().clone()),
                _ => new.insert_resource(old.resource::<Environment>().clone()),
            };
        }
        let mut order = self.entities.clone();
        for i in (1..order.len()).rev() {
            order.swap(i, self.dice.below(i + 1));
        }
        let world = new.world_mut();
        let twins: HashMap<Entity, Entity> = order
            .iter()
            .map(|&entity| (entity, world.spawn_empty().id()))
            .collect();
        let mut meshes = HashMap::new();
        let mut images = HashMap::new();
        for entity in order {
            let twin = twins[&entity];
            copy::<SceneId>(old, entity, world, twin);
            copy::<Transform>(old, entity, world, twin);
            copy::<Visibility>(old, entity, world, twin);
            copy::<Phong>(old, entity, world, twin);
            copy::<PointLamp>(old, entity, world, twin);
            copy::<DirectionalLamp>(old, entity, world, twin);
            copy::<SegmentLamp>(old, entity, world, twin);
            copy::<ParallelogramLamp>(old, entity, world, twin);
            copy::<SceneCamera>(old, entity, world, twin);
            copy::<Motion>(old, entity, world, twin);
            copy::<Name>(old, entity, world, twin);
            copy::<NotTraced>(old, entity, world, twin);
            if old.get::<Disabled>(entity).is_some() {
                world.entity_mut(twin).insert(Disabled);
            }
            if let Some(parent) = old.get::<ChildOf>(entity) {
                world
                    .entity_mut(twin)
                    .insert(ChildOf(twins[&parent.parent()]));
            }
            if let Some(material) = old.get::<UsesMaterial>(entity) {
                // A deleted material stays a deleted one.
                let gone = world.spawn_empty().id();
                world.despawn(gone);
                let material = twins.get(&material.0).copied().unwrap_or(gone);
                world.entity_mut(twin).insert(UsesMaterial(material));
            }
            if let Some(mesh) = old.get::<Mesh3d>(entity) {
                let handle = meshes.entry(mesh.id()).or_insert_with(|| {
                    let mesh = old.resource::<Assets<Mesh>>().get(mesh.id()).unwrap();
                    world.resource_mut::<Assets<Mesh>>().add(mesh.clone())
                });
                world.entity_mut(twin).insert(Mesh3d(handle.clone()));
            }
            if let Some(maps) = old.get::<PhongMaps>(entity) {
                let [diffuse, opacity] = [&maps.diffuse, &maps.opacity].map(|image| {
                    let image = image.as_ref()?;
                    let twin = images.entry(image.id()).or_insert_with(|| {
                        let image = old.resource::<Assets<Image>>().get(image.id()).unwrap();
                        world.resource_mut::<Assets<Image>>().add(image.clone())
                    });
                    Some(twin.clone())
                });
                world.entity_mut(twin).insert(PhongMaps {
                    diffuse,
                    opacity,
                    ..PhongMaps::default()
                });
            }
        }
        new.update();
        new
    }
}

fn copy<C: Component + Clone>(
    from: &bevy::ecs::world::World,
    entity: Entity,
    to: &mut bevy::ecs::world::World,
    twin: Entity,
) {
    if let Some(component) = from.get::<C>(entity) {
        to.entity_mut(twin).insert(component.clone());
    }
}
