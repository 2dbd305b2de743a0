//! Whether all numbers of a value are what the schema lets them be.

use super::{MostPixels, NotAbove, Quantity};
use bevy::math::UVec2;
use bevy::reflect::enums::VariantInfo;
use bevy::reflect::{PartialReflect, ReflectRef, TypeInfo};
use std::fmt;

/// A number that is out of its range.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeProblem {
    /// Reflected path of the number.
    pub path: String,
    /// What it is.
    pub value: String,
    /// What it may be.
    pub range: String,
}

impl fmt::Display for RangeProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, value, range } = self;
        write!(f, "{path} is {value}, and must be {range}")
    }
}

impl std::error::Error for RangeProblem {}

/// The numbers of a value that are out of range, in order, with their paths from it. Numbers of which the schema says
/// nothing have to be finite.
pub fn range_problems(value: &dyn PartialReflect) -> Vec<RangeProblem> {
    let mut walk = Walk {
        path: String::new(),
        found: Vec::new(),
    };
    walk.value(value, None);
    walk.found
}

struct Walk {
    path: String,
    found: Vec<RangeProblem>,
}

impl Walk {
    fn value(&mut self, value: &dyn PartialReflect, quantity: Option<Quantity>) {
        if let Some(&number) = value.try_downcast_ref::<f32>() {
            self.number(f64::from(number), number.to_string(), quantity);
            return;
        }
        if let Some(&number) = value.try_downcast_ref::<u32>() {
            let quantity = quantity.or(Some(Quantity::within(0.0, f64::from(u32::MAX), "")));
            self.number(f64::from(number), number.to_string(), quantity);
            return;
        }
        let kind = value.get_represented_type_info();
        match value.reflect_ref() {
            ReflectRef::Struct(fields) => {
                for index in 0..fields.field_len() {
                    let (Some(name), Some(field)) = (fields.name_at(index), fields.field_at(index))
                    else {
                        continue;
                    };
                    let attributes = match kind {
                        Some(TypeInfo::Struct(info)) => info.field(name),
                        _ => None,
                    };
                    let attributes = attributes.map(|field| field.custom_attributes());
                    let own = attributes.and_then(|all| all.get::<Quantity>()).copied();
                    let quantity = own.or(quantity);
                    self.within(name, |walk| {
                        if let Some(most) = attributes.and_then(|all| all.get::<MostPixels>())
                            && let Some(size) = field.try_downcast_ref::<UVec2>()
                        {
                            walk.size(*size, *most, quantity);
                            return;
                        }
                        walk.value(field, quantity);
                        if let Some(NotAbove(upper)) = attributes.and_then(|all| all.get())
                            && let Some(most) = fields.field(upper)
                        {
                            walk.not_above(field, most, upper);
                        }
                    });
                }
            }
            ReflectRef::TupleStruct(fields) => {
                for field in fields.iter_fields() {
                    self.value(field, quantity);
                }
            }
            ReflectRef::Array(items) => {
                for (index, item) in items.iter().enumerate() {
                    self.part(&index.to_string(), item, quantity);
                }
            }
            ReflectRef::List(items) => {
                for (index, item) in items.iter().enumerate() {
                    self.part(&index.to_string(), item, quantity);
                }
            }
            ReflectRef::Enum(variant) => {
                let info = match kind {
                    Some(TypeInfo::Enum(info)) => info.variant(variant.variant_name()),
                    _ => None,
                };
                for field in variant.iter_fields() {
                    let Some(name) = field.name() else {
                        self.value(field.value(), quantity);
                        continue;
                    };
                    let own = match info {
                        Some(VariantInfo::Struct(info)) => info.field(name),
                        _ => None,
                    };
                    let own = own
                        .and_then(|field| field.get_attribute::<Quantity>())
                        .copied();
                    self.part(name, field.value(), own.or(quantity));
                }
            }
            // What scenes keep has no other shapes with numbers in them.
            _ => {}
        }
    }

    fn part(&mut self, name: &str, value: &dyn PartialReflect, quantity: Option<Quantity>) {
        self.within(name, |walk| walk.value(value, quantity));
    }

    fn within(&mut self, name: &str, look: impl FnOnce(&mut Self)) {
        let before = self.path.len();
        if before > 0 {
            self.path.push('.');
        }
        self.path.push_str(name);
        look(self);
        self.path.truncate(before);
    }

    fn number(&mut self, number: f64, text: String, quantity: Option<Quantity>) {
        let quantity = quantity.unwrap_or(Quantity::ANY);
        if !quantity.allows(number) {
            self.note(text, quantity.range_text());
        }
    }

    fn note(&mut self, value: String, range: String) {
        self.found.push(RangeProblem {
            path: self.path.clone(),
            value,
            range,
        });
    }

    fn not_above(&mut self, field: &dyn PartialReflect, most: &dyn PartialReflect, name: &str) {
        let numbers = (
            field.try_downcast_ref::<f32>(),
            most.try_downcast_ref::<f32>(),
        );
        if let (Some(number), Some(most)) = numbers
            && number > most
        {
            self.note(
                number.to_string(),
                format!("at most {name}, which is {most}"),
            );
        }
    }

    /// A picture's size, said as a whole.
    fn size(&mut self, size: UVec2, MostPixels(most): MostPixels, each: Option<Quantity>) {
        let each = each.unwrap_or(Quantity::ANY);
        let allows = |side: u32| each.allows(side.into());
        let pixels = u64::from(size.x) * u64::from(size.y);
        if !(allows(size.x) && allows(size.y) && pixels <= most) {
            let range = size_range_text(&each, most);
            self.note(format!("{}x{}", size.x, size.y), range);
        }
    }
}

/// What a picture's size may be.
pub(super) fn size_range_text(each: &Quantity, most: u64) -> String {
    format!("WxH, each {}, at most {most} together", each.range_text())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cone, MeshSource, Phong, PointLamp, RenderSettings, Shape};
    use bevy::color::LinearRgba;

    fn found(value: &dyn PartialReflect) -> Vec<String> {
        range_problems(value)
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    #[test]
    fn every_number_out_of_range_is_named_with_its_path_and_its_range() {
        let lamp = PointLamp {
            intensity: -1.0,
            color: LinearRgba::rgb(0.0, f32::NAN, 0.0),
            cone: Some(Cone {
                inner: 0.6,
                outer: 0.5,
            }),
        };
        assert_eq!(
            found(&lamp),
            [
                "color.green is NaN, and must be at least 0",
                "intensity is -1, and must be at least 0",
                "cone.inner is 0.6, and must be at most outer, which is 0.5",
            ]
        );
        let knot = MeshSource::Shape(Shape::Torus {
            major_radius: 1.0,
            minor_radius: 0.0,
            segments: 2,
            sides: 3,
        });
        assert_eq!(
            found(&knot),
            [
                "minor_radius is 0, and must be between 0 and 1e12",
                "segments is 2, and must be 3 to 65536",
            ]
        );
        let settings = RenderSettings {
            size: UVec2::new(0, 9),
            ..RenderSettings::default()
        };
        let size = "size is 0x9, and must be WxH, each 1 to 65536, at most 268435456 together";
        assert_eq!(found(&settings), [size]);
        assert_eq!(found(&Phong::default()), Vec::<String>::new());
    }
}
