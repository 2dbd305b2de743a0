//! The fields that properties are entered in: a label with its explanation on the left, the value on the right. What is
//! asked and what may be answered is the schema's; merely being drawn changes nothing, not even a value out of range.

use super::any_number::AnyNumber;
use super::number_field::{MIXED, NumberField};
use super::says::{Says, in_row};
use crate::scene::schema::{Choice, MostPixels, Property, Quantity, Unit, keep_order};
use bevy::color::LinearRgba;
use bevy::math::UVec2;
use bevy::reflect::enums::{DynamicEnum, DynamicVariant};
use bevy::reflect::{
    PartialReflect, Reflect, ReflectMut, ReflectPath, ReflectRef, TypeInfo, Typed,
};
use bevy_egui::egui::{self, Align, ComboBox, Label, Layout, StrokeKind, Ui, vec2};

/// The part of the width that labels take.
const LABELS: f32 = 0.38;
/// Points to the right of all rows that the bar takes with which they are scrolled.
const SCROLL_BAR: f32 = 6.0;

/// A label with its explanation, and what stands beside it. Fields take all the width that there is, so that they end at
/// one edge.
pub(super) fn row<R>(ui: &mut Ui, label: &str, says: &str, value: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        ui.set_max_width(ui.available_width() - SCROLL_BAR);
        let width = (ui.available_width() * LABELS).clamp(70.0, 160.0);
        let size = vec2(width, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(width);
            ui.add(Label::new(label).truncate()).says(says);
        });
        in_row(ui, label, value)
    })
    .inner
}

/// Which part of a value a person changed: its path, or nothing.
pub(super) type Changed = Option<String>;

/// The row of a property. `is_mixed` says whether several entities differ in what is at a path. It works on `root` and
/// returns the path of what was changed there.
pub(super) fn property_ui(
    ui: &mut Ui,
    root: &mut dyn PartialReflect,
    property: &Property,
    is_mixed: &dyn Fn(&str) -> bool,
) -> Changed {
    let (label, says) = (property.label.as_str(), property.says.as_str());
    if let TypeInfo::Array(info) = property.kind {
        return (0..info.capacity()).fold(None, |changed, index| {
            let part = property.item(index);
            let part = part.and_then(|part| property_ui(ui, root, &part, is_mixed));
            changed.or(part)
        });
    }
    let path = property.path.as_str();
    let mixed = is_mixed(path);
    let value = path.reflect_element_mut(root).ok()?;
    if let Some(value) = value.try_downcast_mut::<bool>() {
        return switch(ui, label, says, value, mixed).then(|| path.to_owned());
    }
    if let Some(number) = AnyNumber::of(value) {
        let field = NumberField {
            is_mixed: mixed,
            ..number.field(says, property.quantity)
        };
        let changed = row(ui, label, says, |ui| number.ui(ui, field, value));
        return changed.then(|| path.to_owned());
    }
    if let Some(value) = value.try_downcast_mut::<LinearRgba>() {
        // What is a factor may be brighter than 1.
        let is_bright = property
            .quantity
            .is_some_and(|quantity| quantity.unit == Unit::TIMES);
        let changed = row(ui, label, says, |ui| match is_bright {
            true => radiant_ui(ui, says, value, mixed),
            false => color_ui(ui, says, value, mixed),
        });
        return changed.then(|| path.to_owned());
    }
    let Some(axes) = axes_of(value) else {
        let choices = property.choices();
        return choice_ui(ui, label, says, value, &choices, mixed).then(|| path.to_owned());
    };
    let size = value.try_downcast_ref::<UVec2>().copied();
    let ReflectMut::Struct(parts) = value.reflect_mut() else {
        return None;
    };
    let changed = vector_ui(ui, label, says, axes.len(), |ui, i| {
        let (axis, part) = (axes[i], parts.field_at_mut(i)?);
        let number = AnyNumber::of(part)?;
        let mut field = NumberField {
            is_mixed: is_mixed(&format!("{path}.{axis}")),
            ..number.field(says, property.quantity)
        };
        field.quantity.slider = None;
        // What is left of the pixels that both sides may have together.
        if let (Some(size), Some(MostPixels(most))) = (size, property.most_pixels) {
            let other = u64::from(size[1 - i.min(1)].max(1));
            field.quantity.most = field.quantity.most.min((most / other) as f64);
        }
        Some(number.ui(ui, field, part))
    });
    changed.map(|i| format!("{path}.{}", axes[i]))
}

/// The axes of a vector of whatever numbers; `None` where it is none.
pub(super) fn axes_of(value: &dyn PartialReflect) -> Option<&'static [&'static str]> {
    const AXES: [&str; 4] = ["x", "y", "z", "w"];
    let ReflectRef::Struct(parts) = value.reflect_ref() else {
        return None;
    };
    let axes = AXES
        .get(..parts.field_len())
        .filter(|axes| axes.len() > 1)?;
    let is_axis = |(i, axis): (usize, &&str)| {
        parts.name_at(i) == Some(*axis)
            && parts
                .field_at(i)
                .is_some_and(|p| AnyNumber::of(p).is_some())
    };
    axes.iter().enumerate().all(is_axis).then_some(axes)
}

/// The rows of these properties of a value by itself: the settings of the scene, for example. What is read only with
/// another setting is faint without it, and says so.
pub(super) fn properties_ui<T: Reflect + Typed>(ui: &mut Ui, root: &mut T, paths: &[&str]) {
    for path in paths {
        if let Some(mut property) = Property::of(T::type_info(), path) {
            one_ui(ui, root, &mut property);
        }
    }
}

fn one_ui<T: Reflect + Typed>(ui: &mut Ui, root: &mut T, property: &mut Property) {
    property.says = format!("{} ({})", property.says, property.path);
    let is_read = property.is_read(root.as_partial_reflect());
    if !is_read
        && let Some(needs) = property.needs
        && let Some(other) = Property::of(T::type_info(), needs.path)
    {
        property.says += &format!("; needs {}", other.label);
    }
    ui.scope(|ui| {
        if !is_read {
            // It can be entered all the same: what it needs may come later.
            ui.multiply_opacity(0.55);
        }
        let root = root.as_partial_reflect_mut();
        if let Some(changed) = property_ui(ui, root, property, &|_| false) {
            keep_order(root, &changed);
        }
    });
}

/// A number of whatever type, the field alone.
fn number_ui(
    ui: &mut Ui,
    says: &str,
    value: &mut dyn PartialReflect,
    quantity: Quantity,
    mixed: bool,
) -> bool {
    AnyNumber::of(value).is_some_and(|number| {
        let field = NumberField {
            is_mixed: mixed,
            ..number.field(says, Some(quantity))
        };
        number.ui(ui, field, value)
    })
}

/// Numbers in a line, each drawn by `one`; returns which was changed.
fn vector_ui(
    ui: &mut Ui,
    label: &str,
    says: &str,
    count: usize,
    mut one: impl FnMut(&mut Ui, usize) -> Option<bool>,
) -> Option<usize> {
    row(ui, label, says, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let width = (ui.available_width() - 3.0 * (count as f32 - 1.0)) / count as f32;
        let mut changed = None;
        for axis in 0..count {
            let size = vec2(width.max(30.0), ui.spacing().interact_size.y);
            ui.allocate_ui(size, |ui| {
                let called = format!("{label} {}", axis + 1);
                if in_row(ui, &called, |ui| one(ui, axis)) == Some(true) {
                    changed = Some(axis);
                }
            });
        }
        changed
    })
}

/// A number with its label that is no property of the scene.
pub(super) fn number_row(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut dyn PartialReflect,
    quantity: Quantity,
) -> bool {
    row(ui, label, says, |ui| {
        number_ui(ui, says, value, quantity, false)
    })
}

/// The same without a label, as wide as its digits.
pub(super) fn number(ui: &mut Ui, says: &str, value: &mut f32, quantity: Quantity) -> bool {
    number_within(ui, says, value, quantity, 60.0)
}

/// The same, so wide.
pub(super) fn number_within(
    ui: &mut Ui,
    says: &str,
    value: &mut dyn PartialReflect,
    quantity: Quantity,
    width: f32,
) -> bool {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, 20.0), layout, |ui| {
        number_ui(ui, says, value, quantity, false)
    })
    .inner
}

/// A switch with its label.
pub(super) fn switch(ui: &mut Ui, label: &str, says: &str, value: &mut bool, mixed: bool) -> bool {
    row(ui, label, says, |ui| {
        let text = if mixed { MIXED } else { "" };
        ui.checkbox(value, text).says(says).changed()
    })
}

/// A colour without a label, in [0, 1], linear inside, shown and entered as a screen's.
pub(super) fn color_ui(ui: &mut Ui, says: &str, value: &mut LinearRgba, mixed: bool) -> bool {
    let mut rgb = [value.red, value.green, value.blue];
    let response = ui.color_edit_button_rgb(&mut rgb).says(says);
    // A white one is to be seen in the light theme, too.
    let visuals = ui.style().interact(&response);
    let (corner, edge) = (visuals.corner_radius, visuals.bg_stroke);
    ui.painter()
        .rect_stroke(response.rect, corner, edge, StrokeKind::Inside);
    if mixed {
        ui.weak(MIXED);
    }
    let changed = response.changed() && rgb.iter().all(|part| part.is_finite());
    if changed {
        *value = LinearRgba::new(rgb[0], rgb[1], rgb[2], value.alpha);
    }
    changed
}

/// A colour that may be brighter than 1: its hue, and its largest component as a number.
fn radiant_ui(ui: &mut Ui, says: &str, value: &mut LinearRgba, mixed: bool) -> bool {
    let [strength, hue] = split(*value);
    let mut entered = hue;
    let mut changed = color_ui(ui, says, &mut entered, mixed);
    let mut level = strength.red;
    changed |= number_ui(ui, says, &mut level, Quantity::FACTOR, mixed);
    if changed {
        let part = |channel: f32| (channel * level).min(f32::MAX);
        *value = LinearRgba::rgb(part(entered.red), part(entered.green), part(entered.blue));
    }
    changed
}

/// The largest component (in every channel), and the colour divided by it.
fn split(color: LinearRgba) -> [LinearRgba; 2] {
    let strength = color.red.max(color.green).max(color.blue);
    let hue = if strength > 0.0 && strength.is_finite() {
        LinearRgba::rgb(
            color.red / strength,
            color.green / strength,
            color.blue / strength,
        )
    } else {
        LinearRgba::WHITE
    };
    [LinearRgba::rgb(strength, strength, strength), hue]
}

/// One of an enum's variants that hold nothing else.
fn choice_ui(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut dyn PartialReflect,
    choices: &[Choice],
    mixed: bool,
) -> bool {
    let ReflectRef::Enum(now) = value.reflect_ref() else {
        return false;
    };
    let current = now.variant_name().to_owned();
    let chosen = chosen_ui(ui, label, says, &current, choices, mixed);
    chosen.is_some_and(|name| {
        let variant = DynamicEnum::new(name, DynamicVariant::Unit);
        // It fails only for a variant that holds something, and those are chosen elsewhere.
        value.try_apply(&variant).is_ok()
    })
}

/// The variants of an enum to choose from; returns the name of another one that was chosen.
pub(super) fn chosen_ui(
    ui: &mut Ui,
    label: &str,
    says: &str,
    current: &str,
    choices: &[Choice],
    mixed: bool,
) -> Option<&'static str> {
    let shown = choices.iter().find(|choice| choice.name == current);
    let shown = match mixed {
        true => MIXED,
        false => shown.map_or(current, |choice| choice.label.as_str()),
    };
    let mut chosen = None;
    row(ui, label, says, |ui| {
        ComboBox::from_id_salt(label)
            .selected_text(shown)
            .width(ui.available_width().max(60.0))
            .truncate()
            .show_ui(ui, |ui| {
                for choice in choices {
                    let is_current = !mixed && choice.name == current;
                    let response = ui.selectable_label(is_current, &choice.label);
                    if response.says(&choice.says).clicked() && !is_current {
                        chosen = Some(choice.name);
                    }
                }
            })
            .response
            .says(says);
    });
    chosen
}

/// A heading that folds what is below it.
pub(super) fn section(ui: &mut Ui, title: &str, open: bool, body: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(egui::RichText::new(title).strong())
        .id_salt(title)
        .default_open(open)
        .show_unindented(ui, body);
    ui.add_space(2.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bright_colour_is_its_hue_times_its_strength() {
        let [strength, hue] = split(LinearRgba::rgb(2.0, 8.0, 4.0));
        assert_eq!(strength.red, 8.0);
        assert_eq!(hue, LinearRgba::rgb(0.25, 1.0, 0.5));
        let [strength, hue] = split(LinearRgba::BLACK);
        assert_eq!((strength.red, hue), (0.0, LinearRgba::WHITE));
    }
}
