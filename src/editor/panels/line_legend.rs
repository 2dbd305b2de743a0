//! What the lines that the tracer drew mean: a legend over the picture, with what there is to say of
//! them, and the labels at their places.

use super::notices::is_over;
use super::says::Says;
use super::theme::gradient;
use crate::editor::inspection::{DebugRay, Drawings};
use crate::editor::pick::to_window;
use crate::inspect::{InspectSettings, Label, LineSet, Meaning, legend};
use crate::trace::RayTree;
use bevy::color::{ColorToPacked, LinearRgba, Srgba};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{
    self, Align2, Color32, FontId, Id, LayerId, Order, Rect, RichText, Sense, Stroke, StrokeKind,
    Ui, pos2, vec2,
};

/// Extent of a line in the legend, in points.
const SWATCH: egui::Vec2 = vec2(26.0, 3.0);
/// Notes are broken at this width, in points.
const WIDTH: f32 = 230.0;
/// Points before each note.
const NOTE_GAP: f32 = 4.0;

/// What the legend remembers between two frames.
#[derive(Resource, Default)]
pub(super) struct LineLegend {
    /// Only the heading is shown.
    is_folded: bool,
    texts: Option<LineTexts>,
}

/// What the lines that are drawn say in words.
struct LineTexts {
    /// Of the [`Drawings`].
    version: u64,
    meanings: Vec<Meaning>,
    notes: Vec<String>,
    labels: Vec<Label>,
}

impl LineTexts {
    fn of(drawings: &Drawings, inspect: &InspectSettings, rays: Option<&RayTree>) -> Self {
        Self {
            version: drawings.version(),
            meanings: drawings
                .sets()
                .filter(|set| !set.is_empty())
                .flat_map(|set| legend(set.system, inspect, rays))
                .collect(),
            notes: drawings.sets().flat_map(LineSet::says).collect(),
            labels: drawings.sets().flat_map(|set| set.labels.clone()).collect(),
        }
    }
}

/// The legend's area.
pub(super) fn layer() -> LayerId {
    LayerId::new(Order::Middle, Id::new("legend of the lines"))
}

/// Draws them, the legend so many points below the picture's upper side; true where the pointer is over the legend.
pub(super) fn line_legend_ui(
    ui: &Ui,
    free: Rect,
    below: f32,
    world: &mut World,
    legend: &mut LineLegend,
) -> bool {
    let Some(inspect) = world.get_resource::<InspectSettings>().filter(|i| i.on) else {
        return false;
    };
    let rays = world.get_resource::<DebugRay>().and_then(DebugRay::rays);
    let Some(drawings) = world.get_resource::<Drawings>() else {
        return false;
    };
    let known = legend.texts.take();
    let texts = match known.filter(|texts| texts.version == drawings.version()) {
        Some(texts) => texts,
        None => LineTexts::of(drawings, inspect, rays.map(|rays| &**rays)),
    };
    let wants_rays =
        inspect.lobes || inspect.pattern.on || inspect.rays.visited || inspect.rays.pruned;
    let lacks_rays = wants_rays && rays.is_none();
    labels_ui(ui, free, world, &texts.labels);
    let texts = legend.texts.insert(texts);
    if texts.meanings.is_empty() && texts.notes.is_empty() && !lacks_rays {
        return false;
    }
    let area = egui::Area::new(layer().id)
        .fixed_pos(free.min + vec2(10.0, 10.0 + below))
        .order(layer().order)
        .show(ui.ctx(), |ui| {
            let fill = ui.visuals().panel_fill.gamma_multiply(0.93);
            egui::Frame::new()
                .fill(fill)
                .corner_radius(4.0)
                .inner_margin(egui::Margin::symmetric(7, 4))
                .show(ui, |ui| {
                    ui.spacing_mut().item_spacing.y = 1.0;
                    let heading = if legend.is_folded {
                        "Lines ⏵"
                    } else {
                        "Lines ⏷"
                    };
                    let heading = egui::Button::new(RichText::new(heading).small()).frame(false);
                    let says = "What the colours of the lines mean; a click folds it up";
                    if ui.add(heading).says(says).clicked() {
                        legend.is_folded = !legend.is_folded;
                    }
                    if !legend.is_folded {
                        body(ui, texts, lacks_rays);
                    }
                });
        });
    is_over(ui.ctx(), area.response.rect)
}

fn body(ui: &mut Ui, texts: &LineTexts, lacks_rays: bool) {
    for Meaning { colors, says } in &texts.meanings {
        ui.horizontal(|ui| {
            let (place, _) = ui.allocate_exact_size(vec2(SWATCH.x, 12.0), Sense::hover());
            let line = Rect::from_center_size(place.center(), SWATCH);
            // What is dark is seen by its edge.
            let edge = Stroke::new(1.0, ui.visuals().weak_text_color());
            ui.painter()
                .rect_stroke(line, 1.0, edge, StrokeKind::Outside);
            let colors: Vec<Color32> = colors.iter().copied().map(color32).collect();
            ui.painter().add(gradient(line, &colors));
            ui.label(RichText::new(*says).small());
        });
    }
    ui.set_max_width(WIDTH);
    let lack = lacks_rays.then_some("no pixel is picked: point at the picture and press R");
    for note in texts.notes.iter().map(String::as_str).chain(lack) {
        // Each is a sentence of its own.
        ui.add_space(NOTE_GAP);
        ui.label(RichText::new(note).small().weak());
    }
}

fn color32(color: LinearRgba) -> Color32 {
    let [r, g, b, a] = Srgba::from(color).to_u8_array();
    Color32::from_rgba_unmultiplied(r, g, b, a)
}

/// Beside what they are about.
fn labels_ui(ui: &Ui, free: Rect, world: &mut World, labels: &[Label]) {
    let zoom = ui.ctx().zoom_factor();
    let painter = ui.painter().with_clip_rect(free);
    for label in labels {
        let Some(at) = to_window(world, label.at) else {
            continue;
        };
        let at = pos2(at.x, at.y) / zoom + vec2(3.0, -3.0);
        let font = FontId::proportional(11.0);
        let galley = painter.layout_no_wrap(label.text.clone(), font, color32(label.color));
        let rect = Align2::LEFT_BOTTOM.anchor_size(at, galley.size());
        let dark = Color32::from_black_alpha(140);
        painter.rect_filled(rect.expand2(vec2(2.0, 0.0)), 2.0, dark);
        painter.galley(rect.min, galley, Color32::WHITE);
    }
}
