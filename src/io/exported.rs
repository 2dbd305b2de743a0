//! What a model file can hold of the open scene, gathered for its writers.

use super::error::Place;
use super::model::MeshParts;
use super::notes::Notes;
use super::place::is_hidden;
use super::scene_file::scene_entities;
use crate::scene::{
    DirectionalLamp, Environment, Lens, Motion, ParallelogramLamp, Phong, PhongMaps, PointLamp,
    RenderSettings, SRGB_16_BITS, SceneCamera, SceneId, SegmentLamp, UsesMaterial,
};
use crate::trace::srgb;
use bevy::asset::{AssetId, Assets};
use bevy::color::{ColorToComponents, LinearRgba};
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::name::Name;
use bevy::image::Image;
use bevy::math::Vec3;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::prelude::{Component, Entity, World};
use exr::prelude::f16;
use image::{DynamicImage, ImageBuffer};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use wgpu_types::TextureFormat;

const LEFT_OUT: &str = "left out";

/// Objects and materials of the scene, in the order of their `SceneId`.
#[derive(Default)]
pub(crate) struct Exported {
    /// Every entity of the scene that is not just a material.
    pub entities: Vec<Entity>,
    /// What is shown: its entity, mesh and material.
    pub objects: Vec<Object>,
    /// Materials that objects use, with names that no other has.
    pub materials: Vec<Material>,
    /// What is around the scene, where it is not as usual.
    pub environment: Option<Environment>,
    /// What no model file can say.
    pub notes: Notes,
}

/// Something with triangles.
pub(crate) struct Object {
    pub entity: Entity,
    /// No other object has it.
    pub name: String,
    pub mesh: AssetId<Mesh>,
    /// Index into the materials.
    pub material: usize,
}

/// A material and its loaded pictures.
pub(crate) struct Material {
    pub name: String,
    pub phong: Phong,
    pub maps: PhongMaps,
}

/// Gathers the scene for a file. Hidden objects are left out: a model file would show them.
pub(crate) fn gather(world: &mut World, file: &Path) -> Exported {
    let mut entities = scene_entities(world);
    entities.sort_by_key(|&e| world.get::<SceneId>(e).copied().unwrap_or_default());
    let world = &*world;
    let mut out = Exported::default();
    let mut names = Names::default();
    let mut material_names = Names::default();
    let mut materials: HashMap<Entity, usize> = HashMap::new();
    let mut hidden = 0;
    for &entity in &entities {
        let Some(Mesh3d(handle)) = world.get::<Mesh3d>(entity) else {
            continue;
        };
        if is_hidden(world, entity) {
            hidden += 1;
            continue;
        }
        let shared = world.get::<UsesMaterial>(entity).map(|shared| shared.0);
        let owner = shared
            .filter(|&material| world.get::<Phong>(material).is_some())
            .unwrap_or(entity);
        let material = *materials.entry(owner).or_insert_with(|| {
            out.materials.push(Material {
                name: material_names.unique(world, owner, "material"),
                phong: world.get::<Phong>(owner).cloned().unwrap_or_default(),
                maps: world.get::<PhongMaps>(owner).cloned().unwrap_or_default(),
            });
            out.materials.len() - 1
        });
        out.objects.push(Object {
            entity,
            name: names.unique(world, entity, "object"),
            mesh: handle.id(),
            material,
        });
    }
    let mut note = |count: usize, what: &str| {
        for _ in 0..count {
            out.notes.add(file, Place::Whole, what, LEFT_OUT);
        }
    };
    note(hidden, "hidden objects");
    note(count::<SegmentLamp>(world, &entities), "segment lights");
    note(
        count::<ParallelogramLamp>(world, &entities),
        "parallelogram lights",
    );
    note(count::<Motion>(world, &entities), "motions");
    note(count::<Lens>(world, &entities), "lenses");
    let environment = world.get_resource::<Environment>();
    out.environment = environment
        .filter(|e| **e != Environment::default())
        .cloned();
    let settings = world.get_resource::<RenderSettings>();
    let is_set = settings.is_some_and(|settings| *settings != RenderSettings::default());
    note(is_set.into(), "the render settings");
    for object in out
        .objects
        .iter()
        .filter(|object| glows_in_colors(world, object, &out.materials))
    {
        let what =
            "colours of vertices of what shines by itself, which other programs do not show, of";
        (out.notes).add_named(
            file,
            Place::Whole,
            what,
            &object.name,
            "written all the same",
        );
    }
    out.entities = entities
        .into_iter()
        .filter(|&entity| !is_only_a_material(world, entity))
        .collect();
    out
}

impl Exported {
    /// A note for a format that cannot say what is around the scene.
    pub fn note_environment(&mut self, file: &Path) {
        if self.environment.is_some() {
            let what = "the environment";
            self.notes.add(file, Place::Whole, what, LEFT_OUT);
        }
    }

    /// Notes for a format without lights, cameras and parents.
    pub fn note_lights_and_cameras(&mut self, world: &World, file: &Path) {
        self.note_environment(file);
        let lights = count::<PointLamp>(world, &self.entities)
            + count::<DirectionalLamp>(world, &self.entities);
        let cameras = count::<SceneCamera>(world, &self.entities);
        let placed = self.objects.iter().map(|object| object.entity);
        let children = placed.filter(|&object| world.get::<ChildOf>(object).is_some());
        for (count, what, instead) in [
            (lights, "point and directional lights", LEFT_OUT),
            (cameras, "cameras", LEFT_OUT),
            (
                children.count(),
                "objects below others",
                "written where they stand, beside them",
            ),
        ] {
            for _ in 0..count {
                self.notes.add(file, Place::Whole, what, instead);
            }
        }
    }
}

/// Whether the colours of its vertices are those of its glow, which they are where it has no body: in no model format they
/// are.
fn glows_in_colors(world: &World, object: &Object, materials: &[Material]) -> bool {
    let phong = &materials[object.material].phong;
    let is_black = |color: LinearRgba| color.to_vec3() == Vec3::ZERO;
    let mesh = world.get_resource::<Assets<Mesh>>();
    let mesh = mesh.and_then(|meshes| meshes.get(object.mesh));
    is_black(phong.diffuse)
        && !is_black(phong.emission)
        && (mesh.and_then(MeshParts::of)).is_some_and(|parts| !parts.colors.is_empty())
}

fn count<T: Component>(world: &World, entities: &[Entity]) -> usize {
    entities
        .iter()
        .filter(|&&e| world.get::<T>(e).is_some())
        .count()
}

fn is_only_a_material(world: &World, entity: Entity) -> bool {
    let has_place = world
        .get::<bevy::transform::components::Transform>(entity)
        .is_some();
    world.get::<Phong>(entity).is_some() && !has_place
}

/// Hands out names that differ.
#[derive(Default)]
struct Names {
    taken: HashSet<String>,
    /// The number to go on with, by the name: thousands may have the same.
    next: HashMap<String, u32>,
}

impl Names {
    fn unique(&mut self, world: &World, entity: Entity, kind: &str) -> String {
        let id = world.get::<SceneId>(entity).map_or(0, |id| id.0);
        let name = match world.get::<Name>(entity) {
            Some(name) => one_line(name.as_str()),
            None => format!("{kind} {id}"),
        };
        if self.taken.insert(name.clone()) {
            return name;
        }
        let number = self.next.entry(name.clone()).or_insert(2);
        loop {
            let free = format!("{name}#{number}");
            *number += 1;
            if self.taken.insert(free.clone()) {
                return free;
            }
        }
    }
}

/// A name as text formats can hold it: one line, nothing at its ends that would be trimmed.
fn one_line(name: &str) -> String {
    let line: String = name
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    match line.trim() {
        "" => "unnamed".to_owned(),
        trimmed => trimmed.to_owned(),
    }
}

/// A loaded picture as pixels: RGBA in 8 bits, in 16 or in `f32`, or grey in 16. `None` for other formats.
pub(crate) fn pixels_of(world: &World, image: AssetId<Image>) -> Option<DynamicImage> {
    let image = world.get_resource::<Assets<Image>>()?.get(image)?;
    let (width, height) = (image.width(), image.height());
    let data = image.data.as_ref()?;
    let words = || {
        let words = data.as_chunks().0.iter();
        words.map(|&bytes| u16::from_ne_bytes(bytes)).collect()
    };
    let floats = || {
        let words = data.as_chunks().0.iter();
        words.map(|&bytes| f32::from_ne_bytes(bytes))
    };
    let pixels = match image.texture_descriptor.format {
        TextureFormat::Rgba8Unorm | TextureFormat::Rgba8UnormSrgb => {
            DynamicImage::ImageRgba8(ImageBuffer::from_raw(width, height, data.clone())?)
        }
        TextureFormat::Rgba16Unorm => {
            DynamicImage::ImageRgba16(ImageBuffer::from_raw(width, height, words())?)
        }
        TextureFormat::R16Unorm => {
            DynamicImage::ImageLuma16(ImageBuffer::from_raw(width, height, words())?)
        }
        TextureFormat::Rgba32Float if image.texture_descriptor.label == Some(SRGB_16_BITS) => {
            let whole = |value: f32| (value * f32::from(u16::MAX)).round() as u16;
            let values: Vec<f32> = floats().collect();
            let encoded = values.as_chunks().0.iter().flat_map(|&[r, g, b, a]| {
                let [r, g, b] = [r, g, b].map(|c| whole(srgb::encode(c)));
                [r, g, b, whole(a)]
            });
            DynamicImage::ImageRgba16(ImageBuffer::from_raw(width, height, encoded.collect())?)
        }
        TextureFormat::Rgba32Float => {
            let buffer = ImageBuffer::from_raw(width, height, floats().collect())?;
            DynamicImage::ImageRgba32F(buffer)
        }
        TextureFormat::Rgba16Float => {
            let words = data.as_chunks().0.iter();
            let values = words.map(|&bytes| f16::from_ne_bytes(bytes).to_f32());
            let buffer = ImageBuffer::from_raw(width, height, values.collect())?;
            DynamicImage::ImageRgba32F(buffer)
        }
        TextureFormat::R32Float => {
            let grey = floats().flat_map(|g| [g, g, g, 1.0]).collect();
            DynamicImage::ImageRgba32F(ImageBuffer::from_raw(width, height, grey)?)
        }
        _ => return None,
    };
    (pixels.width() > 0 && pixels.height() > 0).then_some(pixels)
}
