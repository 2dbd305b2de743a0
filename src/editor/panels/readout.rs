//! What the pixel under the pointer has, in the status line: the number that its colour stands for.

use super::overlays::{UnderPointer, pixel_at, place_under_pointer, value_under_pointer};
use super::says::note_hint;
use crate::editor::viewport::{Viewport, traced_render, traced_view};
use crate::film::views::View;
use crate::inspect::{Names, color_text, vector_text};
use bevy::ecs::world::World;
use bevy_egui::egui::{Rect, Ui};

/// Says it where the pointer is over the traced picture.
pub(super) fn readout_ui(ui: &Ui, free: Rect, world: &mut World, known: &mut UnderPointer) {
    if !world.resource::<Viewport>().hovered {
        return;
    }
    let Some((view, render)) = traced_view(world).zip(traced_render(world)) else {
        return;
    };
    let at = place_under_pointer(ui.ctx(), free, world.resource::<Viewport>());
    let size = render.subject().map(|(_, _, settings)| settings.size);
    let Some(pixel) = at.zip(size).and_then(|(at, size)| pixel_at(at, view, size)) else {
        return;
    };
    let value = value_under_pointer(at, view, render, known);
    let names = world.get_resource::<Names>();
    let hit = known.0.as_ref().map(|(.., hit)| hit);
    let unit = render.shown().and_then(|shown| shown.scale);
    let text = match view.view {
        View::Shaded | View::BloomThreshold | View::BloomLayer => {
            let known = render.render().and_then(|render| render.pixel_sum(pixel));
            known.map(|(sum, count)| match count {
                0 => "no sample yet".into(),
                1 => format!("{} (1 sample)", color_text(sum.mean(1))),
                n => format!("{} ({n} samples)", color_text(sum.mean(n))),
            })
        }
        View::Albedo => hit.map(|hit| format!("kd {}", color_text(hit.albedo))),
        View::Normal => hit.map(|hit| vector_text(hit.normal)),
        View::Object => hit.map(|hit| match (hit.object, names) {
            (Some(id), Some(names)) => names.of(id.0),
            (Some(id), None) => format!("#{}", id.0),
            (None, _) => "nothing".into(),
        }),
        view => value.map(|value| value.with_unit(view, unit.map_or("", |scale| scale.unit))),
    };
    let text = text.unwrap_or_default();
    note_hint(ui.ctx(), format!("pixel {}, {}: {text}", pixel.x, pixel.y));
}

/// What a heatmap shows at a pixel.
#[derive(Clone, Copy)]
pub(super) struct PixelValue {
    pub value: f32,
    /// Whether that is an upper bound.
    pub is_bound: bool,
}

impl PixelValue {
    /// With all digits that it has.
    pub fn text(self, view: View) -> String {
        let at_most = if self.is_bound { "at most " } else { "" };
        format!("{at_most}{}", value_text(view, self.value))
    }

    /// The same with a unit, which is a plural where things are counted.
    pub fn with_unit(self, view: View, unit: &str) -> String {
        let is_counted = matches!(view, View::Nodes | View::Triangles | View::Samples);
        let unit = match unit.strip_suffix('s') {
            Some(one) if is_counted && self.value == 1.0 => one,
            _ => unit,
        };
        format!("{} {unit}", self.text(view))
    }
}

impl From<f32> for PixelValue {
    fn from(value: f32) -> Self {
        Self {
            value,
            is_bound: false,
        }
    }
}

/// A heatmap's number with all that it has: counts are whole.
fn value_text(view: View, value: f32) -> String {
    match view {
        _ if value.is_nan() => "not known yet".into(),
        _ if value.is_infinite() => "nothing there".into(),
        View::Nodes | View::Triangles | View::Samples => format!("{value:.0}"),
        View::Error if value.abs() < 1e-3 => format!("{value:.3e}"),
        View::Error => format!("{value:.5}"),
        _ => format!("{value:.4}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_whole_and_what_is_not_known_or_not_there_says_so() {
        assert_eq!(value_text(View::Nodes, 12.0), "12");
        assert_eq!(value_text(View::Depth, 12.0), "12.0000");
        assert_eq!(value_text(View::Error, 0.0001234), "1.234e-4");
        assert_eq!(value_text(View::Error, f32::NAN), "not known yet");
        assert_eq!(value_text(View::Depth, f32::INFINITY), "nothing there");
        let bound = PixelValue {
            value: 0.01,
            is_bound: true,
        };
        assert_eq!(bound.text(View::Error), "at most 0.01000");
        assert_eq!(PixelValue::from(12.0).text(View::Samples), "12");
        for (value, text) in [(1.0, "1 sample"), (2.0, "2 samples"), (0.0, "0 samples")] {
            let said = PixelValue::from(value).with_unit(View::Samples, "samples");
            assert_eq!(said, text);
        }
        let depth = PixelValue::from(1.0).with_unit(View::Depth, "m");
        assert_eq!(depth, "1.0000 m");
    }
}
