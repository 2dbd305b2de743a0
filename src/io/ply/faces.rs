//! Polygons and strips of a PLY become triangles.

use super::super::error::{Place, Problem};
use super::super::polygon::Triangulator;
use super::body::{Body, Fault};
use super::content::{Content, Work};
use super::header::{Element, Property};
use super::own_corners::OwnCorners;
use super::vertices::whole_of;
use bevy::math::Vec3;
use std::io::BufRead;

const LEFT_OUT: &str = "left out";

/// What a face's property is.
#[derive(Clone, Copy, PartialEq)]
enum Slot {
    /// A list of vertices.
    Corners,
    /// A list of two numbers for each corner.
    Uvs,
    /// With what it is divided by.
    Color(usize, f64),
    Nowhere,
}

impl Slot {
    fn of(property: &Property) -> Self {
        let color = |channel| Self::Color(channel, property.scalar.whole());
        let name = property.name.to_ascii_lowercase();
        match (name.as_str(), property.length.is_some()) {
            ("vertex_indices" | "vertex_index", true) => Self::Corners,
            ("texcoord" | "texcoords", true) => Self::Uvs,
            ("red" | "r" | "diffuse_red", false) => color(0),
            ("green" | "g" | "diffuse_green", false) => color(1),
            ("blue" | "b" | "diffuse_blue", false) => color(2),
            ("alpha" | "a" | "diffuse_alpha", false) => color(3),
            _ => Self::Nowhere,
        }
    }
}

/// The slots of an element, of which one has to be its corners; what goes nowhere is noted. `own` learns what there is
/// for it.
fn slots(
    element: &Element,
    own: &mut OwnCorners,
    content: &mut Content,
    work: &mut Work,
) -> Result<Vec<Slot>, Fault> {
    let mut slots: Vec<Slot> = element.properties.iter().map(Slot::of).collect();
    if !slots.contains(&Slot::Corners) {
        let text = "its faces have no list `vertex_indices`".to_owned();
        return Err(Fault::Of(Problem::Malformed(text)));
    }
    let channels = slots
        .iter()
        .filter(|slot| matches!(slot, Slot::Color(0..3, _)));
    // Where both have some, those of vertices are what was measured.
    let are_free = own.has_colors || content.colors.is_empty();
    let has_colors = channels.count() == 3 && are_free;
    for (property, slot) in element.properties.iter().zip(&mut slots) {
        if !has_colors && matches!(slot, Slot::Color(..)) {
            *slot = Slot::Nowhere;
        }
        if *slot == Slot::Nowhere {
            let what = "what faces have besides:";
            (work.notes).add_named(work.file, Place::Whole, what, &property.name, LEFT_OUT);
        }
    }
    if has_colors {
        content.whole = whole_of(slots.iter().filter_map(|slot| match *slot {
            Slot::Color(channel, whole) => Some((channel, whole)),
            _ => None,
        }));
    }
    own.expect(slots.contains(&Slot::Uvs), has_colors, content);
    Ok(slots)
}

/// What one face says, polygon or strip.
struct Face {
    corners: Vec<f64>,
    uvs: Vec<f64>,
    color: [f32; 4],
    /// Bytes that each corner takes.
    corner_bytes: u64,
}

impl Face {
    /// Before any was read.
    fn of(corner_bytes: u64) -> Self {
        Self {
            corners: Vec::new(),
            uvs: Vec::new(),
            color: [1.0; 4],
            corner_bytes,
        }
    }

    /// Reads the next; where that fails, what there is of it is kept.
    fn read(
        &mut self,
        element: &Element,
        slots: &[Slot],
        body: &mut Body<impl BufRead>,
        work: &mut Work,
    ) -> Result<(), Fault> {
        self.corners.clear();
        self.uvs.clear();
        self.color = [1.0; 4];
        for (property, slot) in element.properties.iter().zip(slots) {
            let list = match *slot {
                Slot::Corners => &mut self.corners,
                Slot::Uvs => &mut self.uvs,
                Slot::Color(channel, whole) => {
                    self.color[channel] = (body.number(property.scalar)? / whole) as f32;
                    continue;
                }
                Slot::Nowhere => {
                    body.skip(property)?;
                    continue;
                }
            };
            let Some(length) = property.length else {
                continue;
            };
            for _ in 0..body.length(length)? {
                work.claim_corners(list.len(), self.corner_bytes)?;
                list.push(body.number(property.scalar)?);
            }
        }
        Ok(())
    }

    /// Adds a triangle of three of its corners, which are vertices that there are.
    fn push(&self, corners: [usize; 3], own: &mut OwnCorners, content: &mut Content) {
        for at in corners {
            let uv = self.uvs.as_chunks::<2>().0.get(at);
            let index = own.vertex(self.corners[at] as u32, uv, self.color, content);
            content.indices.push(index);
        }
    }
}

/// Reads polygons.
pub(super) fn read_faces(
    element: &Element,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    /// As numbers, as places, as triangles, and what finding those takes; vectors grow to twice their length.
    const CORNER: u64 = 2 * (2 * 8 + 12 + 12 + 40);
    let mut own = std::mem::take(&mut content.own);
    let slots = slots(element, &mut own, content, work)?;
    let mut polygons = Polygons {
        count: own.count,
        polygon: Vec::new(),
        triangles: Vec::new(),
        triangulator: Triangulator::default(),
    };
    let mut face = Face::of(CORNER);
    for _ in 0..element.count {
        face.read(element, &slots, body, work)?;
        let place = || body.place(&element.name);
        if polygons.triangulate(&face.corners, content, work, place) {
            for triangle in &polygons.triangles {
                face.push(triangle.map(|at| at as usize), &mut own, content);
            }
        }
        work.claim(content)?;
    }
    own.note(work);
    content.own = own;
    Ok(())
}

/// Reads strips of triangles; -1 begins another. Every second triangle is turned around. What there is of one that is
/// cut short is shown: there are files of a single one.
pub(super) fn read_strips(
    element: &Element,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    /// As numbers, and those of a texture coordinate; vectors grow to twice their length.
    const CORNER: u64 = 2 * 3 * 8;
    let mut own = std::mem::take(&mut content.own);
    let slots = slots(element, &mut own, content, work)?;
    let mut face = Face::of(CORNER);
    for _ in 0..element.count {
        let read = face.read(element, &slots, body, work);
        add_strip(&face, &body.place(&element.name), &mut own, content, work)?;
        read?;
    }
    own.note(work);
    content.own = own;
    Ok(())
}

fn add_strip(
    face: &Face,
    place: &Place,
    own: &mut OwnCorners,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    let corners = &face.corners;
    let mut last: [Option<usize>; 2] = [None; 2];
    let mut is_turned = false;
    for (c, &number) in corners.iter().enumerate() {
        if number == -1.0 {
            last = [None; 2];
            is_turned = false;
            continue;
        }
        if let Err(problem) = vertex(number, own.count, content) {
            let what = "a strip with a corner that cannot be used";
            work.fault(place.clone(), problem, what, "begun anew behind it");
            last = [None; 2];
            is_turned = false;
            continue;
        }
        if let [Some(a), Some(b)] = last {
            let triangle = if is_turned { [b, a, c] } else { [a, b, c] };
            // Strips turn corners by repeating a vertex.
            let [p, q, r] = triangle.map(|at| corners[at]);
            if p != q && q != r && r != p {
                face.push(triangle, own, content);
            }
            is_turned = !is_turned;
        }
        last = [last[1], Some(c)];
        work.claim(content)?;
    }
    Ok(())
}

/// The vertex that a number means, if it is there and has a place.
fn vertex(number: f64, count: usize, content: &Content) -> Result<u32, Problem> {
    let index = number as usize;
    if number < 0.0 || number.fract() != 0.0 || index >= count {
        return Err(Problem::IndexOutOfRange {
            what: "vertex",
            index: number.to_string(),
            count,
        });
    }
    match content.positions[index]
        .iter()
        .all(|value| value.is_finite())
    {
        true => Ok(index as u32),
        false => Err(Problem::NotFinite {
            what: "a vertex".to_owned(),
        }),
    }
}

/// Makes triangles of polygons.
struct Polygons {
    /// Vertices of the file.
    count: usize,
    polygon: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    triangulator: Triangulator,
}

impl Polygons {
    /// False where the polygon cannot be used, which is noted.
    fn triangulate(
        &mut self,
        corners: &[f64],
        content: &Content,
        work: &mut Work,
        place: impl Fn() -> Place,
    ) -> bool {
        self.triangles.clear();
        if corners.len() < 3 {
            let text = format!("a face needs at least 3 corners and has {}", corners.len());
            let what = "a face with fewer than 3 corners";
            work.fault(place(), Problem::Malformed(text), what, LEFT_OUT);
            return false;
        }
        self.polygon.clear();
        for &corner in corners {
            match vertex(corner, self.count, content) {
                Ok(index) => self.polygon.push(content.positions[index as usize].into()),
                Err(problem) => {
                    let what = "a face with a corner that cannot be used";
                    work.fault(place(), problem, what, LEFT_OUT);
                    return false;
                }
            }
        }
        let fit = (self.triangulator).triangulate(&self.polygon, &mut self.triangles);
        if corners.len() > 3
            && let Some((what, instead)) = fit.note()
        {
            work.notes.add(work.file, place(), what, instead);
        }
        true
    }
}
