//! The fields that properties are entered in: a label with its explanation on the left, the value on
//! the right. Each works on a copy and returns whether a person changed it; merely being drawn
//! changes nothing, not even a value out of range.

use super::says::Says;
use bevy::color::LinearRgba;
use bevy::math::{Vec2, Vec3};
use bevy_egui::egui::{
    self, Align, ComboBox, DragValue, Label, Layout, Response, Slider, SliderClamping, Ui, vec2,
};
use std::ops::RangeInclusive;

/// What is shown in place of a value in which several entities differ.
const MIXED: &str = "mixed";
/// The part of the width that labels take.
const LABELS: f32 = 0.38;

/// A label with its explanation, and what stands beside it.
pub(super) fn row<R>(ui: &mut Ui, label: &str, says: &str, value: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let width = (ui.available_width() * LABELS).clamp(70.0, 160.0);
        let size = vec2(width, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(width);
            ui.add(Label::new(label).truncate()).says(says);
        });
        value(ui)
    })
    .inner
}

/// How a number is entered.
#[derive(Clone, Copy)]
pub(super) struct Number {
    /// What it may be, both ends included.
    pub range: [f32; 2],
    /// Its change for each point that it is dragged; a slider where it is 0.
    pub speed: f32,
    /// Behind the number.
    pub unit: &'static str,
    /// The slider's places go by the number's logarithm.
    pub logarithmic: bool,
}

impl Number {
    /// Dragged, without an end.
    pub const fn free(speed: f32, unit: &'static str) -> Self {
        Self {
            range: [f32::MIN, f32::MAX],
            speed,
            unit,
            logarithmic: false,
        }
    }

    /// Dragged, zero or more.
    pub const fn positive(speed: f32, unit: &'static str) -> Self {
        Self {
            range: [0.0, f32::MAX],
            ..Self::free(speed, unit)
        }
    }

    /// A slider between two ends.
    pub const fn slider(least: f32, most: f32, unit: &'static str) -> Self {
        Self {
            range: [least, most],
            speed: 0.0,
            unit,
            logarithmic: false,
        }
    }

    /// The same, by the logarithm.
    pub const fn logarithmic(least: f32, most: f32, unit: &'static str) -> Self {
        Self {
            logarithmic: true,
            ..Self::slider(least, most, unit)
        }
    }

    /// The same with other ends.
    pub const fn within(self, least: f32, most: f32) -> Self {
        Self {
            range: [least, most],
            ..self
        }
    }

    /// The field alone.
    pub fn ui(self, ui: &mut Ui, value: &mut f32, mixed: bool, says: &str) -> bool {
        let mut entered = *value;
        let [least, most] = self.range;
        let response = if self.speed > 0.0 {
            // Large numbers are dragged in larger steps.
            let speed = self.speed.max(entered.abs() * 0.01);
            let speed = if speed.is_finite() { speed } else { self.speed };
            ui.add(drag(&mut entered, least..=most, speed, self.unit, mixed))
        } else {
            slider_ui(ui, &mut entered, least..=most, self, mixed)
        };
        let changed = response.says(says).changed();
        accept(value, entered, self.range, changed)
    }

    /// The field with its label.
    pub fn row(self, ui: &mut Ui, label: &str, says: &str, value: &mut f32, mixed: bool) -> bool {
        row(ui, label, says, |ui| self.ui(ui, value, mixed, says))
    }
}

/// Takes over what was entered where it is a number, brought into its range.
fn accept(value: &mut f32, entered: f32, [least, most]: [f32; 2], changed: bool) -> bool {
    if !changed || entered.is_nan() {
        return false;
    }
    *value = entered.clamp(least, most);
    true
}

fn drag<'a, N: egui::emath::Numeric>(
    value: &'a mut N,
    range: RangeInclusive<N>,
    speed: f32,
    unit: &str,
    mixed: bool,
) -> DragValue<'a> {
    let field = DragValue::new(value)
        .range(range)
        .clamp_existing_to_range(false)
        .speed(speed);
    let field = if unit.is_empty() {
        field
    } else {
        let gap = if unit == "°" { "" } else { " " };
        field.suffix(format!("{gap}{unit}"))
    };
    if mixed {
        field.custom_formatter(|_, _| MIXED.into())
    } else {
        field
    }
}

fn slider_ui(
    ui: &mut Ui,
    value: &mut f32,
    range: RangeInclusive<f32>,
    number: Number,
    mixed: bool,
) -> Response {
    // What is left beside the slider's own number.
    ui.spacing_mut().slider_width = (ui.available_width() - 66.0).clamp(40.0, 220.0);
    let unit = number.unit;
    let suffix = match unit {
        "" | "°" => unit.to_owned(),
        unit => format!(" {unit}"),
    };
    let slider = Slider::new(value, range)
        .logarithmic(number.logarithmic)
        .clamping(SliderClamping::Edits)
        .max_decimals(3)
        .suffix(suffix);
    ui.add(if mixed {
        slider.custom_formatter(|_, _| MIXED.into())
    } else {
        slider
    })
}

/// A whole number with its label; a slider by the logarithm where the range is large.
pub(super) fn integer(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut u32,
    range: RangeInclusive<u32>,
    mixed: bool,
) -> bool {
    row(ui, label, says, |ui| {
        let mut entered = *value;
        let (least, most) = (*range.start(), *range.end());
        let response = if most > 1_000_000 {
            ui.add(drag(&mut entered, range, 0.25, "", mixed))
        } else {
            ui.spacing_mut().slider_width = (ui.available_width() - 66.0).clamp(40.0, 220.0);
            let slider = Slider::new(&mut entered, range)
                .logarithmic(most >= 100 * least.max(1))
                .clamping(SliderClamping::Edits);
            ui.add(if mixed {
                slider.custom_formatter(|_, _| MIXED.into())
            } else {
                slider
            })
        };
        let changed = response.says(says).changed();
        if changed {
            *value = entered.clamp(least, most);
        }
        changed
    })
}

/// A switch with its label.
pub(super) fn switch(ui: &mut Ui, label: &str, says: &str, value: &mut bool, mixed: bool) -> bool {
    row(ui, label, says, |ui| {
        let text = if mixed { MIXED } else { "" };
        ui.checkbox(value, text).says(says).changed()
    })
}

/// Three numbers in a line, with their label; returns which were changed.
pub(super) fn vector(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut Vec3,
    number: Number,
    mixed: [bool; 3],
) -> [bool; 3] {
    let mut changed = [false; 3];
    row(ui, label, says, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let width = (ui.available_width() - 6.0) / 3.0;
        ui.spacing_mut().interact_size.x = width.max(30.0);
        for axis in 0..3 {
            let mut entered = value[axis];
            changed[axis] = number.ui(ui, &mut entered, mixed[axis], says);
            value[axis] = entered;
        }
    });
    changed
}

/// Three numbers that belong to one thing.
pub(super) fn point(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut Vec3,
    number: Number,
    mixed: bool,
) -> bool {
    let changed = vector(ui, label, says, value, number, [mixed; 3]);
    changed.contains(&true)
}

/// Two numbers in a line, with their label.
pub(super) fn pair(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut Vec2,
    number: Number,
    mixed: bool,
) -> bool {
    row(ui, label, says, |ui| {
        let width = (ui.available_width() - 6.0) / 2.0;
        ui.spacing_mut().interact_size.x = width.max(30.0);
        let x = number.ui(ui, &mut value.x, mixed, says);
        number.ui(ui, &mut value.y, mixed, says) || x
    })
}

/// A colour in [0, 1], linear inside, shown and entered as a screen's.
pub(super) fn color(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut LinearRgba,
    mixed: bool,
) -> bool {
    row(ui, label, says, |ui| color_ui(ui, says, value, mixed))
}

/// The same without a label.
pub(super) fn color_ui(ui: &mut Ui, says: &str, value: &mut LinearRgba, mixed: bool) -> bool {
    let mut rgb = [value.red, value.green, value.blue];
    let response = ui.color_edit_button_rgb(&mut rgb).says(says);
    if mixed {
        ui.weak(MIXED);
    }
    let changed = response.changed() && rgb.iter().all(|part| part.is_finite());
    if changed {
        *value = LinearRgba::rgb(rgb[0], rgb[1], rgb[2]);
    }
    changed
}

/// A colour that may be brighter than 1: its hue, and its largest component as a number.
pub(super) fn radiant(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut LinearRgba,
    mixed: bool,
) -> bool {
    row(ui, label, says, |ui| {
        let [strength, hue] = split(*value);
        let mut entered = hue;
        let mut changed = color_ui(ui, says, &mut entered, mixed);
        let mut level = strength.red;
        let number = Number::positive(0.02, "×");
        changed |= number.ui(ui, &mut level, mixed, says);
        if changed {
            let part = |channel: f32| channel * level;
            *value = LinearRgba::rgb(part(entered.red), part(entered.green), part(entered.blue));
        }
        changed
    })
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

/// An angle in degrees, radians inside.
pub(super) fn angle(
    ui: &mut Ui,
    label: &str,
    says: &str,
    radians: &mut f32,
    degrees: [f32; 2],
    mixed: bool,
) -> bool {
    let mut entered = radians.to_degrees();
    let changed =
        Number::slider(degrees[0], degrees[1], "°").row(ui, label, says, &mut entered, mixed);
    if changed {
        *radians = entered.to_radians();
    }
    changed
}

/// One of several, by name.
pub(super) fn choice<T: PartialEq + Copy>(
    ui: &mut Ui,
    label: &str,
    says: &str,
    value: &mut T,
    choices: &[(T, &str, &str)],
    mixed: bool,
) -> bool {
    row(ui, label, says, |ui| {
        let current = choices.iter().find(|choice| choice.0 == *value);
        let name = match mixed {
            true => MIXED,
            false => current.map_or("?", |choice| choice.1),
        };
        let mut changed = false;
        ComboBox::from_id_salt(label)
            .selected_text(name)
            .width((ui.available_width() - 8.0).clamp(60.0, 240.0))
            .show_ui(ui, |ui| {
                for &(choice, name, tip) in choices {
                    let is_current = !mixed && choice == *value;
                    if ui.selectable_label(is_current, name).says(tip).clicked() && !is_current {
                        *value = choice;
                        changed = true;
                    }
                }
            })
            .response
            .says(says);
        changed
    })
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
    fn a_number_out_of_range_is_brought_into_it_and_no_number_is_refused() {
        let mut value = 3.0;
        assert!(accept(&mut value, 90.0, [0.0, 10.0], true));
        assert_eq!(value, 10.0);
        assert!(accept(&mut value, f32::NEG_INFINITY, [0.0, 10.0], true));
        assert_eq!(value, 0.0);
        assert!(!accept(&mut value, f32::NAN, [0.0, 10.0], true));
        assert!(!accept(&mut value, 5.0, [0.0, 10.0], false));
        assert_eq!(value, 0.0);
    }

    #[test]
    fn a_bright_colour_is_its_hue_times_its_strength() {
        let [strength, hue] = split(LinearRgba::rgb(2.0, 8.0, 4.0));
        assert_eq!(strength.red, 8.0);
        assert_eq!(hue, LinearRgba::rgb(0.25, 1.0, 0.5));
        let [strength, hue] = split(LinearRgba::BLACK);
        assert_eq!((strength.red, hue), (0.0, LinearRgba::WHITE));
    }
}
