//! Facets become meshes: corners at one place and of one colour are one vertex.

use super::super::Limits;
use super::super::budget::Growing;
use super::super::error::{FileError, Place, Problem};
use super::super::far_off::FarOff;
use super::super::model::{ColoredMaterial, FreeNames, Model, Node, triangle_mesh};
use super::super::notes::Notes;
use bevy::math::{DVec3, Vec3};
use bevy::mesh::Mesh;
use bevy::platform::hash::RandomState;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// One triangle as the file has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// Any length; 0 where the file leaves it to the reader.
    pub normal: [f32; 3],
    pub corners: [[f32; 3]; 3],
    pub more: More,
}

/// What else a file says of a facet.
#[derive(Clone, Copy, Debug)]
pub(super) enum More {
    Nothing,
    /// Linear. Only binary files have some.
    Color([f32; 3]),
    /// Its corners with all their digits, where those are needed. Only texts have more than 32 bits hold.
    Digits([[f64; 3]; 3]),
}

/// A solid while it grows.
#[derive(Default)]
struct Solid {
    name: String,
    /// By where a vertex is, and its colour or what 32 bits do not hold of its place.
    numbers: HashMap<([u32; 3], [u32; 3]), u32, RandomState>,
    positions: Vec<[f32; 3]>,
    colors: Vec<[f32; 3]>,
    indices: Vec<u32>,
    is_colored: bool,
}

/// Everything that was read of a file so far.
pub(super) struct Facets<'a> {
    pub file: &'a Path,
    pub notes: Notes,
    /// The first thing that could not be read: the reason, should nothing be left to show.
    pub fault: Option<FileError>,
    pub far_off: FarOff,
    limits: &'a Limits,
    memory: Growing<'a>,
    solids: Vec<Solid>,
    vertices: u64,
    triangles: u64,
}

impl<'a> Facets<'a> {
    pub fn of(file: &'a Path, limits: &'a Limits) -> Self {
        Self {
            file,
            notes: Notes::default(),
            fault: None,
            far_off: FarOff::default(),
            limits,
            memory: Growing::of(&limits.memory),
            solids: Vec::new(),
            vertices: 0,
            triangles: 0,
        }
    }

    /// What follows belongs to a solid of that name. One without facets is none.
    pub fn begin(&mut self, name: &str) -> Result<(), FileError> {
        if self
            .solids
            .last()
            .is_some_and(|solid| solid.indices.is_empty())
        {
            self.solids.pop();
        }
        let count = self.solids.len() as u64 + 1;
        if count > self.limits.entities {
            return Err(self.too_many("solids", count, self.limits.entities));
        }
        self.solids.push(Solid {
            name: name.to_owned(),
            ..Solid::default()
        });
        Ok(())
    }

    /// Adds a facet, which stands at that place, to the solid that was begun last.
    pub fn push(&mut self, facet: Facet, place: impl Fn() -> Place) -> Result<(), FileError> {
        const LEFT_OUT: &str = "left out";
        if !facet
            .corners
            .as_flattened()
            .iter()
            .all(|value| value.is_finite())
        {
            let what = "a facet whose corners are not finite numbers";
            self.notes.add(self.file, place(), what, LEFT_OUT);
            let what = "a corner of a facet".to_owned();
            let problem = Problem::NotFinite { what };
            self.fault
                .get_or_insert_with(|| FileError::at(self.file, place(), problem));
            return Ok(());
        }
        let edges = match facet.more {
            More::Digits(corners) => {
                let [a, b, c] = corners.map(DVec3::from);
                [b - a, c - a].map(|edge| edge.as_vec3())
            }
            _ => {
                let [a, b, c] = facet.corners.map(Vec3::from);
                [b - a, c - a]
            }
        };
        if edges[0].cross(edges[1]).dot(facet.normal.into()) < 0.0 {
            let what = "a facet whose normal contradicts the order of its corners";
            let instead = "it faces as they turn";
            self.notes.add(self.file, place(), what, instead);
        }
        if self.solids.is_empty() {
            self.begin("")?;
        }
        self.triangles += 1;
        if self.triangles > self.limits.triangles {
            return Err(self.too_many("triangles", self.triangles, self.limits.triangles));
        }
        let solids = self.solids.len() as u64;
        let Some(solid) = self.solids.last_mut() else {
            return Ok(());
        };
        for (i, corner) in facet.corners.into_iter().enumerate() {
            let is_new = solid.corner(corner, facet.more, i);
            if let (true, More::Digits(exact)) = (is_new, facet.more) {
                (self.far_off).tell(self.vertices as usize, exact[i], corner);
            }
            self.vertices += u64::from(is_new);
        }
        let count = solid.positions.len() as u64;
        if count > self.limits.vertices {
            return Err(self.too_many("vertices", count, self.limits.vertices));
        }
        self.memory
            .reach(self.vertices, self.triangles, solids)
            .map_err(|problem| FileError::at(self.file, place(), problem))
    }

    fn too_many(&self, what: &'static str, count: u64, limit: u64) -> FileError {
        FileError::new(self.file, Problem::TooMany { what, count, limit })
    }

    pub fn into_model(mut self) -> Result<Model, FileError> {
        let solids = self.solids.iter_mut();
        let mut parts: Vec<&mut [[f32; 3]]> = solids.map(|solid| &mut *solid.positions).collect();
        (self.far_off).settle(&mut parts, self.file, &mut self.notes);
        let mut model = Model {
            files: vec![self.file.to_path_buf()],
            notes: self.notes,
            ..Model::default()
        };
        let stem = self.file.file_stem().map(PathBuf::from);
        let stem = stem.unwrap_or_default().display().to_string();
        let mut colored = ColoredMaterial::default();
        let mut free_names = FreeNames::default();
        for solid in self.solids {
            if solid.indices.is_empty() {
                continue;
            }
            let name = match solid.name.is_empty() {
                true => stem.clone(),
                false => solid.name,
            };
            let name = free_names.free(name, &model.meshes);
            let mut mesh = triangle_mesh(solid.positions, Vec::new(), Vec::new(), solid.indices);
            if solid.is_colored {
                let colors = solid.colors.iter().map(|&[r, g, b]| [r, g, b, 1.0]);
                let colors: Vec<[f32; 4]> = colors.collect();
                mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
            }
            let material = solid
                .is_colored
                .then(|| colored.place(&mut model.materials));
            model.nodes.push(Node {
                name: name.clone(),
                mesh: Some(name.clone()),
                material,
                ..Node::default()
            });
            model.meshes.insert(name, mesh);
        }
        if model.meshes.is_empty() {
            let nothing = || FileError::new(self.file, Problem::NoTriangles);
            return Err(self.fault.unwrap_or_else(nothing));
        }
        Ok(model)
    }
}

impl Solid {
    /// Adds a corner, the one of that number of its facet; true where it is a vertex that was not there.
    fn corner(&mut self, position: [f32; 3], more: More, number: usize) -> bool {
        let (color, rest) = match more {
            More::Nothing => ([1.0; 3], [0.0; 3]),
            More::Color(color) => (color, color),
            More::Digits(exact) => ([1.0; 3], FarOff::rest(exact[number], position)),
        };
        self.is_colored |= matches!(more, More::Color(_));
        // -0 and 0 are one place.
        let key = [position, rest].map(|three| three.map(|value| (value + 0.0).to_bits()));
        let key = (key[0], key[1]);
        let next = self.positions.len() as u32;
        let index = *self.numbers.entry(key).or_insert(next);
        self.indices.push(index);
        if index == next {
            self.positions.push(position);
            self.colors.push(color);
        }
        index == next
    }
}
