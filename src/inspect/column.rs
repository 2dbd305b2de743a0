//! The columns of the list of rays: what each says, how wide it is, and how it sorts.

use super::Names;
use crate::trace::{RayEnd, TracedRay};
use glam::Vec3;
use std::cmp::Ordering;

/// What is known of a ray, a column each: [`COLUMNS`] says what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Column {
    /// Its kind and number.
    Ray,
    /// Surfaces before it.
    Depth,
    /// The object that it leaves.
    From,
    /// What became of it.
    End,
    /// What it met.
    Hit,
    /// Its index in the mesh.
    Triangle,
    /// Metres.
    Distance,
    /// Where in the triangle.
    Barycentric,
    /// The triangle's normal.
    Geometric,
    /// The normal that shading used.
    Normal,
    /// The material that it met.
    Material,
    /// What comes back along it.
    In,
    /// Its part of what comes back along its parent.
    Out,
    /// What it put into the sample.
    Adds,
    /// The part of a light that arrives.
    Transmittance,
    /// Nodes entered.
    Nodes,
    /// Boxes tested.
    Boxes,
    /// Triangles tested.
    Triangles,
}

/// A column as a table has it.
pub struct Heading {
    /// Which one.
    pub column: Column,
    /// What stands above it.
    pub name: &'static str,
    /// In points, as wide as its widest usual text.
    pub width: f32,
    /// Its numbers stand to the right.
    pub right: bool,
    /// What it holds.
    pub says: &'static str,
}

const fn heading(
    column: Column,
    name: &'static str,
    width: f32,
    right: bool,
    says: &'static str,
) -> Heading {
    Heading {
        column,
        name,
        width,
        right,
        says,
    }
}

/// All columns, from the left: what a ray met and what light it brings before where and how.
pub const COLUMNS: [Heading; 18] = [
    heading(
        Column::Ray,
        "ray",
        176.0,
        false,
        "What the ray is for, and its number; its children stand below it",
    ),
    heading(
        Column::End,
        "end",
        84.0,
        false,
        "What became of it: surface, light, background; for light: arrived, blocked, unshadowed, or unlit where it was not traced",
    ),
    heading(
        Column::Hit,
        "meets",
        110.0,
        false,
        "The object or light where it ended; of a shadow ray its light, and what blocks it",
    ),
    heading(
        Column::Adds,
        "adds",
        168.0,
        true,
        "What it put into the sample's value by itself; these add up to the value, bit for bit",
    ),
    heading(
        Column::In,
        "in",
        168.0,
        true,
        "The radiance that comes back along the ray to its start, linear RGB",
    ),
    heading(
        Column::Out,
        "out",
        168.0,
        true,
        "Its part of what comes back along its parent: weight × radiance",
    ),
    heading(
        Column::Transmittance,
        "transmitted",
        150.0,
        true,
        "The part of the light that arrives, for rays to lights",
    ),
    heading(
        Column::Distance,
        "t",
        66.0,
        true,
        "Metres from the ray's start to where it ended",
    ),
    heading(
        Column::From,
        "from",
        96.0,
        false,
        "The object whose surface it leaves",
    ),
    heading(
        Column::Depth,
        "depth",
        44.0,
        true,
        "Surfaces between the camera and the ray's start",
    ),
    heading(
        Column::Triangle,
        "triangle",
        58.0,
        true,
        "The triangle that was hit, by its index in the mesh",
    ),
    heading(
        Column::Barycentric,
        "u v",
        104.0,
        true,
        "Barycentric weights of the triangle's second and third corner",
    ),
    heading(
        Column::Geometric,
        "face normal",
        132.0,
        true,
        "Unit normal of the triangle, turned to the viewer",
    ),
    heading(
        Column::Normal,
        "normal",
        132.0,
        true,
        "Unit normal that shading used",
    ),
    heading(
        Column::Material,
        "material",
        92.0,
        false,
        "Which material was hit, and kd there as a colour",
    ),
    heading(
        Column::Nodes,
        "nodes",
        48.0,
        true,
        "Nodes that the walk which traces pictures entered",
    ),
    heading(Column::Boxes, "boxes", 48.0, true, "Boxes that it tested"),
    heading(
        Column::Triangles,
        "triangles",
        62.0,
        true,
        "Triangles that it tested",
    ),
];

/// By what a column sorts.
#[derive(Debug, PartialEq)]
enum Key {
    /// There is nothing in it: last, whichever way is up.
    Nothing,
    Numbers([f64; 3]),
    Text(String),
}

impl Column {
    fn key(self, ray: &TracedRay, names: &Names) -> Key {
        let number = |value: f64| Key::Numbers([value, 0.0, 0.0]);
        let whole = |value: u64| number(value as f64);
        let hit = ray.hit.as_ref();
        let vector = |value: Option<Vec3>| match value {
            Some(v) => Key::Numbers(v.to_array().map(f64::from)),
            None => Key::Nothing,
        };
        // Colours sort by how bright they are.
        let bright = |v: Vec3| number(f64::from(v.x) + f64::from(v.y) + f64::from(v.z));
        match self {
            Self::Ray => Key::Numbers([f64::from(ray.kind as u8), 0.0, 0.0]),
            Self::Depth => number(f64::from(ray.depth)),
            Self::From => match ray.from {
                Some(id) => Key::Text(names.of(id)),
                None => Key::Nothing,
            },
            Self::End => Key::Text(ray.end.name().into()),
            Self::Hit => match meets(ray, names) {
                text if text.is_empty() => Key::Nothing,
                text => Key::Text(text),
            },
            Self::Triangle => hit.map_or(Key::Nothing, |hit| whole(hit.triangle.into())),
            Self::Distance => match metres(ray) {
                Some(t) => number(t.into()),
                None => Key::Nothing,
            },
            Self::Barycentric => hit.map_or(Key::Nothing, |hit| {
                let [u, v] = hit.barycentric;
                Key::Numbers([u.into(), v.into(), 0.0])
            }),
            Self::Geometric => vector(hit.map(|hit| hit.geometric_normal)),
            Self::Normal => vector(hit.map(|hit| hit.normal)),
            Self::Material => hit.map_or(Key::Nothing, |hit| whole(hit.material.into())),
            Self::In => bright(ray.radiance),
            Self::Out => bright(ray.carried),
            Self::Adds => bright(ray.added),
            Self::Transmittance if ray.kind.is_for_light() => bright(ray.transmittance),
            Self::Transmittance => Key::Nothing,
            Self::Nodes => whole(ray.cost.nodes),
            Self::Boxes => whole(ray.cost.boxes),
            Self::Triangles => whole(ray.cost.triangles),
        }
    }

    /// Puts rays, given by their numbers, into this column's order; equal ones stay as they are.
    pub fn sort(self, order: &mut [u32], rays: &[TracedRay], names: &Names, descending: bool) {
        let mut keyed: Vec<(Key, u32)> = order
            .iter()
            .map(|&ray| (self.key(&rays[ray as usize], names), ray))
            .collect();
        keyed.sort_by(|(a, _), (b, _)| a.compare(b, descending));
        for (place, (_, ray)) in order.iter_mut().zip(keyed) {
            *place = ray;
        }
    }

    /// What stands in the cell.
    pub fn text(self, index: u32, ray: &TracedRay, names: &Names) -> String {
        let hit = ray.hit.as_ref();
        let of_hit =
            |text: &dyn Fn(&crate::trace::RayHit) -> String| hit.map_or(String::new(), text);
        match self {
            Self::Ray => format!("{} {index}", ray.kind.name()),
            Self::Depth => ray.depth.to_string(),
            Self::From => ray.from.map_or_else(String::new, |id| names.of(id)),
            Self::End => ray.end.name().into(),
            Self::Hit => meets(ray, names),
            Self::Triangle => of_hit(&|hit| hit.triangle.to_string()),
            Self::Distance => metres(ray).map_or_else(|| "∞".into(), |t| format!("{t:.4}")),
            Self::Barycentric => of_hit(&|hit| {
                let [u, v] = hit.barycentric;
                format!("{u:.4} {v:.4}")
            }),
            Self::Geometric => of_hit(&|hit| vector_text(hit.geometric_normal)),
            Self::Normal => of_hit(&|hit| vector_text(hit.normal)),
            Self::Material => of_hit(&|hit| names.of_material(hit.material)),
            Self::In => color_text(ray.radiance),
            Self::Out => color_text(ray.carried),
            Self::Adds => color_text(ray.added),
            Self::Transmittance if ray.kind.is_for_light() => color_text(ray.transmittance),
            Self::Transmittance => String::new(),
            Self::Nodes => ray.cost.nodes.to_string(),
            Self::Boxes => ray.cost.boxes.to_string(),
            Self::Triangles => ray.cost.triangles.to_string(),
        }
    }

    /// The colour that stands before the text, linear RGB.
    pub fn swatch(self, ray: &TracedRay) -> Option<Vec3> {
        match self {
            Self::Material => ray.hit.map(|hit| hit.diffuse),
            Self::In => Some(ray.radiance),
            Self::Out => Some(ray.carried),
            Self::Adds => Some(ray.added),
            Self::Transmittance if ray.kind.is_for_light() => Some(ray.transmittance),
            _ => None,
        }
    }
}

impl Key {
    fn compare(&self, other: &Self, descending: bool) -> Ordering {
        let order = match (self, other) {
            (Self::Nothing, Self::Nothing) => return Ordering::Equal,
            (Self::Nothing, _) => return Ordering::Greater,
            (_, Self::Nothing) => return Ordering::Less,
            (Self::Numbers(a), Self::Numbers(b)) => a
                .iter()
                .zip(b)
                .map(|(a, b)| a.total_cmp(b))
                .find(|order| order.is_ne())
                .unwrap_or(Ordering::Equal),
            (Self::Text(a), Self::Text(b)) => a.cmp(b),
            (Self::Numbers(_), Self::Text(_)) => Ordering::Less,
            (Self::Text(_), Self::Numbers(_)) => Ordering::Greater,
        };
        if descending { order.reverse() } else { order }
    }
}

/// Metres to where a ray ended; `None` for what has no end.
pub fn metres(ray: &TracedRay) -> Option<f32> {
    let metres = ray.t * ray.direction.length();
    metres.is_finite().then_some(metres)
}

/// What a ray ended at, by name.
pub fn meets(ray: &TracedRay, names: &Names) -> String {
    let hit = ray.hit.map(|hit| names.of(hit.object));
    match (&ray.light, hit, ray.met_light) {
        (Some(light), Some(hit), _) if ray.end == RayEnd::Blocked => {
            format!("{}, by {hit}", names.of(light.id))
        }
        (Some(light), _, _) => names.of(light.id),
        (None, Some(hit), _) => hit,
        (None, None, Some(light)) => names.of(light),
        (None, None, None) => String::new(),
    }
}

/// Four decimals, and a zero that is exactly one is written as such.
pub fn color_text(v: Vec3) -> String {
    if v == Vec3::ZERO {
        return "0".into();
    }
    let part = |x: f32| match x.abs() {
        0.0 => "0".into(),
        small if small < 0.0001 => format!("{x:.0e}"),
        large if large >= 1000.0 => format!("{x:.1}"),
        _ => format!("{x:.4}"),
    };
    let [r, g, b] = v.to_array().map(part);
    format!("{r} {g} {b}")
}

/// Three decimals.
pub fn vector_text(v: Vec3) -> String {
    // No minus before a zero.
    let [x, y, z] = v.to_array().map(|c| if c.abs() < 5e-4 { 0.0 } else { c });
    format!("{x:.3} {y:.3} {z:.3}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_sorts_last_whichever_way_is_up() {
        let keys = || {
            [
                Key::Nothing,
                Key::Numbers([2.0, 0.0, 0.0]),
                Key::Numbers([1.0, 9.0, 0.0]),
            ]
        };
        for (descending, first) in [(false, 1.0), (true, 2.0)] {
            let mut sorted = keys();
            sorted.sort_by(|a, b| a.compare(b, descending));
            assert_eq!(sorted[2], Key::Nothing, "descending: {descending}");
            assert!(matches!(sorted[0], Key::Numbers([n, ..]) if n == first));
        }
    }

    #[test]
    fn colours_are_written_with_what_they_have() {
        assert_eq!(color_text(Vec3::ZERO), "0");
        assert_eq!(color_text(Vec3::new(0.25, 0.0, 1e-6)), "0.2500 0 1e-6");
        assert_eq!(color_text(Vec3::new(1234.56, 1.0, 0.0)), "1234.6 1.0000 0");
        assert_eq!(
            vector_text(Vec3::new(-1e-7, 1.0, -0.5)),
            "0.000 1.000 -0.500"
        );
    }
}
