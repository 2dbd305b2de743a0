//! The vertices of a PLY.

use super::super::error::{Place, Problem};
use super::body::{Body, Fault};
use super::content::{Content, Work};
use super::header::{Element, Property};
use std::io::BufRead;

/// Where a property's number goes.
#[derive(Clone, Copy)]
enum Slot {
    Position(usize),
    Normal(usize),
    Uv(usize),
    /// With what it is divided by.
    Color(usize, f64),
    Nowhere,
}

impl Slot {
    fn of(property: &Property) -> Self {
        if property.length.is_some() {
            return Self::Nowhere;
        }
        let color = |channel| Self::Color(channel, property.scalar.whole());
        match property.name.to_ascii_lowercase().as_str() {
            "x" => Self::Position(0),
            "y" => Self::Position(1),
            "z" => Self::Position(2),
            "nx" | "normal_x" => Self::Normal(0),
            "ny" | "normal_y" => Self::Normal(1),
            "nz" | "normal_z" => Self::Normal(2),
            "s" | "u" | "s0" | "u0" | "texture_u" => Self::Uv(0),
            "t" | "v" | "t0" | "v0" | "texture_v" => Self::Uv(1),
            "red" | "r" | "diffuse_red" => color(0),
            "green" | "g" | "diffuse_green" => color(1),
            "blue" | "b" | "diffuse_blue" => color(2),
            "alpha" | "a" | "diffuse_alpha" => color(3),
            _ => Self::Nowhere,
        }
    }
}

/// Reads all vertices.
pub(super) fn read_vertices(
    element: &Element,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    let slots: Vec<Slot> = element.properties.iter().map(Slot::of).collect();
    let count = |is: fn(&Slot) -> bool| slots.iter().filter(|slot| is(slot)).count();
    if count(|slot| matches!(slot, Slot::Position(_))) < 3 {
        let text = "its vertices have no x, y and z".to_owned();
        return Err(Fault::Of(Problem::Malformed(text)));
    }
    let has_normals = count(|slot| matches!(slot, Slot::Normal(_))) == 3;
    let has_uvs = count(|slot| matches!(slot, Slot::Uv(_))) == 2;
    let has_colors = count(|slot| matches!(slot, Slot::Color(0..3, _))) == 3;
    for (property, slot) in element.properties.iter().zip(&slots) {
        let is_read = match slot {
            Slot::Position(_) => true,
            Slot::Normal(_) => has_normals,
            Slot::Uv(_) => has_uvs,
            Slot::Color(..) => has_colors,
            Slot::Nowhere => false,
        };
        if !is_read {
            let what = "what vertices have besides:";
            (work.notes).add_named(work.file, Place::Whole, what, &property.name, "left out");
        }
    }
    if has_colors {
        content.whole = whole_of(slots.iter().filter_map(|slot| match *slot {
            Slot::Color(channel, whole) => Some((channel, whole)),
            _ => None,
        }));
    }
    for _ in 0..element.count {
        let (mut position, mut exact) = ([0.0; 3], [0.0; 3]);
        let (mut normal, mut uv) = ([0.0; 3], [0.0; 2]);
        let mut color = [1.0_f32; 4];
        for (property, slot) in element.properties.iter().zip(&slots) {
            if let Slot::Nowhere = slot {
                body.skip(property)?;
                continue;
            }
            let number = body.number(property.scalar)?;
            match *slot {
                Slot::Position(axis) => {
                    position[axis] = number as f32;
                    if work.far_off.may_want() {
                        exact[axis] = body.exact(number);
                    }
                }
                Slot::Normal(axis) => normal[axis] = number as f32,
                Slot::Uv(axis) => uv[axis] = number as f32,
                Slot::Color(channel, whole) => color[channel] = (number / whole) as f32,
                Slot::Nowhere => {}
            }
        }
        if work.far_off.wants(position) {
            (work.far_off).tell(content.positions.len(), exact, position);
        }
        content.positions.push(position);
        if has_normals {
            content.normals.push(normal);
        }
        if has_uvs {
            content.uvs.push([uv[0], 1.0 - uv[1]]);
        }
        if has_colors {
            content.colors.push(color);
        }
        work.claim(content)?;
    }
    let far_off = std::mem::take(&mut work.far_off);
    far_off.settle(&mut [&mut content.positions], work.file, &mut work.notes);
    Ok(())
}

/// What a colour's channels of 1 are; alpha's is 1 where there is none.
pub(super) fn whole_of(channels: impl Iterator<Item = (usize, f64)>) -> [f64; 4] {
    let mut all = [1.0; 4];
    for (channel, whole) in channels {
        all[channel] = whole;
    }
    all
}
