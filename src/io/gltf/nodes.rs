//! The hierarchy of a file, and the meshes that it shows.

use super::super::error::{FileError, Problem};
use super::super::model::{Model, Node};
use super::accessors::floats;
use super::document::Document;
use super::json::Json;
use super::lamps::{Lamp, camera_of, has_no_cone, lamp_of};
use super::material::default_phong;
use super::placement::{Placement, placement_of, turn_of};
use super::primitive::{Triangles, read_primitive};
use super::read::name_of;
use super::rest::{Nodes, Pose};
use bevy::math::{Quat, Vec3};
use bevy::transform::components::Transform;
use std::collections::{HashMap, HashSet};

/// Adds the nodes of the file's scene, and what they hold. Returns the first reason why something could not be shown.
pub(super) fn read_nodes(
    document: &Document,
    model: &mut Model,
) -> Result<Option<FileError>, FileError> {
    let mut reader = Reader {
        document,
        model,
        nodes: Nodes::new(document),
        poses: HashMap::new(),
        skinned: HashSet::new(),
        white: None,
        fault: None,
    };
    reader.read()?;
    Ok(reader.fault)
}

struct Reader<'a> {
    document: &'a Document,
    model: &'a mut Model,
    nodes: Nodes<'a>,
    /// Skins at rest.
    poses: HashMap<usize, Pose>,
    /// Names of meshes that a skin's joints place.
    skinned: HashSet<String>,
    /// The material of primitives without one.
    white: Option<usize>,
    fault: Option<FileError>,
}

impl Reader<'_> {
    fn read(&mut self) -> Result<(), FileError> {
        let (document, count) = (self.document, self.nodes.len());
        self.check_count(count)?;
        let mut seen = vec![false; count];
        // A stack, not recursion: a file can nest deeper than a thread's stack reaches.
        let mut to_visit: Vec<(usize, Option<usize>, u64)> = self
            .roots()
            .into_iter()
            .rev()
            .map(|node| (node, None, 0))
            .collect();
        while let Some((index, parent, depth)) = to_visit.pop() {
            let part = format!("node {index}");
            let Some(node) = document.json().element("nodes", index) else {
                document.note(&part, "a node that there is not", "left out");
                continue;
            };
            if std::mem::replace(&mut seen[index], true) {
                let what = "a node that is reached twice; glTF wants a tree";
                document.note(&part, what, "shown once");
                continue;
            }
            let name = name_of(node, "node", index);
            let note = |what: &str, instead| document.note_named(&part, what, &name, instead);
            let placement = placement_of(node, &note);
            // What it holds may become entities below its own.
            let levels = depth + 1 + u64::from(placement.within.is_some());
            if levels > document.limits.depth {
                let problem = Problem::TooMany {
                    what: "ancestors",
                    count: levels,
                    limit: document.limits.depth,
                };
                return Err(document.error(part, problem));
            }
            let place = self.push_node(index, node, &name, parent, placement)?;
            let children: Vec<usize> = node.list("children").map(index_of).collect();
            let children = children.into_iter().rev();
            to_visit.extend(children.map(|child| (child, Some(place), levels)));
        }
        Ok(())
    }

    fn check_count(&self, count: usize) -> Result<(), FileError> {
        let limit = self.document.limits.entities;
        if count as u64 <= limit {
            return Ok(());
        }
        let problem = Problem::TooMany {
            what: "nodes",
            count: count as u64,
            limit,
        };
        Err(FileError::new(&self.document.file, problem))
    }

    fn roots(&self) -> Vec<usize> {
        let json = self.document.json();
        let scenes = json.list("scenes").len();
        let named = json.index("scene");
        let chosen = named.filter(|&scene| scene < scenes);
        if let (Some(named), None) = (named, chosen) {
            let what = format!("scene {named}, which there is not");
            let instead = match scenes {
                0 => "all nodes are shown",
                _ => "the first is shown",
            };
            self.document.note("scene", what, instead);
        } else if chosen.is_none() && scenes > 1 {
            let what = format!("{scenes} scenes, and none that is to be shown");
            self.document.note("scenes", what, "the first is");
        }
        match json.element("scenes", chosen.unwrap_or(0)) {
            Some(scene) => scene.list("nodes").map(index_of).collect(),
            None => {
                let all = 0..self.nodes.len();
                all.filter(|&node| self.nodes.is_root(node)).collect()
            }
        }
    }

    /// Adds a node and what it holds; returns where that below which its children stand is in the model.
    fn push_node(
        &mut self,
        index: usize,
        json: Json,
        name: &str,
        mut parent: Option<usize>,
        placement: Placement,
    ) -> Result<usize, FileError> {
        let document = self.document;
        let part = format!("node {index}");
        let note = |what: &str, instead| document.note_named(&part, what, name, instead);
        let mut contents = Vec::new();
        let meshes = self.meshes(index, json, &part)?;
        let is_skinned =
            |node: &Node| matches!(&node.mesh, Some(mesh) if self.skinned.contains(mesh));
        let (skinned, meshes): (Vec<Node>, Vec<Node>) = meshes.into_iter().partition(is_skinned);
        // Where its joints are says where it is; the node itself does not.
        for (number, mesh) in skinned.into_iter().enumerate() {
            self.model.nodes.push(Node {
                name: format!("{name}/skin {number}"),
                ..mesh
            });
        }
        contents.extend(self.instances(json, &meshes, &note)?);
        if contents.is_empty() {
            contents.extend(meshes);
        }
        if let Some(light) = json.extension("KHR_lights_punctual") {
            contents.extend(light_of(document, light, &note));
        }
        if let Some(camera) = json.index("camera") {
            let camera = document.json().element("cameras", camera);
            match camera.and_then(camera_of) {
                None => note("a camera with impossible numbers in", "left out"),
                camera => contents.push(Node {
                    camera,
                    ..Node::default()
                }),
            }
        }
        let Placement {
            mut transform,
            within,
        } = placement;
        let mut own_name = name.to_owned();
        if let Some(within) = within {
            let above = Node {
                name: name.to_owned(),
                parent,
                transform,
                ..Node::default()
            };
            parent = Some(self.model.nodes.len());
            self.model.nodes.push(above);
            own_name.push_str("/turned");
            transform = within;
        }
        let place = self.model.nodes.len();
        let is_own = contents.len() == 1 && contents[0].transform == Transform::IDENTITY;
        let own = match is_own {
            true => contents.pop().unwrap_or_default(),
            false => Node::default(),
        };
        self.model.nodes.push(Node {
            name: own_name,
            parent,
            transform,
            ..own
        });
        for (number, content) in contents.into_iter().enumerate() {
            self.model.nodes.push(Node {
                name: format!("{name}/{number}"),
                parent: Some(place),
                ..content
            });
        }
        self.check_count(self.model.nodes.len())?;
        Ok(place)
    }

    /// A node for each primitive of the mesh that a node shows.
    fn meshes(&mut self, index: usize, node: Json, part: &str) -> Result<Vec<Node>, FileError> {
        let document = self.document;
        let Some(number) = node.index("mesh") else {
            return Ok(Vec::new());
        };
        let Some(mesh) = document.json().element("meshes", number) else {
            document.note(part, "a mesh that there is not", "left out");
            return Ok(Vec::new());
        };
        let own_weights = node.all_numbers("weights");
        let skin = node.index("skin");
        let ending = match (skin, &own_weights) {
            (_, Some(_)) => format!("/Node{index}"),
            (Some(skin), None) => format!("/Skin{skin}"),
            (None, None) => String::new(),
        };
        let pose = skin.map(|skin| self.pose(skin, part)).transpose()?;
        let weights = own_weights.or_else(|| mesh.all_numbers("weights"));
        let pose = Pose {
            weights: weights.unwrap_or_default(),
            ..pose.unwrap_or_default()
        };
        let mut out = Vec::new();
        for (primitive, json) in mesh.list("primitives").enumerate() {
            let name = format!("Mesh{number}/Primitive{primitive}{ending}");
            if !self.model.meshes.contains_key(&name) {
                match read_primitive(document, json.mark(), &name, &pose) {
                    Ok(Some(Triangles { mesh, is_skinned })) => {
                        self.model.meshes.insert(name.clone(), mesh);
                        if is_skinned {
                            self.skinned.insert(name.clone());
                        }
                    }
                    Ok(None) => continue,
                    Err(problem) if problem.is_of_memory() => {
                        return Err(document.error(name, problem));
                    }
                    Err(problem) => {
                        document.note(&name, problem.to_string(), "left out");
                        let error = || document.error(name, problem);
                        self.fault.get_or_insert_with(error);
                        continue;
                    }
                }
            }
            let material = self.material(json, &name);
            out.push(Node {
                mesh: Some(name),
                material: Some(material),
                ..Node::default()
            });
        }
        Ok(out)
    }

    fn pose(&mut self, skin: usize, part: &str) -> Result<Pose, FileError> {
        if let Some(known) = self.poses.get(&skin) {
            return Ok(known.clone());
        }
        let document = self.document;
        let joints = self.nodes.joints(skin).or_else(|problem| {
            document.do_without(part, "its skin", problem, "shown without")?;
            Ok(Vec::new())
        });
        let pose = Pose {
            joints: joints.map_err(|problem| document.error(part, problem))?,
            ..Pose::default()
        };
        self.poses.insert(skin, pose.clone());
        Ok(pose)
    }

    /// The material of a primitive; white and rough where it has none.
    fn material(&mut self, primitive: Json, name: &str) -> usize {
        let count = self.document.json().list("materials").len();
        let own = primitive.index("material");
        match own {
            Some(own) if own < count => return own,
            Some(own) => {
                let what = format!("material {own}, which there is not");
                self.document.note(name, what, "white and rough");
            }
            None => {}
        }
        let materials = &mut self.model.materials;
        *self.white.get_or_insert_with(|| {
            materials.push(("default".to_owned(), default_phong()));
            materials.len() - 1
        })
    }

    /// A node for each copy that `EXT_mesh_gpu_instancing` asks for.
    fn instances(
        &self,
        node: Json,
        meshes: &[Node],
        note: &impl Fn(&str, &'static str),
    ) -> Result<Vec<Node>, FileError> {
        let instancing = node.extension("EXT_mesh_gpu_instancing");
        let attributes = instancing.and_then(|instancing| instancing.get("attributes"));
        let Some(attributes) = attributes.filter(|_| !meshes.is_empty()) else {
            return Ok(Vec::new());
        };
        let document = self.document;
        let read = || -> Result<_, Problem> {
            let of = |key| attributes.index(key);
            let places = of("TRANSLATION").map(|index| floats::<3>(document, index));
            let turns = of("ROTATION").map(|index| floats::<4>(document, index));
            let scales = of("SCALE").map(|index| floats::<3>(document, index));
            Ok((places.transpose()?, turns.transpose()?, scales.transpose()?))
        };
        let (places, turns, scales) = match read() {
            Ok((None, None, None)) => return Ok(Vec::new()),
            Ok(read) => read,
            Err(problem) if problem.is_of_memory() => {
                return Err(FileError::new(&document.file, problem));
            }
            Err(problem) => {
                note(&format!("copies ({problem}) of"), "one is shown");
                return Ok(Vec::new());
            }
        };
        let lengths = [
            places.as_ref().map(Vec::len),
            turns.as_ref().map(Vec::len),
            scales.as_ref().map(Vec::len),
        ];
        let count = lengths.into_iter().flatten().min().unwrap_or(0);
        self.check_count(count.saturating_mul(meshes.len()))?;
        let mut copies = Vec::new();
        for i in 0..count {
            let transform = Transform {
                translation: places.as_ref().map_or(Vec3::ZERO, |all| all[i].into()),
                rotation: turns
                    .as_ref()
                    .map_or(Quat::IDENTITY, |all| turn_of(all[i], note)),
                scale: scales.as_ref().map_or(Vec3::ONE, |all| all[i].into()),
            };
            if !transform.is_finite() {
                note("a copy that has no place, of", "left out");
                continue;
            }
            copies.extend(meshes.iter().map(|mesh| Node {
                transform,
                ..mesh.clone()
            }));
        }
        Ok(copies)
    }
}

/// The index that a list's element is; that of nothing where it is none.
fn index_of(element: Json) -> usize {
    element.whole().unwrap_or(usize::MAX)
}

fn light_of(document: &Document, light: Json, note: &impl Fn(&str, &'static str)) -> Option<Node> {
    let lights = document.json().extension("KHR_lights_punctual");
    let light = light.index("light");
    let light = light.and_then(|index| lights?.element("lights", index));
    let mut content = Node::default();
    match light.and_then(lamp_of) {
        Some(Lamp::Point(lamp)) => content.point_lamp = Some(lamp),
        Some(Lamp::Directional(lamp)) => content.directional_lamp = Some(lamp),
        None => {
            note(
                "a light that there is not, or with impossible numbers, in",
                "left out",
            );
            return None;
        }
    }
    if light.and_then(|light| light.get("range")).is_some() {
        note("the range of the light in", "light has none here");
    }
    if light.is_some_and(has_no_cone) {
        note("angles that are none of a cone, of the light in", "clamped");
    }
    Some(content)
}
