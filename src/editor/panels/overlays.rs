//! What lies over the picture: the divider of the split view, the legend of a heatmap, the frame of
//! a region; [`notices`](super::notices) has the rest.

use super::answer::{answer_ui, armed_ui};
use super::fields::number;
use super::first_steps::first_steps_ui;
use super::line_legend::line_legend_ui;
use super::notices::{is_over, notices_ui};
use super::pattern::pattern_ui;
use super::readout::PixelValue;
use super::says::Says;
use super::state::with;
use super::theme::{accent, gradient};
use super::tree_pair;
use crate::editor::document::SceneOpened;
use crate::editor::viewport::{
    RegionDrag, Show, Viewport, traced_render, traced_view, traced_view_mut,
};
use crate::film::views::{Scale, View};
use crate::scene::{Quantity, RenderSettings};
use crate::trace::{self, Camera, FirstHit, central_hits};
use crate::view::{TracedRender, TracedView};
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::ResMut;
use bevy::ecs::world::World;
use bevy::math::{self, UVec2, Vec2};
use bevy_egui::egui::{
    self, Align2, Color32, CursorIcon, FontId, Id, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2,
};
use std::sync::{Arc, Weak};

/// Half the width of what can be grabbed of the divider, in points.
const GRAB: f32 = 5.0;
/// Parts of a region that are too small to be meant.
const LEAST_REGION: f32 = 0.01;

/// Parts of a palette's bar, each of which goes from colour to colour.
const STEPS: u32 = 64;

/// An end of a palette; between any two of them the distance is a number.
const END: Quantity = Quantity::within(-1e30, 1e30, "");

/// What the pixel under the pointer shows, and of which world, pixel and camera that is. The world is let go of, but none
/// takes its place in memory.
#[derive(Resource, Default)]
pub(super) struct UnderPointer(pub Option<(Weak<trace::World>, UVec2, Camera, FirstHit)>);

pub(super) fn forget_scene(_: On<SceneOpened>, mut known: ResMut<UnderPointer>) {
    known.0 = None;
}

/// Draws them over the free rectangle, in which there may be two views; true where the pointer is over one of them.
pub(super) fn overlays_ui(
    ui: &mut Ui,
    free: Rect,
    views: Option<[Rect; 2]>,
    world: &mut World,
    only_picture: bool,
) -> bool {
    if !free.is_positive() {
        return false;
    }
    let mut over = false;
    let split = world.resource::<Viewport>().show == Show::Split;
    let picture = views.map_or(free, |[left, _]| left);
    if split {
        over |= divider_ui(ui, picture, world);
        if let Some([_, right]) = views {
            let x = right.min.x + world.resource::<Viewport>().divider * right.width();
            ui.painter()
                .vline(x, right.y_range(), Stroke::new(1.0, Color32::WHITE));
        }
    }
    let [above, below] = views.map_or([0.0; 2], |views| {
        tree_pair::pair_ui(ui, views, world, split)
    });
    over |= with(world, |world, drag| region_ui(ui, picture, world, drag));
    with(world, |world, under| {
        legend_ui(ui, picture, below, world, under)
    });
    with(world, |world, shown| pattern_ui(ui, picture, world, shown));
    over |= with(world, |world, legend| {
        line_legend_ui(ui, picture, above, world, legend)
    });
    over |= notices_ui(ui.ctx(), free, world);
    over |= with(world, |world, answer| {
        answer_ui(ui.ctx(), free, world, answer)
    });
    armed_ui(ui.ctx(), free, world);
    if !only_picture {
        over |= with(world, |world, tried| {
            let room = Rect::from_min_max(free.min, free.max - vec2(0.0, below));
            first_steps_ui(ui.ctx(), room, world, tried)
        });
    }
    over
}

/// The line between raster and traced.
fn divider_ui(ui: &Ui, free: Rect, world: &mut World) -> bool {
    let divider = world.resource::<Viewport>().divider.clamp(0.0, 1.0);
    let x = free.min.x + divider * free.width();
    let rect = Rect::from_x_y_ranges(x - GRAB..=x + GRAB, free.y_range()).intersect(free);
    let response = ui
        .interact(rect, Id::new("split-divider"), Sense::drag())
        .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    if response.dragged()
        && let Some(at) = response.interact_pointer_pos()
    {
        let divider = ((at.x - free.min.x) / free.width()).clamp(0.02, 0.98);
        world.resource_mut::<Viewport>().divider = divider;
    }
    // By the place itself: egui knows what is hovered only a frame later, and a press would pass.
    let active = response.dragged() || is_over(ui.ctx(), rect);
    let color = if active { accent(ui) } else { Color32::WHITE };
    let width = if active { 2.0 } else { 1.0 };
    let painter = ui.painter();
    painter.vline(
        x + 1.0,
        free.y_range(),
        Stroke::new(width, Color32::from_black_alpha(120)),
    );
    painter.vline(x, free.y_range(), Stroke::new(width, color));
    for (align, dx, text) in [
        (Align2::RIGHT_TOP, -8.0, "raster"),
        (Align2::LEFT_TOP, 8.0, "traced"),
    ] {
        label(ui, pos2(x + dx, free.min.y + 8.0), align, text);
    }
    active
}

/// Text over a picture of any brightness.
fn label(ui: &Ui, at: egui::Pos2, align: Align2, text: &str) {
    label_within(ui, at, align, text, f32::INFINITY);
}

/// The same in lines no wider than this; returns where it stands.
pub(super) fn label_within(ui: &Ui, at: egui::Pos2, align: Align2, text: &str, width: f32) -> Rect {
    let font = FontId::proportional(12.0);
    let galley = ui
        .painter()
        .layout(text.to_owned(), font, Color32::WHITE, width);
    let rect = align.anchor_size(at, galley.size());
    let painter = ui.painter();
    painter.rect_filled(
        rect.expand2(vec2(5.0, 2.0)),
        3.0,
        Color32::from_black_alpha(150),
    );
    painter.galley(rect.min, galley, Color32::WHITE);
    rect
}

/// The frame of the region that is traced, and dragging a new one.
fn region_ui(ui: &Ui, free: Rect, world: &mut World, drag: &mut RegionDrag) -> bool {
    let region = traced_view(world).and_then(|view| view.region);
    let place = |at: egui::Pos2| {
        let at = (at - free.min) / free.size();
        Vec2::new(at.x, at.y).clamp(Vec2::ZERO, Vec2::ONE)
    };
    let point = |at: Vec2| free.min + vec2(at.x, at.y) * free.size();
    if let Some(region) = region {
        let rect = Rect::from_min_max(point(region.min), point(region.max));
        let stroke = Stroke::new(1.0, accent(ui));
        ui.painter()
            .rect_stroke(rect, 0.0, stroke, StrokeKind::Outside);
    }
    if !drag.is_armed {
        return false;
    }
    let response = ui
        .interact(free, Id::new("region"), Sense::drag())
        .on_hover_and_drag_cursor(CursorIcon::Crosshair);
    if response.drag_started() {
        let pressed = ui.input(|input| input.pointer.press_origin());
        drag.start = pressed.map(place);
    }
    let Some(start) = drag.start else {
        return true;
    };
    let Some(end) = response.interact_pointer_pos() else {
        return true;
    };
    let rect = Rect::from_two_pos(point(start), end).intersect(free);
    let stroke = Stroke::new(1.0, accent(ui));
    ui.painter()
        .rect_stroke(rect, 0.0, stroke, StrokeKind::Inside);
    if response.drag_stopped() {
        drag.cancel();
        let region = math::Rect::from_corners(start, place(end));
        if region.size().min_element() > LEAST_REGION
            && let Some(mut view) = traced_view_mut(world)
        {
            view.region = Some(region);
        }
    }
    true
}

/// The palette of a heatmap with its ends, which can be dragged, and the value under the pointer; so many points above the
/// picture's lower side.
fn legend_ui(ui: &Ui, free: Rect, above: f32, world: &mut World, known: &mut UnderPointer) {
    let Some((view, render)) = traced_view(world).zip(traced_render(world)) else {
        return;
    };
    let scale = render.shown().and_then(|shown| shown.scale);
    let (Some(scale), true) = (scale, view.view.is_heatmap() && view.divider < 1.0) else {
        return;
    };
    let (kind, range) = (view.view, view.range);
    let at = place_under_pointer(ui.ctx(), free, world.resource::<Viewport>());
    let under = value_under_pointer(at, view, render, known);
    let mut entered = range;
    egui::Area::new(Id::new("legend"))
        .anchor(
            Align2::LEFT_BOTTOM,
            vec2(
                free.min.x + 10.0,
                -(ui.ctx().viewport_rect().max.y - free.max.y + above + 10.0),
            ),
        )
        .order(egui::Order::Middle)
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(egui::Margin::same(6))
                .show(ui, |ui| {
                    entered = legend_body(ui, (kind, &scale), range, under)
                });
        });
    if entered != range
        && let Some(mut view) = traced_view_mut(world)
    {
        view.range = entered;
    }
}

fn legend_body(
    ui: &mut Ui,
    (kind, scale): (View, &Scale),
    range: Option<[f32; 2]>,
    under: Option<PixelValue>,
) -> Option<[f32; 2]> {
    let width = 200.0;
    let (bar, _) = ui.allocate_exact_size(vec2(width, 12.0), Sense::hover());
    let colors: Vec<Color32> = (0..=STEPS)
        .map(|i| {
            let part = i as f32 / STEPS as f32;
            let color = scale.color(scale.low + part * (scale.high - scale.low));
            let [r, g, b] = color.map(|channel| (channel * 255.0 + 0.5) as u8);
            Color32::from_rgb(r, g, b)
        })
        .collect();
    ui.painter().add(gradient(bar, &colors));
    if let Some(value) = under.map(|under| under.value).filter(|v| v.is_finite()) {
        let part = ((value - scale.low) / (scale.high - scale.low)).clamp(0.0, 1.0);
        let x = bar.min.x + part * width;
        let marker =
            Rect::from_x_y_ranges(x - 1.5..=x + 1.5, bar.y_range()).expand2(vec2(0.0, 2.0));
        ui.painter().rect_filled(marker, 1.0, Color32::WHITE);
        let stroke = Stroke::new(1.0, Color32::BLACK);
        ui.painter()
            .rect_stroke(marker, 1.0, stroke, StrokeKind::Outside);
    }
    let mut ends = [scale.low, scale.high];
    let mut entered = range;
    ui.horizontal(|ui| {
        let speed = ((scale.high - scale.low) * 0.01).max(1e-4);
        for (i, says) in [
            "The value at the palette's left end",
            "The value at its right end",
        ]
        .into_iter()
        .enumerate()
        {
            if number(ui, says, &mut ends[i], END.step(speed.into())) {
                entered = Some(in_order(ends, i, scale.high - scale.low));
            }
        }
        ui.label(scale.unit);
        let auto = ui.add_enabled(range.is_some(), egui::Button::new("auto").small());
        if auto
            .says("Takes the range from the picture again")
            .clicked()
        {
            entered = None;
        }
    });
    let text = match under {
        Some(under) if under.value.is_finite() => under.with_unit(kind, scale.unit),
        Some(under) => under.text(kind),
        None => "move the pointer over the picture for its value".into(),
    };
    ui.weak(text);
    entered.filter(|[low, high]| low < high && low.is_finite() && high.is_finite())
}

/// The end that was entered stays, and takes the other one along where it went past it.
fn in_order([low, high]: [f32; 2], entered: usize, span: f32) -> [f32; 2] {
    // As far as numbers of that size can be told apart.
    let span = span.max(1e-3 * low.abs().max(high.abs()));
    match (low < high, entered) {
        (true, _) => [low, high],
        (false, 0) => [low, low + span],
        (false, _) => [high - span, high],
    }
}

/// Where the pointer is over the picture, whichever of two views of it that is: (0, 0) at the top left, (1, 1) opposite.
pub(super) fn place_under_pointer(
    context: &egui::Context,
    picture: Rect,
    viewport: &Viewport,
) -> Option<Vec2> {
    let at = context.pointer_latest_pos()?;
    let zoom = context.zoom_factor();
    let offset = viewport.offset(Vec2::new(at.x, at.y) * zoom) / zoom;
    let at = at - vec2(offset.x, offset.y);
    let place = (at - picture.min) / picture.size();
    picture.contains(at).then_some(Vec2::new(place.x, place.y))
}

/// The pixel of the traced picture at a place of the view.
pub(super) fn pixel_at(place: Vec2, view: &TracedView, size: UVec2) -> Option<UVec2> {
    let pixel = (place * size.as_vec2()).as_uvec2();
    (place.x >= view.divider).then(|| pixel.min(size - UVec2::ONE))
}

/// What the heatmap shows at a place of the view. Looked up when the pointer or the picture
/// moved on, by the same function that the view is made with.
pub(super) fn value_under_pointer(
    at: Option<Vec2>,
    view: &TracedView,
    render: &TracedRender,
    known: &mut UnderPointer,
) -> Option<PixelValue> {
    let (world, camera, settings) = render.subject()?;
    let size = settings.size;
    let pixel = pixel_at(at?, view, size)?;
    let film = || render.render()?.pixel(pixel);
    match view.view {
        View::Samples => film().map(|(samples, _)| (samples as f32).into()),
        View::Error => film().map(|(_, error)| PixelValue {
            value: error.relative,
            is_bound: error.is_bound,
        }),
        kind => {
            let of = Arc::downgrade(world);
            let hit = match &known.0 {
                Some((known, at, from, hit))
                    if known.ptr_eq(&of) && (*at, from) == (pixel, camera) =>
                {
                    *hit
                }
                _ => {
                    let mut hits = [FirstHit::MISS];
                    let settings = RenderSettings {
                        size,
                        ..settings.clone()
                    };
                    central_hits(world, camera, &settings, &[pixel], &mut hits);
                    hits[0]
                }
            };
            known.0 = Some((of, pixel, camera.clone(), hit));
            let value = match kind {
                View::Nodes => hit.cost.nodes as f32,
                View::Triangles => hit.cost.triangles as f32,
                _ => hit.depth,
            };
            Some(value.into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::panels::tests::type_nonsense;

    #[test]
    fn nothing_that_is_typed_makes_a_palette_without_a_range() {
        let scale = |range: &Option<[f32; 2]>| {
            let [low, high] = range.unwrap_or([0.0, 40.0]);
            Scale {
                low,
                high,
                unit: "nodes",
                low_is_bright: false,
            }
        };
        let mut range = None;
        let fields = type_nonsense(
            &mut range,
            |ui, range| *range = legend_body(ui, (View::Nodes, &scale(range)), *range, None),
            |range, text| {
                let [low, high] = range.unwrap_or([0.0, 40.0]);
                let is_range = low < high && (high - low).is_finite();
                assert!(is_range, "`{text}` gives {low} to {high}");
            },
        );
        assert_eq!(fields, 2);
        assert!(range.is_some(), "some of it is a number");
    }

    #[test]
    fn an_end_past_the_other_takes_it_along() {
        assert_eq!(in_order([3.0, 9.0], 0, 40.0), [3.0, 9.0]);
        assert_eq!(in_order([50.0, 40.0], 0, 40.0), [50.0, 90.0]);
        assert_eq!(in_order([0.0, -5.0], 1, 40.0), [-45.0, -5.0]);
        let [low, high] = in_order([1e9, 40.0], 0, 40.0);
        assert!(low == 1e9 && high > low);
    }
}
