//! Polygons and strips of a PLY become triangles.

use super::super::error::{Place, Problem};
use super::super::polygon::Triangulator;
use super::body::{Body, Fault};
use super::content::{Content, Work};
use super::header::{Element, Property};
use super::vertices::whole_of;
use bevy::math::Vec3;
use bevy::platform::hash::RandomState;
use std::collections::HashMap;
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

/// The slots of an element, of which one has to be its corners; what goes nowhere is noted.
fn slots(element: &Element, content: &Content, work: &mut Work) -> Result<Vec<Slot>, Fault> {
    let mut slots: Vec<Slot> = element.properties.iter().map(Slot::of).collect();
    if !slots.contains(&Slot::Corners) {
        let text = "its faces have no list `vertex_indices`".to_owned();
        return Err(Fault::Of(Problem::Malformed(text)));
    }
    let channels = slots
        .iter()
        .filter(|slot| matches!(slot, Slot::Color(0..3, _)));
    // Where both have some, those of vertices are what was measured.
    let has_colors = channels.count() == 3 && content.colors.is_empty();
    for (property, slot) in element.properties.iter().zip(&mut slots) {
        if !has_colors && matches!(slot, Slot::Color(..)) {
            *slot = Slot::Nowhere;
        }
        if *slot == Slot::Nowhere {
            let what = "what faces have besides:";
            (work.notes).add_named(work.file, Place::Whole, what, &property.name, LEFT_OUT);
        }
    }
    Ok(slots)
}

/// Reads polygons.
pub(super) fn read_faces(
    element: &Element,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    let slots = slots(element, content, work)?;
    let mut own = OwnCorners::of(&slots, content);
    if own.has_colors {
        content.whole = whole_of(slots.iter().filter_map(|slot| match *slot {
            Slot::Color(channel, whole) => Some((channel, whole)),
            _ => None,
        }));
    }
    let mut faces = Faces {
        count: content.positions.len(),
        polygon: Vec::new(),
        triangles: Vec::new(),
        triangulator: Triangulator::default(),
    };
    let (mut corners, mut uvs) = (Vec::new(), Vec::new());
    for _ in 0..element.count {
        let mut color = [1.0; 4];
        corners.clear();
        uvs.clear();
        for (property, slot) in element.properties.iter().zip(&slots) {
            match *slot {
                Slot::Corners => read_list(property, body, work, &mut corners)?,
                Slot::Uvs => read_list(property, body, work, &mut uvs)?,
                Slot::Color(channel, whole) => {
                    color[channel] = (body.number(property.scalar)? / whole) as f32;
                }
                Slot::Nowhere => body.skip(property)?,
            }
        }
        let place = || body.place(&element.name);
        if faces.triangulate(&corners, content, work, place) {
            for triangle in &faces.triangles {
                for &at in triangle {
                    let index = corners[at as usize] as u32;
                    let uv = uvs.as_chunks::<2>().0.get(at as usize);
                    let index = own.vertex(index, uv, color, content);
                    content.indices.push(index);
                }
            }
        }
        work.claim(content)?;
    }
    if own.uvs_lack {
        let what = "faces without texture coordinates beside others with";
        work.notes
            .add(work.file, Place::Whole, what, "theirs are 0 0");
    }
    Ok(())
}

/// Reads strips of triangles; -1 begins another. Every second triangle is turned around.
pub(super) fn read_strips(
    element: &Element,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    let slots = slots(element, content, work)?;
    let count = content.positions.len();
    for _ in 0..element.count {
        for (property, slot) in element.properties.iter().zip(&slots) {
            let (Slot::Corners, Some(length)) = (*slot, property.length) else {
                body.skip(property)?;
                continue;
            };
            let mut last: [Option<u32>; 2] = [None; 2];
            let mut is_turned = false;
            for _ in 0..body.length(length)? {
                let number = body.number(property.scalar)?;
                if number == -1.0 {
                    last = [None; 2];
                    is_turned = false;
                    continue;
                }
                let c = match vertex(number, count, content) {
                    Ok(index) => index,
                    Err(problem) => {
                        let place = body.place(&element.name);
                        let what = "a strip with a corner that cannot be used";
                        work.fault(place, problem, what, "begun anew behind it");
                        last = [None; 2];
                        is_turned = false;
                        continue;
                    }
                };
                if let [Some(a), Some(b)] = last {
                    let triangle = if is_turned { [b, a, c] } else { [a, b, c] };
                    // Strips turn corners by repeating a vertex.
                    if a != b && b != c && c != a {
                        content.indices.extend(triangle);
                    }
                    is_turned = !is_turned;
                }
                last = [last[1], Some(c)];
                work.claim(content)?;
            }
        }
    }
    Ok(())
}

fn read_list(
    property: &Property,
    body: &mut Body<impl BufRead>,
    work: &mut Work,
    out: &mut Vec<f64>,
) -> Result<(), Fault> {
    let Some(length) = property.length else {
        return Ok(());
    };
    for _ in 0..body.length(length)? {
        work.claim_corners(out.len())?;
        out.push(body.number(property.scalar)?);
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
struct Faces {
    /// Vertices of the file.
    count: usize,
    polygon: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    triangulator: Triangulator,
}

impl Faces {
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

/// Gives vertices what their faces say of them: colours, texture coordinates. Where faces that share one disagree, each
/// has its own.
struct OwnCorners {
    numbers: HashMap<(u32, [u32; 2], [u32; 4]), u32, RandomState>,
    /// Which of the file's vertices have something of a face.
    is_taken: Vec<bool>,
    has_uvs: bool,
    has_colors: bool,
    uvs_lack: bool,
}

impl OwnCorners {
    fn of(slots: &[Slot], content: &mut Content) -> Self {
        let mut own = Self {
            numbers: HashMap::default(),
            is_taken: Vec::new(),
            has_uvs: slots.contains(&Slot::Uvs),
            has_colors: slots.iter().any(|slot| matches!(slot, Slot::Color(..))),
            uvs_lack: false,
        };
        let count = content.positions.len();
        if own.has_uvs {
            content.uvs.resize(count, [0.0; 2]);
        }
        if own.has_colors {
            content.colors.resize(count, [1.0; 4]);
        }
        if own.has_uvs || own.has_colors {
            own.is_taken.resize(count, false);
        }
        own
    }

    /// The vertex of a corner.
    fn vertex(
        &mut self,
        index: u32,
        uv: Option<&[f64; 2]>,
        color: [f32; 4],
        content: &mut Content,
    ) -> u32 {
        let at = index as usize;
        let Some(is_taken) = self.is_taken.get_mut(at) else {
            return index;
        };
        self.uvs_lack |= self.has_uvs && uv.is_none();
        let uv = uv.map_or([0.0; 2], |&[u, v]| [u as f32, 1.0 - v as f32]);
        let key = (index, uv.map(f32::to_bits), color.map(f32::to_bits));
        let next = match *is_taken {
            true => content.positions.len() as u32,
            false => index,
        };
        let known = *self.numbers.entry(key).or_insert(next);
        if known != next {
            return known;
        }
        if *is_taken {
            content.positions.push(content.positions[at]);
            content.normals.extend(content.normals.get(at).copied());
            content.uvs.extend(content.uvs.get(at).copied());
            content.colors.extend(content.colors.get(at).copied());
        }
        *is_taken = true;
        let at = known as usize;
        if self.has_uvs {
            content.uvs[at] = uv;
        }
        if self.has_colors {
            content.colors[at] = color;
        }
        known
    }
}
