//! Rows for values of which only their reflection is known: components that an app brings along. What can be entered is;
//! the rest is shown.

use super::any_number::AnyNumber;
use super::asset_text::asset_text;
use super::fields::{Changed, axes_of, chosen_ui, color_ui, property_ui, row, switch};
use super::number_field::MIXED;
use super::says::Says;
use super::turn::turn_ui;
use crate::scene::schema::Property;
use bevy::color::{Alpha, Color, LinearRgba, Srgba};
use bevy::math::Quat;
use bevy::reflect::attributes::CustomAttributes;
use bevy::reflect::enums::{DynamicEnum, DynamicVariant, VariantInfo};
use bevy::reflect::std_traits::ReflectDefault;
use bevy::reflect::structs::DynamicStruct;
use bevy::reflect::tuple::DynamicTuple;
use bevy::reflect::{
    PartialReflect, Reflect, ReflectMut, ReflectPath, ReflectRef, TypeInfo, TypeRegistry,
};
use bevy_egui::egui::{TextEdit, Ui};
use std::any::TypeId;
use std::fmt::{self, Write};

/// Parts of parts are drawn so deep; what lies deeper is shown as text.
const DEEPEST: u32 = 8;
/// So many items of a list are drawn.
const MOST_ITEMS: usize = 64;
/// Characters of a value that is shown as text.
const LONGEST_TEXT: usize = 160;

/// How values are drawn.
pub(super) struct Reflected<'a> {
    /// Knows what new items and variants begin as.
    pub registry: &'a TypeRegistry,
    /// Whether several entities differ in what is at a path.
    pub is_mixed: &'a dyn Fn(&str) -> bool,
}

impl Reflected<'_> {
    /// The rows of a value's parts. They work on `root`, of which the value is a part itself; returns the path of what a
    /// person changed there.
    pub fn parts_ui(
        &self,
        ui: &mut Ui,
        root: &mut dyn PartialReflect,
        whole: &Property,
        depth: u32,
    ) -> Changed {
        let value = whole.path.as_str().reflect_element(root).ok()?;
        let mut changed = None;
        for part in parts(whole, value) {
            changed = changed.or(self.value_ui(ui, root, &part, depth));
        }
        changed
    }

    fn value_ui(
        &self,
        ui: &mut Ui,
        root: &mut dyn PartialReflect,
        property: &Property,
        depth: u32,
    ) -> Changed {
        let path = property.path.as_str();
        let (label, says) = (property.label.as_str(), property.says.as_str());
        let value = path.reflect_element_mut(root).ok()?;
        let is_plain = value.try_downcast_ref::<bool>().is_some()
            || value.try_downcast_ref::<LinearRgba>().is_some()
            || AnyNumber::of(value).is_some();
        if let Some(rotation) = value.try_downcast_mut::<Quat>() {
            let mixed = (self.is_mixed)(path);
            let says = "Degrees about x, y and z: first about y, then x, then z";
            let changed = turn_ui(ui, label, says, rotation, mixed);
            return changed.map(|_| path.to_owned());
        }
        if is_plain || axes_of(value).is_some() {
            return property_ui(ui, root, property, self.is_mixed);
        }
        if let Some(color) = value.try_downcast_mut::<Color>() {
            let mixed = (self.is_mixed)(path);
            let changed = row(ui, label, says, |ui| any_color_ui(ui, says, color, mixed));
            return changed.then(|| path.to_owned());
        }
        if let Some(text) = value.try_downcast_mut::<String>() {
            let mixed = (self.is_mixed)(path);
            let changed = row(ui, label, says, |ui| text_ui(ui, text, mixed));
            return changed.then(|| path.to_owned());
        }
        if let Some(text) = asset_text(value, self.registry) {
            let mixed = (self.is_mixed)(path);
            shown_ui(ui, property, if mixed { MIXED } else { &text });
            return None;
        }
        if depth >= DEEPEST {
            shown_ui(ui, property, &short_text(value));
            return None;
        }
        match value.reflect_ref() {
            ReflectRef::Enum(_) => self.variant_ui(ui, root, property, depth),
            ReflectRef::List(_) => self.list_ui(ui, root, property, depth),
            // A struct of one nameless field is what it holds.
            ReflectRef::TupleStruct(fields) if fields.field_len() == 1 => {
                self.parts_ui(ui, root, property, depth + 1)
            }
            ReflectRef::Struct(_)
            | ReflectRef::TupleStruct(_)
            | ReflectRef::Tuple(_)
            | ReflectRef::Array(_) => {
                row(ui, label, says, |ui| ui.weak(type_name(property.kind)));
                ui.indent(path, |ui| self.parts_ui(ui, root, property, depth + 1))
                    .inner
            }
            _ => {
                shown_ui(ui, property, &short_text(value));
                None
            }
        }
    }

    /// Which variant, and what it holds.
    fn variant_ui(
        &self,
        ui: &mut Ui,
        root: &mut dyn PartialReflect,
        property: &Property,
        depth: u32,
    ) -> Changed {
        let path = property.path.as_str();
        let (label, says) = (property.label.as_str(), property.says.as_str());
        let mixed = (self.is_mixed)(path);
        let value = path.reflect_element_mut(root).ok()?;
        let ReflectRef::Enum(now) = value.reflect_ref() else {
            return None;
        };
        let (current, holds) = (now.variant_name().to_owned(), now.field_len());
        let mut choices = property.variants();
        let is_option = choices
            .iter()
            .map(|choice| choice.name)
            .eq(["None", "Some"])
            || choices
                .iter()
                .map(|choice| choice.name)
                .eq(["Some", "None"]);
        // What nothing can be made of cannot be chosen.
        choices.retain(|choice| {
            choice.name == current || self.variant(property.kind, choice.name).is_some()
        });
        let chosen = if is_option && choices.len() == 2 {
            let mut is_some = current == "Some";
            let changed = switch(ui, label, says, &mut is_some, mixed && holds == 0);
            changed.then_some(if is_some { "Some" } else { "None" })
        } else {
            chosen_ui(ui, label, says, &current, &choices, mixed && holds == 0)
        };
        if let Some(chosen) = chosen {
            let variant = self.variant(property.kind, chosen)?;
            return value.try_apply(&variant).ok().map(|()| path.to_owned());
        }
        if holds == 0 {
            return None;
        }
        ui.indent(path, |ui| self.parts_ui(ui, root, property, depth + 1))
            .inner
    }

    /// A variant as it begins; `None` where nobody says what something that it holds begins as.
    fn variant(&self, kind: &TypeInfo, name: &str) -> Option<DynamicEnum> {
        let TypeInfo::Enum(info) = kind else {
            return None;
        };
        let holds = match info.variant(name)? {
            VariantInfo::Unit(_) => DynamicVariant::Unit,
            VariantInfo::Tuple(variant) => {
                let mut fields = DynamicTuple::default();
                for field in variant.iter() {
                    fields.insert_boxed(self.first_value(field.type_id())?.into_partial_reflect());
                }
                DynamicVariant::Tuple(fields)
            }
            VariantInfo::Struct(variant) => {
                let mut fields = DynamicStruct::default();
                for field in variant.iter() {
                    let value = self.first_value(field.type_id())?.into_partial_reflect();
                    fields.insert_boxed(field.name(), value);
                }
                DynamicVariant::Struct(fields)
            }
        };
        Some(DynamicEnum::new(name, holds))
    }

    /// What a value of a type begins as.
    fn first_value(&self, of: TypeId) -> Option<Box<dyn Reflect>> {
        let default = self.registry.get_type_data::<ReflectDefault>(of)?;
        Some(default.default())
    }

    /// The items of a list, each with a button that takes it out, and one that adds another.
    fn list_ui(
        &self,
        ui: &mut Ui,
        root: &mut dyn PartialReflect,
        property: &Property,
        depth: u32,
    ) -> Changed {
        let path = property.path.as_str();
        let value = path.reflect_element(root).ok()?;
        let ReflectRef::List(items) = value.reflect_ref() else {
            return None;
        };
        let count = items.len();
        // Another one like the last, or as its type begins.
        let last = count.checked_sub(1).and_then(|last| items.get(last));
        let next = last.and_then(|last| last.reflect_clone().ok()).or_else(|| {
            let TypeInfo::List(info) = property.kind else {
                return None;
            };
            self.first_value(info.item_ty().id())
        });
        let items = parts(property, value);
        let mut adds = false;
        row(ui, &property.label, &property.says, |ui| {
            ui.weak(match count {
                1 => "1 item".to_owned(),
                count => format!("{count} items"),
            });
            let says = "Adds one at the end";
            adds = next.is_some() && ui.small_button("Add").says(says).clicked();
        });
        let (mut changed, mut gone) = (None, None);
        ui.indent(path, |ui| {
            for (i, item) in items.iter().enumerate() {
                ui.horizontal_top(|ui| {
                    if ui.small_button("✖").says("Takes it out").clicked() {
                        gone = Some(i);
                    }
                    ui.vertical(|ui| {
                        let part = self.value_ui(ui, root, item, depth + 1);
                        changed = changed.take().or(part);
                    });
                });
            }
            if count > items.len() {
                ui.weak(format!("and {} more", count - items.len()));
            }
        });
        let ReflectMut::List(list) = path.reflect_element_mut(root).ok()?.reflect_mut() else {
            return None;
        };
        match (gone, next) {
            (Some(gone), _) => {
                list.remove(gone);
                Some(path.to_owned())
            }
            (None, Some(next)) if adds => {
                list.push(next.into_partial_reflect());
                Some(path.to_owned())
            }
            _ => changed,
        }
    }
}

/// The parts of a value, each with its path and what is said of it where it is declared.
fn parts(whole: &Property, value: &dyn PartialReflect) -> Vec<Property> {
    let info = value.get_represented_type_info();
    let named = |name: &str, attributes: Option<&CustomAttributes>, value| {
        let dot = if whole.path.is_empty() { "" } else { "." };
        let path = format!("{}{dot}{name}", whole.path);
        part(whole, path, attributes, name, value)
    };
    let nameless = |i: usize, count: usize, attributes: Option<&CustomAttributes>, value| {
        let dot = if whole.path.is_empty() { "" } else { "." };
        let label = match (whole.label.as_str(), count) {
            ("", 1) => "Value".to_owned(),
            (label, 1) => label.to_owned(),
            (label, _) => format!("{label} {}", i + 1).trim_start().to_owned(),
        };
        let path = format!("{}{dot}{i}", whole.path);
        part(whole, path, attributes, &label, value)
    };
    let item = |(i, value): (usize, &dyn PartialReflect)| {
        let path = format!("{}[{i}]", whole.path);
        let label = format!("{} {}", whole.label, i + 1);
        part(whole, path, None, label.trim_start(), value)
    };
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => (0..fields.field_len())
            .filter_map(|i| {
                let (name, value) = (fields.name_at(i)?, fields.field_at(i)?);
                let field = match info {
                    Some(TypeInfo::Struct(info)) => info.field(name),
                    _ => None,
                };
                named(name, field.map(|field| field.custom_attributes()), value)
            })
            .collect(),
        ReflectRef::TupleStruct(fields) => (0..fields.field_len())
            .filter_map(|i| {
                let field = match info {
                    Some(TypeInfo::TupleStruct(info)) => info.field_at(i),
                    _ => None,
                };
                let attributes = field.map(|field| field.custom_attributes());
                nameless(i, fields.field_len(), attributes, fields.field(i)?)
            })
            .collect(),
        ReflectRef::Tuple(fields) => (0..fields.field_len())
            .filter_map(|i| nameless(i, fields.field_len(), None, fields.field(i)?))
            .collect(),
        ReflectRef::Enum(variant) => (0..variant.field_len())
            .filter_map(|i| {
                let value = variant.field_at(i)?;
                let Some(name) = variant.name_at(i) else {
                    return nameless(i, variant.field_len(), None, value);
                };
                let field = match info {
                    Some(TypeInfo::Enum(info)) => info.variant(variant.variant_name()),
                    _ => None,
                };
                let field = match field {
                    Some(VariantInfo::Struct(info)) => info.field(name),
                    _ => None,
                };
                named(name, field.map(|field| field.custom_attributes()), value)
            })
            .collect(),
        ReflectRef::List(items) => {
            let items = items.iter().take(MOST_ITEMS).enumerate();
            items.filter_map(item).collect()
        }
        ReflectRef::Array(items) => {
            let items = items.iter().take(MOST_ITEMS).enumerate();
            items.filter_map(item).collect()
        }
        _ => Vec::new(),
    }
}

fn part(
    whole: &Property,
    path: String,
    attributes: Option<&CustomAttributes>,
    name: &str,
    value: &dyn PartialReflect,
) -> Option<Property> {
    let mut part = Property {
        path,
        kind: value.get_represented_type_info()?,
        ..whole.clone()
    }
    .with(attributes.unwrap_or(&CustomAttributes::default()), name);
    if part.says.is_empty() {
        part.says = type_name(part.kind).to_owned();
    }
    Some(part)
}

fn type_name(kind: &TypeInfo) -> &'static str {
    kind.type_path_table().short_path()
}

/// A colour of whatever kind; it stays one of an sRGB screen where it was.
fn any_color_ui(ui: &mut Ui, says: &str, color: &mut Color, mixed: bool) -> bool {
    let mut linear = LinearRgba::from(*color);
    let changed = color_ui(ui, says, &mut linear, mixed);
    if changed {
        let alpha = color.alpha();
        *color = match color {
            Color::Srgba(_) => Color::Srgba(Srgba::from(linear)),
            _ => Color::LinearRgba(linear),
        }
        .with_alpha(alpha);
    }
    changed
}

fn text_ui(ui: &mut Ui, text: &mut String, mixed: bool) -> bool {
    let mut shown = if mixed { String::new() } else { text.clone() };
    let field = TextEdit::singleline(&mut shown)
        .hint_text(if mixed { MIXED } else { "" })
        .desired_width(ui.available_width());
    let changed = ui.add(field).changed();
    if changed {
        *text = shown;
    }
    changed
}

/// What cannot be entered.
fn shown_ui(ui: &mut Ui, property: &Property, text: &str) {
    row(ui, &property.label, &property.says, |ui| {
        let label = bevy_egui::egui::RichText::new(text).weak();
        ui.add(bevy_egui::egui::Label::new(label).truncate())
            .says(text);
    });
}

/// The beginning of a value as text, without the module that its type stands in: the room is for the value.
pub(super) fn short_text(value: &dyn PartialReflect) -> String {
    /// Refuses more than it has room for, so that a long value is not written to its end.
    struct Short(String);
    impl Write for Short {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            let room = LONGEST_TEXT.saturating_sub(self.0.chars().count());
            self.0.extend(text.chars().take(room));
            match text.chars().nth(room) {
                None => Ok(()),
                Some(_) => Err(fmt::Error),
            }
        }
    }
    let mut short = Short(String::new());
    let is_whole = write!(short, "{value:?}").is_ok();
    let Short(mut text) = short;
    let info = value.get_represented_type_info();
    let module = info.and_then(|info| info.type_path_table().module_path());
    if let Some(module) = module
        && let Some(bare) = text.strip_prefix(module)
        && let Some(bare) = bare.strip_prefix("::")
    {
        text = bare.to_owned();
    }
    if is_whole { text } else { text + "…" }
}
