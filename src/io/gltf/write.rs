use super::super::error::{FileError, Place};
use super::super::exported::{Exported, Material, gather, pixels_of};
use super::super::file_name::split_fragment;
use super::super::model::MeshParts;
use super::super::notes::Notes;
use super::super::picture::encode_png;
use super::super::replace::{check_space, replace_file};
use super::environment::environment_json;
use super::glb::Bytes;
use super::lamps::{camera_json, directional_json, point_json};
use super::material::material_json;
use super::texture::sampler_json;
use crate::scene::{
    DirectionalLamp, MapFilter, PhongMap, PointLamp, SceneCamera, TextureSource, Wrap,
};
use bevy::asset::{AssetId, Assets};
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::name::Name;
use bevy::image::Image;
use bevy::mesh::Mesh;
use bevy::prelude::{Entity, World};
use bevy::transform::components::Transform;
use image::DynamicImage;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::path::Path;

/// Writes the scene's hierarchy, meshes, materials, pictures, point and directional lights and
/// cameras into one GLB. Returns what could not be said.
pub(crate) fn write_glb(world: &mut World, file: &Path) -> Result<Notes, FileError> {
    super::super::check_writable(file)?;
    let mut exported = gather(world, file);
    let environment = (exported.environment.as_ref()).and_then(environment_json);
    if environment.is_none() {
        exported.note_environment(file);
    }
    let mut glb = Glb {
        world,
        file,
        bytes: Bytes::default(),
        lists: Map::new(),
        meshes: HashMap::new(),
        images: HashMap::new(),
        textures: HashMap::new(),
        notes: exported.notes.clone(),
    };
    for material in &exported.materials {
        let json = glb.material(material);
        glb.push("materials", json);
    }
    glb.nodes(&exported);
    let (mut root, bytes, notes) = glb.finish();
    if let Some(environment) = environment {
        root["extras"] = environment;
    }
    check_space(file, bytes.len() as u64)?;
    replace_file(file, |out| bytes.write(&root, out))?;
    Ok(notes)
}

/// A glTF document while it grows.
struct Glb<'a> {
    world: &'a World,
    file: &'a Path,
    bytes: Bytes,
    /// The top-level arrays by their names.
    lists: Map<String, Value>,
    /// Primitives that are written: their attributes and indices, without a material.
    meshes: HashMap<AssetId<Mesh>, Value>,
    /// By the picture, and whether it has its alpha.
    images: HashMap<(AssetId<Image>, bool), usize>,
    /// By image and how it is read.
    textures: HashMap<(usize, (Wrap, Wrap, MapFilter)), usize>,
    notes: Notes,
}

impl Glb<'_> {
    /// Adds to a top-level array and returns the index.
    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.lists.entry(list).or_insert_with(|| json!([]));
        match list.as_array_mut() {
            Some(array) => {
                array.push(value);
                array.len() - 1
            }
            None => 0,
        }
    }

    /// Says that something with a name is left out.
    fn note(&mut self, what: &str, name: &str) {
        let file = self.file;
        (self.notes).add_named(file, Place::Whole, what, name, "left out");
    }

    fn material(&mut self, material: &Material) -> Value {
        let phong = &material.phong;
        let mut json = material_json(&material.name, phong);
        let opacity = phong.opacity_map.as_ref();
        let is_in_base = opacity.is_some_and(|map| is_alpha_of(map, phong.diffuse_map.as_ref()));
        if opacity.is_some() && !is_in_base && phong.opacity >= 1.0 {
            json["alphaMode"] = json!("OPAQUE");
        }
        // In what fades or is cut out, the alpha of its colours' picture counts too.
        let is_opaque = json.get("alphaMode").is_none_or(|mode| mode == "OPAQUE");
        let keeps_alpha = is_in_base || is_opaque;
        let mut left_out = Vec::new();
        for map in PhongMap::ALL {
            if map.source(phong).is_none() {
                continue;
            }
            let is_said = match map {
                PhongMap::Diffuse => {
                    let place = &mut json["pbrMetallicRoughness"];
                    self.texture(material, map, keeps_alpha, place, "baseColorTexture")
                }
                PhongMap::Emission => {
                    self.texture(material, map, true, &mut json, "emissiveTexture")
                }
                PhongMap::Normal => {
                    let is_said = self.texture(material, map, true, &mut json, "normalTexture");
                    if is_said {
                        json["normalTexture"]["scale"] = json!(phong.normal_scale);
                    }
                    is_said
                }
                PhongMap::Opacity => is_in_base,
                PhongMap::Specular | PhongMap::Mirror => false,
            };
            if !is_said {
                left_out.push(map.name());
            }
        }
        for map in left_out {
            self.note(&format!("the {map} of the material"), &material.name);
        }
        json
    }

    /// Says under a key which texture a map is, with its alpha or without; false where it cannot be said.
    fn texture(
        &mut self,
        material: &Material,
        map: PhongMap,
        keeps_alpha: bool,
        place: &mut Value,
        key: &str,
    ) -> bool {
        let source = map.source(&material.phong);
        let Some((source, loaded)) = source.zip(map.loaded(&material.maps)) else {
            return false;
        };
        let Some(image) = self.image(loaded.id(), keeps_alpha) else {
            self.note("a picture that cannot be embedded:", &source.path);
            return false;
        };
        let sampler = (source.wrap_u, source.wrap_v, source.filter);
        let texture = match self.textures.get(&(image, sampler)) {
            Some(&texture) => texture,
            None => {
                let mut texture = json!({ "source": image });
                if let Some(json) = sampler_json(source) {
                    texture["sampler"] = json!(self.push("samplers", json));
                }
                let texture = self.push("textures", texture);
                self.textures.insert((image, sampler), texture);
                texture
            }
        };
        place[key] = json!({ "index": texture });
        true
    }

    /// Embeds a loaded picture as a PNG; `None` where it does not hold colours in 8 or 16 bits.
    fn image(&mut self, image: AssetId<Image>, keeps_alpha: bool) -> Option<usize> {
        let key = (image, keeps_alpha);
        if let Some(&image) = self.images.get(&key) {
            return Some(image);
        }
        use DynamicImage as D;
        let pixels = match pixels_of(self.world, image)? {
            pixels @ (D::ImageRgba8(_) | D::ImageRgba16(_)) if keeps_alpha => pixels,
            pixels @ D::ImageRgba8(_) => pixels.into_rgb8().into(),
            pixels @ D::ImageRgba16(_) => pixels.into_rgb16().into(),
            _ => return None,
        };
        let view = self.bytes.push(&encode_png(&pixels).ok()?);
        let image_json = json!({ "bufferView": view, "mimeType": "image/png" });
        let index = self.push("images", image_json);
        self.images.insert(key, index);
        Some(index)
    }

    fn nodes(&mut self, exported: &Exported) {
        let index_of: HashMap<Entity, usize> = exported.entities.iter().copied().zip(0..).collect();
        let mut children: HashMap<Entity, Vec<usize>> = HashMap::new();
        let mut roots = Vec::new();
        for (index, &entity) in exported.entities.iter().enumerate() {
            match self.world.get::<ChildOf>(entity) {
                Some(&ChildOf(parent)) if index_of.contains_key(&parent) => {
                    children.entry(parent).or_default().push(index);
                }
                _ => roots.push(index),
            }
        }
        let objects: HashMap<Entity, _> = exported.objects.iter().map(|o| (o.entity, o)).collect();
        let mut meshes: HashMap<(AssetId<Mesh>, usize), Option<usize>> = HashMap::new();
        for &entity in &exported.entities {
            let mut node = self.node(entity);
            if let Some(children) = children.get(&entity) {
                node["children"] = json!(children);
            }
            if let Some(object) = objects.get(&entity) {
                let mesh = *meshes
                    .entry((object.mesh, object.material))
                    .or_insert_with(|| self.mesh(object.mesh, object.material, &object.name));
                if let Some(mesh) = mesh {
                    node["mesh"] = json!(mesh);
                }
            }
            self.push("nodes", node);
        }
        self.push("scenes", json!({ "nodes": roots }));
    }

    /// A node with its place, light and camera.
    fn node(&mut self, entity: Entity) -> Value {
        let world = self.world;
        let mut node = json!({});
        let name = world.get::<Name>(entity).map_or("", Name::as_str);
        if !name.is_empty() {
            node["name"] = json!(name);
        }
        if let Some(transform) = world.get::<Transform>(entity)
            && *transform != Transform::IDENTITY
        {
            node["translation"] = json!(transform.translation.to_array());
            node["rotation"] = json!(transform.rotation.to_array());
            node["scale"] = json!(transform.scale.to_array());
        }
        if let Some(camera) = world.get::<SceneCamera>(entity) {
            let camera = self.push("cameras", camera_json(camera));
            node["camera"] = json!(camera);
        }
        let point = world.get::<PointLamp>(entity).map(point_json);
        let sun = world.get::<DirectionalLamp>(entity);
        if sun.is_some_and(|sun| sun.angular_diameter > 0.0) {
            self.note("an angular diameter of the light", name);
        }
        let directional = sun.map(directional_json);
        if point.is_some() && directional.is_some() {
            self.note("a directional light beside a point light of", name);
        }
        if let Some(light) = point.or(directional) {
            let light = self.push("lights", light);
            node["extensions"] = json!({ "KHR_lights_punctual": { "light": light } });
        }
        node
    }

    fn mesh(&mut self, id: AssetId<Mesh>, material: usize, name: &str) -> Option<usize> {
        if !self.meshes.contains_key(&id) {
            let world = self.world;
            let meshes = world.get_resource::<Assets<Mesh>>();
            let parts = meshes
                .and_then(|meshes| meshes.get(id))
                .and_then(MeshParts::of);
            let Some(parts) = parts.filter(|parts| parts.triangles().next().is_some()) else {
                self.note("a mesh that is no indexed triangle list:", name);
                return None;
            };
            let mut attributes = json!({ "POSITION": self.bytes.push_vectors(parts.positions) });
            if !parts.normals.is_empty() {
                attributes["NORMAL"] = json!(self.bytes.push_vectors(parts.normals));
            }
            if !parts.tangents.is_empty() && !parts.normals.is_empty() {
                attributes["TANGENT"] = json!(self.bytes.push_vectors(parts.tangents));
            }
            if !parts.uvs.is_empty() {
                attributes["TEXCOORD_0"] = json!(self.bytes.push_vectors(parts.uvs));
            }
            if !parts.colors.is_empty() {
                attributes["COLOR_0"] = json!(self.bytes.push_vectors(parts.colors));
            }
            // Fits: they were 32 bits wide.
            let corners = parts.triangles().flatten().map(|corner| corner as u32);
            let indices = self.bytes.push_indices(corners);
            let primitive = json!({ "attributes": attributes, "indices": indices });
            self.meshes.insert(id, primitive);
        }
        let mut primitive = self.meshes.get(&id).cloned()?;
        primitive["material"] = json!(material);
        Some(self.push("meshes", json!({ "name": name, "primitives": [primitive] })))
    }

    fn finish(mut self) -> (Value, Bytes, Notes) {
        let mut root = json!({
            "asset": {
                "version": "2.0",
                "generator": concat!("Glassbox ", env!("CARGO_PKG_VERSION")),
            },
            "scene": 0,
        });
        let mut used = Vec::new();
        if let Some(lights) = self.lists.remove("lights") {
            root["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
            used.push("KHR_lights_punctual");
        }
        let glows = |material: &Value| material.get("extensions").is_some();
        let materials = self.lists.get("materials").and_then(Value::as_array);
        if materials.is_some_and(|materials| materials.iter().any(glows)) {
            used.push("KHR_materials_emissive_strength");
        }
        if !used.is_empty() {
            root["extensionsUsed"] = json!(used);
        }
        for (name, list) in self.lists {
            root[name] = list;
        }
        if self.bytes.len() > 0 {
            root["bufferViews"] = json!(self.bytes.views);
            root["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        }
        if !self.bytes.accessors.is_empty() {
            root["accessors"] = json!(self.bytes.accessors);
        }
        (root, self.bytes, self.notes)
    }
}

/// Whether a source is the alpha channel of another: then the base colour's picture carries it.
fn is_alpha_of(source: &TextureSource, other: Option<&TextureSource>) -> bool {
    let Some(other) = other else {
        return false;
    };
    let (file, part) = split_fragment(&source.path);
    let (other_file, other_part) = split_fragment(&other.path);
    let part = part
        .strip_suffix("alpha")
        .map(|part| part.trim_end_matches('.'));
    file == other_file && part == Some(other_part)
}
