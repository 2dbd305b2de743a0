//! What the schema knows of the parts of a type, by their reflected paths.

use super::range::size_range_text;
use super::{Quantity, Says};
use bevy::math::UVec2;
use bevy::reflect::attributes::CustomAttributes;
use bevy::reflect::enums::{Enum, VariantInfo};
use bevy::reflect::{
    Access, GetPath, ParsedPath, PartialReflect, Reflect, ReflectMut, ReflectPath, ReflectRef,
    TypeInfo, Typed,
};
use bevy::transform::components::Transform;
use std::sync::LazyLock;

/// Attribute: what panels call a field or a variant, where that is not its name with spaces.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label(pub &'static str);

/// Attribute: a field is read only where another one has one of these values, as they are printed.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Path of the other one, from the same root.
    pub path: &'static str,
    /// Its values, with `|` between them.
    pub values: &'static str,
}

impl Needs {
    /// A switch that has to be on.
    pub const fn on(path: &'static str) -> Self {
        Self {
            path,
            values: "true",
        }
    }

    /// Whether the other one has such a value.
    pub fn are_met(&self, root: &dyn PartialReflect) -> bool {
        let value = self
            .path
            .reflect_element(root)
            .map(|value| format!("{value:?}"));
        value.is_ok_and(|value| self.values.split('|').any(|one| one == value))
    }
}

/// Attribute: a number is not above that of another field of the same struct.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotAbove(pub &'static str);

/// Attribute: how many pixels a picture's size may have together.
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq)]
pub struct MostPixels(pub u64);

/// A part of a type.
#[derive(Clone, Debug)]
pub struct Property {
    /// Reflected path from the type, without a dot at its beginning.
    pub path: String,
    /// What panels call it.
    pub label: String,
    /// What it does, without a full stop.
    pub says: String,
    /// What it may be, where it is a number or holds some.
    pub quantity: Option<Quantity>,
    /// Where alone it is read.
    pub needs: Option<Needs>,
    /// How many pixels it may have together, where it is a picture's size.
    pub most_pixels: Option<MostPixels>,
    /// Its type.
    pub kind: &'static TypeInfo,
}

impl Property {
    /// The property of `of` at a path; `None` where it has none there.
    pub fn of(of: &'static TypeInfo, path: &str) -> Option<Self> {
        let mut property = Self::root(of);
        for step in ParsedPath::parse(path).ok()?.0 {
            property.go(&step.access)?;
        }
        property.path = path.to_owned();
        Some(property)
    }

    /// The same of a value: variants of an enum may have parts of the same name, and that of the variant is meant which it
    /// is.
    pub fn of_value(value: &dyn PartialReflect, path: &str) -> Option<Self> {
        let mut property = Self::root(value.get_represented_type_info()?);
        let steps = ParsedPath::parse(path).ok()?.0;
        for (i, step) in steps.iter().enumerate() {
            let here = ParsedPath(steps[..i].to_vec());
            let variant = match here.reflect_element(value).map(PartialReflect::reflect_ref) {
                Ok(ReflectRef::Enum(value)) => Some(value.variant_name()),
                _ => None,
            };
            property.go_in(&step.access, variant)?;
        }
        property.path = path.to_owned();
        Some(property)
    }

    /// What of a type can be set one by one, in its order: the fields of its structs, and of variants.
    pub fn all(of: &'static TypeInfo) -> Vec<Self> {
        let mut found = Vec::new();
        Self::root(of).collect(&mut found);
        found
    }

    /// The whole of a type.
    pub fn root(of: &'static TypeInfo) -> Self {
        Self {
            path: String::new(),
            label: String::new(),
            says: String::new(),
            quantity: None,
            needs: None,
            most_pixels: None,
            kind: of,
        }
    }

    fn collect(self, found: &mut Vec<Self>) {
        let is_group = matches!(self.kind, TypeInfo::Struct(_)) && is_ours(self.kind);
        if !self.path.is_empty() && !is_group {
            found.push(self.clone());
        }
        for step in parts_of(self.kind) {
            let mut part = self.clone();
            if part.go(&step).is_none() {
                continue;
            }
            let dot = if self.path.is_empty() { "" } else { "." };
            part.path = match step {
                Access::Field(name) => format!("{}{dot}{name}", self.path),
                Access::TupleIndex(index) => format!("{}{dot}{index}", self.path),
                _ => continue,
            };
            part.collect(found);
        }
    }

    /// An item of an array.
    pub fn item(&self, index: usize) -> Option<Self> {
        let mut item = self.clone();
        item.go(&Access::ListIndex(index))?;
        item.path = format!("{}[{index}]", self.path);
        Some(item)
    }

    /// What its type may be by name; empty where it is no choice of this crate.
    pub fn choices(&self) -> Vec<Choice> {
        match is_ours(self.kind) {
            true => self.variants(),
            false => Vec::new(),
        }
    }

    /// The variants of its type, whatever they hold.
    pub fn variants(&self) -> Vec<Choice> {
        let TypeInfo::Enum(info) = self.kind else {
            return Vec::new();
        };
        let choice = |variant: &'static VariantInfo| {
            let attributes = variant.custom_attributes();
            let label = attributes.get::<Label>();
            let says = attributes.get::<Says>();
            Choice {
                name: variant.name(),
                label: label.map_or_else(|| words(variant.name()), |label| label.0.to_owned()),
                says: says.map_or_else(String::new, |says| says.text()),
            }
        };
        info.iter().map(choice).collect()
    }

    /// Whether it is read where the whole type has this value.
    pub fn is_read(&self, root: &dyn PartialReflect) -> bool {
        self.needs.is_none_or(|needs| needs.are_met(root))
    }

    /// What it may be, in words: `1 to 50`, `true or false`, `None, Median, …`.
    pub fn range_text(&self) -> String {
        if self.kind.is::<bool>() {
            return "true or false".into();
        }
        let choices = self.choices();
        if !choices.is_empty() {
            let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
            return names.join(", ");
        }
        match (self.quantity, self.most_pixels) {
            (Some(each), Some(MostPixels(most))) => size_range_text(&each, most),
            (Some(quantity), None) => quantity.range_text(),
            (None, _) if self.kind.is::<f32>() => Quantity::ANY.range_text(),
            (None, _) if self.kind.is::<u64>() || self.kind.is::<u32>() => "a whole number".into(),
            (None, _) => String::new(),
        }
    }

    /// Its value as the command line writes it; empty where `root` has none.
    pub fn value_text(&self, root: &impl GetPath) -> String {
        match root.reflect_path(self.path.as_str()) {
            Ok(value) => match value.try_downcast_ref::<UVec2>() {
                Some(size) => format!("{}x{}", size.x, size.y),
                None => format!("{value:?}"),
            },
            Err(_) => String::new(),
        }
    }

    /// The same with what is said at a part of it, a field of this name or a number among its parts.
    pub fn with(mut self, attributes: &CustomAttributes, name: &str) -> Self {
        self.label = attributes
            .get::<Label>()
            .map_or_else(|| words(name), |label| label.0.to_owned());
        self.quantity = attributes.get().copied().or(self.quantity);
        self.most_pixels = attributes.get().copied();
        self.says = attributes
            .get::<Says>()
            .map_or_else(String::new, |says| says.text());
        self
    }

    /// Goes on to a part of it.
    fn go(&mut self, to: &Access<'static>) -> Option<()> {
        self.go_in(to, None)
    }

    /// The same where it is this variant of an enum; any, where it is not known which.
    fn go_in(&mut self, to: &Access<'static>, variant: Option<&str>) -> Option<()> {
        let (attributes, kind) = part_of(self.kind, to, variant)?;
        let is_pair = matches!(self.kind, TypeInfo::Array(info) if info.capacity() == 2);
        // Bevy's own component says nothing of itself.
        let is_place = self.kind.is::<Transform>() && *to == Access::Field("translation".into());
        if is_place {
            self.quantity = Some(Quantity::COORDINATE);
        }
        self.kind = kind;
        match to {
            // An axis of a vector is called after the vector.
            Access::Field(name) if attributes.iter().len() > 0 || self.label.is_empty() => {
                let label = attributes.get::<Label>();
                self.label = label.map_or_else(|| words(name), |label| label.0.to_owned());
            }
            Access::ListIndex(index) if is_pair => {
                self.label += if *index == 0 { " A" } else { " B" };
            }
            Access::ListIndex(index) => self.label += &format!(" {}", index + 1),
            _ => {}
        }
        self.quantity = attributes.get().copied().or(self.quantity);
        self.needs = attributes.get().copied().or(self.needs);
        self.most_pixels = attributes.get().copied().or(self.most_pixels);
        if let Some(says) = attributes.get::<Says>() {
            self.says = says.text();
        }
        Some(())
    }
}

/// The attributes of a part, and its type.
fn part_of(
    kind: &'static TypeInfo,
    to: &Access,
    variant: Option<&str>,
) -> Option<(&'static CustomAttributes, &'static TypeInfo)> {
    let is_it = |other: &&VariantInfo| variant.is_none_or(|variant| other.name() == variant);
    static NONE: LazyLock<CustomAttributes> = LazyLock::new(CustomAttributes::default);
    match (kind, to) {
        (TypeInfo::Struct(info), Access::Field(name)) => {
            let field = info.field(name)?;
            Some((field.custom_attributes(), field.type_info()?))
        }
        (TypeInfo::Enum(info), Access::Field(name)) => {
            info.iter().filter(is_it).find_map(|variant| {
                let field = variant.as_struct_variant().ok()?.field(name)?;
                Some((field.custom_attributes(), field.type_info()?))
            })
        }
        (TypeInfo::Enum(info), Access::TupleIndex(index)) => {
            info.iter().filter(is_it).find_map(|variant| {
                let field = variant.as_tuple_variant().ok()?.field_at(*index)?;
                Some((&*NONE, field.type_info()?))
            })
        }
        (TypeInfo::TupleStruct(info), Access::TupleIndex(index)) => {
            let field = info.field_at(*index)?;
            Some((field.custom_attributes(), field.type_info()?))
        }
        (TypeInfo::Array(info), Access::ListIndex(_)) => Some((&*NONE, info.item_info()?)),
        (TypeInfo::List(info), Access::ListIndex(_)) => Some((&*NONE, info.item_info()?)),
        _ => None,
    }
}

/// The steps to what it consists of, where that can be set one by one.
fn parts_of(kind: &'static TypeInfo) -> Vec<Access<'static>> {
    let named = |name: &&'static str| Access::Field((*name).into());
    match kind {
        TypeInfo::Struct(info) if is_ours(kind) => info.field_names().iter().map(named).collect(),
        TypeInfo::Enum(info) => info
            .iter()
            .flat_map(|variant| match variant {
                VariantInfo::Struct(variant) => variant.field_names().iter().map(named).collect(),
                VariantInfo::Tuple(variant) => {
                    (0..variant.field_len()).map(Access::TupleIndex).collect()
                }
                VariantInfo::Unit(_) => Vec::new(),
            })
            .collect(),
        _ => Vec::new(),
    }
}

/// Of this crate: the structs and enums of others are values as a whole.
fn is_ours(kind: &TypeInfo) -> bool {
    kind.type_path_table().crate_name() == Some("glassbox")
}

/// `soft_shadows` and `VerySlow` as words: `Soft shadows`, `Very slow`.
fn words(name: &str) -> String {
    let mut text = String::new();
    for (i, character) in name.chars().enumerate() {
        match character {
            '_' => text.push(' '),
            _ if i == 0 => text.extend(character.to_uppercase()),
            _ if character.is_uppercase() => {
                text.push(' ');
                text.extend(character.to_lowercase());
            }
            _ => text.push(character),
        }
    }
    text
}

/// One of the variants of an enum.
#[derive(Clone, Debug)]
pub struct Choice {
    /// In files and on the command line.
    pub name: &'static str,
    /// In panels.
    pub label: String,
    /// What it means, without a full stop.
    pub says: String,
}

/// What a type is for, without a full stop; empty where nothing is said.
pub fn about_type(kind: &TypeInfo) -> String {
    let says = match kind {
        TypeInfo::Struct(info) => info.get_attribute::<Says>(),
        TypeInfo::Enum(info) => info.get_attribute::<Says>(),
        _ => None,
    };
    says.map_or_else(String::new, |says| says.text())
}

/// What the variant that a value is means, without a full stop.
pub fn about_choice<T: Typed + Enum>(value: &T) -> String {
    let TypeInfo::Enum(info) = T::type_info() else {
        return String::new();
    };
    let says = info.variant(value.variant_name());
    let says = says.and_then(|variant| variant.custom_attributes().get::<Says>());
    says.map_or_else(String::new, |says| says.text())
}

/// What the variant that a value is, is called where people read it.
pub fn choice_name<T: Typed + Enum>(value: &T) -> String {
    let name = value.variant_name();
    let TypeInfo::Enum(info) = T::type_info() else {
        return words(name);
    };
    let variant = info.variant(name);
    let label = variant.and_then(|variant| variant.custom_attributes().get::<Label>());
    label.map_or_else(|| words(name), |label| label.0.to_owned())
}

/// What a number of a type may be; where the schema says nothing, every finite number. Quick enough to be asked for every
/// lamp of a scene.
pub fn quantity_of<T: Typed>(path: &str) -> Quantity {
    let mut kind = T::type_info();
    let mut quantity = None;
    for step in ParsedPath::parse(path).map_or(Vec::new(), |path| path.0) {
        let Some((attributes, part)) = part_of(kind, &step.access, None) else {
            break;
        };
        quantity = attributes.get().copied().or(quantity);
        kind = part;
    }
    quantity.unwrap_or(Quantity::ANY)
}

/// Moves the other number where one that was set went past it: what is set stays.
pub fn keep_order(root: &mut dyn PartialReflect, set: &str) {
    let (parent, name) = set.rsplit_once('.').unwrap_or(("", set));
    let Ok(group) = parent.reflect_element_mut(root) else {
        return;
    };
    let Some(TypeInfo::Struct(info)) = group.get_represented_type_info() else {
        return;
    };
    let ReflectMut::Struct(fields) = group.reflect_mut() else {
        return;
    };
    let pairs = info.iter().filter_map(|field| {
        let upper = field.get_attribute::<NotAbove>()?.0;
        Some([field.name(), upper])
    });
    for [lower, upper] in pairs {
        let number = |name| fields.field(name)?.try_downcast_ref::<f32>().copied();
        let (Some(least), Some(most)) = (number(lower), number(upper)) else {
            continue;
        };
        if least > most
            && let Some((other, value)) = match name {
                _ if name == lower => Some((upper, least)),
                _ if name == upper => Some((lower, most)),
                _ => None,
            }
            && let Some(other) = fields.field_mut(other)
            && let Some(other) = other.try_downcast_mut::<f32>()
        {
            *other = value;
        }
    }
}

#[cfg(test)]
mod tests;
